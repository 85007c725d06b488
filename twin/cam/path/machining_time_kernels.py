"""Speeds along a chain of blocks under one acceleration, and the time each block takes; compiled."""

from __future__ import annotations

import math

import numpy as np

from twin.arrays import FloatArray
from twin.jit import njit


@njit
def corner_speeds(
    length: FloatArray,
    into: FloatArray,
    out: FloatArray,
    radius: FloatArray,
    speed: FloatArray,
    acceleration: FloatArray,
    stop: FloatArray,
    deviation: float,
    corner: FloatArray,
) -> None:
    """Largest speed between each two blocks, and at both ends of the chain, where it is 0.

    A corner is rounded by an arc that stands off it by the allowed deviation (junction deviation): with the angle t
    between the blocks, v^2 = a d sin(t/2) / (1 - sin(t/2)). Short chords of a curve are taken as parts of the circle
    that touches both: v^2 = a r with r = l / (2 tan(turn / 2)).

    Args:
        length, radius, speed, acceleration: of each block, shape (n,); radius inf for a straight one; mm, mm/s, mm/s2.
        into, out: unit directions at each block's start and end, shape (n, 3).
        stop: shape (n,), 1 where a block begins and ends at rest, 0 elsewhere.
        deviation: mm.
        corner: shape (n + 1,), filled.
    """
    n = len(length)
    corner[0] = corner[n] = 0.0
    for k in range(1, n):
        if stop[k - 1] > 0.0 or stop[k] > 0.0:
            corner[k] = 0.0
            continue
        cosine = out[k - 1, 0] * into[k, 0] + out[k - 1, 1] * into[k, 1] + out[k - 1, 2] * into[k, 2]
        most = min(speed[k - 1], speed[k])
        a = min(acceleration[k - 1], acceleration[k])
        # cosine of the turn; the angle between the blocks is pi less the turn
        half = math.sqrt(max(0.0, 0.5 * (1.0 + cosine)))  # sin(t / 2) = cos(turn / 2)
        if half < 1.0 - 1e-14:
            most = min(most, math.sqrt(a * deviation * half / (1.0 - half)))
            chord = math.inf
            if radius[k - 1] == math.inf:
                chord = length[k - 1]
            if radius[k] == math.inf:
                chord = min(chord, length[k])
            if chord < math.inf:
                tangent = math.sqrt(max(1e-300, 1.0 - half * half)) / max(half, 1e-300)
                most = min(most, math.sqrt(a * max(0.5 * chord / tangent, deviation)))
        corner[k] = most


@njit
def block_times(
    length: FloatArray, speed: FloatArray, acceleration: FloatArray, corner: FloatArray, times: FloatArray
) -> None:
    """Time of each block: corner speeds are lowered, backwards and forwards, to what the acceleration allows; then a
    trapezoid or a triangle for each. ``corner`` is changed.
    """
    n = len(length)
    for k in range(n - 1, -1, -1):
        corner[k] = min(corner[k], math.sqrt(corner[k + 1] ** 2 + 2.0 * acceleration[k] * length[k]))
    for k in range(n):
        corner[k + 1] = min(corner[k + 1], math.sqrt(corner[k] ** 2 + 2.0 * acceleration[k] * length[k]))
    for k in range(n):
        a, v0, v1 = acceleration[k], corner[k], corner[k + 1]
        peak = min(speed[k], math.sqrt(0.5 * (v0 * v0 + v1 * v1) + a * length[k]))
        peak = max(peak, v0, v1)
        ramps = (2.0 * peak * peak - v0 * v0 - v1 * v1) / (2.0 * a)
        times[k] = (2.0 * peak - v0 - v1) / a
        if peak > 0.0:
            times[k] += max(0.0, length[k] - ramps) / peak


@njit
def directions(points: FloatArray, length: FloatArray, direction: FloatArray) -> None:
    """Lengths and unit directions of the pieces of a polyline; a piece without length has direction 0."""
    for k in range(len(points) - 1):
        x, y, z = points[k + 1, 0] - points[k, 0], points[k + 1, 1] - points[k, 1], points[k + 1, 2] - points[k, 2]
        d = math.sqrt(x * x + y * y + z * z)
        length[k] = d
        if d > 0.0:
            direction[k, 0], direction[k, 1], direction[k, 2] = x / d, y / d, z / d
        else:
            direction[k] = np.zeros(3)
