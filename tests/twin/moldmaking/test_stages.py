"""The stages of a small mold: nothing gouged, everything reached, times in order, programs that other readers take."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from twin.arrays import FloatArray
from twin.cam.passes.level_free_areas import level_free_areas
from twin.cam.passes.pockets import subdivided
from twin.cam.passes.roughing import LevelLinkPlanner, contour_roughing, roughing_levels
from twin.cam.path.machining_time import machining_time
from twin.cam.path.toolpath import MoveKind, ToolPath
from twin.cam.stock.dexel import Dexels
from twin.cam.stock.rest import grown, stock_heights
from twin.cam.stock.strokes import Strokes
from twin.cam.surface.drop_cutter import DropCutter
from twin.moldmaking import STAGES, MoldPlan
from twin.moldmaking.figures import rest_table, saved, times_table

#: Chords of arcs when paths are checked, mm.
FINE = 1e-5


def tips(path: ToolPath, *kinds: MoveKind) -> FloatArray:
    moves = path.of_kind(*kinds) if kinds else path.moves
    return np.concatenate([subdivided(m.chords_mm(FINE), 0.1) for m in moves])


def inside_mm(plan: MoldPlan, path: ToolPath, smaller_mm: float) -> float:
    """How far a tool that is thinner all around by so much would be in the part at most; negative where it is free."""
    thin = replace(path.tool, corner_radius_mm=path.tool.corner_radius_mm - smaller_mm, height_mm=path.tool.height_mm)
    at = tips(path)
    lowest = DropCutter(plan.surface, thin).drop(np.ascontiguousarray(at[:, :2])) - smaller_mm
    return float((lowest - at[:, 2]).max())


@pytest.mark.parametrize("stage", ["rough", "semi"])
def test_allowances_are_kept_in_all_directions(plan: MoldPlan, stage: str) -> None:
    path = plan.stage(stage).path  # type: ignore[arg-type]
    allowance = getattr(plan.job, stage).allowance_mm
    thick = grown(path.tool, allowance - 0.01)
    at = tips(path)
    lowest = DropCutter(plan.surface, thick).drop(np.ascontiguousarray(at[:, :2])) + allowance - 0.01
    assert float((lowest - at[:, 2]).max()) < 1e-6


def test_finishing_stays_within_the_chord_tolerance(plan: MoldPlan) -> None:
    # a tool thinner by the tolerance and a micrometre, all around, touches nothing
    assert inside_mm(plan, plan.finish.path, plan.job.finish.chord_mm + 0.001) < 1e-6


def test_raster_paths_keep_the_allowance(plan: MoldPlan) -> None:
    for path, allowance in ((plan.raster_baseline.rough, 0.3), (plan.raster_baseline.semi, 0.15)):
        at = tips(path)
        lowest = DropCutter(plan.surface, path.tool).drop(np.ascontiguousarray(at[:, :2])) + allowance
        assert float((lowest - at[:, 2]).max()) < 1e-6


def test_each_stage_leaves_less_and_finishing_leaves_scallops_and_fillets(plan: MoldPlan) -> None:
    rest = rest_table(plan)
    volumes = [rest[s].volume_mm3 for s in STAGES]
    assert volumes == sorted(volumes, reverse=True)
    # surface that the finishing tool can reach, with scallops and chords above it
    stock, tool = plan.finish.stock, plan.finish.path.tool
    points = stock.points_mm
    part = DropCutter(plan.surface, None).drop(points)
    reach = DropCutter(plan.surface, tool).drop(points)
    # the lowest height of the tool's underside at each dexel over all tool positions: closing on the dexel grid
    closed = Dexels(stock.low_mm, stock.high_mm, 0.2, 5.0, -12.0)
    stays = np.column_stack((points, reach))
    closed.cut(tool, Strokes(stays, stays, np.empty((0, 8))))
    # measured across the surface: rows of 0.5 mm leave 0.048 mm where it leans by 55 degrees, at a radius of 2 mm;
    # between a row and the foot of a wall next to it the distance may be twice as large
    slope = np.hypot(*np.gradient(closed.heights_mm, 0.2))
    over = (stock.heights_mm - closed.heights_mm) / np.hypot(1.0, slope)
    assert np.percentile(over, 98.0) < 0.055
    assert np.percentile(over, 50.0) < 0.02
    assert over.max() < 0.13
    assert float((stock.heights_mm.ravel() - part).min()) > -0.06


def test_times_come_out_in_order(plan: MoldPlan) -> None:
    lines = {line.name: line for line in times_table(plan)}
    assert list(lines) == ["greedy", "2-opt", "ils", "raster baseline"]
    assert lines["ils"].semi_s <= lines["2-opt"].semi_s <= lines["greedy"].semi_s < lines["raster baseline"].semi_s
    part = saved(list(lines.values()))
    assert part is not None
    assert part == pytest.approx(1.0 - lines["ils"].total_s / lines["raster baseline"].total_s)


def test_roughing_enters_by_helix_or_ramp_and_plunges_through_air_only(plan: MoldPlan) -> None:
    path = plan.rough.path
    kinds = path.lengths_mm()
    assert kinds[MoveKind.HELIX] > 0.0
    top = plan.space.top_mm
    cleared: list[float] = []
    for move in path.moves:
        if move.kind is MoveKind.PLUNGE and move.end_mm[2] < top - 1e-9:
            cleared.append(float(move.end_mm[2]))
            assert move.feed_mm_min == plan.job.rough.feeds.ramp
    # a straight way down into material would be a pass with material above it: those are helices and ramps
    steepest = max(
        math.degrees(
            math.atan2(abs(m.end_mm[2] - m.start_mm[2]), math.sqrt(m.length_mm**2 - (m.end_mm[2] - m.start_mm[2]) ** 2))
        )
        for m in path.of_kind(MoveKind.HELIX)
    )
    assert steepest <= plan.job.rough.ramp_deg + 1e-6


def rapids_in_stock_mm(path: ToolPath, stock: Dexels) -> float:
    """How deep rapids go into the stock as it is when they are run; the stock is cut by the path."""
    deepest, cuts = 0.0, []
    for move in path.moves:
        if move.kind is not MoveKind.RAPID:
            cuts.append(move)
            continue
        if cuts:
            stock.cut(path.tool, Strokes.of_path(replace(path, moves=tuple(cuts))), threads=1)
            cuts = []
        at = subdivided(move.points_mm, 0.2)
        heights = stock_heights(stock, path.tool, np.ascontiguousarray(at[:, :2]), threads=1)
        deepest = max(deepest, float((heights - at[:, 2]).max()))
    return deepest


def test_rapids_touch_no_stock(plan: MoldPlan) -> None:
    before = plan.fresh_stock()
    for stage in STAGES:
        path = plan.stage(stage).path
        assert rapids_in_stock_mm(path, before.copy()) < 1e-6, stage
        before = plan.stage(stage).stock
    before = plan.fresh_stock()
    for path in (plan.raster_baseline.rough, plan.raster_baseline.semi):
        assert rapids_in_stock_mm(path, before) < 1e-6


def test_links_stay_in_the_free_area_of_their_level(plan: MoldPlan) -> None:
    tool, options = plan.rough.path.tool, plan.roughing_options
    levels = roughing_levels(plan.space, options)
    free_areas = level_free_areas(
        plan.part, tool, levels, options.allowance_mm, plan.space.window(tool.max_radius_mm + options.allowance_mm)
    )
    planner = LevelLinkPlanner(levels, free_areas, plan.space.top_mm)
    links = list(plan.rough.path.of_kind(MoveKind.LINK))
    assert links
    assert all(planner.free(m.points_mm) for m in links)


def test_equal_jobs_give_equal_paths(plan: MoldPlan) -> None:
    again = contour_roughing(plan.space, plan.rough.path.tool, plan.roughing_options, plan.cutter(plan.job.rough).drop)
    assert len(again.moves) == len(plan.rough.path.moves)
    assert all(
        np.array_equal(a.points_mm, b.points_mm) for a, b in zip(again.moves, plan.rough.path.moves, strict=True)
    )


def test_stage_times_are_those_of_their_paths(plan: MoldPlan) -> None:
    for stage in STAGES:
        result = plan.stage(stage)
        assert result.time.total_s == machining_time(result.path, plan.job.machine.dynamics).total_s
        assert result.time.total_s > result.path.duration_s(plan.job.machine.rapid_mm_min)


def test_nothing_warns_on_a_sound_job(plan: MoldPlan) -> None:
    assert plan.warnings() == []
