"""The line that a tool's reference point follows over a plane section of an inflated part."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from twin.arrays import FloatArray
from twin.cam import envelope_kernels as kernels
from twin.geometry.region import Region


def upper_envelope(region: Region, low_mm: float, high_mm: float, floor_mm: float) -> FloatArray:
    """The highest boundary of a section over a range of u; undercuts lie below it.

    Args:
        region: material in (u, v).
        low_mm, high_mm: range of u, low below high.
        floor_mm: least v, also where there is no material.

    Returns:
        shape (n >= 2, 2), u from low to high; where the section has a vertical wall two points have one u.
    """
    edges = _upper_edges(region)
    edges = edges[(edges[:, 2] > low_mm) & (edges[:, 0] < high_mm)]
    ends = edges[:, (0, 2)].ravel()
    at = np.unique(np.concatenate(([low_mm, high_mm], ends[(ends > low_mm) & (ends < high_mm)])))
    points = np.empty((3 * len(at), 2))
    count = kernels.envelope(edges, at, floor_mm, np.empty(len(edges), dtype=np.int64), points)
    line: FloatArray = points[:count].copy()
    return line


def _upper_edges(region: Region) -> FloatArray:
    """Edges with material below, turned to increasing u, by increasing u, shape (m, 4)."""
    if region.empty:
        return np.empty((0, 4))
    edges = np.concatenate([np.hstack((np.roll(ring, -1, axis=0), ring)) for ring in region.rings])
    upper = edges[edges[:, 0] < edges[:, 2]]
    return np.ascontiguousarray(upper[np.argsort(upper[:, 0], kind="stable")])


def below(points_mm: FloatArray, top_mm: float) -> list[FloatArray]:
    """The runs of a polyline that lie below a height, with points where it crosses the height.

    Args:
        points_mm: shape (n, d), height last.

    Returns:
        runs of two points at least, in the polyline's order.
    """
    under = points_mm[:, -1] < top_mm
    if under.all():
        return [points_mm]
    if not under.any():
        return []
    runs: list[FloatArray] = []
    changes = np.flatnonzero(np.diff(under.astype(np.int8)))
    bounds = [-1, *changes.tolist(), len(points_mm) - 1]
    for first, last in pairwise(bounds):
        if not under[first + 1]:
            continue
        run = points_mm[first + 1 : last + 1]
        before = [_crossing(points_mm[first], points_mm[first + 1], top_mm)] if first >= 0 else []
        after = [_crossing(points_mm[last], points_mm[last + 1], top_mm)] if last + 1 < len(points_mm) else []
        line = np.concatenate([*before, run, *after])
        line = line[np.concatenate(([True], np.any(np.diff(line, axis=0) != 0.0, axis=1)))]
        if len(line) > 1:
            runs.append(line)
    return runs


def _crossing(a: FloatArray, b: FloatArray, top_mm: float) -> FloatArray:
    """Where a straight piece meets the height, shape (1, d)."""
    part = (top_mm - a[-1]) / (b[-1] - a[-1])
    point: FloatArray = (a + part * (b - a))[None, :]
    return point
