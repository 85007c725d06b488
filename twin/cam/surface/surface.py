"""A triangle surface as tools meet it from above: welded vertices, edges, and the normal cones of both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from twin.arrays import FloatArray
from twin.cam.surface import surface_kernels as kernels
from twin.errors import MeshError
from twin.geometry.mesh.slicing_kernels import weld
from twin.geometry.threads import in_parts


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Faces, edges and vertices, and the directions in which a tool can rest on each; the same for every tool.

    Attributes:
        vertices_mm: shape (n, 3).
        triangles: shape (m, 3).
        normals: shape (m, 3), upward unit normals; 0 for vertical triangles and those without area.
        ends: shape (e, 2), vertices of each edge.
        edge_cones_rad: shape (e, 2), normals across the edge as angles in [0, pi]; first > second where no tool rests.
        vertex_cones: shape (n, 4), box of the normals (x, y, 1): least x, largest x, least y, largest y; likewise.
    """

    vertices_mm: FloatArray
    triangles: NDArray[np.int64]
    normals: FloatArray
    ends: NDArray[np.int64]
    edge_cones_rad: FloatArray
    vertex_cones: FloatArray

    @property
    def low_mm(self) -> FloatArray:
        """Low corner of the box, shape (3,)."""
        return np.asarray(self.vertices_mm.min(axis=0))

    @property
    def high_mm(self) -> FloatArray:
        """High corner of the box, shape (3,)."""
        return np.asarray(self.vertices_mm.max(axis=0))


def surface_of(corners_mm: ArrayLike, *, threads: int | None = None) -> Surface:
    """Weld loose triangles; corners meet where they are equal to the last bit.

    Args:
        corners_mm: shape (m, 3, 3). Triangles may have any orientation, lie apart, or have no area.

    Raises:
        MeshError: no triangles, another shape, or a corner that is not finite.
    """
    corners = np.array(corners_mm, dtype=np.float64) + 0.0
    if corners.ndim != 3 or corners.shape[1:] != (3, 3) or len(corners) == 0:
        raise MeshError(f"surface: triangles of shape {corners.shape}; expected (m, 3, 3) with m above 0")
    bad = np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))
    if len(bad):
        raise MeshError(f"surface: triangle {bad[0] + 1} of {len(corners)} has a corner that is not finite")
    points = corners.reshape(-1, 3)
    ids, first = np.empty((2, len(points)), dtype=np.int64)
    count = weld(points.view(np.int64), ids, first)
    return surface_of_mesh(points[first[:count]], ids.reshape(-1, 3), threads=threads)


def surface_of_mesh(vertices_mm: FloatArray, triangles: NDArray[np.int64], *, threads: int | None = None) -> Surface:
    """The surface of triangles that share vertices already.

    Args:
        vertices_mm: shape (n, 3), finite, each used by a triangle.
        triangles: shape (m, 3).
    """
    # copies, since kernels compile again for arrays that may not be written
    vertices = np.array(vertices_mm, dtype=np.float64, order="C")
    faces = np.array(triangles, dtype=np.int64, order="C")
    normals = np.empty((len(faces), 3))
    kernels.face_slopes(vertices, faces, normals)
    mesh = kernels.Mesh(vertices, faces)
    sides = kernels.Groups(np.empty(3 * len(faces), dtype=np.int64), np.empty(3 * len(faces) + 1, dtype=np.int64))
    count = kernels.edge_sides(faces, len(vertices), sides)
    ends, edge_cones = np.empty((count, 2), dtype=np.int64), np.empty((count, 2))
    in_parts(lambda a, b: kernels.edge_cones(mesh, sides, a, b, ends, edge_cones), count, threads=threads)
    edges = kernels.Groups(np.empty(2 * count, dtype=np.int64), np.zeros(len(vertices) + 1, dtype=np.int64))
    most = kernels.vertex_edges(ends, len(vertices), edges)
    vertex_cones = np.empty((len(vertices), 4))
    in_parts(
        lambda a, b: kernels.vertex_cones(vertices, ends, edges, most, a, b, vertex_cones),
        len(vertices),
        threads=threads,
    )
    return Surface(vertices, faces, normals, ends, edge_cones, vertex_cones)
