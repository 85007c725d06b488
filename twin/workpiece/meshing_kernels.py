"""A surface from inside/outside at lattice nodes and crossings of lattice edges (dual contouring); compiled.

Lattice arrays are flat: node (i, j, k) of a lattice of (nx, ny, nz) nodes is number (i ny + j) nz + k. A lattice edge
is named by its axis and its lower node, a lattice cell by its lowest node. Crossed edges are numbered; each has a point
and a unit normal that points out of the material.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from twin.arrays import FloatArray


@njit(cache=True, nogil=True)
def vote(
    offsets: NDArray[np.int64],
    ends: FloatArray,
    bases: NDArray[np.int64],
    stride: int,
    nodes: FloatArray,
    votes: NDArray[np.uint8],
) -> None:
    """Add one vote to every node of some lines that lies in material.

    Args:
        offsets, ends: material on each line.
        bases: shape (n,), each line's first node; the next one is ``stride`` further.
        nodes: positions of the nodes along the lines, increasing.
    """
    for i in range(len(bases)):
        n = 0
        for e in range(offsets[i], offsets[i + 1], 2):
            while n < len(nodes) and nodes[n] < ends[e]:
                n += 1
            while n < len(nodes) and nodes[n] < ends[e + 1]:
                votes[bases[i] + n * stride] += 1
                n += 1


@njit(cache=True, nogil=True)
def number_edges(
    inside: NDArray[np.bool_], shape: tuple[int, int, int], numbers: NDArray[np.int32], axes: NDArray[np.int8]
) -> int:
    """Number the edges with one end inside.

    Args:
        numbers: shape (3, nodes), filled, -1 for edges that are not crossed.
        axes: shape (3 nodes,), filled for every number: axis + 1, negative where material is at the upper end.
    """
    nx, ny, nz = shape
    count = 0
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                node = (i * ny + j) * nz + k
                for d in range(3):
                    numbers[d, node] = -1
                    if (d == 0 and i + 1 == nx) or (d == 1 and j + 1 == ny) or (d == 2 and k + 1 == nz):
                        continue
                    step = ny * nz if d == 0 else (nz if d == 1 else 1)
                    if inside[node] != inside[node + step]:
                        numbers[d, node] = count
                        axes[count] = d + 1 if inside[node] else -d - 1
                        count += 1
    return count


@njit(cache=True, nogil=True)
def measure(
    offsets: NDArray[np.int64],
    ends: FloatArray,
    slopes: FloatArray,
    bases: NDArray[np.int64],
    stride: int,
    nodes: FloatArray,
    slack: float,
    inside: NDArray[np.bool_],
    numbers: NDArray[np.int32],
    column: int,
    positions: FloatArray,
    leans: FloatArray,
) -> None:
    """Find the crossing of every numbered edge on some lines: the outermost one of the right sense.

    Args:
        offsets, ends, slopes: material on each line.
        bases, stride, nodes: as for `vote`.
        slack: a crossing this much beyond an edge's end still counts, and is moved to the end.
        numbers: shape (nodes,), of edges along the lines.
        column: of ``leans`` that the slopes go to.
        positions: shape (edges,), NaN until found.
        leans: shape (edges, 2), NaN until found.
    """
    for i in range(len(bases)):
        first, last = offsets[i], offsets[i + 1]
        e = first
        for n in range(len(nodes) - 1):
            node = bases[i] + n * stride
            number = numbers[node]
            if number < 0:
                continue
            low, high = nodes[n] - slack, nodes[n + 1] + slack
            while e < last and ends[e] < low:
                e += 1
            leaves = inside[node]
            found = -1
            m = e
            while m < last and ends[m] <= high:
                if ((m - first) % 2 == 1) == leaves and (leaves or found < 0):
                    found = m
                m += 1
            if found >= 0:
                leans[number, column] = slopes[found]
                if math.isnan(positions[number]):
                    positions[number] = min(max(ends[found], nodes[n]), nodes[n + 1])


@njit(cache=True, nogil=True)
def _clamped(x: float, low: float, high: float, margin: float) -> float:
    inset = margin * (high - low)
    return min(max(x, low + inset), high - inset)


@njit(cache=True, nogil=True)
def _place(points: FloatArray, normals: FloatArray, limits: FloatArray, vertex: FloatArray, normal: FloatArray) -> bool:
    """The vertex of a sheet from its crossings, relative to their mean: nearest to all tangent planes.

    On a smooth sheet it only moves along the mean normal. Elsewhere it solves the planes' least squares in all directions
    that they determine well; the others fade out smoothly.

    Args:
        points, normals: shape (n, 3).
        limits: cosine of the angle from the mean normal that still is smooth; where least squares' relative eigenvalues
            begin to count and where they fully do.
        vertex, normal: shape (3,), filled.

    Returns:
        whether the sheet has an edge or a corner here.
    """
    n = len(points)
    middle = np.zeros(3)
    for a in range(3):
        normal[a] = 0.0
        for i in range(n):
            middle[a] += points[i, a] / n
            normal[a] += normals[i, a]
    length = math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    if length > 0.0:
        for a in range(3):
            normal[a] /= length
    smallest, top, bottom = 1.0, 0.0, 0.0
    for i in range(n):
        along, off, own = 0.0, 0.0, 0.0
        for a in range(3):
            along += normals[i, a] * normal[a]
            off += normals[i, a] * (points[i, a] - middle[a])
            own += normals[i, a] ** 2
        if own > 0.0:
            smallest = min(smallest, along)
        top += along * off
        bottom += along * along
    for a in range(3):
        vertex[a] = middle[a] + (normal[a] * top / bottom if bottom > 0.0 else 0.0)
    if smallest > limits[0] or bottom == 0.0:
        return False
    for a in range(3):
        vertex[a] = middle[a]
    matrix = np.zeros((3, 3))
    right = np.zeros(3)
    for i in range(n):
        off = 0.0
        for a in range(3):
            off += normals[i, a] * (points[i, a] - middle[a])
        for a in range(3):
            right[a] += normals[i, a] * off
            for b in range(3):
                matrix[a, b] += normals[i, a] * normals[i, b]
    values, vectors = np.linalg.eigh(matrix)
    for m in range(3):
        share = (values[m] / values[2] - limits[1]) / (limits[2] - limits[1])
        if share <= 0.0:
            continue
        share = min(share, 1.0)
        dot = vectors[0, m] * right[0] + vectors[1, m] * right[1] + vectors[2, m] * right[2]
        for a in range(3):
            vertex[a] += share * share * (3.0 - 2.0 * share) * dot / values[m] * vectors[a, m]
    return True


@njit(cache=True, nogil=True)
def place_vertices(
    inside: NDArray[np.bool_],
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    numbers: NDArray[np.int32],
    points: FloatArray,
    normals: FloatArray,
    sheets: NDArray[np.int8],
    limits: FloatArray,
    margin: float,
    first: NDArray[np.int32],
    cases: NDArray[np.uint8],
    vertices: FloatArray,
    vertex_normals: FloatArray,
    creased: NDArray[np.bool_],
    cells: NDArray[np.int64],
) -> int:
    """One vertex for every sheet of the surface in every cell.

    Args:
        x, y, z: node positions.
        numbers, points, normals: crossed edges.
        sheets: shape (256, 12), see `twin.workpiece.cell_cases`.
        limits: see `_place`.
        margin: part of a cell's size that vertices keep from its faces, so that no two coincide.
        first, cases: shape (nodes,), filled for cells with a surface: number of the first vertex, and case.
        vertices, vertex_normals, creased: filled; creased where the surface has an edge or a corner.
        cells: filled, the cell of each vertex times 4 plus its sheet.

    Returns:
        number of vertices.
    """
    nx, ny, nz = len(x), len(y), len(z)
    own_points, own_normals = np.empty((12, 3)), np.empty((12, 3))
    count = 0
    for i in range(nx - 1):
        for j in range(ny - 1):
            for k in range(nz - 1):
                node = (i * ny + j) * nz + k
                case = 0
                for c in range(8):
                    if inside[node + ((c & 1) * ny + (c >> 1 & 1)) * nz + (c >> 2)]:
                        case |= 1 << c
                first[node] = -1
                if case == 0 or case == 255:
                    continue
                first[node] = count
                cases[node] = case
                for sheet in range(4):
                    n = 0
                    for e in range(12):
                        if sheets[case, e] == sheet:
                            d, low, high = e >> 2, e & 1, e >> 1 & 1
                            shift = low * nz + high if d == 0 else (low * ny * nz + high if d == 1 else (low * ny + high) * nz)
                            number = numbers[d, node + shift]
                            for a in range(3):
                                own_points[n, a] = points[number, a]
                                own_normals[n, a] = normals[number, a]
                            n += 1
                    if n == 0:
                        break
                    creased[count] = _place(
                        own_points[:n], own_normals[:n], limits, vertices[count], vertex_normals[count]
                    )
                    vertices[count, 0] = _clamped(vertices[count, 0], x[i], x[i + 1], margin)
                    vertices[count, 1] = _clamped(vertices[count, 1], y[j], y[j + 1], margin)
                    vertices[count, 2] = _clamped(vertices[count, 2], z[k], z[k + 1], margin)
                    cells[count] = 4 * node + sheet
                    count += 1
    return count


@njit(cache=True, nogil=True)
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
                        place = corner if axes[number] > 0 else 3 - corner
                        quads[count, place] = first[cell] + sheets[cases[cell], edge]
                    quads[count, 4] = number
                    count += 1
    return count


@njit(cache=True, nogil=True)
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
