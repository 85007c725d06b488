"""From arguments to an exit code: every error that a user can correct is one message, never a traceback."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from gcode.cli import direct, exit_codes
from gcode.cli.name_lines import set_names
from gcode.cli.signals import end_in_order, ignore_signals, report_stop
from gcode.cli.streams import failed_output, finish_streams, prepare_streams
from gcode.errors import GcodeError

if TYPE_CHECKING:
    import typer


def console_script(run: Callable[[Sequence[str]], int]) -> None:
    """Carries out the process's own arguments, and exits."""
    prepare_streams()
    end_in_order()
    try:
        code = run(sys.argv[1:])
    except KeyboardInterrupt:
        report_stop()
        code = exit_codes.SIGNAL + signal.SIGINT
    ignore_signals()
    finish_streams()
    sys.exit(code)


def run(arguments: Sequence[str]) -> int:
    """Carries out a command line.

    Args:
        arguments: without the program's name.

    Returns:
        The exit code, see `gcode.cli.exit_codes`.
    """
    from gcode.cli.console import UnusableFileError, fail

    simple = direct.simple_command(arguments)
    try:
        if simple is not None:
            set_names(arguments)
            code = direct.carry_out(simple)
        else:
            from gcode.cli.app import app

            code = carry_out(app, arguments, "gcode")
        sys.stdout.flush()
    except OSError as error:
        return failed_output(error)
    except UnusableFileError as error:
        fail(str(error))
    except GcodeError as error:
        fail(error.underlined())
    except MemoryError:
        fail("not enough memory")
    else:
        return code
    return exit_codes.ERROR


def carry_out(app: typer.Typer, arguments: Sequence[str], name: str) -> int:
    """Runs a command of `app`; a wrong use of the command line is one message.

    Args:
        app: the commands.
        arguments: without the program's name.
        name: of the program.

    Returns:
        The exit code that the command ends with.
    """
    import typer

    from gcode.cli.console import fail

    # Typer's error for a wrong use of the command line; it exports this one of its subclasses only.
    usage_error: type[Exception] = typer.BadParameter.__mro__[1]
    set_names(arguments)
    try:
        code = app(args=list(arguments) or ["--help"], prog_name=name, standalone_mode=False)
        code = code if arguments else exit_codes.USAGE
    except usage_error as error:
        context = getattr(error, "ctx", None)
        command = name if context is None else context.command_path
        message = str(error.format_message()).rstrip(".").replace(": Value error, ", ": ")  # type: ignore[attr-defined]
        fail(f"{message}; see '{command} --help'")
        return exit_codes.USAGE
    except typer.Abort:
        return exit_codes.SIGNAL + signal.SIGINT
    except SystemExit as end:
        if isinstance(end.__context__, BrokenPipeError):  # typer would end with another code
            return failed_output(end.__context__)
        code = end.code
    return code if isinstance(code, int) else exit_codes.OK
