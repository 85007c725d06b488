"""Where a tool lowered along its axis first touches a surface of faces, edges and vertices; compiled.

The tool tip's height over a plan point is the largest of z - ζ(r) over all points of the surface within the tool's
radius, ζ its meridian. It is found on a face where the normals of face and tool agree, inside an edge, or at a vertex.
Seen from the tool, every element is a patch of the plan: the positions at which the tool can rest on it. Patches are
listed in the cells of a grid; a query tests the elements of one cell. Patches may be drawn too large, never too small:
every element tested gives a true contact, so the largest is right however many are tested.

Elements are numbered faces first, then edges, then vertices.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import helper, njit
from twin.tools.meridian import Meridian
from twin.tools.meridian_kernels import is_ball, profile_height, resting_offset

#: Patches are enlarged by this much, mm.
_MARGIN = 1e-6
#: A face reaches beyond its sides by this part of them, so that neighbours leave no gap.
_BEYOND = 1e-9
#: Largest angle of an edge's cone that is drawn as one box, rad.
_PIECE_RAD = 0.2
#: Numbers of a face and of an edge, the columns of their tables.
FACE_COLUMNS, EDGE_COLUMNS = 10, 9
_FACE_TOP, _EDGE_TOP = FACE_COLUMNS - 1, EDGE_COLUMNS - 1


class Face(NamedTuple):
    """A face as seen from the tool tip; one row of `face_patches`.

    Attributes:
        x, y, z: the tip where the tool touches the face at its first corner.
        ux, uy, wx, wy: rows that turn plan coordinates from there into barycentric coordinates u, w.
        rise_u, rise_w: height of the second and third corner above the first.
        top: largest height of the tip, -inf for faces that nothing rests on.
    """

    x: float
    y: float
    z: float
    ux: float
    uy: float
    wx: float
    wy: float
    rise_u: float
    rise_w: float
    top: float


class Edge(NamedTuple):
    """An edge; one row of `edge_patches`.

    Attributes:
        x, y, z: first end.
        ux, uy: direction in the plan.
        length: level length.
        rise: height of the second end above the first.
        tilt: rise over length, in space.
        top: height of the higher end.
    """

    x: float
    y: float
    z: float
    ux: float
    uy: float
    length: float
    rise: float
    tilt: float
    top: float


class Elements(NamedTuple):
    """All that a tool can touch: tables of faces, edges and vertices, and the corners of each face."""

    faces: FloatArray
    edges: FloatArray
    vertices: FloatArray
    triangles: NDArray[np.int64]


class Grid(NamedTuple):
    """Square cells over the plan: low corner, size, columns and rows."""

    x: float
    y: float
    size: float
    columns: int
    rows: int


class Lists(NamedTuple):
    """Elements of every cell: cell c has ``entries[begins[c] : begins[c + 1]]``."""

    begins: NDArray[np.int64]
    entries: NDArray[np.int32]


class Cutter(NamedTuple):
    """A tool over a surface, ready for queries; ``floor`` is the least height of the tip."""

    tool: Meridian
    floor: float
    elements: Elements
    grid: Grid
    lists: Lists


class Listing(NamedTuple):
    """Lists in the making.

    Attributes:
        fill: whether elements are entered, or only counted.
        counts: shape (cells,); counted up, or with ``fill`` where the next entry of each cell goes.
        entries: filled with ``fill``.
    """

    fill: bool
    counts: NDArray[np.int64]
    entries: NDArray[np.int32]


class Box(NamedTuple):
    """Least x, largest x, least y, largest y."""

    low_x: float
    high_x: float
    low_y: float
    high_y: float


class _Triangle(NamedTuple):
    """Three points of the plan; an edge has the last two equal, a vertex all three."""

    x0: float
    y0: float
    x1: float
    y1: float
    x2: float
    y2: float


@helper
def face_at(faces: FloatArray, n: int) -> Face:
    """Row n of a table of faces."""
    f = faces[n]
    return Face(f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[8], f[9])


@helper
def edge_at(edges: FloatArray, n: int) -> Edge:
    """Row n of a table of edges."""
    e = edges[n]
    return Edge(e[0], e[1], e[2], e[3], e[4], e[5], e[6], e[7], e[8])


@njit
def face_patches(
    vertices: FloatArray, triangles: NDArray[np.int64], normals: FloatArray, tool: Meridian, faces: FloatArray
) -> None:
    """Faces as seen from the tool tip.

    Args:
        normals: shape (m, 3), upward unit normals, nz = 0 for faces that nothing rests on.
        faces: shape (m, FACE_COLUMNS), filled with a `Face` each; of faces that nothing rests on the last number only.
    """
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ux, uy = vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1]
        wx, wy = vertices[c, 0] - vertices[a, 0], vertices[c, 1] - vertices[a, 1]
        det = ux * wy - uy * wx
        nx, ny, nz = normals[t, 0], normals[t, 1], normals[t, 2]
        if nz <= 0.0 or det == 0.0:
            faces[t, _FACE_TOP] = -math.inf
            continue
        shift, height = _contact_offset(nx, ny, nz, tool)
        x, y, z = vertices[a, 0] + shift * nx, vertices[a, 1] + shift * ny, vertices[a, 2] - height
        rise_u, rise_w = vertices[b, 2] - vertices[a, 2], vertices[c, 2] - vertices[a, 2]
        top = z + max(0.0, rise_u, rise_w)
        _put_face(faces[t], Face(x, y, z, wy / det, -wx / det, -uy / det, ux / det, rise_u, rise_w, top))


@helper
def _put_face(row: FloatArray, face: Face) -> None:
    row[0], row[1], row[2] = face.x, face.y, face.z
    row[3], row[4], row[5], row[6] = face.ux, face.uy, face.wx, face.wy
    row[7], row[8], row[9] = face.rise_u, face.rise_w, face.top


@helper
def _put_edge(row: FloatArray, edge: Edge) -> None:
    row[0], row[1], row[2] = edge.x, edge.y, edge.z
    row[3], row[4], row[5] = edge.ux, edge.uy, edge.length
    row[6], row[7], row[8] = edge.rise, edge.tilt, edge.top


@helper
def _contact_offset(nx: float, ny: float, nz: float, tool: Meridian) -> tuple[float, float]:
    """From the tip to where the tool's normal is that of a face: along its level part, in its lengths, and up."""
    slope = math.hypot(nx, ny)
    if slope <= 1e-12:
        return 0.0, 0.0
    if tool.tangent > 0.0 and slope * tool.tangent >= nz:
        return tool.radius / slope, tool.height
    return (tool.disc + tool.corner * slope) / slope, tool.corner * (1.0 - nz)


@njit
def edge_patches(vertices: FloatArray, ends: NDArray[np.int64], edges: FloatArray) -> None:
    """Edges as queries need them.

    Args:
        edges: shape (e, EDGE_COLUMNS), filled with an `Edge` each.
    """
    for e in range(len(ends)):
        a, b = ends[e, 0], ends[e, 1]
        dx, dy = vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1]
        rise = vertices[b, 2] - vertices[a, 2]
        level = math.hypot(dx, dy)
        ux, uy, tilt = 1.0, 0.0, 0.0
        if level > 0.0:
            ux, uy, tilt = dx / level, dy / level, rise / math.hypot(level, rise)
        top = max(vertices[a, 2], vertices[b, 2])
        _put_edge(edges[e], Edge(vertices[a, 0], vertices[a, 1], vertices[a, 2], ux, uy, level, rise, tilt, top))


@helper
def _list_patch(
    triangle: _Triangle,
    box: Box,
    grid: Grid,
    element: int,
    fill: bool,
    counts: NDArray[np.int64],
    entries: NDArray[np.int32],
) -> None:
    """List an element in the cells that a triangle touches when it is widened by a box; see `Listing`."""
    x0, y0, x1, y1, x2, y2 = triangle
    low_x = min(x0, x1, x2) + box.low_x - _MARGIN
    high_x = max(x0, x1, x2) + box.high_x + _MARGIN
    low_y = min(y0, y1, y2) + box.low_y - _MARGIN
    high_y = max(y0, y1, y2) + box.high_y + _MARGIN
    left = max(0, _cell(low_x - grid.x, grid.size))
    right = min(grid.columns - 1, _cell(high_x - grid.x, grid.size))
    bottom = max(0, _cell(low_y - grid.y, grid.size))
    top = min(grid.rows - 1, _cell(high_y - grid.y, grid.size))
    simple = right - left <= 1 or top - bottom <= 0
    for row in range(bottom, top + 1):
        first, last = left, right
        if not simple:
            # the part of the triangle that the box brings into this row
            below = grid.y + row * grid.size - box.high_y - _MARGIN
            above = grid.y + (row + 1) * grid.size - box.low_y + _MARGIN
            least, most = _range_in_strip(triangle, below, above)
            if least > most:
                continue
            first = max(first, _cell(least + box.low_x - _MARGIN - grid.x, grid.size))
            last = min(last, _cell(most + box.high_x + _MARGIN - grid.x, grid.size))
        for cell in range(row * grid.columns + first, row * grid.columns + last + 1):
            if fill:
                entries[counts[cell]] = element
            counts[cell] += 1


@helper
def _cell(length: float, size: float) -> int:
    """Number of the column or row in which a length from the low corner lies."""
    return int(math.floor(length / size))


@helper
def _range_in_strip(triangle: _Triangle, below: float, above: float) -> tuple[float, float]:
    """Least and largest x of the part of a triangle with y in a range; the least is the larger where there is none."""
    x0, y0, x1, y1, x2, y2 = triangle
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
    return least, most


@helper
def _widened(tool: Meridian, level: Box, azimuth: Box, steep: bool) -> Box:
    """Box of contact offsets, from boxes of the normals' level part and of its direction."""
    low_x, high_x = _offset_range(tool, level.low_x, level.high_x, azimuth.low_x, azimuth.high_x, steep)
    low_y, high_y = _offset_range(tool, level.low_y, level.high_y, azimuth.low_y, azimuth.high_y, steep)
    return Box(low_x, high_x, low_y, high_y)


@helper
def _offset_range(
    tool: Meridian, level_low: float, level_high: float, azimuth_low: float, azimuth_high: float, steep: bool
) -> tuple[float, float]:
    """Range of contact offsets along one axis."""
    low = tool.corner * level_low + tool.disc * azimuth_low
    high = tool.corner * level_high + tool.disc * azimuth_high
    if tool.tangent > 0.0 and steep:
        low = min(low, tool.arc_radius * azimuth_low, tool.radius * azimuth_low)
        high = max(high, tool.arc_radius * azimuth_high, tool.radius * azimuth_high)
    return max(low, -tool.radius), min(high, tool.radius)


@njit
def list_faces(elements: Elements, first: int, last: int, grid: Grid, listing: Listing) -> None:
    """Count faces ``first`` to ``last - 1`` in the cells of their patches, or list them."""
    fill, counts, entries = listing
    vertices, triangles, faces = elements.vertices, elements.triangles, elements.faces
    box = Box(0.0, 0.0, 0.0, 0.0)
    for t in range(first, last):
        if faces[t, _FACE_TOP] == -math.inf:
            continue
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        x0, y0 = faces[t, 0], faces[t, 1]
        x1, y1 = x0 + vertices[b, 0] - vertices[a, 0], y0 + vertices[b, 1] - vertices[a, 1]
        x2, y2 = x0 + vertices[c, 0] - vertices[a, 0], y0 + vertices[c, 1] - vertices[a, 1]
        _list_patch(_Triangle(x0, y0, x1, y1, x2, y2), box, grid, t, fill, counts, entries)


@njit
def list_edges(
    elements: Elements, cones: FloatArray, first: int, last: int, tool: Meridian, grid: Grid, listing: Listing
) -> None:
    """Count edges ``first`` to ``last - 1`` in the cells of their patches, or list them.

    Args:
        cones: see `twin.cam.surface.surface_kernels.edge_cones`. A wide cone is listed in pieces.
    """
    fill, counts, entries = listing
    edges, number = elements.edges, len(elements.faces)
    for e in range(first, last):
        if cones[e, 0] > cones[e, 1]:
            continue
        edge = edge_at(edges, e)
        x1, y1 = edge.x + edge.length * edge.ux, edge.y + edge.length * edge.uy
        ends = _Triangle(edge.x, edge.y, x1, y1, x1, y1)
        pieces = max(1, int(math.ceil((cones[e, 1] - cones[e, 0]) / _PIECE_RAD)))
        step = (cones[e, 1] - cones[e, 0]) / pieces
        for piece in range(pieces):
            box = _edge_offsets(edge, cones[e, 0] + piece * step, step, tool)
            _list_patch(ends, box, grid, number + e, fill, counts, entries)


@helper
def _edge_offsets(edge: Edge, low: float, step: float, tool: Meridian) -> Box:
    """Box of contact offsets on an edge for normals from an angle ``low`` to ``low + step`` about it.

    The level parts of the normals lie on an ellipse; the box of its two ends is widened by how far it bulges.
    """
    ax, ay = edge.uy, -edge.ux
    bx, by, bz = -edge.ux * edge.tilt, -edge.uy * edge.tilt, math.sqrt(max(0.0, 1.0 - edge.tilt * edge.tilt))
    bulge = 1.0 - math.cos(0.5 * step) + 1e-12
    n0x, n0y = math.cos(low) * ax + math.sin(low) * bx, math.cos(low) * ay + math.sin(low) * by
    n1x = math.cos(low + step) * ax + math.sin(low + step) * bx
    n1y = math.cos(low + step) * ay + math.sin(low + step) * by
    level = Box(min(n0x, n1x) - bulge, max(n0x, n1x) + bulge, min(n0y, n1y) - bulge, max(n0y, n1y) + bulge)
    azimuth = Box(0.0, 0.0, 0.0, 0.0)
    if tool.disc > 0.0 or tool.tangent > 0.0:
        r0, r1 = math.hypot(n0x, n0y), math.hypot(n1x, n1y)
        if min(r0, r1) < 1e-6 or (abs(edge.tilt) < 1e-6 and low < 0.5 * math.pi < low + step):
            azimuth = Box(-1.0, 1.0, -1.0, 1.0)
        else:
            turn = math.atan2(abs(n0x * n1y - n0y * n1x), n0x * n1x + n0y * n1y)
            out = 1.0 - math.cos(0.5 * turn) + 1e-9
            azimuth = Box(
                min(n0x / r0, n1x / r1) - out,
                max(n0x / r0, n1x / r1) + out,
                min(n0y / r0, n1y / r1) - out,
                max(n0y / r0, n1y / r1) + out,
            )
    nz = bz * min(math.sin(low), math.sin(low + step))
    steep = tool.tangent * math.sqrt(max(0.0, 1.0 - nz * nz)) >= nz - 1e-6
    return _widened(tool, level, azimuth, steep)


@helper
def _largest_share(high: float, least: float, most: float, one: float) -> float:
    """Largest x / sqrt(one + x x + y y) with x <= high and y in [least, most]."""
    if high >= 1e6:
        return 1.0
    across = max(abs(least), abs(most))
    if high > 0.0:
        across = 0.0 if least <= 0.0 <= most else min(abs(least), abs(most))
    root = math.sqrt(one + high * high + across * across)
    return high / root if root > 0.0 else 1.0


@helper
def _shares(cone: Box, one: float) -> Box:
    """Box of (x, y) / sqrt(one + x x + y y) for (x, y) in a box."""
    x0, x1, y0, y1 = cone
    return Box(
        -_largest_share(-x0, y0, y1, one),
        _largest_share(x1, y0, y1, one),
        -_largest_share(-y0, x0, x1, one),
        _largest_share(y1, x0, x1, one),
    )


@njit
def list_vertices(
    elements: Elements, cones: FloatArray, first: int, last: int, tool: Meridian, grid: Grid, listing: Listing
) -> None:
    """Count vertices ``first`` to ``last - 1`` in the cells of their patches, or list them.

    Args:
        cones: see `twin.cam.surface.surface_kernels.vertex_cones`.
    """
    fill, counts, entries = listing
    vertices, number = elements.vertices, len(elements.faces) + len(elements.edges)
    for v in range(first, last):
        if cones[v, 0] > cones[v, 1]:
            continue
        cone = Box(cones[v, 0] - 1e-9, cones[v, 1] + 1e-9, cones[v, 2] - 1e-9, cones[v, 3] + 1e-9)
        widest_x, widest_y = max(abs(cone.low_x), abs(cone.high_x)), max(abs(cone.low_y), abs(cone.high_y))
        steep = tool.tangent * math.hypot(widest_x, widest_y) >= 1.0 - 1e-6
        box = _widened(tool, _shares(cone, 1.0), _shares(cone, 0.0), steep)
        x, y = vertices[v, 0], vertices[v, 1]
        _list_patch(_Triangle(x, y, x, y, x, y), box, grid, number + v, fill, counts, entries)


@helper
def _tip_on_edge(tool: Meridian, edge: Edge, x: float, y: float, best: float) -> tuple[float, float]:
    """Height of the tip of a tool resting on a closed edge, and where it touches, 0 to 1.

    -inf out of reach, or where the height cannot be above ``best``.
    """
    radius = tool.radius
    ex, ey = x - edge.x, y - edge.y
    q = abs(ex * edge.uy - ey * edge.ux)
    rest = radius * radius - q * q
    if rest < 0.0:
        return -math.inf, 0.0
    root = math.sqrt(rest)
    foot = ex * edge.ux + ey * edge.uy
    low, high = max(-foot, -root), min(edge.length - foot, root)
    if low > high:
        return -math.inf, 0.0
    if is_ball(tool):
        s = min(max(root * edge.tilt, low), high)
        part = min(max((foot + s) / edge.length, 0.0), 1.0)
        return edge.z + part * edge.rise + math.sqrt(max(0.0, rest - s * s)) - radius, part
    slope = edge.rise / edge.length
    part = min(max((foot + (high if slope > 0.0 else low)) / edge.length, 0.0), 1.0)
    if edge.z + part * edge.rise - profile_height(tool, min(radius, q)) <= best:
        return -math.inf, 0.0
    s = resting_offset(tool, abs(slope), q, root)
    s = min(max(s if slope >= 0.0 else -s, low), high)
    part = min(max((foot + s) / edge.length, 0.0), 1.0)
    return edge.z + part * edge.rise - profile_height(tool, min(radius, math.sqrt(q * q + s * s))), part


@njit
def drop(
    cutter: Cutter, points: FloatArray, first: int, last: int, heights: FloatArray, touched: NDArray[np.int32]
) -> None:
    """Heights of the tool tip over points ``first`` to ``last - 1``, and the elements touched, -1 for the floor."""
    tool, floor, grid = cutter.tool, cutter.floor, cutter.grid
    faces, edges, vertices = cutter.elements.faces, cutter.elements.edges, cutter.elements.vertices
    begins, entries = cutter.lists.begins, cutter.lists.entries
    face_count, edge_count, reach2 = len(faces), len(edges), tool.radius * tool.radius
    for i in range(first, last):
        x, y = points[i, 0], points[i, 1]
        best, element = floor, -1
        # compared before they become whole numbers: a point may be far off, or not a number
        column, row = (x - grid.x) / grid.size, (y - grid.y) / grid.size
        if 0.0 <= column < grid.columns and 0.0 <= row < grid.rows:
            cell = int(row) * grid.columns + int(column)
            for k in range(begins[cell], begins[cell + 1]):
                n = entries[k]
                if n < face_count:
                    if faces[n, _FACE_TOP] <= best:
                        continue
                    face = face_at(faces, n)
                    dx, dy = x - face.x, y - face.y
                    u = dx * face.ux + dy * face.uy
                    w = dx * face.wx + dy * face.wy
                    if u < -_BEYOND or w < -_BEYOND or u + w > 1.0 + _BEYOND:
                        continue
                    z = face.z + u * face.rise_u + w * face.rise_w
                elif n < face_count + edge_count:
                    if edges[n - face_count, _EDGE_TOP] <= best:
                        continue
                    z, _ = _tip_on_edge(tool, edge_at(edges, n - face_count), x, y, best)
                else:
                    v = vertices[n - face_count - edge_count]
                    if v[2] <= best:
                        continue
                    rho2 = (x - v[0]) ** 2 + (y - v[1]) ** 2
                    if rho2 > reach2:
                        continue
                    z = v[2] - profile_height(tool, math.sqrt(rho2))
                if z > best:
                    best, element = z, n
        heights[i], touched[i] = best, element


@njit
def contacts(cutter: Cutter, points: FloatArray, touched: NDArray[np.int32], positions: FloatArray) -> None:
    """Where the tool touches the element found for each point, shape (n, 3); NaN for the floor."""
    tool, triangles = cutter.tool, cutter.elements.triangles
    faces, edges, vertices = cutter.elements.faces, cutter.elements.edges, cutter.elements.vertices
    face_count, edge_count = len(faces), len(edges)
    for i in range(len(points)):
        n = touched[i]
        if n < 0:
            positions[i, 0], positions[i, 1], positions[i, 2] = math.nan, math.nan, math.nan
        elif n < face_count:
            face = face_at(faces, n)
            dx, dy = points[i, 0] - face.x, points[i, 1] - face.y
            u, w = dx * face.ux + dy * face.uy, dx * face.wx + dy * face.wy
            a, b, c = triangles[n, 0], triangles[n, 1], triangles[n, 2]
            for k in range(3):
                positions[i, k] = (1.0 - u - w) * vertices[a, k] + u * vertices[b, k] + w * vertices[c, k]
        elif n < face_count + edge_count:
            edge = edge_at(edges, n - face_count)
            _, part = _tip_on_edge(tool, edge, points[i, 0], points[i, 1], -math.inf)
            positions[i, 0] = edge.x + part * edge.length * edge.ux
            positions[i, 1] = edge.y + part * edge.length * edge.uy
            positions[i, 2] = edge.z + part * edge.rise
        else:
            for k in range(3):
                positions[i, k] = vertices[n - face_count - edge_count, k]
