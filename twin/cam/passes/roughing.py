"""Contour roughing: level by level, pocket by pocket, rings of equal radial depth (the mold paper, section 2.1)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from twin.arrays import FloatArray
from twin.cam.passes.level_free_areas import CHORD_MM, level_free_areas
from twin.cam.passes.pockets import clearing_rings, in_depth, pocket_forest, subdivided
from twin.cam.path.arc_fit import FitOptions, fit_path
from twin.cam.path.linking import LinkOptions, Pass, link
from twin.cam.path.toolpath import ToolPath
from twin.geometry.polygons.free_area import FreeArea, borders
from twin.geometry.polygons.outline import Area, box_area, grown
from twin.tools.shape import ToolShape
from twin.workpiece.solids.from_mesh import Solid

#: Height of the part's surface under a tip, at plan points of shape (n, 2): `DropCutter.drop`.
Drop = Callable[[FloatArray], FloatArray]
#: A pocket must hold a circle of this part of the tool's radius, or the tool cannot be brought into it.
_LEAST_RADIUS = 0.15
#: A link that stays down may be longer than the radial depth by this factor.
_STAY = 2.5
#: A tool that reaches into the stock's sides by less than this does not touch it, mm.
_TOUCH_MM = 0.1
#: Arcs and lines instead of points, mm.
FIT = FitOptions(tolerance_mm=0.01, gouge_mm=0.005)


@dataclass(frozen=True, slots=True, kw_only=True)
class StageFeeds:
    """Feeds of one stage, mm/min.

    Attributes:
        cut, plunge, link: in the cut, straight down, and through cleared areas.
        ramp: on helices and ramps into material.
    """

    cut: float
    plunge: float
    link: float
    ramp: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Workspace:
    """Part, stock and heights that all stages share.

    Attributes:
        part: the part.
        low_mm, high_mm: corners of the stock's box, shape (3,).
        safe_z_mm: height of rapids.
        clearance_mm: distance above material at which rapids down end.
    """

    part: Solid
    low_mm: FloatArray
    high_mm: FloatArray
    safe_z_mm: float
    clearance_mm: float = 1.0

    @property
    def top_mm(self) -> float:
        """The stock's top."""
        return float(self.high_mm[2])

    def window(self, by_mm: float) -> Area:
        """The stock's outline, enlarged by this much on all sides."""
        return box_area((self.low_mm[:2] - by_mm).tolist(), (self.high_mm[:2] + by_mm).tolist())


@dataclass(frozen=True, slots=True, kw_only=True)
class RoughingOptions:
    """How a part is roughed.

    Attributes:
        axial_depth_mm: distance of the levels.
        radial_depth_mm: distance of the rings, at most the tool's radius.
        allowance_mm: left on the part.
        resolution_mm: longest piece of a contour while it is worked on.
        ramp_deg: steepest angle of helices and ramps.
        feeds: of the stage.
    """

    axial_depth_mm: float
    radial_depth_mm: float
    allowance_mm: float
    resolution_mm: float = 0.5
    ramp_deg: float = 3.0
    feeds: StageFeeds


class LevelLinkPlanner:
    """Links in the free areas of all levels, see `twin.cam.path.linking.LinkPlanner`.

    Args:
        levels_mm: decreasing.
        free_areas: of the levels.
        top_mm: the stock's top.
    """

    def __init__(self, levels_mm: Sequence[float], free_areas: Sequence[FreeArea], top_mm: float) -> None:
        self._levels = [round(z, 9) for z in levels_mm]
        self._free_areas = dict(zip(self._levels, free_areas, strict=True))
        self._top_mm = top_mm

    def between(self, start_mm: FloatArray, end_mm: FloatArray) -> FloatArray | None:
        """Straight on the level."""
        line = np.array([start_mm, end_mm])
        return line if start_mm[2] == end_mm[2] and self.free(line) else None

    def free(self, points_mm: FloatArray) -> bool:
        """Whether a level line lies in its level's free area; False at other heights."""
        free_area = self._free_areas.get(round(float(points_mm[0, 2]), 9))
        return free_area is not None and free_area.holds(points_mm[:, :2])

    def clear_z_mm(self, start_mm: FloatArray, end_mm: FloatArray) -> float:
        """The lowest level above the start whose free area holds the link: it was cleared before."""
        line = np.array([start_mm[:2], end_mm[:2]])
        low = max(float(start_mm[2]), min(self._levels)) + 1e-9
        for z in reversed(self._levels):
            if z > low and self._free_areas[z].holds(line):
                return z
        return self._top_mm


def roughing_levels(space: Workspace, options: RoughingOptions) -> list[float]:
    """Heights of the tip from the first cut down to the part's lowest point, decreasing."""
    bottom = float(space.part.vertices_mm[:, 2].min()) + options.allowance_mm
    count = max(1, math.ceil((space.top_mm - bottom) / options.axial_depth_mm - 1e-9))
    return [max(bottom, space.top_mm - options.axial_depth_mm * (k + 1)) for k in range(count)]


def contour_roughing(space: Workspace, tool: ToolShape, options: RoughingOptions, drop: Drop | None = None) -> ToolPath:
    """A path that clears all that the tool can reach from above.

    Args:
        drop: exact heights of the tip on the part; points below them, as over undercuts, are lifted.
    """
    levels, window = roughing_levels(space, options), space.window(tool.max_radius_mm + options.allowance_mm)
    free_areas = level_free_areas(space.part, tool, levels, options.allowance_mm, window)
    used = sum(1 for free_area in free_areas if not free_area.empty)
    levels, free_areas = levels[:used], free_areas[:used]
    passes = list(_passes(space, tool, options, levels, free_areas))
    if drop is not None:
        passes = lifted(passes, drop, options.allowance_mm, options.resolution_mm)
    linking = LinkOptions(
        safe_z_mm=space.safe_z_mm,
        clearance_mm=space.clearance_mm,
        feed_mm_min=options.feeds.cut,
        plunge_mm_min=options.feeds.ramp,  # straight down through air only
        link_mm_min=options.feeds.link,
        stay_down_mm=_STAY * options.radial_depth_mm,
        low_links=True,
        entry="helix",
        ramp_deg=options.ramp_deg,
        helix_mm=0.5 * tool.nominal_radius_mm,
    )
    moves = link(passes, linking, LevelLinkPlanner(levels, free_areas, space.top_mm)) if passes else ()
    return fit_path(ToolPath(moves=moves, tool=tool, name="contour roughing"), FIT)


def _passes(
    space: Workspace, tool: ToolShape, options: RoughingOptions, levels: Sequence[float], free_areas: Sequence[FreeArea]
) -> Iterator[Pass]:
    least = math.pi * (_LEAST_RADIUS * tool.max_radius_mm) ** 2
    stock = FreeArea(space.window(0.0))
    touching = FreeArea(grown(space.window(0.0), tool.max_radius_mm - _TOUCH_MM, CHORD_MM))
    at = space.low_mm[:2]
    for number, pocket in enumerate(in_depth(pocket_forest(free_areas, least), at)):
        closed = stock.holds(next(borders(pocket.area)))
        top = levels[pocket.level - 1] if pocket.level else space.top_mm
        for ring in clearing_rings(pocket.area, options.radial_depth_mm, at, outwards=closed):
            for line in _in_stock(ring, touching, options.resolution_mm):
                at = line[-1]
                points = np.column_stack((line, np.full(len(line), levels[pocket.level])))
                outside = not touching.holds(line[:2])
                yield Pass(points_mm=points, top_mm=None if outside else top, layer=number)


def _in_stock(ring: FloatArray, touching: FreeArea, resolution_mm: float) -> Iterator[FloatArray]:
    """The parts of a ring that touch the stock, with a step outside at both ends; the whole ring where all does."""
    if touching.holds(ring):
        yield ring
        return
    line = subdivided(ring, resolution_mm)
    inside = np.asarray(touching.holds_points(line), dtype=bool)
    if not inside.any():
        return
    if inside.all():
        yield ring
        return
    # begin the closed line where it is outside
    begin = int(np.flatnonzero(~inside[:-1])[0])
    line, inside = np.roll(line[:-1], -begin, axis=0), np.roll(inside[:-1], -begin)
    line, inside = np.vstack((line, line[:1])), np.append(inside, False)
    edges = np.flatnonzero(np.diff(inside.astype(np.int8)))
    for first, last in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        yield line[first : last + 2]


def lifted(passes: Sequence[Pass], drop: Drop, allowance_mm: float, resolution_mm: float) -> list[Pass]:
    """Passes no point of which lies below the tip's exact height on the part plus the allowance.

    Points of all passes are dropped at once, subdivided to the resolution; a pass that lies above them is unchanged.
    """
    if not passes:
        return []
    fine = [subdivided(p.points_mm, resolution_mm) for p in passes]
    heights = drop(np.ascontiguousarray(np.concatenate(fine)[:, :2])) + allowance_mm
    bounds = np.cumsum([0, *(len(f) for f in fine)])
    result: list[Pass] = []
    for one, line, first in zip(passes, fine, bounds[:-1].tolist(), strict=True):
        floor = heights[first : first + len(line)]
        if np.all(floor <= line[:, 2] + allowance_mm * 0.5 + 1e-6):
            result.append(one)
            continue
        raised = np.column_stack((line[:, :2], np.maximum(line[:, 2], floor)))
        result.append(Pass(points_mm=raised, top_mm=one.top_mm, layer=one.layer))
    return result
