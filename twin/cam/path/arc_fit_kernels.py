"""Polylines to the fewest lines and arcs within a tolerance, greedily: from each point the longest piece that fits.

A piece runs through its own two ends. How far it may lie from the polyline has two bounds, one for each side. A longest
piece is found by doubling its number of points until it does not fit and halving after that.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import helper, njit


class Limits(NamedTuple):
    """Limits of a piece.

    Attributes:
        left, right: how far it may lie to the left and right of the polyline as seen along it, mm.
        least_radius, most_radius: of arcs, mm.
    """

    left: float
    right: float
    least_radius: float
    most_radius: float


@helper
def _line_fits(points: FloatArray, i: int, j: int, limits: Limits) -> bool:
    """Whether the chord from point i to j lies within the limits on both sides of the points between."""
    left, right = limits.left, limits.right
    ux, uy = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
    length = math.hypot(ux, uy)
    if length == 0.0:
        return False
    ux /= length
    uy /= length
    slack = min(left, right)
    before = 0.0
    for k in range(i + 1, j):
        dx, dy = points[k, 0] - points[i, 0], points[k, 1] - points[i, 1]
        aside = ux * dy - uy * dx
        along = ux * dx + uy * dy
        if aside > right or -aside > left or along < before - slack or along > length + slack:
            return False
        before = max(before, along)
    return True


@helper
def _arc_through(points: FloatArray, i: int, j: int, arc: FloatArray) -> bool:
    """The circle through points i and j that is nearest to those between; False without one.

    Args:
        arc: filled with centre x, y, radius, signed sweep.
    """
    mx, my = 0.5 * (points[i, 0] + points[j, 0]), 0.5 * (points[i, 1] + points[j, 1])
    hx, hy = points[j, 0] - mx, points[j, 1] - my
    half2 = hx * hx + hy * hy
    half = math.sqrt(half2)
    if half == 0.0:
        return False
    nx, ny = -hy / half, hx / half
    ab = bb = 0.0
    for k in range(i + 1, j):
        dx, dy = points[k, 0] - mx, points[k, 1] - my
        a = dx * dx + dy * dy - half2
        b = 2.0 * (dx * nx + dy * ny)
        ab += a * b
        bb += b * b
    if bb == 0.0:
        return False
    t = ab / bb
    arc[0], arc[1] = mx + t * nx, my + t * ny
    arc[2] = math.hypot(half, t)
    # the points between lie beyond the chord as seen from the centre, or the arc is more than half a turn
    side = 0.0
    for k in range(i + 1, j):
        side += (points[k, 0] - mx) * nx + (points[k, 1] - my) * ny
    sweep = 2.0 * math.atan2(half, abs(t))
    if side * t > 0.0:
        return False
    arc[3] = sweep if t > 0.0 else -sweep
    return True


@helper
def _arc_fits(
    points: FloatArray,
    i: int,
    j: int,
    limits: Limits,
    arc: FloatArray,
) -> bool:
    """Whether an arc from point i to j lies within the limits; fills in it."""
    if not _arc_through(points, i, j, arc):
        return False
    cx, cy, radius, sweep = arc[0], arc[1], arc[2], arc[3]
    if radius < limits.least_radius or radius > limits.most_radius:
        return False
    turn = 1.0 if sweep > 0.0 else -1.0
    # to the left of a counter-clockwise arc is its inside
    outer, inner = (limits.left, limits.right) if turn > 0.0 else (limits.right, limits.left)
    px, py = points[i, 0] - cx, points[i, 1] - cy
    for k in range(i + 1, j + 1):
        qx, qy = points[k, 0] - cx, points[k, 1] - cy
        if turn * (px * qy - py * qx) <= 0.0:
            return False
        ex, ey = qx - px, qy - py
        along = -(px * ex + py * ey) / (ex * ex + ey * ey)
        if 0.0 < along < 1.0:
            near = math.hypot(px + along * ex, py + along * ey)
            if radius - near > inner or near - radius > outer:
                return False
        far = math.hypot(qx, qy)
        if far - radius > outer or radius - far > inner:
            return False
        px, py = qx, qy
    return True


@helper
def _longest_line(points: FloatArray, i: int, limits: Limits) -> int:
    """The last point of the longest chord from point i that fits."""
    n, end, step = len(points), i + 1, 2
    while i + step < n and _line_fits(points, i, i + step, limits):
        end = i + step
        step *= 2
    bad = min(i + step, n)
    while bad - end > 1:
        middle = (bad + end) // 2
        if _line_fits(points, i, middle, limits):
            end = middle
        else:
            bad = middle
    return end


@helper
def _copy(arc: FloatArray, best: FloatArray) -> None:
    """Copy an arc's numbers; an assignment of arrays takes seconds to compile."""
    for k in range(len(arc)):
        best[k] = arc[k]


@helper
def _longest_arc(points: FloatArray, i: int, limits: Limits, arc: FloatArray, best: FloatArray) -> int:
    """The last point of the longest arc from point i that fits, i without one; fills in the arc.

    Args:
        arc: work array, shape (4,).
        best: filled with centre x, y, radius, signed sweep.
    """
    n, end, step = len(points), i, 3
    while i + step < n and _arc_fits(points, i, i + step, limits, arc):
        end = i + step
        _copy(arc, best)
        step *= 2
    bad = min(i + step, n)
    while end > i and bad - end > 1:
        middle = (bad + end) // 2
        if _arc_fits(points, i, middle, limits, arc):
            end = middle
            _copy(arc, best)
        else:
            bad = middle
    return end


@njit
def fit_plane(points: FloatArray, limits: Limits, arcs: bool, ends: NDArray[np.int64], fitted: FloatArray) -> int:
    """Fit pieces to a polyline in a plane.

    Args:
        points: shape (n, 2), no two neighbours equal.
        arcs: whether arcs may be used: where they are longer than a line by more than one point.
        ends: filled with the point at which each piece ends, shape (n - 1,).
        fitted: filled with centre, radius and sweep of each piece that is an arc, radius 0 else, shape (n - 1, 4).

    Returns:
        Number of pieces.
    """
    arc, best = np.zeros(4), np.zeros(4)
    i = pieces = 0
    while i < len(points) - 1:
        end = _longest_line(points, i, limits)
        fitted[pieces, 2] = 0.0
        if arcs:
            arc_end = _longest_arc(points, i, limits, arc, best)
            if arc_end > end + 1:
                end = arc_end
                _copy(best, fitted[pieces])
        ends[pieces] = end
        pieces += 1
        i = end
    return pieces


@helper
def _chord_fits(points: FloatArray, i: int, j: int, most: float) -> bool:
    """Whether the points between i and j lie within ``most`` of the chord and go forward along it, in space."""
    ux, uy, uz = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1], points[j, 2] - points[i, 2]
    length = math.sqrt(ux * ux + uy * uy + uz * uz)
    if length == 0.0:
        return False
    ux, uy, uz = ux / length, uy / length, uz / length
    before = 0.0
    for k in range(i + 1, j):
        dx, dy, dz = points[k, 0] - points[i, 0], points[k, 1] - points[i, 1], points[k, 2] - points[i, 2]
        along = ux * dx + uy * dy + uz * dz
        aside2 = dx * dx + dy * dy + dz * dz - along * along
        if aside2 > most * most or along < before - most or along > length + most:
            return False
        before = max(before, along)
    return True


@njit
def thin_space(points: FloatArray, most: float, ends: NDArray[np.int64]) -> int:
    """Fit chords to a polyline in space; arguments and result as those of `fit_plane`."""
    n = len(points)
    i = pieces = 0
    while i < n - 1:
        end = i + 1
        step = 2
        while i + step < n and _chord_fits(points, i, i + step, most):
            end = i + step
            step *= 2
        bad = min(i + step, n)
        while bad - end > 1:
            middle = (bad + end) // 2
            if _chord_fits(points, i, middle, most):
                end = middle
            else:
                bad = middle
        ends[pieces] = end
        pieces += 1
        i = end
    return pieces
