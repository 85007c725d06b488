"""The functions of `import twin`, thin faces over the rooms that do the work; `twin/__init__.py` lists all names.

Units are mm, s, N, N·m, W and rad throughout. A mistake of the user's is a `twin.TwinError` (or a
`gcode.GcodeError` for the NC program) whose message names file, position, value and what was expected.
"""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from twin.cli.show.progress import LineProgress, NoProgress, show_record
from twin.cli.stop import StopRequest
from twin.errors import CollisionError, CompareError, SettingsError
from twin.job import Job, load_job
from twin.record import Record
from twin.run.drive import drive
from twin.run.run import Run, TemporaryArchive
from twin.settings.check import checked
from twin.settings.file_kinds import is_nc_program
from twin.simulation.replay import Replay
from twin.sinks.outputs import opened

if TYPE_CHECKING:
    from twin.comparison.comparison import Comparison
    from twin.identification.result import Identified
    from twin.measured.log import ForceLog
    from twin.measured.settings import CompareSettings, LogReading
    from twin.settings.table import Table

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
    **drafting: Any,
) -> Run:
    """Replay an NC program, or the job of one: remove material, compute forces at every spindle-angle step.

    Only the files given here are written; those in the job's ``[output]`` are for the command line. Without ``mcap``
    the run is kept in a temporary archive (see `Run`). Ctrl-C ends the replay in order: the files given hold it up to
    there, and can be opened with `open_run`.

    Args:
        job_or_path: a job, or the path of a job file (TOML) or of an NC program, whose job `draft_job` drafts.
        mcap: archive to write; it stays the run's file.
        rrd: rerun recording to write.
        threads: how many work on the replay, None for all cores; results do not depend on it.
        strict: end at the first collision with a `CollisionError`; the files given hold the replay up to there.
        progress: show a progress line on standard error, or in the notebook.
        force: replace files that exist.
        drafting: values for the job of an NC program, e.g. ``material="Al7075-T6"``; see `DraftSettings`.

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
        >>> twin.replay("part.nc", material="Al7075-T6").summary.peak_force_n
    """
    job = _job(job_or_path, drafting)
    archive = TemporaryArchive() if mcap is None else Path(mcap)
    files = archive.path if isinstance(archive, TemporaryArchive) else archive, None if rrd is None else Path(rrd)
    line = LineProgress() if progress else NoProgress()
    with (
        opened(*files, view=False, force=force) as write,
        line,
        closing(Replay(job, threads=threads, report=line.task)) as replaying,
    ):

        def take(record: Record) -> None:
            write(record)
            show_record(line, record)

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


def records(job_or_path: Job | StrPath, *, threads: int | None = None, **drafting: Any) -> Iterator[Record]:
    """Replay a job or an NC program and give its records one by one as they are computed; nothing is kept or written.

    First a `RunHeader`, then `NcEvent`, `Step` (with its force samples), `Collision` and `WorkpiecePatch` in the order
    of machine time, at last a `RunSummary`. Memory does not grow with the program. `Run.records` gives the same of a
    run that is kept.

    Args:
        job_or_path: a job, or the path of a job file (TOML) or of an NC program, as `replay` takes it.
        threads: how many work on the replay, None for all cores.
        drafting: values for the job of an NC program, as `replay` takes them.

    Raises:
        TwinError, gcode.GcodeError: as `replay`, when the first record is asked for.

    Examples:
        >>> for record in twin.records("examples/ball_slot/job.toml"):
        ...     if isinstance(record, twin.Step) and record.engagement.cutting:
        ...         print(record.nc_line, record.engagement.axial_depth_mm)
    """
    with Replay(_job(job_or_path, drafting), threads=threads) as replaying:
        yield from replaying


def compare(
    run: Run | StrPath, measured: StrPath | None = None, settings: CompareSettings | None = None, **values: Any
) -> Comparison:
    """Lay a measured force log over a run: find the delay, correct the log as requested, compare forces.

    The settings are those of the run's job (its ``[measured]`` table), then those of ``settings`` that were given, then
    ``values``. Nothing is written; `write_report` writes a report.

    Args:
        run: a run, or the path of its archive.
        measured: log of any format that `read_log` reads; the job's ``measured.file`` if not given.
        settings: how the log is read and corrected, and the windows to compare.
        values: settings by name, e.g. ``map="x=-Fy,y=-Fx,z=Fz"``, ``windows=["4.00:4.02"]`` (s of machine time).

    Returns:
        Delay, corrections, both forces sample by sample, and errors and harmonics in each window.

    Raises:
        SettingsError: wrong settings; the message has every mistake.
        ArchiveError, MeasuredError: a file that cannot be read.
        CompareError: run and log that cannot be compared.

    Example:
        >>> found = twin.compare("slot.mcap", "ap1.csv", offset="air", windows=["4.00:4.02"])
        >>> found.windows[0].of("x").max_n, found.lag_s, found.warnings
    """
    from twin.comparison.comparison import compare_files
    from twin.comparison.run_job import job_measured
    from twin.measured.settings import CompareSettings

    path = run.path if isinstance(run, Run) else Path(run)
    table, log = job_measured(path)
    log = log if measured is None else Path(measured)
    if log is None:
        raise CompareError(f"{path}: no log given, and its job has no measured.file; expected one of them")
    return compare_files(path, log, checked(CompareSettings, table | _given(settings) | values, "compare"))


def read_log(path: StrPath, settings: LogReading | None = None, **values: Any) -> ForceLog:
    """Read a measured force log: text of any layout, DynoWare, TDMS, LVM, MATLAB, HDF5, Parquet or MCAP.

    Args:
        path: the log.
        settings: how its columns are read; what the file states if not given.
        values: settings by name, e.g. ``map="x=-Fy,y=-Fx,z=Fz"``, ``force_on="workpiece"``.

    Returns:
        Times and forces on the tool in machine axes; ``notes`` states how it was read.

    Raises:
        SettingsError: wrong settings; the message has every mistake.
        MeasuredError: a log that cannot be read, or lacks what is requested of it.

    Example:
        >>> log = twin.read_log("ap1.csv", map="x=-Fy,y=-Fx,z=Fz")
        >>> log.force_n.mean(axis=0)
    """
    from twin.measured.forces import read_forces
    from twin.measured.settings import LogReading

    return read_forces(path, checked(LogReading, _given(settings) | values, "read_log"))


def write_report(comparison: Comparison, folder: StrPath) -> Path:
    """Write a comparison as an HTML report with pictures and ``comparison.json``; earlier ones are replaced.

    Args:
        comparison: result of `compare`.
        folder: created if it is missing.

    Returns:
        The HTML file.

    Raises:
        ArchiveError: the files cannot be written.
    """
    from twin.comparison.report import write_report as write

    return write(comparison, Path(folder))


def identify(
    cuts: StrPath,
    *,
    method: Literal["mean", "iterative", "waveform"] | None = None,
    holdout: Sequence[str] = (),
    runout: bool | None = None,
    progress: Callable[[str], None] = lambda _task: None,
) -> Identified:
    """Identify cutting coefficients from test cuts, with standard errors and intervals.

    Args:
        cuts: file of test cuts (TOML).
        method: ``mean`` (linear least squares on mean forces), ``iterative`` (search that matches simulated mean
            forces) or ``waveform`` (least squares on the force over the revolution); that of the file if not given.
        holdout: names of cuts that are reported but not fitted, in addition to those of the file.
        runout: whether runout is unknown too (waveform); that of the file if not given.
        progress: called with a line about the current task.

    Returns:
        Coefficients, their statistics, the fit of every cut, and warnings.

    Raises:
        CutsError: a file of test cuts with mistakes; the message has every one.
        TwinError, gcode.GcodeError: a log or job that cannot be used, or cuts that the method cannot use.

    Example:
        >>> found = twin.identify("examples/test_cuts/cuts.toml", method="waveform", runout=True)
        >>> found.coefficients["Ktc"], found.warnings
    """
    from twin.identification.cuts.load import load_cuts
    from twin.identification.identify import identify as identify_cuts

    fit = {"method": method, "runout": runout, "holdout": [*holdout]}
    return identify_cuts(
        load_cuts(cuts, {key: value for key, value in fit.items() if value is not None}), None, progress
    )


def write_coefficients(identified: Identified, path: StrPath, *, force: bool = False) -> Path:
    """Write identified coefficients as a ``[cutting]`` table (TOML), to be appended to a job file.

    Args:
        identified: result of `identify`.
        path: file to write.
        force: replace a file that exists.

    Returns:
        The file.

    Raises:
        IdentifyError: a coefficient that the cuts do not determine, or a set that no job may have.
        ArchiveError: the file exists, or cannot be written.
    """
    from twin.identification.coefficients_toml import coefficients_toml
    from twin.identification.write import write_files

    write_files({Path(path): coefficients_toml(identified).encode()}, force=force)
    return Path(path)


def _given(settings: Table | None) -> dict[str, Any]:
    """The values of settings that were given, not left at their defaults."""
    return {} if settings is None else {name: getattr(settings, name) for name in settings.model_fields_set}


def _job(job_or_path: Job | StrPath, drafting: Mapping[str, Any]) -> Job:
    """A job; values for a draft are only for an NC program."""
    path = None if isinstance(job_or_path, Job) else Path(job_or_path)
    if path is not None and is_nc_program(path):
        from twin.drafting.draft import draft_job

        return draft_job(path, **drafting).job()
    if drafting:
        raise SettingsError("replay", [f"{', '.join(drafting)}: expected only with an NC program"])
    return job_or_path if isinstance(job_or_path, Job) else load_job(job_or_path)
