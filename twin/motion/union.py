"""Unions of many sweeps of one tool: what a run of short motions takes, cut at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from twin.arrays import FloatArray
from twin.geometry.column_cells.strips import Bins, Strips
from twin.motion.envelope_kernels import NODES, STRIPS, UnionPlanes, envelope_strips
from twin.motion.level_union_kernels import level_strips
from twin.motion.sweep import EMPTY_STRIPS, Body, Sweep, planes_between


@dataclass(frozen=True, slots=True, eq=False)
class SweepUnion:
    """Sweeps of one body, in any order; all of them reach above the stock.

    Attributes:
        starts_mm, ends_mm: tool tips, shape (n, 3).
    """

    body: Body
    starts_mm: FloatArray
    ends_mm: FloatArray

    @classmethod
    def of(cls, sweeps: Sequence[Sweep]) -> SweepUnion:
        """The union of sweeps of one body, at least one."""
        return cls(sweeps[0].body, np.array([s.start_mm for s in sweeps]), np.array([s.end_mm for s in sweeps]))

    @property
    def start_mm(self) -> FloatArray:
        """Tool tip at the start of the first sweep, shape (3,)."""
        return np.asarray(self.starts_mm[0])

    @property
    def end_mm(self) -> FloatArray:
        """Tool tip at the end of the last sweep, shape (3,)."""
        return np.asarray(self.ends_mm[-1])

    @property
    def bounds_mm(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the swept volume's box."""
        low = np.minimum(self.starts_mm.min(axis=0), self.ends_mm.min(axis=0))
        high = np.maximum(self.starts_mm.max(axis=0), self.ends_mm.max(axis=0))
        radius = self.body.radius_mm
        reach_low = np.array([-radius, -radius, self.body.bottom_mm])
        return low + reach_low, high + np.array([radius, radius, self.body.top_mm])

    def reaches_above(self, top_mm: float) -> bool:
        """Whether the body reaches above a height all along."""
        lowest = min(float(self.starts_mm[:, 2].min()), float(self.ends_mm[:, 2].min()))
        return lowest + self.body.top_mm >= top_mm

    def planes_met(self, axis: int, low_mm: float, pitch_mm: float, count: int) -> tuple[int, int]:
        """The first plane of a family that the sweeps may touch, and how many, 0 or less for none."""
        return planes_between(self.bounds_mm, axis, low_mm, pitch_mm, count)

    def strips(
        self,
        axis: int,
        first_mm: float,
        pitch_mm: float,
        met: tuple[int, int],
        chord_mm: float,
        *,
        bins: Bins,
        top_mm: float,
        start_is_cut: bool = False,
    ) -> Strips:
        """Sections by planes of one slice family, where there is material.

        Args:
            axis: 0, 1 or 2, the normal of the planes.
            first_mm, pitch_mm: position of the family's plane 0, and the distance of planes.
            met: the first plane and how many; see `planes_met`.
            chord_mm: how far a chord may deviate from the curve.
            bins: material on these planes.
            top_mm: height above all material.
            start_is_cut: the volume at the start of the first sweep has been cut already.
        """
        first, planes = met
        if planes <= 0:
            return EMPTY_STRIPS
        cut = UnionPlanes(
            first_w=float(first_mm + first * pitch_mm),
            pitch=float(pitch_mm),
            planes=planes,
            chord=float(chord_mm),
            top=float(top_mm),
            start_is_cut=start_is_cut,
        )
        order = [axis, *(a for a in range(3) if a != axis)]
        sweeps = np.empty((len(self.starts_mm), 6))
        sweeps[:, 0::2] = self.starts_mm[:, order]
        sweeps[:, 1::2] = (self.ends_mm - self.starts_mm)[:, order]
        fill = level_strips if axis == 2 else envelope_strips
        room, used = 64 * planes + 4096, np.zeros(2, dtype=np.int64)
        while True:
            strips = _empty(room)
            if fill(self.body.shape, sweeps, cut, bins, strips, used):
                n, nodes = int(used[STRIPS]), int(used[NODES])
                return Strips(
                    strips.at[:n] + first, strips.offsets[: n + 1], strips.nodes[:nodes], strips.fresh[:nodes]
                )
            room *= 2


def _empty(room: int) -> Strips:
    return Strips(
        np.zeros(room, dtype=np.int64),
        np.zeros(room + 1, dtype=np.int64),
        np.empty((room, 3)),
        np.empty(room, dtype=np.bool_),
    )
