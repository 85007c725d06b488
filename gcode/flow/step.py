"""The whole semantics of one block of words, as a pure function."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from gcode.control.command import Command, control_text_notice, resolve
from gcode.control.state import State
from gcode.events import Block, Event, Notice, ProgramStop
from gcode.flow.requests import CALL_ACTIONS
from gcode.language.blocks import ParsedBlock
from gcode.phases.cutter_compensation import RADIUS_ACTIONS, through
from gcode.phases.g10 import DATA_ACTIONS
from gcode.phases.modes import ACTIONS, Action, not_negative, whole_number
from gcode.phases.motions import MOTION_ACTIONS
from gcode.phases.offsets import OFFSET_ACTIONS
from gcode.phases.transforms import TRANSFORM_ACTIONS

#: All phases of a block by name: what `Dialect.order` puts in order.
PHASES: Mapping[str, Action] = MappingProxyType(
    {
        **ACTIONS,
        **OFFSET_ACTIONS,
        **DATA_ACTIONS,
        **TRANSFORM_ACTIONS,
        **RADIUS_ACTIONS,
        **MOTION_ACTIONS,
        **CALL_ACTIONS,
    }
)


def step(state: State, block: ParsedBlock, *, first_of_program: bool = False) -> tuple[State, tuple[Event, ...]]:
    """Executes one block.

    Args:
        state: the control before the block; it is not changed.
        block: the block as parsed, its words plain numbers.
        first_of_program: the block is the first of its program, so that its O word names the program.

    Returns:
        The control after the block, and the block's events in the order of execution, a `Block` first. Lines without
        words have none.

    Raises:
        GcodeError: where the block is refused; `state` then remains valid.
    """
    if block.percent:
        return _percent(state, block)
    if block.deleted:
        return state, (
            Notice(place=block.place, code="block-deleted", text="block delete is on: the block is skipped"),
        )
    if not block.words:
        return state, ()
    command = resolve(state, block)
    if "N" in command.words or "O" in command.words:
        state = _numbers(state, block, first_of_program=first_of_program)
    if not state.started:
        state = replace(state, started=True)
    return _run_phases(state, command)


def _run_phases(state: State, command: Command) -> tuple[State, tuple[Event, ...]]:
    machine_move = command.code("G53")
    if machine_move and "motion" not in command.phases:
        word = machine_move.word
        raise command.block.error(word, "missing-axis", f"{word.text} names no axis", "at least one of X, Y, Z")
    events: list[Event] = [Block(place=command.block.place)]
    if command.notices:
        events.extend(command.notices)
    if state.waiting is not None:
        state, ready = through(state, None, tuple(events))
        events = list(ready)
    if state.compensates:
        _check_under_compensation(state, command)
    for phase in command.phases:
        state, more = PHASES[phase](state, command)
        # a call is carried out at once, whatever waits: the blocks that it leads to are what the motion waits for
        if phase in ("radius", "call", "state") or (state.waiting is None and not _asks_corner(command)):
            events.extend(more)
        else:
            state, ready = through(state, command if phase == "motion" else None, more)
            events.extend(ready)
    return state, tuple(events)


def _check_under_compensation(state: State, command: Command) -> None:
    """Refuses codes that a control does not execute while cutter compensation is on."""
    off = command.code("G40") is not None
    for use in command.uses:
        if use.rule.phase in state.control.dialect.not_compensated and not off:
            problem = f"{use.word.text} while cutter compensation is on"
            raise command.block.error(use.word, "compensation-on", problem, "G40 before it")


def _asks_corner(command: Command) -> bool:
    return ",C" in command.words or ",R" in command.words


def _percent(state: State, block: ParsedBlock) -> tuple[State, tuple[Event, ...]]:
    """The first percent sign starts a program, the next, or one after blocks, ends it."""
    if not state.started:
        dialect = state.control.dialect
        notices = (control_text_notice(dialect, block.place, "%"),) if "%" in dialect.senders_text else ()
        return replace(state, started=True), notices
    state, events = through(state, None, (ProgramStop(place=block.place, optional=False, end=True),))
    return replace(state, ended=True), events


def _numbers(state: State, block: ParsedBlock, *, first_of_program: bool) -> State:
    """Checks N and O; a second O is another program, which this one does not run into."""
    for word in block.words:
        if word.letter in "NO":
            if word.letter == "N" and not state.control.dialect.whole_block_numbers:
                if word is not block.words[0]:
                    raise block.error(word, "block-number-place", f"{word.text} inside a block", "N at its start")
                number = not_negative(block, word)
                largest = state.control.dialect.largest_block_number
                if largest is not None and number > largest:
                    raise block.error(word, "bad-value", f"{word.text} is not a block number", f"N0 to N{largest}")
                continue
            number = whole_number(block, word)
            if word.letter == "O":
                if state.modes.program is not None and not first_of_program:
                    problem = f"{word.text} begins another program before the end of O{state.modes.program}"
                    raise block.error(word, "program-number", problem, "M2, M30 or % before it")
                state = state.with_modes(program=number)
    return state
