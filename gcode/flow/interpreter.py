"""The interpreter: lines of a program -> events, one block after another.

    lines -> `language.program` -> `language.block_parser` (words, statements) -> `flow.runner` (jumps, calls)
          -> `flow.step`: `control.command` (codes looked up) -> `phases` (modes, offsets, motions) -> events

`step` is the whole semantics of a block of words and a pure function; `interpret` and `check` only drive it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TypeAlias

from gcode.bulk.plain_batch import PlainBatch, expand
from gcode.dialects import AUTO, DIALECTS, FANUC, Dialect, dialect_named
from gcode.errors import GcodeError, Place
from gcode.events import Event, Notice
from gcode.flow.runner import Runner
from gcode.language.foreign import recognise
from gcode.language.likely_dialect import Likely, better, by_suffix, likeliest
from gcode.language.program import Program, program_of, read_program
from gcode.settings import MachineSettings

#: A program: its text, its lines, the path of its file, or the result of `read_program`.
ProgramSource: TypeAlias = str | bytes | Iterable[str] | Path | Program


def interpret(
    source: ProgramSource,
    *,
    file: str = "<program>",
    dialect: Dialect | str = FANUC,
    settings: MachineSettings | None = None,
) -> Iterator[Event]:
    """Runs a program.

    Args:
        source: the program's text, its lines, the path of its file (a `Path`), or the result of `read_program`.
        file: name of a text in places of events and errors; a file is named by its path.
        dialect: the control whose language the program is in, or its name: ``"haas"``; ``"auto"`` for the one that
            the program fits best, which a notice names.
        settings: the machine at the program's start; default `MachineSettings()`.

    Yields:
        The events of the program in the order of execution, up to its end (M2, M30, closing %). A notice comes first
        where the program looks like one in another dialect.

    Raises:
        GcodeError: at the first block that is refused; the events before it have been yielded.
        ValueError: for an unknown name of a dialect.
    """
    for event in run(source, file=file, dialect=dialect, settings=settings):
        if isinstance(event, PlainBatch):
            yield from expand(event)
        else:
            yield event


def interpret_file(
    path: Path | str, *, dialect: Dialect | str = FANUC, settings: MachineSettings | None = None
) -> Iterator[Event]:
    """Runs a program file.

    Args:
        path: the file.
        dialect: the control whose language the program is in, or its name.
        settings: the machine at the program's start; default `MachineSettings()`.

    Yields:
        The events of the program; see `interpret`.

    Raises:
        GcodeError: for a file that cannot be read, and at the first block that is refused.
    """
    return interpret(read_program(path), dialect=dialect, settings=settings)


def run(
    source: ProgramSource,
    *,
    file: str = "<program>",
    dialect: Dialect | str = FANUC,
    settings: MachineSettings | None = None,
) -> Iterator[Event | PlainBatch]:
    """Runs a program as `interpret` does, but keeps runs of plain lines together, for speed.

    Arguments and errors as for `interpret`.

    Yields:
        Events, and `PlainBatch`es that represent the events of many blocks.
    """
    program = _program(source, file)
    _refuse_foreign(program)
    taken, notice = taken_dialect(program, dialect)
    if notice is not None:
        yield notice
    try:
        yield from Runner(program, taken, settings or MachineSettings(), _raise).run()
    except GcodeError as error:
        other = better(program, taken)
        if other is not None and not error.hint:
            error.hint = _looks_like(program, other).text
        raise


def check(
    source: ProgramSource,
    *,
    file: str = "<program>",
    dialect: Dialect | str = FANUC,
    settings: MachineSettings | None = None,
) -> list[GcodeError]:
    """Finds the errors of a program: after a refused block it continues with the next one (see `flow.recovery`).

    Arguments as for `interpret`.

    Returns:
        The errors in the order of execution, at most `Limits.errors` of them; empty for a program that runs.
    """
    return examine(source, file=file, dialect=dialect, settings=settings)[0]


def examine(
    source: ProgramSource,
    *,
    file: str = "<program>",
    dialect: Dialect | str = FANUC,
    settings: MachineSettings | None = None,
) -> tuple[list[GcodeError], list[Notice]]:
    """The errors of a program as `check` finds them, and its notices up to the first of them.

    Arguments as for `interpret`.
    """
    settings = settings or MachineSettings()
    errors: list[GcodeError] = []
    notices: list[Notice] = []
    try:
        program = _program(source, file)
        _refuse_foreign(program)
        taken, notice = taken_dialect(program, dialect)
        for event in Runner(program, taken, settings, errors.append).run():
            if len(errors) >= settings.limits.errors:
                break
            if isinstance(event, Notice) and not errors:
                notices.append(event)
        other = better(program, taken) if errors else None
        notice = notice if other is None else _looks_like(program, other)
        notices[:0] = [] if notice is None else [notice]
    except GcodeError as error:
        errors.append(error)
    return errors[: settings.limits.errors], notices


def taken_dialect(program: Program, dialect: Dialect | str) -> tuple[Dialect, Notice | None]:
    """The dialect to read a program in, and a notice where it was found or the file's name speaks for another one."""
    if dialect == AUTO:
        found = likeliest(program)
        text = f"the dialect is taken as {found.dialect.name}: {found.reason}"
        return found.dialect, Notice(place=Place(file=program.file, line=1), code="auto-dialect", text=text)
    taken = dialect_named(dialect) if isinstance(dialect, str) else dialect
    other = by_suffix(program, taken)
    return taken, None if other is None else _looks_like(program, other)


def _looks_like(program: Program, other: Likely) -> Notice:
    text = (
        f"the program looks like one for {other.dialect.name} ({other.reason}); expected dialect {other.dialect.name}"
    )
    return Notice(place=Place(file=program.file, line=1), code="other-dialect", text=text)


def _program(source: ProgramSource, file: str) -> Program:
    if isinstance(source, Program):
        return source
    return read_program(source) if isinstance(source, Path) else program_of(source, file)


def _refuse_foreign(program: Program) -> None:
    """Refuses a text for another kind of control, and one that is not a program.

    Raises:
        GcodeError: where the beginning of the text shows it.
    """
    foreign = recognise(program.head)
    if foreign is not None:
        text = program.head.split("\n")[foreign.line - 1]
        place = Place(file=program.file, line=foreign.line, column=foreign.column, text=text)
        what = foreign.control if foreign.is_file else f"a program for {foreign.control}"
        problem = f"{what}: {foreign.marker!r} is {foreign.reason}"
        *most, last = DIALECTS
        raise GcodeError(place, "foreign-control", problem, f"a program for {', '.join(most)} or {last}")


def _raise(error: GcodeError) -> None:
    raise error
