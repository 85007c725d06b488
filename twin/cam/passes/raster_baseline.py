"""The raster baseline: scanning rows throughout, without air cuts (the mold paper, section 3).

Every level is covered by rows along x. Neighbouring rows are joined on the level where nothing is in
between; else the tool retracts and plunges.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from twin.cam.passes.level_free_areas import level_free_areas
from twin.cam.passes.levels import CutOptions, cuts_of, row_layers
from twin.cam.passes.roughing import FIT, RoughingOptions, Workspace, roughing_levels
from twin.cam.passes.semi_finishing import LevelCuts, Report, StockLinkPlanner
from twin.cam.path.arc_fit import fit_path
from twin.cam.path.linking import LinkOptions, Pass, link
from twin.cam.path.toolpath import ToolPath
from twin.cam.stock.dexel import Dexels
from twin.tools.shape import ToolShape

#: A link to the next row may be longer than their distance by this factor.
_STAY = 2.5


def row_cuts(
    space: Workspace,
    tool: ToolShape,
    options: RoughingOptions,
    stock: Dexels,
    least_mm: float,
    report: Report | None = None,
) -> list[LevelCuts]:
    """The parts of the levels' rows that cut, from the top; the stock is lowered by them."""
    levels = roughing_levels(space, options)
    free_areas = level_free_areas(space.part, tool, levels, options.allowance_mm, space.window(tool.max_radius_mm))
    cutting = CutOptions(
        least_mm=least_mm, resolution_mm=options.resolution_mm, bridge_mm=2.0 * options.radial_depth_mm
    )
    found: list[LevelCuts] = []
    for number, (z, free_area) in enumerate(zip(levels, free_areas, strict=True)):
        cuts = tuple(cuts_of(row_layers(free_area, options.radial_depth_mm), z, tool, stock, cutting))
        if cuts:
            found.append(LevelCuts(z, free_area, cuts))
        if report is not None:
            report(number + 1, len(levels))
    return found


def row_passes(levels: Sequence[LevelCuts], *, one_way: bool) -> Iterator[Pass]:
    """Level by level, row by row; every second row in the other direction, unless all run in one.

    Rows follow each other towards +y, so the material is on the left of a row towards +x: the one direction is -x,
    which is climb milling.
    """
    for number, one in enumerate(levels):
        rows: dict[int, list[Pass]] = {}
        for cut in one.cuts:
            reversed_row = one_way or cut.row % 2 == 1
            points = cut.points_mm[::-1] if reversed_row else cut.points_mm
            top = cut.top_mm[1 if reversed_row else 0]
            rows.setdefault(cut.row, []).append(
                Pass(points_mm=points, top_mm=top if top > one.z_mm else None, layer=number)
            )
        for row in sorted(rows):
            yield from reversed(rows[row]) if one_way or row % 2 == 1 else rows[row]


def scanned(
    space: Workspace,
    tool: ToolShape,
    options: RoughingOptions,
    levels: Sequence[LevelCuts],
    before: Dexels,
    *,
    one_way: bool,
) -> ToolPath:
    """A path through rows.

    Args:
        levels: from `row_cuts`.
        before: the stock as the stage finds it.
        one_way: whether all rows run in one direction, for climb milling.
    """
    linking = LinkOptions(
        safe_z_mm=space.safe_z_mm,
        clearance_mm=space.clearance_mm,
        feed_mm_min=options.feeds.cut,
        plunge_mm_min=options.feeds.plunge,
        link_mm_min=options.feeds.link,
        stay_down_mm=_STAY * options.radial_depth_mm,
        low_links=True,
        entry="plunge",
    )
    passes = list(row_passes(levels, one_way=one_way))
    moves = link(passes, linking, StockLinkPlanner(levels, space.top_mm, before, tool)) if passes else ()
    return fit_path(ToolPath(moves=moves, tool=tool, name="scanning rows"), FIT)
