"""Engagement map and force sums; compiled.

The map has one row an angle about the tool axis (row j at the angle j * 2 pi / rows, counter-clockwise from +x) and one
column an edge element. Its entries are the engaged share of the element, 0 to 1. Where an element is whole in the
material at one angle and free at the next, ``turn`` tells at which part of the way between them it changes.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import njit

#: What `ENGAGEMENT` summary entries mean.
Z_LOW, Z_HIGH, SIDE_LOW, SIDE_HIGH, ARC, FRONT_AREA, NF_MAX = range(7)


@njit
def front_points(
    tips: FloatArray,
    feeds: FloatArray,
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
    places: NDArray[np.int32],
) -> int:
    """Midpoints of the edge elements, at every angle of the maps, whose normal looks along the feed.

    Args:
        tips, feeds: shape (steps, 3): tool tips in mm and unit feed directions.
        elements: how many of the elements, from the lowest, are asked for.
        gate: shape (elements or more,), least n.f of a front point of each element.
        status: shape (steps, rows, elements): set to -1 behind the gate, 0 before it.
        points: shape (n, 3), the points.
        places: shape (n,), their places in the maps, counted through steps, rows and elements.

    Returns:
        Number of front points.
    """
    n = 0
    rows = len(cos_theta)
    for s in range(len(tips)):
        x, y, z = tips[s, 0], tips[s, 1], tips[s, 2]
        down = feeds[s, 2]
        for j in range(rows):
            cos_t, sin_t = cos_theta[j], sin_theta[j]
            across = cos_t * feeds[s, 0] + sin_t * feeds[s, 1]
            first = (s * rows + j) * elements
            if across <= 0.0 and down >= 0.0:
                status[s, j] = -1
                continue
            for i in range(elements):
                if across * sin_kappa[i] - down * cos_kappa[i] > gate[i]:
                    status[s, j, i] = 0
                    points[n, 0] = x + radius[i] * cos_t
                    points[n, 1] = y + radius[i] * sin_t
                    points[n, 2] = z + height[i]
                    places[n] = first + i
                    n += 1
                else:
                    status[s, j, i] = -1
    return n


@njit
def mark(places: NDArray[np.int32], inside: NDArray[np.bool_], status: NDArray[np.int8]) -> bool:
    """Write what was found at the front points into the status maps, in one dimension: 1 engaged, 0 not.

    Returns:
        Whether any is engaged.
    """
    engaged = False
    for n in range(len(places)):
        if inside[n]:
            status[places[n]] = 1
            engaged = True
    return engaged


@njit
def transitions(status: NDArray[np.int8], places: NDArray[np.int32]) -> int:
    """Neighbouring front elements at one angle of which one is engaged: (step, row, lower column); their number."""
    steps, rows, elements = status.shape
    n = 0
    for s in range(steps):
        for j in range(rows):
            for i in range(elements - 1):
                if status[s, j, i] + status[s, j, i + 1] == 1 and status[s, j, i] * status[s, j, i + 1] == 0:
                    places[n, 0] = s
                    places[n, 1] = j
                    places[n, 2] = i
                    n += 1
    return n


@njit
def turns(status: NDArray[np.int8], first: int, places: NDArray[np.int32]) -> int:
    """Elements engaged at one of two neighbouring angles only: (step, first row, column), written from ``first`` on.

    Returns:
        Where they end in ``places``.
    """
    steps, rows, elements = status.shape
    n = first
    for s in range(steps):
        for j in range(rows):
            after = j + 1 if j + 1 < rows else 0
            for i in range(elements):
                if status[s, j, i] + status[s, after, i] == 1 and status[s, j, i] * status[s, after, i] == 0:
                    places[n, 0] = s
                    places[n, 1] = j
                    places[n, 2] = i
                    n += 1
    return n


@njit
def boundary_points(
    tips: FloatArray,
    places: NDArray[np.int32],
    split: int,
    part: FloatArray,
    at_radius: FloatArray,
    at_height: FloatArray,
    cos_theta: FloatArray,
    sin_theta: FloatArray,
    radius: FloatArray,
    height: FloatArray,
    points: FloatArray,
) -> None:
    """Points between two neighbours of a map, of which one is engaged.

    Args:
        places: shape (n, 3): up to ``split`` `transitions`, then `turns`.
        part: shape (n,), how far from the first neighbour to the second.
        at_radius, at_height: shape (split,): radius and height of the points on the meridian of the transitions.
        points: shape (n, 3).
    """
    step = 2.0 * math.pi / len(cos_theta)
    for n in range(len(places)):
        s, j, i = places[n, 0], places[n, 1], places[n, 2]
        if n < split:
            r, z, cos_t, sin_t = at_radius[n], at_height[n], cos_theta[j], sin_theta[j]
        else:
            theta = (j + part[n]) * step
            r, z, cos_t, sin_t = radius[i], height[i], math.cos(theta), math.sin(theta)
        points[n, 0] = tips[s, 0] + r * cos_t
        points[n, 1] = tips[s, 1] + r * sin_t
        points[n, 2] = tips[s, 2] + z


@njit
def narrow(inside: NDArray[np.bool_], first: NDArray[np.bool_], low: FloatArray, high: FloatArray) -> None:
    """One halving: the boundary lies behind the middle where that is like the first neighbour, else before it."""
    for n in range(len(low)):
        middle = 0.5 * (low[n] + high[n])
        if inside[n] == first[n]:
            low[n] = middle
        else:
            high[n] = middle


@njit
def weights(
    status: NDArray[np.int8],
    bounds: FloatArray,
    places: NDArray[np.int32],
    boundary: FloatArray,
    share: FloatArray,
) -> None:
    """Engaged share of every element from its midpoint's status and the boundaries found between midpoints.

    Rows next to the gate take the share of their neighbour before it, so that interpolation between rows does not fade
    the edge force out half a row too early; the gate itself is applied exactly where forces are summed.

    Args:
        bounds: shape (n + 1,), ends of the elements along the meridian.
        places, boundary: the transitions and where along the meridian each one lies.
        share: shape (steps, rows, elements), filled.
    """
    steps, rows, elements = status.shape
    for s in range(steps):
        for j in range(rows):
            for i in range(elements):
                share[s, j, i] = 1.0 if status[s, j, i] == 1 else 0.0
    for n in range(len(places)):
        s, j, i = places[n, 0], places[n, 1], places[n, 2]
        off = boundary[n] - bounds[i + 1]
        sign = 1.0 if status[s, j, i] == 1 else -1.0
        if off < 0.0:
            share[s, j, i] += sign * off / (bounds[i + 1] - bounds[i])
        else:
            share[s, j, i + 1] += sign * off / (bounds[i + 2] - bounds[i + 1])
    for s in range(steps):
        for j in range(rows):
            before = j - 1 if j > 0 else rows - 1
            after = j + 1 if j + 1 < rows else 0
            for i in range(elements):
                if status[s, j, i] < 0:
                    if status[s, before, i] >= 0:
                        share[s, j, i] = share[s, before, i]
                    elif status[s, after, i] >= 0:
                        share[s, j, i] = share[s, after, i]


@njit
def _summarise_one(
    share: FloatArray,
    turn: FloatArray,
    status: NDArray[np.int8],
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
    out[ARC], front_area, nf_max = 0.0, 0.0, 0.0
    rows, elements = share.shape
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
            front_area += mean * 0.5 * (max(0.0, nf) + max(0.0, nf_after)) * radius[i] * length[i] * step
            if status[j, i] < 0 or first <= 0.0:
                continue
            engaged = True
            nf_max = max(nf_max, nf)
            if first == 1.0 and 0 < i < elements - 1 and status[j, i - 1] == 1 and status[j, i + 1] == 1:
                continue  # what lies between others is not outermost
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
    out[FRONT_AREA], out[NF_MAX] = front_area, nf_max


@njit
def summarise(
    share: FloatArray,
    turn: FloatArray,
    status: NDArray[np.int8],
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
    """Extents of the engagement in several maps, each with its feed; see `_summarise_one`.

    Args:
        out: shape (steps, 7).
    """
    for s in range(len(share)):
        _summarise_one(
            share[s],
            turn[s],
            status[s],
            feed[s],
            cos_theta,
            sin_theta,
            radius,
            height,
            cos_kappa,
            sin_kappa,
            length,
            out[s],
        )


@njit
def sum_forces(
    first_rad: float,
    period: int,
    sense: float,
    feed: FloatArray,
    chip_per_back: FloatArray,
    share: FloatArray,
    turn: FloatArray,
    angle: FloatArray,
    error_per_back: FloatArray,
    radius: FloatArray,
    cos_kappa: FloatArray,
    sin_kappa: FloatArray,
    length: FloatArray,
    cos_row: FloatArray,
    sin_row: FloatArray,
    coefficients: FloatArray,
    least_chip: float,
    out: FloatArray,
) -> None:
    """Force on the tool and torque at spindle angles, summed over teeth and elements (tri-slice paper, eq. 2 to 5).

    Samples are one row of the map apart, so an element of a tooth stands at the same part of the way between two rows
    in all of them, one row farther in each: the map is gathered with a shift.

    Args:
        first_rad: signed spindle angle of the first sample; the others are one row of the map apart.
        period: number of samples after which they repeat.
        sense: +1 for M3, -1 for M4.
        chip_per_back: shape (teeth, backs), feed from the tooth that passed so many teeth before, mm.
        share, turn: the engagement map, shape (rows, elements).
        angle: shape (teeth, elements), angle of each element behind the tip of tooth 0.
        error_per_back: shape (teeth, backs, elements), how much farther out an element is than that of the tooth
            before, by runout, mm.
        cos_row, sin_row: shape (rows,), cosine and sine of the rows' angles.
        coefficients: Ktc, Kte, Krc, Kre, Kac, Kae.
        least_chip: chips thinner than this are none, mm.
        out: shape (samples, 4): Fx, Fy, Fz in N and torque in N mm.
    """
    rows, elements = share.shape
    teeth, backs = chip_per_back.shape
    samples = len(out)
    computed = min(samples, period)
    shift = 1 if sense > 0.0 else -1
    per_rad = rows / (2.0 * math.pi)
    column = np.empty(rows + 1)
    for s in range(computed):
        out[s, 0], out[s, 1], out[s, 2], out[s, 3] = 0.0, 0.0, 0.0, 0.0
    for i in range(elements):
        any_share = False
        for j in range(rows):
            column[j] = share[j, i]
            if column[j] > 0.0:
                any_share = True
        if not any_share:
            continue
        column[rows] = column[0]
        cos_k, sin_k = cos_kappa[i], sin_kappa[i]
        for m in range(teeth):
            theta = -first_rad + sense * angle[m, i]
            place = theta * per_rad
            whole = math.floor(place)
            part = place - whole
            row = int(whole) % rows
            cos_0, sin_0 = math.cos(theta), math.sin(theta)
            turned = 0
            for s in range(computed):
                a, b = column[row], column[row + 1]
                if a + b > 0.0:
                    if a + b == 1.0 and a * b == 0.0:
                        engaged = a if part < turn[row, i] else b
                    else:
                        engaged = (1.0 - part) * a + part * b
                    cos_s, sin_s = cos_row[turned], -sense * sin_row[turned]
                    cos_t = cos_0 * cos_s - sin_0 * sin_s
                    sin_t = sin_0 * cos_s + cos_0 * sin_s
                    nf = (cos_t * feed[0] + sin_t * feed[1]) * sin_k - feed[2] * cos_k
                    chip = chip_per_back[m, 0] * nf + error_per_back[m, 0, i] * sin_k
                    for back in range(1, backs):
                        chip = min(chip, chip_per_back[m, back] * nf + error_per_back[m, back, i] * sin_k)
                    if engaged > 0.0 and chip > least_chip:
                        db = engaged * length[i]
                        tangential = (coefficients[0] * chip + coefficients[1]) * db
                        radial = (coefficients[2] * chip + coefficients[3]) * db
                        axial = (coefficients[4] * chip + coefficients[5]) * db
                        inward = radial * sin_k + axial * cos_k
                        out[s, 0] -= sense * tangential * sin_t + inward * cos_t
                        out[s, 1] += sense * tangential * cos_t - inward * sin_t
                        out[s, 2] += radial * cos_k - axial * sin_k
                        out[s, 3] += tangential * radius[i]
                turned = turned + 1 if turned + 1 < rows else 0
                row -= shift
                if row < 0:
                    row += rows
                elif row >= rows:
                    row -= rows
    for s in range(computed, samples):
        for c in range(4):
            out[s, c] = out[s - period, c]


@njit
def sum_forces_of_steps(
    first_rad: FloatArray,
    offsets: NDArray[np.int64],
    period: int,
    sense: FloatArray,
    feed: FloatArray,
    feed_per_rev: FloatArray,
    feed_part: FloatArray,
    share: FloatArray,
    turn: FloatArray,
    angle: FloatArray,
    error_per_back: FloatArray,
    radius: FloatArray,
    cos_kappa: FloatArray,
    sin_kappa: FloatArray,
    length: FloatArray,
    cos_row: FloatArray,
    sin_row: FloatArray,
    coefficients: FloatArray,
    least_chip: float,
    out: FloatArray,
) -> None:
    """The forces of several steps, each with its own map; see `sum_forces`.

    Args:
        first_rad, sense, feed_per_rev: shape (steps,).
        offsets: shape (steps + 1,), where the samples of each step begin in ``out``.
        feed: shape (steps, 3).
        feed_part: shape (teeth, backs), part of a revolution since the tooth that passed so many teeth before.
        share, turn: shape (steps, rows, elements).
        least_chip: as a part of the feed per revolution.
    """
    for s in range(len(first_rad)):
        sum_forces(
            first_rad[s],
            period,
            sense[s],
            feed[s],
            feed_part * feed_per_rev[s],
            share[s],
            turn[s],
            angle,
            error_per_back,
            radius,
            cos_kappa,
            sin_kappa,
            length,
            cos_row,
            sin_row,
            coefficients,
            least_chip * feed_per_rev[s],
            out[offsets[s] : offsets[s + 1]],
        )
