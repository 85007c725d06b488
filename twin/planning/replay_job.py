"""The job file that replays a planned program."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from twin.archive.container.partial import replacing
from twin.arrays import FloatArray
from twin.cam.path.to_nc import NcOptions, Operation, describe, kind_of
from twin.errors import ToolPathError
from twin.settings.toml_text import toml_text

#: The replay has at least this many slices over the diameter of the smallest tool.
_SLICES_PER_DIAMETER = 20.0


def replay_tables(
    program: Path,
    operations: Sequence[Operation],
    options: NcOptions,
    stock_mm: FloatArray,
    pitch_mm: float,
    folder: Path,
) -> dict[str, Any]:
    """The tables of a job file.

    Args:
        program: the NC program.
        operations: tools and paths in the program.
        options: dialect and work offset of the program.
        stock_mm: the stock's box, lower and upper corner, shape (2, 3).
        pitch_mm: slice pitch of the replay, at most.
        folder: folder of the job file.
    """
    tools = {o.number: o for o in operations}
    thinnest = min(2.0 * o.path.tool.nominal_radius_mm for o in operations)
    tables: dict[str, Any] = {
        "program": {"file": os.path.relpath(program, folder), "dialect": options.dialect},
        "machine": {"offsets": {options.wcs: [0.0, 0.0, 0.0]}},
        "stock": {"box_mm": {"min": stock_mm[0].tolist(), "max": stock_mm[1].tolist()}, "wcs": options.wcs},
        "tools": [_tool(o) for _, o in sorted(tools.items())],
        "simulation": {"slice_pitch_mm": min(pitch_mm, thinnest / _SLICES_PER_DIAMETER)},
    }
    if options.dialect == "grbl":
        tables["program"]["tool"] = operations[0].number
    return tables


def _tool(operation: Operation) -> dict[str, Any]:
    shape = operation.path.tool
    table: dict[str, Any] = {
        "number": operation.number,
        "name": describe(shape),
        "kind": kind_of(shape),
        "diameter_mm": 2.0 * shape.nominal_radius_mm,
        "teeth": operation.teeth,
        "flute_length_mm": shape.height_mm,
        "length_mm": operation.length_mm,
    }
    if table["kind"] in ("bull", "taper") and shape.corner_radius_mm:
        table["corner_radius_mm"] = shape.corner_radius_mm
    if shape.taper_rad:
        table["taper_deg"] = math.degrees(shape.taper_rad)
    return table


def write_replay_job(path: Path, tables: Mapping[str, Any], comment: str) -> None:
    """Write a job file completely or not at all.

    Args:
        path: the file.
        tables: its tables.
        comment: its first line.

    Raises:
        ToolPathError: the file cannot be written.
    """
    with replacing(path, ToolPathError) as partial:
        partial.write_text(f"# {comment}\n\n{toml_text(tables)}", encoding="utf-8")
