"""Sections of a closed triangle mesh with parallel planes, chained to rings by shared edges; compiled.

A vertex on a plane counts as above it. So every triangle that reaches both sides has exactly one edge that goes up
through the plane and one that goes down, whether or not vertices, edges or whole faces lie on it, and no tolerance
decides anything. The point on an edge is computed from the edge alone, never from the triangle.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from twin.arrays import FloatArray


@njit(cache=True, nogil=True)
def plane_ranges(
    heights: FloatArray, triangles: NDArray[np.int64], planes: FloatArray, first: NDArray[np.int64]
) -> NDArray[np.int64]:
    """How many segments every plane gets.

    Args:
        heights: shape (n,), vertex coordinates along the planes' normal.
        triangles: shape (m, 3).
        planes: shape (k,), increasing.
        first: shape (m, 2), filled with the first and one past the last plane that each triangle crosses.

    Returns:
        shape (k + 1,), where each plane's segments begin.
    """
    begins = np.zeros(len(planes) + 1, dtype=np.int64)
    for t in range(len(triangles)):
        a, b, c = heights[triangles[t, 0]], heights[triangles[t, 1]], heights[triangles[t, 2]]
        first[t, 0] = np.searchsorted(planes, min(a, b, c), side="right")
        first[t, 1] = np.searchsorted(planes, max(a, b, c), side="right")
        for k in range(first[t, 0], first[t, 1]):
            begins[k + 1] += 1
    for k in range(len(planes)):
        begins[k + 1] += begins[k]
    return begins


@njit(cache=True, nogil=True)
def fill_segments(
    heights: FloatArray,
    triangles: NDArray[np.int64],
    sides: NDArray[np.int64],
    planes: FloatArray,
    ranges: NDArray[np.int64],
    begins: NDArray[np.int64],
    mirrored: bool,
    segments: NDArray[np.int64],
) -> None:
    """Write each segment's start and end edge, material on its left.

    Args:
        sides: shape (m, 3), edge j of a triangle joins its corners j and j + 1.
        ranges, begins: from `plane_ranges`.
        mirrored: whether (u, v, normal) is a left-handed frame.
        segments: shape (s, 2), grouped by plane.
    """
    cursor = begins[:-1].copy()
    for t in range(len(triangles)):
        for k in range(ranges[t, 0], ranges[t, 1]):
            up, down = -1, -1
            for j in range(3):
                a = heights[triangles[t, j]] >= planes[k]
                b = heights[triangles[t, (j + 1) % 3]] >= planes[k]
                if b and not a:
                    up = sides[t, j]
                elif a and not b:
                    down = sides[t, j]
            segments[cursor[k], 0] = up if mirrored else down
            segments[cursor[k], 1] = down if mirrored else up
            cursor[k] += 1


@njit(cache=True, nogil=True)
def chain_rings(
    segments: NDArray[np.int64], begins: NDArray[np.int64], edges: int, order: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Put every plane's segments into the order of rings.

    Where more than two triangles meet at an edge, any of the segments that begin there goes on: all rings close in
    either case, as every edge has as many beginnings as ends.

    Args:
        edges: number of the mesh's edges.
        order: shape (s,), filled with segments, ring by ring, plane by plane.

    Returns:
        rows (plane, first, one past the last place in ``order``), one a ring.
    """
    rings = np.empty((len(segments) // 2 + 1, 3), dtype=np.int64)
    head = np.full(edges, -1, dtype=np.int64)
    same = np.full(len(segments), -1, dtype=np.int64)
    count, n = 0, 0
    for k in range(len(begins) - 1):
        for s in range(begins[k], begins[k + 1]):
            same[s] = head[segments[s, 0]]
            head[segments[s, 0]] = s
        for seed in range(begins[k], begins[k + 1]):
            s = head[segments[seed, 0]]
            if s < 0:
                continue
            rings[count, 0], rings[count, 1] = k, n
            while s >= 0:
                head[segments[s, 0]] = same[s]
                order[n] = s
                n += 1
                s = head[segments[s, 1]]
            rings[count, 2] = n
            count += 1
    return rings[:count]


@njit(cache=True, nogil=True)
def edge_points(
    vertices: FloatArray,
    edges: NDArray[np.int64],
    axes: tuple[int, int, int],
    planes: FloatArray,
    rings: NDArray[np.int64],
    order: NDArray[np.int64],
    segments: NDArray[np.int64],
    points: FloatArray,
) -> None:
    """Where the first edge of every segment meets its plane, in the order of the rings.

    Args:
        edges: shape (e, 2), the vertices of each edge, lower number first.
        axes: normal, u and v axis.
        points: shape (s, 2), filled with (u, v).
    """
    w, u, v = axes
    for r in range(len(rings)):
        plane = planes[rings[r, 0]]
        for i in range(rings[r, 1], rings[r, 2]):
            a, b = edges[segments[order[i], 0], 0], edges[segments[order[i], 0], 1]
            t = (plane - vertices[a, w]) / (vertices[b, w] - vertices[a, w])
            points[i, 0] = vertices[a, u] + t * (vertices[b, u] - vertices[a, u])
            points[i, 1] = vertices[a, v] + t * (vertices[b, v] - vertices[a, v])
