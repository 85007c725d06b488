"""Standard output for results, standard error for messages."""

from __future__ import annotations

import contextlib
import json
from typing import Any

from rich.text import Text

from gcode.cli.clean_console import CleanConsole
from gcode.cli.console import results, say, say_json

__all__ = ["errors", "fail", "note", "print_json", "results", "say", "say_json", "warn"]


def errors() -> CleanConsole:
    """Standard error; messages are never wrapped, so that they can be searched and copied."""
    return CleanConsole(stderr=True, soft_wrap=True)


def warn(message: str) -> None:
    """Print something that needs attention, if standard error takes it; the program goes on."""
    with contextlib.suppress(OSError):
        errors().print(Text.assemble(("warning:", "bold yellow"), " ", message))


def note(message: str) -> None:
    """Print something worth knowing that needs no action, if standard error takes it."""
    with contextlib.suppress(OSError):
        errors().print(Text.assemble(("note:", "bold"), " ", message))


def fail(message: str) -> None:
    """Print the error that ended the program, if standard error takes it."""
    with contextlib.suppress(OSError):
        errors().print(Text.assemble(("error:", "bold red"), " ", message))


def print_json(value: Any) -> None:
    """Print one JSON object."""
    say_json(json.dumps(value, indent=2, ensure_ascii=False))
