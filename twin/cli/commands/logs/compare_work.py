"""The work of ``twin compare``: settings from job and options, the comparison, its outputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import typer

from twin.cli import exit_codes
from twin.cli.options import settings_from
from twin.comparison.comparison import Comparison, compare_files
from twin.comparison.run_job import job_measured
from twin.errors import ArchiveError, CompareError
from twin.measured.settings import CompareSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class Outputs:
    """Where results go."""

    report: Path | None = None
    as_json: bool = False
    view: bool = False
    rrd: Path | None = None
    mcap: Path | None = None
    table: Path | None = None


def run_one(run: Path, measured: Path | None, options: Mapping[str, Any], outputs: Outputs) -> None:
    """Compare one run with one log.

    Args:
        options: settings by key, as given on the command line.

    Raises:
        TwinError: a mistake that the user can correct.
    """
    from twin.cli.console import print_json, results, warn
    from twin.cli.early_end import warn_of_early_end
    from twin.cli.show.progress import doing

    if outputs.view:
        from twin.sinks.rerun.viewer import require_viewer

        require_viewer()
    table, job_log = job_measured(run)
    settings = settings_from(CompareSettings, options, table, f"{run}, [measured] of its job", "twin compare")
    log = measured or job_log
    if log is None:
        raise CompareError(f"{run}: no log given, and its job has no measured.file; expected RUN.mcap MEASURED")
    warn_of_early_end(run)
    with doing(f"comparing {log.name} with {run.name}", quiet=outputs.as_json):
        found = compare_files(run, log, settings)
    for warning in found.warnings:
        warn(warning)
    if outputs.as_json:
        from twin.comparison.as_json import comparison_object

        print_json(comparison_object(found))
    else:
        from twin.cli.show.compare_tables import print_comparison

        print_comparison(results(), found)
    _write(found, outputs)


def run_batch(table: Path, options: Mapping[str, Any], outputs: Outputs) -> None:
    """Compare the rows of a table; exit code 1 when one of them failed."""
    from twin.archive.container.partial import PartialFile
    from twin.cli.console import fail, print_json, results, warn
    from twin.comparison.batch import batch_csv, compare_batch

    rows = []
    for row in compare_batch(table, lambda run: {**job_measured(run)[0], **options}):
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
        print_json(objects)
    else:
        from twin.cli.show.compare_tables import print_batch

        print_batch(results(), rows)
    if outputs.table is not None:
        file = PartialFile(outputs.table, force=True)
        file.write(text.encode())
        file.commit()
        _print_line(outputs, f"Table      {outputs.table}")
    if any(row.found is None for row in rows):
        raise typer.Exit(exit_codes.ERROR)


def _plain(name: str) -> str:
    return "".join(c if c.isalnum() or c in "-_." else "_" for c in name) or "comparison"


def _write(found: Comparison, outputs: Outputs) -> None:
    """Archive, report, timeline."""
    from twin.cli.console import warn
    from twin.comparison.store import archive

    try:
        _print_line(outputs, f"Archive    {archive(found, outputs.mcap)}")
    except ArchiveError as error:
        if outputs.mcap is not None:
            raise
        warn(f"the comparison is not archived: {error}")
    if outputs.report is not None:
        from twin.comparison.report import write_report

        _print_line(outputs, f"Report     {write_report(found, outputs.report)}")
    if outputs.view or outputs.rrd is not None:
        from twin.comparison.store import compared_forces
        from twin.sinks.rerun.compare import show_comparison

        show_comparison(compared_forces(found), rrd=outputs.rrd, spawn=outputs.view)
        if outputs.rrd is not None:
            _print_line(outputs, f"Recording  {outputs.rrd}")


def _print_line(outputs: Outputs, text: str) -> None:
    from twin.cli.console import errors, results

    (errors() if outputs.as_json else results()).print(text, markup=False, soft_wrap=True)
