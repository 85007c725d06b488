"""Scanning paths: rows in parallel planes, each the upper envelope of the inflated part's section.

The tri-slice paper, section 3.1: zx slices give rows along x, yz slices rows along y. Successive inflation gives the
layers of roughing (its Table 1).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from twin.arrays import FloatArray
from twin.cam.envelope import below, upper_envelope
from twin.cam.linking import Pass
from twin.geometry.region import Region

Direction: TypeAlias = Literal["x", "y"]
#: The planes that rows along a direction lie in, by their normal.
ACROSS: dict[Direction, int] = {"x": 1, "y": 0}
#: Part of the step-over by which rows may be farther apart for rounding.
_SLACK = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rows:
    """Sections of an inflated part in planes along the feed.

    Attributes:
        direction: axis along which rows run.
        at_mm: positions of the planes, increasing, shape (n,).
        regions: the inflated part in (u, z), one a plane, as places of the tool's reference point.
        tip_mm: height of the tip above the reference point: minus the radius where that is a ball's centre.
    """

    direction: Direction
    at_mm: FloatArray
    regions: Sequence[Region]
    tip_mm: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanOptions:
    """How rows become passes.

    Attributes:
        low_mm, high_mm: range of the tip along the rows.
        floor_mm: lowest tip.
        top_mm: material's highest point: what of a row lies above it is left out.
        zigzag: every second row the other way round; else all the same way.
        climb: whether rows run so that the uncut material, towards higher rows, is on their right; with zigzag the
            first row.
        layer: number of the layer, for linking.
    """

    low_mm: float
    high_mm: float
    floor_mm: float
    top_mm: float = math.inf
    zigzag: bool = False
    climb: bool = True
    layer: int = 0


def row_positions(low_mm: float, high_mm: float, stepover_mm: float) -> FloatArray:
    """Evenly spread rows, both ends included, no farther apart than the step-over; shape (n >= 1,)."""
    gaps = math.ceil((high_mm - low_mm) / stepover_mm - _SLACK)
    return np.linspace(low_mm, high_mm, gaps + 1)


def scan_passes(rows: Rows, options: ScanOptions) -> tuple[Pass, ...]:
    """One pass for each run of a row below the material's top, in the order of cutting."""
    # a row along +y has higher rows, towards +x, on its right; one along +x has them, towards +y, on its left
    forward = options.climb == (rows.direction == "y")
    passes: list[Pass] = []
    for number, (at, region) in enumerate(zip(rows.at_mm.tolist(), rows.regions, strict=True)):
        line = upper_envelope(region, options.low_mm, options.high_mm, options.floor_mm - rows.tip_mm)
        runs = below(_in_space(line, at, rows), options.top_mm)
        if forward == (options.zigzag and number % 2 == 1):
            runs = [run[::-1] for run in reversed(runs)]
        passes += [Pass(points_mm=run, top_mm=options.top_mm, layer=options.layer) for run in runs]
    return tuple(passes)


def _in_space(line: FloatArray, at_mm: float, rows: Rows) -> FloatArray:
    """Tips in space from (u, reference height)."""
    across = np.full(len(line), at_mm)
    x, y = (line[:, 0], across) if rows.direction == "x" else (across, line[:, 0])
    return np.column_stack((x, y, line[:, 1] + rows.tip_mm))
