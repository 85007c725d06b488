"""What ``twin compare`` does: settings from job and options, the comparison, its outputs."""

from __future__ import annotations

import ast
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import typer

from twin.cli import exit_codes
from twin.comparison import settings as ask
from twin.comparison.comparison import Comparison, compare_files
from twin.errors import ArchiveError, CompareError
from twin.measured.axes import AxisMap
from twin.measured.filters import Filter
from twin.measured.spans import parse_offset, parse_window

_TABLE = "measured."


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """The options as given; None or empty where the job file or the default counts."""

    windows: tuple[str, ...] = ()
    axis_map: str | None = None
    force_on: Any = None
    columns: str | None = None
    unit: str | None = None
    rate_hz: float | None = None
    rpm: float | None = None
    delimiter: str | None = None
    decimal: str | None = None
    group: str | None = None
    lag: str | None = None
    lag_within_s: float | None = None
    phase: bool = False
    offset: str | None = None
    drift: bool = False
    resample_hz: float | None = None
    lowpass_hz: float | None = None
    notches: tuple[str, ...] = ()
    causal: bool = False
    filter_both: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class Outputs:
    """Where results go."""

    report: Path | None = None
    as_json: bool = False
    view: bool = False
    rrd: Path | None = None
    mcap: Path | None = None
    table: Path | None = None


def run_one(run: Path, measured: Path | None, asked: Asked, outputs: Outputs) -> None:
    """Compare one run with one log.

    Raises:
        TwinError: a mistake that the user can mend.
    """
    from twin.cli.console import results, warn

    job = _job_settings(run)
    log = measured or _job_log(run, job)
    if log is None:
        raise CompareError(f"{run}: no log given, and its job has no measured.file; expected RUN.mcap MEASURED")
    found = compare_files(run, log, settings_of(asked, job))
    for warning in found.warnings:
        warn(warning)
    if outputs.as_json:
        from twin.comparison.as_json import comparison_object

        typer.echo(json.dumps(comparison_object(found), indent=2, ensure_ascii=False))
    else:
        from twin.cli.show.compare_tables import print_comparison

        print_comparison(results(), found)
    _write(found, outputs)


def run_batch(table: Path, asked: Asked, outputs: Outputs) -> None:
    """Compare the rows of a table; exit code 1 when one of them failed."""
    from twin.archive.container.partial import PartialFile
    from twin.cli.console import fail, results, warn
    from twin.comparison.batch import batch_csv, compare_batch

    rows = []
    for row in compare_batch(table, lambda run: settings_of(asked, _job_settings(run))):
        rows.append(row)
        if row.found is None:
            fail(f"{table}, row {row.number} ({row.name}): {row.message}")
        else:
            for warning in row.found.warnings:
                warn(f"{table}, row {row.number} ({row.name}): {warning}")
            if outputs.report is not None:
                from twin.comparison.report import write_report

                write_report(row.found, outputs.report / f"{row.number:03d}_{_plain(row.name)}")
    text = batch_csv(rows)
    if outputs.as_json:
        from twin.comparison.as_json import comparison_object

        objects = [
            {"row": r.number, "name": r.name, "message": r.message or None}
            | {"comparison": comparison_object(r.found) if r.found is not None else None}
            for r in rows
        ]
        typer.echo(json.dumps(objects, indent=2, ensure_ascii=False))
    else:
        from twin.cli.show.compare_tables import print_batch

        print_batch(results(), rows)
    if outputs.table is not None:
        file = PartialFile(outputs.table, force=True)
        file.write(text.encode())
        file.commit()
        _say(outputs, f"Table      {outputs.table}")
    if any(row.found is None for row in rows):
        raise typer.Exit(exit_codes.ERROR)


def settings_of(asked: Asked, job: Mapping[str, str]) -> ask.CompareSettings:
    """Settings from the options, where they say nothing from the job, and where that says nothing the defaults.

    Raises:
        CompareError, MeasuredError: an option that is no window, map, lag, offset.
    """
    axis_map = asked.axis_map or job.get("map")
    columns = asked.columns.split(",") if asked.columns else _list(job.get("columns"))
    rate = asked.rate_hz if asked.rate_hz is not None else _float(job.get("rate_hz"))
    read = ask.ReadSettings(
        axis_map=AxisMap.parse(axis_map) if axis_map else None,
        force_on=asked.force_on or ("workpiece" if job.get("force_on") == "workpiece" else "tool"),
        columns=tuple(c.strip() for c in columns) if columns else None,
        delimiter=_delimiter(asked.delimiter if asked.delimiter is not None else job.get("delimiter")),
        decimal=asked.decimal or job.get("decimal"),
        group=asked.group or job.get("group"),
        rate_hz=rate,
        rpm=asked.rpm,
        unit=asked.unit or job.get("unit"),
    )
    phase: Any = "causal" if asked.causal else "zero"
    filters = [ask.parse_notch(n, phase) for n in asked.notches]
    if asked.lowpass_hz is not None:
        filters.append(Filter(kind="lowpass", hz=asked.lowpass_hz, phase=phase))
    return ask.CompareSettings(
        windows=tuple(parse_window(w) for w in asked.windows or _list(job.get("windows"))),
        lag=ask.parse_lag(asked.lag or job.get("lag_s") or "auto"),
        lag_within_s=asked.lag_within_s,
        phase=asked.phase,
        offset=parse_offset(asked.offset or job.get("offset") or "none"),
        drift=asked.drift,
        resample_hz=asked.resample_hz,
        filters=tuple(filters),
        filter_both=asked.filter_both,
        read=read,
    )


def _job_log(run: Path, job: Mapping[str, str]) -> Path | None:
    """The job's log: where the job said, else beside the run or in the folder above, for runs that were moved."""
    if "file" not in job:
        return None
    told = Path(job["file"])
    places = (told, run.parent / told.name, run.parent.parent / told.name)
    return next((p for p in places if p.is_file()), told)


def _job_settings(run: Path) -> dict[str, str]:
    """The job's ``[measured]`` table, as the run's archive keeps it."""
    from twin.archive import run_info

    parameters = run_info(run).header.parameters
    return {k.removeprefix(_TABLE): v for k, v in parameters.items() if k.startswith(_TABLE)}


def _list(text: str | None) -> list[str]:
    """A list as the archive keeps it."""
    value = ast.literal_eval(text) if text else []
    return [str(v) for v in value]


def _float(text: str | None) -> float | None:
    return float(text) if text else None


def _delimiter(text: str | None) -> str | None:
    """What people write for a delimiter."""
    names = {"tab": "\t", "\\t": "\t", "space": "", "semicolon": ";", "comma": ","}
    return None if text is None else names.get(text.lower(), text)


def _plain(name: str) -> str:
    return "".join(c if c.isalnum() or c in "-_." else "_" for c in name) or "comparison"


def _write(found: Comparison, outputs: Outputs) -> None:
    """Archive, report, timeline."""
    from twin.cli.console import warn
    from twin.comparison.store import archive

    try:
        _say(outputs, f"Archive    {archive(found, outputs.mcap)}")
    except ArchiveError as error:
        if outputs.mcap is not None:
            raise
        warn(f"the comparison is not archived: {error}")
    if outputs.report is not None:
        from twin.comparison.report import write_report

        _say(outputs, f"Report     {write_report(found, outputs.report)}")
    if outputs.view or outputs.rrd is not None:
        from twin.comparison.store import compared_forces
        from twin.sinks.rerun.compare import show_comparison

        show_comparison(compared_forces(found), rrd=outputs.rrd, spawn=outputs.view)
        if outputs.rrd is not None:
            _say(outputs, f"Recording  {outputs.rrd}")


def _say(outputs: Outputs, text: str) -> None:
    from twin.cli.console import errors, results

    (errors() if outputs.as_json else results()).print(text, markup=False, soft_wrap=True)
