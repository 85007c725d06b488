"""From a block's words to places: work offset, distance mode, units and tool length in one spot."""

from __future__ import annotations

from dataclasses import replace

from gcode.blocks import Word
from gcode.events import Point
from gcode.modal import AXES, Command
from gcode.state import State

#: Two places nearer than this are one. No control resolves better than 1e-4 mm, and sums of a program's numbers in
#: doubles stay within 1e-9 mm over a machine's travel.
SAME_PLACE_MM = 1e-6


def work_zero(state: State, command: Command, word: Word | None = None) -> Point:
    """Zero of the active work offset in machine coordinates, mm.

    Raises:
        GcodeError: where the machine's settings do not give that offset.
    """
    offsets = state.control.settings.offsets
    if state.machine.wcs not in offsets:
        known = ", ".join(offsets) or "none is given"
        problem = f"work offset {state.machine.wcs} is not given"
        raise command.block.error(word, "unknown-work-offset", problem, f"one of the machine's offsets: {known}")
    return offsets[state.machine.wcs]


def programmed_end(state: State, command: Command, *, adds_length: bool = True) -> Point:
    """Controlled point that the axis words name, machine coordinates, mm. Axes without a word stay.

    Args:
        adds_length: with G91, whether a Z word also moves by a change of the length offset that nothing has acted on
            yet, in dialects where it does (`Dialect.incremental_adds_length`).
    """
    words, modes = command.words, state.modes
    end = list(state.position_mm)
    for index, axis in enumerate(AXES):
        word = words.get(axis)
        if word is None:
            continue
        length = word.value * modes.unit_mm
        if modes.absolute:
            end[index] = work_zero(state, command, word)[index] + length
        else:
            end[index] += length + (modes.unmoved_length_mm if axis == "Z" and adds_length else 0.0)
    return (end[0], end[1], end[2])


def settled(state: State, command: Command) -> State:
    """The state once the block's motion is made: a Z word has acted on any change of the length offset."""
    if state.modes.unmoved_length_mm and "Z" in command.words:
        return state.with_modes(unmoved_length_mm=0.0)
    return state


def moved_to(state: State, end: Point) -> State:
    """The state with the controlled point at `end`."""
    return replace(state, position_mm=end)


def require_feed(state: State, command: Command) -> None:
    """Refuses a feed motion for which no feed holds.

    Raises:
        GcodeError: where no F word, or F0, was given.
    """
    if state.modes.feed_mm_min <= 0.0:
        problem = f"{state.modes.motion} without a feed rate"
        raise command.block.error(None, "missing-feed", problem, "an F word above 0 in this block or before")
