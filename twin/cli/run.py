"""From arguments to an exit code: every error that a user can correct is one message, never a traceback."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from gcode.cli.console import closed_pipe
from gcode.cli.entry import carry_out, console_script
from gcode.errors import GcodeError
from twin.cli import exit_codes
from twin.errors import SettingsError, TwinError


def main() -> None:
    """The console script."""
    console_script(run)


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
        code = carry_out(app, arguments, "twin")
        sys.stdout.flush()
    except BrokenPipeError:
        return closed_pipe()
    except (TwinError, GcodeError) as error:
        fail(message_of(error))
    except MemoryError:
        fail("not enough memory; a larger simulation.slice_pitch_mm needs less")
    else:
        return code
    return exit_codes.ERROR


def message_of(error: TwinError | GcodeError) -> str:
    """The message to print: the mistakes of a job file as a list, a refused block with a caret under the word."""
    if isinstance(error, GcodeError):
        return error.underlined()
    if isinstance(error, SettingsError) and len(error.problems) > 1:
        return "\n".join([f"{error.file}: {len(error.problems)} mistakes", *(f"  {p}" for p in error.problems)])
    return str(error)
