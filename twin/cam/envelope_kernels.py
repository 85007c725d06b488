"""Upper envelopes of plane sections: what a tool coming from above meets first.

The rings of a section do not cross each other, so neither do the edges that have material below them, and between two
neighbouring ends of such edges one of them is the highest all along.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from twin.arrays import FloatArray


@njit(cache=True, nogil=True)
def _height(edges: FloatArray, e: int, u: float) -> float:
    """Height v of an edge at u; its own ends are met exactly."""
    if u <= edges[e, 0]:
        return edges[e, 1]
    if u >= edges[e, 2]:
        return edges[e, 3]
    part = (u - edges[e, 0]) / (edges[e, 2] - edges[e, 0])
    return edges[e, 1] + part * (edges[e, 3] - edges[e, 1])


@njit(cache=True, nogil=True)
def _add(points: FloatArray, count: int, u: float, v: float) -> int:
    """One more point, unless it is the last one again."""
    if count and points[count - 1, 0] == u and points[count - 1, 1] == v:
        return count
    points[count, 0] = u
    points[count, 1] = v
    return count + 1


@njit(cache=True, nogil=True)
def envelope(edges: FloatArray, at: FloatArray, floor: float, active: NDArray[np.int64], points: FloatArray) -> int:
    """The highest edge over every u, and the floor where it is higher or there is none.

    Args:
        edges: shape (m, 4): u0, v0, u1, v1 with u0 < u1, by increasing u0.
        at: shape (n,): every end of an edge within the range asked for and the range's own ends, increasing.
        floor: least v.
        active: shape (m,), scratch.
        points: shape (3 n, 2), filled; where the envelope jumps there are two points with one u.

    Returns:
        Number of points.
    """
    count = held = begun = 0
    for k in range(len(at) - 1):
        a, b = at[k], at[k + 1]
        while begun < len(edges) and edges[begun, 0] <= a:
            active[held] = begun
            held += 1
            begun += 1
        kept = 0
        best = -1
        most = 0.0
        for i in range(held):
            e = active[i]
            if edges[e, 2] > a:
                active[kept] = e
                kept += 1
                v = _height(edges, e, 0.5 * (a + b))
                if best < 0 or v > most:
                    best = e
                    most = v
        held = kept
        va = vb = floor
        if best >= 0:
            va, vb = _height(edges, best, a), _height(edges, best, b)
        count = _add(points, count, a, max(va, floor))
        if (va < floor) != (vb < floor):
            count = _add(points, count, a + (b - a) * (floor - va) / (vb - va), floor)
        count = _add(points, count, b, max(vb, floor))
    return count
