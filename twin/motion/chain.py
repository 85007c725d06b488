"""Chains of sweeps: chords of an arc, cut together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from twin.arrays import FloatArray
from twin.geometry.column_cells.strips import Strips
from twin.motion.chain_kernels import ChainPlanes, chain_nodes
from twin.motion.sweep import EMPTY_STRIPS, Body, Sweep, planes_between, strips_by

#: Most sweeps of a chain.
_MOST = 128


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Sweeps of one body, each beginning where the one before ends, that go on in one direction along each axis.

    A line along any plane meets their union in one piece, so that one strip for each plane cuts all of them; on planes
    across the tool axis only above `settled_mm`.

    Attributes:
        corners_mm: shape (n + 1, 3), tool tips where sweeps begin and end.
    """

    body: Body
    corners_mm: FloatArray

    @property
    def start_mm(self) -> FloatArray:
        """Tool tip at the start, shape (3,)."""
        return np.asarray(self.corners_mm[0])

    @property
    def end_mm(self) -> FloatArray:
        """Tool tip at the end, shape (3,)."""
        return np.asarray(self.corners_mm[-1])

    @property
    def bounds_mm(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the swept volume's box."""
        return Sweep(self.body, self.start_mm, self.end_mm).bounds_mm

    @property
    def descends(self) -> bool:
        """Whether no sweep rises."""
        return bool(self.corners_mm[-1, 2] <= self.corners_mm[0, 2])

    @property
    def sweeps(self) -> list[Sweep]:
        """The sweeps one by one."""
        return [Sweep(self.body, start, end) for start, end in pairwise(self.corners_mm)]

    @property
    def settled_mm(self) -> float:
        """Height from which on level sections are in one piece.

        Near the tip the section of a ball, corner or taper grows from nothing while the chain goes up or down, so a
        line may meet it at the start and at the end of the chain and miss it between.
        """
        meridian = self.body.shape.meridian
        if meridian.arc_height <= 0.0 and meridian.tangent <= 0.0:
            return -math.inf
        rise = abs(float(self.end_mm[2] - self.start_mm[2]))
        return float(self.bounds_mm[0][2]) + 2.0 * rise if rise > 0.0 else -math.inf

    def strips(
        self,
        axis: int,
        low_mm: float,
        pitch_mm: float,
        count: int,
        chord_mm: float,
        *,
        from_plane: int = 0,
        start_is_cut: bool = False,
        end_is_left: bool = False,
        top_mm: float = math.inf,
        band_mm: float = math.inf,
    ) -> Strips:
        """Sections by the planes of one slice family, as `Sweep.strips` gives them.

        Args:
            from_plane: the first plane of the family to be cut.
            end_is_left: the volume at the end is left to the sweep that comes next; it is marked as not fresh.
            band_mm: height above the lower side up to which there may be material; less than 0 for none anywhere.
        """
        first, planes = planes_between(self.bounds_mm, axis, low_mm, pitch_mm, count)
        first, planes = max(first, from_plane), planes - max(0, from_plane - first)
        if planes <= 0 or band_mm < 0.0:
            return EMPTY_STRIPS
        cut = ChainPlanes(
            horizontal=axis == 2,
            first_w=float(low_mm + (first + 0.5) * pitch_mm),
            pitch=float(pitch_mm),
            planes=planes,
            chord=float(chord_mm),
            top=float(top_mm),
            start_is_cut=start_is_cut,
            end_is_left=end_is_left,
            band=float(band_mm),
        )
        order = [axis, *(a for a in range(3) if a != axis)]
        chords = np.empty((len(self.corners_mm) - 1, 6))
        chords[:, 0::2] = self.corners_mm[:-1, order]
        chords[:, 1::2] = np.diff(self.corners_mm, axis=0)[:, order]
        return strips_by(lambda strips: chain_nodes(self.body.shape, chords, cut, strips), first, planes)


class Moving(Protocol):
    """Motion of a body from a first to a last tool tip."""

    @property
    def body(self) -> Body:
        """The body."""

    @property
    def start_mm(self) -> FloatArray:
        """Tool tip at the start, shape (3,)."""

    @property
    def end_mm(self) -> FloatArray:
        """Tool tip at the end, shape (3,)."""


def follows(sweep: Moving, earlier: Moving | None) -> bool:
    """Whether a sweep begins where an earlier one of the same body ended."""
    return (
        earlier is not None
        and bool(np.array_equal(earlier.end_mm, sweep.start_mm))
        and earlier.body.shape == sweep.body.shape
    )


def chained(sweeps: Sequence[Sweep]) -> Iterator[Chain]:
    """Consecutive sweeps as chains as long as possible."""
    held: list[Sweep] = []
    sense = np.zeros(3)
    for sweep in sweeps:
        along = np.sign(sweep.end_mm - sweep.start_mm)
        if held and not (len(held) < _MOST and follows(sweep, held[-1]) and np.all(along * sense >= 0.0)):
            yield _chain(held)
            held, sense = [], np.zeros(3)
        held.append(sweep)
        sense = np.where(sense == 0.0, along, sense)
    if held:
        yield _chain(held)


def _chain(sweeps: Sequence[Sweep]) -> Chain:
    corners = np.array([sweeps[0].start_mm, *(sweep.end_mm for sweep in sweeps)])
    return Chain(sweeps[0].body, corners)
