"""Measured and simulated forces on one timeline of the rerun viewer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from twin.archive.comparison_file import ComparedForces
from twin.errors import TwinError
from twin.sinks import rerun_layout as layout
from twin.sinks.rerun_file import RecordingFile

_APPLICATION_ID = "twin-comparison"
_PORT = 9876
_MEASURED: layout.Rgb = (206, 212, 220)
_ERROR: layout.Rgb = (214, 120, 226)


def show_comparison(forces: ComparedForces, *, rrd: Path | None = None, spawn: bool = False) -> None:
    """Draw measured, simulated and error of each axis over machine time; a view an axis.

    Args:
        rrd: recording to write; one that is there is replaced.
        spawn: start a viewer.

    Raises:
        ArchiveError: the recording cannot be written.
        TwinError: the viewer cannot be started.
    """
    recording = rr.RecordingStream(_APPLICATION_ID)
    viewers = [_viewer(recording)] if spawn else []
    file = RecordingFile(rrd, force=True) if rrd is not None else None
    if file is not None:
        file.connect(recording, *viewers)
    else:
        recording.set_sinks(*viewers)
    recording.set_log_tick_enabled(False)
    recording.set_log_time_enabled(False)
    recording.send_blueprint(_blueprint())
    _send(recording, forces)
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
            ("error", simulated - measured, _ERROR, f"F{axis} error [N]"),
        )
        for name, values, color, text in curves:
            entity = f"{name}/{axis}"
            recording.log(entity, rr.SeriesLines(colors=color, names=text, widths=1.2), static=True, strict=True)
            recording.send_columns(entity, moments, rr.Scalars.columns(scalars=values), strict=True)


def _blueprint() -> rrb.Blueprint:
    """One view an axis, measured and simulated over each other, errors below."""
    views = [
        rrb.TimeSeriesView(
            origin="/", contents=[f"measured/{a}", f"simulated/{a}"], name=f"F{a}, measured and simulated"
        )
        for a in "xyz"
    ]
    errors = rrb.TimeSeriesView(origin="/", contents=["error/**"], name="Error: simulated less measured")
    return rrb.Blueprint(
        rrb.Vertical(*views, errors),
        rrb.TimePanel(state="collapsed", timeline=layout.TIME),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        auto_views=False,
        auto_layout=False,
    )


def _viewer(recording: rr.RecordingStream) -> rr.GrpcSink:
    """Start a viewer, or find the one that runs."""
    try:
        rr.spawn(port=_PORT, connect=False, hide_welcome_screen=True, recording=recording)
    except RuntimeError as error:
        first = str(error).strip().splitlines()[0]
        raise TwinError(f"the rerun viewer cannot be started: {first}") from error
    return rr.GrpcSink(f"rerun+http://127.0.0.1:{_PORT}/proxy")
