"""``twin export``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from twin.settings.force_on import ForceOn

_STANDARD_OUTPUT = Path("-")


def export(
    run: Annotated[Path, typer.Argument(metavar="RUN.mcap", help="Archive of a run.", show_default=False)],
    out: Annotated[
        Path,
        typer.Argument(
            metavar="OUT.csv|.parquet", help="Table to write; - for CSV to standard output.", show_default=False
        ),
    ],
    on: Annotated[
        ForceOn | None,
        typer.Option(help="Body on which the forces act; the job's output.force_on if not given.", show_default=False),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that exists.")] = False,
) -> None:
    """Write every force sample of a run as CSV or Parquet.

    Columns: t_s, spindle_angle_rad, fx_n, fy_n, fz_n, torque_nm, power_w, nc_line, tool.
    """
    from twin.archive import export_forces, write_csv
    from twin.cli.console import results
    from twin.cli.early_end import warn_of_early_end

    body = on or _force_on(run)
    if out == _STANDARD_OUTPUT:
        write_csv(run, sys.stdout.buffer, body)
        warn_of_early_end(run)
        return
    rows = export_forces(run, out, on=body, force=force)
    warn_of_early_end(run)
    results().print(f"{rows} samples written to {out}", markup=False, soft_wrap=True)


def _force_on(run: Path) -> ForceOn:
    """The body that the run's job names."""
    from twin.archive import read_run
    from twin.record import RunHeader

    header = next(read_run(run))
    assert isinstance(header, RunHeader)
    return "workpiece" if header.parameters.get("output.force_on") == "workpiece" else "tool"
