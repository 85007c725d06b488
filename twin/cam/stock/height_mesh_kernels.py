"""Tiles of a height map as triangles, no finer than a tolerance needs; compiled.

A tile is divided into two right triangles, and these along their longest side's middle, again and again, where the
surface lies off the undivided side (right-triangulated irregular networks: Evans, Kirkpatrick and Townsend, 2001). A
triangle is divided whenever one inside it is, so a tile has no gaps; neighbouring tiles differ by the tolerance at
most.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import helper, njit

#: Cells along a tile's side, and nodes.
CELLS = 32
_SIDE = CELLS + 1
_NODES = _SIDE * _SIDE
#: Triangles of all levels but the finest, and those that have further ones inside.
TRIANGLES = 2 * CELLS * CELLS - 2
_PARENTS = TRIANGLES - CELLS * CELLS
#: Most triangles and vertices of one tile: upper and lower side, and the stock's outer walls.
MOST_TRIANGLES = 2 * 2 * CELLS * CELLS + 2 * 4 * CELLS
MOST_VERTICES = 3 * _NODES + 4 * 4 * CELLS + 4
#: Surfaces steeper than this share of an upward normal are walls: shaded apart from the floors that they meet.
_WALL = 0.5
#: Vertices of a node: one for floors, one for walls, one for the lower side.
_FLOOR, _STEEP, _BELOW = 0, 1, 2


class HeightMap(NamedTuple):
    """Material between two heights over a grid.

    Attributes:
        tops, bottoms: shape (nx, ny), mm; where a top is not above its bottom there is no material.
        x, y: positions of the nodes, shape (nx,) and (ny,).
    """

    tops: FloatArray
    bottoms: FloatArray
    x: FloatArray
    y: FloatArray


class TileMeshes(NamedTuple):
    """Meshes of several tiles, one after the other.

    Attributes:
        vertices, normals: shape (n, 3) float32.
        triangles: shape (m, 3), counter-clockwise seen from outside; numbers count from a tile's first vertex.
        ends: shape (tiles + 1, 2), first vertex and first triangle of each tile, and the ends.
    """

    vertices: NDArray[np.float32]
    normals: NDArray[np.float32]
    triangles: NDArray[np.uint32]
    ends: NDArray[np.int64]


class _Tile(NamedTuple):
    """Heights of one tile, and its triangles while they are made.

    Attributes:
        tops, bottoms: shape (nodes,).
        column, row: number of each node's column and row in the map, shape (side,).
        errors: shape (nodes,), how far the surface may lie off the two triangles on the side whose middle a node is.
        corners: shape (k, 3), nodes of the triangles.
        sums: shape (3 nodes, 3), sums of normals of a node's vertices.
        numbers: shape (3 nodes,), number of a node's vertices, -1 without one.
    """

    tops: FloatArray
    bottoms: FloatArray
    column: NDArray[np.int64]
    row: NDArray[np.int64]
    errors: FloatArray
    corners: NDArray[np.int64]
    sums: FloatArray
    numbers: NDArray[np.int64]


@njit
def changed_tiles(
    tops: FloatArray, drawn: FloatArray, firsts: NDArray[np.int64], least: float, changed: NDArray[np.bool_]
) -> None:
    """Which tiles have a node that is lower than it was drawn, by more than ``least``.

    Args:
        tops, drawn: shape (nx, ny), heights now and as drawn.
        firsts: shape (n, 2), column and row of each tile's first node; it may lie outside of the map.
        changed: shape (n,), filled.
    """
    nx, ny = tops.shape
    for t in range(len(firsts)):
        changed[t] = False
        for i in range(max(0, firsts[t, 0]), min(nx, firsts[t, 0] + _SIDE)):
            for j in range(max(0, firsts[t, 1]), min(ny, firsts[t, 1] + _SIDE)):
                if drawn[i, j] - tops[i, j] > least:
                    changed[t] = True
                    break
            if changed[t]:
                break


@njit
def division_table(table: NDArray[np.int64]) -> None:
    """The two ends of every triangle's longest side, and its right angle, large triangles first.

    Args:
        table: shape (TRIANGLES, 6), filled: column and row of each.
    """
    for k in range(TRIANGLES):
        number = k + 2
        ax, ay, bx, by, cx, cy = 0, 0, 0, 0, 0, 0
        if number & 1:
            bx, by, cx = CELLS, CELLS, CELLS
        else:
            ax, ay, cy = CELLS, CELLS, CELLS
        number >>= 1
        while number > 1:
            mx, my = (ax + bx) >> 1, (ay + by) >> 1
            if number & 1:
                bx, by, ax, ay = ax, ay, cx, cy
            else:
                ax, ay, bx, by = bx, by, cx, cy
            cx, cy = mx, my
            number >>= 1
        table[k, 0], table[k, 1], table[k, 2], table[k, 3], table[k, 4], table[k, 5] = ax, ay, bx, by, cx, cy


@njit
def tile_meshes(
    heights: HeightMap, firsts: NDArray[np.int64], limit: float, table: NDArray[np.int64], out: TileMeshes
) -> None:
    """Triangles of tiles.

    Args:
        firsts: shape (n, 2), column and row of each tile's first node; nodes outside of the map repeat its border.
        limit: distance that the surface may lie off its triangles at a node, along z.
        table: see `division_table`.
        out: filled; it must have room for the largest tiles.
    """
    tile = _Tile(
        np.empty(_NODES),
        np.empty(_NODES),
        np.empty(_SIDE, dtype=np.int64),
        np.empty(_SIDE, dtype=np.int64),
        np.empty(_NODES),
        np.empty((2 * CELLS * CELLS, 3), dtype=np.int64),
        np.empty((3 * _NODES, 3)),
        np.empty(3 * _NODES, dtype=np.int64),
    )
    out.ends[0, 0], out.ends[0, 1] = 0, 0
    for t in range(len(firsts)):
        flat_top, flat_bottom = _take(heights, firsts[t, 0], firsts[t, 1], limit, tile)
        if not (flat_top and flat_bottom):
            _measure(tile, flat_bottom, table)
        count = _divide(heights, tile, -1.0 if flat_top and flat_bottom else limit)
        _add_normals(heights, tile, count)
        _emit(heights, tile, count, flat_bottom, t, out)


@helper
def _take(heights: HeightMap, first_column: int, first_row: int, limit: float, tile: _Tile) -> tuple[bool, bool]:
    """Copy a tile's heights; whether its upper and its lower side are flat and whole."""
    nx, ny = heights.tops.shape
    for i in range(_SIDE):
        tile.column[i] = min(max(first_column + i, 0), nx - 1)
        tile.row[i] = min(max(first_row + i, 0), ny - 1)
    high, low, over, under = -math.inf, math.inf, -math.inf, math.inf
    whole = True
    for i in range(_SIDE):
        for j in range(_SIDE):
            top, bottom = heights.tops[tile.column[i], tile.row[j]], heights.bottoms[tile.column[i], tile.row[j]]
            tile.tops[i * _SIDE + j], tile.bottoms[i * _SIDE + j] = top, bottom
            high, low = max(high, top), min(low, top)
            over, under = max(over, bottom), min(under, bottom)
            whole = whole and top > bottom
    return high - low <= limit, whole and over - under <= limit


@helper
def _measure(tile: _Tile, flat_bottom: bool, table: NDArray[np.int64]) -> None:
    """Bounds of the errors of all nodes, small triangles first; those of the triangles within are added to a node's."""
    tops, bottoms, errors = tile.tops, tile.bottoms, tile.errors
    errors[:] = 0.0
    for k in range(TRIANGLES - 1, -1, -1):
        ax, ay, bx, by, cx, cy = table[k, 0], table[k, 1], table[k, 2], table[k, 3], table[k, 4], table[k, 5]
        a, b = ax * _SIDE + ay, bx * _SIDE + by
        middle = ((ax + bx) >> 1) * _SIDE + ((ay + by) >> 1)
        error = abs(tops[middle] - 0.5 * (tops[a] + tops[b]))
        if not flat_bottom:
            error = max(error, abs(bottoms[middle] - 0.5 * (bottoms[a] + bottoms[b])))
        if k < _PARENTS:
            left = ((ax + cx) >> 1) * _SIDE + ((ay + cy) >> 1)
            right = ((bx + cx) >> 1) * _SIDE + ((by + cy) >> 1)
            error += max(errors[left], errors[right])
        errors[middle] = max(errors[middle], error)


@helper
def _divide(heights: HeightMap, tile: _Tile, limit: float) -> int:
    """Choose a tile's triangles, counter-clockwise from above; returns their number.

    Args:
        limit: of the errors; below 0 nothing is divided.
    """
    stack = np.empty((64, 6), dtype=np.int64)
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3], stack[0, 4], stack[0, 5] = 0, 0, CELLS, CELLS, CELLS, 0
    stack[1, 0], stack[1, 1], stack[1, 2], stack[1, 3], stack[1, 4], stack[1, 5] = CELLS, CELLS, 0, 0, 0, CELLS
    held, count = 2, 0
    while held > 0:
        held -= 1
        ax, ay, bx, by = stack[held, 0], stack[held, 1], stack[held, 2], stack[held, 3]
        cx, cy = stack[held, 4], stack[held, 5]
        mx, my = (ax + bx) >> 1, (ay + by) >> 1
        if limit >= 0.0 and abs(ax - cx) + abs(ay - cy) > 1 and tile.errors[mx * _SIDE + my] > limit:
            stack[held, 0], stack[held, 1], stack[held, 2], stack[held, 3] = cx, cy, ax, ay
            stack[held, 4], stack[held, 5] = mx, my
            stack[held + 1, 0], stack[held + 1, 1], stack[held + 1, 2], stack[held + 1, 3] = bx, by, cx, cy
            stack[held + 1, 4], stack[held + 1, 5] = mx, my
            held += 2
            continue
        a, b, c = ax * _SIDE + ay, bx * _SIDE + by, cx * _SIDE + cy
        if max(_thickness(tile, a), _thickness(tile, b), _thickness(tile, c)) <= 0.0:
            continue
        area = _area(heights, tile, a, b, c)
        if area != 0.0:
            tile.corners[count, 0] = a
            tile.corners[count, 1], tile.corners[count, 2] = (b, c) if area > 0.0 else (c, b)
            count += 1
    return count


@helper
def _thickness(tile: _Tile, node: int) -> float:
    """Height of the material at a node."""
    return float(tile.tops[node] - tile.bottoms[node])


@helper
def _area(heights: HeightMap, tile: _Tile, a: int, b: int, c: int) -> float:
    """Twice the area of a triangle in plan, above 0 where it is counter-clockwise."""
    ax, ay = heights.x[tile.column[a // _SIDE]], heights.y[tile.row[a % _SIDE]]
    bx, by = heights.x[tile.column[b // _SIDE]] - ax, heights.y[tile.row[b % _SIDE]] - ay
    cx, cy = heights.x[tile.column[c // _SIDE]] - ax, heights.y[tile.row[c % _SIDE]] - ay
    return float(bx * cy - by * cx)


@helper
def _add_normals(heights: HeightMap, tile: _Tile, count: int) -> None:
    """Sum the normals of floors and walls at every node, and mark the vertices that are needed."""
    tile.numbers[:] = -1
    for k in range(count):
        a, b, c = tile.corners[k, 0], tile.corners[k, 1], tile.corners[k, 2]
        ax, ay, az = heights.x[tile.column[a // _SIDE]], heights.y[tile.row[a % _SIDE]], tile.tops[a]
        bx, by = heights.x[tile.column[b // _SIDE]] - ax, heights.y[tile.row[b % _SIDE]] - ay
        cx, cy = heights.x[tile.column[c // _SIDE]] - ax, heights.y[tile.row[c % _SIDE]] - ay
        bz, cz = tile.tops[b] - az, tile.tops[c] - az
        nx, ny, nz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
        kind = _STEEP if nz < _WALL * math.sqrt(nx * nx + ny * ny + nz * nz) else _FLOOR
        for corner in range(3):
            node = tile.corners[k, corner]
            slot = 3 * node + kind
            if tile.numbers[slot] < 0:
                tile.numbers[slot] = 0
                tile.sums[slot, 0], tile.sums[slot, 1], tile.sums[slot, 2] = 0.0, 0.0, 0.0
            tile.sums[slot, 0] += nx
            tile.sums[slot, 1] += ny
            tile.sums[slot, 2] += nz
            tile.corners[k, corner] = slot


@helper
def _vertex(n: int, out: TileMeshes, x: float, y: float, z: float) -> None:
    out.vertices[n, 0], out.vertices[n, 1], out.vertices[n, 2] = x, y, z


@helper
def _normal(n: int, out: TileMeshes, x: float, y: float, z: float) -> None:
    out.normals[n, 0], out.normals[n, 1], out.normals[n, 2] = x, y, z


@helper
def _emit(heights: HeightMap, tile: _Tile, count: int, flat_bottom: bool, t: int, out: TileMeshes) -> None:
    """Write a tile's vertices and triangles after those of the tiles before it."""
    first, m = out.ends[t, 0], out.ends[t, 1]
    n = first
    nx, ny = heights.tops.shape
    for k in range(count):
        for corner in range(3):
            slot = tile.corners[k, corner]
            if tile.numbers[slot] <= 0:
                node = slot // 3
                i, j = tile.column[node // _SIDE], tile.row[node % _SIDE]
                sx, sy, sz = tile.sums[slot, 0], tile.sums[slot, 1], tile.sums[slot, 2]
                length = math.sqrt(sx * sx + sy * sy + sz * sz)
                _vertex(n, out, heights.x[i], heights.y[j], tile.tops[node])
                _normal(n, out, sx / length, sy / length, sz / length)
                n += 1
                tile.numbers[slot] = n - first
            out.triangles[m, corner] = tile.numbers[slot] - 1
        m += 1
        for corner in range(3):
            a, b = tile.corners[k, corner] // 3, tile.corners[k, (corner + 1) % 3] // 3
            ai, aj, bi, bj = tile.column[a // _SIDE], tile.row[a % _SIDE], tile.column[b // _SIDE], tile.row[b % _SIDE]
            across = ai == bi and (ai == 0 or ai == nx - 1)
            if not (across or (aj == bj and (aj == 0 or aj == ny - 1))):
                continue
            if max(_thickness(tile, a), _thickness(tile, b)) <= 0.0:
                continue
            side_x = (-1.0 if ai == 0 else 1.0) if across else 0.0
            side_y = 0.0 if across else (-1.0 if aj == 0 else 1.0)
            n, m = _wall(heights, tile, (a, b), (side_x, side_y), first, n, m, out)
    if count and flat_bottom:
        n, m = _flat_bottom(heights, tile, first, n, m, out)
    elif count:
        n, m = _bottom(heights, tile, count, first, n, m, out)
    out.ends[t + 1, 0], out.ends[t + 1, 1] = n, m


@helper
def _wall(
    heights: HeightMap,
    tile: _Tile,
    ends: tuple[int, int],
    side: tuple[float, float],
    first: int,
    n: int,
    m: int,
    out: TileMeshes,
) -> tuple[int, int]:
    """The stock's outer wall below an edge on the map's border; its upper side is on the left of the edge."""
    begin = n - first
    for node in ends:
        x, y = heights.x[tile.column[node // _SIDE]], heights.y[tile.row[node % _SIDE]]
        for z in (tile.tops[node], tile.bottoms[node]):
            _vertex(n, out, x, y, z)
            _normal(n, out, side[0], side[1], 0.0)
            n += 1
    out.triangles[m, 0], out.triangles[m, 1], out.triangles[m, 2] = begin, begin + 1, begin + 3
    out.triangles[m + 1, 0], out.triangles[m + 1, 1], out.triangles[m + 1, 2] = begin, begin + 3, begin + 2
    return n, m + 2


@helper
def _flat_bottom(heights: HeightMap, tile: _Tile, first: int, n: int, m: int, out: TileMeshes) -> tuple[int, int]:
    """A rectangle as lower side."""
    begin = n - first
    for i, j in ((0, 0), (0, CELLS), (CELLS, CELLS), (CELLS, 0)):
        _vertex(n, out, heights.x[tile.column[i]], heights.y[tile.row[j]], tile.bottoms[i * _SIDE + j])
        _normal(n, out, 0.0, 0.0, -1.0)
        n += 1
    out.triangles[m, 0], out.triangles[m, 1], out.triangles[m, 2] = begin, begin + 1, begin + 2
    out.triangles[m + 1, 0], out.triangles[m + 1, 1], out.triangles[m + 1, 2] = begin, begin + 2, begin + 3
    return n, m + 2


@helper
def _bottom(
    heights: HeightMap, tile: _Tile, count: int, first: int, n: int, m: int, out: TileMeshes
) -> tuple[int, int]:
    """A lower side in the triangles of the upper one."""
    for k in range(count):
        for corner in range(3):
            node = tile.corners[k, corner] // 3
            slot = 3 * node + _BELOW
            if tile.numbers[slot] < 0:
                i, j = tile.column[node // _SIDE], tile.row[node % _SIDE]
                _vertex(n, out, heights.x[i], heights.y[j], tile.bottoms[node])
                _normal(n, out, 0.0, 0.0, -1.0)
                n += 1
                tile.numbers[slot] = n - first
            out.triangles[m, 2 - corner] = tile.numbers[slot] - 1
        m += 1
    return n, m
