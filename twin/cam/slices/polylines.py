"""Lines of a tool's tip as polylines, from heights at even samples and more of them where chords would not do."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cam.slices import polyline_kernels as kernels

#: A rough cell is cut into this many.
FINER = 16
#: Heights within cells, shape (c, FINER + 1), from the numbers of lines and of cells, shape (c,) each.
Within: TypeAlias = Callable[[NDArray[np.int64], NDArray[np.int64]], FloatArray]


@dataclass(frozen=True, slots=True, kw_only=True)
class Samples:
    """Evenly spaced samples along a line.

    Attributes:
        start_mm: the first.
        step_mm: their distance, above 0.
        count: how many, at least 2.
    """

    start_mm: float
    step_mm: float
    count: int

    @classmethod
    def between(cls, low_mm: float, high_mm: float, step_mm: float) -> Samples:
        """Both ends included, no farther apart than a step."""
        gaps = max(1, math.ceil((high_mm - low_mm) / step_mm - 1e-9))
        return cls(start_mm=low_mm, step_mm=(high_mm - low_mm) / gaps, count=gaps + 1)

    @property
    def at_mm(self) -> FloatArray:
        """The samples, shape (count,)."""
        return np.asarray(self.start_mm + self.step_mm * np.arange(self.count, dtype=np.float64))


def polylines(
    samples: Samples, heights: FloatArray, within: Within, *, floor_mm: float, chord_mm: float
) -> list[FloatArray]:
    """Lines through heights, with samples in between wherever chords would stand off by more than ``chord_mm``.

    At inner corners the sides of the line are drawn on until they meet; at walls the line first leaves the wall and
    then goes down upright.

    Args:
        heights: shape (p, n), at the even samples of every line.
        within: heights within cells between two of the samples, both ends included.
        floor_mm: least height.

    Returns:
        for every line shape (m, 2): position along it, increasing or equal, and height.
    """
    heights = np.maximum(heights, floor_mm)
    rows, cells = np.nonzero(_rough(heights, samples.step_mm, chord_mm))
    finer = np.maximum(within(rows, cells), floor_mm)
    begins = np.searchsorted(rows, np.arange(len(heights) + 1))
    points, ends = np.empty((4 * (heights.size + finer.size), 2)), np.empty(len(heights), dtype=np.int64)
    kernels.lines(heights, begins, cells, finer, samples.start_mm, samples.step_mm, points, ends)
    return [points[a:b].copy() for a, b in pairwise((0, *ends.tolist()))]


def _rough(heights: FloatArray, step_mm: float, chord_mm: float) -> NDArray[np.bool_]:
    """Cells whose chords may stand off by more than a tolerance, by the second differences at their ends."""
    slope = np.abs(np.diff(heights, axis=1)) / step_mm
    bend = np.zeros_like(heights)
    least = np.minimum(slope[:, 1:], slope[:, :-1])
    bend[:, 1:-1] = np.abs(np.diff(heights, 2, axis=1)) / np.sqrt(1.0 + least**2)
    return np.asarray(np.maximum(bend[:, 1:], bend[:, :-1]) > 8.0 * chord_mm)
