"""``twin view``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def view(
    run: Annotated[Path, typer.Argument(metavar="RUN.mcap", help="Archive of a run.", show_default=False)],
    rrd: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write a rerun recording instead of opening the viewer.", show_default=False),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a recording that is there.")] = False,
) -> None:
    """Show an archived run in rerun, as it looked while it was computed."""
    from twin.archive import read_run
    from twin.cli.console import results
    from twin.cli.outputs import opened
    from twin.cli.progress import progress
    from twin.record import RunHeader, Step

    records = read_run(run)
    header = next(records)
    assert isinstance(header, RunHeader)
    with opened(None, rrd, view=rrd is None, force=force) as write, progress(quiet=False) as line:
        write(header)
        line.start(header.planned_time_s)
        for record in records:
            write(record)
            if isinstance(record, Step):
                line.at(record.t_s, record.nc_line)
    if rrd is not None:
        results().print(f"Recording  {rrd}", markup=False, soft_wrap=True)
