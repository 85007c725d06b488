"""Triangles joined to a mesh, and sections of it with parallel planes, chained to rings by shared edges; compiled.

A vertex on a plane counts as above it. So every triangle that reaches both sides has exactly one edge that goes up
through the plane and one that goes down, whether or not vertices, edges or whole faces lie on it, and no tolerance
decides anything. The point on an edge is computed from the edge alone, never from the triangle.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.sorting_kernels import order_of
from twin.jit import helper, njit


@njit
def weld(points: NDArray[np.int64], ids: NDArray[np.int64], first: NDArray[np.int64]) -> int:
    """Give equal points equal numbers, in the order in which they come first.

    Args:
        points: shape (n, 3), whole units.
        ids: shape (n,), filled.
        first: shape (n,), filled with the row where each number comes first.

    Returns:
        Number of different points.
    """
    size = 16
    while size < 2 * len(points):
        size *= 2
    table = np.full(size, -1, dtype=np.int64)
    count = 0
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        # shifts and exclusive ors only: products would overflow, which is loud without the compiler
        mixed = x ^ (y << np.int64(21)) ^ (z << np.int64(42))
        mixed ^= y ^ (z >> np.int64(7))
        mixed ^= mixed << np.int64(13)
        mixed ^= (mixed >> np.int64(7)) & np.int64(0x1FFFFFFFFFFFFFF)
        mixed ^= mixed << np.int64(17)
        slot = (mixed ^ (mixed >> np.int64(31))) & np.int64(size - 1)
        while True:
            known = table[slot]
            if known < 0:
                table[slot] = count
                first[count] = i
                ids[i] = count
                count += 1
                break
            j = first[known]
            if points[j, 0] == x and points[j, 1] == y and points[j, 2] == z:
                ids[i] = known
                break
            slot = (slot + 1) & np.int64(size - 1)
    return count


@njit
def number_edges(
    triangles: NDArray[np.int64],
    vertices: int,
    ends: NDArray[np.int64],
    uses: NDArray[np.int64],
    sides: NDArray[np.int64],
) -> int:
    """Number the edges of triangles, by the lower of their vertices.

    Args:
        triangles: shape (m, 3), no corner twice.
        vertices: number of vertices.
        ends: shape (3 m, 2), filled with the vertices of each edge, lower number first.
        uses: shape (3 m, 2), filled: how many triangles run along it from lower to higher vertex, and back.
        sides: shape (m, 3), filled: edge j of a triangle joins its corners j and j + 1.

    Returns:
        Number of edges.
    """
    begins = np.zeros(vertices + 1, dtype=np.int64)
    for t in range(len(triangles)):
        for j in range(3):
            begins[min(triangles[t, j], triangles[t, (j + 1) % 3]) + 1] += 1
    for v in range(vertices):
        begins[v + 1] += begins[v]
    held = np.zeros(vertices, dtype=np.int64)
    found = np.empty(3 * len(triangles), dtype=np.int64)
    count = 0
    for t in range(len(triangles)):
        for j in range(3):
            a, b = triangles[t, j], triangles[t, (j + 1) % 3]
            low, high = min(a, b), max(a, b)
            edge = -1
            for m in range(begins[low], begins[low] + held[low]):
                if ends[found[m], 1] == high:
                    edge = found[m]
                    break
            if edge < 0:
                edge = count
                count += 1
                ends[edge, 0], ends[edge, 1] = low, high
                uses[edge, 0], uses[edge, 1] = 0, 0
                found[begins[low] + held[low]] = edge
                held[low] += 1
            uses[edge, 0 if a < b else 1] += 1
            sides[t, j] = edge
    return count


@njit
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


@njit
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


@njit
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
        rows (plane, first, one past the last entry in ``order``), one per ring.
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


@njit
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


@njit
def clean_rings(
    points: FloatArray,
    rings: NDArray[np.int64],
    units: float,
    least: float,
    whole: NDArray[np.int64],
    kept: NDArray[np.int64],
) -> int:
    """Round rings to whole units, without points that repeat or lie exactly on a straight line, and without slivers.

    Args:
        points: shape (n, 2).
        rings: rows (plane, first, one past the last point).
        units: whole units a mm.
        least: smallest area kept, square units.
        whole: shape (n, 2), filled.
        kept: shape (r, 3), filled with rows like ``rings``.

    Returns:
        Number of rings kept.
    """
    count, n = 0, 0
    for r in range(len(rings)):
        first = n
        for i in range(rings[r, 1], rings[r, 2]):
            u, v = int(np.rint(points[i, 0] * units)), int(np.rint(points[i, 1] * units))
            if n > first and whole[n - 1, 0] == u and whole[n - 1, 1] == v:
                continue
            while n > first + 1 and _straight(whole[n - 2, 0], whole[n - 2, 1], whole[n - 1, 0], whole[n - 1, 1], u, v):
                n -= 1
            if n > first and whole[n - 1, 0] == u and whole[n - 1, 1] == v:
                continue
            whole[n, 0], whole[n, 1] = u, v
            n += 1
        begin = first
        while n - begin > 2:
            u, v = whole[begin, 0], whole[begin, 1]
            same = whole[n - 1, 0] == u and whole[n - 1, 1] == v
            if same or _straight(whole[n - 2, 0], whole[n - 2, 1], whole[n - 1, 0], whole[n - 1, 1], u, v):
                n -= 1
            elif _straight(whole[n - 1, 0], whole[n - 1, 1], u, v, whole[begin + 1, 0], whole[begin + 1, 1]):
                begin += 1
            else:
                break
        if n - begin > 2 and abs(_twice_area(whole, begin, n)) > 2.0 * least:
            kept[count, 0], kept[count, 1], kept[count, 2] = rings[r, 0], begin, n
            count += 1
        else:
            n = first
    return count


@helper
def _straight(au: int, av: int, bu: int, bv: int, cu: int, cv: int) -> bool:
    """Whether b lies on the line through a and c, exactly."""
    return (bu - au) * (cv - bv) == (bv - av) * (cu - bu)


@helper
def _twice_area(whole: NDArray[np.int64], first: int, last: int) -> float:
    """Twice the area of a ring, counter-clockwise positive."""
    total = 0.0
    u0, v0 = whole[first, 0], whole[first, 1]
    for i in range(first + 1, last - 1):
        total += float(whole[i, 0] - u0) * float(whole[i + 1, 1] - v0)
        total -= float(whole[i + 1, 0] - u0) * float(whole[i, 1] - v0)
    return total


@helper
def _side(au: int, av: int, bu: int, bv: int, cu: int, cv: int) -> int:
    """1, 0, -1: c lies left of, on, right of the line from a to b, exactly."""
    cross = (bu - au) * (cv - av) - (bv - av) * (cu - au)
    return 1 if cross > 0 else (-1 if cross < 0 else 0)


@njit
def simple_planes(whole: NDArray[np.int64], rings: NDArray[np.int64], simple: NDArray[np.bool_]) -> None:
    """Which planes have rings that neither cross nor touch, material on their left: nothing is to be united there.

    Args:
        whole: points in whole units.
        rings: rows (plane, first, one past the last point), by plane.
        simple: shape (planes,), filled.
    """
    simple[:] = True
    begin = 0
    while begin < len(rings):
        end = begin
        while end < len(rings) and rings[end, 0] == rings[begin, 0]:
            end += 1
        mine = rings[begin:end]
        simple[rings[begin, 0]] = not _any_touch(whole, mine) and _well_nested(whole, mine)
        begin = end


@helper
def _any_touch(whole: NDArray[np.int64], rings: NDArray[np.int64]) -> bool:
    """Whether edges of rings meet anywhere but at the corner between neighbours: a sweep along u."""
    count = 0
    for r in range(len(rings)):
        count += rings[r, 2] - rings[r, 1]
    tail, tip = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    low = np.empty(count, dtype=np.int64)
    n = 0
    for r in range(len(rings)):
        for i in range(rings[r, 1], rings[r, 2]):
            j = i + 1 if i + 1 < rings[r, 2] else rings[r, 1]
            tail[n], tip[n] = i, j
            low[n] = min(whole[i, 0], whole[j, 0])
            n += 1
    order = order_of(low)
    active = np.empty(count, dtype=np.int64)
    held = 0
    for e in order:
        a, b = tail[e], tip[e]
        au, av, bu, bv = whole[a, 0], whole[a, 1], whole[b, 0], whole[b, 1]
        bottom, top = min(av, bv), max(av, bv)
        left, stay = low[e], 0
        for m in range(held):
            f = active[m]
            c, d = tail[f], tip[f]
            if max(whole[c, 0], whole[d, 0]) < left:
                continue
            active[stay] = f
            stay += 1
            cv, dv = whole[c, 1], whole[d, 1]
            if max(cv, dv) < bottom or min(cv, dv) > top:
                continue
            cu, du = whole[c, 0], whole[d, 0]
            if d == a or b == c:
                # neighbours: only a turn straight back lets them meet elsewhere
                x, y, z = (c, a, b) if d == a else (a, b, d)
                if _side(whole[x, 0], whole[x, 1], whole[y, 0], whole[y, 1], whole[z, 0], whole[z, 1]) == 0:
                    return True
                continue
            if (
                _side(au, av, bu, bv, cu, cv) * _side(au, av, bu, bv, du, dv) <= 0
                and _side(cu, cv, du, dv, au, av) * _side(cu, cv, du, dv, bu, bv) <= 0
            ):
                return True
        active[stay] = e
        held = stay + 1
    return False


@helper
def _well_nested(whole: NDArray[np.int64], rings: NDArray[np.int64]) -> bool:
    """Whether just outside of every counter-clockwise ring there is nothing, and of every clockwise one material."""
    for r in range(len(rings)):
        u, v = whole[rings[r, 1], 0], whole[rings[r, 1], 1]
        winding = 0
        for s in range(len(rings)):
            if s == r:
                continue
            for i in range(rings[s, 1], rings[s, 2]):
                j = i + 1 if i + 1 < rings[s, 2] else rings[s, 1]
                if whole[i, 0] <= u < whole[j, 0]:
                    winding -= _side(whole[i, 0], whole[i, 1], whole[j, 0], whole[j, 1], u, v) < 0
                elif whole[j, 0] <= u < whole[i, 0]:
                    winding += _side(whole[i, 0], whole[i, 1], whole[j, 0], whole[j, 1], u, v) > 0
        if winding != (0 if _twice_area(whole, rings[r, 1], rings[r, 2]) > 0.0 else 1):
            return False
    return True
