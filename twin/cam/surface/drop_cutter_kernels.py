"""Where a tool lowered along its axis first touches a surface of faces, edges and vertices; compiled.

The tool tip's height over a plan point is the largest of z - h(r) over all points of the surface within the tool's
radius, h its meridian. It is found on a face where the normals of face and tool agree, inside an edge, or at a vertex.
Seen from the tool, every element is a patch of the plan: the positions at which the tool can rest on it. Patches are
listed in the cells of a grid; a query asks the elements of one cell. Patches may be drawn too large, never too small:
every element asked gives a true contact, so the largest is right however many are asked.

``tool`` is `twin.tools.shape.ToolShape.parameters`: disc, corner, tan(taper), arc radius, arc height, height, radius.
Elements are numbered faces first, then edges, then vertices.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import njit

#: Patches are enlarged by this much, mm.
_MARGIN = 1e-6
#: A face reaches beyond its sides by this part of them, so that neighbours leave no gap.
_BEYOND = 1e-9
#: Largest angle of an edge's cone that is drawn as one box, rad.
_PIECE_RAD = 0.2


@njit
def _profile(tool: FloatArray, rho: float) -> float:
    """Height of the tool's surface above the tip at a distance from the axis, at most the radius."""
    if rho <= tool[0]:
        return 0.0
    if rho <= tool[3]:
        d = rho - tool[0]
        return tool[1] - math.sqrt(max(0.0, tool[1] * tool[1] - d * d))
    if tool[2] > 0.0:
        return tool[4] + (rho - tool[3]) / tool[2]
    return tool[4]


@njit
def face_patches(
    vertices: FloatArray, triangles: NDArray[np.int64], normals: FloatArray, tool: FloatArray, faces: FloatArray
) -> None:
    """Faces as seen from the tool tip.

    Args:
        normals: shape (m, 3), upward unit normals, nz = 0 for faces that nothing rests on.
        faces: shape (m, 10), filled: x, y, z of the tip over the first corner, the two rows that turn a place beside it
            into barycentric coordinates, height of the other corners above the first, largest height of the tip.
    """
    for t in range(len(triangles)):
        nx, ny, nz = normals[t, 0], normals[t, 1], normals[t, 2]
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ux, uy = vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1]
        wx, wy = vertices[c, 0] - vertices[a, 0], vertices[c, 1] - vertices[a, 1]
        det = ux * wy - uy * wx
        if nz <= 0.0 or det == 0.0:
            faces[t, 9] = -math.inf
            continue
        slope = math.hypot(nx, ny)
        shift, height = 0.0, 0.0
        if slope > 1e-12:
            if tool[2] > 0.0 and slope * tool[2] >= nz:
                shift, height = tool[6] / slope, tool[5]
            else:
                shift, height = (tool[0] + tool[1] * slope) / slope, tool[1] * (1.0 - nz)
        faces[t, 0] = vertices[a, 0] + shift * nx
        faces[t, 1] = vertices[a, 1] + shift * ny
        faces[t, 2] = vertices[a, 2] - height
        faces[t, 3], faces[t, 4] = wy / det, -wx / det
        faces[t, 5], faces[t, 6] = -uy / det, ux / det
        faces[t, 7] = vertices[b, 2] - vertices[a, 2]
        faces[t, 8] = vertices[c, 2] - vertices[a, 2]
        faces[t, 9] = faces[t, 2] + max(0.0, faces[t, 7], faces[t, 8])


@njit
def edge_patches(vertices: FloatArray, ends: NDArray[np.int64], edges: FloatArray) -> None:
    """Edges as queries need them.

    Args:
        edges: shape (e, 9), filled: first end, level direction, level length, rise, rise over length, largest z.
    """
    for e in range(len(ends)):
        a, b = ends[e, 0], ends[e, 1]
        ux, uy = vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1]
        rise = vertices[b, 2] - vertices[a, 2]
        level = math.hypot(ux, uy)
        edges[e, 0], edges[e, 1], edges[e, 2] = vertices[a, 0], vertices[a, 1], vertices[a, 2]
        edges[e, 3], edges[e, 4] = (ux / level, uy / level) if level > 0.0 else (1.0, 0.0)
        edges[e, 5], edges[e, 6] = level, rise
        edges[e, 7] = rise / math.hypot(level, rise) if level > 0.0 else 0.0
        edges[e, 8] = max(vertices[a, 2], vertices[b, 2])


@njit
def _list_patch(
    x0: float,
    y0: float,
    x1: float,
    y1: float,
    x2: float,
    y2: float,
    box: FloatArray,
    grid: FloatArray,
    columns: int,
    rows: int,
    element: int,
    fill: bool,
    counts: NDArray[np.int64],
    entries: NDArray[np.int32],
) -> None:
    """List an element in the cells that a triangle, or a segment (third corner = second), widened by a box touches.

    Args:
        box: least x, largest x, least y, largest y that are added.
        grid: x and y of the low corner, cell size.
        counts: shape (cells,); counted up, or with ``fill`` the places of the next entries.
    """
    low_x = min(x0, x1, x2) + box[0] - _MARGIN
    high_x = max(x0, x1, x2) + box[1] + _MARGIN
    low_y = min(y0, y1, y2) + box[2] - _MARGIN
    high_y = max(y0, y1, y2) + box[3] + _MARGIN
    size = grid[2]
    left = max(0, int(math.floor((low_x - grid[0]) / size)))
    right = min(columns - 1, int(math.floor((high_x - grid[0]) / size)))
    bottom = max(0, int(math.floor((low_y - grid[1]) / size)))
    top = min(rows - 1, int(math.floor((high_y - grid[1]) / size)))
    simple = right - left <= 1 or top - bottom <= 0
    for row in range(bottom, top + 1):
        first, last = left, right
        if not simple:
            # the part of the triangle that the box brings into this row
            below = grid[1] + row * size - box[3] - _MARGIN
            above = grid[1] + (row + 1) * size - box[2] + _MARGIN
            least, most = math.inf, -math.inf
            ax, ay = x2, y2
            for k in range(3):
                bx, by = x0, y0
                if k == 1:
                    bx, by = x1, y1
                elif k == 2:
                    bx, by = x2, y2
                if min(ay, by) <= above and max(ay, by) >= below:
                    if ay == by:
                        least, most = min(least, ax, bx), max(most, ax, bx)
                    else:
                        s0 = min(max((below - ay) / (by - ay), 0.0), 1.0)
                        s1 = min(max((above - ay) / (by - ay), 0.0), 1.0)
                        xs0, xs1 = ax + s0 * (bx - ax), ax + s1 * (bx - ax)
                        least, most = min(least, xs0, xs1), max(most, xs0, xs1)
                ax, ay = bx, by
            if least > most:
                continue
            first = max(first, int(math.floor((least + box[0] - _MARGIN - grid[0]) / size)))
            last = min(last, int(math.floor((most + box[1] + _MARGIN - grid[0]) / size)))
        for cell in range(row * columns + first, row * columns + last + 1):
            if fill:
                entries[counts[cell]] = element
            counts[cell] += 1


@njit
def _widen_by_tool(
    tool: FloatArray,
    level: FloatArray,
    azimuth: FloatArray,
    steep: bool,
    box: FloatArray,
) -> None:
    """Box of contact offsets from boxes of the normals' level part and of its direction."""
    for k in range(2):
        low, high = 2 * k, 2 * k + 1
        box[low] = tool[1] * level[low] + tool[0] * azimuth[low]
        box[high] = tool[1] * level[high] + tool[0] * azimuth[high]
        if tool[2] > 0.0 and steep:
            box[low] = min(box[low], tool[3] * azimuth[low], tool[6] * azimuth[low])
            box[high] = max(box[high], tool[3] * azimuth[high], tool[6] * azimuth[high])
        box[low] = max(box[low], -tool[6])
        box[high] = min(box[high], tool[6])


@njit
def list_faces(
    vertices: FloatArray,
    triangles: NDArray[np.int64],
    faces: FloatArray,
    first: int,
    last: int,
    grid: FloatArray,
    columns: int,
    rows: int,
    fill: bool,
    counts: NDArray[np.int64],
    entries: NDArray[np.int32],
) -> None:
    """Count faces ``first`` to ``last - 1`` in the cells of their patches, or list them."""
    box = np.zeros(4)
    for t in range(first, last):
        if faces[t, 9] == -math.inf:
            continue
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        x0, y0 = faces[t, 0], faces[t, 1]
        x1, y1 = x0 + vertices[b, 0] - vertices[a, 0], y0 + vertices[b, 1] - vertices[a, 1]
        x2, y2 = x0 + vertices[c, 0] - vertices[a, 0], y0 + vertices[c, 1] - vertices[a, 1]
        _list_patch(x0, y0, x1, y1, x2, y2, box, grid, columns, rows, t, fill, counts, entries)


@njit
def list_edges(
    edges: FloatArray,
    cones: FloatArray,
    first: int,
    last: int,
    number: int,
    tool: FloatArray,
    grid: FloatArray,
    columns: int,
    rows: int,
    fill: bool,
    counts: NDArray[np.int64],
    entries: NDArray[np.int32],
) -> None:
    """Count edges ``first`` to ``last - 1`` in the cells of their patches, or list them.

    Args:
        number: number of the first such element.
    """
    box, level, azimuth = np.empty(4), np.empty(4), np.zeros(4)
    for e in range(first, last):
        if cones[e, 0] > cones[e, 1]:
            continue
        x0, y0, hx, hy, length, tilt = edges[e, 0], edges[e, 1], edges[e, 3], edges[e, 4], edges[e, 5], edges[e, 7]
        ax, ay = hy, -hx
        bx, by, bz = -hx * tilt, -hy * tilt, math.sqrt(max(0.0, 1.0 - tilt * tilt))
        pieces = max(1, int(math.ceil((cones[e, 1] - cones[e, 0]) / _PIECE_RAD)))
        step = (cones[e, 1] - cones[e, 0]) / pieces
        bulge = 1.0 - math.cos(0.5 * step) + 1e-12
        for piece in range(pieces):
            low = cones[e, 0] + piece * step
            n0x, n0y = math.cos(low) * ax + math.sin(low) * bx, math.cos(low) * ay + math.sin(low) * by
            n1x = math.cos(low + step) * ax + math.sin(low + step) * bx
            n1y = math.cos(low + step) * ay + math.sin(low + step) * by
            level[0], level[1] = min(n0x, n1x) - bulge, max(n0x, n1x) + bulge
            level[2], level[3] = min(n0y, n1y) - bulge, max(n0y, n1y) + bulge
            if tool[0] > 0.0 or tool[2] > 0.0:
                r0, r1 = math.hypot(n0x, n0y), math.hypot(n1x, n1y)
                if min(r0, r1) < 1e-6 or (abs(tilt) < 1e-6 and low < 0.5 * math.pi < low + step):
                    azimuth[0], azimuth[1], azimuth[2], azimuth[3] = -1.0, 1.0, -1.0, 1.0
                else:
                    turn = math.atan2(abs(n0x * n1y - n0y * n1x), n0x * n1x + n0y * n1y)
                    out = 1.0 - math.cos(0.5 * turn) + 1e-9
                    azimuth[0], azimuth[1] = min(n0x / r0, n1x / r1) - out, max(n0x / r0, n1x / r1) + out
                    azimuth[2], azimuth[3] = min(n0y / r0, n1y / r1) - out, max(n0y / r0, n1y / r1) + out
            nz = bz * min(math.sin(low), math.sin(low + step))
            steep = tool[2] * math.sqrt(max(0.0, 1.0 - nz * nz)) >= nz - 1e-6
            _widen_by_tool(tool, level, azimuth, steep, box)
            x1, y1 = x0 + length * hx, y0 + length * hy
            _list_patch(x0, y0, x1, y1, x1, y1, box, grid, columns, rows, number + e, fill, counts, entries)


@njit
def _largest_share(high: float, least: float, most: float, one: float) -> float:
    """Largest x / sqrt(one + x x + y y) with x <= high and y in [least, most]."""
    if high >= 1e6:
        return 1.0
    across = max(abs(least), abs(most))
    if high > 0.0:
        across = 0.0 if least <= 0.0 <= most else min(abs(least), abs(most))
    root = math.sqrt(one + high * high + across * across)
    return high / root if root > 0.0 else 1.0


@njit
def list_vertices(
    vertices: FloatArray,
    cones: FloatArray,
    first: int,
    last: int,
    number: int,
    tool: FloatArray,
    grid: FloatArray,
    columns: int,
    rows: int,
    fill: bool,
    counts: NDArray[np.int64],
    entries: NDArray[np.int32],
) -> None:
    """Count vertices ``first`` to ``last - 1`` in the cells of their patches, or list them.

    Args:
        number: number of the first such element.
    """
    box, level, azimuth = np.empty(4), np.empty(4), np.empty(4)
    for v in range(first, last):
        if cones[v, 0] > cones[v, 1]:
            continue
        x0, x1, y0, y1 = cones[v, 0] - 1e-9, cones[v, 1] + 1e-9, cones[v, 2] - 1e-9, cones[v, 3] + 1e-9
        level[0], level[1] = -_largest_share(-x0, y0, y1, 1.0), _largest_share(x1, y0, y1, 1.0)
        level[2], level[3] = -_largest_share(-y0, x0, x1, 1.0), _largest_share(y1, x0, x1, 1.0)
        azimuth[0], azimuth[1] = -_largest_share(-x0, y0, y1, 0.0), _largest_share(x1, y0, y1, 0.0)
        azimuth[2], azimuth[3] = -_largest_share(-y0, x0, x1, 0.0), _largest_share(y1, x0, x1, 0.0)
        steepest = math.hypot(max(abs(x0), abs(x1)), max(abs(y0), abs(y1)))
        _widen_by_tool(tool, level, azimuth, tool[2] * steepest >= 1.0 - 1e-6, box)
        x, y = vertices[v, 0], vertices[v, 1]
        _list_patch(x, y, x, y, x, y, box, grid, columns, rows, number + v, fill, counts, entries)


@njit
def _resting_place(tool: FloatArray, slope: float, q: float, limit: float) -> float:
    """Where along a line the tool rests: s in [0, limit] with the largest slope s - h(sqrt(q q + s s)), slope >= 0.

    h is convex, so the derivative falls; it is solved on the corner arc for the angle kappa of the normal by Newton
    steps kept in a bracket, and in closed form elsewhere.
    """
    disc, corner, tangent, arc = tool[0], tool[1], tool[2], tool[3]
    flat = math.sqrt(max(0.0, disc * disc - q * q))
    if slope == 0.0:
        return 0.0
    if q < arc and corner > 0.0:
        end = math.sqrt(arc * arc - q * q)
        wall = math.inf if tangent == 0.0 else 1.0 / tangent
        if wall * end / arc >= slope:
            # with t = tan(kappa): t s = slope rho, rho = disc + corner t / sqrt(1 + t t), s = sqrt(rho rho - q q)
            sine = max(0.0, (q - disc) / corner)
            low, high = slope, wall
            if sine > 0.0:
                low = max(slope, sine / math.sqrt(max(1e-300, 1.0 - sine * sine)))
            t = low * (1.0 + 1e-3) if sine > 0.0 else low
            s = 0.0
            for _ in range(80):
                root = math.sqrt(1.0 + t * t)
                rho = disc + corner * t / root
                s = math.sqrt(max(0.0, rho * rho - q * q))
                value = t * s - slope * rho
                if value > 0.0:
                    high = min(high, t)
                else:
                    low = max(low, t)
                following = -1.0
                if s > 0.0:
                    turn = corner / (root * root * root)
                    rise = s + t * rho * turn / s - slope * turn
                    if rise > 0.0:
                        following = t - value / rise
                if not low <= following <= high:
                    following = 0.5 * (low + high) if high < math.inf else 2.0 * low
                done = abs(following - t) <= 1e-9 * t
                t = following
                if done:
                    break
            rho = disc + corner * t / math.sqrt(1.0 + t * t)
            return min(limit, math.sqrt(max(0.0, rho * rho - q * q)))
        flat = end
    if tangent > 0.0:
        wall = 1.0 / tangent
        if slope < wall:
            return min(limit, max(flat, slope * q / math.sqrt(wall * wall - slope * slope)))
        return limit
    return min(limit, flat)


@njit
def _tip_on_edge(
    tool: FloatArray, ball: bool, edge: FloatArray, x: float, y: float, best: float
) -> tuple[float, float]:
    """Height of the tip of a tool resting on a closed edge, and where it touches, 0 to 1.

    -inf out of reach, or where the height cannot be above ``best``.
    """
    ex, ey = x - edge[0], y - edge[1]
    q = abs(ex * edge[4] - ey * edge[3])
    rest = tool[6] * tool[6] - q * q
    if rest < 0.0:
        return -math.inf, 0.0
    root = math.sqrt(rest)
    foot = ex * edge[3] + ey * edge[4]
    low, high = max(-foot, -root), min(edge[5] - foot, root)
    if low > high:
        return -math.inf, 0.0
    if ball:
        s = min(max(root * edge[7], low), high)
        part = min(max((foot + s) / edge[5], 0.0), 1.0)
        return edge[2] + part * edge[6] + math.sqrt(max(0.0, rest - s * s)) - tool[6], part
    slope = edge[6] / edge[5]
    part = min(max((foot + (high if slope > 0.0 else low)) / edge[5], 0.0), 1.0)
    if edge[2] + part * edge[6] - _profile(tool, min(tool[6], q)) <= best:
        return -math.inf, 0.0
    s = _resting_place(tool, abs(slope), q, root)
    s = min(max(s if slope >= 0.0 else -s, low), high)
    part = min(max((foot + s) / edge[5], 0.0), 1.0)
    return edge[2] + part * edge[6] - _profile(tool, min(tool[6], math.sqrt(q * q + s * s))), part


@njit
def drop(
    points: FloatArray,
    first: int,
    last: int,
    floor: float,
    tool: FloatArray,
    faces: FloatArray,
    edges: FloatArray,
    vertices: FloatArray,
    grid: FloatArray,
    columns: int,
    rows: int,
    begins: NDArray[np.int64],
    entries: NDArray[np.int32],
    heights: FloatArray,
    elements: NDArray[np.int32],
) -> None:
    """Heights of the tool tip over points ``first`` to ``last - 1``, and the elements touched, -1 for the floor."""
    ball = tool[0] == 0.0 and tool[2] == 0.0 and tool[1] == tool[6]
    face_count, edge_count = len(faces), len(edges)
    for i in range(first, last):
        x, y = points[i, 0], points[i, 1]
        best, touched = floor, -1
        # compared before they become whole numbers: a place may be far off, or no number at all
        column, row = (x - grid[0]) / grid[2], (y - grid[1]) / grid[2]
        if 0.0 <= column < columns and 0.0 <= row < rows:
            cell = int(row) * columns + int(column)
            for k in range(begins[cell], begins[cell + 1]):
                n = entries[k]
                if n < face_count:
                    f = faces[n]
                    if f[9] <= best:
                        continue
                    dx, dy = x - f[0], y - f[1]
                    u = dx * f[3] + dy * f[4]
                    w = dx * f[5] + dy * f[6]
                    if u < -_BEYOND or w < -_BEYOND or u + w > 1.0 + _BEYOND:
                        continue
                    z = f[2] + u * f[7] + w * f[8]
                elif n < face_count + edge_count:
                    if edges[n - face_count, 8] <= best:
                        continue
                    z, _ = _tip_on_edge(tool, ball, edges[n - face_count], x, y, best)
                else:
                    v = vertices[n - face_count - edge_count]
                    if v[2] <= best:
                        continue
                    rho2 = (x - v[0]) ** 2 + (y - v[1]) ** 2
                    if rho2 > tool[6] * tool[6]:
                        continue
                    z = v[2] - _profile(tool, math.sqrt(rho2))
                if z > best:
                    best, touched = z, n
        heights[i], elements[i] = best, touched


@njit
def contacts(
    points: FloatArray,
    elements: NDArray[np.int32],
    tool: FloatArray,
    triangles: NDArray[np.int64],
    faces: FloatArray,
    edges: FloatArray,
    vertices: FloatArray,
    places: FloatArray,
) -> None:
    """Where the tool touches the element found for each point, shape (n, 3); NaN for the floor."""
    ball = tool[0] == 0.0 and tool[2] == 0.0 and tool[1] == tool[6]
    face_count, edge_count = len(faces), len(edges)
    for i in range(len(points)):
        n = elements[i]
        if n < 0:
            places[i, 0], places[i, 1], places[i, 2] = math.nan, math.nan, math.nan
        elif n < face_count:
            f = faces[n]
            dx, dy = points[i, 0] - f[0], points[i, 1] - f[1]
            u, w = dx * f[3] + dy * f[4], dx * f[5] + dy * f[6]
            a, b, c = triangles[n, 0], triangles[n, 1], triangles[n, 2]
            for k in range(3):
                places[i, k] = (1.0 - u - w) * vertices[a, k] + u * vertices[b, k] + w * vertices[c, k]
        elif n < face_count + edge_count:
            edge = edges[n - face_count]
            _, part = _tip_on_edge(tool, ball, edge, points[i, 0], points[i, 1], -math.inf)
            places[i, 0] = edge[0] + part * edge[5] * edge[3]
            places[i, 1] = edge[1] + part * edge[5] * edge[4]
            places[i, 2] = edge[2] + part * edge[6]
        else:
            for k in range(3):
                places[i, k] = vertices[n - face_count - edge_count, k]
