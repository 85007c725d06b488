"""FANUC's optional chamfer (``,C``) and corner rounding (``,R``) between two motions of the active plane."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TypeAlias

from gcode.compensation.planar import (
    SAME_POINT_MM,
    Segment,
    WorkingPlane,
    circle_circle,
    cross,
    dot,
    line_circle,
    swept,
    unit,
)
from gcode.control.waiting import CornerKind
from gcode.errors import GcodeError
from gcode.events import LinearMotion, Motion

Ends: TypeAlias = tuple[complex, complex]

#: Two directions that differ by no more than this have no corner: the motion inserted has no length.
SMOOTH_RAD = math.radians(1.0)
#: The words of a corner.
_WORDS: Mapping[str, str] = {"chamfer": ",C", "round": ",R"}
#: A corner may use up a straight motion; rounding of figures may then take this much more of it, mm.
_ROUNDING_MM = 1e-6


def insert_corner(first: Motion, second: Motion, kind: CornerKind, size_mm: float) -> tuple[Motion, Motion, Motion]:
    """Breaks the corner between two motions.

    A chamfer is a straight motion between the points at `size_mm` from the corner on both motions; a rounding is an
    arc of radius `size_mm` tangent to both. Where the directions at the corner agree within 1 degree the motion
    inserted has no length.

    Args:
        first: the motion whose block has the word ``,C`` or ``,R``.
        second: the motion of the next block, from the end of `first`.
        kind: ``chamfer``, between straight motions only, or ``round``.
        size_mm: the word's value, mm, above 0.

    Returns:
        The first motion shortened, the corner's motion with the first one's place and feed, the second shortened.

    Raises:
        GcodeError: ``corner-size`` for a size not above 0; ``corner-motion`` with a rapid motion (alarm
            PS0052); ``corner-plane`` where the two are not in one plane or leave it; ``corner-no-motion`` where one
            does not move (PS0051); ``corner-tangent`` where the path reverses; ``corner-arc-chamfer`` for a
            chamfer at an arc; ``corner-too-large`` where a motion is too short for it (PS0055).
    """
    if not (math.isfinite(size_mm) and size_mm > 0.0):
        raise _error(first, "corner-size", f"{_WORDS[kind]}{size_mm:g}", "a length above 0")
    frame = WorkingPlane(plane=first.state.plane)
    before, after = _segment(frame, first, first, kind), _segment(frame, second, first, kind)
    if kind == "chamfer" and (before.centre is not None or after.centre is not None):
        raise _error(first, "corner-arc-chamfer", ",C at an arc", "G1 before and after it, or ,R")
    corner, height = before.end, frame.height(first.end_mm)
    if _smooth(before, after, kind):
        return first, frame.line(first, corner, corner, height), second
    start, end = _ENDS[kind](before, after, size_mm)
    if kind == "chamfer":
        joint: Motion = frame.line(first, start, end, height)
    else:
        turns = 1 if cross(before.direction_out, after.direction_in) > 0.0 else -1
        centre = start + 1j * turns * size_mm * before.direction_at(start)
        joint = frame.arc(first, (start, end), centre, turns, height)
    shortened = frame.motion(replace(before, end=start)), frame.motion(replace(after, start=end))
    return shortened[0], joint, shortened[1]


def _segment(frame: WorkingPlane, motion: Motion, first: Motion, kind: CornerKind) -> Segment:
    """`motion` projected onto the plane, after the check that a corner can be next to it."""
    word = _WORDS[kind]
    if motion.state.plane != frame.plane:
        problem = f"{word} between motions of the planes G{frame.plane} and G{motion.state.plane}"
        raise _error(first, "corner-plane", problem, "both motions in one plane")
    if isinstance(motion, LinearMotion) and motion.rapid:
        raise _error(first, "corner-motion", f"{word} with a rapid motion", "G1, G2 or G3 before and after it")
    rise = frame.height(motion.end_mm) - frame.height(motion.start_mm)
    if abs(rise) > SAME_POINT_MM:
        problem = f"{word} with a motion that leaves the plane G{frame.plane} by {rise:.4f} mm"
        raise _error(first, "corner-plane", problem, "motions in the plane")
    segment = frame.segment(motion)
    if not segment.moves:
        raise _error(first, "corner-no-motion", f"{word} with a block without motion in the plane", "a motion")
    return segment


def _smooth(before: Segment, after: Segment, kind: CornerKind) -> bool:
    """Whether the path continues without a corner; a path that reverses is refused."""
    d1, d2 = before.direction_out, after.direction_in
    angle = math.atan2(abs(cross(d1, d2)), dot(d1, d2))
    if math.pi - angle <= SMOOTH_RAD:
        problem = f"{_WORDS[kind]} where the path turns back by {math.degrees(angle):.4f} degrees"
        raise _error(before.motion, "corner-tangent", problem, "a corner of less than 179 degrees")
    return angle <= SMOOTH_RAD


def _chamfer(before: Segment, after: Segment, size: float) -> Ends:
    for segment in (before, after):
        length = abs(segment.end - segment.start)
        if size > length + _ROUNDING_MM:
            raise _too_large(before, ",C", size, f"a motion of {length:.4f} mm")
    return before.end - size * before.direction_out, after.start + size * after.direction_in


def _round(before: Segment, after: Segment, size: float) -> Ends:
    """Where the arc tangent to both motions leaves the first and reaches the second, nearest to the corner."""
    side = 1.0 if cross(before.direction_out, after.direction_in) > 0.0 else -1.0
    found: list[tuple[float, Ends]] = []
    for centre in _centres(before, after, side * size):
        ends = _foot(before, centre), _foot(after, centre)
        if _reaches(before, ends[0]) and _reaches(after, ends[1]):
            found.append((abs(centre - before.end), ends))
    if not found:
        raise _too_large(before, ",R", size, "the two motions")
    return min(found, key=lambda item: item[0])[1]


def _centres(before: Segment, after: Segment, offset: float) -> tuple[complex, ...]:
    """The points at the signed distance `offset` from both motions, each extended in its own shape."""
    first, second = _offset_point(before, before.end, offset), _offset_point(after, after.start, offset)
    if before.centre is None and after.centre is None:
        d1, d2 = before.direction_out, after.direction_in
        return (first + d1 * cross(second - first, d2) / cross(d1, d2),)
    if before.centre is None and after.centre is not None:
        radius = _shifted_radius(after, after.start, after.centre, offset)
        return line_circle(first, before.direction_out, after.centre, radius) if radius > 0.0 else ()
    if before.centre is not None and after.centre is None:
        radius = _shifted_radius(before, before.end, before.centre, offset)
        return line_circle(second, after.direction_in, before.centre, radius) if radius > 0.0 else ()
    return _between_arcs(before, after, offset)


def _between_arcs(before: Segment, after: Segment, offset: float) -> tuple[complex, ...]:
    if before.centre is None or after.centre is None:
        return ()
    a = _shifted_radius(before, before.end, before.centre, offset)
    b = _shifted_radius(after, after.start, after.centre, offset)
    return circle_circle(before.centre, a, after.centre, b) if min(a, b) > 0.0 else ()


def _offset_point(segment: Segment, point: complex, offset: float) -> complex:
    return point + 1j * offset * segment.direction_at(point)


def _shifted_radius(segment: Segment, point: complex, centre: complex, offset: float) -> float:
    """Radius of the arc's parallel at `offset`; not above 0 where there is none."""
    return abs(point - centre) - (offset if segment.turns > 0 else -offset)


def _foot(segment: Segment, centre: complex) -> complex:
    """Point of contact of a circle about `centre` with the extended motion."""
    if segment.centre is None:
        direction = segment.direction_in
        return segment.start + direction * dot(centre - segment.start, direction)
    return segment.centre + abs(segment.start - segment.centre) * unit(centre - segment.centre)


def _reaches(segment: Segment, point: complex) -> bool:
    """Whether `point` lies on the motion. It may use up a straight motion, but must leave part of an arc."""
    if segment.centre is None:
        along = dot(point - segment.start, segment.direction_in)
        return -_ROUNDING_MM <= along <= abs(segment.end - segment.start) + _ROUNDING_MM
    angle = abs(swept(segment.start, point, segment.centre, 1 if segment.turns > 0 else -1))
    least = _ROUNDING_MM / abs(segment.start - segment.centre)
    return least < angle < abs(segment.sweep_rad) - least


def _too_large(before: Segment, word: str, size: float, what: str) -> GcodeError:
    problem = f"{word}{size:g}: a corner of {size:.4f} mm does not fit on {what}"
    return _error(before.motion, "corner-too-large", problem, "a smaller size or longer motions")


def _error(motion: Motion, code: str, problem: str, expected: str) -> GcodeError:
    return GcodeError(motion.place, code, problem, expected)


_ENDS: Mapping[CornerKind, Callable[[Segment, Segment, float], Ends]] = {"chamfer": _chamfer, "round": _round}
