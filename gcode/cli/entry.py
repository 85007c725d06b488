"""From arguments to an exit code: what a user can mend is one message, never a traceback."""

from __future__ import annotations

import io
import sys
from collections.abc import Sequence

from gcode.cli import exit_codes
from gcode.errors import GcodeError


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
        the exit code, see `gcode.cli.exit_codes`.
    """
    from gcode.cli.app import app
    from gcode.cli.console import UnusableFileError, fail

    try:
        app(args=list(arguments), prog_name="gcode")
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else exit_codes.OK
    except UnusableFileError as error:
        fail(str(error))
        return exit_codes.USAGE
    except GcodeError as error:
        fail(error.underlined())
    except MemoryError:
        fail("not enough memory")
    return exit_codes.MISTAKES
