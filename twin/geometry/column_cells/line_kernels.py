"""Lines along u or v through column cells: where they enter and leave material; compiled.

Ends, slopes and merging are those of `twin.geometry.polygons.line_kernels`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells.edge_kernels import edge_of
from twin.geometry.column_cells.store_kernels import EMPTY, FULL, SIZE, START, STATE, CellStore, Grid, cell_at
from twin.geometry.column_cells.strip_kernels import Tile, tile_of
from twin.geometry.polygons.line_kernels import LineEnds, join_sorted
from twin.jit import inlined, njit


@njit
def cell_lines(
    lines: FloatArray,
    fixed: int,
    window: tuple[float, float],
    merge: float,
    tables: NDArray[np.int64],
    grid: Grid,
    store: CellStore,
    out: LineEnds,
) -> int:
    """Lines through column cells.

    Args:
        fixed: 0 for lines u = const, 1 for v = const.
        window: only cells between these values of the other coordinate are examined.
        tables: shape (p, columns), the table of pages of each column of each plane.
        out: filled: all lines of the first plane, then those of the second, ...

    Returns:
        The number of ends, or -1 when they do not fit.
    """
    page, cells, pool = store.page, store.cells, store.pool
    offsets, ends, slopes = out.offsets, out.ends_mm, out.slopes
    low, count, across_low, across = grid.u_low, grid.columns, grid.v_low, grid.tiles
    if fixed:
        low, count, across_low, across = across_low, across, low, count
    first = max(0, math.floor((window[0] - across_low) / grid.size))
    last = min(across, math.floor((window[1] - across_low) / grid.size) + 1)
    n = 0
    offsets[0] = 0
    for i in range(len(tables) * len(lines)):
        begin = n
        at = lines[i % len(lines)]
        row = math.floor((at - low) / grid.size)
        for k in range(first, last if 0 <= row < count else first):
            column, tile = (k, row) if fixed else (row, k)
            cell = cell_at(page, tables[i // len(lines), column], tile)
            if cells[cell, STATE] == EMPTY:
                continue
            if n + 3 + 2 * cells[cell, SIZE] > len(ends):
                return -1
            if fixed:
                m = _v_ends(at, cell, tile_of(grid, column, tile), cells, pool, ends, slopes, n)
            else:
                m = _u_ends(at, cell, tile_of(grid, column, tile), cells, pool, ends, slopes, n)
            n = join_sorted(ends, slopes, begin, n, m, merge)
        offsets[i + 1] = n
    return n


@inlined
def _u_ends(
    u: float,
    cell: int,
    box: Tile,
    cells: NDArray[np.int32],
    pool: FloatArray,
    ends: FloatArray,
    slopes: FloatArray,
    n: int,
) -> int:
    """Append the ends of a line u = const in one cell, in any order; returns how many there are then."""
    m = n
    if cells[cell, STATE] == FULL:
        ends[m], slopes[m] = box.top, 0.0
        m += 1
    else:
        for e in range(cells[cell, START], cells[cell, START] + cells[cell, SIZE]):
            edge = edge_of(pool, e)
            if edge.u0 <= u < edge.u1:
                slope = (edge.v1 - edge.v0) / (edge.u1 - edge.u0)
                ends[m], slopes[m] = edge.v0 + slope * (u - edge.u0), slope
                m += 1
    if (m - n) % 2 == 1:
        ends[m], slopes[m] = box.floor, 0.0
        m += 1
    return m


@inlined
def _v_ends(
    v: float,
    cell: int,
    box: Tile,
    cells: NDArray[np.int32],
    pool: FloatArray,
    ends: FloatArray,
    slopes: FloatArray,
    n: int,
) -> int:
    """Append the ends of a line v = const in one cell, in any order; returns how many there are then.

    A point is in material when an odd number of edges lies above it, so each edge turns material on where it begins to
    lie above the line, and off where it stops to.
    """
    m = n
    if cells[cell, STATE] == FULL:
        ends[m], slopes[m] = box.c0, 0.0
        ends[m + 1], slopes[m + 1] = box.c1, 0.0
        return m + 2
    for e in range(cells[cell, START], cells[cell, START] + cells[cell, SIZE]):
        edge = edge_of(pool, e)
        if edge.v0 <= v and edge.v1 <= v:
            continue
        ends[m], slopes[m], ends[m + 1], slopes[m + 1] = edge.u0, 0.0, edge.u1, 0.0
        if edge.v0 <= v or edge.v1 <= v:
            slope = (edge.u1 - edge.u0) / (edge.v1 - edge.v0)
            side = m if edge.v0 <= v else m + 1
            ends[side], slopes[side] = edge.u0 + slope * (v - edge.v0), slope
        m += 2
    return m
