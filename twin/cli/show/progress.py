"""Progress of a run or a computation, on the terminal."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Protocol, Self

from twin.cli.console import errors
from twin.number_format import clock
from twin.record import NcEvent, Record, RunHeader, Step

#: Least time between two updates of the line, s.
_EVERY_S = 0.1


class Progress(Protocol):
    """Shows how far a run has come."""

    def start(self, total_s: float) -> None:
        """The run begins; its whole machine time is known."""

    def at(self, t_s: float, nc_line: int) -> None:
        """The run is at this machine time and NC line."""

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def progress(*, quiet: bool) -> Progress:
    """A line on the terminal; nothing where standard error is not a terminal, or when ``quiet``."""
    return NoProgress() if quiet or not sys.stderr.isatty() else LineProgress()


def report(line: Progress, record: Record) -> None:
    """Show how far a run has come, from the record at hand."""
    if isinstance(record, Step | NcEvent):
        line.at(record.t_s, record.nc_line)
    elif isinstance(record, RunHeader):
        line.start(record.planned_time_s)


class NoProgress:
    """Shows nothing."""

    def start(self, total_s: float) -> None:
        """Nothing."""

    def at(self, t_s: float, nc_line: int) -> None:
        """Nothing."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None: ...


class LineProgress:
    """One line with bar, percent, machine time, real-time factor, time left and NC line; removed at the end.

    Args:
        now: seconds of a clock that only goes forward.
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        from rich import progress as rich

        self._bar = rich.Progress(
            rich.TextColumn("{task.description}", style="bold", markup=False),
            rich.BarColumn(bar_width=28),
            rich.TaskProgressColumn(),
            rich.TextColumn("{task.fields[state]}"),
            rich.TimeRemainingColumn(compact=True),
            rich.TextColumn("{task.fields[left]}"),
            console=errors(),
            transient=True,
        )
        self._task = self._bar.add_task("preparing", total=None, state="", left="")
        self._now = now
        self._total_s = self._begin = self._drawn = 0.0

    def start(self, total_s: float) -> None:
        """See `Progress.start`."""
        self._total_s = max(total_s, 1e-9)
        self._begin = self._now()
        self._bar.reset(self._task, description="replaying", total=self._total_s, state="", left="left")

    def at(self, t_s: float, nc_line: int) -> None:
        """See `Progress.at`."""
        now = self._now()
        if now - self._drawn < _EVERY_S:
            return
        self._drawn = now
        factor = t_s / max(now - self._begin, 1e-3)
        state = f"{clock(t_s)} of {clock(self._total_s)}  {factor:.1f}x real time  line {nc_line}"
        self._bar.update(self._task, completed=t_s, state=state)

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()


@contextmanager
def working(*, quiet: bool, even: bool = False) -> Iterator[Callable[[str, float], None]]:
    """A bar for work in stages; yields a function of a stage's name and share done. Drawn where `progress` is.

    Args:
        even: shares are those of the whole time, so that the time left can be estimated.
    """
    if quiet or not sys.stderr.isatty():
        yield lambda _what, _share: None
        return
    from rich import progress as rich

    bar = rich.Progress(
        rich.TextColumn("{task.description}", style="bold", markup=False),
        rich.BarColumn(bar_width=28),
        rich.TaskProgressColumn(),
        *((rich.TimeRemainingColumn(compact=True), rich.TextColumn("left")) if even else (rich.TimeElapsedColumn(),)),
        console=errors(),
        transient=True,
    )
    task = bar.add_task("beginning", total=1.0)
    with bar:
        yield lambda what, share: bar.update(task, description=what, completed=share)
