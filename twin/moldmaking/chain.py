"""The stages of a mold, one after the other, each from the stock that the one before leaves."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, TypeAlias

import numpy as np

from twin.arrays import FloatArray
from twin.cam.passes.finishing import FinishingOptions, finishing, stepover_for_scallop
from twin.cam.passes.raster_baseline import row_cuts, scanned
from twin.cam.passes.roughing import RoughingOptions, Workspace, contour_roughing
from twin.cam.passes.semi_finishing import SemiOptions, remaining_cuts, semi_finishing
from twin.cam.path.machining_time import PathTime, machining_time
from twin.cam.path.toolpath import ToolPath
from twin.cam.path.tour import METHODS, Search
from twin.cam.stock.dexel import Dexels
from twin.cam.stock.strokes import Strokes
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import surface_of_mesh
from twin.moldmaking import checks
from twin.moldmaking.load import shape_of
from twin.moldmaking.model import MoldJob, StageTable
from twin.tools.shape import ToolShape
from twin.workpiece.from_mesh import load_mesh

Stage: TypeAlias = Literal["rough", "semi", "finish"]
STAGES: tuple[Stage, ...] = ("rough", "semi", "finish")
#: Told what is being done, and how much of all the work is done, 0 to 1.
Report: TypeAlias = Callable[[str, float], None]

#: Parts of the work, for the progress alone.
_SHARES: Mapping[str, tuple[float, float]] = {
    "part": (0.0, 0.1),
    "rough": (0.1, 0.3),
    "semi": (0.3, 0.5),
    "finish": (0.5, 0.75),
    "conventional": (0.75, 1.0),
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StageResult:
    """One stage.

    Attributes:
        stage: which.
        path: what its program does.
        time: of the path.
        stock: as it is left, not to be changed.
        computed_s: time that the computation took.
        by_method: paths of the other orders, by `twin.cam.path.tour.METHODS`; semi-finishing only.
    """

    stage: Stage
    path: ToolPath
    time: PathTime
    stock: Dexels
    computed_s: float
    by_method: Mapping[str, PathTime]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Conventional:
    """Scanning lines in roughing and semi-finishing.

    Attributes:
        rough, semi: the paths.
        rough_time, semi_time: their times.
        stock: as they leave it.
    """

    rough: ToolPath
    semi: ToolPath
    rough_time: PathTime
    semi_time: PathTime
    stock: Dexels


def _quiet(what: str, part: float) -> None:
    """Says nothing."""


class MoldChain:
    """A mold job at work; every stage is computed once, when it is asked for.

    Args:
        job: what to do.
        report: told of the progress.

    Raises:
        MeshError: the part is no solid.
        StockError: the stock does not hold the part.
    """

    def __init__(self, job: MoldJob, report: Report = _quiet) -> None:
        self.job = job
        self._report = report
        report("reading the part", 0.0)
        begin = time.perf_counter()
        self.part = load_mesh(job.part.stl, scale=job.part.scale, offset_mm=job.part.offset_mm)
        self.surface = surface_of_mesh(self.part.vertices_mm, self.part.triangles)
        self.space = self._workspace()
        self.read_s = time.perf_counter() - begin
        self._cutters: dict[int, DropCutter] = {}

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
        """The cutting part of a stage's tool."""
        return shape_of(self.job, stage.tool)

    def cutter(self, stage: StageTable) -> DropCutter:
        """A stage's tool over the part."""
        if stage.tool not in self._cutters:
            self._cutters[stage.tool] = DropCutter(self.surface, self.shape(stage))
        return self._cutters[stage.tool]

    def stage(self, name: Stage) -> StageResult:
        """One stage, those before it made first."""
        results: dict[Stage, StageResult] = {"rough": self.rough}
        if name != "rough":
            results["semi"] = self.semi
        if name == "finish":
            results["finish"] = self.finish
        return results[name]

    def fresh_stock(self) -> Dexels:
        """The block as dexels."""
        low, high = self.space.low_mm, self.space.high_mm
        return Dexels(low[:2], high[:2], self.job.output.dexel_mm, float(high[2]), float(low[2]))

    @property
    def roughing_options(self) -> RoughingOptions:
        """Of contours and of scanning rows."""
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
        """Of semi-finishing."""
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
        """Of finishing."""
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
        self._say("rough", "roughing", 0.0)
        begin, table = time.perf_counter(), self.job.rough
        tool = self.shape(table)
        path = contour_roughing(self.space, tool, self.roughing_options, self.cutter(table).drop)
        return self._result("rough", path, self.fresh_stock(), tool, begin, {})

    @cached_property
    def semi(self) -> StageResult:
        """Semi-finishing of what roughing leaves, in the best order that the job's method finds."""
        before, table = self.rough.stock, self.job.semi
        self._say("semi", "finding what is left", 0.0)
        begin, tool, dynamics = time.perf_counter(), self.shape(table), self.job.machine.dynamics
        options, stock = self.semi_options, before.copy()
        levels = remaining_cuts(
            self.space, tool, options, stock, lambda k, n: self._say("semi", "finding what is left", 0.7 * k / n)
        )
        best: tuple[ToolPath, PathTime] | None = None
        times: dict[str, PathTime] = {}
        for method in METHODS[: METHODS.index(table.method) + 1]:
            self._say("semi", f"ordering, {method}", 0.7 + 0.1 * METHODS.index(method))
            search = replace(options.search, method=method)
            path = semi_finishing(self.space, tool, replace(options, search=search), dynamics, levels, before)
            spent = machining_time(path, dynamics)
            # the search's clock knows no corners; a longer path by the machine's clock is not taken
            if best is None or spent.total_s < best[1].total_s:
                best = path, spent
            times[method] = best[1]
        assert best is not None
        return self._result("semi", best[0], before.copy(), tool, begin, times)

    @cached_property
    def finish(self) -> StageResult:
        """Finishing of what semi-finishing leaves."""
        before = self.semi.stock
        self._say("finish", "finishing", 0.0)
        begin = time.perf_counter()
        cutter = self.cutter(self.job.finish)
        path = finishing(self.space, cutter, self.finishing_options, before, self.job.machine.dynamics)
        return self._result("finish", path, before.copy(), self.shape(self.job.finish), begin, {})

    @cached_property
    def conventional(self) -> Conventional:
        """Scanning lines in roughing and semi-finishing, under the same conditions."""
        dynamics, table = self.job.machine.dynamics, self.job.rough
        stock, before = self.fresh_stock(), self.fresh_stock()
        rough_tool, semi_tool, semi = self.shape(table), self.shape(self.job.semi), self.semi_options
        cuts = row_cuts(
            self.space,
            rough_tool,
            self.roughing_options,
            stock,
            semi.least_mm,
            lambda k, n: self._say("conventional", "scanning lines, roughing", 0.4 * k / n),
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
            lambda k, n: self._say("conventional", "scanning lines, semi-finishing", 0.4 + 0.4 * k / n),
        )
        path = scanned(self.space, semi_tool, options, cuts, before, one_way=semi.direction == "climb")
        return Conventional(
            rough=rough,
            semi=path,
            rough_time=machining_time(rough, dynamics),
            semi_time=machining_time(path, dynamics),
            stock=stock,
        )

    def _say(self, share: str, what: str, part: float) -> None:
        low, high = _SHARES[share]
        self._report(what, low + part * (high - low))

    def _result(
        self,
        stage: Stage,
        path: ToolPath,
        stock: Dexels,
        tool: ToolShape,
        begin: float,
        by_method: Mapping[str, PathTime],
    ) -> StageResult:
        """A finished stage; the stock is lowered by its path."""
        stock.cut(tool, Strokes.of_path(path))
        return StageResult(
            stage=stage,
            path=path,
            time=machining_time(path, self.job.machine.dynamics),
            stock=stock,
            computed_s=time.perf_counter() - begin,
            by_method=by_method,
        )

    def warnings(self, stages: tuple[Stage, ...] = STAGES) -> list[str]:
        """What needs attention: undercuts, shank and holder that touch the part, depths beyond the flutes."""
        found = list(checks.undercut_warnings(self.part))
        for name in stages:
            table = getattr(self.job, name)
            tool = self.job.tool_of(table)
            if name != "finish":
                found += checks.flute_warnings(name, table.axial_depth_mm, tool)
            found += checks.reach_warnings(name, self.stage(name).path, tool, self.surface)
        return found
