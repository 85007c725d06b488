"""Parts of the cutting edges in the material at a position of the tool.

The front of the tool (n.f > 0) is tested at every angle of a map about the axis. A convex tool on a straight motion
never reaches a front point of its present position before (its earlier positions all lie behind the tangent plane
there), so points are tested against the workpiece as it was before the motion began: no step's own crescent can be
missed or counted twice.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cutting import engagement_kernels as kernels
from twin.cutting.edge_arrays import EdgeArrays, RowAngles
from twin.geometry.column_cells.strips import HeightMap
from twin.motion.sweep import SweptVolume
from twin.motion.swept_kernels import Fronts
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
        share: shape (rows, elements), 0 to 1; row j is at the angle j 2 pi / rows counter-clockwise from +x.
            Elements are counted from the lowest; those above the stock are omitted.
        turn: shape (rows, elements), where between row j and the next an element changes from engaged to free or back.
        summary: extent of the engagement.
    """

    share: FloatArray
    turn: FloatArray
    summary: Engagement


@dataclass(frozen=True, slots=True, eq=False)
class EngagementMaps:
    """Maps of several positions.

    Attributes:
        share, turn: shape (positions, rows, elements), as those of an `EngagementMap`.
        summaries: extent of each engagement, `NO_ENGAGEMENT` in air.
    """

    share: FloatArray
    turn: FloatArray
    summaries: tuple[Engagement, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Positions:
    """Tool positions to be solved together.

    Attributes:
        tip_mm: shape (n, 3), tool tips.
        feed: shape (n, 3), unit feed directions.
        feed_mm_s: shape (n,), feeds along the path.
        feed_per_tooth_mm: shape (n,).
        waiting: shape (n,), number of pending sweeps, from the first, before each position.
    """

    tip_mm: FloatArray
    feed: FloatArray
    feed_mm_s: FloatArray
    feed_per_tooth_mm: FloatArray
    waiting: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.tip_mm)

    def part(self, first: int, last: int) -> Positions:
        """Positions ``first`` to ``last - 1``."""
        at = slice(first, last)
        return Positions(
            self.tip_mm[at], self.feed[at], self.feed_mm_s[at], self.feed_per_tooth_mm[at], self.waiting[at]
        )

    def take(self, numbers: Sequence[int]) -> Positions:
        """Positions by their numbers."""
        at = np.asarray(numbers, dtype=np.intp)
        return Positions(
            self.tip_mm[at], self.feed[at], self.feed_mm_s[at], self.feed_per_tooth_mm[at], self.waiting[at]
        )


class Prepared(NamedTuple):
    """Heights of the material about positions, by the planes across x and across y, if they are known."""

    known: bool
    over_x: HeightMap
    over_y: HeightMap


#: Heights of the material are worth finding where this part of the front is above it; elsewhere they are tried again
#: at every call of this number.
_WORTH, _WITHOUT = 0.3, 16
#: Material may be anywhere.
_ANY_HEIGHT = HeightMap(np.full((1, 1), math.inf), -1e12, -1e12, 5e-13, 5e-13)


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
        self._rows, self._edge_arrays = row_angles(rows), edge_arrays(edges)
        end_edge = edges.kappa_rad == 0.0
        self._gate = np.where(end_edge, math.sin(math.radians(DISH_DEG)), tolerance.gate)
        self._worth, self._without = True, 0
        self._middle = 0.5 * (edges.bounds_mm[:-1] + edges.bounds_mm[1:])

    @property
    def entries(self) -> int:
        """Entries of one map over the whole cutting part: rows times edge elements."""
        return self._rows.cos.size * self._edges.z_mm.size

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
                subtracted from its slices yet and are excluded exactly.
        """
        at = Positions(
            tip_mm[None, :],
            feed[None, :],
            np.array([feed_mm_s]),
            np.array([feed_per_tooth_mm]),
            np.array([len(pending)], dtype=np.int64),
        )
        found = self.engage_all(at, workpiece, pending, self.prepare(at, workpiece), Scratch())
        if found is None or not found.summaries[0].cutting:
            return None
        return EngagementMap(found.share[0], found.turn[0], found.summaries[0])

    def prepare(self, at: Positions, workpiece: TriSlices) -> Prepared:
        """Make the workpiece ready for `engage_all` at these positions."""
        radius, top = self._shape.max_radius_mm, workpiece.high_mm[2]
        reach = np.array([radius, radius, 0.0])
        low, high = at.tip_mm.min(axis=0) - reach, at.tip_mm.max(axis=0) + reach
        high[2] = top
        if low[2] < top:
            workpiece.prepare(low, high)
        self._without = 0 if self._worth else (self._without + 1) % _WITHOUT
        if self._enough == 1 or low[2] >= top or self._without > 0:
            return Prepared(False, _ANY_HEIGHT, _ANY_HEIGHT)
        return Prepared(True, workpiece.height_map(0, low, high), workpiece.height_map(1, low, high))

    def engage_all(
        self, at: Positions, workpiece: TriSlices, pending: SweptVolume, prepared: Prepared, scratch: Scratch
    ) -> EngagementMaps | None:
        """The engagement at each of several positions, None where all are in air; threads may share it.

        Args:
            at: positions for which `prepare` was called, in any order.
            prepared: its answer.
            scratch: memory of the calling thread. The maps are in it until it is used again.
        """
        reach = min(float(workpiece.high_mm[2]), self._top_mm(at, prepared)) - float(at.tip_mm[:, 2].min())
        if not reach > 0.0:
            return None
        elements = min(len(self._edges.z_mm), int(np.searchsorted(self._edges.z_mm, reach)) + 1)
        status = scratch.array("status", np.int8, len(at), len(self._rows.cos), elements)
        if not self._test_front(at, workpiece, pending, status, prepared, scratch):
            return None
        share, turn = self._boundaries(at, workpiece, pending, status, scratch)
        return EngagementMaps(share, turn, self._summaries(at, status, share, turn))

    def _top_mm(self, at: Positions, prepared: Prepared) -> float:
        """Height of the material about positions; -inf where there is none."""
        radius = self._shape.max_radius_mm
        low, high = at.tip_mm[:, :2].min(axis=0) - radius, at.tip_mm[:, :2].max(axis=0) + radius
        return max(
            _highest(prepared.over_x, low[0], high[0], low[1], high[1]),
            _highest(prepared.over_y, low[1], high[1], low[0], high[0]),
        )

    def _test_front(
        self,
        at: Positions,
        workpiece: TriSlices,
        pending: SweptVolume,
        status: NDArray[np.int8],
        prepared: Prepared,
        scratch: Scratch,
    ) -> bool:
        """Fill the status maps; returns whether any point is engaged."""
        points = scratch.array("points", np.float64, status.size, 3)
        entries = scratch.array("entries", np.int32, status.size)
        count, above = kernels.front_points(
            kernels.Front(at.tip_mm, at.feed, self._gate, *prepared),
            self._rows,
            self._edge_arrays,
            status,
            points,
            entries,
        )
        if prepared.known:
            # that changes how fast the next answers are found, not what they are
            self._worth = above > _WORTH * (above + count)
        points, entries = points[:count], entries[:count]
        steps = entries // status[0].size if len(pending) else entries
        inside = self._in_material(points, steps, at, workpiece, pending)
        return bool(kernels.mark(entries, inside, status.reshape(-1)))

    def _in_material(
        self,
        points: FloatArray,
        steps: NDArray[np.int32],
        at: Positions,
        workpiece: TriSlices,
        pending: SweptVolume,
    ) -> NDArray[np.bool_]:
        """Which points are in material.

        Args:
            steps: shape (n,), the position that each point belongs to; only used where sweeps are pending.
        """
        if self._enough == 1:
            votes = np.zeros(len(points), dtype=np.int8)
            workpiece.count_votes(points, 1, votes)
            inside = votes > 0
        else:
            inside = workpiece.most_contain(points)
        if len(pending):
            fronts = Fronts(self._shape.meridian, at.tip_mm, steps)
            pending.clear(points, inside, self._tolerance.depth_mm, at.waiting[steps], fronts)
        return np.asarray(inside)

    def _boundaries(
        self, at: Positions, workpiece: TriSlices, pending: SweptVolume, status: NDArray[np.int8], scratch: Scratch
    ) -> tuple[FloatArray, FloatArray]:
        """Engaged share of each element, and where between two rows each changes between engaged and free."""
        found = scratch.array("found", np.int32, 2 * status.size, 3)
        split = kernels.transitions(status, found)
        found = found[: kernels.turns(status, split, found)]
        part = self._halve(found, split, at, workpiece, pending, status)
        share = scratch.array("share", np.float64, *status.shape)
        kernels.weights(status, self._edges.bounds_mm, found[:split], self._along(found[:split], part[:split]), share)
        turn = scratch.array("turn", np.float64, *status.shape)
        turn.fill(0.5)
        turn[found[split:, 0], found[split:, 1], found[split:, 2]] = part[split:]
        return share, turn

    def _along(self, found: NDArray[np.int32], part: FloatArray) -> FloatArray:
        """Lengths along the meridian, at a fraction between the middles of an element and the next."""
        first = self._middle[found[:, 2]]
        return np.asarray(first + part * (self._middle[found[:, 2] + 1] - first))

    def _halve(
        self,
        found: NDArray[np.int32],
        split: int,
        at: Positions,
        workpiece: TriSlices,
        pending: SweptVolume,
        status: NDArray[np.int8],
    ) -> FloatArray:
        """Where, from 0 to 1, the material ends between the two neighbours of each boundary in ``found``."""
        low, high = np.zeros(len(found)), np.ones(len(found))
        points = np.empty((len(found), 3))
        first, steps = status[found[:, 0], found[:, 1], found[:, 2]] == 1, np.ascontiguousarray(found[:, 0])
        for _ in range(_HALVINGS if len(found) else 0):
            part = 0.5 * (low + high)
            on = meridian(self._shape, self._along(found[:split], part[:split]))
            kernels.boundary_points(
                at.tip_mm,
                kernels.Boundaries(found, split, part),
                on.radius_mm,
                on.height_mm,
                self._rows,
                self._edge_arrays,
                points,
            )
            kernels.narrow(self._in_material(points, steps, at, workpiece, pending), first, low, high)
        return 0.5 * (low + high)

    def _summaries(
        self, at: Positions, status: NDArray[np.int8], share: FloatArray, turn: FloatArray
    ) -> tuple[Engagement, ...]:
        out = np.empty((len(at), kernels.SUMMARY_ENTRIES))
        kernels.summarise(share, turn, status, at.feed, self._rows, self._edge_arrays, out)
        row_rad = 2.0 * math.pi / len(self._rows.cos)
        given = zip(out.tolist(), at.feed_mm_s.tolist(), at.feed_per_tooth_mm.tolist(), strict=True)
        return tuple(_summary(values, row_rad, feed_mm_s, chip_mm) for values, feed_mm_s, chip_mm in given)


def _highest(over: HeightMap, w0: float, w1: float, u0: float, u1: float) -> float:
    """Highest material of a map in a rectangle; -inf without any."""
    first, last = (math.floor((w - over.w_low) * over.per_w) for w in (w0, w1))
    begin, end = (math.floor((u - over.u_low) * over.per_u) for u in (u0, u1))
    part = over.heights[max(0, first) : max(0, last + 1), max(0, begin) : max(0, end + 1)]
    return float(part.max()) if part.size else -math.inf


def _summary(values: list[float], row_rad: float, feed_mm_s: float, feed_per_tooth_mm: float) -> Engagement:
    """The result of `kernels.summarise` as a record."""
    if values[kernels.ARC] == 0.0:
        return NO_ENGAGEMENT
    return Engagement(
        axial_depth_mm=values[kernels.Z_HIGH] - values[kernels.Z_LOW],
        radial_width_mm=values[kernels.SIDE_HIGH] - values[kernels.SIDE_LOW],
        arc_rad=values[kernels.ARC] * row_rad,
        chip_thickness_mm=values[kernels.NF_MAX] * feed_per_tooth_mm,
        removal_rate_mm3_s=values[kernels.FRONT_AREA] * feed_mm_s,
        cutting=True,
    )


def row_angles(rows: int) -> RowAngles:
    """Cosine and sine of the rows of a map."""
    theta = np.arange(rows) * (2.0 * math.pi / rows)
    return RowAngles(np.cos(theta), np.sin(theta))


def edge_arrays(edges: CuttingEdges) -> EdgeArrays:
    """Edge elements as kernels take them."""
    return EdgeArrays(
        edges.radius_mm, edges.z_mm, np.cos(edges.kappa_rad), np.sin(edges.kappa_rad), edges.element_length_mm
    )


class Scratch:
    """Memory that one thread uses again and again."""

    def __init__(self) -> None:
        self._arrays: dict[str, NDArray[Any]] = {}

    def array(self, name: str, dtype: type[np.generic], *shape: int) -> NDArray[Any]:
        """An array of that name, type and shape; it still holds the values of its last use."""
        size = math.prod(shape)
        held = self._arrays.get(name)
        if held is None or held.size < size:
            held = self._arrays[name] = np.empty(size, dtype=dtype)
        return held[:size].reshape(shape)
