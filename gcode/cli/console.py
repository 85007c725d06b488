"""Standard output for results; standard error for messages and, on a terminal, progress.

All text of a command passes here, or through `gcode.cli.clean_console`: no character of a file, of its name or of its
values reaches the terminal as a control character.
"""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, TypeVar

from gcode.cli.name_lines import on_one_line
from gcode.underline import harmless, harmless_json

if TYPE_CHECKING:
    from rich.console import Console

    from gcode.bulk.plain_batch import PlainBatch
    from gcode.events import Event

_E = TypeVar("_E", "Event", "Event | PlainBatch")
#: Width of what is written to a file or a pipe.
WIDTH = 100
#: Progress is drawn again after this time at the earliest, s; the clock is read once per this many events.
_EVERY_S = 0.1
_EVERY_EVENTS = 256


class UnusableFileError(Exception):
    """A file that a command cannot use, other than the text of an NC program; the message names it and the reason."""


def results() -> Console:
    """Standard output for tables."""
    from gcode.cli.clean_console import CleanConsole

    return CleanConsole(width=None if sys.stdout.isatty() else WIDTH)


def say(text: str, *, colour: str | None = None, error: bool = False) -> None:
    """Prints a text.

    Args:
        colour: name of a colour, for terminals.
        error: on standard error.
    """
    _write(harmless(on_one_line(text)), colour, error=error)


def _write(text: str, colour: str | None, *, error: bool, bold: bool = False, end: str = "\n") -> None:
    """Writes a text as it is; colours are for terminals alone."""
    stream = sys.stderr if error else sys.stdout
    if stream.isatty():
        import typer

        typer.secho(text, fg=colour, bold=bold, err=error, nl=bool(end))
    else:
        stream.write(text + end)
        stream.flush()


def say_json(text: str) -> None:
    """Prints JSON."""
    _write(harmless_json(text), None, error=False)


def fail(message: str) -> None:
    """Prints an error, if standard error takes it."""
    with contextlib.suppress(OSError):
        _write("error:", "red", error=True, bold=True, end="")
        say(f" {message}", error=True)


def with_progress(events: Iterable[_E], name: str) -> Iterator[_E]:
    """Hands events on, and shows on a terminal how far the program has come.

    Args:
        name: of the program.
    """
    if not sys.stderr.isatty():
        yield from events
        return
    from rich.text import Text

    from gcode.cli.clean_console import CleanConsole

    with CleanConsole(stderr=True).status(Text(f"{name}: reading")) as status:
        drawn = time.monotonic()
        for number, event in enumerate(events, start=1):
            yield event
            if number % _EVERY_EVENTS == 0 and time.monotonic() - drawn >= _EVERY_S:
                drawn = time.monotonic()
                status.update(Text(f"{name}: line {event.place.line}"))
