"""How far a mold has come, on a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from twin.cli.console import errors


@contextmanager
def mold_progress(*, quiet: bool) -> Iterator[Callable[[str, float], None]]:
    """A line with what is done, a bar and the time left; nothing where standard error is no terminal."""
    if quiet or not sys.stderr.isatty():
        yield lambda _what, _part: None
        return
    from rich import progress as rich

    bar = rich.Progress(
        rich.TextColumn("{task.description}", style="bold"),
        rich.BarColumn(bar_width=28),
        rich.TaskProgressColumn(),
        rich.TimeRemainingColumn(compact=True),
        rich.TextColumn("left"),
        console=errors(),
        transient=True,
    )
    task = bar.add_task("preparing", total=1.0)
    with bar:
        yield lambda what, part: bar.update(task, description=what, completed=part)
