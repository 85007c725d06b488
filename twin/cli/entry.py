"""From arguments to an exit code: every error that a user can correct is one message, never a traceback."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from gcode.cli.entry import carry_out
from gcode.cli.streams import failed_output
from gcode.errors import GcodeError
from twin.cli import exit_codes
from twin.errors import SettingsError, TwinError

#: Commands whose memory is that of the slices.
_REPLAYING = ("replay", "verify", "mesh")


def run(arguments: Sequence[str]) -> int:
    """Carry out a command line.

    Args:
        arguments: without the program's name.

    Returns:
        the exit code, see `twin.cli.exit_codes`.
    """
    from twin.cli.app import app_for
    from twin.cli.console import fail

    try:
        code = carry_out(app_for(arguments), arguments, "twin")
        sys.stdout.flush()
    except OSError as error:
        return failed_output(error)
    except (TwinError, GcodeError) as error:
        fail(message_of(error))
    except MemoryError:
        replayed = next(iter(arguments), "") in _REPLAYING
        fail(f"not enough memory{'; a larger simulation.slice_pitch_mm needs less' if replayed else ''}")
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
