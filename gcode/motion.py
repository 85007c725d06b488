"""Straight motions: G0, G1, the legs of G28, and G53; and the place that a block's axis words name."""

from __future__ import annotations

import math
from collections.abc import Mapping

from gcode.actions import Action, Result
from gcode.arcs import arc
from gcode.blocks import Word
from gcode.events import LinearMotion, Point
from gcode.frame import SAME_PLACE_MM, moved_to, programmed_end, require_feed, settled
from gcode.modal import AXES, Command
from gcode.state import State


def move(state: State, command: Command) -> Result:
    """The motion that a block's axis words make with the active motion code."""
    if command.code("G53"):
        return _machine_move(state, command)
    return _MOTIONS[state.modes.motion](state, command)


def _rapid(state: State, command: Command) -> Result:
    return _straight(state, command, programmed_end(state, command), rapid=True)


def _feed(state: State, command: Command) -> Result:
    require_feed(state, command)
    return _straight(state, command, programmed_end(state, command), rapid=False)


def _machine_move(state: State, command: Command) -> Result:
    """G53: the gauge point goes to machine coordinates, whatever offsets hold."""
    use = command.code("G53")
    word = use.word if use else None
    dialect, modes = state.control.dialect, state.modes
    if not modes.absolute:
        raise command.block.error(word, "g53-incremental", "G53 while G91 is active", "G90")
    if not dialect.machine_moves_rapid and modes.motion not in ("G0", "G1"):
        raise command.block.error(word, "g53-motion", f"G53 while {modes.motion} is active", "G0 or G1")
    rapid = dialect.machine_moves_rapid or modes.motion == "G0"
    if not rapid:
        require_feed(state, command)
    end = state.tip_of(_replaced(state.gauge_mm, command, modes.unit_mm))
    return _straight(settled(state, command), command, end, rapid=rapid)


def _replaced(point: Point, command: Command, unit_mm: float) -> Point:
    """`point` with the coordinates that the block's axis words give, taken as they stand."""
    x, y, z = (
        command.words[axis].value * unit_mm if axis in command.words else old
        for axis, old in zip(AXES, point, strict=True)
    )
    return (x, y, z)


def return_to_reference(state: State, command: Command) -> Result:
    """G28: the named axes go by way of the programmed point to the reference point, at rapid."""
    block, dialect = command.block, state.control.dialect
    named: Mapping[str, Word] = {axis: command.words[axis] for axis in AXES if axis in command.words}
    if not named and not dialect.reference_all_axes:
        word = command.of_phase("reference")[0].word
        raise block.error(word, "missing-axis", f"{word.text} names no axis", "at least one of X, Y, Z")
    first = programmed_end(state, command, adds_length=False)
    via, to_via = _straight(state, command, first, rapid=True)
    home = state.control.settings.home_mm
    x, y, z = (
        there if axis in named or not named else here
        for axis, there, here in zip(AXES, home, via.gauge_mm, strict=True)
    )
    there, to_home = _straight(via, command, state.tip_of((x, y, z)), rapid=True)
    return settled(there, command), to_via + to_home


def _straight(state: State, command: Command, end: Point, *, rapid: bool) -> Result:
    """A straight motion to `end` (controlled point, machine coordinates); none where that is where the tool is."""
    state = settled(state, command)
    if math.dist(state.position_mm, end) <= SAME_PLACE_MM:
        return state, ()
    event = LinearMotion(
        place=command.block.place,
        state=state.machine,
        start_mm=state.position_mm,
        end_mm=end,
        rapid=rapid,
        feed_mm_min=0.0 if rapid else state.modes.feed_mm_min,
    )
    return moved_to(state, end), (event,)


_MOTIONS: Mapping[str, Action] = {"G0": _rapid, "G1": _feed, "G2": arc, "G3": arc}
MOTION_ACTIONS: Mapping[str, Action] = {"motion": move, "reference": return_to_reference}
