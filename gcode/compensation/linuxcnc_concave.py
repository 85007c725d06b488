"""Intersection of two offset paths in a concave corner, as LinuxCNC chooses it; the tool is on the left."""

from __future__ import annotations

import cmath
import math

from gcode.compensation.interface import gouge
from gcode.compensation.planar import Segment, dot, unit


def meeting_point(before: Segment, segment: Segment, corner: complex, centre: complex, radius: float) -> complex:
    """The point at which the tool touches both sides of a concave corner.

    Args:
        before: the motion of the tool's centre to the corner, to be ended at this point.
        segment: the programmed motion that leaves the corner.
        corner: the programmed corner.
        centre: the tool's centre at the end of `before`.
        radius: the tool's radius, mm.

    Raises:
        GcodeError: ``compensation-gouge`` where there is none.
    """
    forward = unit((centre - corner) / 1j)
    if segment.centre is None:
        if before.centre is None:
            return _line_line(segment, centre, forward, radius)
        return _arc_line(before, before.centre, segment, corner, radius)
    if before.centre is None:
        return _line_arc(segment, segment.centre, forward, radius)
    return _arc_arc((before, before.centre), (segment, segment.centre), radius)


def _line_line(segment: Segment, centre: complex, forward: complex, radius: float) -> complex:
    half = (cmath.phase(segment.direction_in / forward) - math.pi) / 2.0
    return centre + forward * radius / math.tan(half)


def _arc_line(before: Segment, centre: complex, segment: Segment, corner: complex, radius: float) -> complex:
    """The point of the shifted arc at the tool's radius from the line."""
    shifted = abs(before.end - centre)
    inside = before.turns > 0
    across = segment.direction_in * (1j if inside else -1j)
    arc = shifted + radius if inside else shifted - radius
    depth = arc * dot(across, unit(centre - corner)) + (-radius if inside else radius)
    share = _share(depth / shifted, segment, radius, "the tool does not fit between the arc and the straight motion")
    return centre - shifted * across * cmath.exp(-1j * math.acos(share))


def _line_arc(segment: Segment, centre: complex, forward: complex, radius: float) -> complex:
    """The point of the line's shifted path at the shifted arc's radius from its centre."""
    inside = segment.turns > 0
    arc = abs(segment.end - centre)
    height = -arc * dot(segment.direction_in, forward)
    depth, shifted = (height + radius, arc - radius) if inside else (height - radius, arc + radius)
    share = _share(depth / shifted, segment, radius, "the arc in a concave corner cannot be reached")
    towards = forward if inside else -forward
    return centre + shifted * towards * cmath.exp(1j * math.asin(share))


def _arc_arc(before: tuple[Segment, complex], after: tuple[Segment, complex], radius: float) -> complex:
    """The point common to both shifted arcs; each arc comes with its centre."""
    (first, a), (second, b) = before, after
    old, between, arc = abs(first.end - a), abs(b - a), abs(second.end - b)
    new = arc - radius if second.turns > 0 else arc + radius
    if old == 0.0 or between == 0.0:
        raise gouge(second, radius, "two arcs about one centre have no corner")
    share = (old * old + between * between - new * new) / (2.0 * old * between)
    back = math.acos(_share(share, second, radius, "the tool does not fit between the two arcs"))
    side = 1.0 if first.turns * second.turns > 0 else -1.0
    return a + old * unit(b - a) * cmath.exp(1j * side * back)


def _share(share: float, segment: Segment, radius: float, why: str) -> float:
    if not -1.0 <= share <= 1.0:
        raise gouge(segment, radius, why)
    return share
