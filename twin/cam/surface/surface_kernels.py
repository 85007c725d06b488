"""Normal cones of a triangle surface: in which directions a tool coming from above can rest on it; compiled.

A tool rests on an edge only where its outward normal there has no component into any triangle of the edge, and on a
vertex only where that holds for all its edges: the normal cone of the point. Directions n point from the surface to
the tool's axis side, with nz >= 0. Triangles are sets of points here: no orientation counts, open surfaces, several
triangles at an edge and triangles without area are all the same rule.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.sorting_kernels import sort_by
from twin.jit import inlined, njit

#: Cones thinner than this have no part of their own: neighbours touch there, up to R times this.
_THIN_RAD = 1e-10
#: Cones are widened by this against rounding; more elements are tested, never a wrong height found.
_WIDEN_RAD = 1e-9
#: Steepest direction of a vertex cone, as a slope; what lies beyond is taken as level.
_STEEPEST = 1e6


class Mesh(NamedTuple):
    """Vertices, shape (n, 3), and the corners of each triangle, shape (m, 3)."""

    vertices: FloatArray
    triangles: NDArray[np.int64]


class Groups(NamedTuple):
    """Numbers in groups: group k has ``members[begins[k] : begins[k + 1]]``."""

    members: NDArray[np.int64]
    begins: NDArray[np.int64]


@njit
def edge_sides(triangles: NDArray[np.int64], vertices: int, sides: Groups) -> int:
    """Group the sides of triangles by the edge they lie on.

    Side 3 t + j joins corners j and j + 1 of triangle t; sides with one vertex twice are omitted.

    Args:
        sides: members of shape (3 m,), filled with sides, edge by edge; begins of shape (3 m + 1,), filled with where
            each edge's sides begin, and the end.

    Returns:
        number of edges.
    """
    order, begins = sides
    starts = np.zeros(vertices + 1, dtype=np.int64)
    high = np.empty(3 * len(triangles), dtype=np.int64)
    for t in range(len(triangles)):
        for j in range(3):
            a, b = triangles[t, j], triangles[t, (j + 1) % 3]
            high[3 * t + j] = max(a, b)
            if a != b:
                starts[min(a, b) + 1] += 1
    for v in range(vertices):
        starts[v + 1] += starts[v]
    cursor = starts[:-1].copy()
    for t in range(len(triangles)):
        for j in range(3):
            a, b = triangles[t, j], triangles[t, (j + 1) % 3]
            if a != b:
                low = min(a, b)
                order[cursor[low]] = 3 * t + j
                cursor[low] += 1
    edges = 0
    for v in range(vertices):
        first, last = starts[v], starts[v + 1]
        sort_by(order[first:last], high)
        for i in range(first, last):
            if i == first or high[order[i]] != high[order[i - 1]]:
                begins[edges] = i
                edges += 1
    begins[edges] = starts[vertices]
    return edges


@njit
def edge_cones(mesh: Mesh, sides: Groups, first: int, last: int, ends: NDArray[np.int64], cones: FloatArray) -> None:
    """Ends and normal cone of edges ``first`` to ``last - 1``.

    In the plane across the edge, with a = level direction and b = the upward one, normals are cos(phi) a + sin(phi) b.

    Args:
        sides: from `edge_sides`.
        ends: shape (e, 2), filled.
        cones: shape (e, 2), filled with the least and largest phi in [0, pi]; least > largest where nothing rests.
    """
    vertices, triangles = mesh
    order, begins = sides
    for e in range(first, last):
        side = order[begins[e]]
        t, j = side // 3, side % 3
        v0, v1 = triangles[t, j], triangles[t, (j + 1) % 3]
        ends[e, 0], ends[e, 1] = v0, v1
        cones[e, 0], cones[e, 1] = 1.0, 0.0
        ex = vertices[v1, 0] - vertices[v0, 0]
        ey = vertices[v1, 1] - vertices[v0, 1]
        ez = vertices[v1, 2] - vertices[v0, 2]
        level = math.hypot(ex, ey)
        length = math.hypot(level, ez)
        if level <= 1e-12 * length:
            continue
        ax, ay = ey / level, -ex / level
        bx, by, bz = -ex * ez / (level * length), -ey * ez / (level * length), level / length
        low, high = 0.0, math.pi
        doubt = 0.0
        for i in range(begins[e], begins[e + 1]):
            t, j = order[i] // 3, order[i] % 3
            v2 = triangles[t, (j + 2) % 3]
            wx = vertices[v2, 0] - vertices[v0, 0]
            wy = vertices[v2, 1] - vertices[v0, 1]
            wz = vertices[v2, 2] - vertices[v0, 2]
            u = wx * ax + wy * ay
            w = wx * bx + wy * by + wz * bz
            off = math.hypot(u, w)
            reach = abs(wx) + abs(wy) + abs(wz) + length
            if off <= 1e-12 * reach:
                continue
            doubt += 1e-14 * reach / off
            psi = math.atan2(w, u)
            if u >= 0.0:
                low = max(low, psi + 0.5 * math.pi)
            elif psi > 0.0:
                high = min(high, psi - 0.5 * math.pi)
            else:
                high = min(high, psi + 1.5 * math.pi)
        if high - low > _THIN_RAD - doubt:
            cones[e, 0] = max(0.0, low - _WIDEN_RAD - doubt)
            cones[e, 1] = min(math.pi, high + _WIDEN_RAD + doubt)


@njit
def vertex_edges(ends: NDArray[np.int64], vertices: int, edges: Groups) -> int:
    """List every vertex's edges.

    Args:
        edges: members of shape (2 e,), filled; begins of shape (n + 1,), zeros, filled with where each vertex's edges
            begin.

    Returns:
        the largest number of edges at one vertex.
    """
    listed, begins = edges
    for e in range(len(ends)):
        begins[ends[e, 0] + 1] += 1
        begins[ends[e, 1] + 1] += 1
    most = 0
    for v in range(vertices):
        most = max(most, begins[v + 1])
        begins[v + 1] += begins[v]
    cursor = begins[:-1].copy()
    for e in range(len(ends)):
        for k in range(2):
            v = ends[e, k]
            listed[cursor[v]] = e
            cursor[v] += 1
    return most


@njit
def vertex_cones(
    vertices: FloatArray,
    ends: NDArray[np.int64],
    edges: Groups,
    most: int,
    first: int,
    last: int,
    cones: FloatArray,
) -> None:
    """Box of the normal cone of vertices ``first`` to ``last - 1``.

    Normals are (x, y, 1) up to length: every edge is a half plane, and the cone a convex polygon that is clipped.

    Args:
        ends: from `edge_cones`.
        edges, most: from `vertex_edges`.
        cones: shape (n, 4), filled with least x, largest x, least y, largest y; least > largest where nothing rests.
    """
    listed, begins = edges
    px, py = np.empty(most + 8), np.empty(most + 8)
    qx, qy = np.empty(most + 8), np.empty(most + 8)
    for v in range(first, last):
        cones[v, 0], cones[v, 1], cones[v, 2], cones[v, 3] = 1.0, -1.0, 1.0, -1.0
        count = 4
        px[0], px[1], px[2], px[3] = -_STEEPEST, _STEEPEST, _STEEPEST, -_STEEPEST
        py[0], py[1], py[2], py[3] = -_STEEPEST, -_STEEPEST, _STEEPEST, _STEEPEST
        for i in range(begins[v], begins[v + 1]):
            e = listed[i]
            other = ends[e, 0] + ends[e, 1] - v
            ex = vertices[other, 0] - vertices[v, 0]
            ey = vertices[other, 1] - vertices[v, 1]
            ez = vertices[other, 2] - vertices[v, 2]
            length = math.sqrt(ex * ex + ey * ey + ez * ez)
            if length == 0.0:
                continue
            ex, ey, ez = ex / length, ey / length, ez / length + _THIN_RAD
            count = _clipped(px, py, count, ex, ey, ez, qx, qy)
            px, qx = qx, px
            py, qy = qy, py
            if count == 0:
                break
        if count > 0:
            cones[v, 0], cones[v, 1], cones[v, 2], cones[v, 3] = px[0], px[0], py[0], py[0]
            for i in range(1, count):
                cones[v, 0], cones[v, 1] = min(cones[v, 0], px[i]), max(cones[v, 1], px[i])
                cones[v, 2], cones[v, 3] = min(cones[v, 2], py[i]), max(cones[v, 3], py[i])


@inlined
def _clipped(
    px: FloatArray, py: FloatArray, count: int, ex: float, ey: float, ez: float, x: FloatArray, y: FloatArray
) -> int:
    """The part of a convex polygon where ex x + ey y + ez <= 0; fills in its corners and returns their number."""
    kept = 0
    x0, y0 = px[count - 1], py[count - 1]
    f0 = ex * x0 + ey * y0 + ez
    for k in range(count):
        x1, y1 = px[k], py[k]
        f1 = ex * x1 + ey * y1 + ez
        if (f0 <= 0.0) != (f1 <= 0.0):
            s = f0 / (f0 - f1)
            x[kept], y[kept] = x0 + s * (x1 - x0), y0 + s * (y1 - y0)
            kept += 1
        if f1 <= 0.0:
            x[kept], y[kept] = x1, y1
            kept += 1
        x0, y0, f0 = x1, y1, f1
    return kept


@njit
def face_slopes(vertices: FloatArray, triangles: NDArray[np.int64], normals: FloatArray) -> None:
    """Upward unit normals, shape (m, 3); nz = 0 for triangles on edge or without area."""
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ux, uy, uz = (
            vertices[b, 0] - vertices[a, 0],
            vertices[b, 1] - vertices[a, 1],
            vertices[b, 2] - vertices[a, 2],
        )
        wx, wy, wz = (
            vertices[c, 0] - vertices[a, 0],
            vertices[c, 1] - vertices[a, 1],
            vertices[c, 2] - vertices[a, 2],
        )
        nx, ny, nz = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
        length = math.sqrt(nx * nx + ny * ny + nz * nz)
        scale = (abs(ux) + abs(uy) + abs(uz)) * (abs(wx) + abs(wy) + abs(wz))
        if length <= 1e-14 * scale or abs(nz) <= 1e-12 * length:
            normals[t, 0], normals[t, 1], normals[t, 2] = 0.0, 0.0, 0.0
            continue
        sign = 1.0 / length if nz > 0.0 else -1.0 / length
        normals[t, 0], normals[t, 1], normals[t, 2] = nx * sign, ny * sign, nz * sign
