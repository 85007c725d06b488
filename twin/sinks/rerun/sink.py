"""A run in the rerun viewer: part, tool and path in 3D, forces below, NC blocks on the right (docs/rerun.md)."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType
from typing import Any, Self
from uuid import uuid4

import numpy as np
import rerun as rr

from twin.arrays import FloatArray
from twin.errors import ArchiveError
from twin.record import Collision, NcEvent, Record, RunHeader, RunSummary, Step, ToolRecord, WorkpiecePatch
from twin.sinks.rerun import layout
from twin.sinks.rerun.batches import Moments, PathBatch, PoseBatch, StepBatch, path_columns
from twin.sinks.rerun.blueprint import blueprint
from twin.sinks.rerun.envelope import Envelope, EnvelopeRows, SampleColumns, Selection
from twin.sinks.rerun.file import RecordingFile
from twin.sinks.rerun.scene import draw_colors, draw_scale, draw_scene
from twin.sinks.rerun.shapes import scale_end_n, tool_mesh, view_box
from twin.sinks.rerun.summary import summary_text
from twin.sinks.rerun.viewer import require_viewer, viewer_sink
from twin.sinks.rerun.web import WebServer


class RerunSink:
    """Writes a ``.rrd`` file, shows the run live, or both.

    Args:
        rrd: the recording's file; missing folders above it are created. It is named ``*.partial.rrd`` until `close`.
        spawn: start a viewer and show the run while it is computed.
        web: server for a browser that shows it.
        force: replace an existing file instead of refusing.
        job: job file of the run: a recording that was made from it is replaced without ``force``.

    Raises:
        ArchiveError: the file already exists, or cannot be created.
        TwinError: there is no screen for the viewer.
        ValueError: neither a file nor a viewer is requested.
    """

    def __init__(
        self,
        *,
        rrd: Path | None = None,
        spawn: bool = False,
        web: WebServer | None = None,
        force: bool = False,
        job: Path | None = None,
    ) -> None:
        if rrd is None and not spawn and web is None:
            raise ValueError("rrd, spawn or web must be given")
        if spawn:
            require_viewer()
        self._file = RecordingFile(Path(rrd), force=force, job=job) if rrd is not None else None
        self._spawn, self._web = spawn, web
        self._recording: rr.RecordingStream | None = None
        self._closed = False
        self._batch = StepBatch()
        self._path, self._poses = PathBatch(0.0), PoseBatch(0.0)
        self._envelope, self._selection = Envelope(0.0), Selection(0.0)
        self._tools: dict[int, ToolRecord] = {}
        self._tool: int | None = None
        self._scale_n = 0.0
        self._now = (0.0, 0, 0)
        self._tip = (0.0, 0.0, 0.0)
        self._view_mm = np.zeros((2, 3))

    def write(self, record: Record) -> None:
        """Take one record.

        Raises:
            ArchiveError: the disk is full or the like; or the record does not belong here.
        """
        if self._closed:
            raise ArchiveError("the recording is closed")
        if isinstance(record, RunHeader):
            self._start(record)
            return
        if self._recording is None:
            raise ArchiveError(f"a run begins with its RunHeader, got {type(record).__name__}")
        match record:
            case Step():
                self._step(record)
            case NcEvent():
                self._event(record)
            case Collision():
                self._collision(record)
            case WorkpiecePatch():
                self._patch(record)
            case RunSummary():
                self._send_batch()
                text = summary_text(record, all_samples=self._selection.complete)
                self._log(layout.SUMMARY, None, rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN))
        if self._file is not None:
            self._file.check()

    def close(self) -> None:
        """Send the last batch and complete the file; may be called twice. A closed viewer does not raise an error.

        Raises:
            ArchiveError: the end could not be written; the part written so far is kept under the partial name.
        """
        if self._closed:
            return
        self._closed = True
        if self._recording is not None:
            self._send_batch()
            self._send_envelope(self._envelope.rest())
            if self._tool is not None:
                self._log(layout.TOOL, self._now, rr.Transform3D.from_fields(translation=self._tip))
            self._recording.disconnect()
        if self._file is not None:
            self._file.close()

    def discard(self) -> None:
        """End without leaving a file; a viewer keeps the data that it has."""
        if self._closed:
            return
        self._closed = True
        if self._recording is not None:
            self._recording.disconnect()
        if self._file is not None:
            self._file.discard()

    def _start(self, header: RunHeader) -> None:
        if self._recording is not None:
            raise ArchiveError("a run has one RunHeader, got a second one")
        recording = rr.RecordingStream(layout.APPLICATION_ID, recording_id=f"{header.job or 'run'}-{uuid4().hex}")
        viewers = [viewer_sink()] if self._spawn else []
        viewers += [self._web.sink()] if self._web is not None else []
        if self._file is not None:
            self._file.connect(recording, *viewers)
        else:
            recording.set_sinks(*viewers)
        self._view_mm = view_box(header)
        recording.send_blueprint(blueprint(self._view_mm))
        recording.set_log_tick_enabled(False)
        recording.set_log_time_enabled(False)
        recording.send_recording_name(header.program)
        self._recording = recording
        self._tools = {tool.number: tool for tool in header.tools}
        planned_s = header.planned_time_s
        self._path, self._poses = PathBatch(planned_s), PoseBatch(planned_s)
        self._envelope, self._selection = Envelope(planned_s), Selection(planned_s)
        draw_scene(recording, header)

    def _step(self, step: Step) -> None:
        if step.tool != self._tool:
            self._tool = step.tool
            self._change_tool(step)
        self._path.add(step)
        self._now = (step.t_s + step.duration_s, step.index + 1, step.nc_line)
        self._tip = step.end_mm
        if self._batch.add(step):
            self._send_batch()

    def _change_tool(self, step: Step) -> None:
        """Draw the tool in the spindle, or clear it."""
        tool = self._tools.get(step.tool)
        moment = (step.t_s, step.index, step.nc_line)
        if tool is None:
            self._log(layout.TOOL, moment, rr.Clear(recursive=False))
            return
        mesh = tool_mesh(tool.profile_mm)
        self._log(
            layout.TOOL,
            moment,
            rr.Mesh3D(
                vertex_positions=mesh.vertices,
                vertex_normals=mesh.normals,
                triangle_indices=mesh.triangles,
                albedo_factor=layout.TOOL_COLOR,
            ),
        )

    def _event(self, event: NcEvent) -> None:
        self._now = (event.t_s, self._now[1], event.nc_line)
        level, color = layout.EVENT_STYLE[event.kind]
        text = f"{event.nc_line:>6}  {event.text}"
        self._log(layout.BLOCKS, self._now, rr.TextLog(text, level=level, color=color))
        if event.kind == "notice":
            self._log(layout.WARNING_MARK, self._now, rr.Scalars(0.0))

    def _collision(self, collision: Collision) -> None:
        moment = (collision.t_s, self._now[1], collision.nc_line)
        message = collision.message.partition(f":{collision.nc_line}: ")[2] or collision.message
        text = f"{collision.nc_line:>6}  COLLISION {message}"
        self._log(layout.COLLISION_LOG, moment, rr.TextLog(text, level="ERROR", color=layout.COLLISION_COLOR))
        self._log(layout.COLLISION_MARK, moment, rr.Scalars(0.0))
        self._log(
            layout.COLLISIONS,
            moment,
            rr.Points3D(
                [collision.point_mm],
                colors=layout.COLLISION_COLOR,
                radii=rr.Radius.ui_points(6.0),
                labels=f"{collision.kind}, line {collision.nc_line}",
            ),
        )

    def _patch(self, patch: WorkpiecePatch) -> None:
        moment = (patch.t_s, self._now[1], self._now[2])
        entity = f"{layout.WORKPIECE}/{patch.patch}"
        if not len(patch.vertices_mm):
            self._log(entity, moment, rr.Clear(recursive=False))
            return
        self._log(
            entity,
            moment,
            rr.Mesh3D(
                vertex_positions=patch.vertices_mm,
                vertex_normals=patch.normals,
                triangle_indices=patch.triangles,
                albedo_factor=layout.PART_COLOR,
            ),
        )

    def _send_batch(self) -> None:
        steps = self._batch.take()
        if not steps:
            return
        if poses := self._poses.columns(steps):
            self._send(layout.TOOL, poses[0], rr.Transform3D.columns(translation=poses[1]))
        samples = SampleColumns.of(steps)
        self._send_envelope(self._envelope.rows(samples))
        kept = self._selection.of(samples)
        if len(kept.t_s):
            self._send_curves(layout.SAMPLES, Moments(kept.t_s, kept.step, kept.nc_line), kept.loads)
        for entity, rows in self._path.take():
            self._send(entity, *path_columns(rows))
        end_n = scale_end_n(self._path.highest_n)
        if self._recording is not None and end_n != self._scale_n:
            self._scale_n = end_n
            draw_colors(self._recording, end_n)
            if self._path.highest_n > 0.0:
                draw_scale(self._recording, self._view_mm, end_n)

    def _send_envelope(self, rows: EnvelopeRows | None) -> None:
        """Rows of the curves over the whole run."""
        if rows is None:
            return
        moments = Moments(rows.t_s, rows.step, rows.nc_line)
        low, high, mean = rows.low, rows.high, rows.mean
        self._send_curves(layout.ENVELOPE, moments, np.stack((low, high, mean), axis=2)[:, :3].reshape(-1, 9))
        self._send_curves(layout.RESULTANT_CURVES, moments, np.column_stack((high[:, 3], mean[:, 3])))
        self._send_curves(layout.TORQUE_CURVES, moments, np.column_stack((high[:, 4], mean[:, 4])))

    def _send_curves(self, curves: layout.Curves, moments: Moments, values: FloatArray) -> None:
        """Rows of several curves; values have shape (n, curves)."""
        columns = rr.Scalars.columns(scalars=values.ravel()).partition([values.shape[1]] * len(values))
        self._send(curves.entity, moments, columns)

    def _send(self, entity: str, moments: Moments, columns: Any) -> None:
        """Many rows of an entity."""
        if self._recording is not None:
            self._recording.send_columns(entity, moments.columns(), columns, strict=True)

    def _log(self, entity: str, moment: tuple[float, int, int] | None, what: rr.AsComponents) -> None:
        """One row of an entity; None for a static one."""
        if self._recording is None:
            return
        if moment is not None:
            t_s, step, nc_line = moment
            self._recording.set_time(layout.TIME, duration=np.timedelta64(round(t_s * 1e9), "ns"))
            self._recording.set_time(layout.STEP, sequence=step)
            self._recording.set_time(layout.NC_LINE, sequence=nc_line)
        self._recording.log(entity, what, static=moment is None, strict=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
