"""Tool paths over their part as a rerun recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.sinks.rerun_file import RecordingFile
from twin.sinks.rerun_layout import APPLICATION_ID

_COLOURS: Mapping[str, tuple[int, int, int]] = {
    "cut": (60, 140, 230),
    "rapid": (220, 60, 50),
    "link": (70, 190, 90),
    "helix": (240, 150, 40),
    "ramp": (240, 150, 40),
}
_OTHER = (160, 90, 200)


def write_paths(
    file: Path,
    vertices_mm: FloatArray,
    triangles: NDArray[np.int64],
    paths: Mapping[str, Mapping[str, Sequence[FloatArray]]],
    *,
    force: bool = False,
) -> None:
    """Write a part and polylines over it.

    Args:
        vertices_mm, triangles: the part.
        paths: for each stage the polylines of each kind of move, shape (n, 3) each.
        force: whether a file that is there may be replaced.

    Raises:
        ArchiveError: the file is there already, or cannot be written.
    """
    target = RecordingFile(file, force=force)
    recording = rr.RecordingStream(APPLICATION_ID)
    target.connect(recording)
    recording.send_recording_name(file.stem)
    recording.log("/", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    part = rr.Mesh3D(
        vertex_positions=vertices_mm.astype(np.float32),
        triangle_indices=triangles.astype(np.uint32),
        albedo_factor=(170, 175, 185),
    )
    recording.log("part", part, static=True)
    for stage, kinds in paths.items():
        for kind, lines in kinds.items():
            strips = rr.LineStrips3D(
                [line.astype(np.float32) for line in lines],
                colors=_COLOURS.get(kind, _OTHER),
                radii=rr.Radius.ui_points(0.5 if kind == "rapid" else 1.0),
            )
            recording.log(f"{stage}/{kind}", strips, static=True)
    recording.disconnect()
    target.close()
