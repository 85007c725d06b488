"""Edges of cells; compiled.

An edge is a row (u0, v0, u1, v1, sign) of an array, u0 < u1, sign +1 where material lies below it and -1 where it lies
above; vertical edges are implied.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from twin.arrays import FloatArray
from twin.jit import helper, njit

#: Numbers in an edge's row.
EDGE_COLUMNS = 5


class Edge(NamedTuple):
    """An edge from (u0, v0) to (u1, v1), u0 < u1; sign +1 where material lies below it, -1 where it lies above."""

    u0: float
    v0: float
    u1: float
    v1: float
    sign: float


@helper
def edge_of(edges: FloatArray, e: int) -> Edge:
    """The edge in a row of an array."""
    return Edge(edges[e, 0], edges[e, 1], edges[e, 2], edges[e, 3], edges[e, 4])


@helper
def put_edge(edges: FloatArray, e: int, edge: Edge) -> None:
    """Write an edge to a row of an array."""
    edges[e, 0], edges[e, 1], edges[e, 2], edges[e, 3], edges[e, 4] = edge.u0, edge.v0, edge.u1, edge.v1, edge.sign


@helper
def line_v(u: float, ua: float, va: float, ub: float, vb: float) -> float:
    """The v at u on the straight line through two points, exact at both."""
    if u == ua:
        return va
    if u == ub:
        return vb
    return va + (vb - va) * ((u - ua) / (ub - ua))


@helper
def v_on(edge: Edge, u: float) -> float:
    """The v at u on an edge, exact at its ends."""
    return line_v(u, edge.u0, edge.v0, edge.u1, edge.v1)


@helper
def part_of(edge: Edge, ua: float, ub: float) -> Edge:
    """The part of an edge between two u."""
    return Edge(ua, v_on(edge, ua), ub, v_on(edge, ub), edge.sign)


@helper
def emit(out: FloatArray, count: int, edge: Edge) -> int:
    """Append an edge, but none without length; returns the number of edges. The caller has made sure of room."""
    if edge.u1 > edge.u0:
        put_edge(out, count, edge)
        count += 1
    return count


@njit
def crossing(a: float, b: float, da: float, db: float) -> float:
    """Where a linear difference, da at a and db at b, of opposite signs, is 0; in [a, b]."""
    u = a + (b - a) * (da / (da - db))
    return min(max(u, a), b)


@helper
def area_above(edges: FloatArray, begin: int | np.int64, count: int | np.int64, floor: float) -> float:
    """Area of material that a cell's edges bound, above the cell's floor."""
    area = 0.0
    for e in range(begin, begin + count):
        edge = edge_of(edges, e)
        area += edge.sign * (0.5 * (edge.v0 + edge.v1) - floor) * (edge.u1 - edge.u0)
    return area
