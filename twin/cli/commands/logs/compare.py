"""``twin compare``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from twin.cli.options import options_from
from twin.measured.settings import CompareSettings, LogCorrections, LogReading

_OUT = "Results"


@options_from(CompareSettings, "windows", omit={*LogReading.model_fields, *LogCorrections.model_fields})
@options_from(LogReading, "reading", panel="Reading the log")
@options_from(LogCorrections, "corrections", panel="Corrections before comparing")
def compare(
    windows: Mapping[str, Any],
    reading: Mapping[str, Any],
    corrections: Mapping[str, Any],
    run: Annotated[
        Path | None, typer.Argument(metavar="RUN.mcap", help="Archive of a run.", show_default=False)
    ] = None,
    measured: Annotated[
        Path | None,
        typer.Argument(
            metavar="MEASURED",
            help="Log (CSV, TXT, DynoWare, TDMS, LVM, MAT, HDF5, Parquet, MCAP); the job's measured.file if not given.",
            show_default=False,
        ),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Folder for report.html and its pictures.", rich_help_panel=_OUT, show_default=False
        ),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object in place of the tables.", rich_help_panel=_OUT)
    ] = False,
    view: Annotated[
        bool, typer.Option("--view", help="Show measured and simulated forces in rerun.", rich_help_panel=_OUT)
    ] = False,
    rrd: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Rerun recording to write.", rich_help_panel=_OUT, show_default=False),
    ] = None,
    mcap: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Archive of the comparison to write; RUN.MEASURED.compare.mcap next to the run if not given.",
            rich_help_panel=_OUT,
            show_default=False,
        ),
    ] = None,
    batch: Annotated[
        Path | None,
        typer.Option(
            metavar="TABLE",
            help="Compare every row of this .csv or .toml table of runs and logs.",
            rich_help_panel=_OUT,
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            metavar="FILE",
            help="Table of errors to write, for --batch.",
            rich_help_panel=_OUT,
            show_default=False,
        ),
    ] = None,
) -> None:
    """Compare a measured force log with a run: errors, harmonics, report.

    Every correction is printed and stored. Only the delay is found by the program unless you give it; all other
    corrections are off unless you turn them on.
    """
    from twin.cli.commands.logs.compare_work import Outputs, run_batch, run_one

    options = {**windows, **reading, **corrections}
    outputs = Outputs(report=report, as_json=as_json, view=view, rrd=rrd, mcap=mcap, table=out)
    if batch is not None:
        if run is not None or measured is not None:
            raise typer.BadParameter("files are in the table, expected no RUN and MEASURED with --batch")
        run_batch(batch, options, outputs)
        return
    if run is None:
        raise typer.BadParameter("expected RUN.mcap and MEASURED, or --batch TABLE")
    run_one(run, measured, options, outputs)
