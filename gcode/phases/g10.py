"""G10: writes work offsets (L2, L20) and the tool offset table (L1, L10 to L13). Nothing moves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from gcode.control.command import Command
from gcode.control.coordinates import ORIGIN, CoordinateFrame, difference, plus
from gcode.control.state import AXES, EXTRA_AXES, State, WorkOffset
from gcode.events import NO_EXTRA, Event, Notice, Point
from gcode.language.blocks import ParsedBlock
from gcode.phases.modes import Action, Result, whole_number
from gcode.phases.offsets import additional_offset, axis_words, extra_value, extra_words, to_extra
from gcode.settings import NUMBERED_OFFSETS, ToolOffset

#: Kind of data (`Dialect.data_kinds`) that lasts from G10 L until G11, block after block, and is not executed.
_UNTIL_G11 = "ignored"
#: Tool offsets that a program may make by G10; controls have a few hundred.
MOST_TOOL_OFFSETS = 2000
#: Orientations of lathe tools are numbered from 1 to this.
LAST_ORIENTATION = 9


def set_data(state: State, command: Command) -> Result:
    """G10: writes work offsets (L2, L20) or the tool offset table (L1, L10 to L13)."""
    use = command.of_phase("data")[0]
    if use.rule.code == "G11":
        return state, ()
    word = command.words.get("L")
    if word is None:
        raise command.block.error(use.word, "missing-word", f"{use.word.text} without L", "L and a kind of data")
    kind = whole_number(command.block, word)
    table = state.control.dialect.data_kinds
    if kind not in table:
        known = ", ".join(f"L{n}" for n in table)
        raise command.block.error(
            word, "unknown-data", f"{word.text} is not a kind of data that can be set here", known
        )
    takes = _TAKES[table[kind]]
    for letter in command.words.keys() & set(use.rule.letters) - set("LPN" + takes):
        problem = f"{command.words[letter].text} has no meaning in {use.word.text} {word.text}"
        raise command.block.error(command.words[letter], "unused-word", problem, f"only {', '.join('P' + takes)}")
    state, events = _DATA[table[kind]](state, command)
    return state, events + _lathe_words(command)


def _lathe_words(command: Command) -> tuple[Event, ...]:
    """The notice that the angles of a lathe tool have no effect on motion."""
    words = [command.words[letter] for letter in "IJ" if letter in command.words]
    text = f"{' '.join(word.text for word in words)}: the angles of a lathe tool have no effect on motion"
    return (Notice(place=command.block.place_of(words[0]), code="no-motion", text=text),) if words else ()


def _set_zero(state: State, command: Command) -> Result:
    """G10 L2: the zero of a work offset; with G91 the words are added where the dialect does so."""
    return _write_offset(state, command, from_position=False)


def _set_zero_here(state: State, command: Command) -> Result:
    """G10 L20: in FANUC the zero of an additional work offset, in LinuxCNC from the position of the tool."""
    if state.control.dialect.additional_by_l20:
        return _write_offset(state, command, from_position=False, additional=True)
    return _write_offset(state, command, from_position=True)


def _write_offset(state: State, command: Command, *, from_position: bool, additional: bool = False) -> Result:
    if state.control.dialect.needs_axis_words and command.words.keys().isdisjoint(AXES):
        use = command.of_phase("data")[0].word
        raise command.block.error(use, "missing-axis", f"{use.text} names no axis", "at least one of X, Y, Z")
    name = _offset_name(state, command, additional=additional)
    if name == "external":
        base = state.setup.external_mm if state.modes.absolute else ORIGIN
        return state.with_setup(external_mm=_moved(state, command, state.setup.external_mm, base)), ()
    old = state.setup.offsets.get(name, WorkOffset())
    turned = _turned(state, command, old, from_position=from_position)
    if from_position:
        new = _offset_from_position(state, command, replace(old, rotation_deg=turned))
    else:
        zero = _moved(state, command, old.zero_mm, old.zero_mm)
        new = WorkOffset(zero_mm=zero, extra=extra_words(state, command, old.extra), rotation_deg=turned)
    offsets = MappingProxyType({**state.setup.offsets, name: new})
    return state.with_setup(offsets=offsets), ()


def _moved(state: State, command: Command, old: Point, otherwise: Point) -> Point:
    """New zero from axis words: absolute, or added to the old one with G91 in dialects where that is so."""
    if state.modes.absolute or state.control.dialect.shift_is_rotated:
        return axis_words(state, command, otherwise)
    return plus(old, axis_words(state, command, ORIGIN))


def _turned(state: State, command: Command, old: WorkOffset, *, from_position: bool) -> float:
    word = command.words.get("R")
    if word is None:
        return old.rotation_deg
    if not state.control.dialect.shift_is_rotated or from_position:
        raise command.block.error(word, "unused-word", f"{word.text}: work offsets of this control have no rotation")
    return word.value


def _offset_from_position(state: State, command: Command, old: WorkOffset) -> WorkOffset:
    """The offset that puts the tool at the given program coordinates."""
    named = state.with_setup(offsets=MappingProxyType({**state.setup.offsets, state.machine.wcs: old}))
    here = named.program_mm
    wanted = axis_words(state, command, here)
    there = named.frame.to_machine(wanted)
    moved = difference(state.position_mm, there)
    extra = list(old.extra)
    shift = state.setup.shift.extra if state.setup.shift_on else NO_EXTRA
    for index, axis in enumerate(EXTRA_AXES):
        if axis in command.words:
            extra[index] = state.extra[index] - shift[index] - extra_value(state, command.words[axis])
    return replace(old, zero_mm=plus(old.zero_mm, moved), extra=to_extra(extra))


def _offset_name(state: State, command: Command, *, additional: bool) -> str:
    word = command.words.get("P")
    if word is None:
        use = command.of_phase("data")[0].word
        raise command.block.error(use, "missing-word", f"{use.text} without P", "P and the number of a work offset")
    number = whole_number(command.block, word)
    if additional:
        return additional_offset(state, command, word)
    if number == 0:
        return state.machine.wcs if state.control.dialect.shift_is_rotated else "external"
    count = 9 if "G59.1" in state.control.dialect.codes else 6
    if number > count:
        raise command.block.error(word, "bad-value", f"{word.text} is not a work offset", f"P0 to P{count}")
    return NUMBERED_OFFSETS[number - 1]


def _tool_number(command: Command) -> int:
    word = command.words.get("P")
    if word is None:
        use = command.of_phase("data")[0].word
        raise command.block.error(use, "missing-word", f"{use.text} without P", "P and the number of a tool offset")
    number = whole_number(command.block, word)
    if number == 0:
        raise command.block.error(word, "bad-value", f"{word.text} is not a tool offset", "P1 or more")
    return number


def _set_tool_field(field: str, letter: str = "R") -> Action:
    """G10 L10 to L13: one column of the tool offset table."""

    def action(state: State, command: Command) -> Result:
        number, word = _tool_number(command), command.words.get(letter)
        if word is None:
            use = command.of_phase("data")[0].word
            raise command.block.error(use, "missing-word", f"{use.text} without {letter}", f"{letter} and a length")
        row = state.setup.tools.get(number, ToolOffset())
        length = word.value * state.modes.unit_mm
        value = length if state.modes.absolute else getattr(row, field) + length
        return _with_tool(state, command, number, row.with_column(field, value)), ()

    return action


def _set_tool_row_here(state: State, command: Command) -> Result:
    """LinuxCNC's G10 L10: the offset that puts the tool at the given program coordinates."""
    return _row_from_position(state, command, state.frame)


def _set_tool_row_at_fixture(state: State, command: Command) -> Result:
    """LinuxCNC's G10 L11: as L10, in the last work offset without a shift."""
    fixture = replace(state, machine=replace(state.machine, wcs=NUMBERED_OFFSETS[-1]))
    return _row_from_position(state, command, fixture.with_setup(shift_on=False).frame)


def _row_from_position(state: State, command: Command, frame: CoordinateFrame) -> Result:
    number, row = _known_row(state, command)
    gauge = state.gauge_mm
    believed = frame.to_program(difference(gauge, (row.x_mm, row.y_mm, row.length_mm)))
    place = difference(gauge, frame.to_machine(axis_words(state, command, believed)))
    return _with_tool(state, command, number, _with_offsets(state, command, row, place)), ()


def _set_tool_row(state: State, command: Command) -> Result:
    """LinuxCNC's G10 L1: a row of the tool table from axis words and R, a radius."""
    number, row = _known_row(state, command)
    if command.words.keys().isdisjoint("XYZRIJQ"):
        use = command.of_phase("data")[0].word
        raise command.block.error(use, "missing-word", f"{use.text} sets nothing", "axis words, R, I, J or Q")
    place = axis_words(state, command, (row.x_mm, row.y_mm, row.length_mm))
    return _with_tool(state, command, number, _with_offsets(state, command, row, place)), ()


def _known_row(state: State, command: Command) -> tuple[int, ToolOffset]:
    number = _tool_number(command)
    if number not in state.setup.tools and state.control.settings.tools is not None:
        word = command.words["P"]
        raise command.block.error(word, "unknown-tool", f"{word.text} is not in the tool table")
    return number, state.setup.tools.get(number, ToolOffset())


def _with_offsets(state: State, command: Command, row: ToolOffset, place: Point) -> ToolOffset:
    """The row with these offsets, the radius of an R word and the orientation of a Q word."""
    word = command.words.get("R")
    radius = row.radius_mm if word is None else word.value * state.modes.unit_mm
    turned = command.words.get("Q")
    orientation = row.orientation if turned is None else whole_number(command.block, turned)
    if turned is not None and orientation > LAST_ORIENTATION:
        problem = f"{turned.text} is not an orientation of a lathe tool"
        raise command.block.error(turned, "bad-value", problem, f"Q0 to Q{LAST_ORIENTATION}")
    return replace(row, x_mm=place[0], y_mm=place[1], length_mm=place[2], radius_mm=radius, orientation=orientation)


def _with_tool(state: State, command: Command, number: int, row: ToolOffset) -> State:
    if number not in state.setup.tools and len(state.setup.tools) >= MOST_TOOL_OFFSETS:
        problem = f"{command.words['P'].text} is one tool offset too many"
        raise command.block.error(command.words["P"], "bad-value", problem, f"at most {MOST_TOOL_OFFSETS} of them")
    return state.with_setup(tools=MappingProxyType({**state.setup.tools, number: row}))


_DATA: Mapping[str, Action] = {
    "zero": _set_zero,
    "zero-here": _set_zero_here,
    "length": _set_tool_field("length_mm"),
    "length-wear": _set_tool_field("length_wear_mm"),
    "radius": _set_tool_field("radius_mm"),
    "radius-wear": _set_tool_field("radius_wear_mm"),
    "tool": _set_tool_row,
    "tool-here": _set_tool_row_here,
    "tool-at-fixture": _set_tool_row_at_fixture,
}

#: Letters that each kind of data takes in addition to L and P.
_TAKES: Mapping[str, str] = {
    "zero": "XYZABCR",
    "zero-here": "XYZABCR",
    "length": "R",
    "length-wear": "R",
    "radius": "R",
    "radius-wear": "R",
    "tool": "XYZRIJQ",
    "tool-here": "XYZR",
    "tool-at-fixture": "XYZR",
}


def skipped_data(state: State, block: ParsedBlock) -> tuple[State, Notice | None]:
    """Skips a block of data entry (tool life, parameters) between G10 L and G11.

    Returns:
        The state, and a notice where the block is such data and must not be executed.
    """
    codes = {word.value for word in block.words if word.letter == "G"}
    kind = next((word for word in block.words if word.letter == "L"), None)
    if not state.modes.entering_data:
        kinds = state.control.dialect.data_kinds
        if kind is None or 10.0 not in codes or kinds.get(int(kind.value)) != _UNTIL_G11:
            return state, None
        state = state.with_modes(entering_data=True)
    elif 11.0 in codes or block.percent:
        return state.with_modes(entering_data=False), None
    if not block.words:
        return state, None
    text = f"data entry is not executed: {block.place.text.strip()}"
    return state, Notice(place=block.place, code="data-entry", text=text)


DATA_ACTIONS: Mapping[str, Action] = {"data": set_data}
