"""The two streams that people read."""

from __future__ import annotations

import sys

from rich.console import Console
from rich.text import Text

#: Width of what is written to a file or a pipe.
WIDTH = 100


def results() -> Console:
    """Standard output."""
    return Console(highlight=False, width=None if sys.stdout.isatty() else WIDTH)


def errors() -> Console:
    """Standard error; messages are never wrapped, so that they can be searched and copied."""
    return Console(stderr=True, highlight=False, soft_wrap=True)


def warn(message: str) -> None:
    """Say something that needs attention and stops nothing."""
    errors().print(Text.assemble(("warning:", "bold yellow"), " ", message))


def fail(message: str) -> None:
    """Say what ended the program."""
    errors().print(Text.assemble(("error:", "bold red"), " ", message))
