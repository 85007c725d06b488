"""Points and areas of material in column cells; compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells.edge_kernels import edge_of, v_on
from twin.geometry.column_cells.store_kernels import FULL, PARTIAL, SIZE, START, STATE, CellStore, Grid, cell_at
from twin.jit import helper, inlined, njit


class Planes(NamedTuple):
    """Where a family's planes are: at ``low + (k + 1/2) pitch`` along an axis, with in-plane axes u and v."""

    normal_axis: int
    u_axis: int
    v_axis: int
    low: float
    pitch: float


@inlined
def _odd_above(u: float, v: float, begin: int, end: int, pool: FloatArray) -> bool:
    """Whether an odd number of a cell's edges lies above a point."""
    inside = False
    for e in range(begin, end):
        if pool[e, 0] <= u < pool[e, 2] and v_on(edge_of(pool, e), u) > v:
            inside = not inside
    return inside


@njit
def contains(
    points: FloatArray,
    planes: Planes,
    grid: Grid,
    store: CellStore,
    votes: NDArray[np.int8],
    least: int,
    most: int,
) -> None:
    """Add one vote to each point that lies in material on the nearest plane of a family.

    Points whose votes are below ``least`` or above ``most`` already are not examined: their case is settled.
    """
    table, page, cells, pool = store.table, store.page, store.cells, store.pool
    for i in range(len(points)):
        if votes[i] < least or votes[i] > most:
            continue
        k = int(math.floor((points[i, planes.normal_axis] - planes.low) / planes.pitch))
        u, v = points[i, planes.u_axis], points[i, planes.v_axis]
        column = int(math.floor((u - grid.u_low) / grid.size))
        tile = int(math.floor((v - grid.v_low) / grid.size))
        if k < 0 or k >= len(table) or column < 0 or column >= grid.columns or tile < 0 or tile >= grid.tiles:
            continue
        if table[k, column] == 0:
            continue
        cell = cell_at(page, table[k, column], tile)
        state, begin, end = cells[cell, STATE], cells[cell, START], cells[cell, START] + cells[cell, SIZE]
        if state == FULL or (state == PARTIAL and _odd_above(u, v, begin, end, pool)):
            votes[i] += 1


class Family(NamedTuple):
    """One family of planes and its cells."""

    planes: Planes
    grid: Grid
    store: CellStore


@njit
def most_contain(points: FloatArray, x: Family, y: Family, z: Family, inside: NDArray[np.bool_]) -> None:
    """Whether points lie in material on the nearest planes of at least two of three families.

    Args:
        points: shape (n, 3).
        inside: shape (n,), filled.
    """
    votes = np.zeros(len(points), dtype=np.int8)
    contains(points, x.planes, x.grid, x.store, votes, 0, 0)
    contains(points, y.planes, y.grid, y.store, votes, 0, 1)
    contains(points, z.planes, z.grid, z.store, votes, 1, 1)
    for i in range(len(points)):
        inside[i] = votes[i] > 1


@njit
def top_heights(store: CellStore, grid: Grid, first: int, first_column: int, base: float, heights: FloatArray) -> None:
    """Height of the highest material in columns of consecutive planes.

    Args:
        first, first_column: the plane and the column of the first entry of ``heights``.
        base: material below this v need not be found.
        heights: shape (planes, columns), filled: -inf where there is none, inf where a plane is not built.
    """
    lowest_tile = max(0, int(math.floor((base - grid.v_low) / grid.size)))
    for i in range(len(heights)):
        for j in range(heights.shape[1]):
            table = store.table[first + i, first_column + j]
            heights[i, j] = -math.inf if table != 0 else math.inf
            for tile in range(grid.tiles - 1 if table != 0 else -1, lowest_tile - 1, -1):
                cell = cell_at(store.page, table, tile)
                state = store.cells[cell, STATE]
                if state == FULL:
                    heights[i, j] = grid.v_low + (tile + 1) * grid.size
                    break
                if state == PARTIAL:
                    begin, end = store.cells[cell, START], store.cells[cell, START] + store.cells[cell, SIZE]
                    for e in range(begin, end):
                        heights[i, j] = max(heights[i, j], store.pool[e, 1], store.pool[e, 3])
                    break


@njit
def plane_trapezoids(tables: NDArray[np.int64], grid: Grid, store: CellStore, out: FloatArray) -> int:
    """Material of a plane, given by its columns' tables, as trapezoids with vertical sides.

    Rows are (ua, ub, bottom a, bottom b, top a, top b). Runs of full tiles in a column make one rectangle.

    Returns:
        The number of rows, or -1 when ``out`` is too short.
    """
    n = 0
    for column in range(len(tables)):
        c0 = grid.u_low + column * grid.size
        c1 = grid.u_low + (column + 1) * grid.size
        tile = 0
        while tile < grid.tiles:
            cell = cell_at(store.page, tables[column], tile)
            floor = grid.v_low + tile * grid.size
            if store.cells[cell, STATE] == FULL:
                tile = _end_of_full(tables[column], tile, grid.tiles, store)
                if n >= len(out):
                    return -1
                top = grid.v_low + tile * grid.size
                out[n, 0], out[n, 1], out[n, 2], out[n, 3], out[n, 4], out[n, 5] = c0, c1, floor, floor, top, top
                n += 1
                continue
            if store.cells[cell, STATE] == PARTIAL:
                n = _cell_trapezoids(cell, floor, store, out, n)
                if n < 0:
                    return -1
            tile += 1
    return n


@helper
def _end_of_full(table: int, tile: int, tiles: int, store: CellStore) -> int:
    """The first tile from ``tile`` on that is not full."""
    while tile < tiles and store.cells[cell_at(store.page, table, tile), STATE] == FULL:
        tile += 1
    return tile


@helper
def _cell_trapezoids(cell: int, floor: float, store: CellStore, out: FloatArray, n: int) -> int:
    """Append the trapezoids of one cell with edges; returns the number of rows, or -1 when they do not fit."""
    pool, begin, count = store.pool, store.cells[cell, START], store.cells[cell, SIZE]
    cuts, stack = np.empty(2 * count), np.empty(count, dtype=np.int64)
    for e in range(count):
        cuts[2 * e], cuts[2 * e + 1] = pool[begin + e, 0], pool[begin + e, 2]
    cuts.sort()
    for c in range(2 * count - 1):
        ua, ub = cuts[c], cuts[c + 1]
        if ub <= ua:
            continue
        hits = _stack_edges(pool, begin, count, 0.5 * (ua + ub), stack)
        for t in range(hits - 1, -1, -2):
            if n >= len(out):
                return -1
            upper = edge_of(pool, stack[t])
            out[n, 0], out[n, 1] = ua, ub
            out[n, 2], out[n, 3] = floor, floor
            out[n, 4], out[n, 5] = v_on(upper, ua), v_on(upper, ub)
            if t > 0:
                lower = edge_of(pool, stack[t - 1])
                out[n, 2], out[n, 3] = v_on(lower, ua), v_on(lower, ub)
            n += 1
    return n


@helper
def _stack_edges(pool: FloatArray, begin: int, count: int, u: float, stack: NDArray[np.int64]) -> int:
    """Write a cell's edges over u from the lowest to the highest; returns their number."""
    hits = 0
    for e in range(begin, begin + count):
        edge = edge_of(pool, e)
        if edge.u0 <= u < edge.u1:
            v = v_on(edge, u)
            at = hits
            while at > 0 and v_on(edge_of(pool, stack[at - 1]), u) > v:
                stack[at] = stack[at - 1]
                at -= 1
            stack[at] = e
            hits += 1
    return hits
