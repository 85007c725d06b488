"""Sections of many sweeps of one tool by vertical planes: one lower envelope for all of them; compiled.

Every sweep reaches above the material, so the union of their sections by a plane is all that lies above their lower
envelope. Coordinates are those of `twin.motion.swept_kernels`; a sweep is a row (w, dw, u, du, v, dv).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells.strips import Bins, Strips
from twin.jit import helper, njit
from twin.motion.node_kernels import INSET, NO_SECTION, SAME_SECTION, off_chord
from twin.motion.swept_kernels import BodyShape, Motion, disc_upper, lowest
from twin.tools.meridian_kernels import profile_height

#: Columns of a sweep that reaches a plane, after those of its motion: one over the square of its length in plan, or 0;
#: the range of u that it covers; its lowest tip.
PER_SQUARE, FROM_U, TO_U, TIP = 6, 7, 8, 9
REACHING_COLUMNS = 10
#: How often a bin may be halved, and the part of it that is left then.
DEPTH = 9
NARROWEST = 1.001 * 0.5**DEPTH
#: Columns of a stack of nodes.
_U, _LO, _NEW = 0, 1, 2
#: Entries of ``used``: strips and nodes that are written.
STRIPS, NODES = 0, 1


class UnionPlanes(NamedTuple):
    """Planes that cut the union of many sweeps.

    Attributes:
        first_w, pitch, planes: position of the first, their distance, mm, and their number.
        chord: how far a chord may deviate from its curve, mm.
        top: a height above all material; for vertical planes.
        start_is_cut: the body's volume at the start of the first sweep has been cut already. Nodes where the section
            does not reach beyond it are not fresh.
    """

    first_w: float
    pitch: float
    planes: int
    chord: float
    top: float
    start_is_cut: bool


class _Plane(NamedTuple):
    """One plane: the sweeps that reach it, in order of where they begin along u; see `REACHING_COLUMNS`."""

    w: float
    reaching: FloatArray
    top: float
    chord: float
    start: Motion
    start_is_cut: bool


@njit
def envelope_strips(
    body: BodyShape, sweeps: FloatArray, planes: UnionPlanes, bins: Bins, strips: Strips, used: NDArray[np.int64]
) -> bool:
    """Strips above the lower envelope of sweeps on consecutive vertical planes, where there is material.

    Bins whose material lies below the envelope have no strip. The others are halved until no chord of the envelope
    deviates from it by more than the tolerance.

    Args:
        sweeps: shape (n, 6), each beginning where the one before ends or anywhere.
        strips: its arrays are filled, of ``at`` the number of the plane from the first.
        used: shape (2,), filled: strips and nodes that were written.

    Returns:
        Whether they fit.
    """
    room, stack, near = np.empty((len(sweeps), REACHING_COLUMNS)), np.empty((DEPTH + 2, 3)), np.empty(len(sweeps))
    active = np.empty(len(sweeps), dtype=np.int64)
    used[STRIPS], used[NODES] = 0, 0
    start = Motion(sweeps[0, 0], 0.0, sweeps[0, 2], 0.0, sweeps[0, 4], 0.0)
    for i in range(planes.planes):
        w = planes.first_w + i * planes.pitch
        reaching = room[: _reaching(body, sweeps, w, room)]
        plane = _Plane(w, reaching, planes.top, planes.chord, start, planes.start_is_cut)
        first = 0
        while first < len(reaching):
            last, end = first + 1, reaching[first, TO_U]
            while last < len(reaching) and reaching[last, FROM_U] <= end:
                end = max(end, reaching[last, TO_U])
                last += 1
            if not _piece(body, plane, (first, last), end, (i, bins), (active, stack, near), strips, used):
                return False
            first = last
    return True


@helper
def _reaching(body: BodyShape, sweeps: FloatArray, w: float, room: FloatArray) -> int:
    """Write the sweeps that reach a plane, in order of where they begin along u; returns their number."""
    radius, n = body.meridian.radius, 0
    for j in range(len(sweeps)):
        begin, end = sweeps[j, 0], sweeps[j, 0] + sweeps[j, 1]
        if w < min(begin, end) - radius or w > max(begin, end) + radius:
            continue
        m = Motion(sweeps[j, 0], sweeps[j, 1], sweeps[j, 2], sweeps[j, 3], sweeps[j, 4], sweeps[j, 5])
        low = -disc_upper(m.w, m.dw, -m.u, -m.du, radius, w, 0.0, 1.0)
        high = disc_upper(m.w, m.dw, m.u, m.du, radius, w, 0.0, 1.0)
        if not high - low > NO_SECTION * radius:
            continue
        middle, half = 0.5 * (low + high), 0.5 * (high - low) * INSET
        at = n
        while at > 0 and room[at - 1, FROM_U] > middle - half:
            room[at] = room[at - 1]
            at -= 1
        room[at, :PER_SQUARE] = sweeps[j]
        square = m.dw * m.dw + m.du * m.du
        room[at, PER_SQUARE] = 1.0 / square if square > 0.0 else 0.0
        room[at, FROM_U], room[at, TO_U] = middle - half, middle + half
        room[at, TIP] = min(m.v, m.v + m.dv)
        n += 1
    return n


@helper
def _piece(
    body: BodyShape,
    plane: _Plane,
    part: tuple[int, int],
    end: float,
    where: tuple[int, Bins],
    scratch: tuple[NDArray[np.int64], FloatArray, FloatArray],
    strips: Strips,
    used: NDArray[np.int64],
) -> bool:
    """Strips of sweeps that cover a range of u without a gap; returns whether they fit.

    Args:
        part: the first of them and the end of them in ``plane.reaching``.
        end: of the range.
        where: number of the plane, and the bins.
        scratch: numbers of the sweeps that matter in a bin, a stack of nodes, and lower bounds.
    """
    i, bins = where
    active, stack, near = scratch
    begin, open_to = plane.reaching[part[0], FROM_U], -math.inf
    since = part[0]
    first = max(0, int(math.floor((begin - bins.u_low) / bins.size)))
    last = min(bins.heights.shape[1] - 1, int(math.floor((end - bins.u_low) / bins.size)))
    for b in range(first, last + 1):
        height = bins.heights[i, b]
        if height == -math.inf:
            continue
        u0, u1 = max(begin, bins.u_low + b * bins.size), min(end, bins.u_low + (b + 1) * bins.size)
        if not u1 > u0:
            continue
        while plane.reaching[since, TO_U] <= u0:
            since += 1
        count = _active(body, plane, (since, part[1], u0, u1), height, active, near)
        if count == 0:
            continue
        if open_to != u0:
            if not _begin(body, plane, active[:count], u0, i, strips, used):
                return False
        if not _refine(body, plane, active[:count], u1, stack, strips, used):
            return False
        open_to = u1
    return True


@helper
def _active(
    body: BodyShape,
    plane: _Plane,
    part: tuple[int, int, float, float],
    height: float,
    active: NDArray[np.int64],
    near: FloatArray,
) -> int:
    """Write the numbers of the sweeps that may be lowest somewhere in a range of u; returns how many, 0 where none is
    below a height.

    Args:
        part: the first of the sweeps, the end of them, and the range.
    """
    tool, n, best, least = body.meridian, 0, -1, math.inf
    first, end, u0, u1 = part
    middle, half = 0.5 * (u0 + u1), 0.5 * (u1 - u0)
    for j in range(first, end):
        row = plane.reaching[j]
        if row[FROM_U] >= u1:
            break
        if row[TO_U] <= u0:
            continue
        distance = max(0.0, _distance(row, plane.w, middle) - half)
        bound = row[TIP] + max(0.0, profile_height(tool, min(distance * INSET, tool.radius)) - body.drop)
        near[n] = bound
        active[n] = j
        if bound < least:
            best, least = n, bound
        n += 1
    if n == 0 or least >= height + SAME_SECTION * tool.radius:
        return 0
    if n == 1:
        return 1
    row = plane.reaching[active[best]]
    most = max(_lowest_of(body, row, plane.w, u0), _lowest_of(body, row, plane.w, u1))
    kept = 0
    for k in range(n):
        if near[k] <= most:
            active[kept] = active[k]
            kept += 1
    return kept


@helper
def _distance(row: FloatArray, w: float, u: float) -> float:
    """Distance in plan of a point from the line of a sweep."""
    ew, eu = w - row[0], u - row[2]
    t = min(1.0, max(0.0, (ew * row[1] + eu * row[3]) * row[PER_SQUARE]))
    return math.hypot(ew - t * row[1], eu - t * row[3])


@helper
def _lowest_of(body: BodyShape, row: FloatArray, w: float, u: float) -> float:
    """Lowest point of one sweep at u, inf where it does not cover that."""
    if u < row[FROM_U] or u > row[TO_U]:
        return math.inf
    motion = Motion(row[0], row[1], row[2], row[3], row[4], row[5])
    return float(max(lowest(body, motion, w, u), row[TIP]))


@helper
def _envelope(body: BodyShape, plane: _Plane, active: NDArray[np.int64], u: float) -> float:
    """Lowest point of several sweeps, by their numbers, at u.

    Where rounding hides all of them, at the end of their range, it is the top.
    """
    lo = math.inf
    for k in active:
        if plane.reaching[k, TIP] < lo:
            lo = min(lo, _lowest_of(body, plane.reaching[k], plane.w, u))
    return lo if lo < math.inf else plane.top


@helper
def _is_new(body: BodyShape, plane: _Plane, u: float, lo: float) -> bool:
    """Whether the envelope lies below the body at rest at the start, if that has been cut already."""
    if not plane.start_is_cut:
        return True
    at = plane.start
    if math.hypot(plane.w - at.w, u - at.u) > body.meridian.radius:
        return True
    return lo < max(lowest(body, at, plane.w, u), at.v) - SAME_SECTION * body.meridian.radius


@helper
def _begin(
    body: BodyShape, plane: _Plane, active: NDArray[np.int64], u: float, i: int, strips: Strips, used: NDArray[np.int64]
) -> bool:
    """Begin a strip at u on the plane ``i``; returns whether it fits."""
    if used[STRIPS] + 1 >= len(strips.offsets):
        return False
    strips.at[used[STRIPS]] = i
    strips.offsets[used[STRIPS]] = used[NODES]
    used[STRIPS] += 1
    lo = _envelope(body, plane, active, u)
    return _write(u, lo, _is_new(body, plane, u, lo), plane.top, strips, used)


@helper
def _write(u: float, lo: float, new: bool, top: float, strips: Strips, used: NDArray[np.int64]) -> bool:
    """Append a node to the last strip; returns whether it fits."""
    n = used[NODES]
    if n >= len(strips.nodes):
        return False
    strips.nodes[n, 0], strips.nodes[n, 1], strips.nodes[n, 2] = u, lo, max(lo, top)
    strips.fresh[n] = new
    used[NODES] += 1
    strips.offsets[used[STRIPS]] = used[NODES]
    return True


@helper
def _refine(
    body: BodyShape,
    plane: _Plane,
    active: NDArray[np.int64],
    end: float,
    stack: FloatArray,
    strips: Strips,
    used: NDArray[np.int64],
) -> bool:
    """Append the nodes after the last one, up to ``end``; returns whether they fit."""
    n = used[NODES] - 1
    u, lo, new = strips.nodes[n, 0], strips.nodes[n, 1], strips.fresh[n]
    depth, least = 0, (end - u) * NARROWEST
    stack[0, _U], stack[0, _LO] = end, _envelope(body, plane, active, end)
    stack[0, _NEW] = 1.0 if _is_new(body, plane, end, stack[0, _LO]) else 0.0
    while depth >= 0:
        right_u, right_lo, right_new = stack[depth, _U], stack[depth, _LO], stack[depth, _NEW] > 0.0
        middle = 0.5 * (u + right_u)
        middle_lo = _envelope(body, plane, active, middle)
        middle_new = _is_new(body, plane, middle, middle_lo)
        old = not (new or middle_new or right_new)
        if (
            old
            or right_u - u <= least
            or (lo == middle_lo and lo == right_lo)
            or off_chord(middle, middle_lo, u, lo, right_u, right_lo) <= plane.chord
        ):
            if not _write(right_u, right_lo, right_new, plane.top, strips, used):
                return False
            u, lo, new = right_u, right_lo, right_new
            depth -= 1
        else:
            depth += 1
            stack[depth, _U], stack[depth, _LO], stack[depth, _NEW] = middle, middle_lo, 1.0 if middle_new else 0.0
    return True
