"""Measured and simulated forces on one timeline of the rerun viewer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from twin.archive.comparison_file import ComparedForces
from twin.sinks.rerun import layout
from twin.sinks.rerun.file import RecordingFile
from twin.sinks.rerun.viewer import viewer_sink
from twin.sinks.rerun.web import WebServer

_APPLICATION_ID = "twin-comparison"
_MEASURED: layout.Rgb = (206, 212, 220)
#: Half of the time that the close views show around the cursor, s.
_CLOSE_S = 0.02
_CLOSE_NAME = "Around the cursor, ±20 ms"


def show_comparison(
    forces: ComparedForces, *, rrd: Path | None = None, spawn: bool = False, web: WebServer | None = None
) -> None:
    """Draw measured force, simulated force and error of each axis over machine time; one view per axis.

    Args:
        forces: both forces at the log's samples.
        rrd: recording to write; an existing one is replaced.
        spawn: start a viewer.
        web: server for a browser.

    Raises:
        ArchiveError: the recording cannot be written.
        TwinError: the viewer cannot be started.
    """
    recording = rr.RecordingStream(_APPLICATION_ID)
    viewers = [viewer_sink()] if spawn else []
    viewers += [web.sink()] if web is not None else []
    file = RecordingFile(rrd, force=True) if rrd is not None else None
    if file is not None:
        file.connect(recording, *viewers)
    else:
        recording.set_sinks(*viewers)
    try:
        recording.set_log_tick_enabled(False)
        recording.set_log_time_enabled(False)
        recording.send_blueprint(_blueprint())
        _send(recording, forces)
    except BaseException:
        recording.disconnect()
        if file is not None:
            file.discard()
        raise
    recording.disconnect()
    if file is not None:
        file.close()


def _send(recording: rr.RecordingStream, forces: ComparedForces) -> None:
    moments = [rr.TimeColumn(layout.TIME, duration=np.rint(forces.t_s * 1e9).astype("timedelta64[ns]"))]
    for index, series in enumerate(layout.FORCES):
        axis = "xyz"[index]
        measured, simulated = forces.measured_n[:, index], forces.simulated_n[:, index]
        curves = (
            ("measured", measured, _MEASURED, f"F{axis} measured [N]"),
            ("simulated", simulated, series.color, f"F{axis} simulated [N]"),
            ("error", simulated - measured, series.color, f"F{axis} error [N]"),
        )
        for name, values, color, text in curves:
            style = rr.SeriesLines(colors=color, names=text, widths=1.2, aggregation_policy="MinMax")
            recording.log(f"{name}/{axis}", style, static=True, strict=True)
            recording.send_columns(f"{name}/{axis}", moments, rr.Scalars.columns(scalars=values), strict=True)


def _blueprint() -> rrb.Blueprint:
    """For each axis the whole log on the left and the close view around the cursor on the right; errors below."""
    pairs = {f"F{a}, measured and simulated": [f"measured/{a}", f"simulated/{a}"] for a in "xyz"}
    pairs["Error: simulated less measured"] = [f"error/{a}" for a in "xyz"]
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(*(_curves(name, contents) for name, contents in pairs.items())),
            rrb.Vertical(*(_curves(_CLOSE_NAME, contents, close=True) for contents in pairs.values())),
            column_shares=[6, 5],
        ),
        rrb.TimePanel(state="collapsed", timeline=layout.TIME),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        auto_views=False,
        auto_layout=False,
    )


def _curves(name: str, contents: list[str], *, close: bool = False) -> rrb.TimeSeriesView:
    """Curves over the whole log, or around the cursor."""
    around = rr.VisibleTimeRange(
        layout.TIME,
        start=rr.TimeRangeBoundary.cursor_relative(seconds=-_CLOSE_S),
        end=rr.TimeRangeBoundary.cursor_relative(seconds=_CLOSE_S),
    )
    whole = rr.TimeRange(start=rr.TimeRangeBoundary.infinite(), end=rr.TimeRangeBoundary.infinite())
    return rrb.TimeSeriesView(
        origin="/",
        contents=contents,
        name=name,
        plot_legend=rrb.PlotLegend(visible=not close, corner=rrb.Corner2D.LeftTop),
        time_ranges=[around] if close else None,
        axis_x=None if close else rrb.TimeAxis(view_range=whole),
    )
