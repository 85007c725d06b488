"""The interpreter: lines of a program -> events, one block after another.

    lines -> `program` -> `parse` (words, statements) -> `runner` (`flow`: jumps and calls)
          -> `step`: `modal` (codes looked up) -> phases (`actions`, `offsets`, `motion`, ...) -> `compensated`

`step` is the whole semantics of a block of words and a pure function; `interpret` and `check` only feed it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from gcode.bulk.plain_runs import PlainBatch, expand
from gcode.dialects import DIALECTS, FANUC, Dialect
from gcode.errors import GcodeError, Place
from gcode.events import Event
from gcode.flow.runner import Runner
from gcode.flow.step import step
from gcode.language.foreign import recognise
from gcode.language.program import Program, program_of, read_program
from gcode.settings import MachineSettings

__all__ = ["check", "interpret", "interpret_file", "read_program", "run", "step"]

Text = str | bytes | Iterable[str] | Program


def interpret(
    source: Text,
    *,
    file: str = "<program>",
    dialect: Dialect = FANUC,
    settings: MachineSettings | None = None,
) -> Iterator[Event]:
    """Runs a program.

    Args:
        source: the program's text, its lines, or what `read_program` gives for a file.
        file: name for places in events and errors; that of a file is its own.
        dialect: the control whose language the program is in.
        settings: the machine at the program's start; default `MachineSettings()`.

    Yields:
        The events of the program in the order of execution, up to its end (M2, M30, closing %).

    Raises:
        GcodeError: at the first block that is refused; the events before it have been yielded.
    """
    for event in run(source, file=file, dialect=dialect, settings=settings):
        if isinstance(event, PlainBatch):
            yield from expand(event)
        else:
            yield event


def interpret_file(
    path: Path | str, *, dialect: Dialect = FANUC, settings: MachineSettings | None = None
) -> Iterator[Event]:
    """Runs a program file; see `interpret`."""
    return interpret(read_program(path), dialect=dialect, settings=settings)


def run(
    source: Text,
    *,
    file: str = "<program>",
    dialect: Dialect = FANUC,
    settings: MachineSettings | None = None,
) -> Iterator[Event | PlainBatch]:
    """Runs a program as `interpret` does, with runs of plain straight motions left together for speed.

    Yields:
        Events, and `PlainBatch`es that stand for the events of many blocks.
    """
    program = _program(source, file)
    _refuse_foreign(program)
    yield from Runner(program, dialect, settings or MachineSettings(), _raise).run()


def check(
    source: Text,
    *,
    file: str = "<program>",
    dialect: Dialect = FANUC,
    settings: MachineSettings | None = None,
) -> list[GcodeError]:
    """Runs a program for its mistakes: after a refused block it goes on with the next one (see `recover`).

    Arguments as for `interpret`.

    Returns:
        The refusals in the order of execution, `Limits.errors` at most; empty for a program that runs.
    """
    settings = settings or MachineSettings()
    errors: list[GcodeError] = []
    try:
        program = _program(source, file)
        _refuse_foreign(program)
        for _ in Runner(program, dialect, settings, errors.append).run():
            if len(errors) >= settings.limits.errors:
                break
    except GcodeError as error:
        errors.append(error)
    return errors[: settings.limits.errors]


def _program(source: Text, file: str) -> Program:
    return source if isinstance(source, Program) else program_of(source, file)


def _refuse_foreign(program: Program) -> None:
    """Refuses a text that another kind of control, or none, understands.

    Raises:
        GcodeError: where its first part says so.
    """
    foreign = recognise(program.head)
    if foreign is not None:
        text = program.head.split("\n")[foreign.line - 1]
        place = Place(file=program.file, line=foreign.line, column=foreign.column, text=text)
        problem = f"a program for {foreign.control}: {foreign.marker!r} is {foreign.reason}"
        *most, last = DIALECTS
        raise GcodeError(place, "foreign-control", problem, f"a program for {', '.join(most)} or {last}")


def _raise(error: GcodeError) -> None:
    raise error
