"""The stages of a mold, one after the other, each from the stock that the previous one leaves."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import Literal, TypeAlias

import numpy as np

from twin.arrays import FloatArray
from twin.cam.passes.clear_moves import ClearOptions, Obstacle, part_obstacle, with_clear_moves
from twin.cam.passes.finishing import FinishingOptions, finishing, stepover_for_scallop
from twin.cam.passes.raster_baseline import row_cuts, scanned
from twin.cam.passes.roughing import RoughingOptions, Workspace, contour_roughing
from twin.cam.passes.semi_finishing import SemiOptions, clear_maps, remaining_cuts, semi_finishing
from twin.cam.path.machining_time import PathTime, machining_time
from twin.cam.path.toolpath import ToolPath
from twin.cam.path.tour import METHODS, Search
from twin.cam.stock.dexel import Dexels
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import surface_of_mesh
from twin.moldmaking import checks
from twin.moldmaking.load import shape_of
from twin.moldmaking.model import LevelStage, MoldJob, StageTable
from twin.planning.paths import Progress, silent
from twin.tools.shape import ToolShape
from twin.workpiece.solids.from_mesh import Solid, load_mesh
from twin.workpiece.solids.units import TOOL_DIAMETERS, size_doubts

Stage: TypeAlias = Literal["rough", "semi", "finish"]
STAGES: tuple[Stage, ...] = ("rough", "semi", "finish")

#: Shares of the whole work, for the progress display only.
_SHARES: Mapping[str, tuple[float, float]] = {
    "part": (0.0, 0.1),
    "rough": (0.1, 0.3),
    "semi": (0.3, 0.5),
    "finish": (0.5, 0.75),
    "raster baseline": (0.75, 1.0),
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StageResult:
    """One stage.

    Attributes:
        stage: its name.
        path: the tool path of its program.
        time: machining time of the path.
        stock: the stock afterwards; not to be changed.
        computed_s: computing time.
        by_method: machining times by search method, `twin.cam.path.tour.METHODS`; semi-finishing only.
    """

    stage: Stage
    path: ToolPath
    time: PathTime
    stock: Dexels
    computed_s: float
    by_method: Mapping[str, PathTime]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RasterBaseline:
    """Raster roughing and raster semi-finishing, which the contours are compared with.

    Attributes:
        rough, semi: the paths.
        rough_time, semi_time: their machining times.
        stock: the stock afterwards.
    """

    rough: ToolPath
    semi: ToolPath
    rough_time: PathTime
    semi_time: PathTime
    stock: Dexels


class MoldPlan:
    """The stages of a mold job; each is computed once, when it is first needed.

    Args:
        job: the checked job.
        progress: called with the current task and the share of the work that is done, 0 to 1.

    Raises:
        MeshError: the part is not a closed solid.
        StockError: the stock does not contain the part.
    """

    def __init__(self, job: MoldJob, progress: Progress = silent) -> None:
        self.job = job
        self._progress = progress
        progress("reading the part", 0.0)
        begin = time.perf_counter()
        self.part = self._part()
        self.surface = surface_of_mesh(self.part.vertices_mm, self.part.triangles)
        self.space = self._workspace()
        self.read_s = time.perf_counter() - begin
        self._cutters: dict[int, DropCutter] = {}
        self._obstacles: dict[tuple[int, float], Obstacle] = {}

    def _part(self) -> Solid:
        """The part; a unit that is not known is the one in which it is most like the stock, or a typical part."""
        part, box = self.job.part, self.job.stock.box_mm
        like = TOOL_DIAMETERS * max(tool.diameter_mm for tool in self.job.tools)
        if box is not None:
            like = float(np.ptp(np.array([box.min, box.max]), axis=0).max())
        return load_mesh(part.stl, unit=part.unit, scale=part.scale, offset_mm=part.offset_mm, like_mm=like)

    def _workspace(self) -> Workspace:
        box = self.job.stock.box_mm
        low: FloatArray = self.part.vertices_mm.min(axis=0)
        high: FloatArray = self.part.vertices_mm.max(axis=0) + np.array([0.0, 0.0, self.job.stock.top_mm])
        if box is not None:
            low, high = np.array(box.min), np.array(box.max)
        checks.check_stock(self.part, low, high)
        machine = self.job.machine
        return Workspace(
            part=self.part,
            low_mm=low,
            high_mm=high,
            safe_z_mm=float(high[2]) + machine.safe_mm,
            clearance_mm=min(machine.clearance_mm, machine.safe_mm),
        )

    def shape(self, stage: StageTable) -> ToolShape:
        """Shape of the cutting part of a stage's tool."""
        return shape_of(self.job, stage.tool)

    def cutter(self, stage: StageTable) -> DropCutter:
        """The drop-cutter of a stage's tool on the part."""
        if stage.tool not in self._cutters:
            self._cutters[stage.tool] = DropCutter(self.surface, self.shape(stage))
        return self._cutters[stage.tool]

    def stage(self, name: Stage) -> StageResult:
        """One stage; the stages before it are computed first."""
        results: dict[Stage, StageResult] = {"rough": self.rough}
        if name != "rough":
            results["semi"] = self.semi
        if name == "finish":
            results["finish"] = self.finish
        return results[name]

    def fresh_stock(self) -> Dexels:
        """The uncut stock as dexels."""
        low, high = self.space.low_mm, self.space.high_mm
        return Dexels(low[:2], high[:2], self.job.output.dexel_mm, float(high[2]), float(low[2]))

    @property
    def roughing_options(self) -> RoughingOptions:
        """Options of contour roughing, and of the raster baseline."""
        table = self.job.rough
        return RoughingOptions(
            axial_depth_mm=table.axial_depth_mm,
            radial_depth_mm=table.radial_depth_mm,
            allowance_mm=table.allowance_mm,
            resolution_mm=table.resolution_mm,
            ramp_deg=table.ramp_deg,
            feeds=table.feeds,
        )

    @property
    def semi_options(self) -> SemiOptions:
        """Options of semi-finishing."""
        table = self.job.semi
        return SemiOptions(
            axial_depth_mm=table.axial_depth_mm,
            radial_depth_mm=table.radial_depth_mm,
            allowance_mm=table.allowance_mm,
            least_mm=table.least_mm,
            resolution_mm=table.resolution_mm,
            direction=table.direction,
            search=Search(method=table.method, seed=table.seed, iterations=table.iterations, budget_s=table.budget_s),
            feeds=table.feeds,
        )

    @cached_property
    def finishing_options(self) -> FinishingOptions:
        """Options of finishing; the stepover follows from the scallop height where that is given."""
        table = self.job.finish
        stepover = table.stepover_mm
        if stepover is None:
            assert table.scallop_mm is not None
            stepover = stepover_for_scallop(self.cutter(table), table.scallop_mm)
        return FinishingOptions(
            stepover_mm=stepover,
            chord_mm=table.chord_mm,
            pitch_mm=table.pitch_mm,
            direction=table.direction,
            steep_deg=table.steep_deg,
            least_mm=table.least_mm,
            feeds=table.feeds,
        )

    @cached_property
    def rough(self) -> StageResult:
        """Contour roughing."""
        self._at("rough", "roughing", 0.0)
        begin, table = time.perf_counter(), self.job.rough
        tool = self.shape(table)
        path = contour_roughing(self.space, tool, self.roughing_options, self.cutter(table).drop)
        stock = self.fresh_stock()
        return self._result("rough", self._cleared(table, path, stock), stock, begin)

    @cached_property
    def semi(self) -> StageResult:
        """Semi-finishing of the rest material after roughing, in the best order that the job's method finds."""
        before, table = self.rough.stock, self.job.semi
        self._at("semi", "finding rest material", 0.0)
        begin, tool, dynamics = time.perf_counter(), self.shape(table), self.job.machine.dynamics
        options, stock = self.semi_options, before.copy()
        levels = remaining_cuts(
            self.space, tool, options, stock, lambda k, n: self._at("semi", "finding rest material", 0.7 * k / n)
        )
        maps = clear_maps(levels, self.space)
        best: tuple[ToolPath, PathTime, Dexels] | None = None
        times: dict[str, PathTime] = {}
        for method in METHODS[: METHODS.index(table.method) + 1]:
            self._at("semi", f"ordering, {method}", 0.7 + 0.1 * METHODS.index(method))
            search = replace(options.search, method=method)
            path = semi_finishing(self.space, tool, replace(options, search=search), dynamics, levels, maps, before)
            after = before.copy()
            path = self._cleared(table, path, after)
            spent = machining_time(path, dynamics)
            # the search's times ignore corners; a path that takes longer on the machine is not used
            if best is None or spent.total_s < best[1].total_s:
                best = path, spent, after
            times[method] = best[1]
        assert best is not None
        return self._result("semi", best[0], best[2], begin, times, best[1])

    @cached_property
    def finish(self) -> StageResult:
        """Finishing of the rest material after semi-finishing."""
        before = self.semi.stock
        self._at("finish", "finishing", 0.0)
        begin = time.perf_counter()
        cutter = self.cutter(self.job.finish)
        path = finishing(self.space, cutter, self.finishing_options, before, self.job.machine.dynamics)
        stock = before.copy()
        return self._result("finish", self._cleared(self.job.finish, path, stock), stock, begin)

    @cached_property
    def raster_baseline(self) -> RasterBaseline:
        """Raster roughing and semi-finishing under the same conditions."""
        dynamics, table = self.job.machine.dynamics, self.job.rough
        stock, before = self.fresh_stock(), self.fresh_stock()
        rough_tool, semi_tool, semi = self.shape(table), self.shape(self.job.semi), self.semi_options
        cuts = row_cuts(
            self.space,
            rough_tool,
            self.roughing_options,
            stock,
            semi.least_mm,
            lambda k, n: self._at("raster baseline", "raster roughing", 0.4 * k / n),
        )
        rough = scanned(self.space, rough_tool, self.roughing_options, cuts, before, one_way=True)
        before = stock.copy()
        options = replace(semi.levels, resolution_mm=semi.resolution_mm)
        cuts = row_cuts(
            self.space,
            semi_tool,
            options,
            stock,
            semi.least_mm,
            lambda k, n: self._at("raster baseline", "raster semi-finishing", 0.4 + 0.4 * k / n),
        )
        path = scanned(self.space, semi_tool, options, cuts, before, one_way=semi.direction == "climb")
        return RasterBaseline(
            rough=rough,
            semi=path,
            rough_time=machining_time(rough, dynamics),
            semi_time=machining_time(path, dynamics),
            stock=stock,
        )

    def _at(self, stage: str, task: str, share: float) -> None:
        low, high = _SHARES[stage]
        self._progress(task, low + share * (high - low))

    def _cleared(self, table: StageTable, path: ToolPath, stock: Dexels) -> ToolPath:
        """A stage's path with rapids and links clear of part and stock; the stock is cut by it."""
        allowance = table.allowance_mm if isinstance(table, LevelStage) else 0.0
        key = (table.tool, allowance)
        if key not in self._obstacles:
            exact = self.cutter(table) if allowance == 0.0 else None
            self._obstacles[key] = part_obstacle(self.surface, self.shape(table), allowance, exact)
        clear = ClearOptions(
            safe_z_mm=self.space.safe_z_mm, clearance_mm=self.space.clearance_mm, feed_mm_min=table.feeds.link
        )
        return with_clear_moves(path, clear, self._obstacles[key], stock)

    def _result(
        self,
        stage: Stage,
        path: ToolPath,
        stock: Dexels,
        begin: float,
        by_method: Mapping[str, PathTime] = MappingProxyType({}),
        spent: PathTime | None = None,
    ) -> StageResult:
        """A finished stage, with its machining time where that is known already."""
        return StageResult(
            stage=stage,
            path=path,
            time=spent or machining_time(path, self.job.machine.dynamics),
            stock=stock,
            computed_s=time.perf_counter() - begin,
            by_method=by_method,
        )

    def warnings(self, stages: tuple[Stage, ...] = STAGES) -> list[str]:
        """Warnings: doubts about the unit, undercuts, contact of shank or holder, depths beyond the flute length."""
        smallest = min(self.job.tool_of(getattr(self.job, name)).diameter_mm for name in stages)
        found = [*self.part.notes, *size_doubts(self.part.name, self.part.box_mm, tool_mm=smallest)]
        found += checks.undercut_warnings(self.part)
        for name in stages:
            table = getattr(self.job, name)
            tool = self.job.tool_of(table)
            if name != "finish":
                found += checks.flute_warnings(name, table.axial_depth_mm, tool)
            found += checks.reach_warnings(name, self.stage(name).path, tool, self.surface)
        return found
