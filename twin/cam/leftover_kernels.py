"""Distances of points from a part that is known by sections; compiled."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from twin.arrays import FloatArray


@njit(cache=True, nogil=True)
def _to_edge(u: float, v: float, edge: FloatArray) -> float:
    """Squared distance of a point from an edge."""
    du, dv = edge[2] - edge[0], edge[3] - edge[1]
    size = du * du + dv * dv
    t = 0.0 if size == 0.0 else ((u - edge[0]) * du + (v - edge[1]) * dv) / size
    t = min(1.0, max(0.0, t))
    return (edge[0] + t * du - u) ** 2 + (edge[1] + t * dv - v) ** 2


@njit(cache=True, nogil=True)
def _inside(u: float, v: float, edges: FloatArray) -> bool:
    """Whether a point lies in a section, by even-odd filling."""
    odd = False
    for i in range(len(edges)):
        if (edges[i, 0] <= u) != (edges[i, 2] <= u):
            at = edges[i, 1] + (u - edges[i, 0]) / (edges[i, 2] - edges[i, 0]) * (edges[i, 3] - edges[i, 1])
            odd ^= at > v
    return odd


@njit(cache=True, nogil=True)
def distances(
    points: FloatArray,
    planes: FloatArray,
    edges: FloatArray,
    begins: NDArray[np.int64],
    positions: FloatArray,
    found: FloatArray,
) -> None:
    """Distance of every point from the nearest section's material.

    Sections are asked in the order of their distance, until they are farther than what is known.

    Args:
        points: shape (n, 2), in the planes.
        planes: shape (n,), the plane of each point.
        edges: shape (m, 4), the sections' edges.
        begins: where each section's edges begin, and the end.
        positions: where the sections lie, increasing.
        found: shape (n,), filled.
    """
    for i in range(len(points)):
        u, v = points[i, 0], points[i, 1]
        best = math.inf
        up = np.searchsorted(positions, planes[i])
        down = up - 1
        while True:
            above = positions[up] - planes[i] if up < len(positions) else math.inf
            below = planes[i] - positions[down] if down >= 0 else math.inf
            d2 = min(above, below) ** 2
            if d2 >= best:
                break
            k = up if above < below else down
            if above < below:
                up += 1
            else:
                down -= 1
            mine = edges[begins[k] : begins[k + 1]]
            if len(mine) and _inside(u, v, mine):
                best = d2
                continue
            for e in range(len(mine)):
                best = min(best, d2 + _to_edge(u, v, mine[e]))
        found[i] = math.sqrt(best)
