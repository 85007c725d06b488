"""Checks of part, stock and tools, before and after the paths are made."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from twin.arrays import FloatArray
from twin.cam.passes.pockets import subdivided
from twin.cam.path.toolpath import ToolPath
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import Surface
from twin.errors import StockError
from twin.job.job_file import Tool
from twin.tools.shape import tool_shape
from twin.workpiece.solids.from_mesh import Solid

#: Faces that overhang by an angle with a sine below this count as vertical.
_LEAN = 1e-3
#: Distance of the tool positions that are checked for reach, and permitted overlap, mm.
_REACH_STEP_MM, _REACH_SLACK_MM = 1.0, 0.05


def check_stock(part: Solid, low_mm: FloatArray, high_mm: FloatArray) -> None:
    """Check that the stock contains the part.

    Args:
        part: the part.
        low_mm, high_mm: corners of the stock, shape (3,).

    Raises:
        StockError: it does not; the message names axis and side.
    """
    low, high = part.vertices_mm.min(axis=0), part.vertices_mm.max(axis=0)
    for axis, name in enumerate("xyz"):
        if low[axis] < low_mm[axis] - 1e-6:
            raise StockError(
                f"stock: begins at {name} = {low_mm[axis]:g}; expected {low[axis]:g} or less, where the part begins"
            )
        if high[axis] > high_mm[axis] + 1e-6:
            raise StockError(
                f"stock: ends at {name} = {high_mm[axis]:g}; expected {high[axis]:g} or more, where the part ends"
            )


def undercut_warnings(part: Solid) -> Iterator[str]:
    """Faces that face down above the part's underside; a tool from above cannot reach below them."""
    corners = part.vertices_mm[part.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.linalg.norm(normals, axis=1)
    low = float(part.vertices_mm[:, 2].min())
    above = corners[:, :, 2].max(axis=1) > low + 1e-4
    under = np.flatnonzero(above & (normals[:, 2] < -_LEAN * doubled))
    if len(under) == 0:
        return
    area = 0.5 * float(doubled[under].sum())
    x, y, z = corners[under[np.argmax(doubled[under])]].mean(axis=0)
    yield (
        f"undercuts: {len(under)} triangles with {area:.4g} mm2 face down, the largest at X{x:.2f} Y{y:.2f} Z{z:.2f}; "
        "the part is machined as seen from above"
    )


def reach_warnings(stage: str, path: ToolPath, tool: Tool, surface: Surface) -> Iterator[str]:
    """Shank or holder that would touch the finished part, with position and missing tool length."""
    height = tool.flute_length_mm
    parts = [("shank", tool.shank)] if tool.shank is not None else []
    parts += [("holder", one) for one in tool.holder]
    if not parts or path.empty:
        return
    tips = tips_of(path, _REACH_STEP_MM)
    for name, part in parts:
        if part.diameter_mm > tool.diameter_mm:
            disc = tool_shape("flat", part.diameter_mm, max(part.length_mm, 1e-3))
            missing = DropCutter(surface, disc).drop(np.ascontiguousarray(tips[:, :2])) - (tips[:, 2] + height)
            k = int(np.argmax(missing))
            if missing[k] > _REACH_SLACK_MM:
                x, y, z = tips[k]
                yield (
                    f"{stage}: the {name} of tool {tool.number} would touch the part at X{x:.2f} Y{y:.2f} Z{z:.2f}; "
                    f"the tool is {missing[k]:.2f} mm too short there"
                )
        height += part.length_mm


def flute_warnings(stage: str, depth_mm: float, tool: Tool) -> Iterator[str]:
    """An axial depth of cut greater than the flute length."""
    if depth_mm > tool.flute_length_mm:
        yield (
            f"{stage}: axial depth {depth_mm:g} mm is more than the flute length of tool {tool.number}, "
            f"{tool.flute_length_mm:g} mm"
        )


def tips_of(path: ToolPath, step_mm: float, kinds: Sequence[str] = ()) -> FloatArray:
    """Tip positions along a path's moves, shape (n, 3); only of moves of the given kinds, if any are given."""
    lines = [subdivided(m.chords_mm(), step_mm) for m in path.moves if not kinds or m.kind in kinds]
    return np.concatenate(lines)
