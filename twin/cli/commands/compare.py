"""``twin compare``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from twin.cli.commands.export import Body

_READING = "Reading the log"
_CORRECTING = "Making it comparable"
_OUT = "Results"


def compare(
    run: Annotated[
        Path | None, typer.Argument(metavar="RUN.mcap", help="Archive of a run.", show_default=False)
    ] = None,
    measured: Annotated[
        Path | None,
        typer.Argument(
            metavar="MEASURED",
            help="Log: CSV, TXT, DynoWare, TDMS, LVM, MAT, HDF5, Parquet, MCAP; the job's measured.file if not given.",
            show_default=False,
        ),
    ] = None,
    window: Annotated[
        list[str] | None,
        typer.Option(metavar="BEGIN:END", help="Window on the run's clock, s; may be repeated.", show_default=False),
    ] = None,
    axis_map: Annotated[
        str | None,
        typer.Option(
            "--map",
            metavar="MAP",
            help="x=-Fy,y=-Fx,z=Fz: columns for the axes.",
            rich_help_panel=_READING,
            show_default=False,
        ),
    ] = None,
    force_on: Annotated[
        Body | None,
        typer.Option(help="Body that the mapped force acts on; tool.", rich_help_panel=_READING, show_default=False),
    ] = None,
    columns: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES", help="t_s,Fx_N,...: names of all columns.", rich_help_panel=_READING, show_default=False
        ),
    ] = None,
    unit: Annotated[
        str | None,
        typer.Option(
            metavar="UNIT", help="Unit of the forces: N, kN, lbf.", rich_help_panel=_READING, show_default=False
        ),
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option(metavar="HZ", help="Sampling rate of the log.", rich_help_panel=_READING, show_default=False),
    ] = None,
    rpm: Annotated[
        float | None,
        typer.Option(
            metavar="RPM",
            help="Makes time of a column of the spindle's angle.",
            rich_help_panel=_READING,
            show_default=False,
        ),
    ] = None,
    delimiter: Annotated[
        str | None,
        typer.Option(metavar="CHAR", help="Delimiter of a text file.", rich_help_panel=_READING, show_default=False),
    ] = None,
    decimal: Annotated[
        str | None,
        typer.Option(metavar="CHAR", help="Decimal mark: . or ,", rich_help_panel=_READING, show_default=False),
    ] = None,
    group: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Group, variable or topic in the file.", rich_help_panel=_READING, show_default=False
        ),
    ] = None,
    lag: Annotated[
        str | None,
        typer.Option(
            metavar="auto|SECONDS", help="How late the log is; auto.", rich_help_panel=_CORRECTING, show_default=False
        ),
    ] = None,
    lag_within: Annotated[
        float | None,
        typer.Option(
            metavar="SECONDS", help="Look at delays up to this.", rich_help_panel=_CORRECTING, show_default=False
        ),
    ] = None,
    phase: Annotated[
        bool, typer.Option("--phase", help="Shift each window to the measured phase.", rich_help_panel=_CORRECTING)
    ] = False,
    offset: Annotated[
        str | None,
        typer.Option(
            metavar="none|air|BEGIN:END|X,Y,Z",
            help="Zero of the amplifier: mean in air, over a part of the log, or in N; none.",
            rich_help_panel=_CORRECTING,
            show_default=False,
        ),
    ] = None,
    drift: Annotated[
        bool, typer.Option("--drift", help="Subtract a line through the air segments.", rich_help_panel=_CORRECTING)
    ] = False,
    resample: Annotated[
        float | None,
        typer.Option(metavar="HZ", help="Rate of the comparison.", rich_help_panel=_CORRECTING, show_default=False),
    ] = None,
    lowpass: Annotated[
        float | None,
        typer.Option(metavar="HZ", help="Low-pass log and run.", rich_help_panel=_CORRECTING, show_default=False),
    ] = None,
    notch: Annotated[
        list[str] | None,
        typer.Option(
            metavar="HZ[:Q]",
            help="Notch log and run; may be repeated.",
            rich_help_panel=_CORRECTING,
            show_default=False,
        ),
    ] = None,
    causal: Annotated[
        bool, typer.Option("--causal", help="Filters run forwards only, not both ways.", rich_help_panel=_CORRECTING)
    ] = False,
    filter_log_only: Annotated[
        bool, typer.Option("--filter-log-only", help="Leave the run unfiltered.", rich_help_panel=_CORRECTING)
    ] = False,
    report: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Write report.html and its pictures.", rich_help_panel=_OUT, show_default=False
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.", rich_help_panel=_OUT)] = False,
    view: Annotated[bool, typer.Option("--view", help="Show both in rerun.", rich_help_panel=_OUT)] = False,
    rrd: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write a rerun recording.", rich_help_panel=_OUT, show_default=False),
    ] = None,
    mcap: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Archive of the comparison; RUN.MEASURED.compare.mcap beside the run.",
            rich_help_panel=_OUT,
            show_default=False,
        ),
    ] = None,
    batch: Annotated[
        Path | None,
        typer.Option(
            metavar="TABLE", help="Compare the rows of a .csv or .toml table.", rich_help_panel=_OUT, show_default=False
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="FILE", help="Batch: table of errors.", rich_help_panel=_OUT, show_default=False
        ),
    ] = None,
) -> None:
    """Lay a measured force log over a run: errors, harmonics, report.

    Every correction is printed and stored; only the delay is looked for unless it is given.
    """
    from twin.cli.commands.comparing import Asked, Outputs, run_batch, run_one

    asked = Asked(
        windows=tuple(window or ()),
        axis_map=axis_map,
        force_on=force_on.value if force_on is not None else None,
        columns=columns,
        unit=unit,
        rate_hz=rate,
        rpm=rpm,
        delimiter=delimiter,
        decimal=decimal,
        group=group,
        lag=lag,
        lag_within_s=lag_within,
        phase=phase,
        offset=offset,
        drift=drift,
        resample_hz=resample,
        lowpass_hz=lowpass,
        notches=tuple(notch or ()),
        causal=causal,
        filter_both=not filter_log_only,
    )
    outputs = Outputs(report=report, as_json=as_json, view=view, rrd=rrd, mcap=mcap, table=out)
    if batch is not None:
        if run is not None or measured is not None:
            raise typer.BadParameter("files stand in the table, expected no RUN and MEASURED beside --batch")
        run_batch(batch, asked, outputs)
        return
    if run is None:
        raise typer.BadParameter("expected RUN.mcap and MEASURED, or --batch TABLE")
    run_one(run, measured, asked, outputs)
