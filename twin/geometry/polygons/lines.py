"""Straight lines through the material of a plane: their ends in it, and the slope of the boundary there."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from twin.arrays import FloatArray
from twin.geometry.polygons.line_kernels import LineEnds, ring_lines

__all__ = ["MERGE_MM", "LineEnds", "collect", "ring_line_ends"]

#: Ends of material no further apart than this cancel: far below any slice pitch, far above rounding.
MERGE_MM = 1e-8


def collect(count: int, fill: Callable[[LineEnds], int]) -> LineEnds:
    """Call a kernel with more and more room until its ends fit.

    Args:
        count: number of lines.
        fill: takes arrays to fill; returns the number of ends, or -1 when they do not fit.
    """
    offsets = np.zeros(count + 1, dtype=np.int64)
    room = 64 + 8 * count
    while True:
        found = LineEnds(offsets, np.empty(room), np.empty(room))
        n = fill(found)
        if n >= 0:
            return LineEnds(offsets, found.ends_mm[:n], found.slopes[:n])
        room *= 4


def ring_line_ends(planes: Iterable[Sequence[FloatArray]], fixed: int, at_mm: FloatArray) -> LineEnds:
    """Lines through rings by even-odd filling.

    Args:
        planes: the rings of each plane, each of shape (n, 2).
        fixed: in-plane coordinate that is constant on a line, 0 for u, 1 for v.
        at_mm: shape (n,), that coordinate for each line.

    Returns:
        all lines of the first plane, then those of the second, ...
    """
    found = [_through(rings, fixed, at_mm) for rings in planes]
    starts = np.cumsum([0] + [len(f.ends_mm) for f in found])
    return LineEnds(
        np.concatenate([[0]] + [f.offsets[1:] + s for f, s in zip(found, starts, strict=False)]).astype(np.int64),
        np.concatenate([np.empty(0)] + [f.ends_mm for f in found]),
        np.concatenate([np.empty(0)] + [f.slopes for f in found]),
    )


def _through(rings: Sequence[FloatArray], fixed: int, at_mm: FloatArray) -> LineEnds:
    edges = [np.column_stack((r, np.roll(r, -1, axis=0))) for r in rings]
    rows = np.concatenate(edges) if edges else np.empty((0, 4))
    return collect(len(at_mm), lambda out: ring_lines(at_mm, fixed, MERGE_MM, rows, out))
