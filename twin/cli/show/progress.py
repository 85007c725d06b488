"""Progress of a run or a computation, on the terminal."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Protocol, Self

from twin.cli.console import errors
from twin.cli.show.heartbeat import COMPILING, Heartbeat, LogProgress
from twin.jit.notice import on_compiling
from twin.number_format import clock
from twin.record import NcEvent, Record, RunHeader, Step

#: Least time between two updates of the line, s.
_EVERY_S = 0.1


class Progress(Protocol):
    """Shows how far a run has come."""

    def task(self, what: str) -> None:
        """The preparation of the run begins a task."""

    def start(self, total_s: float) -> None:
        """The run begins; its whole machine time is known."""

    def at(self, t_s: float, nc_line: int) -> None:
        """The run is at this machine time and NC line."""

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def progress(*, quiet: bool) -> Progress:
    """A line on the terminal, or lines every ten seconds where standard error is none; nothing when ``quiet``."""
    if quiet:
        return NoProgress()
    return LineProgress() if sys.stderr.isatty() else LogProgress()


def show_record(line: Progress, record: Record) -> None:
    """Show how far a run has come, from the record at hand."""
    if isinstance(record, Step | NcEvent):
        line.at(record.t_s, record.nc_line)
    elif isinstance(record, RunHeader):
        line.start(record.planned_time_s)


class NoProgress:
    """Shows nothing."""

    def task(self, what: str) -> None:
        """Nothing."""

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
        self._compiling = on_compiling(lambda: self._bar.console.print(COMPILING, markup=False))

    def task(self, what: str) -> None:
        """See `Progress.task`."""
        self._bar.update(self._task, description=f"preparing: {what}")

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
        self._compiling.__enter__()
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()
        self._compiling.__exit__(kind, error, trace)


@contextmanager
def working(*, quiet: bool, even: bool = False) -> Iterator[Callable[[str, float], None]]:
    """A bar for work in stages; yields a function of a stage's name and share done. Shown where `progress` is.

    Args:
        even: shares are those of the whole time, so that the time left can be estimated.
    """
    if quiet:
        yield lambda _what, _share: None
        return
    if not sys.stderr.isatty():
        state = ["beginning"]
        with Heartbeat(lambda: state[0]):
            yield lambda what, share: state.__setitem__(0, f"{what}: {100.0 * share:.0f} %")
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
    with on_compiling(lambda: bar.console.print(COMPILING, markup=False)), bar:
        yield lambda what, share: bar.update(task, description=what, completed=share)


@contextmanager
def doing(what: str, *, quiet: bool = False) -> Iterator[Callable[[str], None]]:
    """A line with the present task of work whose length is not known; yields a function of a task's name."""
    if quiet:
        yield lambda _what: None
        return
    console = errors()
    if not console.is_terminal:
        state = [what]
        with Heartbeat(lambda: state[0]):
            yield lambda text: state.__setitem__(0, text)
        return
    from rich.markup import escape

    with on_compiling(lambda: console.print(COMPILING, markup=False)), console.status(escape(what)) as status:
        yield lambda text: status.update(escape(text))
