"""Strips taken out of planes of column cells; compiled.

Cutting a strip lo(u) <= v <= hi(u) keeps the parts of the edges that are not above lo or are above hi, and adds the
parts of lo and hi that have an odd number of edges above them. Every part is classified once and both uses share the
same u, so parity cannot leak.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells.edge_kernels import Edge, area_above, crossing, edge_of, emit, part_of, put_edge, v_on
from twin.geometry.column_cells.store_kernels import (
    DONE,
    EMPTY,
    FULL,
    PAGE_BITS,
    POOL_FULL,
    SCRATCH_FULL,
    SIZE,
    START,
    STATE,
    CellStore,
    Grid,
    Scratch,
    cell_at,
    own_page,
    store_edges,
)
from twin.geometry.column_cells.strip_kernels import (
    HI_INSIDE,
    LO_INSIDE,
    UA,
    UB,
    Tile,
    U,
    covers,
    hi_of,
    lo_of,
    split_segments,
    strip_part,
    tile_of,
)
from twin.geometry.column_cells.strips import Strips
from twin.geometry.column_cells.thin_kernels import MANY_EDGES, thinned
from twin.jit import helper, njit

#: Entries of a cursor: where a kernel that ran out of room goes on.
STRIP, COLUMN, TILE = 0, 1, 2


class _Side(NamedTuple):
    """On which side of lo or hi a part of an edge runs.

    Attributes:
        above_a, above_b: whether it is above at its beginning and at its end.
        u: where it changes side; its end if it does not.
    """

    above_a: bool
    above_b: bool
    u: float


@njit
def cut_planes(
    store: CellStore,
    grid: Grid,
    strips: Strips,
    scratch: Scratch,
    cursor: NDArray[np.int64],
    merge_mm: float,
    removed: FloatArray,
) -> int:
    """Subtract strips from planes, or only measure what they would remove.

    Args:
        cursor: shape (3,): strip, column, tile to go on from; 0 at the first call, kept between calls.
        merge_mm: how far edges of a cell with many may be moved to have fewer, see
            `twin.geometry.column_cells.thin_kernels`; 0 for none; negative to leave the planes as they are.
        removed: shape (strips,), area taken by each strip, added to.

    Returns:
        DONE, or POOL_FULL / SCRATCH_FULL / CELLS_FULL / TABLES_FULL: make room and call again with the same cursor.
    """
    table, page, own_table, own = store.table, store.page, store.own_table, store.own
    cells, pool, free = store.cells, store.pool, store.free
    offsets, nodes, fresh = strips.offsets, strips.nodes, strips.fresh
    segments, toggles_lo, toggles_hi = scratch.segments, scratch.toggles_lo, scratch.toggles_hi
    work, out = scratch.work, scratch.out
    apply = merge_mm >= 0.0
    # 64-bit numbers throughout: helpers are compiled once for each type of their arguments
    while cursor[STRIP] < len(offsets) - 1:
        node, end = offsets[cursor[STRIP]], offsets[cursor[STRIP] + 1] - 1
        plane = strips.at[cursor[STRIP]]
        last_column = _last_column(nodes, end, grid) if end > node and table[plane, 0] != 0 else -1
        for column in range(max(_first_column(nodes, node, grid), cursor[COLUMN]), last_column + 1):
            part = strip_part(nodes, fresh, node, end, grid, column)
            node = part.first
            for tile in range(max(part.first_tile, cursor[TILE]), part.last_tile + 1):
                cell = cell_at(page, table[plane, column], tile)
                if cells[cell, STATE] == EMPTY:
                    continue
                box = tile_of(grid, column, tile)
                count, answer = 0, DONE
                if not covers(part, box):
                    pieces = split_segments(nodes, part, box, segments)
                    if pieces == 0:
                        continue
                    if pieces < 0:
                        count = -1
                    elif cells[cell, STATE] == FULL:
                        put_edge(work, 0, Edge(box.c0, box.top, box.c1, box.top, 1.0))
                        count = cut_edges(work, 0, 1, pieces, segments, toggles_lo, toggles_hi, out)
                    else:
                        begin, size = np.int64(cells[cell, START]), np.int64(cells[cell, SIZE])
                        count = cut_edges(pool, begin, size, pieces, segments, toggles_lo, toggles_hi, out)
                    if count < 0:
                        answer = SCRATCH_FULL
                    elif merge_mm > 0.0 and count > MANY_EDGES:
                        count = thinned(out, count, box.top, merge_mm)
                area = _area(cell, box, cells, pool)
                if apply and answer == DONE:
                    t = table[plane, column]
                    if not (own_table[t] and own[t, tile >> PAGE_BITS]):
                        answer = own_page(store, plane, column, tile)
                        cell = cell_at(page, table[plane, column], tile)
                    if answer == DONE and not store_edges(cell, out, count, cells, pool, free):
                        answer = POOL_FULL
                if answer != DONE:
                    cursor[COLUMN], cursor[TILE] = column, tile
                    return answer
                removed[cursor[STRIP]] += area - area_above(out, 0, count, box.floor)
            cursor[TILE] = 0
        cursor[COLUMN] = 0
        cursor[STRIP] += 1
    return DONE


@helper
def _first_column(nodes: FloatArray, node: int, grid: Grid) -> int:
    """The first column that a strip meets, from its first node; 0 without nodes."""
    return max(0, int(math.floor((nodes[node, U] - grid.u_low) / grid.size))) if node < len(nodes) else 0


@helper
def _last_column(nodes: FloatArray, end: int, grid: Grid) -> int:
    """The last column that a strip meets, from its last node."""
    return min(grid.columns - 1, int(math.floor((nodes[end, U] - grid.u_low) / grid.size)))


@helper
def _area(cell: int, box: Tile, cells: NDArray[np.int32], pool: FloatArray) -> float:
    """Area of material in a cell."""
    area = (box.c1 - box.c0) * (box.top - box.floor)
    if cells[cell, STATE] != FULL:
        area = area_above(pool, np.int64(cells[cell, START]), np.int64(cells[cell, SIZE]), box.floor)
    return area


@helper
def cut_edges(
    edges: FloatArray,
    begin: int | np.int64,
    size: int | np.int64,
    pieces: int,
    segments: FloatArray,
    toggles_lo: FloatArray,
    toggles_hi: FloatArray,
    out: FloatArray,
) -> int:
    """The edges of a cell without a strip.

    Args:
        edges, begin, size: the cell's edges.
        pieces, segments: the strip over the cell; see `twin.geometry.column_cells.strip_kernels.split_segments`.
        toggles_lo, toggles_hi: scratch.

    Returns:
        The number of edges in ``out``, or -1 when they do not fit.
    """
    count, n_lo, n_hi = 0, 0, 0
    for e in range(begin, begin + size):
        edge = edge_of(edges, e)
        kept, since, end = True, edge.u0, edge.u0
        for m in range(pieces):
            if segments[m, UB] <= edge.u0:
                continue
            if segments[m, UA] >= edge.u1:
                break
            a, b = max(segments[m, UA], edge.u0), min(segments[m, UB], edge.u1)
            if b <= a:
                continue
            if count + 3 >= len(out) or max(n_lo, n_hi) + 3 >= len(toggles_lo):
                return -1
            if a > end and not kept:
                kept, since = True, end
            end = b
            part = part_of(edge, a, b)
            lo, hi = _Side(True, True, b), _Side(False, False, b)
            if segments[m, LO_INSIDE] > 0.0:
                lo = _side_of(part, lo_of(segments, m))
                n_lo = _note(toggles_lo, n_lo, part, lo)
            if segments[m, HI_INSIDE] > 0.0:
                hi = _side_of(part, hi_of(segments, m))
                n_hi = _note(toggles_hi, n_hi, part, hi)
            for u, keep in _turns(a, lo, hi):
                if keep != kept:
                    if kept:
                        count = emit(out, count, part_of(edge, since, u))
                    kept, since = keep, u
        if not kept and end < edge.u1:
            kept, since = True, end
        if kept:
            if count >= len(out):
                return -1
            count = emit(out, count, part_of(edge, since, edge.u1))
    count = _emit_odd(toggles_lo, n_lo, segments, pieces, True, out, count)
    if count < 0:
        return -1
    return _emit_odd(toggles_hi, n_hi, segments, pieces, False, out, count)


@helper
def _side_of(part: Edge, curve: Edge) -> _Side:
    """On which side of lo or hi a part of an edge runs that lies over one segment."""
    da, db = part.v0 - v_on(curve, part.u0), part.v1 - v_on(curve, part.u1)
    above_a, above_b = da > 0.0, db > 0.0
    u = part.u1
    if above_a != above_b:
        u = crossing(part.u0, part.u1, da, db)
    return _Side(above_a, above_b, u)


@helper
def _note(toggles: FloatArray, n: int, part: Edge, side: _Side) -> int:
    """Append where an edge begins and ends to run above lo or hi; returns the number of toggles."""
    if side.above_a:
        toggles[n] = part.u0
        n += 1
    if side.above_a != side.above_b:
        toggles[n] = side.u
        n += 1
    if side.above_b:
        toggles[n] = part.u1
        n += 1
    return n


@helper
def _turns(a: float, lo: _Side, hi: _Side) -> tuple[tuple[float, bool], tuple[float, bool], tuple[float, bool]]:
    """Whether an edge is kept from ``a`` on, and from where it changes side: it is where above hi or not above lo."""
    begin, end = hi.above_a or not lo.above_a, hi.above_b or not lo.above_b
    if lo.u <= hi.u:
        return (a, begin), (lo.u, hi.above_a or not lo.above_b), (hi.u, end)
    return (a, begin), (hi.u, hi.above_b or not lo.above_a), (lo.u, end)


@helper
def _emit_odd(
    toggles: FloatArray, n: int, segments: FloatArray, pieces: int, lower: bool, out: FloatArray, count: int
) -> int:
    """Add the parts of lo (``lower``) or hi between an odd and the next toggle; -1 when they do not fit.

    Parts that meet are added as one, or a surface that is cut again and again would be divided ever more finely.
    """
    if n == 0:
        return count
    toggles[:n].sort()
    m, i = 0, 0
    while i < n:
        ua, ub = toggles[i], toggles[i + 1]
        i += 2
        while i < n and toggles[i] == ub:
            ub = toggles[i + 1]
            i += 2
        if ub <= ua:
            continue
        while m > 0 and segments[m, UA] > ua:
            m -= 1
        while m < pieces and segments[m, UA] < ub:
            if segments[m, UB] > ua:
                if count >= len(out):
                    return -1
                curve = lo_of(segments, m) if lower else hi_of(segments, m)
                count = emit(out, count, part_of(curve, max(ua, curve.u0), min(ub, curve.u1)))
            m += 1
        m = min(m, pieces - 1)
    return count
