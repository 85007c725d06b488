"""Motions as JSON objects, as `gcode motions` prints them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from gcode.errors import Call
from gcode.events import NO_EXTRA, ArcMotion, Dwell, Event, Extra, LinearMotion, MotionState, Point

#: Decimals of numbers: 1e-9 mm is far below any control's resolution, and hides the last digits of sums.
DECIMALS = 9


def motion_objects(events: Iterable[Event], start_mm: Point = (0.0, 0.0, 0.0)) -> Iterator[dict[str, Any]]:
    """The motions and dwells among events as JSON objects; other events are skipped.

    Args:
        events: of a program.
        start_mm: controlled point before the first motion, in machine coordinates; also of a dwell before it.

    Yields:
        `motion_object` of each.
    """
    at = start_mm
    for event in events:
        if isinstance(event, LinearMotion | ArcMotion):
            at = event.end_mm
        elif not isinstance(event, Dwell):
            continue
        yield motion_object(event, at)


def motion_object(event: LinearMotion | ArcMotion | Dwell, at_mm: Point) -> dict[str, Any]:
    """One motion or dwell as a JSON object.

    Args:
        event: a motion or dwell.
        at_mm: controlled point at its end.

    Returns:
        ``type`` (``rapid``, ``feed``, ``arc``, ``tap`` or ``dwell``), ``line``, ``end``, ``feed_mm_min`` (0 for
        rapids and dwells), the modal values that hold, arcs with ``plane``, ``centre`` and ``turns``, dwells with
        ``seconds``, ``abc`` and ``uvw`` where one of them is not 0, ``file``, ``column``, and ``calls`` in a call.
        Lengths are mm in machine coordinates.
    """
    state, place = event.state, event.place
    made: dict[str, Any] = {
        "type": type_of(event),
        "line": place.line,
        "end": _numbers(at_mm),
        "feed_mm_min": 0.0 if isinstance(event, Dwell) else _number(event.feed_mm_min),
        "tool": state.tool,
        "spindle_rpm": _number(state.spindle_rpm),
        "spindle_dir": state.spindle_direction,
        **_of_its_type(event),
        **modal_values(state, place.file, place.column, place.calls),
    }
    return made


def modal_values(state: MotionState, file: str, column: int, calls: Iterable[Call]) -> dict[str, Any]:
    """The last part of a motion's object: modal values, file and column, and the calls where there are any."""
    made: dict[str, Any] = {
        "feed_mode": state.feed_mode,
        "wcs": state.wcs,
        "h": state.length_number,
        "d": state.radius_number,
        "compensation": state.compensation,
        "file": file,
        "column": column,
    }
    if calls:
        made["calls"] = call_objects(calls)
    return made


def further_axes(extra: Extra) -> dict[str, Any]:
    """Positions of the further axes, where one is not 0."""
    further = {"abc": extra[:3], "uvw": extra[3:]}
    return {name: _numbers(values) for name, values in further.items() if any(values)}


def type_of(event: LinearMotion | ArcMotion | Dwell) -> str:
    """``rapid``, ``feed``, ``arc``, ``tap`` or ``dwell``."""
    if isinstance(event, LinearMotion):
        return "rapid" if event.rapid else "tap" if event.tapping else "feed"
    return "arc" if isinstance(event, ArcMotion) else "dwell"


def call_objects(calls: Iterable[Call]) -> list[dict[str, Any]]:
    """A call stack, the outermost call first."""
    return [{"program": call.program, "file": call.file, "line": call.line} for call in calls]


def _of_its_type(event: LinearMotion | ArcMotion | Dwell) -> dict[str, Any]:
    if isinstance(event, Dwell):
        return {"seconds": _number(event.seconds)}
    made: dict[str, Any] = {}
    if isinstance(event, ArcMotion):
        made |= {"plane": event.plane, "centre": _numbers(event.centre_mm), "turns": event.turns}
    return made if event.extra == NO_EXTRA else made | further_axes(event.extra)


def _number(value: float) -> float:
    """Rounded to `DECIMALS`, without a negative zero."""
    return round(value, DECIMALS) + 0.0


def _numbers(values: Iterable[float]) -> list[float]:
    return [round(value, DECIMALS) + 0.0 for value in values]
