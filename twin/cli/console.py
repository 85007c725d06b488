"""Standard output for results, standard error for messages."""

from __future__ import annotations

from rich.console import Console
from rich.text import Text

from gcode.cli.console import results

__all__ = ["errors", "fail", "results", "warn"]


def errors() -> Console:
    """Standard error; messages are never wrapped, so that they can be searched and copied."""
    return Console(stderr=True, highlight=False, soft_wrap=True)


def warn(message: str) -> None:
    """Print something that needs attention; the program goes on."""
    errors().print(Text.assemble(("warning:", "bold yellow"), " ", message))


def fail(message: str) -> None:
    """Print the error that ended the program."""
    errors().print(Text.assemble(("error:", "bold red"), " ", message))
