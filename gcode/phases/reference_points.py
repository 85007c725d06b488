"""Reference points: G27, G28, G29, G30, G28.1, G30.1, and FANUC's G60."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from gcode.control.command import Command
from gcode.control.coordinates import ORIGIN, SAME_POSITION_MM
from gcode.control.state import AXES, EXTRA_AXES, State
from gcode.events import NO_EXTRA, Extra, Point
from gcode.language.blocks import Word
from gcode.phases.end_points import extra_end, programmed_end, settled
from gcode.phases.modes import Action, Result, whole_number
from gcode.phases.offsets import to_extra, with_length
from gcode.phases.straight_motion import straight


def return_to_reference(state: State, command: Command) -> Result:
    """Executes the code of this family in the block."""
    use = command.of_phase("reference")[0]
    if state.compensates:
        problem = f"{use.word.text} while cutter compensation is on"
        raise command.block.error(use.word, "compensation-reference", problem, "G40 before it")
    return _ACTIONS[use.rule.code](state, command)


def _named(state: State, command: Command) -> frozenset[str]:
    """The axes that the block names; none where all are meant.

    Raises:
        GcodeError: where it names none and the dialect wants one.
    """
    dialect = state.control.dialect
    named = frozenset(axis for axis in AXES + dialect.extra_axes + dialect.still_axes if axis in command.words)
    if not named and not dialect.reference_all_axes:
        word = command.of_phase("reference")[0].word
        raise command.block.error(word, "missing-axis", f"{word.text} names no axis", "at least one of X, Y, Z")
    return named


def _return(state: State, command: Command) -> Result:
    """G28, G30: the named axes move at rapid through the programmed point to the reference point."""
    named = _named(state, command)
    first = programmed_end(state, command, adds_length=False)
    via, to_via = straight(state, command, first, rapid=True, extra=extra_end(state, command))
    via = via.with_modes(via_mm=_only(AXES, named, first, state.modes.via_mm or first))
    point, far = _reference_point(state, command)
    extra = to_extra(_only(EXTRA_AXES, named, far, via.extra))
    there, to_home = straight(via, command, _home(via, point, named), rapid=True, extra=extra)
    if there.control.dialect.reference_cancels_length:
        there = with_length(there, "G49", None, ORIGIN)
    return settled(there, command), to_via + to_home


def _home(state: State, point: Point, named: frozenset[str]) -> Point:
    """Controlled point at the reference point `point` in the named axes, and unchanged in the others.

    The axes are those of the machine, or in LinuxCNC those of the program, which G10 L2 R may have rotated.
    """
    if not state.control.dialect.shift_is_rotated:
        x, y, z = _only(AXES, named, point, state.gauge_mm)
        return state.tip_of((x, y, z))
    there = state.frame.to_program(state.tip_of(point))
    x, y, z = _only(AXES, named, there, state.program_mm)
    return state.frame.to_machine((x, y, z))


def _only(
    axes: Sequence[str], named: frozenset[str], there: Sequence[float], here: Sequence[float]
) -> tuple[float, ...]:
    """The numbers of `there` for the named axes, of all where none is named, and those of `here` for the others."""
    return tuple(far if axis in named or not named else near for axis, far, near in zip(axes, there, here, strict=True))


def _reference_point(state: State, command: Command) -> tuple[Point, Extra]:
    """Gauge point of the reference point that the code and its P word name."""
    number = 1 if command.of_phase("reference")[0].rule.code in ("G28", "G27") else 2
    word: Word | None = command.words.get("P")
    if word is not None:
        number = whole_number(command.block, word)
        if not 2 <= number <= 4:
            raise command.block.error(word, "bad-value", f"{word.text} is not a reference point", "P2, P3 or P4")
    points = state.setup.references
    if number in points:
        return points[number]
    if state.control.dialect.reference_all_axes:
        return ((0.0, 0.0, 0.0), NO_EXTRA)
    use = command.of_phase("reference")[0].word
    known = ", ".join(f"P{n}" for n in sorted(points) if n > 1) or "none is given"
    problem = f"{use.text}: reference point {number} is not defined"
    raise command.block.error(word or use, "unknown-reference", problem, f"one of the defined ones: {known}")


def _check(state: State, command: Command) -> Result:
    """G27: a rapid to the programmed point, which must be the reference point of the named axes."""
    named = _named(state, command)
    state, events = straight(state, command, programmed_end(state, command), rapid=True)
    point, _ = _reference_point(state, command)
    for axis, there, here in zip(AXES, point, state.gauge_mm, strict=True):
        if axis in named and abs(there - here) > SAME_POSITION_MM:
            problem = (
                f"{command.words[axis].text} ends at {here:.4f} mm in machine coordinates, not at the reference point"
            )
            raise command.block.error(command.words[axis], "reference-missed", problem, f"{there:.4f} mm")
    return state, events


def _return_from(state: State, command: Command) -> Result:
    """G29: the named axes move through the intermediate point of the last G28 or G30 to the programmed point."""
    named = _named(state, command)
    via = state.modes.via_mm
    if via is None:
        word = command.of_phase("reference")[0].word
        raise command.block.error(word, "missing-reference", f"{word.text} before any G28 or G30", "G28 or G30 first")
    x, y, z = (there if axis in named else here for axis, there, here in zip(AXES, via, state.position_mm, strict=True))
    state, first = straight(state, command, (x, y, z), rapid=True)
    state, second = straight(state, command, programmed_end(state, command), rapid=True)
    return state, first + second


def _one_sided(state: State, command: Command) -> Result:
    """G60: a rapid; the overrun that takes up backlash is not known and is omitted."""
    return straight(state, command, programmed_end(state, command), rapid=True)


def _store(state: State, command: Command) -> Result:
    """G28.1, G30.1: the present position becomes the reference point."""
    number = 1 if command.of_phase("reference")[0].rule.code == "G28.1" else 2
    points = {**state.setup.references, number: (state.gauge_mm, state.extra)}
    return state.with_setup(references=MappingProxyType(points)), ()


_ACTIONS: Mapping[str, Action] = {
    "G27": _check,
    "G28": _return,
    "G28.1": _store,
    "G29": _return_from,
    "G30": _return,
    "G30.1": _store,
    "G60": _one_sided,
}
