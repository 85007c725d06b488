"""Stretches of a polyline below a height."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from twin.arrays import FloatArray


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
