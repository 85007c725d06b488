"""Plane sections of closed triangle meshes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.mesh import slicing_kernels as kernels
from twin.geometry.polygons.clip import DECIMALS, LEAST_AREA_MM2, union_nonzero
from twin.geometry.polygons.region import Region


@dataclass(frozen=True, slots=True, eq=False)
class MeshEdges:
    """The edges of a triangle mesh.

    Attributes:
        ends: shape (e, 2), the vertices of each edge, lower number first.
        sides: shape (m, 3), edge j of a triangle joins its corners j and j + 1.
        forward, backward: shape (e,), how many triangles run along an edge from its lower to its higher vertex, and
            the other way. A closed mesh with all triangles turned alike has as many of both everywhere.
    """

    ends: NDArray[np.int64]
    sides: NDArray[np.int64]
    forward: NDArray[np.int64]
    backward: NDArray[np.int64]


def mesh_edges(triangles: NDArray[np.int64]) -> MeshEdges:
    """Number the edges of triangles, shape (m, 3), none with a corner twice."""
    ends, uses = np.empty((2, 3 * len(triangles), 2), dtype=np.int64)
    sides = np.empty((len(triangles), 3), dtype=np.int64)
    count = kernels.number_edges(triangles, int(triangles.max(initial=-1)) + 1, ends, uses, sides)
    return MeshEdges(
        ends=ends[:count].copy(), sides=sides, forward=uses[:count, 0].copy(), backward=uses[:count, 1].copy()
    )


def weld(points_mm: FloatArray) -> tuple[FloatArray, NDArray[np.int64]]:
    """Join points that are equal when rounded to 1e-5 mm.

    Args:
        points_mm: shape (n, 3), finite.

    Returns:
        the different points, rounded, in the order in which they come first; and the number of each point among them.
    """
    units = 10.0**DECIMALS
    whole = np.rint(points_mm * units).astype(np.int64)
    ids, first = np.empty((2, len(whole)), dtype=np.int64)
    count = kernels.weld(whole, ids, first)
    return whole[first[:count]] / units, ids


def mesh_sections(
    vertices_mm: FloatArray,
    triangles: NDArray[np.int64],
    edges: MeshEdges,
    axes: tuple[int, int, int],
    planes_mm: FloatArray,
) -> tuple[Region, ...]:
    """Cut a closed mesh with planes.

    A vertex on a plane counts as above it, so the section there is that of a plane a hair lower. Bodies
    that overlap are united by non-zero winding.

    Args:
        vertices_mm: shape (n, 3).
        triangles: shape (m, 3), counter-clockwise seen from outside.
        edges: of these triangles; every edge as often forward as backward.
        axes: the planes' normal axis and the in-plane axes u, v.
        planes_mm: shape (k,), positions along the normal axis, increasing.

    Returns:
        One region per plane, vertices rounded to 1e-5 mm.
    """
    heights = np.ascontiguousarray(vertices_mm[:, axes[0]])
    ranges = np.empty((len(triangles), 2), dtype=np.int64)
    begins = kernels.plane_ranges(heights, triangles, planes_mm, ranges)
    segments = np.empty((begins[-1], 2), dtype=np.int64)
    mirrored = (axes[1] + 1) % 3 != axes[2]
    kernels.fill_segments(heights, triangles, edges.sides, planes_mm, ranges, begins, mirrored, segments)
    order = np.empty(len(segments), dtype=np.int64)
    rings = kernels.chain_rings(segments, begins, len(edges.ends), order)
    points = np.empty((len(segments), 2))
    kernels.edge_points(vertices_mm, edges.ends, axes, planes_mm, rings, order, segments, points)
    return _regions(points, rings, len(planes_mm))


def _regions(points_mm: FloatArray, rings: NDArray[np.int64], planes: int) -> tuple[Region, ...]:
    """Chained rings to regions; only where rings meet each other are they united."""
    units = 10.0**DECIMALS
    whole, kept = np.empty(points_mm.shape, dtype=np.int64), np.empty_like(rings)
    kept = kept[: kernels.clean_rings(points_mm, rings, units, LEAST_AREA_MM2 * units**2, whole, kept)]
    simple = np.empty(planes, dtype=np.bool_)
    kernels.simple_planes(whole, kept, simple)
    points = whole / units
    points.flags.writeable = False
    found: list[list[FloatArray]] = [[] for _ in range(planes)]
    for plane, first, last in kept.tolist():
        found[plane].append(points[first:last])
    return tuple(Region(tuple(r)) if s else union_nonzero(r) for r, s in zip(found, simple.tolist(), strict=True))
