"""Column cells: polygons on parallel planes cut into small cells; compiled.

A plane is divided into columns along u and tiles along v, all squares of one size. A cell is EMPTY, FULL, or PARTIAL
with its own list of edges: a row of ``cells`` holds its state, first edge, number of edges, and room for edges. An edge
is a row (u0, v0, u1, v1, sign), u0 < u1, sign +1 where material lies below it and
-1 where it lies above; vertical edges are implied. Where material goes on through the top of a cell a closing edge lies
there, so that a point is in material when an odd number of the cell's edges lies above it (half-open in u).

Cutting a strip lo(u) <= v <= hi(u) keeps the parts of the edges that are not above lo or are above hi, and adds the
parts of lo and hi that have an odd number of edges above them. Every part is classified once and both uses share the
same u, so parity cannot leak.

Cells lie in pages of 8 tiles of one column, and each column has a table of its pages: ``page[table[k, column], block]``
is the index of the first cell of a page on plane k; ``table[k, column]`` is 0 while the plane is not built. Columns
that begin alike, on one plane or on many, share their table until one is cut: then it gets its own (``own_table``),
and each page that is cut becomes its own (``own``), with the same edges, which are never written where they belong to
another cell (their room is 0). Pages without edges are shared between neighbouring columns, too.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import njit

EMPTY, FULL, PARTIAL = 0, 1, 2
#: What `cut_planes` and `fill_plane` return when they ran out of room, to be called again.
DONE, POOL_FULL, SCRATCH_FULL, CELLS_FULL, TABLES_FULL = 0, 1, 2, 3, 4
_SMALLEST_BLOCK = 4
#: Columns of the array of cells: state, first edge, number of edges, room for edges.
_STATE, _START, _SIZE, _ROOM = 0, 1, 2, 3
#: Tiles in a page of cells: 2 ** 3.
PAGE_BITS = 3
PAGE_TILES = 1 << PAGE_BITS
_IN_PAGE = PAGE_TILES - 1


@njit
def _line(u: float, ua: float, va: float, ub: float, vb: float) -> float:
    """The v on the straight line through two points, exact at both."""
    if u == ua:
        return va
    if u == ub:
        return vb
    return va + (vb - va) * ((u - ua) / (ub - ua))


@njit
def _block_class(count: int) -> int:
    """Smallest power of two, as an exponent above the smallest block, that holds ``count`` edges."""
    size = _SMALLEST_BLOCK
    exponent = 0
    while size < count:
        size *= 2
        exponent += 1
    return exponent


@njit
def _release(cell: int, cells: NDArray[np.int32], pool: FloatArray, free: NDArray[np.int64]) -> None:
    if cells[cell, _ROOM] > 0:
        exponent = _block_class(cells[cell, _ROOM])
        pool[cells[cell, _START], 0] = float(free[exponent])
        free[exponent] = cells[cell, _START]
        cells[cell, _ROOM] = 0


@njit
def _store(
    cell: int,
    edges: FloatArray,
    count: int,
    cells: NDArray[np.int32],
    pool: FloatArray,
    free: NDArray[np.int64],
) -> bool:
    """Give a cell its edges; False when the pool has no room (nothing is changed then).

    ``free[e]`` heads the list of released blocks of 4 * 2**e edges; its last entry is the pool's end so far.
    """
    if count > cells[cell, _ROOM]:
        exponent = _block_class(count)
        block = _SMALLEST_BLOCK << exponent
        last = len(free) - 1
        if free[exponent] >= 0:
            place = free[exponent]
            free[exponent] = int(pool[place, 0])
        else:
            place = free[last]
            if place + block > len(pool):
                return False
            free[last] = place + block
        _release(cell, cells, pool, free)
        cells[cell, _START] = place
        cells[cell, _ROOM] = block
    begin = cells[cell, _START]
    for i in range(count):
        for c in range(5):
            pool[begin + i, c] = edges[i, c]
    cells[cell, _SIZE] = count
    if count == 0:
        _release(cell, cells, pool, free)
        cells[cell, _STATE] = EMPTY
    else:
        cells[cell, _STATE] = PARTIAL
    return True


@njit
def _cell_area(edges: FloatArray, begin: int, count: int, floor: float) -> float:
    area = 0.0
    for i in range(begin, begin + count):
        area += edges[i, 4] * (0.5 * (edges[i, 1] + edges[i, 3]) - floor) * (edges[i, 2] - edges[i, 0])
    return area


@njit
def _emit(
    out: FloatArray, count: int, ua: float, ub: float, u0: float, v0: float, u1: float, v1: float, sign: float
) -> int:
    """Append the part [ua, ub] of an edge; parts without length are dropped. The caller has made sure of room."""
    if ub > ua:
        out[count, 0] = ua
        out[count, 1] = _line(ua, u0, v0, u1, v1)
        out[count, 2] = ub
        out[count, 3] = _line(ub, u0, v0, u1, v1)
        out[count, 4] = sign
        return count + 1
    return count


@njit
def _crossing(a: float, b: float, da: float, db: float) -> float:
    """Where a linear difference, da at a and db at b, of unlike sides, passes 0; in [a, b]."""
    u = a + (b - a) * (da / (da - db))
    return min(max(u, a), b)


@njit
def _split_segments(
    nodes: FloatArray, first: int, last: int, a0: float, a1: float, floor: float, top: float, segments: FloatArray
) -> int:
    """The strip over [a0, a1] as linear pieces that cross neither the floor nor the top of a tile.

    Rows of ``segments``: ua, ub, lo(ua), lo(ub), hi(ua), hi(ub), lo inside the tile, hi inside the tile. Pieces that
    miss the tile are left out. Returns the number of rows, or -1 when they do not fit.
    """
    count = 0
    cuts = np.empty(6)
    for k in range(first, last):
        ua = max(a0, nodes[k, 0])
        ub = min(a1, nodes[k + 1, 0])
        if ub <= ua:
            continue
        n0, n1 = nodes[k, 0], nodes[k + 1, 0]
        lo_a = _line(ua, n0, nodes[k, 1], n1, nodes[k + 1, 1])
        lo_b = _line(ub, n0, nodes[k, 1], n1, nodes[k + 1, 1])
        hi_a = _line(ua, n0, nodes[k, 2], n1, nodes[k + 1, 2])
        hi_b = _line(ub, n0, nodes[k, 2], n1, nodes[k + 1, 2])
        if min(lo_a, lo_b) >= top or max(hi_a, hi_b) <= floor:
            continue
        n = 1
        cuts[0] = ua
        for level in (floor, top):
            if (lo_a > level) != (lo_b > level):
                cuts[n] = _crossing(ua, ub, lo_a - level, lo_b - level)
                n += 1
            if (hi_a > level) != (hi_b > level):
                cuts[n] = _crossing(ua, ub, hi_a - level, hi_b - level)
                n += 1
        cuts[n] = ub
        if n > 1:
            cuts[: n + 1].sort()
        for i in range(n):
            pa, pb = cuts[i], cuts[i + 1]
            if pb <= pa:
                continue
            if count >= len(segments):
                return -1
            middle = 0.5 * (pa + pb)
            lo_m = _line(middle, ua, lo_a, ub, lo_b)
            hi_m = _line(middle, ua, hi_a, ub, hi_b)
            if lo_m >= top or hi_m <= floor:
                continue
            segments[count, 0] = pa
            segments[count, 1] = pb
            segments[count, 2] = _line(pa, ua, lo_a, ub, lo_b)
            segments[count, 3] = _line(pb, ua, lo_a, ub, lo_b)
            segments[count, 4] = _line(pa, ua, hi_a, ub, hi_b)
            segments[count, 5] = _line(pb, ua, hi_a, ub, hi_b)
            segments[count, 6] = 1.0 if lo_m > floor else 0.0
            segments[count, 7] = 1.0 if hi_m < top else 0.0
            count += 1
    return count


@njit
def _emit_odd(
    toggles: FloatArray,
    n: int,
    segments: FloatArray,
    pieces: int,
    column: int,
    sign: float,
    out: FloatArray,
    count: int,
) -> int:
    """Add the parts of lo (column 2) or hi (column 4) between an odd and the next toggle; -1 when they do not fit."""
    if n == 0:
        return count
    toggles[:n].sort()
    m = 0
    for i in range(0, n, 2):
        ua, ub = toggles[i], toggles[i + 1]
        if ub <= ua:
            continue
        while m > 0 and segments[m, 0] > ua:
            m -= 1
        while m < pieces and segments[m, 0] < ub:
            if segments[m, 1] > ua:
                if count >= len(out):
                    return -1
                s0, s1 = segments[m, 0], segments[m, 1]
                count = _emit(
                    out, count, max(ua, s0), min(ub, s1), s0, segments[m, column], s1, segments[m, column + 1], sign
                )
            m += 1
        m = min(m, pieces - 1)
    return count


@njit
def _side_of(
    segment: FloatArray, column: int, a: float, b: float, va: float, vb: float, toggles: FloatArray, n: int
) -> tuple[bool, bool, float, int]:
    """On which side of lo (column 2) or hi (column 4) an edge runs from (a, va) to (b, vb), inside one segment.

    Where it runs above, its ends are noted as toggles.

    Returns:
        Whether it is above at a and at b, where it changes side (b if it does not), and the number of toggles.
    """
    s0, s1 = segment[0], segment[1]
    da = va - _line(a, s0, segment[column], s1, segment[column + 1])
    db = vb - _line(b, s0, segment[column], s1, segment[column + 1])
    above_a, above_b = da > 0.0, db > 0.0
    u = b
    if above_a:
        toggles[n] = a
        n += 1
    if above_a != above_b:
        u = _crossing(a, b, da, db)
        toggles[n] = u
        n += 1
    if above_b:
        toggles[n] = b
        n += 1
    return above_a, above_b, u, n


@njit
def _cut_edges(
    edges: FloatArray,
    begin: int,
    size: int,
    segments: FloatArray,
    pieces: int,
    toggles_lo: FloatArray,
    toggles_hi: FloatArray,
    out: FloatArray,
) -> int:
    """The edges left of a cell when the strip is taken out; returns their number, or -1 when they do not fit."""
    count = 0
    n_lo = 0
    n_hi = 0
    for e in range(begin, begin + size):
        u0, v0, u1, v1, sign = edges[e, 0], edges[e, 1], edges[e, 2], edges[e, 3], edges[e, 4]
        kept = True
        since = u0
        end = u0
        for m in range(pieces):
            if segments[m, 1] <= u0:
                continue
            if segments[m, 0] >= u1:
                break
            a = max(segments[m, 0], u0)
            b = min(segments[m, 1], u1)
            if b <= a:
                continue
            if count + 3 >= len(out) or n_lo + 3 >= len(toggles_lo) or n_hi + 3 >= len(toggles_hi):
                return -1
            if a > end and not kept:
                kept = True
                since = end
            end = b
            va = _line(a, u0, v0, u1, v1)
            vb = _line(b, u0, v0, u1, v1)
            above_a, above_b, u_lo = True, True, b
            if segments[m, 6] > 0.0:
                above_a, above_b, u_lo, n_lo = _side_of(segments[m], 2, a, b, va, vb, toggles_lo, n_lo)
            over_a, over_b, u_hi = False, False, b
            if segments[m, 7] > 0.0:
                over_a, over_b, u_hi, n_hi = _side_of(segments[m], 4, a, b, va, vb, toggles_hi, n_hi)
            above = above_a
            over = over_a
            keep = over or not above
            if keep != kept:
                if kept:
                    count = _emit(out, count, since, a, u0, v0, u1, v1, sign)
                since = a
                kept = keep
            for turn in range(2):
                first_is_lo = u_lo <= u_hi
                use_lo = first_is_lo if turn == 0 else not first_is_lo
                if use_lo:
                    if above_a == above_b:
                        continue
                    u = u_lo
                    above = above_b
                else:
                    if over_a == over_b:
                        continue
                    u = u_hi
                    over = over_b
                keep = over or not above
                if keep != kept:
                    if kept:
                        count = _emit(out, count, since, u, u0, v0, u1, v1, sign)
                    since = u
                    kept = keep
        if not kept and end < u1:
            kept = True
            since = end
        if kept:
            if count >= len(out):
                return -1
            count = _emit(out, count, since, u1, u0, v0, u1, v1, sign)
    count = _emit_odd(toggles_lo, n_lo, segments, pieces, 2, 1.0, out, count)
    if count < 0:
        return -1
    return _emit_odd(toggles_hi, n_hi, segments, pieces, 4, -1.0, out, count)


@njit
def _own_page(
    plane: int,
    column: int,
    block: int,
    table: NDArray[np.int64],
    page: NDArray[np.int64],
    own_table: NDArray[np.bool_],
    own: NDArray[np.bool_],
    used: NDArray[np.int64],
    cells: NDArray[np.int32],
) -> int:
    """Give a column of a plane cells of its own for a page, if it has none yet; DONE, TABLES_FULL or CELLS_FULL."""
    if not own_table[table[plane, column]]:
        if used[1] >= len(page):
            return TABLES_FULL
        page[used[1]] = page[table[plane, column]]
        own_table[used[1]] = True
        own[used[1]] = False
        table[plane, column] = used[1]
        used[1] += 1
    t = table[plane, column]
    if own[t, block]:
        return DONE
    old, new = page[t, block], used[0]
    if new + PAGE_TILES > len(cells):
        return CELLS_FULL
    for tile in range(PAGE_TILES):
        for column_of in range(_ROOM):
            cells[new + tile, column_of] = cells[old + tile, column_of]
        cells[new + tile, _ROOM] = 0
    used[0] += PAGE_TILES
    page[t, block] = new
    own[t, block] = True
    return DONE


@njit
def cut_planes(
    first: int,
    offsets: NDArray[np.int64],
    nodes: FloatArray,
    fresh: NDArray[np.bool_],
    grid: FloatArray,
    tiles: int,
    table: NDArray[np.int64],
    page: NDArray[np.int64],
    own_table: NDArray[np.bool_],
    own: NDArray[np.bool_],
    used: NDArray[np.int64],
    cells: NDArray[np.int32],
    pool: FloatArray,
    free: NDArray[np.int64],
    segments: FloatArray,
    toggles_lo: FloatArray,
    toggles_hi: FloatArray,
    out: FloatArray,
    cursor: NDArray[np.int64],
    apply: bool,
    removed: FloatArray,
) -> int:
    """Subtract strips from planes, or only measure what they would remove.

    Args:
        first, offsets, nodes, fresh: see `twin.geometry.column_cells.strips.Strips`.
        grid: lower u, lower v, cell size.
        used: shape (2,), number of cells and of tables in use.
        cursor: shape (3,): plane, column, tile to go on from; 0 at the first call, kept between calls.
        apply: False leaves the planes as they are.
        removed: shape (planes,), area taken from each plane, added to.

    Returns:
        DONE, or POOL_FULL / SCRATCH_FULL / CELLS_FULL / TABLES_FULL: make room and call again with the same cursor.
    """
    u_low, v_low, h = grid[0], grid[1], grid[2]
    columns = table.shape[1]
    while cursor[0] < len(offsets) - 1:
        i = cursor[0]
        n0, n1 = offsets[i], offsets[i + 1] - 1
        plane = first + i
        if n1 <= n0 or table[plane, 0] == 0:
            cursor[0] += 1
            continue
        u_first, u_last = nodes[n0, 0], nodes[n1, 0]
        last_column = min(columns - 1, int(math.floor((u_last - u_low) / h)))
        column = max(max(0, int(math.floor((u_first - u_low) / h))), cursor[1])
        node = n0
        while column <= last_column:
            c0 = u_low + column * h
            c1 = u_low + (column + 1) * h
            a0 = max(c0, u_first)
            a1 = min(c1, u_last)
            if a1 > a0:
                while node < n1 - 1 and nodes[node + 1, 0] <= a0:
                    node += 1
                end = node
                lo_a = _line(a0, nodes[node, 0], nodes[node, 1], nodes[node + 1, 0], nodes[node + 1, 1])
                hi_a = _line(a0, nodes[node, 0], nodes[node, 2], nodes[node + 1, 0], nodes[node + 1, 2])
                lo_min, lo_max, hi_min, hi_max = lo_a, lo_a, hi_a, hi_a
                while end < n1:
                    k = end
                    end += 1
                    u = min(a1, nodes[end, 0])
                    lo = _line(u, nodes[k, 0], nodes[k, 1], nodes[end, 0], nodes[end, 1])
                    hi = _line(u, nodes[k, 0], nodes[k, 2], nodes[end, 0], nodes[end, 2])
                    lo_min, lo_max = min(lo_min, lo), max(lo_max, lo)
                    hi_min, hi_max = min(hi_min, hi), max(hi_max, hi)
                    if nodes[end, 0] >= a1:
                        break
                cuts = False
                for k in range(node, end + 1):
                    cuts = cuts or fresh[k]
                if not cuts:
                    cursor[2] = 0
                    column += 1
                    continue
                tile = max(max(0, int(math.floor((lo_min - v_low) / h))), cursor[2])
                last_tile = min(tiles - 1, int(math.floor((hi_max - v_low) / h)))
                spans = a0 == c0 and a1 == c1
                while tile <= last_tile:
                    block = tile >> PAGE_BITS
                    cell = page[table[plane, column], block] + (tile & _IN_PAGE)
                    floor = v_low + tile * h
                    top = v_low + (tile + 1) * h
                    if cells[cell, _STATE] == EMPTY:
                        tile += 1
                        continue
                    if spans and lo_max <= floor and hi_min >= top:
                        if cells[cell, _STATE] == FULL:
                            area = (c1 - c0) * (top - floor)
                        else:
                            area = _cell_area(pool, cells[cell, _START], cells[cell, _SIZE], floor)
                        if apply:
                            answer = _own_page(plane, column, block, table, page, own_table, own, used, cells)
                            if answer != DONE:
                                cursor[1] = column
                                cursor[2] = tile
                                return answer
                            cell = page[table[plane, column], block] + (tile & _IN_PAGE)
                            _release(cell, cells, pool, free)
                            cells[cell, _SIZE] = 0
                            cells[cell, _STATE] = EMPTY
                        removed[i] += area
                        tile += 1
                        continue
                    pieces = _split_segments(nodes, node, end, a0, a1, floor, top, segments)
                    count = 0
                    before = 0.0
                    if pieces > 0:
                        if cells[cell, _STATE] == FULL:
                            last = len(out) - 1
                            out[last, 0], out[last, 1], out[last, 2], out[last, 3] = c0, top, c1, top
                            out[last, 4] = 1.0
                            before = (c1 - c0) * (top - floor)
                            count = _cut_edges(out, last, 1, segments, pieces, toggles_lo, toggles_hi, out[:last])
                        else:
                            begin, old = cells[cell, _START], cells[cell, _SIZE]
                            before = _cell_area(pool, begin, old, floor)
                            count = _cut_edges(pool, begin, old, segments, pieces, toggles_lo, toggles_hi, out)
                    if pieces < 0 or count < 0:
                        cursor[1] = column
                        cursor[2] = tile
                        return SCRATCH_FULL
                    if pieces > 0:
                        if apply:
                            answer = _own_page(plane, column, block, table, page, own_table, own, used, cells)
                            if answer != DONE:
                                cursor[1] = column
                                cursor[2] = tile
                                return answer
                        cell = page[table[plane, column], block] + (tile & _IN_PAGE)
                        if apply and not _store(cell, out, count, cells, pool, free):
                            cursor[1] = column
                            cursor[2] = tile
                            return POOL_FULL
                        removed[i] += before - _cell_area(out, 0, count, floor)
                    tile += 1
            cursor[2] = 0
            column += 1
        cursor[1] = 0
        cursor[0] += 1
    return DONE


@njit
def fill_plane(
    edges: FloatArray,
    alone: bool,
    grid: FloatArray,
    tiles: int,
    tables: NDArray[np.int64],
    page: NDArray[np.int64],
    own_table: NDArray[np.bool_],
    own: NDArray[np.bool_],
    used: NDArray[np.int64],
    cells: NDArray[np.int32],
    pool: FloatArray,
    free: NDArray[np.int64],
    toggles: FloatArray,
    work: FloatArray,
    out: FloatArray,
    cursor: NDArray[np.int64],
) -> int:
    """Build one plane's cells from the edges of its rings.

    Args:
        edges: shape (n, 5), all non-vertical ring edges as (u0, v0, u1, v1, sign).
        alone: no other plane will share these cells.
        tables: shape (columns,), filled: the table of each column.
        used: see `cut_planes`.
        work: shape (2 n + more, 5), scratch for the edges of one column; as ``out``.
        cursor: shape (1,): column to go on from.

    Returns:
        DONE or what ran out, as `cut_planes`.
    """
    u_low, v_low, h = grid[0], grid[1], grid[2]
    blocks = page.shape[1]
    without_edges = False
    while cursor[0] < len(tables):
        column = cursor[0]
        if used[1] >= len(page):
            return TABLES_FULL
        first = used[0]
        if first + blocks * PAGE_TILES > len(cells):
            return CELLS_FULL
        c0 = u_low + column * h
        c1 = u_low + (column + 1) * h
        if without_edges and _go_on(edges, u_low + (column - 1) * h, c1):
            tables[column] = tables[column - 1]
            own_table[tables[column]] = False
            cursor[0] += 1
            continue
        n = 0
        for e in range(len(edges)):
            a, b = max(c0, edges[e, 0]), min(c1, edges[e, 2])
            if b > a:
                if n >= len(work):
                    return SCRATCH_FULL
                n = _emit(work, n, a, b, edges[e, 0], edges[e, 1], edges[e, 2], edges[e, 3], edges[e, 4])
        repeats = False
        for tile in range(tiles):
            floor, top = v_low + tile * h, v_low + (tile + 1) * h
            lowest = math.inf
            for e in range(n):
                lowest = min(lowest, work[e, 1], work[e, 3])
            if repeats and lowest > top:
                cells[first + tile, _STATE] = cells[first + tile - 1, _STATE]
                cells[first + tile, _SIZE] = 0
                continue
            count = 0
            rest = 0
            n_toggles = 0
            for e in range(n):
                if count + 2 >= len(out) or n_toggles + 2 >= len(toggles):
                    return SCRATCH_FULL
                u0, v0, u1, v1, sign = work[e, 0], work[e, 1], work[e, 2], work[e, 3], work[e, 4]
                above0 = v0 > top
                above1 = v1 > top
                u = u1 if above0 == above1 else _crossing(u0, u1, v0 - top, v1 - top)
                if above0:
                    toggles[n_toggles], toggles[n_toggles + 1] = u0, u
                    n_toggles += 2
                elif above1:
                    toggles[n_toggles], toggles[n_toggles + 1] = u, u1
                    n_toggles += 2
                if above0 != above1:
                    low0, low1, high0, high1 = (u, u1, u0, u) if above0 else (u0, u, u, u1)
                    count = _emit(out, count, low0, low1, u0, v0, u1, v1, sign)
                    rest = _emit(work, rest, high0, high1, u0, v0, u1, v1, sign)
                elif above0:
                    rest = _emit(work, rest, u0, u1, u0, v0, u1, v1, sign)
                elif v0 > floor or v1 > floor:  # an edge on the floor lies above no point of the cell
                    count = _emit(out, count, u0, u1, u0, v0, u1, v1, sign)
            toggles[:n_toggles].sort()
            for t in range(0, n_toggles, 2):
                if count >= len(out):
                    return SCRATCH_FULL
                count = _emit(out, count, toggles[t], toggles[t + 1], c0, top, c1, top, 1.0)
            # with all edges above, the next tile is like this one if this one is all material or none
            repeats = rest == n
            n = rest
            cell = first + tile
            closed = _spans_top(out, count, c0, c1, top)
            repeats = repeats and (closed or count == 0)
            if closed:
                cells[cell, _STATE] = FULL
                cells[cell, _SIZE] = 0
            elif not _store(cell, out, count, cells, pool, free):
                return POOL_FULL
        t, before = used[1], page[tables[max(0, column - 1)]]
        new = column == 0
        without_edges = True
        for block in range(blocks):
            at, most = first + block * PAGE_TILES, min(PAGE_TILES, tiles - block * PAGE_TILES)
            plain = PARTIAL not in cells[at : at + most, _STATE]
            own[t, block] = alone and not plain
            without_edges = without_edges and plain
            if (
                plain
                and column > 0
                and np.array_equal(cells[at : at + most, _STATE], cells[before[block] : before[block] + most, _STATE])
            ):
                page[t, block] = before[block]
            else:
                page[t, block] = _move_page(at, used, cells)
                new = True
        tables[column] = t if new else tables[column - 1]
        own_table[tables[column]] = alone and new
        used[1] += new
        cursor[0] += 1
    return DONE


@njit
def _go_on(edges: FloatArray, begin: float, end: float) -> bool:
    """Whether all edges between two u run level from the one to the other."""
    for e in range(len(edges)):
        if edges[e, 0] < end and edges[e, 2] > begin:
            if edges[e, 0] > begin or edges[e, 2] < end or edges[e, 1] != edges[e, 3]:
                return False
    return True


@njit
def _move_page(at: int, used: NDArray[np.int64], cells: NDArray[np.int32]) -> int:
    """Move a page down to the first cells that are not in use; returns where it is then."""
    to = used[0]
    for tile in range(PAGE_TILES if to < at else 0):
        for column in range(_ROOM + 1):
            cells[to + tile, column] = cells[at + tile, column]
        cells[at + tile, _ROOM] = 0
    used[0] = to + PAGE_TILES
    return to


@njit
def _spans_top(edges: FloatArray, count: int, c0: float, c1: float, top: float) -> bool:
    """Whether a cell's edges are nothing but a closing edge over its whole width."""
    covered = 0.0
    for e in range(count):
        if edges[e, 1] != top or edges[e, 3] != top or edges[e, 4] < 0.0:
            return False
        covered += edges[e, 2] - edges[e, 0]
    return count > 0 and covered >= (c1 - c0) * (1.0 - 1e-12)


@njit
def _odd_above(u: float, v: float, begin: int, end: int, pool: FloatArray) -> bool:
    """Whether an odd number of a cell's edges lies above a point."""
    inside = False
    for e in range(begin, end):
        if pool[e, 0] <= u < pool[e, 2]:
            if _line(u, pool[e, 0], pool[e, 1], pool[e, 2], pool[e, 3]) > v:
                inside = not inside
    return inside


@njit
def contains(
    points: FloatArray,
    normal_axis: int,
    u_axis: int,
    v_axis: int,
    low: float,
    pitch: float,
    grid: FloatArray,
    tiles: int,
    table: NDArray[np.int64],
    page: NDArray[np.int64],
    cells: NDArray[np.int32],
    pool: FloatArray,
    votes: NDArray[np.int8],
    needed_low: int,
    needed_high: int,
) -> None:
    """Add one vote to each point that lies in material on the nearest plane of a family.

    Points whose votes are below ``needed_low`` or above ``needed_high`` already are left alone: their case is settled.
    """
    planes, columns = table.shape
    u_low, v_low, h = grid[0], grid[1], grid[2]
    for i in range(len(points)):
        if votes[i] < needed_low or votes[i] > needed_high:
            continue
        k = int(math.floor((points[i, normal_axis] - low) / pitch))
        u, v = points[i, u_axis], points[i, v_axis]
        column = int(math.floor((u - u_low) / h))
        tile = int(math.floor((v - v_low) / h))
        if k < 0 or k >= planes or column < 0 or column >= columns or tile < 0 or tile >= tiles:
            continue
        if table[k, column] == 0:
            continue
        cell = page[table[k, column], tile >> PAGE_BITS] + (tile & _IN_PAGE)
        kind, begin, end = cells[cell, _STATE], cells[cell, _START], cells[cell, _START] + cells[cell, _SIZE]
        if kind == FULL or (kind == PARTIAL and _odd_above(u, v, begin, end, pool)):
            votes[i] += 1


@njit
def plane_trapezoids(
    tables: NDArray[np.int64],
    page: NDArray[np.int64],
    grid: FloatArray,
    tiles: int,
    cells: NDArray[np.int32],
    pool: FloatArray,
    out: FloatArray,
) -> int:
    """Material of a plane, given by its columns' tables, as trapezoids with vertical sides.

    Rows are (ua, ub, bottom a, bottom b, top a, top b).

    Runs of full tiles in a column make one rectangle. Returns the number of rows, or -1 when ``out`` is too short.
    """
    n = 0
    cuts = np.empty(0)
    height = np.empty(0)
    order = np.empty(0, dtype=np.int64)
    for column in range(len(tables)):
        c0 = grid[0] + column * grid[2]
        c1 = grid[0] + (column + 1) * grid[2]
        tile = 0
        while tile < tiles:
            cell = page[tables[column], tile >> PAGE_BITS] + (tile & _IN_PAGE)
            floor = grid[1] + tile * grid[2]
            if cells[cell, _STATE] == FULL:
                while (
                    tile < tiles and cells[page[tables[column], tile >> PAGE_BITS] + (tile & _IN_PAGE), _STATE] == FULL
                ):
                    tile += 1
                if n >= len(out):
                    return -1
                top = grid[1] + tile * grid[2]
                out[n, 0], out[n, 1], out[n, 2], out[n, 3], out[n, 4], out[n, 5] = c0, c1, floor, floor, top, top
                n += 1
                continue
            if cells[cell, _STATE] == PARTIAL:
                begin, count = cells[cell, _START], cells[cell, _SIZE]
                if len(cuts) < 2 * count:
                    cuts = np.empty(4 * count)
                    height = np.empty(2 * count)
                    order = np.empty(2 * count, dtype=np.int64)
                for e in range(count):
                    cuts[2 * e], cuts[2 * e + 1] = pool[begin + e, 0], pool[begin + e, 2]
                cuts[: 2 * count].sort()
                for c in range(2 * count - 1):
                    ua, ub = cuts[c], cuts[c + 1]
                    if ub <= ua:
                        continue
                    middle = 0.5 * (ua + ub)
                    hit = 0
                    for e in range(begin, begin + count):
                        if pool[e, 0] <= middle < pool[e, 2]:
                            v = _line(middle, pool[e, 0], pool[e, 1], pool[e, 2], pool[e, 3])
                            place = hit
                            while place > 0 and height[place - 1] > v:
                                height[place] = height[place - 1]
                                order[place] = order[place - 1]
                                place -= 1
                            height[place] = v
                            order[place] = e
                            hit += 1
                    for t in range(hit - 1, -1, -2):
                        if n >= len(out):
                            return -1
                        e = order[t]
                        out[n, 0], out[n, 1] = ua, ub
                        out[n, 2], out[n, 3] = floor, floor
                        out[n, 4] = _line(ua, pool[e, 0], pool[e, 1], pool[e, 2], pool[e, 3])
                        out[n, 5] = _line(ub, pool[e, 0], pool[e, 1], pool[e, 2], pool[e, 3])
                        if t > 0:
                            e = order[t - 1]
                            out[n, 2] = _line(ua, pool[e, 0], pool[e, 1], pool[e, 2], pool[e, 3])
                            out[n, 3] = _line(ub, pool[e, 0], pool[e, 1], pool[e, 2], pool[e, 3])
                        n += 1
            tile += 1
    return n
