"""Engagement maps; compiled.

A map has one row per angle about the tool axis (row j at the angle j * 2 pi / rows, counter-clockwise from +x) and one
column per edge element. Its entries are the engaged share of the element, 0 to 1. Where an element is whole in the
material at one angle and free at the next, ``turn`` is the fraction of a row between them at which it changes.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cutting.edge_arrays import EdgeArrays, RowAngles
from twin.cutting.equation_kernels import normal_along_feed
from twin.geometry.column_cells.strips import HeightMap
from twin.jit import helper, inlined, njit

#: Entries of a summary: lowest and highest engaged point, extent sideways, number of rows engaged, area projected on
#: the feed in mm2, largest n . f.
Z_LOW, Z_HIGH, SIDE_LOW, SIDE_HIGH, ARC, FRONT_AREA, NF_MAX = range(7)
SUMMARY_ENTRIES = 7


class Boundaries(NamedTuple):
    """Neighbours in maps of which one is engaged.

    Attributes:
        entries: shape (n, 3): up to ``split`` those of `transitions`, then those of `turns`.
        split: number of transitions.
        part: shape (n,), position between the first neighbour, 0, and the second, 1.
    """

    entries: NDArray[np.int32]
    split: int
    part: FloatArray


class Front(NamedTuple):
    """Where the front of a tool is, and where material may be.

    Attributes:
        tips, feeds: shape (steps, 3): tool tips in mm and unit feed directions.
        gate: shape (elements or more,), least n . f of a front point of each element.
        known: whether heights of the material are known.
        over_x, over_y: those by the planes across x and across y; there is no material where both are lower.
    """

    tips: FloatArray
    feeds: FloatArray
    gate: FloatArray
    known: bool
    over_x: HeightMap
    over_y: HeightMap


@njit
def front_points(
    front: Front,
    angles: RowAngles,
    edges: EdgeArrays,
    status: NDArray[np.int8],
    points: FloatArray,
    entries: NDArray[np.int32],
) -> tuple[int, int]:
    """Midpoints of the edge elements, at every angle of the maps, whose normal looks along the feed.

    Args:
        status: shape (steps, rows, elements), set to 0 at front points, -1 elsewhere; its elements are the lowest.
        points: shape (n, 3), the points where material may be.
        entries: shape (n,), their indices in the maps, counted through steps, rows and elements.

    Returns:
        Number of points, and of those above all material, which are left out.
    """
    tips, feeds, gate, known = front.tips, front.feeds, front.gate, front.known
    cos_theta, sin_theta, elements = angles.cos, angles.sin, status.shape[2]
    radius, height, cos_kappa, sin_kappa = edges.radius, edges.height, edges.cos_kappa, edges.sin_kappa
    n, above = 0, 0
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
                if normal_along_feed(across, down, sin_kappa[i], cos_kappa[i]) > gate[i]:
                    status[s, j, i] = 0
                    px, py, pz = x + radius[i] * cos_t, y + radius[i] * sin_t, z + height[i]
                    if known and pz >= _height_at(front.over_x, px, py) and pz >= _height_at(front.over_y, py, px):
                        above += 1
                        continue
                    points[n, 0], points[n, 1], points[n, 2] = px, py, pz
                    entries[n] = first + i
                    n += 1
                else:
                    status[s, j, i] = -1
    return n, above


@inlined
def _height_at(over: HeightMap, w: float, u: float) -> float:
    """Height of the material at a point in plan, -inf without any."""
    k, b = (w - over.w_low) * over.per_w, (u - over.u_low) * over.per_u
    if k < 0.0 or b < 0.0 or k >= over.heights.shape[0] or b >= over.heights.shape[1]:
        return -math.inf
    return over.heights[int(k), int(b)]


@njit
def mark(entries: NDArray[np.int32], inside: NDArray[np.bool_], status: NDArray[np.int8]) -> bool:
    """Write the front points' states into the status maps, in one dimension: 1 engaged, 0 not.

    Returns:
        Whether any is engaged.
    """
    engaged = False
    for n in range(len(entries)):
        if inside[n]:
            status[entries[n]] = 1
            engaged = True
    return engaged


@njit
def transitions(status: NDArray[np.int8], entries: NDArray[np.int32]) -> int:
    """Neighbouring front elements at one angle of which one is engaged: (step, row, lower column); their number."""
    steps, rows, elements = status.shape
    n = 0
    for s in range(steps):
        for j in range(rows):
            for i in range(elements - 1):
                if status[s, j, i] + status[s, j, i + 1] == 1 and status[s, j, i] * status[s, j, i + 1] == 0:
                    entries[n, 0] = s
                    entries[n, 1] = j
                    entries[n, 2] = i
                    n += 1
    return n


@njit
def turns(status: NDArray[np.int8], first: int, entries: NDArray[np.int32]) -> int:
    """Elements engaged at one of two neighbouring angles only: (step, first row, column), written from ``first`` on.

    Returns:
        Where they end in ``entries``.
    """
    steps, rows, elements = status.shape
    n = first
    for s in range(steps):
        for j in range(rows):
            after = j + 1 if j + 1 < rows else 0
            for i in range(elements):
                if status[s, j, i] + status[s, after, i] == 1 and status[s, j, i] * status[s, after, i] == 0:
                    entries[n, 0] = s
                    entries[n, 1] = j
                    entries[n, 2] = i
                    n += 1
    return n


@njit
def boundary_points(
    tips: FloatArray,
    boundaries: Boundaries,
    at_radius: FloatArray,
    at_height: FloatArray,
    angles: RowAngles,
    edges: EdgeArrays,
    points: FloatArray,
) -> None:
    """Points between two neighbours of a map, of which one is engaged.

    Args:
        at_radius, at_height: shape (split,): radius and height of the points on the meridian of the transitions.
        points: shape (n, 3), filled.
    """
    entries, split, part = boundaries
    cos_theta, sin_theta = angles.cos, angles.sin
    radius, height = edges.radius, edges.height
    step = 2.0 * math.pi / len(cos_theta)
    for n in range(len(entries)):
        s, j, i = entries[n, 0], entries[n, 1], entries[n, 2]
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
    """One halving: the boundary lies after the middle where that is like the first neighbour, else before it."""
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
    entries: NDArray[np.int32],
    boundary: FloatArray,
    share: FloatArray,
) -> None:
    """Engaged share of every element from its midpoint's status and the boundaries found between midpoints.

    Rows next to the gate take the share of their neighbour before it, so that interpolation between rows does not fade
    the edge force out half a row too early; the gate itself is applied exactly where forces are summed.

    Args:
        bounds: shape (n + 1,), ends of the elements along the meridian.
        entries, boundary: the transitions and where along the meridian each one lies.
        share: shape (steps, rows, elements), filled.
    """
    steps, rows, elements = status.shape
    for s in range(steps):
        for j in range(rows):
            for i in range(elements):
                share[s, j, i] = 1.0 if status[s, j, i] == 1 else 0.0
    for n in range(len(entries)):
        s, j, i = entries[n, 0], entries[n, 1], entries[n, 2]
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
def summarise(
    share: FloatArray,
    turn: FloatArray,
    status: NDArray[np.int8],
    feed: FloatArray,
    angles: RowAngles,
    edges: EdgeArrays,
    out: FloatArray,
) -> None:
    """Extents of the engagement in several maps, each with its feed.

    Args:
        out: shape (steps, 7), see `Z_LOW` and the names after it; extents are +inf, -inf where nothing is engaged.
    """
    for s in range(len(share)):
        _measure_front(share[s], turn[s], feed[s], angles, edges, out[s])
        _measure_extents(share[s], status[s], feed[s], angles, edges, out[s])


@helper
def _measure_front(
    share: FloatArray, turn: FloatArray, feed: FloatArray, angles: RowAngles, edges: EdgeArrays, out: FloatArray
) -> None:
    """Area of the engagement projected on the feed."""
    cos_theta, sin_theta = angles.cos, angles.sin
    radius, cos_kappa, sin_kappa, length = edges.radius, edges.cos_kappa, edges.sin_kappa, edges.length
    rows, elements = share.shape
    step = 2.0 * math.pi / rows
    front_area = 0.0
    for j in range(rows):
        after = (j + 1) % rows
        across = cos_theta[j] * feed[0] + sin_theta[j] * feed[1]
        across_after = cos_theta[after] * feed[0] + sin_theta[after] * feed[1]
        for i in range(elements):
            first, second = share[j, i], share[after, i]
            if first + second > 0.0:
                mean = _mean_share(first, second, turn[j, i])
                nf = max(0.0, normal_along_feed(across, feed[2], sin_kappa[i], cos_kappa[i]))
                nf_after = max(0.0, normal_along_feed(across_after, feed[2], sin_kappa[i], cos_kappa[i]))
                front_area += mean * 0.5 * (nf + nf_after) * radius[i] * length[i] * step
    out[FRONT_AREA] = front_area


@helper
def _mean_share(first: float, second: float, turn: float) -> float:
    """Mean engaged share between two rows."""
    if first + second == 1.0 and first * second == 0.0:
        return turn if first > 0.0 else 1.0 - turn
    return 0.5 * (first + second)


@helper
def _measure_extents(
    share: FloatArray,
    status: NDArray[np.int8],
    feed: FloatArray,
    angles: RowAngles,
    edges: EdgeArrays,
    out: FloatArray,
) -> None:
    """Heights and sideways positions from-to of the engagement, number of rows engaged, and largest n . f."""
    cos_theta, sin_theta = angles.cos, angles.sin
    radius, height, length = edges.radius, edges.height, edges.length
    cos_kappa, sin_kappa = edges.cos_kappa, edges.sin_kappa
    out[Z_LOW], out[Z_HIGH], out[SIDE_LOW], out[SIDE_HIGH] = math.inf, -math.inf, math.inf, -math.inf
    out[ARC], out[NF_MAX] = 0.0, 0.0
    rows, elements = share.shape
    plan = math.hypot(feed[0], feed[1])
    for j in range(rows):
        across = cos_theta[j] * feed[0] + sin_theta[j] * feed[1]
        sideways = (cos_theta[j] * feed[1] - sin_theta[j] * feed[0]) / plan if plan > 0.0 else cos_theta[j]
        engaged = False
        for i in range(elements):
            part = share[j, i]
            if status[j, i] < 0 or part <= 0.0:
                continue
            engaged = True
            out[NF_MAX] = max(out[NF_MAX], normal_along_feed(across, feed[2], sin_kappa[i], cos_kappa[i]))
            if part == 1.0 and 0 < i < elements - 1 and status[j, i - 1] == 1 and status[j, i + 1] == 1:
                continue  # an element between others is not outermost
            rise = length[i] * sin_kappa[i]
            if i == 0 or share[j, i - 1] >= part:
                low = height[i] - 0.5 * rise
                high = low + part * rise
            else:
                high = height[i] + 0.5 * rise
                low = high - part * rise
            wide = radius[i] if sin_kappa[i] <= 0.0 else radius[i] + (high - height[i]) * cos_kappa[i] / sin_kappa[i]
            out[Z_LOW] = min(out[Z_LOW], low)
            out[Z_HIGH] = max(out[Z_HIGH], high)
            out[SIDE_LOW] = min(out[SIDE_LOW], wide * sideways)
            out[SIDE_HIGH] = max(out[SIDE_HIGH], wide * sideways)
        if engaged:
            out[ARC] += 1.0
