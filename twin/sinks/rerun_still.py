"""A scene that does not change, as a rerun recording: meshes, lines, points, a text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.sinks.rerun_file import RecordingFile

Colors = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StillMesh:
    """Triangles with one colour, or one a vertex, shape (n, 3) or (n, 4)."""

    entity: str
    vertices_mm: FloatArray
    triangles: NDArray[np.int64]
    colors: Colors


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
        text: markdown beside it.
    """

    meshes: Sequence[StillMesh] = ()
    lines: Sequence[StillLines] = ()
    points: Sequence[StillPoints] = ()
    text: str = field(default="")


def write_still(path: Path, still: Still, *, force: bool = False) -> None:
    """Write a scene.

    Args:
        force: replace a file that is there.

    Raises:
        ArchiveError: a file that is there already, or cannot be written.
    """
    file = RecordingFile(path, force=force)
    recording = rr.RecordingStream("twin")
    try:
        file.connect(recording)
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
        shape = rr.Mesh3D(
            vertex_positions=mesh.vertices_mm,
            triangle_indices=mesh.triangles,
            vertex_normals=_normals(mesh.vertices_mm, mesh.triangles),
            vertex_colors=mesh.colors,
        )
        log(mesh.entity, shape, static=True)
    for lines in still.lines:
        strips = rr.LineStrips3D(lines.lines_mm, colors=lines.color, radii=rr.Radius.ui_points(lines.width))
        log(lines.entity, strips, static=True)
    for points in still.points:
        cloud = rr.Points3D(points.points_mm, colors=points.colors, radii=points.radius_mm, labels=points.labels)
        log(points.entity, cloud, static=True)
    if still.text:
        log("report", rr.TextDocument(still.text, media_type="text/markdown"), static=True)


def _normals(vertices: FloatArray, triangles: NDArray[np.int64]) -> FloatArray:
    """Normals at vertices: means of the faces', weighted by area."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    cross = np.cross(b - a, c - a)
    total = np.zeros_like(vertices)
    for i in range(3):
        np.add.at(total, triangles[:, i], cross)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    normals: FloatArray = total / np.where(length > 0.0, length, 1.0)
    return normals
