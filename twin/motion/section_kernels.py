"""Sections of a convex tool, swept along a straight line, by parallel planes; compiled.

Coordinates are those of `twin.motion.swept_kernels`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from twin.arrays import FloatArray
from twin.geometry.column_cells.strips import Strips, Tops
from twin.jit import helper, njit
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
from twin.motion.swept_kernels import BodyShape, Motion, disc_upper, highest, lowest, reach, side, upside_down


class Planes(NamedTuple):
    """Planes that cut a sweep, and how closely.

    Attributes:
        horizontal: whether the tool axis is their normal.
        first_w, pitch, planes: position of the first, their distance, mm, and their number.
        chord: how far a chord of lo or hi may deviate from its curve, mm.
        start_is_cut: the body's volume at the start has been cut already. Then nodes where the section is no more than
            that of the body there are not fresh, and no chords are refined between them: they cut nothing new.
        top: height above which there is no material; for vertical planes.
    """

    horizontal: bool
    first_w: float
    pitch: float
    planes: int
    chord: float
    start_is_cut: bool
    top: float


class _Section(NamedTuple):
    """One plane's section: u runs ``half`` to either side of ``middle`` on the plane ``w``."""

    w: float
    middle: float
    half: float


@njit
def section_nodes(body: BodyShape, motion: Motion, planes: Planes, tops: Tops, strips: Strips) -> int:
    """Strips of a swept body on consecutive planes.

    Intervals are halved until no chord of lo or hi deviates from its curve by more than the chord tolerance, evenly in
    the angle whose cosine is u, which follows a round section's vertical ends.

    Args:
        tops: heights of the material on these planes, or none; vertical planes only. Where there is no material in the
            way, no chords are refined and nodes are not fresh.
        strips: its arrays are filled.

    Returns:
        Number of nodes written, or -1 when they do not fit.
    """
    stack = np.empty((MAX_DEPTH + 2, NODE_FIELDS))
    offsets, nodes, fresh = strips.offsets, strips.nodes, strips.fresh
    written = 0
    offsets[0] = 0
    for i in range(planes.planes):
        w = planes.first_w + i * planes.pitch
        if i > 0 and len(tops.heights) == 0 and _same_as_before(body, motion, planes, w):
            written = repeat_nodes(nodes, fresh, offsets[i - 1], written)
        else:
            written = _plane_nodes(body, motion, planes, tops, i, stack, strips, written)
        if written < 0:
            return -1
        offsets[i + 1] = written
    return written


@helper
def _same_as_before(body: BodyShape, motion: Motion, planes: Planes, w: float) -> bool:
    """Whether a plane's section is that of the plane before: the whole tool passes straight through both.

    Horizontal planes: both meet the cylindrical wall all the time.
    """
    tool = body.meridian
    if planes.horizontal:
        lowest_base = motion.w - body.drop + min(0.0, motion.dw)
        highest_base = motion.w - body.drop + max(0.0, motion.dw)
        wall_from = highest_base + tool.arc_height + SAME_SECTION * tool.radius
        return tool.tangent == 0.0 and w - planes.pitch >= wall_from and w <= lowest_base + tool.height
    if motion.du != 0.0 or motion.dv != 0.0:
        return False
    passed_from = min(motion.w, motion.w + motion.dw) + body.meridian.radius
    passed_to = max(motion.w, motion.w + motion.dw) - body.meridian.radius
    return w - planes.pitch >= passed_from and w <= passed_to


@helper
def _plane_nodes(
    body: BodyShape,
    motion: Motion,
    planes: Planes,
    tops: Tops,
    i: int,
    stack: FloatArray,
    strips: Strips,
    written: int,
) -> int:
    """Append the nodes of plane ``i``; returns the number then, or -1 when they do not fit."""
    nodes, fresh = strips.nodes, strips.fresh
    known = len(tops.heights) > 0
    w = planes.first_w + i * planes.pitch
    low, high = _range_of_u(body, planes.horizontal, motion, w)
    half = 0.5 * (high - low)
    if not half > NO_SECTION * body.meridian.radius:
        return written
    section = _Section(w, 0.5 * (high + low), half * INSET)
    first = written
    flat_v = _flat_bottom(body, motion, planes.horizontal)
    left = _node_at(body, motion, planes, section, 0.0)
    written = append_node(left, nodes, fresh, written)
    clear_before, all_clear = known, known
    for piece in range(START_INTERVALS):
        depth = 0
        push_node(stack, depth, _node_at(body, motion, planes, section, math.pi * (piece + 1) / START_INTERVALS))
        while depth >= 0:
            right = node_of(stack, depth)
            middle = _node_at(body, motion, planes, section, 0.5 * (left.phi + right.phi))
            clear = known and _is_clear(tops, i, left, middle, right, SAME_SECTION * body.meridian.radius)
            if clear or depth >= MAX_DEPTH or _is_straight(left, middle, right, planes.chord, flat_v):
                if clear and clear_before and written > first and left.lo <= left.hi:
                    fresh[written - 1] = False
                clear_before, all_clear = clear, all_clear and clear
                written = append_node(right, nodes, fresh, written)
                left = right
                depth -= 1
            else:
                depth += 1
                push_node(stack, depth, middle)
        if written < 0:
            return -1
    if clear_before and written > first and left.lo <= left.hi:
        fresh[written - 1] = False
    return written if written - first >= 2 and not all_clear else first


@helper
def _is_clear(tops: Tops, i: int, left: Node, middle: Node, right: Node, same: float) -> bool:
    """Whether there is no material between two nodes on plane ``i`` above the strip's lower side, which is convex.

    That lies above the lines through the middle and either end, prolonged.
    """
    du0, du1 = middle.u - left.u, right.u - middle.u
    if du0 <= 0.0 or du1 <= 0.0 or not (left.lo <= left.hi and middle.lo <= middle.hi and right.lo <= right.hi):
        return False
    at_left = middle.lo - (right.lo - middle.lo) / du1 * du0
    at_right = middle.lo + (middle.lo - left.lo) / du0 * du1
    bound = min(middle.lo, at_left, at_right) + same
    heights = tops.heights
    first = max(0, int(math.floor((left.u - tops.u_low) / tops.size)))
    last = min(heights.shape[1] - 1, int(math.floor((right.u - tops.u_low) / tops.size)))
    highest_there = -math.inf
    for column in range(first, last + 1):
        highest_there = max(highest_there, heights[i, column])
    return highest_there <= bound


@helper
def _flat_bottom(body: BodyShape, motion: Motion, horizontal: bool) -> float:
    """Height up to which lo is on the body's flat bottom at the start; -inf where that makes no kink in lo."""
    if horizontal or body.meridian.disc == 0.0:
        return -math.inf
    return motion.v + max(0.0, -body.drop) + SAME_SECTION * body.meridian.radius


@helper
def _is_straight(left: Node, middle: Node, right: Node, chord: float, flat_v: float) -> bool:
    """Whether lo and hi need no node between two, judged by one in the middle.

    Between a node on the flat bottom and one beyond its kink the section may be fresh although it is at neither.
    """
    if not (left.fresh or right.fresh or middle.fresh):
        on_flat = left.lo <= flat_v
        if on_flat == (right.lo <= flat_v) and on_flat == (middle.lo <= flat_v):
            return True
    if not (left.lo <= left.hi and right.lo <= right.hi and middle.lo <= middle.hi):
        return True
    return (
        off_chord(middle.u, middle.lo, left.u, left.lo, right.u, right.lo) <= chord
        and off_chord(middle.u, middle.hi, left.u, left.hi, right.u, right.hi) <= chord
    )


@helper
def _node_at(body: BodyShape, motion: Motion, planes: Planes, section: _Section, phi: float) -> Node:
    """The node of a section at an angle."""
    u = section.middle - section.half * math.cos(phi)
    lo, hi = _strip_at(body, planes.horizontal, motion, section.w, u)
    fresh = not planes.start_is_cut or _is_new(body, motion, planes, section.w, u, lo, hi)
    return Node(phi, u, lo, hi, fresh)


@helper
def _is_new(body: BodyShape, motion: Motion, planes: Planes, w: float, u: float, lo: float, hi: float) -> bool:
    """Whether a section reaches beyond that of the body at rest at the start, below the top of the material."""
    if not lo <= hi:
        return True
    start = Motion(motion.w, 0.0, motion.u, 0.0, motion.v, 0.0)
    lo_start, hi_start = _strip_at(body, planes.horizontal, start, w, u)
    if not lo_start <= hi_start:
        return True
    if not planes.horizontal:
        hi, hi_start = min(hi, planes.top), min(hi_start, planes.top)
    same = SAME_SECTION * body.meridian.radius
    return lo < lo_start - same or hi > hi_start + same


@helper
def _strip_at(body: BodyShape, horizontal: bool, motion: Motion, w: float, u: float) -> tuple[float, float]:
    """The lo and hi of the section by the plane w at u; (inf, -inf) where there is none."""
    if horizontal:
        return -side(body, upside_down(motion), w, u), side(body, motion, w, u)
    lo = max(lowest(body, motion, w, u), motion.v + min(0.0, motion.dv))
    return lo, highest(body, motion, w, u)


@helper
def _range_of_u(body: BodyShape, horizontal: bool, motion: Motion, w: float) -> tuple[float, float]:
    """Extent of the section by the plane w along u; empty when first > last."""
    u, du = motion.u, motion.du
    if horizontal:
        if w < motion.w + min(0.0, motion.dw):
            return math.inf, -math.inf
        opposite = Motion(motion.w, motion.dw, -u, -du, motion.v, motion.dv)
        return -reach(body, opposite, w), reach(body, motion, w)
    radius = body.meridian.radius
    low = -disc_upper(motion.w, motion.dw, -u, -du, radius, w, 0.0, 1.0)
    return low, disc_upper(motion.w, motion.dw, u, du, radius, w, 0.0, 1.0)
