"""One replay from the first record to the last, as every command that replays needs it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from twin.cli.outputs import Write
from twin.cli.show.progress import Progress
from twin.cli.show.watch import Watch
from twin.cli.stop import StopWish
from twin.job import Job
from twin.record import Collision, NcEvent, Record, RunHeader, RunSummary, Step

if TYPE_CHECKING:
    from twin.workpiece.to_mesh import SurfaceMesh


class Run(Protocol):
    """What is used of `twin.simulation.replay.Replay`."""

    def __iter__(self) -> Iterator[Record]: ...

    def summary(self, *, complete: bool = False) -> RunSummary:
        """Sums so far."""

    def mesh(self) -> SurfaceMesh:
        """The part as it is."""

    def close(self) -> None:
        """Let go of what the run holds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """How a replay went.

    Attributes:
        wall_time_s: from the first record to the last.
        setup_time_s: before that: program read and checked, stock sliced, tools made ready.
        signal_number: what ended it early, None if nothing did.
        refused: the collision that ended a strict replay.
        at_end: what the function of that name gave.
    """

    summary: RunSummary
    watch: Watch
    wall_time_s: float
    setup_time_s: float
    signal_number: int | None
    refused: Collision | None
    at_end: SurfaceMesh | None = None


def open_run(job: Job, threads: int | None = None) -> Run:
    """Read the program, slice the stock, make the tools ready."""
    from twin.simulation.replay import Replay

    return Replay(job, threads=threads)


def replay_job(
    job: Job,
    progress: Progress,
    write: Write = lambda _record: None,
    *,
    strict: bool = False,
    threads: int | None = None,
    at_end: Callable[[Run], SurfaceMesh | None] = lambda _run: None,
) -> Outcome:
    """Replay a job into its outputs, until its end, a wish to stop, or a collision when strict.

    However it ends, the last record written is a `RunSummary`.

    Args:
        write: takes every record.
        strict: end at the first collision, which is still written.
        threads: how many to work with, None for all cores.
        at_end: called with the run before it is closed.

    Raises:
        TwinError, GcodeError: what cannot be replayed or written.
    """
    begin = time.perf_counter()
    with closing(open_run(job, threads)) as run, StopWish() as wish:
        ready = time.perf_counter()
        watch = Watch()
        refused = summary = None
        for record in run:
            write(record)
            watch.take(record)
            _tell(progress, record)
            if isinstance(record, RunSummary):
                summary = record
            if strict and isinstance(record, Collision):
                refused = record
            if refused is not None or wish.signal_number is not None:
                break
        if summary is None:
            summary = run.summary(complete=False)
            write(summary)
        return Outcome(
            summary=summary,
            watch=watch,
            wall_time_s=time.perf_counter() - ready,
            setup_time_s=ready - begin,
            signal_number=wish.signal_number,
            refused=refused,
            at_end=at_end(run),
        )


def _tell(progress: Progress, record: Record) -> None:
    if isinstance(record, Step | NcEvent):
        progress.at(record.t_s, record.nc_line)
    elif isinstance(record, RunHeader):
        progress.start(record.planned_time_s)
