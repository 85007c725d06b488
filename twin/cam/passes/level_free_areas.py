"""Where a tool's axis may be at each height, from slices of the part.

The mold paper, section 2.1: the contours of a level are offset by tool radius and allowance, outlines of hollows
(Cavity) inwards and outlines of what stands in them (Boss) outwards, each kind is united, and Boss is subtracted from
Cavity. That is what growing the level's section does: its holes are the cavities, its outer rings the bosses.

A part is cut from above, so a level's section is united with those above it. A tool with a round corner touches at
several heights: the section at each is grown by the tool's radius at the next one above, which errs away from the
part, by one step of the radius at most; on vertical walls and floors it does not err. The allowance is kept in all
directions, for sections are taken that much below the tool.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from twin.arrays import FloatArray
from twin.geometry.mesh.slicing import MeshEdges, mesh_sections
from twin.geometry.polygons.free_area import FreeArea, simplified, united
from twin.geometry.polygons.outline import Area, grown, minus
from twin.geometry.polygons.shapes import to_shape
from twin.tools.shape import ToolShape
from twin.workpiece.solids.from_mesh import Solid

#: How far borders may be moved away from the part by chords and left-out vertices.
CHORD_MM = 0.005
#: Largest step of the radius between two sections of a round corner, and the most steps.
_RADIUS_STEP_MM, _MOST_STEPS = 0.3, 10


def tool_steps(tool: ToolShape) -> tuple[tuple[float, float], ...]:
    """Heights above the tip, and the largest radius from each to the next one; the last is the largest of all."""
    if tool.corner_radius_mm == 0.0 and tool.taper_rad == 0.0:
        return ((0.0, tool.max_radius_mm),)
    reach = tool.max_radius_mm - tool.disc_mm
    count = max(1, min(_MOST_STEPS, math.ceil(reach / _RADIUS_STEP_MM)))
    radii = tool.disc_mm + reach * np.arange(1, count + 1) / count
    heights = [0.0, *(_height_at(tool, r) for r in radii[:-1].tolist())]
    return tuple(zip(heights, radii.tolist(), strict=True))


def _height_at(tool: ToolShape, radius_mm: float) -> float:
    """Height above the tip where the meridian has a radius."""
    if radius_mm <= tool.arc_radius_mm:
        return tool.corner_radius_mm - math.sqrt(max(0.0, tool.corner_radius_mm**2 - (radius_mm - tool.disc_mm) ** 2))
    return tool.arc_height_mm + (radius_mm - tool.arc_radius_mm) / math.tan(tool.taper_rad)


def level_free_areas(
    part: Solid, tool: ToolShape, levels_mm: Sequence[float], allowance_mm: float, window: Area
) -> tuple[FreeArea, ...]:
    """The free area of a tool's axis at each level.

    Args:
        levels_mm: heights of the tip, decreasing.
        allowance_mm: left on the part.
        window: where the axis may be at all.
    """
    steps = tool_steps(tool)
    low = float(part.vertices_mm[:, 2].min())
    # a section at or below the underside would be empty; the part's lowest one stands for it
    wanted = np.array([[max(z - allowance_mm + h, low + 1e-4) for h, _ in steps] for z in levels_mm])
    sections = _sections(part, part.edges, np.unique(wanted))
    above: Area = united([])
    free_areas: list[FreeArea] = []
    for row in wanted.tolist():
        parts = [
            grown(sections[z], r + allowance_mm + 0.5 * CHORD_MM, 0.5 * CHORD_MM)
            for z, (_, r) in zip(row, steps, strict=True)
        ]
        above = simplified(united([above, *(grown(p, 0.0, CHORD_MM) for p in parts)]), 1e-4)
        free_areas.append(FreeArea(minus(window, above)))
    return tuple(free_areas)


def _sections(part: Solid, edges: MeshEdges, planes_mm: FloatArray) -> dict[float, Area]:
    regions = mesh_sections(part.vertices_mm, part.triangles, edges, (2, 0, 1), planes_mm)
    return {
        z: simplified(to_shape(region), 0.5 * CHORD_MM) for z, region in zip(planes_mm.tolist(), regions, strict=True)
    }
