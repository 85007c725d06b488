"""Straight lines through the material of a plane: where they enter and leave it, and how the boundary leans there."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.polygons import line_kernels as kernels

#: Ends of material no further apart than this cancel: far below any slice pitch, far above rounding.
MERGE_MM = 1e-8


class LineEnds(NamedTuple):
    """Material on parallel lines of a plane.

    Attributes:
        offsets: shape (lines + 1,); line i has the values from ``offsets[i]`` to ``offsets[i + 1]``, an even number.
        ends_mm: increasing on each line: material from the first to the second, from the third to the fourth, ...
        slopes: d(end) / d(position of the line) of the boundary at each end; 0 where it is square to the line.
    """

    offsets: NDArray[np.int64]
    ends_mm: FloatArray
    slopes: FloatArray


def collect(count: int, fill: Callable[[NDArray[np.int64], FloatArray, FloatArray], int]) -> LineEnds:
    """Call a kernel with more and more room until its ends fit.

    Args:
        count: number of lines.
        fill: takes offsets, ends and slopes to fill; returns how many ends there are, or -1 when they do not fit.
    """
    offsets = np.zeros(count + 1, dtype=np.int64)
    room = 64 + 8 * count
    while True:
        ends, slopes = np.empty(room), np.empty(room)
        n = fill(offsets, ends, slopes)
        if n >= 0:
            return LineEnds(offsets, ends[:n], slopes[:n])
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
    return collect(
        len(at_mm),
        lambda offsets, ends, slopes: kernels.ring_lines(at_mm, fixed, MERGE_MM, rows, offsets, ends, slopes),
    )
