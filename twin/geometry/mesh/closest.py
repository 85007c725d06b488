"""Signed distances from a closed triangle mesh: exact, with the sign from pseudo-normals.

The nearest point lies on a face, an edge or a corner. The side follows from the face's normal, from the sum of the
normals at the edge, or from the sum weighted by angles at the corner (Baerentzen and Aanaes, 2005).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.mesh import closest_kernels as kernels
from twin.geometry.mesh.slicing import MeshEdges
from twin.geometry.threads import in_parts

#: Points that are not worth several threads.
_FEW = 64
#: Triangles of a leaf.
_LEAF = 4
#: Cells along each axis that triangles are sorted by (Morton, 1966).
_BITS = 10


class Nearest(NamedTuple):
    """Nearest points on a mesh.

    Attributes:
        distance_mm: shape (n,), positive outside.
        places_mm: shape (n, 3).
        normals: shape (n, 3), outward unit (pseudo-)normals there.
        triangles: shape (n,).
    """

    distance_mm: FloatArray
    places_mm: FloatArray
    normals: FloatArray
    triangles: NDArray[np.int64]


class ClosestPoints:
    """A closed mesh, ready for queries.

    Args:
        vertices_mm: shape (n, 3).
        triangles: shape (m, 3), m above 0, counter-clockwise seen from outside.
        edges: of these triangles.
    """

    def __init__(self, vertices_mm: FloatArray, triangles: NDArray[np.int64], edges: MeshEdges) -> None:
        corners = vertices_mm[triangles]
        self._order = np.argsort(_morton(corners.mean(axis=1)), kind="stable")
        levels = max(0, math.ceil(math.log2(math.ceil(len(triangles) / _LEAF))))
        in_order = np.ascontiguousarray(corners[self._order].reshape(-1, 9))
        self._tree = kernels.Tree(in_order, _LEAF, levels, np.empty((2 ** (levels + 1) - 1, 6)))
        kernels.fill_boxes(self._tree)
        self._normals = _pseudo_normals(corners, vertices_mm, triangles, edges)

    def ask(self, points_mm: FloatArray, threads: int | None = None) -> Nearest:
        """The nearest points of points, shape (n, 3); best with neighbours one after the other."""
        points = np.ascontiguousarray(points_mm, dtype=np.float64)
        count = len(points)
        found = kernels.Closest(np.empty((count, 3)), np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int8))
        in_parts(
            lambda first, last: kernels.closest(points, first, last, self._tree, found),
            count,
            threads=threads,
            few=_FEW,
        )
        triangles = self._order[found.triangles]
        normals = self._normals[triangles, found.features]
        away = points - found.points
        side = np.einsum("ij,ij->i", away, normals)
        distance = np.copysign(np.linalg.norm(away, axis=1), side)
        return Nearest(distance, found.points, normals, triangles)


def _morton(points: FloatArray) -> NDArray[np.int64]:
    """Positions along a curve that keeps neighbours together."""
    low, extent = points.min(axis=0), max(float(np.ptp(points, axis=0).max()), 1e-300)
    cells = np.minimum((points - low) / extent * 2**_BITS, 2**_BITS - 1).astype(np.int64)
    codes = np.zeros(len(points), dtype=np.int64)
    for bit in range(_BITS):
        for axis in range(3):
            codes |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return codes


def _pseudo_normals(
    corners: FloatArray, vertices: FloatArray, triangles: NDArray[np.int64], edges: MeshEdges
) -> FloatArray:
    """Unit normals of the seven features of each triangle, shape (m, 7, 3), in the order of the kernel."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    face = _unit(cross)
    at_edges = np.zeros((len(edges.ends), 3))
    at_vertices = np.zeros((len(vertices), 3))
    for i in range(3):
        np.add.at(at_edges, edges.sides[:, i], face)
        a = _unit(corners[:, (i + 1) % 3] - corners[:, i])
        b = _unit(corners[:, (i + 2) % 3] - corners[:, i])
        angle = np.arccos(np.clip(np.einsum("ij,ij->i", a, b), -1.0, 1.0))
        np.add.at(at_vertices, triangles[:, i], face * angle[:, None])
    found = np.empty((len(triangles), 7, 3))
    found[:, 0] = face
    for i in range(3):
        found[:, 1 + i] = at_edges[edges.sides[:, i]]
        found[:, 4 + i] = at_vertices[triangles[:, i]]
    return _unit(found)


def _unit(vectors: FloatArray) -> FloatArray:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    unit: FloatArray = vectors / np.where(length > 0.0, length, 1.0)
    return unit
