"""NC events to motion in the workpiece frame. Machine coordinates, gauge points and mm/min end here."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from gcode.errors import GcodeError
from gcode.events import (
    NO_EXTRA,
    ArcMotion,
    Dwell,
    Event,
    LinearMotion,
    Motion,
    MotionState,
    Point,
)
from twin.arrays import FloatArray
from twin.motion.path import Arc, Move, path_length_mm
from twin.motion.rapids import independent_legs


def moves_from_nc(
    events: Iterable[Event],
    *,
    origin_mm: FloatArray,
    start_mm: Point,
    tool_length_mm: Mapping[int, float],
    rapid_mm_min: float,
    axis_rapid_mm_min: FloatArray | None = None,
) -> Iterator[Move | Event]:
    """Turn motions and dwells into moves and pass all other events on.

    The tool tip is at the controlled point plus the active length offset less the tool's own length: with G43 and
    the right offset that is the controlled point itself, without it the tip is lower by the tool's length, as on the
    machine. Motions without length are omitted.

    Args:
        origin_mm: origin of the workpiece frame in machine coordinates, shape (3,).
        start_mm: gauge point when the program starts, machine coordinates; where a dwell before any motion is.
        tool_length_mm: gauge length of each tool by number; missing tools count as 0.
        rapid_mm_min: speed of positioning along a straight path.
        axis_rapid_mm_min: shape (3,), rates of axes that move independently in rapids; None where rapids are straight.

    Raises:
        GcodeError: for a motion with an axis other than X, Y and Z away from 0.
    """
    gauge = np.array(start_mm) - origin_mm
    lifts: dict[tuple[float, ...], FloatArray] = {}
    for event in events:
        if isinstance(event, LinearMotion | ArcMotion):
            _refuse_further_axes(event)
            if isinstance(event, LinearMotion) and event.start_mm == event.end_mm:
                continue
            move = _move(event, _lift(event.state, origin_mm, tool_length_mm, lifts), rapid_mm_min)
            gauge = move.end_mm + _up(tool_length_mm.get(move.tool, 0.0))
            if move.rapid and axis_rapid_mm_min is not None:
                yield from independent_legs(move, axis_rapid_mm_min)
            else:
                yield move
        elif isinstance(event, Dwell):
            tip = gauge - _up(tool_length_mm.get(event.state.tool, 0.0))
            yield Move(
                start_mm=tip,
                end_mm=tip,
                duration_s=event.seconds,
                feed_mm_min=0.0,
                spindle_rpm=_signed_rpm(event.state),
                tool=event.state.tool,
                rapid=False,
                nc_line=event.place.line,
            )
        else:
            yield event


def _refuse_further_axes(event: Motion) -> None:
    """Refuses a motion with a rotary axis turned: the workpiece would not be where it is taken to be."""
    if event.extra != NO_EXTRA:
        turned = ", ".join(f"{axis}{value:g}" for axis, value in zip("ABCUVW", event.extra, strict=True) if value)
        problem = f"an axis besides X, Y, Z is not at 0: {turned}"
        raise GcodeError(event.place, "further-axis", problem, "a program for three axes")


def _up(length_mm: float) -> FloatArray:
    return np.array([0.0, 0.0, length_mm])


def _signed_rpm(state: MotionState) -> float:
    return state.spindle_rpm * state.spindle_direction


def _lift(
    state: MotionState, origin: FloatArray, lengths: Mapping[int, float], known: dict[tuple[float, ...], FloatArray]
) -> FloatArray:
    """From machine coordinates of the controlled point to the tool tip in the workpiece frame, shape (3,).

    Args:
        known: earlier answers, to which this one is added.
    """
    key = (*state.tool_offset_xy_mm, state.length_offset_mm, state.tool)
    if key not in known:
        known[key] = np.array(key[:3]) - _up(lengths.get(state.tool, 0.0)) - origin
    return known[key]


def _move(event: Motion, lift: FloatArray, rapid_mm_min: float) -> Move:
    state = event.state

    def tip(point: Point) -> FloatArray:
        return np.array(point) + lift

    arc = None
    rapid = False
    if isinstance(event, ArcMotion):
        arc = Arc(centre_mm=tip(event.centre_mm), plane=event.plane, sweep_rad=event.sweep_rad)
    else:
        rapid = event.rapid
    start, end = tip(event.start_mm), tip(event.end_mm)
    feed = rapid_mm_min if rapid else event.feed_mm_min
    return Move(
        start_mm=start,
        end_mm=end,
        arc=arc,
        duration_s=path_length_mm(start, end, arc) / feed * 60.0,
        feed_mm_min=feed,
        spindle_rpm=_signed_rpm(state),
        tool=state.tool,
        rapid=rapid,
        nc_line=event.place.line,
    )
