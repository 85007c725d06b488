"""Rays along x, y and z through the part and what was machined, in the planes of the slices.

Sections of what was machined are exact in the planes of the slices, and so are those of the design, so points where a
ray enters or leaves either are exact too, wherever the surface stands. Only what lies between rays is not seen.
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
        places_mm: shape (rays, 2), where the rays stand in these.
        machined, design: where they enter and leave.
        area_mm2: of the plan that each ray stands for.
    """

    axis: int
    across: tuple[int, int]
    places_mm: FloatArray
    machined: LineEnds
    design: LineEnds
    area_mm2: float

    def points(self, ends: LineEnds) -> tuple[FloatArray, NDArray[np.int64], FloatArray]:
        """Ends as points, shape (n, 3), the ray of each, and which way is out of the material there, -1 or +1."""
        rays = np.repeat(np.arange(len(self.places_mm)), np.diff(ends.offsets))
        points = np.empty((len(rays), 3))
        points[:, self.across] = self.places_mm[rays]
        points[:, self.axis] = ends.ends_mm
        out = np.where((np.arange(len(rays)) - ends.offsets[rays]) % 2 == 0, -1.0, 1.0)
        return points, rays, out


def cast(store: TriSlices, design: Solid) -> Iterator[Rays]:
    """Rays along x, y and z, at the planes of the other two families."""
    for axis, (family, fixed) in enumerate(_PLANES):
        u, v = PLANE_AXES[family]
        other = (u, v)[fixed]
        planes = plane_positions(store.low_mm, store.pitch_mm, family, store.count(family))
        at = plane_positions(store.low_mm, store.pitch_mm, other, store.count(other))
        window = (float(store.low_mm[axis]) - 1.0, float(store.high_mm[axis]) + 1.0)
        machined = store.line_ends(family, np.arange(len(planes)), fixed, at, window)
        sections = mesh_sections(design.vertices_mm, design.triangles, design.edges, (family, u, v), planes)
        places = np.column_stack((np.repeat(planes, len(at)), np.tile(at, len(planes))))
        yield Rays(
            axis=axis,
            across=(family, other),
            places_mm=places,
            machined=machined,
            design=ring_line_ends((r.rings for r in sections), fixed, at),
            area_mm2=float(store.pitch_mm[family] * store.pitch_mm[other]),
        )


def beyond(rays: Rays) -> FloatArray:
    """How far the machined part reaches over each end of the design, along its ray.

    Returns:
        shape (n,), positive where material stands over the design, negative where the design is gone, at most through
        to the end of the design's material behind it.
    """
    _, lines, out = rays.points(rays.design)
    ends, wanted = rays.machined.ends_mm, rays.design.ends_mm
    span = float(max(np.ptp(ends) if len(ends) else 0.0, np.ptp(wanted) if len(wanted) else 0.0)) + 1.0
    base = min(ends.min(initial=np.inf), wanted.min(initial=np.inf))
    own = np.repeat(np.arange(len(rays.places_mm)), np.diff(rays.machined.offsets))
    keys = own * (2.0 * span) + (ends - base)
    # the side out of the design decides: where an end of both lies at one place, nothing stands over
    place = lines * (2.0 * span) + (wanted - base)
    found = np.where(out > 0.0, np.searchsorted(keys, place, side="right"), np.searchsorted(keys, place, side="left"))
    inside = (found - rays.machined.offsets[lines]) % 2 == 1
    partner = np.arange(len(wanted)) - out.astype(np.int64)
    through = np.abs(wanted - wanted[partner])
    # in material: its end on the way out; in air: the nearest material on the way in
    index = np.where(inside == (out > 0.0), found, found - 1)
    ok = (index >= rays.machined.offsets[lines]) & (index < rays.machined.offsets[lines + 1])
    distance = np.where(ok, np.abs(ends[np.clip(index, 0, max(len(ends) - 1, 0))] - wanted), np.inf)
    return np.where(inside, distance, -np.minimum(distance, through))
