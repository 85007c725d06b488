"""A surface from the crossings of a lattice's edges (dual contouring); compiled.

Arrays are flat as in `twin.workpiece.lattice_kernels`; a lattice cell is named by its lowest node. Each crossed edge
has a point and a unit normal that points out of the material, or a normal of zero where nothing is known.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import helper, inlined, njit


@helper
def _clamped(x: float, low: float, high: float, inset: float) -> float:
    """Keep x between two cell faces, a part ``inset`` of their distance from both."""
    return min(max(x, low + inset * (high - low)), high - inset * (high - low))


@helper
def _dot(a: FloatArray, b: FloatArray) -> float:
    product: float = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return product


@helper
def _centre(points: FloatArray, normals: FloatArray, normal: FloatArray) -> None:
    """Shift points so that their mean is 0; fill the unit mean normal (0 where the normals cancel).

    Args:
        points: shape (n + 1, 3), the mean goes to the last row.
        normals: shape (n, 3).
    """
    n = len(normals)
    for a in range(3):
        points[n, a] = normal[a] = 0.0
        for i in range(n):
            points[n, a] += points[i, a]
            normal[a] += normals[i, a]
        points[n, a] /= n
        for i in range(n):
            points[i, a] -= points[n, a]
    length = math.sqrt(_dot(normal, normal))
    if length > 0.0:
        for a in range(3):
            normal[a] /= length


@helper
def _along_normal(points: FloatArray, normals: FloatArray, normal: FloatArray, shift: FloatArray) -> float:
    """The point on the mean normal nearest to the tangent planes; returns the least cosine of a normal to the mean."""
    smallest, top, bottom = 1.0, 0.0, 0.0
    for i in range(len(normals)):
        along = _dot(normals[i], normal)
        if along != 0.0 or _dot(normals[i], normals[i]) > 0.0:
            smallest = min(smallest, along)
        top += along * _dot(normals[i], points[i])
        bottom += along * along
    for a in range(3):
        shift[a] = normal[a] * top / bottom if bottom > 0.0 else 0.0
    return smallest


@helper
def _nearest(points: FloatArray, normals: FloatArray, ramp: tuple[float, float], shift: FloatArray) -> None:
    """The point nearest to the tangent planes in directions that they determine well; the others fade out smoothly.

    Args:
        ramp: relative eigenvalues of the least squares from which a direction begins to count, and fully does.
    """
    matrix, right = np.zeros((3, 3)), np.zeros(3)
    for i in range(len(normals)):
        off = _dot(normals[i], points[i])
        for a in range(3):
            right[a] += normals[i, a] * off
            for b in range(3):
                matrix[a, b] += normals[i, a] * normals[i, b]
    values, vectors = np.linalg.eigh(matrix)
    shift[:] = 0.0
    for m in range(3):
        share = (values[m] / values[2] - ramp[0]) / (ramp[1] - ramp[0])
        if share > 0.0:
            share = min(share, 1.0)
            weight = share * share * (3.0 - 2.0 * share) / values[m]
            dot = vectors[0, m] * right[0] + vectors[1, m] * right[1] + vectors[2, m] * right[2]
            for a in range(3):
                shift[a] += weight * dot * vectors[a, m]


@helper
def _case(inside: NDArray[np.bool_], node: int, strides: tuple[int, int, int]) -> int:
    """Which corners of a cell are inside, bit by bit."""
    case = 0
    for c in range(8):
        if inside[node + (c & 1) * strides[0] + (c >> 1 & 1) * strides[1] + (c >> 2)]:
            case |= 1 << c
    return case


class Nodes(NamedTuple):
    """Nodes of a lattice: whether each is in material, shape (nodes,), and their positions along x, y, z, mm."""

    inside: NDArray[np.bool_]
    x: FloatArray
    y: FloatArray
    z: FloatArray


class Crossings(NamedTuple):
    """Crossed edges.

    Attributes:
        numbers: shape (3, nodes), number of each edge by axis and lower node, -1 where it is not crossed.
        points, normals: shape (edges, 3), of each edge that is crossed.
    """

    numbers: NDArray[np.int32]
    points: FloatArray
    normals: FloatArray


class Limits(NamedTuple):
    """How vertices are placed.

    Attributes:
        smooth: cosine of the angle from the mean normal within which a sheet is smooth.
        ramp: see `_nearest`.
        margin: part of a cell's size that vertices keep from its faces, those of a second sheet twice as much and so
            on, so that no two coincide.
    """

    smooth: float
    ramp: tuple[float, float]
    margin: float


class Vertices(NamedTuple):
    """Vertices of a surface, filled.

    Attributes:
        first, cases: shape (nodes,), for cells with a surface: number of the first vertex, and case.
        points, normals: shape (n, 3).
        creased: shape (n,), whether the surface has an edge or a corner there.
        cells: shape (n,), the cell of each vertex times 4 plus its sheet.
    """

    first: NDArray[np.int32]
    cases: NDArray[np.uint8]
    points: FloatArray
    normals: FloatArray
    creased: NDArray[np.bool_]
    cells: NDArray[np.int64]


@inlined
def _gather(
    node: int,
    strides: tuple[int, int, int],
    sheet: int,
    sheet_of: NDArray[np.int8],
    crossings: Crossings,
    near: FloatArray,
    leans: FloatArray,
) -> int:
    """Copy the points and normals of the crossed edges of one sheet in a cell; returns how many.

    Args:
        sheet_of: shape (12,), the sheet of each edge of the cell.
    """
    numbers, points, normals = crossings
    n = 0
    for e in range(12):
        if sheet_of[e] == sheet:
            d, low, high = e >> 2, e & 1, e >> 1 & 1
            p = 1 if d == 0 else 0
            q = 1 if d == 2 else 2
            number = numbers[d, node + low * strides[p] + high * strides[q]]
            for a in range(3):
                near[n, a], leans[n, a] = points[number, a], normals[number, a]
            n += 1
    return n


@helper
def _last_sheet(sheet_of: NDArray[np.int8]) -> int:
    """Number of the last sheet in a cell."""
    last = 0
    for e in range(12):
        last = max(last, sheet_of[e])
    return last


@njit
def place_vertices(
    nodes: Nodes, crossings: Crossings, sheets: NDArray[np.int8], limits: Limits, vertices: Vertices
) -> int:
    """One vertex for every sheet of the surface in every cell: the point nearest to its crossings' tangent planes.

    Args:
        sheets: shape (256, 12), see `twin.workpiece.cell_cases`.

    Returns:
        number of vertices.
    """
    inside, x, y, z = nodes
    first, cases, points, normals, creased, cells = vertices
    strides = (len(y) * len(z), len(z), 1)
    near, leans = np.empty((13, 3)), np.empty((12, 3))
    count = 0
    for i in range(len(x) - 1):
        for j in range(len(y) - 1):
            for k in range(len(z) - 1):
                node = i * strides[0] + j * strides[1] + k
                case = _case(inside, node, strides)
                first[node] = -1
                if case == 0 or case == 255:
                    continue
                first[node] = count
                cases[node] = case
                sheet_of = sheets[case]
                for sheet in range(_last_sheet(sheet_of) + 1):
                    n = _gather(node, strides, sheet, sheet_of, crossings, near, leans)
                    vertex = points[count]
                    creased[count] = _place_vertex(near[: n + 1], leans[:n], limits, vertex, normals[count])
                    inset = limits.margin * (1 + sheet)
                    vertex[0] = _clamped(vertex[0], x[i], x[i + 1], inset)
                    vertex[1] = _clamped(vertex[1], y[j], y[j + 1], inset)
                    vertex[2] = _clamped(vertex[2], z[k], z[k + 1], inset)
                    cells[count] = 4 * node + sheet
                    count += 1
    return count


@inlined
def _place_vertex(near: FloatArray, leans: FloatArray, limits: Limits, vertex: FloatArray, normal: FloatArray) -> bool:
    """Fill the vertex of one sheet and its normal; returns whether the surface has an edge or a corner there.

    Args:
        near: shape (n + 1, 3), points of the crossings, and a row for their mean.
        leans: shape (n, 3), normals of the crossings.
    """
    n = len(leans)
    _centre(near, leans, normal)
    creased = _along_normal(near[:n], leans, normal, vertex) < limits.smooth
    if creased:
        _nearest(near[:n], leans, limits.ramp, vertex)
    for a in range(3):
        vertex[a] += near[n, a]
    return creased


@njit
def join_quads(
    shape: tuple[int, int, int],
    own: tuple[int, int],
    numbers: NDArray[np.int32],
    axes: NDArray[np.int8],
    sheets: NDArray[np.int8],
    first: NDArray[np.int32],
    cases: NDArray[np.uint8],
    quads: NDArray[np.int32],
) -> int:
    """One quadrilateral round every crossed edge, counter-clockwise seen from outside.

    Args:
        own: only edges whose lower node is at least here along x and y, and not on the last nodes.
        quads: shape (edges, 5), filled: four vertices and the edge's number.

    Returns:
        number of quadrilaterals.
    """
    nx, ny, nz = shape
    strides = (ny * nz, nz, 1)
    count = 0
    for i in range(own[0], nx - 1):
        for j in range(own[1], ny - 1):
            for k in range(nz - 1):
                node = (i * ny + j) * nz + k
                for d in range(3):
                    number = numbers[d, node]
                    if number < 0:
                        continue
                    p, q = (d + 1) % 3, (d + 2) % 3
                    for corner in range(4):
                        back_p = 1 if corner == 0 or corner == 3 else 0
                        back_q = 1 if corner == 0 or corner == 1 else 0
                        cell = node - back_p * strides[p] - back_q * strides[q]
                        edge = 4 * d + (back_p + 2 * back_q if p < q else back_q + 2 * back_p)
                        position = corner if axes[number] > 0 else 3 - corner
                        quads[count, position] = first[cell] + sheets[cases[cell], edge]
                    quads[count, 4] = number
                    count += 1
    return count


@njit
def split_quads(
    quads: NDArray[np.int32], vertices: FloatArray, creased: NDArray[np.bool_], triangles: NDArray[np.int32]
) -> None:
    """Two triangles a quadrilateral: along a crease that crosses it, else along the shorter diagonal.

    Args:
        triangles: shape (2 n, 3), filled.
    """
    for n in range(len(quads)):
        a, b, c, d = quads[n, 0], quads[n, 1], quads[n, 2], quads[n, 3]
        crease_ac, crease_bd = creased[a] and creased[c], creased[b] and creased[d]
        ac, bd = 0.0, 0.0
        for m in range(3):
            ac += (vertices[a, m] - vertices[c, m]) ** 2
            bd += (vertices[b, m] - vertices[d, m]) ** 2
        if (crease_bd and not crease_ac) or (crease_ac == crease_bd and bd < ac):
            a, b, c, d = b, c, d, a
        triangles[2 * n, 0], triangles[2 * n, 1], triangles[2 * n, 2] = a, b, c
        triangles[2 * n + 1, 0], triangles[2 * n + 1, 1], triangles[2 * n + 1, 2] = a, c, d
