"""A part's sections: evenly spaced slices in three directions, and more of them where faces lie across a direction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.mesh.slicing import mesh_sections
from twin.geometry.polygons.region import Region
from twin.geometry.threads import run_all
from twin.workpiece.solids.from_mesh import Solid, load_mesh, mesh_slices
from twin.workpiece.stock import SliceSet
from twin.workpiece.store import PLANE_AXES

#: A face lies across an axis when its normal has at least this component along it.
_ACROSS = 1.0 - 1e-9
#: Edges are sharp from this angle between the normals on either side.
_SHARP_RAD = math.radians(10.0)
#: Sections of such faces are cut this far inside the material, and stand for the face itself.
_INSIDE_MM = 2e-5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sections:
    """Sections across one axis at any positions.

    Attributes:
        axis: 0, 1, 2 for planes normal to x, y, z.
        positions_mm: shape (n,), increasing.
        regions: one a position.
    """

    axis: int
    positions_mm: FloatArray
    regions: tuple[Region, ...]

    @classmethod
    def of(cls, slices: SliceSet, axis: int) -> Sections:
        """One direction of a set of slices."""
        return cls(axis=axis, positions_mm=slices.positions_mm(axis), regions=slices.regions[axis])

    def joined(self, other: Sections) -> Sections:
        """The sections of both, by position."""
        positions = np.concatenate((self.positions_mm, other.positions_mm))
        order = np.argsort(positions, kind="stable")
        regions = self.regions + other.regions
        return Sections(axis=self.axis, positions_mm=positions[order], regions=tuple(regions[i] for i in order))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SlicedPart:
    """A part as slices, with sections at the faces and edges that even slices would miss.

    Attributes:
        mesh: the solid that was cut.
        slices: evenly spaced sections in three directions.
        faces: for every axis, sections just inside of the faces that lie across it, and on both sides of such sharp
            edges. Even slices know these to half a pitch only; with the added ones they are known exactly.
    """

    mesh: Solid
    slices: SliceSet
    faces: tuple[Sections, Sections, Sections]

    def sections(self, axis: int) -> Sections:
        """Even slices and those of faces, together."""
        return Sections.of(self.slices, axis).joined(self.faces[axis])


def slice_part(part: Path | str | Solid, pitch_mm: float) -> SlicedPart:
    """Slice a part in three directions.

    Args:
        part: an STL file, or a solid.
        pitch_mm: largest distance of the planes, which lie at low + (k + 1/2) pitch.

    Raises:
        MeshError: the mesh is not a closed solid.
        StockError: a pitch that is not possible.
    """
    mesh = part if isinstance(part, Solid) else load_mesh(part)
    slices = mesh_slices(mesh, pitch_mm)
    x, y, z = run_all([partial(face_sections, mesh, axis) for axis in range(3)])
    return SlicedPart(mesh=mesh, slices=slices, faces=(x, y, z))


def face_sections(mesh: Solid, axis: int) -> Sections:
    """Sections at the faces that lie across an axis, cut just inside the material, and on both sides of sharp edges."""
    low, high = face_levels(mesh, axis)
    faces = _beside_faces(mesh, axis, low, high, _INSIDE_MM)
    edges = np.setdiff1d(edge_levels(mesh, axis), np.concatenate((low, high)))
    if len(edges) == 0:
        return faces
    cuts = np.sort(np.concatenate((edges - _INSIDE_MM, edges + _INSIDE_MM)))
    return faces.joined(_cut(mesh, axis, cuts, np.repeat(edges, 2)))


def outside_sections(mesh: Solid, axis: int) -> Sections:
    """Sections at the same faces, cut just outside the material."""
    return _beside_faces(mesh, axis, *face_levels(mesh, axis), -_INSIDE_MM)


def _beside_faces(mesh: Solid, axis: int, low: FloatArray, high: FloatArray, inwards_mm: float) -> Sections:
    cuts = np.concatenate((low + inwards_mm, high - inwards_mm))
    order = np.argsort(cuts, kind="stable")
    return _cut(mesh, axis, cuts[order], np.concatenate((low, high))[order])


def cut_sections(mesh: Solid, axis: int, positions_mm: FloatArray) -> Sections:
    """Sections at increasing positions."""
    return _cut(mesh, axis, positions_mm, positions_mm)


def _cut(mesh: Solid, axis: int, cuts_mm: FloatArray, positions_mm: FloatArray) -> Sections:
    """Sections at increasing cuts, which stand for other positions close by."""
    u, v = PLANE_AXES[axis]
    regions = mesh_sections(mesh.vertices_mm, mesh.triangles, mesh.edges, (axis, u, v), cuts_mm)
    return Sections(axis=axis, positions_mm=positions_mm, regions=regions)


def face_levels(mesh: Solid, axis: int) -> tuple[FloatArray, FloatArray]:
    """Positions of faces across an axis: those with material above them, and those with material below."""
    which, vectors = flat_triangles(mesh, axis)
    heights, up = mesh.vertices_mm[mesh.triangles[which, 0], axis], vectors[axis] > 0.0
    return np.unique(heights[~up]), np.unique(heights[up])


def flat_triangles(mesh: Solid, axis: int) -> tuple[NDArray[np.int64], FloatArray]:
    """Triangles that lie across an axis, and their `Solid.area_vectors_mm2`."""
    level = _nearly_level(mesh, axis)
    vectors = mesh.area_vectors_mm2(level)
    flat = _lies_across(vectors, axis)
    return level[flat], vectors[:, flat]


def slanted_triangles(mesh: Solid, axis: int) -> tuple[NDArray[np.int64], FloatArray]:
    """Triangles with an area that do not lie across an axis, and their `Solid.area_vectors_mm2`."""
    vectors = mesh.area_vectors_mm2()
    which = np.flatnonzero(np.any(vectors != 0.0, axis=0) & ~_lies_across(vectors, axis))
    return which, vectors[:, which]


def _lies_across(vectors: FloatArray, axis: int) -> NDArray[np.bool_]:
    size = np.linalg.norm(vectors, axis=0)
    return np.asarray((np.abs(vectors[axis]) >= _ACROSS * size) & (size > 0.0))


def _nearly_level(mesh: Solid, axis: int) -> NDArray[np.int64]:
    """Triangles that may lie across an axis; most are excluded by their heights, without their normals."""
    heights = mesh.vertices_mm[:, axis]
    a, b, c = (heights[mesh.triangles[:, i]] for i in range(3))
    spread = np.maximum(np.maximum(a, b), c) - np.minimum(np.minimum(a, b), c)
    size = float(np.linalg.norm(np.diff(mesh.box_mm, axis=0)))
    return np.flatnonzero(spread <= 2.0 * math.sqrt(1.0 - _ACROSS) * size)


def edge_levels(mesh: Solid, axis: int) -> FloatArray:
    """Positions of sharp edges that lie across an axis: ridges, rims of cones, borders of faces that lie across it.

    Even slices miss the top of such an edge by up to half a pitch times the slope next to it.
    """
    ends = mesh.vertices_mm[mesh.edges.ends, axis]
    level = np.flatnonzero(ends[:, 0] == ends[:, 1])
    number = np.full(len(ends), -1, dtype=np.int64)
    number[level] = np.arange(len(level))
    of_sides = number[mesh.edges.sides]
    triangles, sides = np.divmod(np.flatnonzero(of_sides >= 0), 3)
    own = of_sides[triangles, sides]
    normals = mesh.area_vectors_mm2(triangles)
    normals /= np.maximum(np.linalg.norm(normals, axis=0), 1e-300)
    summed = np.stack([np.bincount(own, weights=normal, minlength=len(level)) for normal in normals], axis=1)
    # two unit normals at an angle add up to 2 cos(angle / 2)
    sharp = np.linalg.norm(summed, axis=1) < 2.0 * math.cos(0.5 * _SHARP_RAD)
    return np.asarray(np.unique(ends[level[sharp], 0]))
