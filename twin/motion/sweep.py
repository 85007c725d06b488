"""What a tool sweeps on a straight motion: its sections by planes, and whether points lie in it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells.strips import Strips
from twin.motion import kernels
from twin.tools.shape import ToolShape

#: Order of the coordinates (normal, u, v) of each slice family.
_ORDER = ((0, 1, 2), (1, 0, 2), (2, 0, 1))
_EMPTY = Strips(0, np.zeros(1, dtype=np.int64), np.zeros((0, 3)), np.zeros(0, dtype=np.bool_))


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A convex body of revolution carried by the tool: the cutting part, the shank, a piece of the holder.

    Attributes:
        parameters: shape (8,), the form that kernels take: `ToolShape.parameters` and how far the body's lowest point
            lies below the tool tip.
    """

    parameters: FloatArray

    @classmethod
    def of(cls, shape: ToolShape, *, chord_mm: float = 0.0, above_tip_mm: float = 0.0) -> Body:
        """A shape standing ``above_tip_mm`` over the tip; with ``chord_mm`` the circumscribed one.

        The circumscribed corner arc keeps its centre, so its lowest point lies ``chord_mm`` below the tip; sections
        never reach below the tip's plane all the same.
        """
        enlarged = shape.circumscribed(chord_mm) if chord_mm > 0.0 else shape
        drop = chord_mm if shape.corner_mm > 0.0 else 0.0
        return cls(np.append(enlarged.parameters, drop - above_tip_mm))

    @property
    def top_mm(self) -> float:
        """Height of the body's top above the tool tip."""
        return float(self.parameters[5] - self.parameters[7])

    @property
    def bottom_mm(self) -> float:
        """Height of the body's lowest point above the tool tip, not below the tip."""
        return max(0.0, -float(self.parameters[7]))

    @property
    def radius_mm(self) -> float:
        """Largest radius."""
        return float(self.parameters[6])


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
        return float(np.linalg.norm(self.end_mm - self.start_mm))

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

    def follows(self, earlier: Sweep | None) -> bool:
        """Whether this sweep begins where an earlier one of the same body ended."""
        return (
            earlier is not None
            and bool(np.array_equal(earlier.end_mm, self.start_mm))
            and bool(np.array_equal(earlier.body.parameters, self.body.parameters))
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
    ) -> Strips:
        """Sections by the planes of one slice family that the sweep may touch.

        Args:
            axis: 0, 1 or 2, the normal of the planes.
            low_mm, pitch_mm, count: planes at low + (k + 1/2) pitch, k from 0 to count - 1.
            chord_mm: how far a chord may stand off the curve.
            start_is_cut: the body's volume at the start has been cut already, so that only what the motion adds need
                be right; the rest is marked as not fresh.
            top_mm: height above which there is no material.
        """
        low, high = self.bounds_mm
        first = max(0, math.ceil((low[axis] - low_mm) / pitch_mm - 0.5))
        last = min(count - 1, math.floor((high[axis] - low_mm) / pitch_mm - 0.5))
        if last < first:
            return _EMPTY
        order = list(_ORDER[axis])
        start = self.start_mm[order]
        move = (self.end_mm - self.start_mm)[order]
        planes = last - first + 1
        offsets = np.zeros(planes + 1, dtype=np.int64)
        room = 128 * planes + 2048
        while True:
            nodes = np.empty((room, 3))
            fresh = np.empty(room, dtype=np.bool_)
            written = kernels.section_nodes(
                self.body.parameters,
                axis == 2,
                start,
                move,
                low_mm + (first + 0.5) * pitch_mm,
                pitch_mm,
                planes,
                chord_mm,
                start_is_cut,
                top_mm,
                offsets,
                nodes,
                fresh,
            )
            if written >= 0:
                return Strips(first, offsets, nodes[:written], fresh[:written])
            room *= 2


class SweptVolume:
    """The union of several sweeps, ready to be asked for many points."""

    def __init__(self, sweeps: Sequence[Sweep]) -> None:
        self._parameters = np.array([s.body.parameters for s in sweeps])
        self._starts = np.array([s.start_mm for s in sweeps])
        self._moves = np.array([s.end_mm - s.start_mm for s in sweeps])

    def __len__(self) -> int:
        return len(self._starts)

    def clear(
        self,
        points_mm: FloatArray,
        in_material: NDArray[np.bool_],
        depth_mm: float,
        counts: NDArray[np.int64] | None = None,
    ) -> None:
        """Clear the flags of the points that lie deeper than ``depth_mm`` inside one of the sweeps, in place.

        Args:
            counts: shape (n,), how many of the sweeps, from the first, each point is asked against; None for all.
        """
        if len(self._starts):
            if counts is None:
                counts = np.full(len(points_mm), len(self._starts), dtype=np.int64)
            kernels.outside_sweeps(
                points_mm, in_material, counts, self._parameters, self._starts, self._moves, depth_mm
            )
