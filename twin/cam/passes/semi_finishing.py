"""Semi-finishing of the rest material of roughing: cuts of each level where there is material, in a short order.

The mold paper, section 2.2, takes remaining regions as points and orders them by a travelling salesman's tour. Here the
pieces to be ordered are stretches of contour: each follows the wall and cuts all along, so what is saved by the order
is not lost by bent paths. The tour's cost is time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from twin.arrays import FloatArray
from twin.cam.passes.level_free_areas import level_free_areas
from twin.cam.passes.levels import Cut, CutOptions, cuts_of, ring_layers
from twin.cam.passes.roughing import FIT, LevelLinkPlanner, RoughingOptions, StageFeeds, Workspace, roughing_levels
from twin.cam.path.arc_fit import fit_path
from twin.cam.path.linking import LinkOptions, Pass, link
from twin.cam.path.machining_time import Dynamics
from twin.cam.path.toolpath import ToolPath
from twin.cam.path.tour import ClearGrid, LinkSpeeds, Search, order_pieces
from twin.cam.stock.dexel import Dexels
from twin.cam.stock.rest import stock_heights
from twin.geometry.polygons.free_area import FreeArea
from twin.tools.shape import ToolShape

#: Called after each step with the steps done and all steps.
Report = Callable[[int, int], None]
#: Distance of the points checked along a link over the stock, mm.
_LINK_STEP_MM = 0.5
#: Pitch of the map in which links look for walls, mm.
_MAP_PITCH_MM = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class SemiOptions:
    """How rest material is removed.

    Attributes:
        axial_depth_mm, radial_depth_mm: distance of levels and of rings.
        allowance_mm: left on the part.
        least_mm: material thinner than this is left for finishing.
        resolution_mm: distance of the points that are checked.
        direction: ``both`` lets cuts run in either direction, ``climb`` with the part on the right only.
        search: of the order.
        feeds: of the stage.
    """

    axial_depth_mm: float
    radial_depth_mm: float
    allowance_mm: float
    least_mm: float = 0.1
    resolution_mm: float = 0.4
    direction: Literal["both", "climb"] = "both"
    search: Search = field(default_factory=Search)
    feeds: StageFeeds

    @property
    def levels(self) -> RoughingOptions:
        """The levels' distances, as roughing has them."""
        return RoughingOptions(
            axial_depth_mm=self.axial_depth_mm,
            radial_depth_mm=self.radial_depth_mm,
            allowance_mm=self.allowance_mm,
            feeds=self.feeds,
        )

    @property
    def cutting(self) -> CutOptions:
        """Which stretches count as cutting."""
        return CutOptions(
            least_mm=self.least_mm, resolution_mm=self.resolution_mm, bridge_mm=2.0 * self.radial_depth_mm
        )


@dataclass(frozen=True, slots=True, eq=False)
class LevelCuts:
    """Cuts at one level.

    Attributes:
        z_mm: height of the tip.
        free_area: of the tool's axis.
        cuts: without order.
    """

    z_mm: float
    free_area: FreeArea
    cuts: tuple[Cut, ...]


class StockLinkPlanner(LevelLinkPlanner):
    """Links in the free areas of all levels, and over the stock; see `twin.cam.path.linking.LinkPlanner`.

    Args:
        stock: before the stage.
        tool: of the stage.
    """

    def __init__(self, levels: Sequence[LevelCuts], top_mm: float, stock: Dexels, tool: ToolShape) -> None:
        super().__init__([one.z_mm for one in levels], [one.free_area for one in levels], top_mm)
        self._stock, self._tool = stock, tool

    def clear_z_mm(self, start_mm: FloatArray, end_mm: FloatArray) -> float:
        """Lowest tip that touches nothing of the stock on the link."""
        count = max(1, math.ceil(float(np.linalg.norm(end_mm[:2] - start_mm[:2])) / _LINK_STEP_MM))
        part = (np.arange(count + 1) / count)[:, None]
        line = start_mm[:2] * (1.0 - part) + end_mm[:2] * part
        highest = float(stock_heights(self._stock, self._tool, line, threads=1).max())
        return min(self._top_mm, highest) if math.isfinite(highest) else float(min(start_mm[2], end_mm[2]))


def remaining_cuts(
    space: Workspace, tool: ToolShape, options: SemiOptions, stock: Dexels, report: Report | None = None
) -> list[LevelCuts]:
    """The parts of the levels' contours that cut, from the top; the stock is lowered by them."""
    levels = roughing_levels(space, options.levels)
    window = space.window(tool.max_radius_mm)
    free_areas = level_free_areas(space.part, tool, levels, options.allowance_mm, window)
    found: list[LevelCuts] = []
    for number, (z, free_area) in enumerate(zip(levels, free_areas, strict=True)):
        if free_area.empty:
            continue
        cuts = tuple(cuts_of(ring_layers(free_area, options.radial_depth_mm), z, tool, stock, options.cutting))
        if cuts:
            found.append(LevelCuts(z, free_area, cuts))
        if report is not None:
            report(number + 1, len(levels))
    return found


def ordered_passes(
    levels: Sequence[LevelCuts],
    maps: Sequence[ClearGrid],
    space: Workspace,
    options: SemiOptions,
    dynamics: Dynamics,
) -> Iterator[Pass]:
    """Passes level by level, in each the order of a tour; those reached without going up share a layer."""
    at = space.low_mm[:2]
    layer = 0
    for one, clear in zip(levels, maps, strict=True):
        ends = np.array([(c.points_mm[0, :2], c.points_mm[-1, :2]) for c in one.cuts])
        tour = order_pieces(
            ends,
            at,
            link_speeds(options.feeds, dynamics),
            lift_s=lift_s(space, one.z_mm, options.feeds, dynamics),
            start_lift_s=lift_s(space, one.z_mm, options.feeds, dynamics),
            clear=clear,
            two_way=options.direction == "both",
            search=options.search,
        )
        for k, (piece, backwards) in enumerate(zip(tour.order.tolist(), tour.backwards.tolist(), strict=True)):
            layer += k == 0 or not tour.down[k]
            cut = one.cuts[piece]
            points = cut.points_mm[::-1] if backwards else cut.points_mm
            top = cut.top_mm[1 if backwards else 0]
            yield Pass(points_mm=points, top_mm=top if top > one.z_mm else None, layer=layer)
            at = points[-1, :2]


def link_speeds(feeds: StageFeeds, dynamics: Dynamics) -> LinkSpeeds:
    """Speeds of links of a stage."""
    return LinkSpeeds(
        feed_mm_s=feeds.link / 60.0,
        feed_mm_s2=dynamics.acceleration_mm_s2,
        rapid_mm_s=dynamics.rapid_mm_min / 60.0,
        rapid_mm_s2=dynamics.rapid_mm_s2,
    )


def lift_s(space: Workspace, z_mm: float, feeds: StageFeeds, dynamics: Dynamics) -> float:
    """Half the time of going up from a level over the stock and down again, the last bit at the plunging feed."""
    rise, speed = max(space.top_mm + space.clearance_mm - z_mm, 0.0), dynamics.rapid_mm_min / 60.0
    ramp = speed * speed / dynamics.rapid_mm_s2
    up = rise / speed + speed / dynamics.rapid_mm_s2 if rise > ramp else 2.0 * math.sqrt(rise / dynamics.rapid_mm_s2)
    return up + 0.5 * space.clearance_mm / (feeds.plunge / 60.0)


def clear_maps(levels: Sequence[LevelCuts], space: Workspace) -> list[ClearGrid]:
    """Maps of the free areas of levels, in which links look for walls."""
    return [_clear_map(one.free_area, space) for one in levels]


def _clear_map(free_area: FreeArea, space: Workspace) -> ClearGrid:
    low, high = space.low_mm[:2] - 1.0, space.high_mm[:2] + 1.0
    x, y = (np.arange(low[i], high[i] + _MAP_PITCH_MM, _MAP_PITCH_MM) for i in (0, 1))
    gx, gy = np.meshgrid(x, y, indexing="ij")
    inside = free_area.holds_points(np.column_stack((gx.ravel(), gy.ravel())))
    return ClearGrid.of(np.asarray(inside, dtype=bool).reshape(gx.shape), low, _MAP_PITCH_MM)


def linked(
    passes: Sequence[Pass],
    space: Workspace,
    tool: ToolShape,
    feeds: StageFeeds,
    planner: LevelLinkPlanner,
    stay_down_mm: float,
) -> ToolPath:
    """Passes as one path: straight down into a cut with a round tool, along a ramp with a flat one."""
    linking = LinkOptions(
        safe_z_mm=space.safe_z_mm,
        clearance_mm=space.clearance_mm,
        feed_mm_min=feeds.cut,
        plunge_mm_min=feeds.plunge,
        link_mm_min=feeds.link,
        stay_down_mm=stay_down_mm,
        low_links=True,
        entry="plunge" if tool.corner_radius_mm >= 0.5 * tool.nominal_radius_mm else "ramp",
    )
    moves = link(passes, linking, planner) if passes else ()
    return fit_path(ToolPath(moves=moves, tool=tool, name="semi-finishing"), FIT)


def semi_finishing(
    space: Workspace,
    tool: ToolShape,
    options: SemiOptions,
    dynamics: Dynamics,
    levels: Sequence[LevelCuts],
    maps: Sequence[ClearGrid],
    before: Dexels,
) -> ToolPath:
    """A path through the rest material.

    Args:
        levels: from `remaining_cuts`.
        maps: from `clear_maps`, the same for every order of the cuts.
        before: the stock as the stage finds it.
    """
    passes = list(ordered_passes(levels, maps, space, options, dynamics))
    return linked(passes, space, tool, options.feeds, StockLinkPlanner(levels, space.top_mm, before, tool), math.inf)
