"""Volume swept by a tool on a straight motion: its sections by planes, and whether points lie in it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells.strips import NO_TOPS, Strips, Tops
from twin.motion.section_kernels import Planes, section_nodes
from twin.motion.swept_kernels import GROUP, BodyShape, Fronts, Motion, Sweeps, outside_sweeps
from twin.tools.meridian import Meridian
from twin.tools.shape import ToolShape

#: Order of the coordinates (normal, u, v) of each slice family.
_ORDER = ((0, 1, 2), (1, 0, 2), (2, 0, 1))
#: No tool on whose surface points lie.
ANYWHERE = Fronts(Meridian(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), np.zeros((0, 3)), np.zeros(0, dtype=np.int32))
EMPTY_STRIPS = Strips(
    np.zeros(0, dtype=np.int64), np.zeros(1, dtype=np.int64), np.zeros((0, 3)), np.zeros(0, dtype=np.bool_)
)


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A convex body of revolution carried by the tool: the cutting part, the shank, a piece of the holder.

    Attributes:
        shape: the form that kernels take.
    """

    shape: BodyShape

    @classmethod
    def of(cls, shape: ToolShape, *, chord_mm: float = 0.0, above_tip_mm: float = 0.0) -> Body:
        """A shape ``above_tip_mm`` above the tip; with ``chord_mm`` the circumscribed one.

        The circumscribed corner arc keeps its centre, so its lowest point lies ``chord_mm`` below the tip; sections
        never reach below the tip's plane nevertheless.
        """
        enlarged = shape.circumscribed(chord_mm) if chord_mm > 0.0 else shape
        drop = chord_mm if shape.corner_radius_mm > 0.0 else 0.0
        return cls(BodyShape(enlarged.meridian, float(drop - above_tip_mm)))

    @property
    def top_mm(self) -> float:
        """Height of the body's top above the tool tip."""
        return self.shape.meridian.height - self.shape.drop

    @property
    def bottom_mm(self) -> float:
        """Height of the body's lowest point above the tool tip, not below the tip."""
        return max(0.0, -self.shape.drop)

    @property
    def radius_mm(self) -> float:
        """Largest radius."""
        return self.shape.meridian.radius


@dataclass(frozen=True, slots=True, eq=False)
class Sweep:
    """A body moving in a straight line from one tool tip position to another (which may be the same).

    Attributes:
        start_mm, end_mm: tool tip in the workpiece frame, shape (3,).
    """

    body: Body
    start_mm: FloatArray
    end_mm: FloatArray

    @property
    def length_mm(self) -> float:
        """Distance travelled."""
        along = self.end_mm - self.start_mm
        return math.sqrt(along.dot(along))

    @property
    def bounds_mm(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the swept volume's box."""
        r = self.body.radius_mm
        reach_low = np.array([-r, -r, self.body.bottom_mm])
        reach_high = np.array([r, r, self.body.top_mm])
        return (
            np.minimum(self.start_mm, self.end_mm) + reach_low,
            np.maximum(self.start_mm, self.end_mm) + reach_high,
        )

    def strips(
        self,
        axis: int,
        low_mm: float,
        pitch_mm: float,
        count: int,
        chord_mm: float,
        *,
        start_is_cut: bool = False,
        top_mm: float = math.inf,
        tops: Tops = NO_TOPS,
    ) -> Strips:
        """Sections by the planes of one slice family that the sweep may touch.

        Args:
            axis: 0, 1 or 2, the normal of the planes.
            low_mm, pitch_mm, count: planes at low + (k + 1/2) pitch, k from 0 to count - 1.
            chord_mm: how far a chord may deviate from the curve.
            start_is_cut: the volume at the start has been cut already, so that only the part that the motion adds
                need be right; the rest is marked as not fresh.
            top_mm: height above which there is no material.
            tops: heights of the material on the planes of `planes_met`, where they are known: sections are refined
                only where they meet it, and planes without any have none.
        """
        first, planes = self.planes_met(axis, low_mm, pitch_mm, count)
        if planes <= 0:
            return EMPTY_STRIPS
        cut = Planes(
            horizontal=axis == 2,
            first_w=float(low_mm + (first + 0.5) * pitch_mm),
            pitch=float(pitch_mm),
            planes=planes,
            chord=float(chord_mm),
            start_is_cut=start_is_cut,
            top=float(top_mm),
        )
        motion = self._motion(axis)
        return strips_by(lambda strips: section_nodes(self.body.shape, motion, cut, tops, strips), first, planes)

    def planes_met(self, axis: int, low_mm: float, pitch_mm: float, count: int) -> tuple[int, int]:
        """The first plane of a family that the sweep may touch, and how many, 0 or less for none; see `strips`."""
        return planes_between(self.bounds_mm, axis, low_mm, pitch_mm, count)

    def _motion(self, axis: int) -> Motion:
        """The tip's motion in the order (normal, u, v) of a slice family."""
        move = self.end_mm - self.start_mm
        w, u, v = ((float(self.start_mm[a]), float(move[a])) for a in _ORDER[axis])
        return Motion(*w, *u, *v)


def planes_between(
    bounds_mm: tuple[FloatArray, FloatArray], axis: int, low_mm: float, pitch_mm: float, count: int
) -> tuple[int, int]:
    """The first plane of a family that meets a box, and how many, 0 or less for none; see `Sweep.strips`."""
    low, high = bounds_mm
    first = max(0, math.ceil((low[axis] - low_mm) / pitch_mm - 0.5))
    last = min(count - 1, math.floor((high[axis] - low_mm) / pitch_mm - 0.5))
    return first, last - first + 1


def strips_by(fill: Callable[[Strips], int], first: int, planes: int) -> Strips:
    """Strips whose arrays a function fills; it returns the number of nodes, or -1 where they do not fit."""
    at, offsets = np.arange(first, first + planes), np.zeros(planes + 1, dtype=np.int64)
    room = 128 * planes + 2048
    while True:
        strips = Strips(at, offsets, np.empty((room, 3)), np.empty(room, dtype=np.bool_))
        written = fill(strips)
        if written >= 0:
            return Strips(at, offsets, strips.nodes[:written], strips.fresh[:written])
        room *= 2


class SweptVolume:
    """The union of several sweeps, ready for tests of many points.

    Args:
        behind_mm: see `Sweeps.behind`; None for bodies of any tools.
    """

    def __init__(self, sweeps: Sequence[Sweep], behind_mm: Sequence[float] | None = None) -> None:
        starts = np.array([s.start_mm for s in sweeps])
        ends = np.array([s.end_mm for s in sweeps])
        behind = np.full(len(sweeps), math.inf) if behind_mm is None else np.array(behind_mm, dtype=np.float64)
        self._sweeps = Sweeps(
            bodies=np.array([(*s.body.shape.meridian, s.body.shape.drop) for s in sweeps]),
            starts=starts,
            moves=ends - starts,
            behind=behind,
            boxes=_boxes(starts, ends),
            far=np.maximum.reduceat(behind, np.arange(0, len(sweeps), GROUP)) if len(sweeps) else behind,
        )

    def __len__(self) -> int:
        return len(self._sweeps.starts)

    def clear(
        self,
        points_mm: FloatArray,
        in_material: NDArray[np.bool_],
        depth_mm: float,
        counts: NDArray[np.int64] | None = None,
        fronts: Fronts = ANYWHERE,
    ) -> None:
        """Clear the flags of the points that lie deeper than ``depth_mm`` inside one of the sweeps, in place.

        Args:
            counts: shape (n,), how many of the sweeps, from the first, count for each point; None for all.
            fronts: the tool on whose surface the points lie, where that is known.
        """
        if len(self):
            if counts is None:
                counts = np.full(len(points_mm), len(self), dtype=np.int64)
            outside_sweeps(points_mm, in_material, counts, self._sweeps, depth_mm, fronts)


def _boxes(starts_mm: FloatArray, ends_mm: FloatArray) -> FloatArray:
    """Middle and half the size of the box about the tips of each group of sweeps, shape (groups, 6)."""
    if not len(starts_mm):
        return np.zeros((0, 6))
    groups = np.arange(0, len(starts_mm), GROUP)
    low = np.minimum.reduceat(np.minimum(starts_mm, ends_mm), groups)
    high = np.maximum.reduceat(np.maximum(starts_mm, ends_mm), groups)
    return np.hstack((0.5 * (low + high), 0.5 * (high - low)))
