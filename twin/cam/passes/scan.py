"""Scanning paths: rows in parallel planes, each the upper boundary of the inflated part's section.

The tri-slice paper, section 3.1: zx slices give rows along x, yz slices rows along y. Inflation by more and more gives
the layers of roughing (its Table 1).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from twin.arrays import FloatArray
from twin.cam.path.linking import Pass
from twin.cam.slices.stretches import below

Direction: TypeAlias = Literal["x", "y"]
#: The planes that rows along a direction lie in, by their normal.
ACROSS: dict[Direction, int] = {"x": 1, "y": 0}
#: Part of the stepover by which rows may be farther apart for rounding.
_SLACK = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rows:
    """CL lines over an inflated part.

    Attributes:
        direction: axis along which rows run.
        at_mm: their positions across it, increasing, shape (n,).
        lines_mm: for every row positions along it, not decreasing, and heights of the tip, shape (m, 2).
    """

    direction: Direction
    at_mm: FloatArray
    lines_mm: Sequence[FloatArray]


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanOptions:
    """How rows become passes.

    Attributes:
        top_mm: material's highest point: parts of a row above it are omitted.
        zigzag: every second row in the opposite direction; else all in the same one.
        climb: whether rows run so that the uncut material, towards higher rows, is on their right; with zigzag the
            first row.
        layer: number of the layer, for linking.
        approach_mm: positions along the row, before its low and after its high end, from which the tool may come
            through nothing but air; None for an end without one.
    """

    top_mm: float = math.inf
    zigzag: bool = False
    climb: bool = True
    layer: int = 0
    approach_mm: tuple[float | None, float | None] = (None, None)


def row_positions(low_mm: float, high_mm: float, stepover_mm: float) -> FloatArray:
    """Evenly spread rows, both ends included, no farther apart than the stepover; shape (n >= 1,)."""
    gaps = math.ceil((high_mm - low_mm) / stepover_mm - _SLACK)
    return np.linspace(low_mm, high_mm, gaps + 1)


def scan_passes(rows: Rows, options: ScanOptions) -> tuple[Pass, ...]:
    """One pass for each run of a row below the material's top, in the order of cutting."""
    # a row along +y has higher rows, towards +x, on its right; one along +x has them, towards +y, on its left
    forward = options.climb == (rows.direction == "y")
    passes: list[Pass] = []
    for number, (at, line) in enumerate(zip(rows.at_mm.tolist(), rows.lines_mm, strict=True)):
        ends = (float(line[0, 0]), float(line[-1, 0]))
        runs = below(_in_space(line, at, rows), options.top_mm)
        if forward == (options.zigzag and number % 2 == 1):
            runs = [run[::-1] for run in reversed(runs)]
        passes += [_pass(run, ends, rows, options) for run in runs]
    return tuple(passes)


def _pass(run: FloatArray, ends: tuple[float, float], rows: Rows, options: ScanOptions) -> Pass:
    """A run, approached from outside where it begins at an end of its row that allows it."""
    axis = 0 if rows.direction == "x" else 1
    approach: FloatArray | None = None
    for end, position in zip(ends, options.approach_mm, strict=True):
        if position is not None and run[0, axis] == end:
            approach = run[0].copy()
            approach[axis] = position
    return Pass(points_mm=run, top_mm=options.top_mm, layer=options.layer, approach_mm=approach)


def _in_space(line: FloatArray, at_mm: float, rows: Rows) -> FloatArray:
    """Tips in space from positions along a row and heights."""
    across = np.full(len(line), at_mm)
    x, y = (line[:, 0], across) if rows.direction == "x" else (across, line[:, 0])
    return np.column_stack((x, y, line[:, 1]))
