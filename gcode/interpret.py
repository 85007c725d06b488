"""The interpreter: lines of a program -> events, one block after another.

    lines -> `source` -> `parse` (words) -> `modal` (codes looked up) -> `phases` (`actions`, `motion`, `arcs`)

`step` is the whole semantics and a pure function; `interpret` and `check` only feed it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from gcode.actions import whole_number
from gcode.blocks import ParsedBlock
from gcode.dialects import FANUC, Dialect
from gcode.errors import GcodeError, Place
from gcode.events import Block, Event, Notice, ProgramStop
from gcode.modal import resolve
from gcode.parse import parse_line
from gcode.phases import PHASES
from gcode.recover import recovered
from gcode.settings import MachineSettings
from gcode.source import after_leader, numbered, read_program
from gcode.state import State, initial_state


def step(state: State, block: ParsedBlock) -> tuple[State, tuple[Event, ...]]:
    """Executes one block.

    Args:
        state: the control before the block; it is not changed.
        block: the block as parsed.

    Returns:
        The control after the block, and the block's events in the order of execution, a `Block` first. Lines without
        words have none.

    Raises:
        GcodeError: where the block is refused; then `state` holds on as a whole.
    """
    if block.percent:
        return _percent(state, block)
    if block.deleted:
        return state, (Notice(place=block.place, code="block-deleted", text="block delete: not executed"),)
    if not block.words:
        return state, ()
    command = resolve(state, block)
    if "N" in command.words or "O" in command.words:
        state = _numbers(state, block)
    if not state.started:
        state = replace(state, started=True)
    events: list[Event] = [Block(place=block.place)]
    for phase in command.phases:
        state, more = PHASES[phase](state, command)
        events.extend(more)
    return state, tuple(events)


def _percent(state: State, block: ParsedBlock) -> tuple[State, tuple[Event, ...]]:
    """The first percent sign starts a program, the next, or one after blocks, ends it."""
    if not state.started:
        return replace(state, started=True), ()
    return replace(state, ended=True), (ProgramStop(place=block.place, optional=False, end=True),)


def _numbers(state: State, block: ParsedBlock) -> State:
    """Checks N and O; a second O is another program, which this one does not run into."""
    for word in block.words:
        if word.letter in "NO":
            number = whole_number(block, word)
            if word.letter == "O":
                if state.modes.program is not None:
                    problem = f"{word.text} begins another program before the end of O{state.modes.program}"
                    raise block.error(word, "program-number", problem, "M2, M30 or % before it")
                state = state.with_modes(program=number)
    return state


def interpret(
    source: str | Iterable[str],
    *,
    file: str = "<program>",
    dialect: Dialect = FANUC,
    settings: MachineSettings | None = None,
) -> Iterator[Event]:
    """Runs a program.

    Args:
        source: the program's text, or its lines (`read_program` gives those of a file); lines are read as needed.
        file: name for places in events and errors.
        dialect: the control whose language the program is in.
        settings: the machine at the program's start; default `MachineSettings()`.

    Yields:
        The events of the program in the order of execution, up to its end (M2, M30, closing %).

    Raises:
        GcodeError: at the first block that is refused; the events before it have been yielded.
    """
    return _run(source, file, dialect, settings or MachineSettings(), _raise)


def interpret_file(
    path: Path | str, *, dialect: Dialect = FANUC, settings: MachineSettings | None = None
) -> Iterator[Event]:
    """Runs a program file; see `interpret`."""
    return interpret(read_program(path), file=str(path), dialect=dialect, settings=settings)


def check(
    source: str | Iterable[str],
    *,
    file: str = "<program>",
    dialect: Dialect = FANUC,
    settings: MachineSettings | None = None,
) -> list[GcodeError]:
    """Runs a program for its mistakes: after a refused block it goes on with the next one (see `recover`).

    Arguments as for `interpret`.

    Returns:
        All refusals in the order of the program; empty for a program that runs.
    """
    errors: list[GcodeError] = []
    try:
        for _ in _run(source, file, dialect, settings or MachineSettings(), errors.append):
            pass
    except GcodeError as error:
        errors.append(error)
    return errors


def _run(
    source: str | Iterable[str],
    file: str,
    dialect: Dialect,
    settings: MachineSettings,
    refuse: Callable[[GcodeError], None],
) -> Iterator[Event]:
    """The events of a program; refused blocks go to `refuse`, and if that returns, the program goes on."""
    leader, places = after_leader(numbered(source, file), dialect)
    if leader:
        text = f"lines 1 to {leader.line}, before the first %, are not executed"
        yield Notice(place=leader, code="leader", text=text)
    state = initial_state(dialect, settings)
    place = Place(file=file, line=1)
    for place in places:
        block = None
        try:
            block = parse_line(place, dialect, block_delete=settings.block_delete)
            state, events = step(state, block)
        except GcodeError as error:
            refuse(error)
            state = recovered(state, block, error) if block else state
            continue
        yield from events
        if state.ended:
            return
    yield Notice(place=place, code="no-program-end", text="the program ends without M2, M30 or %")


def _raise(error: GcodeError) -> None:
    raise error
