"""Blocks of straight motions and arcs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from gcode.events import NO_EXTRA, PLANE_AXES, ArcMotion, LinearMotion, Motion
from gcode.write.control_memory import ControlMemory, EventStream
from gcode.write.length_offsets import check_gap, set_length
from gcode.write.machine_functions import ready
from gcode.write.numbers import Counts, plain
from gcode.write.strokes import Circle, Line, Stroke, arc_strokes
from gcode.write.taps import tap_blocks, tap_of

_AXES = "XYZ"
_CENTRE = "IJK"
#: Digits after the point of feeds, by unit.
_FEED_DECIMALS: Mapping[str, int] = {"mm": 3, "inch": 5}


def motion(control: ControlMemory, event: Motion, stream: EventStream) -> Iterator[str]:
    """Blocks of one motion, or of a tap, which is several.

    Raises:
        WriteError: for one that cannot be written, or that does not begin where the last one ended.
    """
    _check(control, event)
    own: list[str] = []
    in_block: list[str] = []
    if event.state is control.state:
        check_gap(control, event)
    else:
        yield from ready(control, event, event.state)
        own, in_block = set_length(control, event)
        control.state = event.state
    if control.at is None:
        control.at = control.grid.point(event.start_mm)
    if isinstance(event, LinearMotion) and event.tapping:
        control.state = None  # the cycle turns the spindle both ways
        yield from (control.line(*words) for words in (own, in_block) if words)
        yield from tap_blocks(control, event, tap_of(control, event, stream), feed_word(control, event))
        return
    if own:
        yield control.line(*own)
    for stroke in _strokes(control, event):
        yield control.line(*in_block, *_words(control, event, stroke))
        control.at, control.unsure, in_block = stroke.end, False, []
    control.at_mm = event.end_mm


def feed_word(control: ControlMemory, event: Motion, stroke: Stroke | None = None) -> str:
    """F for a motion's feed; for a helix that of its arc, where that is what the control takes."""
    feed = event.feed_mm_min / control.grid.unit_mm
    if isinstance(stroke, Circle) and control.options.dialect.helix_feed_along_arc:
        feed /= stroke.climb
    return f"F{plain(feed, _FEED_DECIMALS[control.options.units])}"


def _check(control: ControlMemory, event: Motion) -> None:
    """Refuses a motion of which no block can be made."""
    points = [event.start_mm, event.end_mm, *([event.centre_mm] if isinstance(event, ArcMotion) else [])]
    if not all(math.isfinite(value) for point in points for value in point):
        problem = f"a motion from {event.start_mm} to {event.end_mm}"
        raise control.error(event, "bad-value", problem, "finite lengths")
    if event.extra != NO_EXTRA:
        raise control.error(event, "further-axes", f"further axes at {event.extra}", "motions in x, y and z")
    if isinstance(event, LinearMotion) and event.rapid:
        return
    if not math.isfinite(event.feed_mm_min) or float(feed_word(control, event)[1:]) <= 0.0:
        expected = f"a finite feed that is not 0 in {_FEED_DECIMALS[control.options.units]} decimals"
        raise control.error(event, "bad-value", f"a feed of {event.feed_mm_min:g} mm/min", expected)


def _strokes(control: ControlMemory, event: Motion) -> Iterator[Stroke]:
    """The strokes of a motion. An arc whose start no word has named yet is led in by a straight feed to it."""
    if isinstance(event, LinearMotion):
        yield Line(control.grid.point(event.end_mm))
        return
    assert control.at is not None
    if control.unsure:
        yield Line(control.at)
    yield from arc_strokes(event, control.at, control.grid, control.options.dialect)


def _words(control: ControlMemory, event: Motion, stroke: Stroke) -> Iterator[str]:
    rapid = isinstance(event, LinearMotion) and event.rapid
    incremental = control.options.distance == "incremental" and not control.unsure
    yield from control.modal("distance", "G91" if incremental else "G90")
    if isinstance(stroke, Circle):
        yield from control.modal("plane", f"G{stroke.plane}")
        yield from _circle(control, stroke, incremental=incremental)
    else:
        yield from control.modal("motion", "G0" if rapid else "G1")
        yield from _axes(control, stroke.end, "", incremental=incremental)
    if not rapid:
        yield from control.modal("F", feed_word(control, event, stroke))


def _circle(control: ControlMemory, stroke: Circle, *, incremental: bool) -> Iterator[str]:
    i, j, _ = PLANE_AXES[stroke.plane]
    yield from control.modal("motion", "G3" if stroke.turns > 0 else "G2")
    by_radius = control.options.arcs == "radius" and stroke.radius is not None
    yield from _axes(control, stroke.end, _AXES[i] + _AXES[j], incremental=incremental)
    if by_radius:
        yield f"R{control.grid.text(stroke.radius or 0)}"
    else:
        for axis, count in sorted(zip((i, j), stroke.centre, strict=True)):
            yield f"{_CENTRE[axis]}{control.grid.text(count)}"
    if abs(stroke.turns) > 1:
        yield f"P{abs(stroke.turns)}"


def _axes(control: ControlMemory, end: Counts, needed: str, *, incremental: bool) -> Iterator[str]:
    """Axis words of a motion: those that change, those that are needed, and at least one."""
    assert control.at is not None
    if control.unsure or not control.options.modal:
        needed = _AXES
    elif not needed and end == control.at:
        needed = _AXES[0]
    for letter, before, after in zip(_AXES, control.at, end, strict=True):
        if before != after or letter in needed:
            yield f"{letter}{control.grid.text(after - before if incremental else after)}"
