"""A static scene as a rerun recording: meshes, lines, points, a text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.sinks.rerun.file import RecordingFile

#: Different from that of runs, so that a viewer does not use the layout of one for the other.
_APPLICATION = "twin_scene"
#: Position of the camera, from front, right and above, in multiples of the scene's size.
_EYE = np.array((0.5, -0.75, 0.55))

Colors = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StillMesh:
    """Triangles of one colour, each shaded as flat as it is."""

    entity: str
    vertices_mm: FloatArray
    triangles: NDArray[np.int64]
    color: tuple[int, int, int]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StillLines:
    """Polylines of one colour; width in points on the screen."""

    entity: str
    lines_mm: Sequence[FloatArray]
    color: tuple[int, int, int]
    width: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StillPoints:
    """Points with a colour each; radius in mm."""

    entity: str
    points_mm: FloatArray
    colors: Colors
    radius_mm: float
    labels: Sequence[str] | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Still:
    """A scene.

    Attributes:
        name: the recording's name in the viewer.
        text: Markdown next to it.
    """

    name: str

    meshes: Sequence[StillMesh] = ()
    lines: Sequence[StillLines] = ()
    points: Sequence[StillPoints] = ()
    text: str = field(default="")


def write_still(path: Path, still: Still, *, force: bool = False) -> None:
    """Write a scene.

    Args:
        force: replace a file that exists.

    Raises:
        ArchiveError: a file that already exists, or cannot be written.
    """
    file = RecordingFile(path, force=force)
    recording = rr.RecordingStream(_APPLICATION)
    try:
        file.connect(recording)
        recording.send_recording_name(still.name)
        recording.send_blueprint(_layout(still))
        recording.set_log_tick_enabled(False)
        recording.set_log_time_enabled(False)
        _log(recording, still)
        recording.flush()
        recording.disconnect()
    except BaseException:
        recording.disconnect()
        file.discard()
        raise
    file.close()


def _log(recording: rr.RecordingStream, still: Still) -> None:
    log = recording.log
    log("/", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for mesh in still.meshes:
        log(mesh.entity, _flat(mesh), static=True)
    for lines in still.lines:
        strips = rr.LineStrips3D(lines.lines_mm, colors=lines.color, radii=rr.Radius.ui_points(lines.width))
        log(lines.entity, strips, static=True)
    for points in still.points:
        cloud = rr.Points3D(points.points_mm, colors=points.colors, radii=points.radius_mm, labels=points.labels)
        log(points.entity, cloud, static=True)
    if still.text:
        log("report", rr.TextDocument(still.text, media_type="text/markdown"), static=True)


def _flat(mesh: StillMesh) -> rr.Mesh3D:
    """A mesh whose triangles have corners, and so normals, of their own."""
    corners = mesh.vertices_mm[mesh.triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(cross, axis=1, keepdims=True)
    normals = cross / np.where(length > 0.0, length, 1.0)
    return rr.Mesh3D(
        vertex_positions=corners.reshape(-1, 3),
        triangle_indices=np.arange(3 * len(corners)).reshape(-1, 3),
        vertex_normals=np.repeat(normals, 3, axis=0),
        albedo_factor=[*mesh.color, 255],
    )


def _layout(still: Still) -> rrb.Blueprint:
    """The scene, with the text on its right."""
    points = [m.vertices_mm for m in still.meshes]
    low, high = np.min([p.min(axis=0) for p in points], axis=0), np.max([p.max(axis=0) for p in points], axis=0)
    centre, size = 0.5 * (low + high), float(np.linalg.norm(high - low))
    eye = rrb.EyeControls3D(position=centre + size * _EYE, look_target=centre)
    scene = rrb.Spatial3DView(origin="/", contents=["+ /**", "- /report"], name="Scene", eye_controls=eye)
    return rrb.Blueprint(
        rrb.Horizontal(scene, rrb.TextDocumentView(origin="/report", name="Report"), column_shares=[3, 1]),
        rrb.TimePanel(state="hidden"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        auto_views=False,
        auto_layout=False,
    )
