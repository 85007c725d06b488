"""Rays along x, y and z through the design and the machined part, in the planes of the slices.

Sections of the machined part are exact in the planes of the slices, and so are those of the design. The points where a
ray enters or leaves either of them are therefore exact too. Only details between rays are not detected.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.mesh.slicing import mesh_sections
from twin.geometry.polygons.lines import LineEnds, ring_line_ends
from twin.workpiece.solids.from_mesh import Solid
from twin.workpiece.stock import plane_positions
from twin.workpiece.store import PLANE_AXES
from twin.workpiece.trislice import TriSlices

#: For rays along x, y, z: the family of planes that they lie in, and which in-plane coordinate is constant on them.
_PLANES: tuple[tuple[int, int], ...] = ((2, 1), (0, 1), (1, 0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rays:
    """Rays along one axis through two bodies.

    Attributes:
        axis: 0, 1, 2 for rays along x, y, z.
        across: the two other axes.
        positions_mm: positions of the rays on these axes, shape (rays, 2).
        machined, design: points where the rays enter and leave.
        area_mm2: cross-sectional area that each ray represents.
    """

    axis: int
    across: tuple[int, int]
    positions_mm: FloatArray
    machined: LineEnds
    design: LineEnds
    area_mm2: float

    def facing(self, store: TriSlices) -> FloatArray:
        """Component of the machined surface's normal along the ray at each of its ends, 0 to 1, shape (n,).

        The slopes of the boundary in both families of planes that hold the ray give the normal; where the two disagree
        on the number of ends, the second slope counts as 0.
        """
        family, other = self.across
        at = [plane_positions(store.low_mm, store.pitch_mm, a, store.count(a)) for a in (family, other)]
        window = (float(store.low_mm[self.axis]) - 1.0, float(store.high_mm[self.axis]) + 1.0)
        fixed = PLANE_AXES[other].index(family)
        second = store.line_ends(other, np.arange(len(at[1])), fixed, at[0], window)
        # that of ray (i, j) is line j n + i there
        turned = np.arange(len(self.positions_mm)).reshape(len(at[1]), len(at[0])).T.ravel()
        counts, here = np.diff(second.offsets)[turned], np.diff(self.machined.offsets)
        same = np.repeat(counts == here, here)
        ends = np.arange(len(self.machined.ends_mm)) - np.repeat(self.machined.offsets[:-1], here)
        index = np.where(same, np.repeat(second.offsets[:-1][turned], here) + ends, 0)
        across = np.where(same, second.slopes[index], 0.0) if len(second.slopes) else 0.0
        return np.asarray(1.0 / np.sqrt(1.0 + self.machined.slopes**2 + across**2))

    def volumes_mm3(self, store: TriSlices, low_mm: FloatArray, high_mm: FloatArray) -> tuple[float, float]:
        """Volume of the machined part outside the design, and of the design outside the machined part.

        Args:
            low_mm, high_mm: corners of the box that both are limited to, shape (3,), with the stock's box.
        """
        low, high = np.maximum(low_mm, store.low_mm), np.minimum(high_mm, store.high_mm)
        half = 0.5 * store.pitch_mm[list(self.across)]
        inner, outer = low[list(self.across)], high[list(self.across)]
        # the part of each ray's cell inside the box
        cell = np.minimum(self.positions_mm + half, outer) - np.maximum(self.positions_mm - half, inner)
        weight = np.prod(np.clip(cell, 0.0, None), axis=1)
        both = (self.machined, self.design)
        rays = np.concatenate([np.repeat(np.arange(len(weight)), np.diff(ends.offsets)) for ends in both])
        at = np.clip(np.concatenate([ends.ends_mm for ends in both]), low[self.axis], high[self.axis])
        own = np.arange(len(rays)) < len(self.machined.ends_mm)
        order = np.lexsort((at, rays))
        rays, at, own = rays[order], at[order], own[order]
        inside, wanted = np.cumsum(own) % 2 == 1, np.cumsum(~own) % 2 == 1
        length = np.where(rays[1:] == rays[:-1], np.diff(at), 0.0) * weight[rays[:-1]]
        left, gone = (float(length[(a & ~b)[:-1]].sum()) for a, b in ((inside, wanted), (wanted, inside)))
        return left, gone

    def points(self, ends: LineEnds) -> tuple[FloatArray, NDArray[np.int64], FloatArray]:
        """Ends as points, shape (n, 3), the ray of each, and the direction out of the material there, -1 or +1."""
        rays = np.repeat(np.arange(len(self.positions_mm)), np.diff(ends.offsets))
        points = np.empty((len(rays), 3))
        points[:, self.across] = self.positions_mm[rays]
        points[:, self.axis] = ends.ends_mm
        out = np.where((np.arange(len(rays)) - ends.offsets[rays]) % 2 == 0, -1.0, 1.0)
        return points, rays, out


def cast(store: TriSlices, design: Solid) -> Iterator[Rays]:
    """Rays along x, y and z, at the planes of the other two families of slices."""
    for axis, (family, fixed) in enumerate(_PLANES):
        u, v = PLANE_AXES[family]
        other = (u, v)[fixed]
        planes = plane_positions(store.low_mm, store.pitch_mm, family, store.count(family))
        at = plane_positions(store.low_mm, store.pitch_mm, other, store.count(other))
        window = (float(store.low_mm[axis]) - 1.0, float(store.high_mm[axis]) + 1.0)
        machined = store.line_ends(family, np.arange(len(planes)), fixed, at, window)
        sections = mesh_sections(design.vertices_mm, design.triangles, design.edges, (family, u, v), planes)
        positions = np.column_stack((np.repeat(planes, len(at)), np.tile(at, len(planes))))
        yield Rays(
            axis=axis,
            across=(family, other),
            positions_mm=positions,
            machined=machined,
            design=ring_line_ends((r.rings for r in sections), fixed, at),
            area_mm2=float(store.pitch_mm[family] * store.pitch_mm[other]),
        )


def beyond(rays: Rays) -> FloatArray:
    """How far the machined part extends beyond each end of the design, along the ray.

    Returns:
        shape (n,), mm; positive where material is left on the design, negative where the design is missing, then at
        most the thickness of the design along the ray.
    """
    _, lines, out = rays.points(rays.design)
    ends, wanted = rays.machined.ends_mm, rays.design.ends_mm
    span = float(max(np.ptp(ends) if len(ends) else 0.0, np.ptp(wanted) if len(wanted) else 0.0)) + 1.0
    base = min(ends.min(initial=np.inf), wanted.min(initial=np.inf))
    own = np.repeat(np.arange(len(rays.positions_mm)), np.diff(rays.machined.offsets))
    keys = own * (2.0 * span) + (ends - base)
    # searched from outside the design: where an end of both lies at the same position, nothing is left on the design
    sought = lines * (2.0 * span) + (wanted - base)
    found = np.where(out > 0.0, np.searchsorted(keys, sought, side="right"), np.searchsorted(keys, sought, side="left"))
    inside = (found - rays.machined.offsets[lines]) % 2 == 1
    partner = np.arange(len(wanted)) - out.astype(np.int64)
    through = np.abs(wanted - wanted[partner])
    # in material: the end of it outwards; in air: the nearest material inwards
    index = np.where(inside == (out > 0.0), found, found - 1)
    ok = (index >= rays.machined.offsets[lines]) & (index < rays.machined.offsets[lines + 1])
    distance = np.where(ok, np.abs(ends[np.clip(index, 0, max(len(ends) - 1, 0))] - wanted), np.inf)
    return np.where(inside, distance, -np.minimum(distance, through))
