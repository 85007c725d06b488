"""Strips over one column and one tile of a plane; compiled.

A strip is lo(u) <= v <= hi(u) between nodes, rows (u, lo, hi); see `twin.geometry.column_cells.strips.Strips`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells.edge_kernels import Edge, crossing, line_v
from twin.geometry.column_cells.store_kernels import Grid
from twin.jit import helper, njit

#: Columns of the array of nodes.
U, LO, HI = 0, 1, 2
#: Columns of the array of segments: the range of u, lo and hi at its ends, and whether they lie inside the tile.
UA, UB, LO_A, LO_B, HI_A, HI_B, LO_INSIDE, HI_INSIDE = range(8)


class Tile(NamedTuple):
    """A cell on its plane: u from ``c0`` to ``c1``, v from ``floor`` to ``top``, mm."""

    c0: float
    c1: float
    floor: float
    top: float


class StripPart(NamedTuple):
    """The part of a strip over one column.

    Attributes:
        a0, a1: range of u.
        spans: whether that is the column's whole width.
        first, last: nodes from at or before a0 to at or after a1.
        first_tile, last_tile: tiles that the strip meets; none, last before first, where it cuts nothing new.
        lo_max, hi_min: highest lo and lowest hi.
    """

    a0: float
    a1: float
    spans: bool
    first: int
    last: int
    first_tile: int
    last_tile: int
    lo_max: float
    hi_min: float


class Segment(NamedTuple):
    """A piece of a strip with straight lo and hi over the range [ua, ub].

    Attributes:
        lo_inside, hi_inside: whether lo and hi lie inside the tile.
    """

    ua: float
    ub: float
    lo_a: float
    lo_b: float
    hi_a: float
    hi_b: float
    lo_inside: bool
    hi_inside: bool


@helper
def _between(nodes: FloatArray, k: int, column: int, u: float) -> float:
    """The lo or hi, by its column, at u between the nodes k and k + 1."""
    return line_v(u, nodes[k, U], nodes[k, column], nodes[k + 1, U], nodes[k + 1, column])


@helper
def tile_of(grid: Grid, column: int, tile: int) -> Tile:
    """The box of a cell."""
    c0, c1 = grid.u_low + column * grid.size, grid.u_low + (column + 1) * grid.size
    return Tile(c0, c1, grid.v_low + tile * grid.size, grid.v_low + (tile + 1) * grid.size)


@helper
def strip_part(nodes: FloatArray, fresh: NDArray[np.bool_], first: int, end: int, grid: Grid, column: int) -> StripPart:
    """The part of a strip over one column that it meets.

    Args:
        first, end: the strip's nodes, ``first`` at or before the column's.
    """
    c0, c1 = grid.u_low + column * grid.size, grid.u_low + (column + 1) * grid.size
    a0, a1 = max(c0, nodes[first, U]), min(c1, nodes[end, U])
    if not a1 > a0:
        return StripPart(a0, a1, False, first, first, 0, -1, math.inf, -math.inf)
    while first < end - 1 and nodes[first + 1, U] <= a0:
        first += 1
    lo, hi = _between(nodes, first, LO, a0), _between(nodes, first, HI, a0)
    lo_min, lo_max, hi_min, hi_max = lo, lo, hi, hi
    last = first
    new = fresh[first]
    while last < end:
        last += 1
        u = min(a1, nodes[last, U])
        lo, hi = _between(nodes, last - 1, LO, u), _between(nodes, last - 1, HI, u)
        lo_min, lo_max = min(lo_min, lo), max(lo_max, lo)
        hi_min, hi_max = min(hi_min, hi), max(hi_max, hi)
        new = new or fresh[last]
        if nodes[last, U] >= a1:
            break
    first_tile = max(0, int(math.floor((lo_min - grid.v_low) / grid.size)))
    last_tile = min(grid.tiles - 1, int(math.floor((hi_max - grid.v_low) / grid.size))) if new else -1
    return StripPart(a0, a1, a0 == c0 and a1 == c1, first, last, first_tile, last_tile, lo_max, hi_min)


@njit
def covers(part: StripPart, tile: Tile) -> bool:
    """Whether the strip takes the whole of a tile."""
    return part.spans and part.lo_max <= tile.floor and part.hi_min >= tile.top


@helper
def _segment(nodes: FloatArray, k: int, ua: float, ub: float, tile: Tile) -> Segment:
    """The strip over [ua, ub], between the nodes k and k + 1."""
    lo_a, lo_b = _between(nodes, k, LO, ua), _between(nodes, k, LO, ub)
    hi_a, hi_b = _between(nodes, k, HI, ua), _between(nodes, k, HI, ub)
    return Segment(ua, ub, lo_a, lo_b, hi_a, hi_b, lo_a > tile.floor, hi_a < tile.top)


@helper
def _crosses(whole: Segment, level: float) -> bool:
    """Whether lo or hi crosses a level."""
    return (whole.lo_a > level) != (whole.lo_b > level) or (whole.hi_a > level) != (whole.hi_b > level)


@helper
def _level_crossings(whole: Segment, floor: float, top: float, cuts: FloatArray) -> int:
    """Fill the ends of a segment and the u at which lo or hi cross floor or top; returns how many, less 1."""
    n = 1
    cuts[0] = whole.ua
    for level in (floor, top):
        if (whole.lo_a > level) != (whole.lo_b > level):
            cuts[n] = crossing(whole.ua, whole.ub, whole.lo_a - level, whole.lo_b - level)
            n += 1
        if (whole.hi_a > level) != (whole.hi_b > level):
            cuts[n] = crossing(whole.ua, whole.ub, whole.hi_a - level, whole.hi_b - level)
            n += 1
    cuts[n] = whole.ub
    cuts[: n + 1].sort()
    return n


@helper
def _part(whole: Segment, pa: float, pb: float, lo_m: float, hi_m: float, tile: Tile) -> Segment:
    """The part [pa, pb] of a segment, with lo_m and hi_m in its middle."""
    lo_a, lo_b = _lo_on(whole, pa), _lo_on(whole, pb)
    return Segment(pa, pb, lo_a, lo_b, _hi_on(whole, pa), _hi_on(whole, pb), lo_m > tile.floor, hi_m < tile.top)


@helper
def _lo_on(whole: Segment, u: float) -> float:
    return line_v(u, whole.ua, whole.lo_a, whole.ub, whole.lo_b)


@helper
def _hi_on(whole: Segment, u: float) -> float:
    return line_v(u, whole.ua, whole.hi_a, whole.ub, whole.hi_b)


@helper
def split_segments(nodes: FloatArray, part: StripPart, tile: Tile, segments: FloatArray) -> int:
    """A strip over one column as linear segments that cross neither the floor nor the top of a tile.

    Rows of ``segments``: see `UA` and the names after it. Segments that miss the tile are omitted.

    Returns:
        The number of rows, or -1 when they do not fit.
    """
    count = 0
    cuts = np.empty(6)
    for k in range(part.first, part.last):
        ua = max(part.a0, nodes[k, U])
        ub = min(part.a1, nodes[k + 1, U])
        if ub <= ua:
            continue
        whole = _segment(nodes, k, ua, ub, tile)
        if min(whole.lo_a, whole.lo_b) >= tile.top or max(whole.hi_a, whole.hi_b) <= tile.floor:
            continue
        n = 1
        cuts[0], cuts[1] = ua, ub
        if _crosses(whole, tile.floor) or _crosses(whole, tile.top):
            n = _level_crossings(whole, tile.floor, tile.top, cuts)
        for i in range(n):
            pa, pb = cuts[i], cuts[i + 1]
            if pb <= pa:
                continue
            if count >= len(segments):
                return -1
            middle = 0.5 * (pa + pb)
            lo_m, hi_m = _lo_on(whole, middle), _hi_on(whole, middle)
            if lo_m < tile.top and hi_m > tile.floor:
                _put_segment(segments, count, _part(whole, pa, pb, lo_m, hi_m, tile))
                count += 1
    return count


@helper
def _put_segment(segments: FloatArray, m: int, segment: Segment) -> None:
    """Write a segment to a row."""
    segments[m, UA], segments[m, UB] = segment.ua, segment.ub
    segments[m, LO_A], segments[m, LO_B] = segment.lo_a, segment.lo_b
    segments[m, HI_A], segments[m, HI_B] = segment.hi_a, segment.hi_b
    segments[m, LO_INSIDE] = 1.0 if segment.lo_inside else 0.0
    segments[m, HI_INSIDE] = 1.0 if segment.hi_inside else 0.0


@helper
def lo_of(segments: FloatArray, m: int) -> Edge:
    """The lo of a segment, as an edge with material below it."""
    return Edge(segments[m, UA], segments[m, LO_A], segments[m, UB], segments[m, LO_B], 1.0)


@helper
def hi_of(segments: FloatArray, m: int) -> Edge:
    """The hi of a segment, as an edge with material above it."""
    return Edge(segments[m, UA], segments[m, HI_A], segments[m, UB], segments[m, HI_B], -1.0)
