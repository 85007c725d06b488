"""Engagement map and force sums; compiled.

The map has one row an angle about the tool axis (row j at the angle j * 2 pi / rows, counter-clockwise from +x) and one
column an edge element. Its entries are the engaged share of the element, 0 to 1. Where an element is whole in the
material at one angle and free at the next, ``turn`` tells at which part of the way between them it changes.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from twin.arrays import FloatArray

#: What `ENGAGEMENT` summary entries mean.
Z_LOW, Z_HIGH, SIDE_LOW, SIDE_HIGH, ARC, FRONT_AREA, NF_MAX = range(7)


@njit(cache=True, nogil=True)
def front_points(
    tip: FloatArray,
    feed: FloatArray,
    cos_theta: FloatArray,
    sin_theta: FloatArray,
    radius: FloatArray,
    height: FloatArray,
    cos_kappa: FloatArray,
    sin_kappa: FloatArray,
    elements: int,
    gate: FloatArray,
    status: NDArray[np.int8],
    points: FloatArray,
    places: NDArray[np.int64],
) -> int:
    """Midpoints of the edge elements, at every angle of the map, whose normal looks along the feed.

    Args:
        tip: tool tip, mm.
        feed: unit feed direction.
        elements: how many of the elements, from the lowest, are asked for.
        gate: shape (elements or more,), least n.f of a front point of each element.
        status: shape (rows, elements or more): set to -1 behind the gate, 0 before it.
        points, places: shapes (n, 3) and (n, 2): the points and their row and column in the map.

    Returns:
        Number of front points.
    """
    n = 0
    for j in range(len(cos_theta)):
        across = cos_theta[j] * feed[0] + sin_theta[j] * feed[1]
        for i in range(elements):
            if across * sin_kappa[i] - feed[2] * cos_kappa[i] > gate[i]:
                status[j, i] = 0
                points[n, 0] = tip[0] + radius[i] * cos_theta[j]
                points[n, 1] = tip[1] + radius[i] * sin_theta[j]
                points[n, 2] = tip[2] + height[i]
                places[n, 0] = j
                places[n, 1] = i
                n += 1
            else:
                status[j, i] = -1
    return n


@njit(cache=True, nogil=True)
def mark(places: NDArray[np.int64], inside: NDArray[np.bool_], status: NDArray[np.int8]) -> None:
    """Write what was found at the front points into the status map: 1 engaged, 0 not."""
    for n in range(len(places)):
        status[places[n, 0], places[n, 1]] = 1 if inside[n] else 0


@njit(cache=True, nogil=True)
def transitions(status: NDArray[np.int8], elements: int, places: NDArray[np.int64]) -> int:
    """Neighbouring front elements at one angle of which one is engaged: (row, lower column); returns their number."""
    n = 0
    for j in range(len(status)):
        for i in range(elements - 1):
            if status[j, i] >= 0 and status[j, i + 1] >= 0 and status[j, i] != status[j, i + 1]:
                places[n, 0] = j
                places[n, 1] = i
                n += 1
    return n


@njit(cache=True, nogil=True)
def turns(status: NDArray[np.int8], elements: int, places: NDArray[np.int64]) -> int:
    """Elements engaged at one of two neighbouring angles only: (first row, column); returns their number."""
    n = 0
    rows = len(status)
    for j in range(rows):
        after = (j + 1) % rows
        for i in range(elements):
            if status[j, i] >= 0 and status[after, i] >= 0 and status[j, i] != status[after, i]:
                places[n, 0] = j
                places[n, 1] = i
                n += 1
    return n


@njit(cache=True, nogil=True)
def _share_at(first: float, second: float, part: float, turn: float) -> float:
    """Engaged share between two rows of the map, ``part`` of the way from the first to the second."""
    if first + second == 1.0 and first * second == 0.0:
        return first if part < turn else second
    return (1.0 - part) * first + part * second


@njit(cache=True, nogil=True)
def weights(
    status: NDArray[np.int8],
    elements: int,
    bounds: FloatArray,
    places: NDArray[np.int64],
    boundary: FloatArray,
    share: FloatArray,
) -> None:
    """Engaged share of every element from its midpoint's status and the boundaries found between midpoints.

    Rows next to the gate take the share of their neighbour before it, so that interpolation between rows does not fade
    the edge force out half a row too early; the gate itself is applied exactly where forces are summed.

    Args:
        bounds: shape (n + 1,), ends of the elements along the meridian.
        places, boundary: the transitions and where along the meridian each one lies.
    """
    rows = len(status)
    for j in range(rows):
        for i in range(elements):
            share[j, i] = 1.0 if status[j, i] == 1 else 0.0
    for n in range(len(places)):
        j, i = places[n, 0], places[n, 1]
        off = boundary[n] - bounds[i + 1]
        sign = 1.0 if status[j, i] == 1 else -1.0
        if off < 0.0:
            share[j, i] += sign * off / (bounds[i + 1] - bounds[i])
        else:
            share[j, i + 1] += sign * off / (bounds[i + 2] - bounds[i + 1])
    for j in range(rows):
        for i in range(elements):
            if status[j, i] < 0:
                before, after = (j - 1) % rows, (j + 1) % rows
                if status[before, i] >= 0:
                    share[j, i] = share[before, i]
                elif status[after, i] >= 0:
                    share[j, i] = share[after, i]


@njit(cache=True, nogil=True)
def summarise(
    share: FloatArray,
    turn: FloatArray,
    status: NDArray[np.int8],
    elements: int,
    feed: FloatArray,
    cos_theta: FloatArray,
    sin_theta: FloatArray,
    radius: FloatArray,
    height: FloatArray,
    cos_kappa: FloatArray,
    sin_kappa: FloatArray,
    length: FloatArray,
    out: FloatArray,
) -> None:
    """Extent of the engagement and its area projected on the feed; see the names at the top of this file.

    Args:
        out: shape (7,): heights and sideways positions from-to, engaged angle in rows, projected area in mm2, and the
            largest n.f; the extents are +inf, -inf where nothing is engaged.
    """
    out[Z_LOW], out[Z_HIGH], out[SIDE_LOW], out[SIDE_HIGH] = math.inf, -math.inf, math.inf, -math.inf
    out[ARC], out[FRONT_AREA], out[NF_MAX] = 0.0, 0.0, 0.0
    rows = len(share)
    step = 2.0 * math.pi / rows
    plan = math.hypot(feed[0], feed[1])
    for j in range(rows):
        after = (j + 1) % rows
        across = cos_theta[j] * feed[0] + sin_theta[j] * feed[1]
        across_after = cos_theta[after] * feed[0] + sin_theta[after] * feed[1]
        sideways = (cos_theta[j] * feed[1] - sin_theta[j] * feed[0]) / plan if plan > 0.0 else cos_theta[j]
        engaged = False
        for i in range(elements):
            first, second = share[j, i], share[after, i]
            if first + second <= 0.0:
                continue
            along = feed[2] * cos_kappa[i]
            nf = across * sin_kappa[i] - along
            nf_after = across_after * sin_kappa[i] - along
            if first + second == 1.0 and first * second == 0.0:
                mean = turn[j, i] if first > 0.0 else 1.0 - turn[j, i]
            else:
                mean = 0.5 * (first + second)
            out[FRONT_AREA] += mean * 0.5 * (max(0.0, nf) + max(0.0, nf_after)) * radius[i] * length[i] * step
            if status[j, i] < 0 or first <= 0.0:
                continue
            engaged = True
            out[NF_MAX] = max(out[NF_MAX], nf)
            rise = length[i] * sin_kappa[i]
            if i == 0 or share[j, i - 1] >= first:
                low = height[i] - 0.5 * rise
                high = low + first * rise
            else:
                high = height[i] + 0.5 * rise
                low = high - first * rise
            wide = radius[i] if sin_kappa[i] <= 0.0 else radius[i] + (high - height[i]) * cos_kappa[i] / sin_kappa[i]
            out[Z_LOW] = min(out[Z_LOW], low)
            out[Z_HIGH] = max(out[Z_HIGH], high)
            out[SIDE_LOW] = min(out[SIDE_LOW], wide * sideways)
            out[SIDE_HIGH] = max(out[SIDE_HIGH], wide * sideways)
        if engaged:
            out[ARC] += 1.0


@njit(cache=True, nogil=True)
def sum_forces(
    spindle: FloatArray,
    sense: float,
    feed: FloatArray,
    feed_per_rev: float,
    share: FloatArray,
    turn: FloatArray,
    elements: int,
    angle: FloatArray,
    pitch: FloatArray,
    radial_error: FloatArray,
    radius: FloatArray,
    cos_kappa: FloatArray,
    sin_kappa: FloatArray,
    length: FloatArray,
    coefficients: FloatArray,
    least_chip: float,
    out: FloatArray,
) -> None:
    """Force on the tool and torque at spindle angles, summed over teeth and elements (tri-slice paper, eq. 2 to 5).

    Args:
        spindle: shape (n,), signed spindle angles.
        sense: +1 for M3, -1 for M4.
        feed_per_rev: feed per revolution, mm.
        share, turn: the engagement map, shape (rows, elements).
        angle: shape (teeth, elements), angle of each element behind the tip of tooth 0.
        pitch: shape (teeth,), angle of each tooth behind tooth 0.
        radial_error: shape (teeth, elements), how far the runout moves each element outwards, mm.
        coefficients: Ktc, Kte, Krc, Kre, Kac, Kae.
        least_chip: chips thinner than this are none, mm.
        out: shape (n, 4): Fx, Fy, Fz in N and torque in N mm.
    """
    rows = len(share)
    teeth = len(pitch)
    per_rad = rows / (2.0 * math.pi)
    round_rad = 2.0 * math.pi
    for s in range(len(spindle)):
        fx, fy, fz, torque = 0.0, 0.0, 0.0, 0.0
        for m in range(teeth):
            for i in range(elements):
                theta = -spindle[s] + sense * angle[m, i]
                place = theta * per_rad
                whole = math.floor(place)
                part = place - whole
                row = int(whole) % rows
                after = row + 1 if row + 1 < rows else 0
                engaged = _share_at(share[row, i], share[after, i], part, turn[row, i])
                if engaged <= 0.0:
                    continue
                cos_t, sin_t = math.cos(theta), math.sin(theta)
                nf = (cos_t * feed[0] + sin_t * feed[1]) * sin_kappa[i] - feed[2] * cos_kappa[i]
                chip = math.inf
                for back in range(1, teeth + 1):
                    other = m - back
                    gap = pitch[m] - pitch[other]
                    if other < 0:
                        gap += round_rad
                    error = radial_error[m, i] - radial_error[other, i]
                    chip = min(chip, feed_per_rev * gap / round_rad * nf + error * sin_kappa[i])
                if chip <= least_chip:
                    continue
                db = engaged * length[i]
                tangential = (coefficients[0] * chip + coefficients[1]) * db
                radial = (coefficients[2] * chip + coefficients[3]) * db
                axial = (coefficients[4] * chip + coefficients[5]) * db
                inward = radial * sin_kappa[i] + axial * cos_kappa[i]
                fx -= sense * tangential * sin_t + inward * cos_t
                fy += sense * tangential * cos_t - inward * sin_t
                fz += radial * cos_kappa[i] - axial * sin_kappa[i]
                torque += tangential * radius[i]
        out[s, 0], out[s, 1], out[s, 2], out[s, 3] = fx, fy, fz, torque
