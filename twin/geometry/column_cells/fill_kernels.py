"""Cells of a plane made from the edges of its rings; compiled."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells.edge_kernels import Edge, crossing, edge_of, emit, part_of
from twin.geometry.column_cells.store_kernels import (
    CELLS,
    CELLS_FULL,
    DONE,
    FULL,
    PAGE_TILES,
    PARTIAL,
    POOL_FULL,
    ROOM,
    SCRATCH_FULL,
    SIZE,
    STATE,
    TABLES,
    TABLES_FULL,
    CellStore,
    Grid,
    Scratch,
    store_edges,
)
from twin.geometry.column_cells.strip_kernels import Tile, tile_of
from twin.jit import helper, njit

#: A closing edge over this part of a cell's width spans it; the rest is rounding.
_WHOLE_WIDTH = 1.0 - 1e-12


@njit
def fill_plane(
    edges: FloatArray,
    alone: bool,
    grid: Grid,
    store: CellStore,
    tables: NDArray[np.int64],
    scratch: Scratch,
    cursor: NDArray[np.int64],
) -> int:
    """Build one plane's cells from the edges of its rings.

    Args:
        edges: shape (n, 5), all non-vertical ring edges.
        alone: no other plane will share these cells.
        tables: shape (columns,), filled: the table of each column.
        cursor: shape (1,): column to go on from.

    Returns:
        DONE or what ran out, as `twin.geometry.column_cells.cut_kernels.cut_planes`.
    """
    blocks = store.page.shape[1]
    without_edges = False
    while cursor[0] < len(tables):
        column = cursor[0]
        if store.used[TABLES] >= len(store.page):
            return TABLES_FULL
        if store.used[CELLS] + blocks * PAGE_TILES > len(store.cells):
            return CELLS_FULL
        c0 = grid.u_low + column * grid.size
        c1 = grid.u_low + (column + 1) * grid.size
        if without_edges and _all_level(edges, grid.u_low + (column - 1) * grid.size, c1):
            tables[column] = tables[column - 1]
            store.own_table[tables[column]] = False
        else:
            answer = _fill_tiles(_edges_between(edges, c0, c1, scratch.work), column, grid, store, scratch)
            if answer != DONE:
                return answer
            without_edges = _share_pages(tables, column, grid.tiles, alone, store)
        cursor[0] += 1
    return DONE


@helper
def _all_level(edges: FloatArray, begin: float, end: float) -> bool:
    """Whether all edges between two u run level from the one to the other."""
    for e in range(len(edges)):
        edge = edge_of(edges, e)
        if edge.u0 < end and edge.u1 > begin:
            if edge.u0 > begin or edge.u1 < end or edge.v0 != edge.v1:
                return False
    return True


@helper
def _edges_between(edges: FloatArray, c0: float, c1: float, work: FloatArray) -> int:
    """Write the parts of edges between two u; returns their number, or -1 when they do not fit."""
    n = 0
    for e in range(len(edges)):
        a, b = max(c0, edges[e, 0]), min(c1, edges[e, 2])
        if b > a:
            if n >= len(work):
                return -1
            n = emit(work, n, part_of(edge_of(edges, e), a, b))
    return n


@helper
def _fill_tiles(n: int, column: int, grid: Grid, store: CellStore, scratch: Scratch) -> int:
    """Fill the first cells that are not in use with a column's edges, the first ``n`` of ``scratch.work``."""
    if n < 0:
        return SCRATCH_FULL
    cells, pool, free, first = store.cells, store.pool, store.free, store.used[CELLS]
    work, out, toggles = scratch.work, scratch.out, scratch.toggles_lo
    repeats = False
    for i in range(grid.tiles):
        cell = first + i
        tile = tile_of(grid, column, i)
        if repeats and _lowest(work, n) > tile.top:
            cells[cell, STATE] = cells[cell - 1, STATE]
            cells[cell, SIZE] = 0
            continue
        count, above = _split_at_top(n, tile, work, out, toggles)
        if count < 0:
            return SCRATCH_FULL
        closed = _spans_top(out, count, tile)
        # with all edges above, the next tile is like this one if this one is all material or none
        repeats = above == n and (closed or count == 0)
        n = above
        if closed:
            cells[cell, STATE] = FULL
            cells[cell, SIZE] = 0
        elif not store_edges(cell, out, count, cells, pool, free):
            return POOL_FULL
    return DONE


@helper
def _lowest(edges: FloatArray, n: int) -> float:
    """Lowest v of the first ``n`` edges."""
    lowest = math.inf
    for e in range(n):
        lowest = min(lowest, edges[e, 1], edges[e, 3])
    return lowest


@helper
def _split_at_top(n: int, tile: Tile, work: FloatArray, out: FloatArray, toggles: FloatArray) -> tuple[int, int]:
    """Divide a column's edges, the first ``n`` of ``work``, at a tile's top.

    The edges of the tile, closed at its top, go to ``out``; those above it stay in ``work``.

    Returns:
        The number of both; the first is -1 when they do not fit.
    """
    top = tile.top
    count, above, n_toggles = 0, 0, 0
    for e in range(n):
        if count + 2 >= len(out) or n_toggles + 2 >= len(toggles):
            return -1, 0
        edge = edge_of(work, e)
        above0, above1 = edge.v0 > top, edge.v1 > top
        if above0 and above1:
            above = emit(work, above, edge)
            toggles[n_toggles], toggles[n_toggles + 1] = edge.u0, edge.u1
            n_toggles += 2
        elif above0 or above1:
            u = crossing(edge.u0, edge.u1, edge.v0 - top, edge.v1 - top)
            low0, low1, high0, high1 = (u, edge.u1, edge.u0, u) if above0 else (edge.u0, u, u, edge.u1)
            count = emit(out, count, part_of(edge, low0, low1))
            above = emit(work, above, part_of(edge, high0, high1))
            toggles[n_toggles], toggles[n_toggles + 1] = high0, high1
            n_toggles += 2
        elif edge.v0 > tile.floor or edge.v1 > tile.floor:  # an edge on the floor lies above no point of the cell
            count = emit(out, count, edge)
    toggles[:n_toggles].sort()
    for t in range(0, n_toggles, 2):
        if count >= len(out):
            return -1, 0
        count = emit(out, count, Edge(toggles[t], top, toggles[t + 1], top, 1.0))
    return count, above


@helper
def _spans_top(edges: FloatArray, count: int, tile: Tile) -> bool:
    """Whether a cell's edges are nothing but a closing edge over its whole width."""
    covered = 0.0
    for e in range(count):
        edge = edge_of(edges, e)
        if edge.v0 != tile.top or edge.v1 != tile.top or edge.sign < 0.0:
            return False
        covered += edge.u1 - edge.u0
    return count > 0 and covered >= (tile.c1 - tile.c0) * _WHOLE_WIDTH


@helper
def _share_pages(tables: NDArray[np.int64], column: int, tiles: int, alone: bool, store: CellStore) -> bool:
    """Give a column its table: that of the column before where they are alike, else one with pages as few as possible.

    Returns:
        Whether the column has no cells with edges.
    """
    page, cells, used = store.page, store.cells, store.used
    first, t, before = used[CELLS], used[TABLES], page[tables[max(0, column - 1)]]
    new = column == 0
    without_edges = True
    for block in range(page.shape[1]):
        at, most = first + block * PAGE_TILES, min(PAGE_TILES, tiles - block * PAGE_TILES)
        plain = PARTIAL not in cells[at : at + most, STATE]
        store.own[t, block] = alone and not plain
        without_edges = without_edges and plain
        if (
            plain
            and column > 0
            and np.array_equal(cells[at : at + most, STATE], cells[before[block] : before[block] + most, STATE])
        ):
            page[t, block] = before[block]
        else:
            page[t, block] = _move_page(at, used, cells)
            new = True
    tables[column] = t if new else tables[column - 1]
    store.own_table[tables[column]] = alone and new
    used[TABLES] += new
    return without_edges


@helper
def _move_page(at: int, used: NDArray[np.int64], cells: NDArray[np.int32]) -> int:
    """Move a page with its edges to the first cells that are not in use; returns its position then."""
    to = used[CELLS]
    for tile in range(PAGE_TILES if to < at else 0):
        for field in range(ROOM + 1):
            cells[to + tile, field] = cells[at + tile, field]
        cells[at + tile, ROOM] = 0
    used[CELLS] = to + PAGE_TILES
    return to
