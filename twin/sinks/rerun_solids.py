"""Solids that stand still, as a rerun recording: a part and what is left on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.errors import ArchiveError
from twin.sinks.rerun_file import RecordingFile


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SolidView:
    """One solid of a scene.

    Attributes:
        entity: its path in the scene, as ``leftover/ball_8``.
        vertices_mm: shape (n, 3).
        triangles: shape (m, 3).
        color: red, green, blue, alpha, 0 to 255.
        text: what is told of it, empty for nothing.
    """

    entity: str
    vertices_mm: FloatArray
    triangles: NDArray[np.int64]
    color: tuple[int, int, int, int]
    text: str = ""


def write_solids(path: Path, name: str, solids: Sequence[SolidView], *, force: bool = False) -> None:
    """Write a scene under its final name, whole or not at all.

    Args:
        name: the recording's name in the viewer.
        force: replace a file that is there.

    Raises:
        ArchiveError: a suffix that viewers do not know, a file that is there, or one that cannot be written.
    """
    if path.suffix.lower() != ".rrd":
        raise ArchiveError(f"{path}: expected a file name that ends in .rrd")
    file = RecordingFile(path, force=force)
    recording = rr.RecordingStream("twin_solids")
    file.connect(recording)
    try:
        recording.send_recording_name(name)
        recording.log("/", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        for solid in solids:
            _draw(recording, solid)
    except BaseException:
        recording.disconnect()
        file.discard()
        raise
    recording.disconnect()
    file.close()


def _draw(recording: rr.RecordingStream, solid: SolidView) -> None:
    corners = solid.vertices_mm[solid.triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(cross, axis=1, keepdims=True)
    normals = np.repeat(cross / np.where(size > 0.0, size, 1.0), 3, axis=0)
    mesh = rr.Mesh3D(
        vertex_positions=corners.reshape(-1, 3).astype(np.float32),
        vertex_normals=normals.astype(np.float32),
        triangle_indices=np.arange(corners.size // 3, dtype=np.uint32).reshape(-1, 3),
        albedo_factor=solid.color,
    )
    recording.log(solid.entity, mesh, static=True, strict=True)
    if solid.text:
        recording.log(f"{solid.entity}/text", rr.TextDocument(solid.text), static=True, strict=True)
