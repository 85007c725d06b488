"""Values over machine time in a fixed number of equal parts, filled step by step."""

from __future__ import annotations

import math

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from twin.arrays import FloatArray
from twin.record import Step

#: Parts of the machine time; a page is not much wider in pixels.
COLUMNS = 1000
_SIZE = 4


class TimeBins:
    """Extremes of forces and engagement in equal parts of the machine time.

    Attributes:
        end_s: machine time at the end of the last part.
        low_n, high_n: shape (COLUMNS, 4), least and largest Fx, Fy, Fz and resultant; NaN without samples.
        power_w: shape (COLUMNS,), largest power; NaN without samples.
        turn_s: longest revolution of the spindle in cut.
        axial_mm, radial_mm, chip_mm: shape (COLUMNS,), largest axial and radial depth of cut and uncut chip
            thickness, 0 in air.
    """

    def __init__(self, end_s: float) -> None:
        self.end_s = max(end_s, 1e-9)
        self.low_n = np.full((COLUMNS, _SIZE), np.nan)
        self.high_n = np.full((COLUMNS, _SIZE), np.nan)
        self.power_w = np.full(COLUMNS, np.nan)
        self.turn_s = 0.0
        self.axial_mm, self.radial_mm, self.chip_mm = (np.zeros(COLUMNS) for _ in range(3))

    @property
    def t_s(self) -> FloatArray:
        """Machine time in the middle of each part, shape (COLUMNS,)."""
        return np.linspace(0.5, COLUMNS - 0.5, COLUMNS, dtype=np.float64) * (self.end_s / COLUMNS)

    def add(self, step: Step, resultant_n: FloatArray) -> None:
        """Take one step.

        Args:
            resultant_n: shape (n,), of its samples.
        """
        if step.engagement.cutting:
            self._add_engagement(step)
        if not len(resultant_n):
            return
        at = self._columns(step.samples.t_s)
        firsts = np.flatnonzero(np.diff(at, prepend=-1))
        rows = at[firsts]
        values = np.column_stack((step.samples.force_n, resultant_n))
        self.low_n[rows] = np.fmin(self.low_n[rows], np.minimum.reduceat(values, firsts))
        self.high_n[rows] = np.fmax(self.high_n[rows], np.maximum.reduceat(values, firsts))
        self.power_w[rows] = np.fmax(self.power_w[rows], np.maximum.reduceat(step.samples.power_w, firsts))

    def envelope(self, low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Least and largest value within a revolution about each part, so that parts shorter than that show no teeth.

        Args:
            low, high: shape (COLUMNS,), extremes of each part, NaN without samples.
        """
        size = 1 + 2 * min(math.ceil(0.5 * self.turn_s * COLUMNS / self.end_s), COLUMNS)
        if self.turn_s <= self.end_s / COLUMNS:
            return low, high
        least = minimum_filter1d(np.where(np.isnan(low), np.inf, low), size, mode="nearest")
        most = maximum_filter1d(np.where(np.isnan(high), -np.inf, high), size, mode="nearest")
        none = np.isinf(least) | np.isinf(most)
        return np.where(none, np.nan, least), np.where(none, np.nan, most)

    def _add_engagement(self, step: Step) -> None:
        if step.spindle_rpm:
            self.turn_s = max(self.turn_s, 60.0 / abs(step.spindle_rpm))
        first, last = self._columns(np.array([step.t_s, step.t_s + step.duration_s]))
        part = slice(first, last + 1)
        engagement = step.engagement
        for kept, value in (
            (self.axial_mm, engagement.axial_depth_mm),
            (self.radial_mm, engagement.radial_width_mm),
            (self.chip_mm, engagement.chip_thickness_mm),
        ):
            np.maximum(kept[part], value, out=kept[part])

    def _columns(self, t_s: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
        return np.minimum((t_s * (COLUMNS / self.end_s)).astype(np.int64), COLUMNS - 1)
