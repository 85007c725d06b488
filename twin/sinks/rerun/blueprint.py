"""Layout of the timeline: the part at the top, the NC blocks on its right, the forces below.

The same blueprint is used for a recording of `twin.sinks.rerun.sink.RerunSink` and for an archive that rerun itself
reads: force curves come from ``force/...`` in the former and from fields of the messages on ``/force/revolution`` in
the latter.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.encodings import ComponentSourceKind, TextLogColumnKind, VisualizerComponentMapping

from twin.arrays import FloatArray
from twin.errors import ArchiveError
from twin.sinks.rerun import layout

#: Half of the time that the close view of the forces shows around the cursor, s.
_CLOSE_S = 0.04

#: The blueprint for archives that comes with the program; made by ``python -m twin.sinks.rerun.blueprint``.
SHIPPED = Path(__file__).with_name("twin.rbl")

_WHOLE_RUN = rr.TimeRange(start=rr.TimeRangeBoundary.infinite(), end=rr.TimeRangeBoundary.infinite())
_UP_TO_CURSOR = [
    rr.VisibleTimeRange(name, start=rr.TimeRangeBoundary.infinite(), end=rr.TimeRangeBoundary.cursor_relative())
    for name in layout.TIMELINES
]


def blueprint(view_mm: FloatArray | None = None, *, timeline: str = layout.TIME) -> rrb.Blueprint:
    """The layout of the timeline.

    Args:
        view_mm: shape (2, 3), the box that the camera looks at; None leaves the camera to the viewer.
        timeline: machine time: `layout.TIME` in a recording, `layout.ARCHIVE_TIME` in an archive.
    """
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(
                _part(view_mm),
                _curves("Resultant force: highest and mean of each revolution", layout.RESULTANT_CURVES, marks=True),
                _curves("Force on the tool: lowest, highest and mean of each revolution", layout.ENVELOPE),
                _curves("Spindle torque: highest and mean of each revolution", layout.TORQUE_CURVES),
                row_shares=[9, 4, 6, 3],
            ),
            rrb.Vertical(
                rrb.Tabs(_blocks(timeline), _summary()),
                _curves("Force around the cursor, ±40 ms", layout.SAMPLES, close=True),
                row_shares=[11, 8],
            ),
            column_shares=[7, 3],
        ),
        rrb.TimePanel(state="collapsed", timeline=timeline, play_state="following"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        auto_views=False,
        auto_layout=False,
    )


def save_blueprint(path: Path) -> None:
    """Write the layout to a ``.rbl`` file, for archives that the viewer reads itself (docs/rerun.md).

    Raises:
        ArchiveError: the file cannot be written.
    """
    try:
        blueprint(timeline=layout.ARCHIVE_TIME).save(layout.APPLICATION_ID, path)
    except (OSError, RuntimeError) as error:
        raise ArchiveError(f"{path}: cannot be written: {error}") from error


def _part(view_mm: FloatArray | None) -> rrb.Spatial3DView:
    """Machined part, tool and path up to the cursor."""
    history = [layout.CUT_PATH, layout.RAPID_PATH, layout.COLLISIONS]
    return rrb.Spatial3DView(
        origin="/",
        contents=["machine/**", "workpiece/**", "stock/**"],
        name="Part, tool and path coloured by resultant force",
        background=rrb.Background(color=(26, 29, 34), kind=rrb.BackgroundKind.SolidColor),
        line_grid=_grid(view_mm),
        eye_controls=None if view_mm is None else _eye(view_mm),
        overrides={entity: rrb.VisibleTimeRanges(_UP_TO_CURSOR) for entity in history},
    )


def _grid(view_mm: FloatArray | None) -> rrb.LineGrid3D:
    """A grid in the plane of the stock's lower face."""
    floor = 0.0 if view_mm is None else float(view_mm[0, 2])
    plane = rr.encodings.Plane3D((0.0, 0.0, 1.0), floor)
    return rrb.LineGrid3D(visible=True, plane=plane, spacing=10.0, stroke_width=0.75, color=(120, 128, 140, 40))


def _eye(view_mm: FloatArray) -> rrb.EyeControls3D:
    """From the front, left and above, as one looks into a machine."""
    low, high = view_mm
    reach = 0.5 * float(((high - low) ** 2).sum()) ** 0.5
    target = 0.5 * (low + high) + np.array((0.0, 0.0, 0.1 * reach))
    return rrb.EyeControls3D(position=target + reach * np.array(layout.EYE), look_target=target, eye_up=(0, 0, 1))


def _blocks(timeline: str) -> rrb.TextLogView:
    """NC blocks and collisions; lines of an archive have no colours, so their level is shown as well."""
    body, level = TextLogColumnKind.Body, TextLogColumnKind.LogLevel
    columns = [body] if timeline == layout.TIME else [level, body]
    return rrb.TextLogView(
        origin="/",
        contents=["nc/**", "collision/**"],
        name="NC program",
        columns=rrb.TextLogColumns(timeline_columns=[timeline], text_log_columns=columns),
        format_options=rrb.TextLogFormat(monospace_body=True),
    )


def _summary() -> rrb.TextDocumentView:
    return rrb.TextDocumentView(origin=layout.SUMMARY, name="Summary")


def _curves(name: str, curves: layout.Curves, *, close: bool = False, marks: bool = False) -> rrb.TimeSeriesView:
    """Curves over the whole run, or around the cursor; an archive that the viewer reads itself has no samples."""
    around = [
        rr.VisibleTimeRange(
            timeline,
            start=rr.TimeRangeBoundary.cursor_relative(seconds=-_CLOSE_S),
            end=rr.TimeRangeBoundary.cursor_relative(seconds=_CLOSE_S),
        )
        for timeline in (layout.TIME, layout.ARCHIVE_TIME)
    ]
    archived = layout.ARCHIVED[curves.entity]
    return rrb.TimeSeriesView(
        origin="/",
        contents=[curves.entity, *((layout.ARCHIVE_FORCE,) if archived else ()), *(("marks/**",) if marks else ())],
        name=name,
        plot_legend=rrb.PlotLegend(visible=not close, corner=rrb.Corner2D.LeftTop),
        time_ranges=around if close else None,
        axis_x=None if close else rrb.TimeAxis(view_range=_WHOLE_RUN),
        overrides={layout.ARCHIVE_FORCE: [_archive_curve(s) for s in archived]} if archived else None,
    )


def _archive_curve(series: layout.Series) -> rrb.Visualizer:
    """A field of the archive's force messages as a curve."""
    lines = rr.SeriesLines(colors=series.color, names=series.label, aggregation_policy="MinMax", widths=1.0)
    return lines.visualizer(
        mappings=[
            VisualizerComponentMapping(
                target="Scalars:scalars",
                source_kind=ComponentSourceKind.SourceComponent,
                source_component=layout.ARCHIVE_FORCE_COMPONENT,
                selector=f".{series.archive_field}",
            )
        ]
    )


if __name__ == "__main__":
    save_blueprint(SHIPPED)
