"""Sections of a chain of sweeps, one after the other, by parallel planes: one strip for all of them; compiled.

The chain goes on in one direction along each axis, so that a line along a plane meets the union of its sweeps in one
piece. Coordinates are those of `twin.motion.swept_kernels`; a chord is a row (w, dw, u, du, v, dv).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells.strips import Strips
from twin.jit import helper, njit
from twin.motion.section_kernels import repeat_nodes
from twin.motion.swept_kernels import BodyShape, Motion, disc_upper, highest, lowest
from twin.tools.meridian_kernels import profile_height, profile_radius

_START_INTERVALS, _MAX_DEPTH, _NODE_FIELDS = 8, 7, 5
#: Sections that differ by less than this part of the tool's radius are the same but for rounding; so is their size.
_SAME_SECTION, _NO_SECTION = 1e-12, 1e-9
#: Nodes keep this part of half a section's width from its middle, for rounding.
_INSET = 1.0 - 1e-12
#: Columns of the sections of chords by a horizontal plane: two discs, each u, v, radius.
_U0, _V0, _R0, _U1, _V1, _R1 = range(6)


class ChainPlanes(NamedTuple):
    """Planes that cut a chain, and what of it need not be cut.

    Attributes:
        horizontal: whether the tool axis is their normal.
        first_w, pitch, planes: position of the first, their distance, mm, and their number.
        chord: how far a chord of lo or hi may deviate from its curve, mm.
        top: height above which there is no material; for vertical planes.
        start_is_cut, end_is_left: whether the body at the start has been cut already, and whether the body at the end
            is left to the sweep that comes next.
        band: height above the lower side up to which there may be material; inf if unknown.
    """

    horizontal: bool
    first_w: float
    pitch: float
    planes: int
    chord: float
    top: float
    start_is_cut: bool
    end_is_left: bool
    band: float


class _Node(NamedTuple):
    """A node of a strip: ``phi`` is the angle whose cosine places u in the section, from 0 to pi."""

    phi: float
    u: float
    lo: float
    hi: float
    fresh: bool


@njit
def chain_nodes(body: BodyShape, chords: FloatArray, planes: ChainPlanes, strips: Strips) -> int:
    """Strips of a chain of sweeps on consecutive planes, refined as those of one sweep.

    Args:
        chords: shape (n, 6), each beginning where the one before ends.
        strips: its arrays are filled.

    Returns:
        Number of nodes written, or -1 when they do not fit.
    """
    stack, sections = np.empty((_MAX_DEPTH + 2, _NODE_FIELDS)), np.empty((len(chords), 6))
    offsets, nodes, fresh = strips.offsets, strips.nodes, strips.fresh
    unchanged = _unchanged_above(body, chords, planes)
    written, offsets[0] = 0, 0
    for i in range(planes.planes):
        w = planes.first_w + i * planes.pitch
        if planes.horizontal and w >= unchanged:
            if planes.band < math.inf:
                pass
            elif i > 0 and w - planes.pitch >= unchanged and w <= _reached_by_all(body, chords):
                written = repeat_nodes(nodes, fresh, offsets[i - 1], written)
            else:
                written = _plane_nodes(body, chords, planes, w, sections, stack, strips, written)
        else:
            written = _plane_nodes(body, chords, planes, w, sections, stack, strips, written)
        if written < 0:
            return -1
        offsets[i + 1] = written
    return written


@helper
def _unchanged_above(body: BodyShape, chords: FloatArray, planes: ChainPlanes) -> float:
    """Height from which on horizontal sections have the tool's whole radius, also when the chain lies a band higher."""
    if not planes.horizontal or body.meridian.tangent > 0.0:
        return math.inf
    end = len(chords) - 1
    tip = max(chords[0, 0], chords[end, 0] + chords[end, 1])
    return tip + max(0.0, body.meridian.arc_height - body.drop) + (planes.band if planes.band < math.inf else 0.0)


@helper
def _reached_by_all(body: BodyShape, chords: FloatArray) -> float:
    """Height up to which the body reaches all along the chain."""
    end = len(chords) - 1
    return min(chords[0, 0], chords[end, 0] + chords[end, 1]) + body.meridian.height - body.drop


@helper
def _plane_nodes(
    body: BodyShape,
    chords: FloatArray,
    planes: ChainPlanes,
    w: float,
    sections: FloatArray,
    stack: FloatArray,
    strips: Strips,
    written: int,
) -> int:
    """Append the nodes of the plane ``w``; returns the number then, or -1 when they do not fit."""
    nodes, fresh = strips.nodes, strips.fresh
    if planes.horizontal:
        count = _disc_sections(body, chords, w, sections)
        low, high = _range_of_discs(sections, count)
    else:
        count = _vertical_sections(body, chords, w, sections)
        low, high = _range_of_chords(body, sections, count, w)
    half, middle = 0.5 * (high - low), 0.5 * (high + low)
    if not half > _NO_SECTION * body.meridian.radius:
        return written
    half *= _INSET
    first = written
    left = _node_at(body, chords, planes, sections[:count], w, middle, half, 0.0)
    written = _append_node(left, nodes, fresh, written)
    for piece in range(_START_INTERVALS):
        depth = 0
        phi = math.pi * (piece + 1) / _START_INTERVALS
        _push(stack, depth, _node_at(body, chords, planes, sections[:count], w, middle, half, phi))
        while depth >= 0:
            right = _node_of(stack, depth)
            between = _node_at(
                body, chords, planes, sections[:count], w, middle, half, 0.5 * (left.phi + right.phi)
            )
            if depth >= _MAX_DEPTH or _is_straight(left, between, right, planes.chord):
                written = _append_node(right, nodes, fresh, written)
                left = right
                depth -= 1
            else:
                depth += 1
                _push(stack, depth, between)
        if written < 0:
            return -1
    return written if written - first >= 2 else first


@helper
def _vertical_sections(body: BodyShape, chords: FloatArray, w: float, sections: FloatArray) -> int:
    """Copy the chords that reach a vertical plane, those that reach lowest first; returns their number."""
    radius, n, m = body.meridian.radius, 0, len(chords)
    down = chords[m - 1, 4] + chords[m - 1, 5] <= chords[0, 4]
    for k in range(m):
        i = m - 1 - k if down else k
        begin, end = chords[i, 0], chords[i, 0] + chords[i, 1]
        if min(begin, end) - radius <= w <= max(begin, end) + radius:
            sections[n] = chords[i]
            n += 1
    return n


@helper
def _motion(row: FloatArray) -> Motion:
    return Motion(row[0], row[1], row[2], row[3], row[4], row[5])


@helper
def _range_of_chords(body: BodyShape, sections: FloatArray, count: int, w: float) -> tuple[float, float]:
    """Extent along u of the chain's section by a vertical plane; empty when first > last."""
    radius, low, high = body.meridian.radius, math.inf, -math.inf
    for k in range(count):
        m = _motion(sections[k])
        low = min(low, -disc_upper(m.w, m.dw, -m.u, -m.du, radius, w, 0.0, 1.0))
        high = max(high, disc_upper(m.w, m.dw, m.u, m.du, radius, w, 0.0, 1.0))
    return low, high


@helper
def _disc_sections(body: BodyShape, chords: FloatArray, z: float, sections: FloatArray) -> int:
    """Sections of the chords at a height, each as the discs at its two ends; returns their number."""
    tool, n = body.meridian, 0
    for i in range(len(chords)):
        tip, dz = chords[i, 0], chords[i, 1]
        first, last = _times_between(tip, dz, z - tool.height + body.drop, z)
        if first > last:
            continue
        for e, t in enumerate((first, last)):
            sections[n, 3 * e] = chords[i, 2] + t * chords[i, 3]
            sections[n, 3 * e + 1] = chords[i, 4] + t * chords[i, 5]
            height = min(max(0.0, z - tip - t * dz + body.drop), tool.height)
            sections[n, 3 * e + 2] = profile_radius(tool, height)
        n += 1
    return n


@helper
def _times_between(tip: float, dz: float, low: float, high: float) -> tuple[float, float]:
    """Interval of t in [0, 1] with low <= tip + t dz <= high; empty when first > last."""
    if dz == 0.0:
        return (0.0, 1.0) if low <= tip <= high else (1.0, 0.0)
    a, b = (low - tip) / dz, (high - tip) / dz
    return max(0.0, min(a, b)), min(1.0, max(a, b))


@helper
def _range_of_discs(sections: FloatArray, count: int) -> tuple[float, float]:
    """Extent along u of the sections at a height; empty when first > last."""
    low, high = math.inf, -math.inf
    for k in range(count):
        low = min(low, sections[k, _U0] - sections[k, _R0], sections[k, _U1] - sections[k, _R1])
        high = max(high, sections[k, _U0] + sections[k, _R0], sections[k, _U1] + sections[k, _R1])
    return low, high


@helper
def _node_at(
    body: BodyShape,
    chords: FloatArray,
    planes: ChainPlanes,
    sections: FloatArray,
    w: float,
    middle: float,
    half: float,
    phi: float,
) -> _Node:
    """The node of a section at an angle."""
    u = middle - half * math.cos(phi)
    if planes.horizontal:
        lo, hi = -_discs_upper(sections, u, -1.0), _discs_upper(sections, u, 1.0)
    else:
        lo, hi = _envelope(body, sections, w, u, planes.top)
        hi = min(hi, lo + planes.band)
    fresh = True
    end = len(chords) - 1
    if planes.start_is_cut:
        c = chords[0]
        fresh = _beyond(body, planes, Motion(c[0], 0.0, c[2], 0.0, c[4], 0.0), w, u, lo, hi)
    if fresh and planes.end_is_left:
        c = chords[end]
        at = Motion(c[0] + c[1], 0.0, c[2] + c[3], 0.0, c[4] + c[5], 0.0)
        fresh = _beyond(body, planes, at, w, u, lo, hi)
    return _Node(phi, u, lo, hi, fresh)


@helper
def _envelope(body: BodyShape, sections: FloatArray, w: float, u: float, top: float) -> tuple[float, float]:
    """The lowest and the highest point of several sweeps at (w, u); (inf, -inf) where there is none."""
    tool = body.meridian
    lo, hi = math.inf, -math.inf
    for k in range(len(sections)):
        m = _motion(sections[k])
        distance = _distance_to(m, w, u)
        if distance > tool.radius:
            continue
        lowest_tip = m.v + min(0.0, m.dv)
        if max(lowest_tip, lowest_tip - body.drop + profile_height(tool, distance)) < lo:
            lo = min(lo, max(lowest(body, m, w, u), lowest_tip))
        least = lowest_tip - body.drop + tool.height
        hi = max(hi, least if least >= top else highest(body, m, w, u))
    return lo, hi


@helper
def _distance_to(m: Motion, w: float, u: float) -> float:
    """Distance of a plan point from the line of a motion, a little less for rounding."""
    ew, eu = w - m.w, u - m.u
    square = m.dw * m.dw + m.du * m.du
    t = 0.0
    if square > 0.0:
        t = min(1.0, max(0.0, (ew * m.dw + eu * m.du) / square))
    return math.hypot(ew - t * m.dw, eu - t * m.du) * _INSET


@helper
def _discs_upper(sections: FloatArray, u: float, sense: float) -> float:
    """Largest v times ``sense`` at u of the hulls of pairs of discs; -inf where there is none."""
    best = -math.inf
    for k in range(len(sections)):
        u0, v0, r0 = sections[k, _U0], sense * sections[k, _V0], sections[k, _R0]
        u1, v1, r1 = sections[k, _U1], sense * sections[k, _V1], sections[k, _R1]
        if max(v0 + r0, v1 + r1) <= best:
            continue
        rest0, rest1 = r0 * r0 - (u - u0) * (u - u0), r1 * r1 - (u - u1) * (u - u1)
        if rest0 >= 0.0:
            best = max(best, v0 + math.sqrt(rest0))
        if rest1 >= 0.0:
            best = max(best, v1 + math.sqrt(rest1))
        du, dv, grown = u1 - u0, v1 - v0, r1 - r0
        square = du * du + dv * dv
        if square > grown * grown:
            # the line that touches both discs from above: its normal (nu, nv)
            across = math.sqrt(square - grown * grown)
            right = 1.0 if du > 0.0 else -1.0
            nu, nv = (-grown * du - right * across * dv) / square, (-grown * dv + right * across * du) / square
            ua, ub = u0 + r0 * nu, u1 + r1 * nu
            if nv > 0.0 and ua != ub and min(ua, ub) <= u <= max(ua, ub):
                va, vb = v0 + r0 * nv, v1 + r1 * nv
                best = max(best, va + (vb - va) * ((u - ua) / (ub - ua)))
    return best


@helper
def _beyond(
    body: BodyShape, planes: ChainPlanes, at: Motion, w: float, u: float, lo: float, hi: float
) -> bool:
    """Whether a section reaches beyond that of the body at rest, below the top of the material."""
    if not lo <= hi:
        return True
    same = _SAME_SECTION * body.meridian.radius
    if planes.horizontal:
        height = w - at.w + body.drop
        if w < at.w or height > body.meridian.height:
            return True
        radius = profile_radius(body.meridian, height)
        rest = radius * radius - (u - at.u) * (u - at.u)
        if rest < 0.0:
            return True
        root = math.sqrt(rest)
        return lo < at.v - root - same or hi > at.v + root + same
    lo_there, hi_there = max(lowest(body, at, w, u), at.v), highest(body, at, w, u)
    if not lo_there <= hi_there:
        return True
    return lo < lo_there - same or min(hi, planes.top) > min(hi_there, planes.top) + same


@helper
def _append_node(node: _Node, nodes: FloatArray, fresh: NDArray[np.bool_], written: int) -> int:
    """Append a node unless its section is empty; returns the number of nodes then, or -1 when they do not fit."""
    if written < 0 or not node.lo <= node.hi:
        return written
    if written >= len(nodes):
        return -1
    nodes[written, 0], nodes[written, 1], nodes[written, 2] = node.u, node.lo, node.hi
    fresh[written] = node.fresh
    return written + 1


@helper
def _push(stack: FloatArray, depth: int, node: _Node) -> None:
    stack[depth, 0], stack[depth, 1], stack[depth, 2], stack[depth, 3] = node.phi, node.u, node.lo, node.hi
    stack[depth, 4] = 1.0 if node.fresh else 0.0


@helper
def _node_of(stack: FloatArray, depth: int) -> _Node:
    return _Node(stack[depth, 0], stack[depth, 1], stack[depth, 2], stack[depth, 3], stack[depth, 4] > 0.0)


@helper
def _is_straight(left: _Node, middle: _Node, right: _Node, chord: float) -> bool:
    """Whether lo and hi need no node between two, judged by one in the middle."""
    if not (left.fresh or right.fresh or middle.fresh):
        return True
    if not (left.lo <= left.hi and right.lo <= right.hi and middle.lo <= middle.hi):
        return True
    return (
        _off_chord(middle.u, middle.lo, left.u, left.lo, right.u, right.lo) <= chord
        and _off_chord(middle.u, middle.hi, left.u, left.hi, right.u, right.hi) <= chord
    )


@helper
def _off_chord(u: float, v: float, ua: float, va: float, ub: float, vb: float) -> float:
    """Distance of a point from the chord between two others."""
    du, dv = ub - ua, vb - va
    length = math.hypot(du, dv)
    if length == 0.0:
        return math.hypot(u - ua, v - va)
    return abs((u - ua) * dv - (v - va) * du) / length
