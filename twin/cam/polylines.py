"""Lines of a tool's tip as polylines, from heights at even places and more of them where chords would not do."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray

#: A rough cell is cut into this many.
FINER = 16
#: Change of slope that makes an inner corner, and slope that makes a wall.
_CORNER = 0.02
_WALL = 50.0
#: Heights within cells, shape (c, FINER + 1), from the numbers of lines and of cells, shape (c,) each.
Within: TypeAlias = Callable[[NDArray[np.int64], NDArray[np.int64]], FloatArray]


@dataclass(frozen=True, slots=True, kw_only=True)
class Places:
    """Evenly spaced places along a line.

    Attributes:
        start_mm: the first.
        step_mm: their distance, above 0.
        count: how many, at least 2.
    """

    start_mm: float
    step_mm: float
    count: int

    @classmethod
    def between(cls, low_mm: float, high_mm: float, step_mm: float) -> Places:
        """Both ends included, no farther apart than a step."""
        gaps = max(1, math.ceil((high_mm - low_mm) / step_mm - 1e-9))
        return cls(start_mm=low_mm, step_mm=(high_mm - low_mm) / gaps, count=gaps + 1)

    @property
    def at_mm(self) -> FloatArray:
        """The places, shape (count,)."""
        return np.asarray(self.start_mm + self.step_mm * np.arange(self.count, dtype=np.float64))


def polylines(
    places: Places, heights: FloatArray, within: Within, *, floor_mm: float, chord_mm: float
) -> list[FloatArray]:
    """Lines through heights, with places in between wherever chords would stand off by more than ``chord_mm``.

    At inner corners the sides of the line are drawn on until they meet; at walls the line first leaves the wall and
    then goes down upright.

    Args:
        heights: shape (p, n), at the even places of every line.
        within: heights within cells between two of the places, both ends included.
        floor_mm: least height.

    Returns:
        for every line shape (m, 2): place along it, increasing or equal, and height.
    """
    heights = np.maximum(heights, floor_mm)
    rows, cells = np.nonzero(_rough(heights, places.step_mm, chord_mm))
    finer = np.maximum(within(rows, cells), floor_mm)
    inner = places.step_mm / FINER * np.arange(FINER)
    lines = []
    bounds = np.searchsorted(rows, np.arange(len(heights) + 1))
    at = places.at_mm
    for p, (first, last) in enumerate(pairwise(bounds.tolist())):
        mine = cells[first:last]
        u = np.concatenate((np.delete(at, mine), (at[mine, None] + inner).ravel()))
        z = np.concatenate((np.delete(heights[p], mine), finer[first:last, :FINER].ravel()))
        order = np.argsort(u, kind="stable")
        lines.append(_with_walls(_with_corners(np.column_stack((u[order], z[order])))))
    return lines


def _rough(heights: FloatArray, step_mm: float, chord_mm: float) -> NDArray[np.bool_]:
    """Cells whose chords may stand off by more than a tolerance, by the second differences at their ends."""
    slope = np.abs(np.diff(heights, axis=1)) / step_mm
    bend = np.zeros_like(heights)
    least = np.minimum(slope[:, 1:], slope[:, :-1])
    bend[:, 1:-1] = np.abs(np.diff(heights, 2, axis=1)) / np.sqrt(1.0 + least**2)
    return np.asarray(np.maximum(bend[:, 1:], bend[:, :-1]) > 8.0 * chord_mm)


def _with_corners(line: FloatArray) -> FloatArray:
    """A line with the points where an inner corner lies between two of its points: where its sides, drawn on, meet."""
    u, z = line[:, 0], line[:, 1]
    slope = np.diff(z) / np.diff(u)
    left, right, width = slope[:-2], slope[2:], np.diff(u)[1:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        ahead = (z[2:-1] - z[1:-2] - right * width) / (left - right)
    found = np.flatnonzero((right - left > _CORNER) & (ahead > 0.0) & (ahead < width))
    corners = np.column_stack((u[found + 1] + ahead[found], z[found + 1] + left[found] * ahead[found]))
    return np.insert(line, found + 2, corners, axis=0)


def _with_walls(line: FloatArray) -> FloatArray:
    """A line that goes upright where it is nearly so, on the side away from the wall."""
    step = np.diff(line, axis=0)
    steep = np.flatnonzero(np.abs(step[:, 1]) > _WALL * step[:, 0])
    down = step[steep, 1] < 0.0
    corners = np.column_stack(
        (np.where(down, line[steep + 1, 0], line[steep, 0]), np.where(down, line[steep, 1], line[steep + 1, 1]))
    )
    return np.insert(line, steep + 1, corners, axis=0)
