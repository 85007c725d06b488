"""The motion of a block: G0, G1, G53 and spindle-synchronised motions here, arcs, splines and cycles elsewhere."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from gcode.control.command import Command
from gcode.control.state import AXES, State
from gcode.dialects import Dialect
from gcode.events import LinearMotion, Notice, Point
from gcode.phases.arcs import arc
from gcode.phases.drilling import drill
from gcode.phases.end_points import extra_end, moved_to, programmed_end, require_axes, settled
from gcode.phases.modes import Action, Result
from gcode.phases.polar_words import POLAR_LETTERS, as_axis_words
from gcode.phases.reference_points import return_to_reference
from gcode.phases.splines import cubic_spline, quadratic_spline
from gcode.phases.straight_motion import straight


def move(state: State, command: Command) -> Result:
    """The motion that a block's axis words make with the active motion code."""
    if state.modes.surface_speed is not None:
        state = _at_surface_speed(state)
    if not command.words.keys().isdisjoint(POLAR_LETTERS):
        command = as_axis_words(state, command)
    if command.code("G53"):
        return _machine_move(state, command)
    return _MOTIONS.get(state.modes.motion, drill)(state, command)


def _at_surface_speed(state: State) -> State:
    """The spindle speed that gives the surface speed at the distance from X0 where the motion starts."""
    speed, limit = state.modes.surface_speed or 0.0, state.modes.surface_speed_limit
    radius = abs(state.program_mm[0])
    rpm = math.inf if radius == 0.0 else 1000.0 * speed / (2.0 * math.pi * radius)
    rpm = min(rpm, limit) if limit else rpm
    return state.with_machine(spindle_rpm=rpm if math.isfinite(rpm) else state.machine.spindle_rpm)


def _rapid(state: State, command: Command) -> Result:
    return straight(state, command, programmed_end(state, command), extra=extra_end(state, command), rapid=True)


def _feed(state: State, command: Command) -> Result:
    return straight(state, command, programmed_end(state, command), extra=extra_end(state, command), rapid=False)


def _machine_move(state: State, command: Command) -> Result:
    """G53: the gauge point goes to machine coordinates, whatever offsets hold."""
    use = command.code("G53")
    word = use.word if use else None
    dialect, modes = state.control.dialect, state.modes
    if not modes.absolute and dialect.machine_move_incremental == "refused":
        raise command.block.error(word, "g53-incremental", "G53 while G91 is active", "G90")
    if not dialect.machine_moves_rapid and modes.motion not in ("G0", "G1"):
        raise command.block.error(word, "g53-motion", f"G53 while {modes.motion} is active", "G0 or G1")
    if state.compensates:
        raise command.block.error(word, "g53-compensation", "G53 while cutter compensation is on", "G40 before it")
    warnings = () if modes.absolute else (_incremental_warning(dialect, command),)
    if not modes.absolute and dialect.machine_move_incremental == "ignored":
        return state, warnings
    rapid = dialect.machine_moves_rapid or modes.motion == "G0"
    end = state.tip_of(_replaced(state.gauge_mm, command, modes.unit_mm))
    state, events = straight(settled(state, command), command, end, rapid=rapid)
    return state, (*warnings, *events)


def _incremental_warning(dialect: Dialect, command: Command) -> Notice:
    text = "G53 while G91 is active: machine coordinates are absolute, whatever the distance mode"
    if dialect.machine_move_incremental == "ignored":
        text = "G53 while G91 is active: the control ignores it, and the block does not move"
    return Notice(place=command.block.place, code="g53-incremental", text=text)


def _replaced(point: Point, command: Command, unit_mm: float) -> Point:
    """`point` with the coordinates of the block's axis words, unchanged."""
    x, y, z = (
        command.words[axis].value * unit_mm if axis in command.words else old
        for axis, old in zip(AXES, point, strict=True)
    )
    return (x, y, z)


def _synchronised(state: State, command: Command) -> Result:
    """G33: K of path to a turn of the spindle."""
    require_axes(state, command)
    end, feed = programmed_end(state, command), _pitch_feed(state, command)
    event = LinearMotion(
        place=command.block.place,
        state=state.machine,
        start_mm=state.position_mm,
        end_mm=end,
        rapid=False,
        feed_mm_min=feed,
        extra=state.extra,
    )
    return moved_to(settled(state, command), end), (event,)


def _rigid_tap(state: State, command: Command) -> Result:
    """G33.1: into the hole at K a turn, and back out to the start with the spindle reversed."""
    require_axes(state, command)
    start, end = state.position_mm, programmed_end(state, command)
    feed = _pitch_feed(state, command)
    place, there = command.block.place, state.machine
    back = state.with_machine(spindle_direction=-there.spindle_direction).machine
    down = LinearMotion(
        place=place,
        state=there,
        start_mm=start,
        end_mm=end,
        rapid=False,
        feed_mm_min=feed,
        tapping=True,
        extra=state.extra,
    )
    up = replace(down, state=back, start_mm=end, end_mm=start)
    return settled(state, command), (down, up)


def _pitch_feed(state: State, command: Command) -> float:
    feed = command.words.get("F")
    if feed is not None:
        problem = f"{feed.text} together with {state.modes.motion}, whose feed is pitch times spindle speed"
        raise command.block.error(feed, "unused-word", problem, "F in another block")
    word = command.words.get("K")
    if word is None or word.value == 0.0:
        problem = f"{state.modes.motion} without a pitch"
        raise command.block.error(word, "missing-word", problem, "K and the length of path to a turn")
    if not state.machine.spindle_direction:
        problem = f"{state.modes.motion} while the spindle is stopped"
        raise command.block.error(None, "spindle-stopped", problem, "M3 or M4 before it")
    return abs(word.value) * state.modes.unit_mm * state.machine.spindle_rpm


_MOTIONS: Mapping[str, Action] = {
    "G0": _rapid,
    "G1": _feed,
    "G2": arc,
    "G3": arc,
    "G5": cubic_spline,
    "G5.1": quadratic_spline,
    "G33": _synchronised,
    "G33.1": _rigid_tap,
}
MOTION_ACTIONS: Mapping[str, Action] = {"motion": move, "reference": return_to_reference}
