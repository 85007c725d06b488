"""Sections of a chain of sweeps, one after the other, by parallel planes: one strip for all of them; compiled.

The chain goes on in one direction along each axis, so that a line along a plane meets the union of its sweeps in one
piece. Coordinates are those of `twin.motion.swept_kernels`; a chord is a row (w, dw, u, du, v, dv).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from twin.arrays import FloatArray
from twin.geometry.column_cells.strips import Strips
from twin.jit import helper, njit
from twin.motion.disc_kernels import disc_parts, reached_by_all
from twin.motion.node_kernels import (
    INSET,
    MAX_DEPTH,
    NO_SECTION,
    NODE_FIELDS,
    SAME_SECTION,
    START_INTERVALS,
    Node,
    append_node,
    node_of,
    off_chord,
    push_node,
    repeat_nodes,
)
from twin.motion.swept_kernels import BodyShape, Motion, disc_upper, highest, lowest
from twin.tools.meridian_kernels import profile_height, profile_radius

#: Columns of the sections of chords by a horizontal plane: two discs, each u, v, radius.
_U0, _V0, _R0, _U1, _V1, _R1 = range(6)
#: Chords are looked at up to this part beyond the distance at which they can matter, for rounding.
_OUTSET = 1.0 + 1e-9
#: Columns of parts and blocks after those of a chord: one over the square of its length in plan, or 0; and how far the
#: chords of a block are off its line.
_PER_SQUARE, _BULGE = 6, 7
#: Intervals halved less often than this are judged by a second point.
_LOOK_TWICE = 3
#: Most discs by which the section of a chord is described.
_DISCS = 16
#: Chords in a block.
_BLOCK = 8


class _Section(NamedTuple):
    """One plane's section: u runs ``half`` to either side of ``middle`` on the plane ``w``.

    Attributes:
        parts: shape (n, 7), on a vertical plane the chords that reach it and their `_PER_SQUARE`; on a horizontal one
            the discs at the ends of each chord.
        blocks: shape (m, 8), lines from the start to the end of `_BLOCK` chords each, as a chord, their `_PER_SQUARE`,
            and how far the chords are off them; on vertical planes.
    """

    w: float
    middle: float
    half: float
    parts: FloatArray
    blocks: FloatArray


class ChainPlanes(NamedTuple):
    """Planes that cut a chain, and the parts of it that need not be cut.

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


@njit
def chain_nodes(body: BodyShape, chords: FloatArray, planes: ChainPlanes, strips: Strips) -> int:
    """Strips of a chain of sweeps on consecutive planes, refined as those of one sweep.

    Args:
        chords: shape (n, 6), each beginning where the one before ends.
        strips: its arrays are filled.

    Returns:
        Number of nodes written, or -1 when they do not fit.
    """
    stack, parts = np.empty((MAX_DEPTH + 2, NODE_FIELDS)), np.empty((2 * len(chords) + 4 * _DISCS, 8))
    offsets, nodes, fresh = strips.offsets, strips.nodes, strips.fresh
    unchanged = _unchanged_above(body, chords, planes)
    written, offsets[0] = 0, 0
    for i in range(planes.planes):
        w = planes.first_w + i * planes.pitch
        if planes.horizontal and w >= unchanged:
            if planes.band < math.inf:
                pass
            elif i > 0 and w - planes.pitch >= unchanged and w <= reached_by_all(body, chords):
                written = repeat_nodes(nodes, fresh, offsets[i - 1], written)
            else:
                written = _plane_nodes(body, chords, planes, w, parts, stack, strips, written)
        else:
            written = _plane_nodes(body, chords, planes, w, parts, stack, strips, written)
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
    return float(
        tip + max(0.0, body.meridian.arc_height - body.drop) + (planes.band if planes.band < math.inf else 0.0)
    )


@helper
def _plane_nodes(
    body: BodyShape,
    chords: FloatArray,
    planes: ChainPlanes,
    w: float,
    room: FloatArray,
    stack: FloatArray,
    strips: Strips,
    written: int,
) -> int:
    """Append the nodes of the plane ``w``; returns the number then, or -1 when they do not fit."""
    nodes, fresh = strips.nodes, strips.fresh
    section = _section(body, chords, planes, w, room)
    if not section.half > NO_SECTION * body.meridian.radius:
        return written
    first = written
    left = _node_at(body, chords, planes, section, 0.0)
    written = append_node(left, nodes, fresh, written)
    for piece in range(START_INTERVALS):
        depth = 0
        phi = math.pi * (piece + 1) / START_INTERVALS
        push_node(stack, depth, _node_at(body, chords, planes, section, phi))
        while depth >= 0:
            right = node_of(stack, depth)
            between = _node_at(body, chords, planes, section, 0.5 * (left.phi + right.phi))
            straight = _is_straight(left, between, right, planes.chord)
            if straight and depth < _LOOK_TWICE:
                # a curve that bends to both sides may cross its chord in the middle
                quarter = _node_at(body, chords, planes, section, 0.75 * left.phi + 0.25 * right.phi)
                straight = _is_straight(left, quarter, right, planes.chord)
            if depth >= MAX_DEPTH or straight:
                written = append_node(right, nodes, fresh, written)
                left = right
                depth -= 1
            else:
                depth += 1
                push_node(stack, depth, between)
        if written < 0:
            return -1
    return written if written - first >= 2 else first


@helper
def _section(body: BodyShape, chords: FloatArray, planes: ChainPlanes, w: float, room: FloatArray) -> _Section:
    """The section by a plane, its parts and blocks in ``room``."""
    if planes.horizontal:
        count = disc_parts(body, chords, w, planes.chord, _DISCS, room)
        low, high = _range_of_discs(room, count)
        blocks = 0
    else:
        count = _vertical_parts(body, chords, w, room)
        low, high = _range_of_chords(body, room, count, w)
        blocks = _make_blocks(room, count)
    return _Section(w, 0.5 * (high + low), 0.5 * (high - low) * INSET, room[:count], room[count : count + blocks])


@helper
def _vertical_parts(body: BodyShape, chords: FloatArray, w: float, parts: FloatArray) -> int:
    """Copy the chords that reach a vertical plane, those that reach lowest first; returns their number."""
    radius, n, m = body.meridian.radius, 0, len(chords)
    down = chords[m - 1, 4] + chords[m - 1, 5] <= chords[0, 4]
    for k in range(m):
        i = m - 1 - k if down else k
        begin, end = chords[i, 0], chords[i, 0] + chords[i, 1]
        if min(begin, end) - radius <= w <= max(begin, end) + radius:
            parts[n, :_PER_SQUARE] = chords[i]
            parts[n, _PER_SQUARE] = _per_square(chords[i, 1], chords[i, 3])
            n += 1
    return n


@helper
def _per_square(dw: float, du: float) -> float:
    square = dw * dw + du * du
    return 1.0 / square if square > 0.0 else 0.0


@helper
def _make_blocks(room: FloatArray, count: int) -> int:
    """Write the blocks of parts after them; returns their number."""
    n = 0
    for first in range(0, count, _BLOCK):
        last = min(first + _BLOCK, count) - 1
        # parts follow each other forwards or backwards
        back = first < last and room[first + 1, 0] + room[first + 1, 1] == room[first, 0]
        back = back and room[first + 1, 2] + room[first + 1, 3] == room[first, 2]
        head, tail = (last, first) if back else (first, last)
        row = room[count + n]
        row[0], row[2] = room[head, 0], room[head, 2]
        row[1] = room[tail, 0] + room[tail, 1] - row[0]
        row[3] = room[tail, 2] + room[tail, 3] - row[2]
        row[_PER_SQUARE] = _per_square(row[1], row[3])
        bulge = 0.0
        for k in range(first, last + 1):
            bulge = max(bulge, _distance2_to(room, count + n, room[k, 0], room[k, 2]))
            bulge = max(bulge, _distance2_to(room, count + n, room[k, 0] + room[k, 1], room[k, 2] + room[k, 3]))
        row[_BULGE] = math.sqrt(bulge)
        n += 1
    return n


@helper
def _motion(row: FloatArray) -> Motion:
    return Motion(row[0], row[1], row[2], row[3], row[4], row[5])


@helper
def _range_of_chords(body: BodyShape, parts: FloatArray, count: int, w: float) -> tuple[float, float]:
    """Extent along u of the chain's section by a vertical plane; empty when first > last."""
    radius, low, high = body.meridian.radius, math.inf, -math.inf
    for k in range(count):
        m = _motion(parts[k])
        low = min(low, -disc_upper(m.w, m.dw, -m.u, -m.du, radius, w, 0.0, 1.0))
        high = max(high, disc_upper(m.w, m.dw, m.u, m.du, radius, w, 0.0, 1.0))
    return low, high


@helper
def _range_of_discs(parts: FloatArray, count: int) -> tuple[float, float]:
    """Extent along u of the parts at a height; empty when first > last."""
    low, high = math.inf, -math.inf
    for k in range(count):
        low = min(low, parts[k, _U0] - parts[k, _R0], parts[k, _U1] - parts[k, _R1])
        high = max(high, parts[k, _U0] + parts[k, _R0], parts[k, _U1] + parts[k, _R1])
    return low, high


@helper
def _node_at(body: BodyShape, chords: FloatArray, planes: ChainPlanes, section: _Section, phi: float) -> Node:
    """The node of a section at an angle."""
    w, u = section.w, section.middle - section.half * math.cos(phi)
    if planes.horizontal:
        lo, hi = -_discs_upper(section.parts, u, -1.0), _discs_upper(section.parts, u, 1.0)
    else:
        lo, hi = _envelope(body, section, u, planes.top)
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
    return Node(phi, u, lo, hi, fresh)


@helper
def _envelope(body: BodyShape, section: _Section, u: float, top: float) -> tuple[float, float]:
    """The lowest and the highest point of several sweeps at u of a section; (inf, -inf) where there is none.

    Sweeps too far away to reach below the lowest point that is known are left out, the nearest come first.
    """
    tool, parts, blocks = body.meridian, section.parts, section.blocks
    tip = _lowest_tip(parts)
    lo, near, nearest, least = math.inf, tool.radius, -1, math.inf
    for b in range(len(blocks)):
        distance2 = _distance2_to(blocks, b, section.w, u)
        if distance2 < least:
            nearest, least = b, distance2
    if nearest >= 0:
        lo, near = _lowest_of_block(body, section, u, nearest, tip, lo, near)
    for b in range(len(blocks)):
        reach = near + blocks[b, _BULGE]
        if b != nearest and _distance2_to(blocks, b, section.w, u) <= reach * reach * _OUTSET:
            lo, near = _lowest_of_block(body, section, u, b, tip, lo, near)
    hi = tip - body.drop + tool.height
    if lo == math.inf:
        return math.inf, -math.inf
    if hi < top:
        for k in range(len(parts)):
            hi = max(hi, highest(body, _motion(parts[k]), section.w, u))
    return lo, hi


@helper
def _lowest_tip(parts: FloatArray) -> float:
    """Lowest tip on chords that go up or down throughout."""
    if len(parts) == 0:
        return math.inf
    a, b = parts[0], parts[len(parts) - 1]
    return float(min(a[4], a[4] + a[5], b[4], b[4] + b[5]))


@helper
def _lowest_of_block(
    body: BodyShape, section: _Section, u: float, block: int, tip: float, lo: float, near: float
) -> tuple[float, float]:
    """The lowest point of sweeps at u, and how far from the tool axis a lower one can only be.

    Args:
        tip: lowest of all tips.
        lo, near: so far.
    """
    tool, parts, w = body.meridian, section.parts, section.w
    for k in range(_BLOCK * block, min(_BLOCK * (block + 1), len(parts))):
        distance2 = _distance2_to(parts, k, w, u)
        if distance2 > near * near * _OUTSET:
            continue
        m = _motion(parts[k])
        lowest_tip = m.v + min(0.0, m.dv)
        if lowest_tip - body.drop + profile_height(tool, math.sqrt(distance2) * INSET) < lo:
            found = max(lowest(body, m, w, u), lowest_tip)
            if found < lo:
                lo = found
                near = min(near, profile_radius(tool, min(max(0.0, lo - tip + body.drop), tool.height)))
    return lo, near


@helper
def _distance2_to(parts: FloatArray, k: int, w: float, u: float) -> float:
    """Square of the distance of a plan point from the line of a chord."""
    ew, eu, dw, du = w - parts[k, 0], u - parts[k, 2], parts[k, 1], parts[k, 3]
    t = min(1.0, max(0.0, (ew * dw + eu * du) * parts[k, _PER_SQUARE]))
    ew -= t * dw
    eu -= t * du
    return float(ew * ew + eu * eu)


@helper
def _discs_upper(parts: FloatArray, u: float, sense: float) -> float:
    """Largest v times ``sense`` at u of the hulls of pairs of discs; -inf where there is none."""
    best = -math.inf
    for k in range(len(parts)):
        u0, v0, r0 = parts[k, _U0], sense * parts[k, _V0], parts[k, _R0]
        u1, v1, r1 = parts[k, _U1], sense * parts[k, _V1], parts[k, _R1]
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
def _beyond(body: BodyShape, planes: ChainPlanes, at: Motion, w: float, u: float, lo: float, hi: float) -> bool:
    """Whether a section reaches beyond that of the body at rest, below the top of the material."""
    if not lo <= hi:
        return True
    same = SAME_SECTION * body.meridian.radius
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
def _is_straight(left: Node, middle: Node, right: Node, chord: float) -> bool:
    """Whether lo and hi need no node between two, judged by one in the middle."""
    if not (left.fresh or right.fresh or middle.fresh):
        return True
    if not (left.lo <= left.hi and right.lo <= right.hi and middle.lo <= middle.hi):
        return True
    return (
        off_chord(middle.u, middle.lo, left.u, left.lo, right.u, right.lo) <= chord
        and off_chord(middle.u, middle.hi, left.u, left.hi, right.u, right.hi) <= chord
    )
