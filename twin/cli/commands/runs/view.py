"""``twin view``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def view(
    run: Annotated[
        Path, typer.Argument(metavar="RUN.mcap", help="Archive of a run or of a comparison.", show_default=False)
    ],
    rrd: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write a rerun recording instead of opening the viewer.", show_default=False),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a recording that exists.")] = False,
) -> None:
    """Show an archived run, or an archived comparison, in the rerun viewer."""
    from twin.archive.comparison_file import is_comparison

    if is_comparison(run):
        _comparison(run, rrd, force=force)
        return
    from twin.archive import read_run
    from twin.cli.console import results
    from twin.cli.early_end import warn_of_early_end
    from twin.cli.show.progress import progress
    from twin.record import RunHeader, Step
    from twin.sinks.outputs import opened

    records = read_run(run)
    header = next(records)
    assert isinstance(header, RunHeader)
    warn_of_early_end(run)
    with opened(None, rrd, view=rrd is None, force=force) as write, progress(quiet=False) as line:
        write(header)
        line.start(header.planned_time_s)
        for record in records:
            write(record)
            if isinstance(record, Step):
                line.at(record.t_s, record.nc_line)
    if rrd is not None:
        results().print(f"Recording  {rrd}", markup=False, soft_wrap=True)


def _comparison(path: Path, rrd: Path | None, *, force: bool) -> None:
    """Measured and simulated forces of a comparison."""
    from twin.archive.comparison_file import read_comparison
    from twin.cli.console import results
    from twin.errors import ArchiveError
    from twin.sinks.rerun.compare import show_comparison

    if rrd is not None and rrd.exists() and not force:
        raise ArchiveError(f"{rrd}: already exists; replace it with --force")
    forces, _ = read_comparison(path)
    show_comparison(forces, rrd=rrd, spawn=rrd is None)
    if rrd is not None:
        results().print(f"Recording  {rrd}", markup=False, soft_wrap=True)
