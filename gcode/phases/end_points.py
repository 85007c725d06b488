"""End points of motions from the words of a block, and the feed."""

from __future__ import annotations

import math
from dataclasses import replace

from gcode.control.command import Command
from gcode.control.coordinates import SAME_POSITION_MM
from gcode.control.state import AXES, EXTRA_AXES, State
from gcode.events import PLANE_AXES, Extra, Point
from gcode.language.blocks import Word
from gcode.phases.offsets import extra_value, known_offsets, to_extra


def programmed_end(state: State, command: Command, *, adds_length: bool = True) -> Point:
    """Controlled point that the axis words name, machine coordinates, mm. Axes without a word are unchanged.

    Args:
        adds_length: with G91, whether a Z word also moves by a change of the length offset that nothing has acted on
            yet, in dialects where it does (`Dialect.incremental_adds_length`).
    """
    words, modes, frame = command.words, state.modes, state.frame
    if modes.absolute and state.machine.wcs not in state.setup.offsets:
        raise _no_offset(state, command)
    if frame.matrix is not None or modes.polar:
        x, y, z = frame.to_machine(program_end(state, command))
        return (x, y, z + _unmoved(state, command, adds_length=adds_length))
    end = list(state.position_mm)
    for index, axis in enumerate(AXES):
        word = words.get(axis)
        if word is None:
            continue
        length = _length(state, word)
        if modes.absolute:
            end[index] = frame.zero_mm[index] + length
        else:
            end[index] += length + (_unmoved(state, command, adds_length=adds_length) if axis == "Z" else 0.0)
    return (end[0], end[1], end[2])


def _no_offset(state: State, command: Command) -> Exception:
    problem = f"work offset {state.machine.wcs} is not defined"
    expected = f"one of the defined offsets: {known_offsets(state)}"
    return command.block.error(None, "unknown-work-offset", problem, expected)


def _unmoved(state: State, command: Command, *, adds_length: bool) -> float:
    if not adds_length or state.modes.absolute or "Z" not in command.words:
        return 0.0
    return state.modes.unmoved_length_mm


def _length(state: State, word: Word) -> float:
    """An axis word's length, mm."""
    length = word.value * state.modes.unit_mm
    return length / 2.0 if state.modes.diameter and word.letter == "X" else length


def program_end(state: State, command: Command) -> Point:
    """Position that the axis words name, program coordinates, mm."""
    modes, here = state.modes, state.program_mm
    end = list(here)
    for index, axis in enumerate(AXES):
        word = command.words.get(axis)
        if word is not None:
            end[index] = _length(state, word) if modes.absolute else here[index] + _length(state, word)
    if modes.polar:
        return _from_polar(state, command, here, end)
    return (end[0], end[1], end[2])


def _from_polar(state: State, command: Command, here: Point, end: list[float]) -> Point:
    """The plane's words read as a radius and an angle; a missing one is unchanged.

    Raises:
        GcodeError: for an incremental radius that is not measured from where the tool was at G16.
    """
    i, j, _ = PLANE_AXES[state.machine.plane]
    words, modes = command.words, state.modes
    if AXES[i] not in words and AXES[j] not in words:
        return (end[0], end[1], end[2])
    centre = modes.polar_centre_mm or (0.0, 0.0, 0.0)
    u, v = here[i] - centre[i], here[j] - centre[j]
    radius, angle = math.hypot(u, v), math.degrees(math.atan2(v, u))
    if AXES[i] in words and not modes.absolute and radius > SAME_POSITION_MM:
        word = words[AXES[i]]
        problem = (
            f"{word.text} as an incremental radius not from the polar origin, which controls interpret differently"
        )
        raise command.block.error(word, "polar-incremental", problem, "G90, or G16 again where the tool is")
    if AXES[i] in words:
        radius = _length(state, words[AXES[i]]) + (0.0 if modes.absolute else radius)
    if AXES[j] in words:
        angle = words[AXES[j]].value + (0.0 if modes.absolute else angle)
    end[i] = centre[i] + radius * math.cos(math.radians(angle))
    end[j] = centre[j] + radius * math.sin(math.radians(angle))
    return (end[0], end[1], end[2])


def extra_end(state: State, command: Command) -> Extra:
    """Positions of the further axes that the block's words name, machine coordinates."""
    if not state.control.dialect.extra_axes or command.words.keys().isdisjoint(EXTRA_AXES):
        return state.extra
    end = list(state.extra)
    for index, axis in enumerate(EXTRA_AXES):
        if axis in command.words:
            value = extra_value(state, command.words[axis])
            end[index] = state.frame.extra[index] + value if state.modes.absolute else end[index] + value
    return to_extra(end)


def settled(state: State, command: Command) -> State:
    """The state once the block's motion is made: a Z word has acted on any change of the length offset."""
    if state.modes.unmoved_length_mm and "Z" in command.words:
        return state.with_modes(unmoved_length_mm=0.0)
    return state


def moved_to(state: State, end: Point, extra: Extra | None = None) -> State:
    """The state with the controlled point at `end`."""
    return replace(state, position_mm=end, extra=state.extra if extra is None else extra)


def require_axes(state: State, command: Command) -> None:
    """Refuses a motion that names no axis.

    Raises:
        GcodeError: where the block has no axis word.
    """
    if command.words.keys().isdisjoint(AXES):
        raise command.block.error(None, "missing-axis", f"{state.modes.motion} names no axis", "at least one axis word")


def feed_mm_min(state: State, command: Command, length_mm: float) -> float:
    """Speed of a feed motion of this length along its path, mm/min.

    Raises:
        GcodeError: where no feed holds; with inverse time, where the block gives none; with feed per revolution,
            where the spindle has no speed.
    """
    feed, mode = state.modes.feed, state.machine.feed_mode
    if feed <= 0.0 or (mode == "inverse-time" and "F" not in command.words):
        problem = f"{state.modes.motion} without a feed rate"
        where = "in this block" if mode == "inverse-time" else "in this block or before"
        raise command.block.error(None, "missing-feed", problem, f"an F word above 0 {where}")
    if mode == "per-minute":
        return feed
    if mode == "inverse-time":
        return feed * length_mm
    if state.machine.spindle_rpm <= 0.0:
        problem = f"{state.modes.motion} with feed per revolution and no spindle speed"
        raise command.block.error(None, "missing-speed", problem, "an S word above 0 in this block or before")
    return feed * state.machine.spindle_rpm
