"""Speeds along a chain of blocks under one acceleration, and the time each block takes; compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import helper, njit


class Chain(NamedTuple):
    """Blocks of a chain, n of them.

    Attributes:
        length: mm.
        into, out: unit directions at each block's start and end, shape (n, 3).
        radius: mm, inf for a straight block.
        speed: mm/s.
        acceleration: mm/s2.
        stop: whether a block begins and ends at rest.
    """

    length: FloatArray
    into: FloatArray
    out: FloatArray
    radius: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    stop: NDArray[np.bool_]


@njit
def corner_speeds(chain: Chain, deviation: float, corner: FloatArray) -> None:
    """Largest speed between each two blocks, and at both ends of the chain, where it is 0.

    Args:
        deviation: how far a corner may be rounded off, mm.
        corner: shape (n + 1,), filled.
    """
    length, into, out, radius, speed, acceleration, stop = chain
    n = len(length)
    corner[0] = corner[n] = 0.0
    for k in range(1, n):
        if stop[k - 1] or stop[k]:
            corner[k] = 0.0
            continue
        cosine = out[k - 1, 0] * into[k, 0] + out[k - 1, 1] * into[k, 1] + out[k - 1, 2] * into[k, 2]
        chord = math.inf
        if radius[k - 1] == math.inf:
            chord = length[k - 1]
        if radius[k] == math.inf:
            chord = min(chord, length[k])
        a = min(acceleration[k - 1], acceleration[k])
        corner[k] = min(speed[k - 1], speed[k], _corner_speed(cosine, chord, a, deviation))


@helper
def _corner_speed(cosine: float, chord: float, a: float, deviation: float) -> float:
    """Speed at which a corner can be passed.

    It is rounded by an arc that stays within the allowed deviation d of it (junction deviation): with the angle t
    between the blocks, v^2 = a d sin(t/2) / (1 - sin(t/2)). Short chords of a curve are taken as parts of the circle
    that touches both: v^2 = a r with r = l / (2 tan(turn / 2)).

    Args:
        cosine: of the turn; the angle between the blocks is pi less the turn.
        chord: length l of the shorter straight block, inf between arcs.
    """
    half = math.sqrt(max(0.0, 0.5 * (1.0 + cosine)))  # sin(t / 2) = cos(turn / 2)
    if half >= 1.0 - 1e-14:
        return math.inf
    most = math.sqrt(a * deviation * half / (1.0 - half))
    if chord < math.inf:
        tangent = math.sqrt(max(1e-300, 1.0 - half * half)) / max(half, 1e-300)
        most = min(most, math.sqrt(a * max(0.5 * chord / tangent, deviation)))
    return most


@njit
def block_times(chain: Chain, corner: FloatArray, times: FloatArray) -> None:
    """Time of each block: corner speeds are lowered to what the acceleration allows, backwards and forwards.

    Then each block has a trapezoid or triangle of speed over time. ``corner`` is changed.
    """
    length, _, _, _, speed, acceleration, _ = chain
    n = len(length)
    for k in range(n - 1, -1, -1):
        corner[k] = min(corner[k], math.sqrt(corner[k + 1] ** 2 + 2.0 * acceleration[k] * length[k]))
    for k in range(n):
        corner[k + 1] = min(corner[k + 1], math.sqrt(corner[k] ** 2 + 2.0 * acceleration[k] * length[k]))
    for k in range(n):
        times[k] = _block_time(length[k], speed[k], acceleration[k], corner[k], corner[k + 1])


@helper
def _block_time(length: float, speed: float, a: float, v0: float, v1: float) -> float:
    """Time over a length that begins at speed v0 and ends at v1, with acceleration a, at most at a speed."""
    peak = min(speed, math.sqrt(0.5 * (v0 * v0 + v1 * v1) + a * length))
    peak = max(peak, v0, v1)
    ramps = (2.0 * peak * peak - v0 * v0 - v1 * v1) / (2.0 * a)
    time = (2.0 * peak - v0 - v1) / a
    if peak > 0.0:
        time += max(0.0, length - ramps) / peak
    return time


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
