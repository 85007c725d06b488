"""Column cells: polygons on parallel planes divided into small cells, and the memory that holds them; compiled.

A plane is divided into columns along u and tiles along v, all squares of one size. A cell is EMPTY, FULL, or PARTIAL
with its own list of edges (see `twin.geometry.column_cells.edge_kernels`). Where material continues through the top of
a cell a closing edge lies there, so that a point is in material when an odd number of the cell's edges lies above it
(half-open in u).

Cells lie in pages of 8 tiles of one column, and each column has a table of its pages: ``page[table[k, column], block]``
is the index of the first cell of a page on plane k; ``table[k, column]`` is 0 while the plane is not built. Columns
that begin alike, on one plane or on many, share their table until one is cut: then it gets its own (``own_table``),
and each page that is cut becomes its own (``own``), with the same edges, which are never written where they belong to
another cell (their room is 0). Pages without edges are shared between neighbouring columns, too.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells.edge_kernels import EDGE_COLUMNS
from twin.jit import helper

#: States of a cell.
EMPTY, FULL, PARTIAL = 0, 1, 2
#: Answers of kernels that write cells: done, or which array has no room left. Make room and call again.
DONE, POOL_FULL, SCRATCH_FULL, CELLS_FULL, TABLES_FULL = 0, 1, 2, 3, 4
#: Columns of the array of cells: state, first edge, number of edges, room for edges.
STATE, START, SIZE, ROOM = 0, 1, 2, 3
#: Entries of ``used``.
CELLS, TABLES = 0, 1
#: Tiles in a page of cells: 2 ** 3.
PAGE_BITS = 3
PAGE_TILES = 1 << PAGE_BITS
_IN_PAGE = PAGE_TILES - 1
_SMALLEST_BLOCK = 4


class Grid(NamedTuple):
    """Division of a family's planes into cells, the same on each of them.

    Attributes:
        u_low, v_low: lower corner of the first cell, mm.
        size: size of a cell, mm.
        columns, tiles: number of cells along u and v.
    """

    u_low: float
    v_low: float
    size: float
    columns: int
    tiles: int


class CellStore(NamedTuple):
    """Cells of all planes of a family.

    Attributes:
        table: shape (planes, columns), table of pages of each column; 0 where the plane is not built.
        page: shape (tables, blocks), first cell of each page.
        own_table: shape (tables,), whether a table belongs to one column only.
        own: shape (tables, blocks), whether a page belongs to one column only.
        used: shape (2,), number of cells and of tables in use.
        cells: shape (n, 4), see `STATE`, `START`, `SIZE`, `ROOM`.
        pool: shape (n, 5), edges of all cells; of a released block the first number is the next released block.
        free: first released block of 4 * 2**e edges in entry e, or -1; the last entry is the end of the used pool.
    """

    table: NDArray[np.int64]
    page: NDArray[np.int64]
    own_table: NDArray[np.bool_]
    own: NDArray[np.bool_]
    used: NDArray[np.int64]
    cells: NDArray[np.int32]
    pool: FloatArray
    free: NDArray[np.int64]


class Scratch(NamedTuple):
    """Memory for one cell's work; all grows together when a kernel answers SCRATCH_FULL.

    Attributes:
        segments: shape (n, 8), see `twin.geometry.column_cells.strip_kernels.split_segments`.
        toggles_lo, toggles_hi: shape (4 n,), positions along u.
        work, out: shape (n, 5), edges.
    """

    segments: FloatArray
    toggles_lo: FloatArray
    toggles_hi: FloatArray
    work: FloatArray
    out: FloatArray


@helper
def cell_at(page: NDArray[np.int64], table: int, tile: int) -> int:
    """Index of the cell of a tile in a column with a table of pages."""
    return page[table, tile >> PAGE_BITS] + (tile & _IN_PAGE)


@helper
def _block_class(count: int | np.int64) -> int:
    """Smallest power of two, as an exponent above the smallest block, that holds ``count`` edges."""
    size = _SMALLEST_BLOCK
    exponent = 0
    while size < count:
        size *= 2
        exponent += 1
    return exponent


@helper
def _release(cell: int, cells: NDArray[np.int32], pool: FloatArray, free: NDArray[np.int64]) -> None:
    """Return a cell's block of edges to the pool, if it has one."""
    if cells[cell, ROOM] > 0:
        exponent = _block_class(np.int64(cells[cell, ROOM]))
        pool[cells[cell, START], 0] = float(free[exponent])
        free[exponent] = cells[cell, START]
        cells[cell, ROOM] = 0


@helper
def _reserve(cell: int, count: int, cells: NDArray[np.int32], pool: FloatArray, free: NDArray[np.int64]) -> bool:
    """Give a cell a block with room for ``count`` edges; False when the pool has none (nothing is changed then)."""
    exponent = _block_class(count)
    block = _SMALLEST_BLOCK << exponent
    last = len(free) - 1
    if free[exponent] >= 0:
        begin = free[exponent]
        free[exponent] = int(pool[begin, 0])
    else:
        begin = free[last]
        if begin + block > len(pool):
            return False
        free[last] = begin + block
    _release(cell, cells, pool, free)
    cells[cell, START] = begin
    cells[cell, ROOM] = block
    return True


@helper
def store_edges(
    cell: int,
    edges: FloatArray,
    count: int,
    cells: NDArray[np.int32],
    pool: FloatArray,
    free: NDArray[np.int64],
) -> bool:
    """Give a cell its edges, which make it PARTIAL, or EMPTY without any; False when the pool has no room."""
    if count > cells[cell, ROOM] and not _reserve(cell, count, cells, pool, free):
        return False
    begin = cells[cell, START]
    for i in range(count):
        for c in range(EDGE_COLUMNS):
            pool[begin + i, c] = edges[i, c]
    cells[cell, SIZE] = count
    if count == 0:
        _release(cell, cells, pool, free)
        cells[cell, STATE] = EMPTY
    else:
        cells[cell, STATE] = PARTIAL
    return True


@helper
def own_page(store: CellStore, plane: int, column: int, tile: int) -> int:
    """Give a column of a plane cells of its own for a tile's page, if it has none; DONE, TABLES_FULL or CELLS_FULL."""
    table, page, used = store.table, store.page, store.used
    if not store.own_table[table[plane, column]]:
        if used[TABLES] >= len(page):
            return TABLES_FULL
        for block in range(page.shape[1]):
            page[used[TABLES], block] = page[table[plane, column], block]
        store.own_table[used[TABLES]] = True
        store.own[used[TABLES]] = False
        table[plane, column] = used[TABLES]
        used[TABLES] += 1
    t, block = table[plane, column], tile >> PAGE_BITS
    if store.own[t, block]:
        return DONE
    if used[CELLS] + PAGE_TILES > len(store.cells):
        return CELLS_FULL
    _copy_page(page[t, block], used[CELLS], store.cells)
    page[t, block] = used[CELLS]
    used[CELLS] += PAGE_TILES
    store.own[t, block] = True
    return DONE


@helper
def _copy_page(old: int, new: int, cells: NDArray[np.int32]) -> None:
    """Copy the cells of a page; the edges still belong to the old ones."""
    for tile in range(PAGE_TILES):
        for field in range(ROOM):
            cells[new + tile, field] = cells[old + tile, field]
        cells[new + tile, ROOM] = 0
