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
from twin.workpiece.from_mesh import Solid
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
