"""What is said beside results: messages on standard error, progress on a terminal, and the end of a pipe."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

import typer

from gcode.cli import exit_codes
from gcode.underline import harmless

if TYPE_CHECKING:
    from rich.console import Console

    from gcode.events import Event

#: Width of what is written to a file or a pipe.
WIDTH = 100
#: Progress is drawn anew at most this often, s, and looked at every so many events.
_EVERY_S = 0.1
_EVERY_EVENTS = 256
_SIGPIPE = 13


class UnusableFileError(Exception):
    """A file other than an NC program's text that a command cannot use; the text says which and why."""


def results() -> Console:
    """Standard output for tables."""
    from rich.console import Console

    return Console(highlight=False, width=None if sys.stdout.isatty() else WIDTH)


def fail(message: str) -> None:
    """Say what is wrong."""
    typer.secho("error:", fg=typer.colors.RED, bold=True, err=True, nl=False)
    typer.echo(f" {harmless(message)}", err=True)


@contextlib.contextmanager
def written() -> Iterator[None]:
    """What is written to standard output inside: when its reader has gone, the command ends without a word."""
    try:
        yield
        sys.stdout.flush()
    except BrokenPipeError:
        with contextlib.suppress(OSError, ValueError):  # what is left in the buffer has nowhere to go
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise typer.Exit(exit_codes.SIGNAL + _SIGPIPE) from None


def with_progress(events: Iterable[Event], name: str) -> Iterator[Event]:
    """Hands events on, and tells on a terminal how far the program has come.

    Args:
        name: of the program.
    """
    if not sys.stderr.isatty():
        yield from events
        return
    from rich.console import Console

    console = Console(stderr=True, highlight=False)
    with console.status(f"{name}: reading") as status:
        drawn = time.monotonic()
        for number, event in enumerate(events, start=1):
            yield event
            if number % _EVERY_EVENTS == 0 and time.monotonic() - drawn >= _EVERY_S:
                drawn = time.monotonic()
                status.update(f"{name}: line {event.place.line}")
