"""Triangle meshes in and out: STL files, the check that they are solids, and their slices. The only door to trimesh."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from twin.arrays import FloatArray, frozen
from twin.errors import MeshError
from twin.geometry.mesh.slicing import MeshEdges, mesh_sections, weld
from twin.geometry.polygons.region import Region
from twin.geometry.threads import run_all
from twin.workpiece.solids.solid_check import check_closed, check_orientation
from twin.workpiece.solids.stl_file import stl_corners
from twin.workpiece.solids.units import TYPICAL_MM, UNITS_MM, unit_of
from twin.workpiece.solids.weld import Mesh, welded
from twin.workpiece.stock import SliceSet, even_pitch, plane_counts, plane_positions
from twin.workpiece.store import PLANE_AXES

if TYPE_CHECKING:
    from trimesh import Trimesh

#: Coordinates are joined as whole multiples of 1e-5 mm; no machine is nearly so large.
_LARGEST_MM = 1e9


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A checked triangle mesh: closed, turned outwards, one or more bodies.

    Attributes:
        name: where it came from, for messages.
        vertices_mm: shape (n, 3), rounded to 1e-5 mm, no two equal.
        triangles: shape (m, 3), counter-clockwise seen from outside, no corner twice.
        edges: the edges of the triangles.
        notes: what was assumed or mended when it was read, for the user.
    """

    name: str
    vertices_mm: FloatArray
    triangles: NDArray[np.int64]
    edges: MeshEdges
    notes: tuple[str, ...] = ()

    @property
    def used(self) -> NDArray[np.bool_]:
        """Vertices that triangles have; others were those of triangles without area. Shape (n,)."""
        used = np.zeros(len(self.vertices_mm), dtype=np.bool_)
        used[self.triangles.ravel()] = True
        return used

    @property
    def box_mm(self) -> FloatArray:
        """Low and high corner of the triangles' box, shape (2, 3)."""
        columns = self.vertices_mm[self.used].T
        return np.array([[c.min() for c in columns], [c.max() for c in columns]])

    def area_vectors_mm2(self, which: NDArray[np.int64] | slice = slice(None)) -> FloatArray:
        """Outward normals of triangles, as long as twice their areas, shape (3, n); all, or those of some numbers."""
        a, b, c = (self.vertices_mm.T[:, self.triangles[which, i]] for i in range(3))
        (ux, uy, uz), (vx, vy, vz) = b - a, c - a
        return np.stack((uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx))

    @property
    def volume_mm3(self) -> float:
        """Volume inside the triangles; where bodies overlap it counts twice."""
        a, b, c = (self.vertices_mm[self.triangles[:, i]] - self.vertices_mm[0] for i in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


def load_mesh(
    path: Path | str,
    *,
    unit: str = "mm",
    scale: float = 1.0,
    offset_mm: ArrayLike = (0.0, 0.0, 0.0),
    like_mm: float = TYPICAL_MM,
) -> Solid:
    """Read a binary or ASCII STL file and check that it is a solid.

    Args:
        unit: of the file: ``mm``, ``inch``, ``m``, or ``auto`` for the one in which the part is most like ``like_mm``.
        scale: further factor on the file's points.
        offset_mm: shape (3,), added after scaling.
        like_mm: length that the part's longest side should be comparable with.

    Raises:
        MeshError: no such file, no STL, or no solid; see `solid`.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise MeshError(f"{path}: cannot be read: {error.strerror}; expected an STL file") from error
    if not (np.isfinite(scale) and scale > 0.0):
        raise MeshError(f"{path}: scale {scale:g}; expected a number above 0")
    corners = stl_corners(str(path), data)
    own, notes = unit_of(str(path), unit, corners * scale, like_mm)
    made = solid(corners * (scale * UNITS_MM[own]) + frozen(offset_mm, "offset_mm", (3,)), str(path))
    return replace(made, notes=notes + made.notes) if notes else made


def solid(corners_mm: ArrayLike, name: str) -> Solid:
    """Join loose triangles to a solid.

    Vertices are rounded to 1e-5 mm first, so that triangles whose corners differ by rounding meet. Triangles with two
    equal corners after that enclose nothing and are dropped. Seams that are open by no more than
    `twin.workpiece.solids.weld.WELD_MM` are closed, which the solid's notes state; nothing else is mended.

    Args:
        corners_mm: shape (m, 3, 3), the corners of each triangle, counter-clockwise seen from outside.
        name: for messages.

    Raises:
        MeshError: no triangles, a corner that is not finite, an open edge, triangles turned unlike their neighbours, or
            a body turned inside out.
    """
    corners = np.asarray(corners_mm, dtype=np.float64)
    if corners.size == 0:
        raise MeshError(f"{name}: holds no triangles; expected a closed surface")
    if not np.isfinite(corners).all():
        bad = np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))
        raise MeshError(f"{name}: triangle {bad[0] + 1} of {len(corners)} has a corner that is not a finite number")
    if (largest := float(np.abs(corners).max())) > _LARGEST_MM:
        raise MeshError(f"{name}: a corner is {largest:g} mm from the origin; expected at most {_LARGEST_MM:g} mm")
    vertices, numbers = weld(corners.reshape(-1, 3))
    mesh = Mesh.of(numbers.reshape(-1, 3), np.arange(len(corners)))
    if len(mesh.triangles) == 0:
        raise MeshError(f"{name}: every one of its {len(corners)} triangles has no area; expected a closed surface")
    done = ""
    if not mesh.closed:
        mesh, done = welded(vertices, mesh)
        check_closed(name, vertices, mesh)
    check_orientation(name, vertices, mesh.triangles)
    vertices.flags.writeable = mesh.triangles.flags.writeable = False
    return Solid(name, vertices, mesh.triangles, mesh.edges, (f"{name}: {done}",) if done else ())


def mesh_slices(mesh: Solid, pitch_mm: float) -> SliceSet:
    """Slice a solid in three directions; its box is the box of the slices.

    Args:
        pitch_mm: largest distance of the planes.

    Raises:
        StockError: a mesh without extent, or a pitch that cannot be.
    """
    box = mesh.box_mm
    low, high = frozen(box[0], "low_mm", (3,)), frozen(box[1], "high_mm", (3,))
    pitch, counts = even_pitch(low, high, pitch_mm), plane_counts(low, high, pitch_mm)

    def cut(axis: int) -> tuple[Region, ...]:
        axes = (axis, *PLANE_AXES[axis])
        planes = plane_positions(low, pitch, axis, counts[axis])
        return mesh_sections(mesh.vertices_mm, mesh.triangles, mesh.edges, axes, planes)

    families = run_all([partial(cut, axis) for axis in range(3)])
    return SliceSet(low_mm=low, high_mm=high, pitch_mm=pitch, regions=tuple(families), notes=mesh.notes)


def stl_bytes(vertices_mm: ArrayLike, triangles: ArrayLike) -> bytes:
    """A mesh as binary STL, as float32 mm."""
    from trimesh.exchange.stl import export_stl

    return bytes(export_stl(_trimesh(vertices_mm, triangles)))


def threemf_bytes(vertices_mm: ArrayLike, triangles: ArrayLike) -> bytes:
    """A mesh as 3MF, in mm."""
    from trimesh.exchange.threemf import export_3MF

    mesh = _trimesh(vertices_mm, triangles)
    mesh.units = "millimeter"
    data: bytes = export_3MF(mesh)  # type: ignore[no-untyped-call]
    return data


def _trimesh(vertices_mm: ArrayLike, triangles: ArrayLike) -> Trimesh:
    import trimesh  # takes as long to load as all else of a replay, which seldom needs it

    return trimesh.Trimesh(np.asarray(vertices_mm), np.asarray(triangles), process=False)
