"""The phases of a block without motion: modes, feed, spindle, tool, coolant, dwell, stops and notices."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Literal, TypeAlias

from gcode.control.command import Command
from gcode.control.state import MM_PER_INCH, State
from gcode.events import CoolantChange, Dwell, Event, FeedMode, Notice, ProgramStop, SpindleChange, ToolChange
from gcode.language.blocks import ParsedBlock, Word

Result: TypeAlias = tuple[State, tuple[Event, ...]]
Action: TypeAlias = Callable[[State, Command], Result]

#: Field of `Modes` and its value, for every code whose whole effect is one mode.
_MODE_OF_CODE: Mapping[str, tuple[str, object]] = {
    "G7": ("diameter", True),
    "G8": ("diameter", False),
    "G20": ("unit_mm", MM_PER_INCH),
    "G21": ("unit_mm", 1.0),
    "G90": ("absolute", True),
    "G91": ("absolute", False),
    "G90.1": ("absolute_centres", True),
    "G91.1": ("absolute_centres", False),
    "G98": ("return_to_r", False),
    "G99": ("return_to_r", True),
}
_PLANE_OF_CODE: Mapping[str, int] = {"G17": 17, "G18": 18, "G19": 19}
#: Motion codes that a canned cycle's end falls back to.
_BASE_MOTIONS = frozenset({"G0", "G1", "G2", "G3"})
_FEED_MODES: Mapping[str, FeedMode] = {"G93": "inverse-time", "G94": "per-minute", "G95": "per-revolution"}
_SPINDLE: Mapping[str, Literal[-1, 0, 1]] = {"M3": 1, "M4": -1, "M5": 0, "M19": 0}
#: Range of each word of M19: an angle, a sense, and a time.
_ORIENTATION: Mapping[str, tuple[float, float]] = {"R": (0.0, 360.0), "P": (0.0, 2.0), "Q": (1e-9, 1e9)}
_ENDS = frozenset({"M2", "M30"})


def whole_number(block: ParsedBlock, word: Word) -> int:
    """The value of a word that is a count or a number of something.

    Raises:
        GcodeError: where it is negative or has a fraction.
    """
    if word.value < 0.0 or word.value != int(word.value):
        expected = f"{word.letter}0, 1, 2..."
        if (word.letter, word.value) == ("T", -1.0):
            expected += "; T-1 puts the tool back on a Carvera only, and its block can be deleted"
        raise block.error(word, "bad-value", f"{word.text} is not a whole number of 0 or more", expected)
    return int(word.value)


def not_negative(block: ParsedBlock, word: Word) -> float:
    """The value of a word that may not be negative.

    Raises:
        GcodeError: where it is.
    """
    if word.value < 0.0:
        raise block.error(word, "bad-value", f"{word.text} is negative", f"{word.letter} of 0 or more")
    return word.value


def set_modes(state: State, command: Command) -> Result:
    """Codes whose whole effect is one modal value."""
    uses = command.of_phase("modes")
    for rule, word in sorted(uses, key=lambda use: use.rule.code != "G80"):
        code = rule.code
        if code in _PLANE_OF_CODE:
            state = _with_plane(state, command, word, _PLANE_OF_CODE[code])
        elif code in _MODE_OF_CODE:
            name, value = _MODE_OF_CODE[code]
            state = state.with_modes(**{name: value})
        else:
            state = _with_motion(state, code)
    return state, ()


def _with_motion(state: State, code: str) -> State:
    """The state under a motion code; outside of a cycle nothing of the last cycle is kept."""
    modes = state.modes
    cancels = code == "G80"
    if cancels and "cycle" in state.control.dialect.codes["G80"].groups:
        code = modes.base_motion
    if code == modes.motion and not cancels:
        return state
    cycles = state.control.dialect.cycles
    if cycles is not None and code in cycles.cycles:
        return state.with_modes(motion=code)
    base = code if code in _BASE_MOTIONS else modes.base_motion
    return state.with_modes(motion=code, base_motion=base, in_cycle=False, rigid_tapping=False, spline_lead_mm=None)


def _with_plane(state: State, command: Command, word: Word, plane: int) -> State:
    if plane != state.machine.plane and state.compensates:
        problem = f"{word.text} while cutter compensation is on"
        raise command.block.error(word, "compensation-plane", problem, "G40 before another plane")
    return state.with_machine(plane=plane)


def set_feed_mode(state: State, command: Command) -> Result:
    """G93, G94, G95. A feed of another mode is no longer valid."""
    mode = _FEED_MODES[command.of_phase("feed_mode")[0].rule.code]
    if mode == state.machine.feed_mode:
        return state, ()
    return state.with_machine(feed_mode=mode).with_modes(feed=0.0), ()


def set_feed(state: State, command: Command) -> Result:
    """F, in program units a minute or a revolution, or per minute with inverse time."""
    feed = not_negative(command.block, command.words["F"])
    unit = 1.0 if state.machine.feed_mode == "inverse-time" else state.modes.unit_mm
    return state.with_modes(feed=feed * unit), ()


def set_speed_mode(state: State, command: Command) -> Result:
    """G96 and G97. With G96, S is a surface speed and the spindle's speed follows from the distance to X0."""
    _check_spindle_number(command)
    use = command.of_phase("speed_mode")[0]
    if use.rule.code == "G97":
        return state.with_modes(surface_speed=None), ()
    if "S" not in command.words and state.modes.surface_speed is None:
        raise command.block.error(use.word, "missing-speed", f"{use.word.text} without S", "S and a surface speed")
    limit = not_negative(command.block, command.words["D"]) if "D" in command.words else None
    return state.with_modes(surface_speed=state.modes.surface_speed or 0.0, surface_speed_limit=limit), ()


def set_speed(state: State, command: Command) -> Result:
    """S; the change is reported here unless a spindle code of the same block reports it."""
    _check_spindle_number(command)
    value = not_negative(command.block, command.words["S"])
    if state.modes.surface_speed is not None:
        metre = 1.0 if state.modes.unit_mm == 1.0 else 0.3048
        return state.with_modes(surface_speed=value * metre), ()
    changed = value != state.machine.spindle_rpm
    state = state.with_machine(spindle_rpm=value) if changed else state
    if not changed or command.of_phase("spindle_on"):
        return state, ()
    return state, (spindle_event(state, command),)


def set_spindle_on(state: State, command: Command) -> Result:
    """M3 and M4."""
    return _set_spindle(state, command, "spindle_on")


def set_spindle_off(state: State, command: Command) -> Result:
    """M5, and M19, which also stops the spindle."""
    for letter, (least, most) in _ORIENTATION.items():
        word = command.words.get(letter)
        if command.code("M19") and word is not None and not least <= word.value <= most:
            raise command.block.error(
                word, "bad-value", f"{word.text} with M19", f"{letter}{least:g} to {letter}{most:g}"
            )
    return _set_spindle(state, command, "spindle_off")


def _check_spindle_number(command: Command) -> None:
    """Refuses words for another spindle than the first: 0, or -1 for all."""
    word = command.words.get("$")
    if word is not None and word.value not in (0.0, -1.0):
        raise command.block.error(word, "unknown-spindle", f"{word.text} is another spindle", "$0, or $-1 for all")


def _set_spindle(state: State, command: Command, phase: str) -> Result:
    _check_spindle_number(command)
    direction = _SPINDLE[command.of_phase(phase)[0].rule.code]
    if direction != state.machine.spindle_direction:
        state = state.with_machine(spindle_direction=direction)
    return state, (spindle_event(state, command),)


def spindle_event(state: State, command: Command) -> SpindleChange:
    """The event that reports the present state of the spindle."""
    machine = state.machine
    return SpindleChange(
        place=command.block.place, spindle_rpm=machine.spindle_rpm, spindle_direction=machine.spindle_direction
    )


def select_tool(state: State, command: Command) -> Result:
    """T: the tool that the next M6 puts in, or that is in from here on where the control has no tool change."""
    word, dialect = command.words["T"], state.control.dialect
    number = whole_number(command.block, word)
    if dialect.largest_tool is not None and number > dialect.largest_tool:
        raise command.block.error(
            word, "bad-value", f"{word.text} is not a tool number", f"T0 to T{dialect.largest_tool}"
        )
    _check_tool(state, command, word, number)
    state = state.with_modes(next_tool=number)
    if not dialect.tool_word_changes or number == state.machine.tool:
        return state, ()
    return state.with_machine(tool=number), (ToolChange(place=command.block.place, tool=number),)


def _check_tool(state: State, command: Command, word: Word, number: int) -> None:
    """Refuses a tool that a control with a tool table does not know."""
    tools = state.setup.tools
    if number == 0 or number in tools or state.control.settings.tools is None:
        return
    if state.control.dialect.tools_must_be_known:
        known = ", ".join(f"T{n}" for n in sorted(tools)) or "none is given"
        raise command.block.error(
            word, "unknown-tool", f"{word.text} is not in the tool table", f"one from the table: {known}"
        )


def change_tool(state: State, command: Command) -> Result:
    """M6: the selected tool goes in, and the spindle stops. M61 Q: the tool that is in gets a number."""
    use = command.of_phase("tool_change")[0]
    if use.rule.code == "M61":
        return _name_tool(state, command, use.word)
    block, tool = command.block, state.modes.next_tool
    if tool is None:
        if not state.control.dialect.tool_defaults_to_present:
            text = f"{use.word.text} with no tool selected"
            raise block.error(use.word, "missing-tool", text, "a T word in this block or before it")
        tool = state.machine.tool
    events: tuple[Event, ...] = ()
    if state.machine.spindle_direction:
        state = state.with_machine(spindle_direction=0)
        events = (spindle_event(state, command),)
    return state.with_machine(tool=tool), (*events, ToolChange(place=block.place, tool=tool))


def _name_tool(state: State, command: Command, word: Word) -> Result:
    if "Q" not in command.words:
        raise command.block.error(word, "missing-tool", f"{word.text} without Q", "Q and the number of the tool")
    tool = whole_number(command.block, command.words["Q"])
    _check_tool(state, command, command.words["Q"], tool)
    return state.with_machine(tool=tool), (ToolChange(place=command.block.place, tool=tool),)


def set_rigid_tapping(state: State, _command: Command) -> Result:
    """M29: the tapping cycle that follows is rigid."""
    return state.with_modes(rigid_tapping=True), ()


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
    unit = rule.pointed if word.has_point else rule.seconds
    if unit is None:
        problem = f"{word.text} has a decimal point, but counts steps of {rule.seconds} s"
        raise block.error(word, "bad-dwell", problem, f"{word.letter} without a point, or X and seconds")
    seconds = not_negative(block, word) * unit
    return state, (Dwell(place=block.place, state=state.machine, seconds=seconds),)


def stop(state: State, command: Command) -> Result:
    """M0, M1, M2, M30 and the dialect's further stops."""
    code = command.of_phase("stop")[0].rule.code
    ends = code in _ENDS
    message = "; ".join(command.block.comments) if not ends else ""
    event = ProgramStop(place=command.block.place, optional=code == "M1", end=ends, message=message)
    return (replace(state, ended=True) if ends else state), (event,)


def notice(state: State, command: Command) -> Result:
    """Codes that are understood and cause no motion."""
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
    "feed_mode": set_feed_mode,
    "feed": set_feed,
    "speed_mode": set_speed_mode,
    "speed": set_speed,
    "tool": select_tool,
    "tool_change": change_tool,
    "spindle_on": set_spindle_on,
    "spindle_off": set_spindle_off,
    "rigid_tapping": set_rigid_tapping,
    "coolant_on": set_coolant_on,
    "coolant_off": set_coolant_off,
    "dwell": dwell,
    "stop": stop,
    "notice": notice,
}
