"""The functions of `import twin`: thin faces over simulation, planning, verification, comparison, identification.

Units are mm, s, N, N·m, W and rad throughout. A mistake of the user's is a `twin.TwinError` (or a
`gcode.GcodeError` for the NC program) whose message names file, position, value and what was expected.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import closing
from os import PathLike
from pathlib import Path
from typing import TypeAlias

from twin.cli.show.progress import LineProgress, NoProgress, report
from twin.cli.stop import StopRequest
from twin.errors import CollisionError
from twin.job import Job, load_job
from twin.record import Record
from twin.run.drive import drive
from twin.run.run import Run, TemporaryArchive
from twin.simulation.replay import Replay
from twin.sinks.outputs import opened

StrPath: TypeAlias = str | PathLike[str]


def replay(
    job_or_path: Job | StrPath,
    *,
    mcap: StrPath | None = None,
    rrd: StrPath | None = None,
    threads: int | None = None,
    strict: bool = False,
    progress: bool = False,
    force: bool = False,
) -> Run:
    """Replay the NC program of a job: remove material, compute forces at every spindle-angle step.

    Only the files given here are written; those in the job's ``[output]`` are for the command line. Without ``mcap``
    the run is kept in a temporary archive (see `Run`). Ctrl-C ends the replay in order: the files given hold it up to
    there, and can be opened with `open_run`.

    Args:
        job_or_path: a job, or the path of a job file (TOML).
        mcap: archive to write; it stays the run's file.
        rrd: rerun recording to write.
        threads: how many work on the replay, None for all cores; results do not depend on it.
        strict: end at the first collision with a `CollisionError`; the files given hold the replay up to there.
        progress: show a progress line on standard error, or in the notebook.
        force: replace files that exist.

    Returns:
        The run, with forces, summary, events and the machined part.

    Raises:
        CollisionError: the first collision of a strict replay.
        TwinError: a job, tool, stock or program that cannot be replayed, or a file that exists or cannot be written.
        gcode.GcodeError: an NC program that cannot be interpreted.

    Examples:
        >>> run = twin.replay("examples/ball_slot/job.toml")
        >>> run.forces["fx_n"].max(), run.summary.peak_force_n
        >>> run.save("slot.mcap")
    """
    job = _job(job_or_path)
    archive = TemporaryArchive() if mcap is None else Path(mcap)
    files = archive.path if isinstance(archive, TemporaryArchive) else archive, None if rrd is None else Path(rrd)
    line = LineProgress() if progress else NoProgress()
    with opened(*files, view=False, force=force) as write, line, closing(Replay(job, threads=threads)) as replaying:

        def take(record: Record) -> None:
            write(record)
            report(line, record)

        with StopRequest() as stop:
            ending = drive(replaying, take, strict=strict, stopped=stop.came)
    if stop.signal_number is not None:
        signal.raise_signal(stop.signal_number)
    if ending.refused is not None:
        raise CollisionError(ending.refused.message)
    return Run(archive)


def open_run(path: StrPath) -> Run:
    """Open the archive of a run, written by `replay`, `Run.save` or ``twin replay``.

    The archive of a replay that was interrupted or killed opens as well, with what it holds in full: `Run.complete` is
    False then, and `Run.intact` where the file itself ends early.

    Args:
        path: MCAP file.

    Raises:
        ArchiveError: no such file, no archive of a run, or a damaged one.

    Examples:
        >>> run = twin.open_run("slot.mcap")
        >>> run.mesh().triangles.shape
    """
    return Run(path)


def records(job_or_path: Job | StrPath, *, threads: int | None = None) -> Iterator[Record]:
    """Replay a job and give its records one by one as they are computed; nothing is kept or written.

    First a `RunHeader`, then `NcEvent`, `Step` (with its force samples), `Collision` and `WorkpiecePatch` in the order
    of machine time, at last a `RunSummary`. Memory does not grow with the program. `Run.records` gives the same of a
    run that is kept.

    Args:
        job_or_path: a job, or the path of a job file (TOML).
        threads: how many work on the replay, None for all cores.

    Raises:
        TwinError, gcode.GcodeError: as `replay`, when the first record is asked for.

    Examples:
        >>> for record in twin.records("examples/ball_slot/job.toml"):
        ...     if isinstance(record, twin.Step) and record.engagement.cutting:
        ...         print(record.nc_line, record.engagement.axial_depth_mm)
    """
    with Replay(_job(job_or_path), threads=threads) as replaying:
        yield from replaying


def _job(job_or_path: Job | StrPath) -> Job:
    return job_or_path if isinstance(job_or_path, Job) else load_job(job_or_path)
