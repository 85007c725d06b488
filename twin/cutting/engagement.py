"""Which parts of the cutting edges are in the material at one position of the tool.

The front of the tool (n.f > 0) is asked at every angle of a map about the tool axis. A convex tool on a straight motion
never reaches a front point of its present position before (its earlier positions all lie behind the tangent plane
there), so points are asked against the workpiece as it was before the motion began: no step's own crescent can be
missed or counted twice.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cutting import kernels
from twin.motion.sweep import SweptVolume
from twin.record import Engagement
from twin.tolerance import Tolerance
from twin.tools.edges import CuttingEdges, meridian
from twin.tools.shape import ToolShape
from twin.workpiece.trislice import TriSlices

#: ``majority``: two of the three nearest slices must have material at a point. ``any``: one (the tri-slice paper).
EngagementRule: TypeAlias = Literal["majority", "any"]

#: End edges of flat-bottomed tools rise towards the axis by about this much, so that shallower ramps do not use them.
DISH_DEG = 2.0
_HALVINGS = 5
NO_ENGAGEMENT = Engagement()


@dataclass(frozen=True, slots=True, eq=False)
class EngagementMap:
    """Engaged shares of the edge elements about the tool axis.

    Attributes:
        share: shape (rows, elements), 0 to 1; row j stands at the angle j 2 pi / rows counter-clockwise from +x.
        turn: shape (rows, elements), where between row j and the next an element changes from engaged to free or back.
        elements: number of elements, from the lowest, that can be engaged; the rest are above the stock.
        summary: extent of the engagement.
    """

    share: FloatArray
    turn: FloatArray
    elements: int
    summary: Engagement


class Engager:
    """Finds the engagement of one tool, position by position.

    Args:
        rows: angles of the map, 360 for one degree.
        rule: how the three slice families decide.
    """

    def __init__(
        self, shape: ToolShape, edges: CuttingEdges, rows: int, rule: EngagementRule, tolerance: Tolerance
    ) -> None:
        self._shape = shape
        self._edges = edges
        self._enough = 1 if rule == "any" else 2
        self._tolerance = tolerance
        theta = np.arange(rows) * (2.0 * math.pi / rows)
        self._cos_theta, self._sin_theta = np.cos(theta), np.sin(theta)
        self._cos_kappa, self._sin_kappa = np.cos(edges.kappa_rad), np.sin(edges.kappa_rad)
        end_edge = edges.kappa_rad == 0.0
        self._gate = np.where(end_edge, math.sin(math.radians(DISH_DEG)), tolerance.gate)
        n = len(edges.z_mm)
        self._status = np.full((rows, n), -1, dtype=np.int8)
        self._points = np.empty((rows * n, 3))
        self._places = np.empty((rows * n, 2), dtype=np.int64)

    def engage(
        self,
        tip_mm: FloatArray,
        feed: FloatArray,
        feed_mm_s: float,
        feed_per_tooth_mm: float,
        workpiece: TriSlices,
        pending: SweptVolume,
    ) -> EngagementMap | None:
        """The engagement at one tool position, or None in air.

        Args:
            tip_mm: tool tip, shape (3,).
            feed: unit feed direction, shape (3,).
            workpiece: the material before the present motion, less ``pending``: earlier sweeps that have not been
                subtracted from its slices yet and are left out exactly.
        """
        reach = float(workpiece.high_mm[2] - tip_mm[2])
        elements = min(len(self._edges.z_mm), int(np.searchsorted(self._edges.z_mm, reach)) + 1)
        if reach <= 0.0:
            return None
        count = kernels.front_points(
            tip_mm,
            feed,
            self._cos_theta,
            self._sin_theta,
            self._edges.radius_mm,
            self._edges.z_mm,
            self._cos_kappa,
            self._sin_kappa,
            elements,
            self._gate,
            self._status,
            self._points,
            self._places,
        )
        radius = self._shape.max_radius_mm
        workpiece.prepare(tip_mm - np.array([radius, radius, 0.0]), tip_mm + np.array([radius, radius, reach]))
        places = self._places[:count]
        inside = self._in_material(self._points[:count], workpiece, pending)
        if not inside.any():
            return None
        kernels.mark(places, inside, self._status)
        asked = (tip_mm, elements, workpiece, pending)
        share, turn = self._shares(*asked), self._turns(*asked)
        summary = self._summary(share, turn, elements, feed, feed_mm_s, feed_per_tooth_mm)
        return EngagementMap(share, turn, elements, summary)

    def _in_material(self, points: FloatArray, workpiece: TriSlices, pending: SweptVolume) -> NDArray[np.bool_]:
        votes = np.zeros(len(points), dtype=np.int8)
        if len(points):
            workpiece.count_votes(points, self._enough, votes)
        inside = votes >= self._enough
        if inside.any():
            pending.clear(points, inside, self._tolerance.depth_mm)
        return np.asarray(inside)

    def _shares(self, tip: FloatArray, elements: int, workpiece: TriSlices, pending: SweptVolume) -> FloatArray:
        """Engaged share of each element, from where along the meridian the material ends."""
        found = np.empty((len(self._cos_theta) * elements, 2), dtype=np.int64)
        found = found[: kernels.transitions(self._status, elements, found)]
        rows, columns = found[:, 0], found[:, 1]
        middle = 0.5 * (self._edges.bounds_mm[:-1] + self._edges.bounds_mm[1:])
        after = np.minimum(columns + 1, len(middle) - 1)

        def points(part: FloatArray) -> FloatArray:
            at = meridian(self._shape, middle[columns] + part * (middle[after] - middle[columns]))
            x, y = at.radius_mm * self._cos_theta[rows], at.radius_mm * self._sin_theta[rows]
            return np.column_stack((x, y, at.height_mm)) + tip

        part = self._halve(points, found, workpiece, pending)
        share = np.zeros((len(self._cos_theta), elements))
        boundary = middle[columns] + part * (middle[after] - middle[columns])
        kernels.weights(self._status, elements, self._edges.bounds_mm, found, boundary, share)
        return share

    def _turns(self, tip: FloatArray, elements: int, workpiece: TriSlices, pending: SweptVolume) -> FloatArray:
        """Where between two rows an element changes between engaged and free, as a part of the way."""
        found = np.empty((len(self._cos_theta) * elements, 2), dtype=np.int64)
        found = found[: kernels.turns(self._status, elements, found)]
        rows, columns = found[:, 0], found[:, 1]
        step = 2.0 * math.pi / len(self._cos_theta)
        radius, height = self._edges.radius_mm[columns], self._edges.z_mm[columns]

        def points(part: FloatArray) -> FloatArray:
            theta = (rows + part) * step
            return np.column_stack((radius * np.cos(theta), radius * np.sin(theta), height)) + tip

        turn = np.full((len(self._cos_theta), elements), 0.5)
        turn[rows, columns] = self._halve(points, found, workpiece, pending)
        return turn

    def _halve(
        self,
        points: Callable[[FloatArray], FloatArray],
        found: NDArray[np.int64],
        workpiece: TriSlices,
        pending: SweptVolume,
    ) -> FloatArray:
        """Where, from 0 to 1, the material ends between the two elements of each pair in ``found``."""
        low, high = np.zeros(len(found)), np.ones(len(found))
        if len(found) == 0:
            return low
        low_in = self._status[found[:, 0], found[:, 1]] == 1
        for _ in range(_HALVINGS):
            part = 0.5 * (low + high)
            same = self._in_material(points(part), workpiece, pending) == low_in
            low, high = np.where(same, part, low), np.where(same, high, part)
        return 0.5 * (low + high)

    def _summary(
        self,
        share: FloatArray,
        turn: FloatArray,
        elements: int,
        feed: FloatArray,
        feed_mm_s: float,
        feed_per_tooth_mm: float,
    ) -> Engagement:
        out = np.empty(7)
        kernels.summarise(
            share,
            turn,
            self._status,
            elements,
            feed,
            self._cos_theta,
            self._sin_theta,
            self._edges.radius_mm,
            self._edges.z_mm,
            self._cos_kappa,
            self._sin_kappa,
            self._edges.length_mm,
            out,
        )
        if out[kernels.ARC] == 0.0:
            return NO_ENGAGEMENT
        return Engagement(
            axial_depth_mm=float(out[kernels.Z_HIGH] - out[kernels.Z_LOW]),
            radial_width_mm=float(out[kernels.SIDE_HIGH] - out[kernels.SIDE_LOW]),
            arc_rad=float(out[kernels.ARC] * 2.0 * math.pi / len(self._cos_theta)),
            chip_thickness_mm=float(out[kernels.NF_MAX] * feed_per_tooth_mm),
            removal_rate_mm3_s=float(out[kernels.FRONT_AREA] * feed_mm_s),
            cutting=True,
        )
