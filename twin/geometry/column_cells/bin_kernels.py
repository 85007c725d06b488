"""Where planes of column cells have material, in bins along u; compiled."""

from __future__ import annotations

import math

from twin.arrays import FloatArray
from twin.geometry.column_cells.edge_kernels import Edge, edge_of, v_on
from twin.geometry.column_cells.store_kernels import EMPTY, FULL, SIZE, START, STATE, CellStore, Grid, cell_at
from twin.jit import helper, njit


@njit
def bin_tops(store: CellStore, grid: Grid, first: int, first_column: int, base: float, heights: FloatArray) -> None:
    """Height of the highest material in bins of consecutive planes; a column has a whole number of bins.

    Args:
        first, first_column: the plane and the column of the first entries of ``heights``.
        base: material below this v need not be found.
        heights: shape (planes, columns, bins), filled: -inf where there is none, inf where a plane is not built.
    """
    lowest_tile = max(0, int(math.floor((base - grid.v_low) / grid.size)))
    bins = heights.shape[2]
    for i in range(len(heights)):
        for j in range(heights.shape[1]):
            table = store.table[first + i, first_column + j]
            row = heights[i, j]
            row[:] = -math.inf if table != 0 else math.inf
            found = 0 if table != 0 else bins
            tile = grid.tiles - 1
            while tile >= lowest_tile and found < bins:
                found = _raise_bins(store, grid, table, first_column + j, tile, row)
                tile -= 1


@helper
def _raise_bins(store: CellStore, grid: Grid, table: int, column: int, tile: int, row: FloatArray) -> int:
    """Fill the bins without a height from one cell; returns how many have one then."""
    cell, bins = cell_at(store.page, table, tile), len(row)
    state = store.cells[cell, STATE]
    if state != EMPTY:
        floor, c0, width = grid.v_low + tile * grid.size, grid.u_low + column * grid.size, grid.size / bins
        if state == FULL:
            for b in range(bins):
                if row[b] == -math.inf:
                    row[b] = floor + grid.size
        else:
            begin = store.cells[cell, START]
            for e in range(begin, begin + store.cells[cell, SIZE]):
                edge = edge_of(store.pool, e)
                if edge.sign > 0.0:
                    _raise_to_edge(edge, c0, width, floor + grid.size, row)
    found = 0
    for b in range(bins):
        found += row[b] > -math.inf
    return found


@helper
def _raise_to_edge(edge: Edge, c0: float, width: float, top: float, row: FloatArray) -> None:
    """Raise the bins under an edge that has material below it, where they have no height above its cell's top."""
    first = max(0, int(math.floor((edge.u0 - c0) / width)))
    last = min(len(row) - 1, int(math.floor((edge.u1 - c0) / width)))
    for b in range(first, last + 1):
        if row[b] <= top:
            a, c = max(edge.u0, c0 + b * width), min(edge.u1, c0 + (b + 1) * width)
            if c >= a:
                row[b] = max(row[b], v_on(edge, a), v_on(edge, c))


@njit
def occupied_columns(
    store: CellStore, grid: Grid, first: int, first_column: int, range_v: tuple[float, float], heights: FloatArray
) -> None:
    """Whether columns of consecutive planes have material between two v.

    Args:
        first, first_column: the plane and the column of the first entries of ``heights``.
        heights: shape (planes, columns, 1), filled: inf where there is material, -inf where there is none.
    """
    low = max(0, int(math.floor((range_v[0] - grid.v_low) / grid.size)))
    high = min(grid.tiles - 1, int(math.floor((range_v[1] - grid.v_low) / grid.size)))
    for i in range(len(heights)):
        for j in range(heights.shape[1]):
            table = store.table[first + i, first_column + j]
            heights[i, j, 0] = -math.inf if table != 0 else math.inf
            for tile in range(low, high + 1 if table != 0 else low):
                if store.cells[cell_at(store.page, table, tile), STATE] != EMPTY:
                    heights[i, j, 0] = math.inf
                    break
