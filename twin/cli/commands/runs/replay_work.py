"""One replay with what the command line adds: progress, warnings, Ctrl-C, times."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from twin.cli.show.progress import Progress, show_record
from twin.cli.stop import StopRequest
from twin.job import Job
from twin.record import Collision, Record, RunSummary
from twin.run.drive import Replaying, drive
from twin.run.watch import Watch
from twin.sinks.outputs import Write

if TYPE_CHECKING:
    from twin.workpiece.to_mesh import SurfaceMesh


class OpenReplay(Replaying, Protocol):
    """The interface of `twin.simulation.replay.Replay` that is used here."""

    def mesh(self) -> SurfaceMesh:
        """The surface of the workpiece."""

    def close(self) -> None:
        """End worker threads."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """How a replay went.

    Attributes:
        wall_time_s: from the first record to the last.
        setup_time_s: before that: program read and checked, stock sliced, tools made ready.
        signal_number: the signal that ended it early, None otherwise.
        refused: the collision that ended a strict replay.
        at_end: the result of the function of that name.
    """

    summary: RunSummary
    watch: Watch
    wall_time_s: float
    setup_time_s: float
    signal_number: int | None
    refused: Collision | None
    at_end: SurfaceMesh | None = None


def open_replay(job: Job, threads: int | None = None, report: Callable[[str], None] = lambda _task: None) -> OpenReplay:
    """Read the program, slice the stock, make the tools ready; ``report`` is called with each of these tasks."""
    from twin.simulation.replay import Replay

    return Replay(job, threads=threads, report=report)


def replay_job(
    job: Job,
    progress: Progress,
    write: Write = lambda _record: None,
    *,
    strict: bool = False,
    threads: int | None = None,
    at_end: Callable[[OpenReplay], SurfaceMesh | None] = lambda _replay: None,
) -> Outcome:
    """Replay a job into its outputs, until its end, Ctrl-C, or a collision when strict.

    However it ends, the last record written is a `RunSummary`.

    Args:
        write: takes every record.
        strict: end at the first collision, which is still written.
        threads: how many to work with, None for all cores.
        at_end: called with the replay before it is closed.

    Raises:
        TwinError, GcodeError: the program cannot be replayed, or an output cannot be written.
    """
    begin = time.perf_counter()
    with closing(open_replay(job, threads, progress.task)) as replay, StopRequest() as stop:
        ready = time.perf_counter()
        watch = Watch()

        def take(record: Record) -> None:
            write(record)
            watch.take(record)
            show_record(progress, record)

        ending = drive(replay, take, strict=strict, stopped=stop.came)
        return Outcome(
            summary=ending.summary,
            watch=watch,
            wall_time_s=time.perf_counter() - ready,
            setup_time_s=ready - begin,
            signal_number=stop.signal_number,
            refused=ending.refused,
            at_end=at_end(replay),
        )
