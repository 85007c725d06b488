"""Canned cycles in the interpreter: from the words of a block to motions, dwells and spindle changes."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

from gcode.control.command import Command
from gcode.control.state import AXES, State, same_position
from gcode.cycles import (
    CycleError,
    CycleInput,
    CycleRules,
    Move,
    OperatorStop,
    Orient,
    Pause,
    Position,
    Spindle,
    Step,
    run_cycle,
)
from gcode.events import PLANE_AXES, Dwell, Event, Point, ProgramStop
from gcode.phases.end_points import program_end
from gcode.phases.modes import Result, spindle_event
from gcode.phases.straight_motion import straight

#: Letters of a cycle that are lengths.
_LENGTHS = frozenset("XYZRQIJK")


def drill(state: State, command: Command) -> Result:
    """The holes that a block makes in a cycle's mode.

    Raises:
        GcodeError: for a word that the cycle refuses, or a missing one.
    """
    rules = state.control.dialect.cycles
    if rules is None:
        raise command.block.error(None, "unsupported-code", f"{state.modes.motion} is not supported")
    if state.machine.feed_mode == "inverse-time":
        problem = f"{state.modes.motion} with inverse time feed"
        raise command.block.error(None, "cycle-feed", problem, "G94 or G95")
    if state.compensates:
        problem = f"{state.modes.motion} while cutter compensation is on"
        raise command.block.error(None, "compensation-cycle", problem, "G40 before it")
    if not state.frame.keeps_lengths:
        problem = f"{state.modes.motion} while scaling is active; controls scale only some words of a cycle"
        raise command.block.error(None, "cycle-scaled", problem, "G50 before it")
    i, j, k = PLANE_AXES[state.machine.plane]
    here = state.program_mm
    if not state.modes.in_cycle:
        state = state.with_modes(initial_level_mm=here[k])
    try:
        output = run_cycle(rules, _input(state, command, rules, (here[i], here[j], here[k])))
    except CycleError as error:
        word = command.words.get(error.letter) if error.letter else None
        raise command.block.error(word, error.code, error.problem, error.expected) from None
    state = state.with_modes(in_cycle=True, cycle_words=MappingProxyType(dict(output.sticky)))
    events: list[Event] = []
    for step in output.steps:
        state, more = _execute(state, command, rules, step)
        events.extend(more)
    end = state.frame.to_machine(_point(state, output.position))
    if not same_position(end, state.position_mm):
        state = replace(state, position_mm=end)
    return state, tuple(events)


def _input(state: State, command: Command, rules: CycleRules, position: Position) -> CycleInput:
    modes, unit = state.modes, state.modes.unit_mm
    i, j, k = PLANE_AXES[state.machine.plane]
    words = {
        letter: word.value * unit if letter in _LENGTHS and not _repeats(rules, letter) else word.value
        for letter, word in command.words.items()
    }
    position, words = _without_polar(state, command, position, words)
    return CycleInput(
        code=modes.motion,
        words=words,
        sticky=modes.cycle_words,
        position=position,
        axes=(AXES[i], AXES[j], AXES[k]),
        absolute=modes.absolute,
        return_to_r=modes.return_to_r,
        initial_level=modes.initial_level_mm,
        spindle_direction=state.machine.spindle_direction,
        feed_known=modes.feed > 0.0,
        first_of_mode=not modes.in_cycle,
        rigid=modes.rigid_tapping,
        unit_mm=unit,
        pointed=frozenset(letter for letter, word in command.words.items() if word.has_point),
    )


def _repeats(rules: CycleRules, letter: str) -> bool:
    return letter in rules.repeat_letters


def _without_polar(
    state: State, command: Command, position: Position, words: dict[str, float]
) -> tuple[Position, dict[str, float]]:
    """With polar coordinates the position of the hole is computed here, and the cycle gets rectangular words."""
    i, j, _ = PLANE_AXES[state.machine.plane]
    if not state.modes.polar or not {AXES[i], AXES[j]} & command.words.keys():
        return position, words
    end = program_end(state, command)
    shift = (0.0, 0.0) if state.modes.absolute else position[:2]
    return position, {**words, AXES[i]: end[i] - shift[0], AXES[j]: end[j] - shift[1]}


def _execute(state: State, command: Command, rules: CycleRules, step: Step) -> Result:
    place = command.block.place
    match step:
        case Move():
            end = state.frame.to_machine(_point(state, step.end))
            tapping = step.tapping and rules.tap_follows_spindle
            return straight(state, command, end, rapid=step.rapid, tapping=tapping)
        case Pause():
            return state, (Dwell(place=place, state=state.machine, seconds=step.seconds),)
        case Spindle():
            state = state.with_machine(spindle_direction=step.direction)
            return state, (spindle_event(state, command),)
        case Orient():
            state = state.with_machine(spindle_direction=0)
            return state, (spindle_event(state, command),)
        case OperatorStop():
            return state, (ProgramStop(place=place, optional=False, end=False, message="manual retract"),)


def _point(state: State, position: Position) -> Point:
    """Program coordinates X, Y, Z of a place in the plane's order."""
    point = [0.0, 0.0, 0.0]
    for axis, value in zip(PLANE_AXES[state.machine.plane], position, strict=True):
        point[axis] = value
    return (point[0], point[1], point[2])
