"""From arguments to an exit code: what a user can mend is one message, never a traceback."""

from __future__ import annotations

import io
import sys
from collections.abc import Sequence

from gcode.errors import GcodeError
from twin.cli import exit_codes
from twin.errors import SettingsError, TwinError


def main() -> None:
    """The console script."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    sys.exit(run(sys.argv[1:]))


def run(arguments: Sequence[str]) -> int:
    """Carry out a command line.

    Args:
        arguments: without the program's name.

    Returns:
        the exit code, see `twin.cli.exit_codes`.
    """
    from twin.cli.app import app
    from twin.cli.console import fail

    try:
        app(args=list(arguments), prog_name="twin")
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else exit_codes.ERROR
    except (TwinError, GcodeError) as error:
        fail(message_of(error))
    except MemoryError:
        fail("not enough memory; a larger simulation.slice_pitch_mm needs less")
    return exit_codes.ERROR


def message_of(error: TwinError | GcodeError) -> str:
    """What to print: a job file's mistakes as a list, a refused block with a caret under the word."""
    if isinstance(error, GcodeError):
        return error.underlined()
    if isinstance(error, SettingsError) and len(error.problems) > 1:
        return "\n".join([f"{error.file}: {len(error.problems)} mistakes", *(f"  {p}" for p in error.problems)])
    return str(error)
