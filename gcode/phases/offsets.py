"""The phases of zeros and offsets: work offsets, tool length offset, G52 and G92. Nothing moves in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from gcode.control.command import Command
from gcode.control.coordinates import ORIGIN, difference, plus
from gcode.control.state import AXES, EXTRA_AXES, State, WorkOffset
from gcode.events import Event, Extra, Notice, Point
from gcode.language.blocks import Word
from gcode.phases.modes import Action, Result, not_negative, whole_number
from gcode.settings import NUMBERED_OFFSETS, ToolOffset

#: Additional work offsets that have codes of their own.
_SAME_OFFSETS: Mapping[str, str] = {f"G{109 + n}": f"G54.1 P{n}" for n in range(1, 21)}
_LENGTH_SIGN: Mapping[str, float] = {"G43": 1.0, "G44": -1.0, "G49": 0.0, "G43.1": 1.0, "G43.2": 1.0}


def known_offsets(state: State) -> str:
    """The names of the work offsets that may be used, for a message."""
    names = list(state.setup.offsets)
    return ", ".join(names[:12]) + (", ..." if len(names) > 12 else "") if names else "none is given"


def set_work_offset(state: State, command: Command) -> Result:
    """G54 to G59 and the further ones of a dialect.

    In a block with a call, as ``G54 M98 P200``, P is the subprogram's number.
    """
    use = command.of_phase("work_offset")[0]
    name = _SAME_OFFSETS.get(use.rule.code, use.rule.code)
    word = command.words.get("P")
    if use.rule.letters and word is not None and not (command.of_phase("call") and name in NUMBERED_OFFSETS):
        name = additional_offset(state, command, word)
    elif name == "G54.1":
        name = "G54.1 P1"
    elif name == "G154":
        raise command.block.error(use.word, "missing-word", f"{use.word.text} without P", "P and a number")
    if name not in state.setup.offsets:
        problem = f"work offset {name} is not defined"
        expected = f"one of the defined offsets: {known_offsets(state)}"
        raise command.block.error(use.word, "unknown-work-offset", problem, expected)
    return state.with_machine(wcs=name).reframed(), ()


def additional_offset(state: State, command: Command, word: Word) -> str:
    """Name of the additional work offset that a P word counts.

    Raises:
        GcodeError: where there is none of that number.
    """
    number, most = whole_number(command.block, word), state.control.dialect.additional_offsets
    if not 1 <= number <= most:
        expected = f"P1 to P{most}"
        raise command.block.error(word, "bad-value", f"{word.text} is not an additional work offset", expected)
    return f"G54.1 P{number}"


def set_length(state: State, command: Command) -> Result:
    """G43, G44, G49, G43.1, G43.2 and H: which tool length offset holds. Nothing moves."""
    uses = command.of_phase("length")
    code = uses[0].rule.code if uses else state.modes.length_code
    if code == "G43.1":
        return with_length(state, code, None, axis_words(state, command, state.tool_offset_mm)), ()
    word = command.words.get("H")
    number = whole_number(command.block, word) if word else state.modes.length_number
    offset = ORIGIN
    notices: tuple[Event, ...] = ()
    if code == "G43.2":
        offset = _added_length(state, command)
    elif _LENGTH_SIGN[code]:
        if word is None and not state.control.dialect.length_word_is_modal:
            number = None
        row = _length_row(state, command, number)
        notices = _unknown_table(state, command, number)
        both = state.control.dialect.length_moves_all_axes
        sign = _LENGTH_SIGN[code]
        offset = (row.x_mm if both else 0.0, row.y_mm if both else 0.0, sign * row.whole_length_mm)
    return with_length(state, code, number, offset), notices


def _unknown_table(state: State, command: Command, number: int | None) -> tuple[Event, ...]:
    """A notice that the length of a tool is not known and counts as 0."""
    if state.control.settings.tools is not None or not number or number in state.setup.tools:
        return ()
    word = command.words.get("H") or command.of_phase("length")[0].word
    text = f"{word.text}: no tool table is given, so the length of offset {number} counts as 0"
    return (Notice(place=command.block.place_of(word), code="no-tool-table", text=text),)


def _added_length(state: State, command: Command) -> Point:
    """G43.2: a further row of the table on top of what holds."""
    x, y, z = state.tool_offset_mm
    word = command.words.get("H")
    if word is None:
        use = command.of_phase("length")[0].word
        problem = f"{use.text} without an H word"
        raise command.block.error(use, "missing-length-offset", problem, "H and the number of a tool length offset")
    row = _length_row(state, command, whole_number(command.block, word))
    return (x + row.x_mm, y + row.y_mm, z + row.whole_length_mm)


def axis_words(state: State, command: Command, otherwise: Point) -> Point:
    """The block's X, Y, Z words as lengths, mm; those that are missing are taken from `otherwise`."""
    words, unit = command.words, state.modes.unit_mm
    x, y, z = (words[axis].value * unit if axis in words else old for axis, old in zip(AXES, otherwise, strict=True))
    return (x, y, z)


def with_length(state: State, code: str, number: int | None, offset_mm: Point) -> State:
    """The state under another tool offset: the gauge point stays, so the controlled point changes."""
    gauge, change = state.gauge_mm, offset_mm[2] - state.machine.length_offset_mm
    unmoved = state.modes.unmoved_length_mm + change if state.control.dialect.incremental_adds_length else 0.0
    mode = "G49" if code == "G49" else "G44" if code == "G44" else "G43"
    state = state.with_modes(length_code=mode, length_number=number, unmoved_length_mm=unmoved)
    active = number if mode != "G49" else None
    if offset_mm == state.tool_offset_mm:
        return state.with_machine(length_number=active) if active != state.machine.length_number else state
    machine = {"length_offset_mm": offset_mm[2], "tool_offset_xy_mm": offset_mm[:2], "length_number": active}
    state = state.with_machine(**machine)
    return replace(state, position_mm=state.tip_of(gauge))


def _length_row(state: State, command: Command, number: int | None) -> ToolOffset:
    """Row of the offset table for an H number."""
    dialect, table = state.control.dialect, state.setup.tools
    word = command.words.get("H") or command.of_phase("length")[0].word
    if dialect.length_defaults_to_tool and not number:
        number = state.machine.tool
    if number is None:
        problem = f"{word.text} without an H word, and none before"
        raise command.block.error(word, "missing-length-offset", problem, "H and the number of a tool length offset")
    if number == 0:
        return ToolOffset()
    if number not in table and state.control.settings.tools is None:
        return ToolOffset()
    if number not in table:
        known = ", ".join(f"H{n}" for n in sorted(table)) or "none is given"
        problem = f"tool length offset {number} is not in the tool table"
        raise command.block.error(word, "unknown-length-offset", problem, f"one from the table: {known}")
    return table[number]


def set_shift(state: State, command: Command) -> Result:
    """G52 and G92 with its family: a shift of program coordinates."""
    use = command.of_phase("shift")[0]
    return _SHIFTS[use.rule.code](state, command)


def _local(state: State, command: Command) -> Result:
    """G52: the zero is at the given position of the work offset; axes without a word keep theirs."""
    if not any(axis in command.words for axis in AXES + EXTRA_AXES):
        return _without_axes(state, command)
    if state.control.dialect.shift_is_rotated:
        shift = WorkOffset(
            zero_mm=axis_words(state, command, state.setup.shift.zero_mm),
            extra=extra_words(state, command, state.setup.shift.extra),
        )
        return state.with_setup(shift=shift, shift_on=True), ()
    return state.with_setup(local_mm=axis_words(state, command, state.setup.local_mm)), ()


def _preset(state: State, command: Command) -> Result:
    """G92: where the tool is gets the given coordinates. Where G52 is a shift of its own it ends in those axes."""
    if not any(axis in command.words for axis in AXES + EXTRA_AXES):
        return _without_axes(state, command)
    setup, dialect = state.setup, state.control.dialect
    if not dialect.shift_is_rotated:
        state = state.with_setup(local_mm=_unnamed(command, setup.local_mm))
    wanted = axis_words(state, command, state.program_mm)
    if dialect.shift_is_rotated:
        inside = state.with_setup(shift=WorkOffset(), shift_on=False).program_mm
        zero = difference(inside, wanted)
    else:
        zero = plus(setup.shift.zero_mm, difference(state.position_mm, state.frame.to_machine(wanted)))
    extra = list(setup.shift.extra)
    for index, axis in enumerate(EXTRA_AXES):
        if axis in command.words:
            offset = state.setup.offsets[state.machine.wcs].extra[index] if state.setup.offsets else 0.0
            extra[index] = state.extra[index] - offset - extra_value(state, command.words[axis])
    return state.with_setup(shift=WorkOffset(zero_mm=zero, extra=to_extra(extra)), shift_on=True), ()


def _without_axes(state: State, command: Command) -> Result:
    """G92 S: the largest speed of the spindle with a constant surface speed."""
    use = command.of_phase("shift")[0]
    if (
        "S" in command.words
        and "S" in state.control.dialect.free_letters
        and not state.control.dialect.shift_is_rotated
    ):
        limit = not_negative(command.block, command.words["S"])
        return state.with_modes(surface_speed_limit=limit), ()
    raise command.block.error(use.word, "missing-axis", f"{use.word.text} names no axis", "at least one of X, Y, Z")


def _unnamed(command: Command, point: Point) -> Point:
    """`point` with 0 for the axes that the block names."""
    x, y, z = (0.0 if axis in command.words else old for axis, old in zip(AXES, point, strict=True))
    return (x, y, z)


def _reset_shift(state: State, command: Command) -> Result:
    """G92.1: no shift, and none kept; with axis words for those axes."""
    if any(axis in command.words for axis in AXES):
        kept = replace(state.setup.shift, zero_mm=_unnamed(command, state.setup.shift.zero_mm))
        return state.with_setup(shift=kept, local_mm=_unnamed(command, state.setup.local_mm)), ()
    return state.with_setup(shift=WorkOffset(), local_mm=ORIGIN, shift_on=True), ()


def _suspend_shift(state: State, _command: Command) -> Result:
    """G92.2: no shift, and it is kept."""
    return state.with_setup(shift_on=False), ()


def _resume_shift(state: State, _command: Command) -> Result:
    """G92.3: the shift that was kept."""
    return state.with_setup(shift_on=True), ()


_SHIFTS: Mapping[str, Action] = {
    "G52": _local,
    "G92": _preset,
    "G92.1": _reset_shift,
    "G92.2": _suspend_shift,
    "G92.3": _resume_shift,
}


def extra_value(state: State, word: Word) -> float:
    """A further axis' word: degrees for A, B, C, mm for U, V, W."""
    return word.value if word.letter in "ABC" else word.value * state.modes.unit_mm


def extra_words(state: State, command: Command, otherwise: Extra) -> Extra:
    """The block's words of further axes; those that are missing are taken from `otherwise`."""
    return to_extra(
        [
            extra_value(state, command.words[axis]) if axis in command.words else old
            for axis, old in zip(EXTRA_AXES, otherwise, strict=True)
        ]
    )


def to_extra(values: Sequence[float]) -> Extra:
    """Six values as positions of the further axes."""
    a, b, c, u, v, w = values
    return (a, b, c, u, v, w)


OFFSET_ACTIONS: Mapping[str, Action] = {
    "work_offset": set_work_offset,
    "length": set_length,
    "shift": set_shift,
}
