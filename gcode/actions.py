"""The phases of a block that move nothing: modes, feed, spindle, tool, offsets, coolant, dwell, stops and notices."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Literal, TypeAlias

from gcode.blocks import ParsedBlock, Word
from gcode.events import CoolantChange, Dwell, Event, Notice, ProgramStop, SpindleChange, ToolChange
from gcode.modal import Command
from gcode.state import MODE_OF_CODE, PLANE_OF_CODE, State

Result: TypeAlias = tuple[State, tuple[Event, ...]]
Action: TypeAlias = Callable[[State, Command], Result]

_SPINDLE: Mapping[str, Literal[-1, 0, 1]] = {"M3": 1, "M4": -1, "M5": 0, "M19": 0}
_LENGTH_SIGN: Mapping[str, float] = {"G43": 1.0, "G44": -1.0, "G49": 0.0}
_ENDS = frozenset({"M2", "M30"})


def whole_number(block: ParsedBlock, word: Word) -> int:
    """The value of a word that counts or names something.

    Raises:
        GcodeError: where it is negative or has a fraction.
    """
    if word.value < 0.0 or word.value != int(word.value):
        raise block.error(word, "bad-value", f"{word.text} is no whole number of 0 or more", f"{word.letter}0, 1, 2...")
    return int(word.value)


def _not_negative(block: ParsedBlock, word: Word) -> float:
    if word.value < 0.0:
        raise block.error(word, "bad-value", f"{word.text} is negative", f"{word.letter} of 0 or more")
    return word.value


def set_modes(state: State, command: Command) -> Result:
    """Codes whose whole effect is one modal value."""
    for rule, _ in command.of_phase("modes"):
        if rule.code in PLANE_OF_CODE:
            state = state.with_machine(plane=PLANE_OF_CODE[rule.code])
        else:
            name, value = MODE_OF_CODE[rule.code]
            state = state.with_modes(**{name: value})
    return state, ()


def set_feed(state: State, command: Command) -> Result:
    """F, in program units a minute."""
    feed = _not_negative(command.block, command.words["F"]) * state.modes.unit_mm
    return state.with_modes(feed_mm_min=feed), ()


def set_speed(state: State, command: Command) -> Result:
    """S; the change is reported here unless a spindle code of the same block reports it."""
    rpm = _not_negative(command.block, command.words["S"])
    changed = rpm != state.machine.spindle_rpm
    state = state.with_machine(spindle_rpm=rpm) if changed else state
    if not changed or command.of_phase("spindle_on"):
        return state, ()
    return state, (_spindle_event(state, command),)


def set_spindle_on(state: State, command: Command) -> Result:
    """M3 and M4."""
    return _set_spindle(state, command, "spindle_on")


def set_spindle_off(state: State, command: Command) -> Result:
    """M5, and M19 which stops the spindle too."""
    return _set_spindle(state, command, "spindle_off")


def _set_spindle(state: State, command: Command, phase: str) -> Result:
    direction = _SPINDLE[command.of_phase(phase)[0].rule.code]
    if direction != state.machine.spindle_direction:
        state = state.with_machine(spindle_direction=direction)
    return state, (_spindle_event(state, command),)


def _spindle_event(state: State, command: Command) -> SpindleChange:
    machine = state.machine
    return SpindleChange(
        place=command.block.place, spindle_rpm=machine.spindle_rpm, spindle_direction=machine.spindle_direction
    )


def select_tool(state: State, command: Command) -> Result:
    """T: the tool that the next M6 puts in."""
    return state.with_modes(next_tool=whole_number(command.block, command.words["T"])), ()


def change_tool(state: State, command: Command) -> Result:
    """M6: the selected tool goes in, and the spindle stops."""
    block, tool = command.block, state.modes.next_tool
    if tool is None:
        word = command.of_phase("tool_change")[0].word
        raise block.error(word, "missing-tool", f"{word.text} with no tool selected", "a T word before or beside it")
    events: tuple[Event, ...] = ()
    if state.machine.spindle_direction:
        state = state.with_machine(spindle_direction=0)
        events = (_spindle_event(state, command),)
    return state.with_machine(tool=tool), (*events, ToolChange(place=block.place, tool=tool))


def set_work_offset(state: State, command: Command) -> Result:
    """G54 to G59 and the further ones of a dialect."""
    rule, word = command.of_phase("work_offset")[0]
    offsets = state.control.settings.offsets
    if rule.code not in offsets:
        known = ", ".join(offsets)
        problem = f"work offset {rule.code} is not given"
        raise command.block.error(word, "unknown-work-offset", problem, f"one of the machine's offsets: {known}")
    return state.with_machine(wcs=rule.code), ()


def set_length(state: State, command: Command) -> Result:
    """G43, G44, G49 and H: which tool length offset holds. Nothing moves."""
    uses = command.of_phase("length")
    code = uses[0].rule.code if uses else state.modes.length_code
    word = command.words.get("H")
    number = whole_number(command.block, word) if word else state.modes.length_number
    offset = 0.0
    if _LENGTH_SIGN[code]:
        if word is None and not state.control.dialect.length_word_is_modal:
            number = None
        offset = _LENGTH_SIGN[code] * _length_offset(state, command, number)
    return _with_length(state, code, number, offset), ()


def _with_length(state: State, code: str, number: int | None, offset_mm: float) -> State:
    """The state under another length offset: the gauge point stays, so the controlled point changes."""
    change = offset_mm - state.machine.length_offset_mm
    x, y, z = state.position_mm
    unmoved = state.modes.unmoved_length_mm + change if state.control.dialect.incremental_adds_length else 0.0
    state = state.with_modes(length_code=code, length_number=number, unmoved_length_mm=unmoved)
    if change == 0.0:
        return state
    return replace(state.with_machine(length_offset_mm=offset_mm), position_mm=(x, y, z - change))


def _length_offset(state: State, command: Command, number: int | None) -> float:
    """Entry of the offset table for an H number, mm."""
    dialect, table = state.control.dialect, state.control.settings.length_offsets_mm
    word = command.words.get("H") or command.of_phase("length")[0].word
    if dialect.length_defaults_to_tool and not number:
        number = state.machine.tool
    if number is None:
        problem = f"{word.text} without an H word, and none before"
        raise command.block.error(word, "missing-length-offset", problem, "H and the number of a tool length offset")
    if number == 0:
        return 0.0
    if number not in table:
        known = ", ".join(f"H{n}" for n in sorted(table)) or "none is given"
        problem = f"tool length offset {number} is not in the table"
        raise command.block.error(word, "unknown-length-offset", problem, f"one of the table: {known}")
    return table[number]


def set_coolant_on(state: State, command: Command) -> Result:
    """M7 and M8."""
    on = {use.rule.code for use in command.of_phase("coolant_on")}
    return _set_coolant(state, command, mist=state.modes.mist or "M7" in on, flood=state.modes.flood or "M8" in on)


def set_coolant_off(state: State, command: Command) -> Result:
    """M9."""
    return _set_coolant(state, command, mist=False, flood=False)


def _set_coolant(state: State, command: Command, *, mist: bool, flood: bool) -> Result:
    event = CoolantChange(place=command.block.place, mist=mist, flood=flood)
    return state.with_modes(mist=mist, flood=flood), (event,)


def dwell(state: State, command: Command) -> Result:
    """G4 and the one word that gives its time."""
    block, table = command.block, state.control.dialect.dwell
    given = [command.words[letter] for letter in table if letter in command.words]
    use = command.of_phase("dwell")[0]
    if len(given) != 1:
        count = "without a time" if not given else "with two times"
        raise block.error(use.word, "bad-dwell", f"{use.word.text} {count}", f"{' or '.join(table)} and a time")
    word, rule = given[0], table[given[0].letter]
    if rule.whole and word.has_point:
        problem = f"{word.text} has a decimal point, but counts steps of {rule.seconds} s"
        raise block.error(word, "bad-dwell", problem, f"{word.letter} without a point, or X and seconds")
    seconds = _not_negative(block, word) * rule.seconds
    return state, (Dwell(place=block.place, state=state.machine, seconds=seconds),)


def stop(state: State, command: Command) -> Result:
    """M0, M1, M2, M30 and the dialect's further stops."""
    code = command.of_phase("stop")[0].rule.code
    ends = code in _ENDS
    event = ProgramStop(place=command.block.place, optional=code == "M1", end=ends)
    return (replace(state, ended=True) if ends else state), (event,)


def notice(state: State, command: Command) -> Result:
    """Codes that are understood and move nothing."""
    return state, tuple(
        Notice(
            place=command.block.place_of(use.word),
            code="no-motion",
            text=f"{use.word.text} ({use.rule.meaning}) has no effect on the simulated motion",
        )
        for use in command.of_phase("notice")
    )


ACTIONS: Mapping[str, Action] = {
    "modes": set_modes,
    "feed": set_feed,
    "speed": set_speed,
    "tool": select_tool,
    "tool_change": change_tool,
    "spindle_on": set_spindle_on,
    "spindle_off": set_spindle_off,
    "coolant_on": set_coolant_on,
    "coolant_off": set_coolant_off,
    "work_offset": set_work_offset,
    "length": set_length,
    "dwell": dwell,
    "stop": stop,
    "notice": notice,
}
