"""Fewer edges for a cell that has many; compiled.

Motions that nearly retrace others leave chains of tiny edges, where one surface lies within a chord's deviation above
or below another. Edges of a chain are merged while all the points between them stay near the edge that replaces them.
Both ends of every chain, and closing edges, stay exactly as they are.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from twin.arrays import FloatArray
from twin.geometry.column_cells.edge_kernels import EDGE_COLUMNS, Edge, edge_of, put_edge
from twin.jit import helper, njit

#: A cell with more edges than this gets fewer, where it can.
MANY_EDGES = 48
_SIGN = 4


class _Cone(NamedTuple):
    """Directions in which a line through a point is near to others.

    Attributes:
        low, high: angles to the u axis, rad.
    """

    low: float
    high: float


@njit
def thinned(edges: FloatArray, count: int, top: float, merge_mm: float) -> int:
    """Merge edges of a cell in place.

    Args:
        edges, count: the cell's edges, in any order.
        top: of the cell, where its closing edges lie.
        merge_mm: how far from an edge the ends of the edges may be that it replaces.

    Returns:
        The number of edges then.
    """
    _sort(edges, count)
    kept = 0
    for e in range(count):
        if edges[e, _SIGN] == 0.0:
            continue
        whole = edge_of(edges, e)
        closing = _is_closing(whole, top)
        cone = _Cone(-math.pi, math.pi)
        after = _next_of(edges, e + 1, count, whole, merge_mm)
        while after >= 0:
            part = edge_of(edges, after)
            if _is_closing(part, top) != closing:
                break
            cone = _narrowed(_narrowed(cone, whole, whole.u1, whole.v1, merge_mm), whole, part.u0, part.v0, merge_mm)
            angle = math.atan2(part.v1 - whole.v0, part.u1 - whole.u0)
            if not cone.low <= angle <= cone.high:
                break
            whole = Edge(whole.u0, whole.v0, part.u1, part.v1, whole.sign)
            edges[after, _SIGN] = 0.0
            after = _next_of(edges, after + 1, count, whole, merge_mm)
        put_edge(edges, kept, whole)
        kept += 1
    return kept


@helper
def _is_closing(edge: Edge, top: float) -> bool:
    """Whether an edge closes a cell at its top."""
    return edge.v0 == top and edge.v1 == top


@helper
def _sort(edges: FloatArray, count: int) -> None:
    """Sort edges by their first u, in place; most are in order."""
    for e in range(1, count):
        edge = edge_of(edges, e)
        at = e
        while at > 0 and edges[at - 1, 0] > edge.u0:
            for c in range(EDGE_COLUMNS):
                edges[at, c] = edges[at - 1, c]
            at -= 1
        if at < e:
            put_edge(edges, at, edge)


@helper
def _next_of(edges: FloatArray, first: int, count: int, whole: Edge, merge_mm: float) -> int:
    """The edge that goes on where another ends, at most ``merge_mm`` above or below; -1 where there is none."""
    best, found = merge_mm, -1
    for e in range(first, count):
        if edges[e, 0] > whole.u1:
            break
        if edges[e, 0] == whole.u1 and edges[e, _SIGN] == whole.sign:
            off = abs(edges[e, 1] - whole.v1)
            if off <= best:
                best, found = off, e
                if off == 0.0:
                    break
    return found


@helper
def _narrowed(cone: _Cone, whole: Edge, u: float, v: float, merge_mm: float) -> _Cone:
    """The directions of a cone from the beginning of an edge that also pass near to a point."""
    du, dv = u - whole.u0, v - whole.v0
    distance = math.hypot(du, dv)
    if distance <= merge_mm:
        return cone
    angle, half = math.atan2(dv, du), math.asin(merge_mm / distance)
    return _Cone(max(cone.low, angle - half), min(cone.high, angle + half))
