"""Standard output and standard error that are full, closed, or a pipe without a reader."""

from __future__ import annotations

import contextlib
import io
import os
import signal
import sys
from collections.abc import Iterator
from typing import TextIO

from gcode.cli import exit_codes


def prepare_streams() -> None:
    """Replace characters that a terminal cannot show; make closed streams ones that fail when they are written."""
    if sys.stdout is None:
        sys.stdout = _closed(1)
    if sys.stderr is None:
        sys.stderr = _closed(2)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def finish_streams() -> None:
    """Write what is left, and drop what cannot be written: Python itself would end with a code of its own."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            drop(stream)


def drop(stream: TextIO) -> None:
    """Let everything that a stream still has, or gets, go nowhere."""
    with contextlib.suppress(OSError, ValueError):
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, stream.fileno())
        os.close(null)


def failed_output(error: OSError) -> int:
    """End after an error of the system: nothing if the reader of a pipe is gone, else one message.

    Returns:
        The exit code.
    """
    from gcode.cli.console import fail

    if isinstance(error, BrokenPipeError):
        drop(sys.stdout)
        return exit_codes.SIGNAL + signal.SIGPIPE
    text = error.strerror or str(error)
    text = text[:1].lower() + text[1:]
    if error.filename is None:
        drop(sys.stdout)
        fail(f"standard output: cannot be written: {text}")
    else:
        fail(f"{error.filename}: {text}")
    return exit_codes.ERROR


@contextlib.contextmanager
def closed_pipe_ends() -> Iterator[None]:
    """A reader that closes the pipe of standard output ends the command; typer would end it with another code."""
    try:
        yield
    except BrokenPipeError as error:
        import typer

        raise typer.Exit(failed_output(error)) from None


def _closed(number: int) -> TextIO:
    """A stream in place of a closed one; no file that is opened later gets its number."""
    file = os.open(os.devnull, os.O_RDONLY)
    if file != number:
        os.dup2(file, number)
        os.close(file)
    return open(number, "w", encoding="utf-8", closefd=False)
