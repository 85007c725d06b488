"""Where lines along u or v enter and leave the material of a plane, and how the boundary leans there; compiled.

Ends come in pairs: material from the first to the second, from the third to the fourth, and so on. Two ends that are
no further apart than ``merge`` cancel, be it a sliver or a slit. ``slopes`` hold the boundary's d(end) / d(line
position). A line at ``at`` is met by an edge that has one end at most ``at`` and the other above it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import njit

_EMPTY, _FULL = 0, 1
#: Columns of the array of cells, as there.
_STATE, _START, _SIZE = 0, 1, 2
#: Tiles in a page of cells, as there.
_PAGE_BITS, _IN_PAGE = 3, 7


@njit
def _sort(ends: FloatArray, slopes: FloatArray, first: int, last: int) -> None:
    """Insertion sort of a few ends with their slopes."""
    for i in range(first + 1, last):
        end, slope = ends[i], slopes[i]
        j = i
        while j > first and ends[j - 1] > end:
            ends[j], slopes[j] = ends[j - 1], slopes[j - 1]
            j -= 1
        ends[j], slopes[j] = end, slope


@njit
def _join(ends: FloatArray, slopes: FloatArray, begin: int, first: int, last: int, merge: float) -> int:
    """Append the ends [first, last) to those from ``begin`` on, without neighbours that meet; returns the new end."""
    n = first
    for i in range(first, last):
        if n > begin and ends[i] - ends[n - 1] <= merge:
            n -= 1
        else:
            ends[n], slopes[n] = ends[i], slopes[i]
            n += 1
    return n


@njit
def cell_u_lines(
    lines: FloatArray,
    window: tuple[float, float],
    merge: float,
    tables: NDArray[np.int64],
    page: NDArray[np.int64],
    grid: FloatArray,
    tiles: int,
    cells: NDArray[np.int32],
    pool: FloatArray,
    offsets: NDArray[np.int64],
    ends: FloatArray,
    slopes: FloatArray,
) -> int:
    """Lines u = const through column cells (see `twin.geometry.column_cells.kernels`).

    Args:
        window: only cells between these v are looked at.
        tables: shape (p, columns), the table of pages of each column of each plane.
        page: see there.
        offsets: shape (p n + 1,), filled: all lines of the first plane, then those of the second, ...
        ends, slopes: filled.

    Returns:
        how many ends were written, or -1 when they do not fit.
    """
    h = grid[2]
    t0 = max(0, math.floor((window[0] - grid[1]) / h))
    t1 = min(tiles, math.floor((window[1] - grid[1]) / h) + 1)
    n = 0
    offsets[0] = 0
    for i in range(len(tables) * len(lines)):
        begin = n
        plane = i // len(lines)
        u = lines[i % len(lines)]
        column = math.floor((u - grid[0]) / h)
        if 0 <= column < tables.shape[1]:
            for tile in range(t0, t1):
                cell = page[tables[plane, column], tile >> _PAGE_BITS] + (tile & _IN_PAGE)
                if cells[cell, _STATE] == _EMPTY:
                    continue
                if n + 3 + cells[cell, _SIZE] > len(ends):
                    return -1
                floor = grid[1] + tile * h
                m = n
                if cells[cell, _STATE] == _FULL:
                    ends[m], slopes[m] = grid[1] + (tile + 1) * h, 0.0
                    m += 1
                else:
                    for e in range(cells[cell, _START], cells[cell, _START] + cells[cell, _SIZE]):
                        if pool[e, 0] <= u < pool[e, 2]:
                            slope = (pool[e, 3] - pool[e, 1]) / (pool[e, 2] - pool[e, 0])
                            ends[m], slopes[m] = pool[e, 1] + slope * (u - pool[e, 0]), slope
                            m += 1
                if (m - n) % 2 == 1:
                    ends[m], slopes[m] = floor, 0.0
                    m += 1
                _sort(ends, slopes, n, m)
                n = _join(ends, slopes, begin, n, m, merge)
        offsets[i + 1] = n
    return n


@njit
def cell_v_lines(
    lines: FloatArray,
    window: tuple[float, float],
    merge: float,
    tables: NDArray[np.int64],
    page: NDArray[np.int64],
    grid: FloatArray,
    tiles: int,
    cells: NDArray[np.int32],
    pool: FloatArray,
    offsets: NDArray[np.int64],
    ends: FloatArray,
    slopes: FloatArray,
) -> int:
    """Lines v = const through column cells; as `cell_u_lines`, ``window`` in u.

    A point is in material when an odd number of edges lies above it, so each edge turns material on where it begins to
    lie above the line, and off where it stops to.
    """
    h = grid[2]
    c0 = max(0, math.floor((window[0] - grid[0]) / h))
    c1 = min(tables.shape[1], math.floor((window[1] - grid[0]) / h) + 1)
    n = 0
    offsets[0] = 0
    for i in range(len(tables) * len(lines)):
        begin = n
        plane = i // len(lines)
        v = lines[i % len(lines)]
        tile = math.floor((v - grid[1]) / h)
        if 0 <= tile < tiles:
            for column in range(c0, c1):
                cell = page[tables[plane, column], tile >> _PAGE_BITS] + (tile & _IN_PAGE)
                if cells[cell, _STATE] == _EMPTY:
                    continue
                if n + 2 + 2 * cells[cell, _SIZE] > len(ends):
                    return -1
                m = n
                if cells[cell, _STATE] == _FULL:
                    ends[m], slopes[m] = grid[0] + column * h, 0.0
                    ends[m + 1], slopes[m + 1] = grid[0] + (column + 1) * h, 0.0
                    m += 2
                else:
                    for e in range(cells[cell, _START], cells[cell, _START] + cells[cell, _SIZE]):
                        u0, v0, u1, v1 = pool[e, 0], pool[e, 1], pool[e, 2], pool[e, 3]
                        if v0 <= v and v1 <= v:
                            continue
                        ends[m], slopes[m], ends[m + 1], slopes[m + 1] = u0, 0.0, u1, 0.0
                        if v0 <= v or v1 <= v:
                            slope = (u1 - u0) / (v1 - v0)
                            side = m if v0 <= v else m + 1
                            ends[side], slopes[side] = u0 + slope * (v - v0), slope
                        m += 2
                _sort(ends, slopes, n, m)
                n = _join(ends, slopes, begin, n, m, merge)
        offsets[i + 1] = n
    return n


@njit
def ring_lines(
    lines: FloatArray,
    fixed: int,
    merge: float,
    edges: FloatArray,
    offsets: NDArray[np.int64],
    ends: FloatArray,
    slopes: FloatArray,
) -> int:
    """Lines through plain rings: every line against every edge.

    Args:
        fixed: 0 for lines u = const, 1 for v = const.
        edges: shape (n, 4), rows (u0, v0, u1, v1).

    Returns:
        how many ends were written, or -1 when they do not fit.
    """
    free = 1 - fixed
    n = 0
    offsets[0] = 0
    for i in range(len(lines)):
        begin = n
        at = lines[i]
        m = n
        for e in range(len(edges)):
            a, b = edges[e, fixed], edges[e, 2 + fixed]
            if (a <= at) != (b <= at):
                if m >= len(ends):
                    return -1
                slope = (edges[e, 2 + free] - edges[e, free]) / (b - a)
                ends[m], slopes[m] = edges[e, free] + slope * (at - a), slope
                m += 1
        _sort(ends, slopes, n, m)
        n = _join(ends, slopes, begin, n, m, merge)
        offsets[i + 1] = n
    return n
