"""Lengths and extreme coordinates of the motions in runs of plain lines, equal to those of single motions.

Sums and differences are numpy's; functions whose last bit counts are `math`'s, which differ from numpy's in it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gcode.bulk.plain_arcs import arctangent, hypot
from gcode.bulk.plain_batch import PlainBatch, motion_at
from gcode.events import PLANE_AXES, Point
from gcode.report.path_geometry import extremes_mm

Floats = NDArray[np.float64]

#: Directions in a plane, by axis and side, as angles from the plane's first axis.
_TURNS = ((0, 0.0, 1.0), (0, math.pi, -1.0), (1, math.pi / 2.0, 1.0), (1, -math.pi / 2.0, -1.0))
#: Error allowed for in estimates of an arc's extreme coordinates, mm, and of where they are, rad.
_ESTIMATE = 1e-6


class BatchPaths:
    """Paths of a run's n motions.

    Args:
        batch: the run.

    Attributes:
        start_mm: (n, 3) where each starts.
        end_mm: (n, 3) where each ends.
        length_mm: (n,) length of each path.
    """

    def __init__(self, batch: PlainBatch) -> None:
        self._batch = batch
        run = batch.run
        self.end_mm: Floats = run.end_mm
        self.start_mm: Floats = np.concatenate([[batch.start.position_mm], run.end_mm[:-1]])
        ends = list(zip(*(run.end_mm[:, axis].tolist() for axis in range(3)), strict=True))
        starts = [batch.start.position_mm, *ends[:-1]]
        self.length_mm: Floats = np.fromiter(map(math.dist, starts, ends), np.float64, len(ends))
        self._arcs = np.flatnonzero(run.code >= 2)
        if self._arcs.size:
            self._measure_arcs()

    def _measure_arcs(self) -> None:
        """Lengths of the arcs, as `path_geometry.length_mm` computes them."""
        arcs, run = self._arcs, self._batch.run
        i, j, normal = PLANE_AXES[self._batch.start.plane]
        start, end = (points[arcs] - run.centre_mm[arcs] for points in (self.start_mm, self.end_mm))
        self._begin, last = arctangent(start[:, j], start[:, i]), arctangent(end[:, j], end[:, i])
        turns = 2.0 * run.code[arcs] - 5.0
        one = (turns * (last - self._begin)) % (2.0 * math.pi)
        closed = (self.start_mm[arcs][:, (i, j)] == self.end_mm[arcs][:, (i, j)]).all(axis=1)
        self._sweep = turns * (np.where(closed | (one == 0.0), 2.0 * math.pi, one) + 0.0)
        self._radii = hypot(start[:, i], start[:, j]), hypot(end[:, i], end[:, j])
        first, second = self._radii
        growth = (second - first) / self._sweep
        rise = self.end_mm[arcs, normal] - self.start_mm[arcs, normal]
        along = hypot(growth, rise / self._sweep)
        parts = [hypot(radius, along) for radius in (first, (first + second) / 2.0, second)]
        self.length_mm[arcs] = np.abs(self._sweep) * (parts[0] + 4.0 * parts[1] + parts[2]) / 6.0

    def boxes(self, chosen: NDArray[np.bool_]) -> Iterator[tuple[Point, Point]]:
        """Boxes whose union is that of some of the motions: one of all their ends, and those of the outermost arcs.

        Args:
            chosen: (n,) True for the motions; at least one is.
        """
        low, high = self._ends_box(chosen)
        yield low, high
        if self._arcs.size:
            outer = self._outermost(chosen[self._arcs], low, high)
            for index in self._arcs[outer].tolist():
                yield extremes_mm(motion_at(self._batch, index))

    def _ends_box(self, chosen: NDArray[np.bool_]) -> tuple[Point, Point]:
        ends = [np.concatenate([self.start_mm[chosen, axis], self.end_mm[chosen, axis]]) for axis in range(3)]
        (x, y, z), (u, v, w) = ([float(side(axis)) for axis in ends] for side in (np.min, np.max))
        return (x, y, z), (u, v, w)

    def _outermost(self, chosen: NDArray[np.bool_], low: Point, high: Point) -> NDArray[np.intp]:
        """The arcs that may reach beyond the box of all ends as far as any other, by an estimate for circles."""
        first, second = self._radii
        radius, change = np.maximum(first, second), np.abs(second - first)
        swept_rad, sense = np.abs(self._sweep), np.sign(self._sweep)
        # a spiral turns back at another angle than a circle
        aside = np.arctan2(change / swept_rad, np.minimum(first, second)) + _ESTIMATE
        margin = change + _ESTIMATE
        found = np.zeros(chosen.size, dtype=np.bool_)
        for index, angle, side in _TURNS:
            axis = PLANE_AXES[self._batch.start.plane][index]
            swept = (sense * (angle - self._begin) + aside) % (2.0 * math.pi) - aside
            reach = side * self._batch.run.centre_mm[self._arcs, axis] + radius
            limit = high[axis] if side > 0.0 else -low[axis]
            certain = chosen & (swept >= aside) & (swept <= swept_rad - aside)
            furthest = np.max(reach - margin, where=certain, initial=limit)
            found |= chosen & (swept <= swept_rad + aside) & (reach + margin > furthest)
        return np.flatnonzero(found)
