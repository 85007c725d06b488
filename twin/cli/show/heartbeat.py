"""Progress where there is no terminal: a line on standard error every ten seconds, and none for short work."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Self

from twin.cli.console import errors
from twin.jit.notice import on_compiling
from twin.number_format import clock, duration

#: Time between two lines, s.
EVERY_S = 10.0
#: Share of a run between two lines from which its pace is an estimate of the time left.
_MOVING_SHARE = 0.01
#: Printed when code is compiled.
COMPILING = "compiling the numerical code, once for this version: takes 20 seconds to a minute"


class Heartbeat:
    """Prints a text every ten seconds, from a thread of its own, so that long computations between two reports count.

    Args:
        text: gives the line at the time.
        every_s: time between two lines, `EVERY_S` if not given.

    Attributes:
        compiled: whether code has been compiled since its start.
    """

    def __init__(self, text: Callable[[], str], every_s: float | None = None) -> None:
        self._text, self._every_s = text, EVERY_S if every_s is None else every_s
        self._ended, self._compiles = threading.Event(), threading.Event()
        self.compiled = False
        self._thread = threading.Thread(target=self._beat, daemon=True)
        self._compiling = on_compiling(self._note_compiling)

    def _note_compiling(self) -> None:
        self.compiled = True
        self._compiles.set()

    def _beat(self) -> None:
        while not self._ended.wait(self._every_s):
            if self._compiles.is_set():
                say(COMPILING)
                self._compiles.clear()
            say(self._text())

    def __enter__(self) -> Self:
        self._compiling.__enter__()
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._compiling.__exit__(kind, error, trace)


class LogProgress:
    """Progress of a run as lines; see `twin.cli.show.progress.Progress`.

    Args:
        now: seconds of a clock that only goes forward.
        every_s: time between two lines.
    """

    def __init__(self, now: Callable[[], float] = time.monotonic, every_s: float | None = None) -> None:
        self._now = now
        self._task, self._total_s, self._t_s, self._line = "preparing", 0.0, 0.0, 0
        self._begin_s = now()
        self._last = (0.0, self._begin_s)
        self._beat = Heartbeat(self.text, every_s)

    def task(self, what: str) -> None:
        """See `Progress.task`."""
        self._task = f"preparing: {what}"

    def start(self, total_s: float) -> None:
        """See `Progress.start`."""
        self._total_s, self._begin_s = max(total_s, 1e-9), self._now()
        self._last = (0.0, self._begin_s)

    def at(self, t_s: float, nc_line: int) -> None:
        """See `Progress.at`."""
        self._t_s, self._line = t_s, nc_line

    def text(self) -> str:
        """The line for now."""
        now_s = self._now()
        passed_s = now_s - self._begin_s
        if not self._total_s:
            return f"{self._task} ({clock(passed_s)})"
        share, pace = self._t_s / self._total_s, self._t_s / max(passed_s, 1e-3)
        since = self._t_s - self._last[0], max(now_s - self._last[1], 1e-3)
        self._last = self._t_s, now_s
        # while code is compiled the run stands still; the mean pace since its start means nothing then
        lately = since[0] / since[1] if self._beat.compiled else pace
        moving = since[0] > _MOVING_SHARE * self._total_s or not self._beat.compiled
        left = (
            f", about {duration(max(self._total_s - self._t_s, 0.0) / lately)} left" if lately > 0.0 and moving else ""
        )
        times = f"{clock(self._t_s)} of {clock(self._total_s)}"
        return f"replaying: {100.0 * share:.0f} %, {times}, {pace:.1f}x real time, line {self._line}{left}"

    def __enter__(self) -> Self:
        self._beat.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._beat.__exit__(kind, error, trace)


def say(text: str) -> None:
    """Print a line, if standard error takes it."""
    with contextlib.suppress(OSError, ValueError):
        errors().print(text, markup=False, highlight=False)
