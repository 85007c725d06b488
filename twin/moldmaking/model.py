"""The keys of a mold job, one model a table; tools are those of a replay's job file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, Strict

from twin.cam.passes.roughing import StageFeeds
from twin.cam.path.machining_time import Dynamics
from twin.job.model import Box, FilePath, Point, Table, Tool


class Part(Table):
    """The part to be made."""

    stl: FilePath = Field(description="STL file of a closed solid, relative to the job file's folder")
    scale: float = Field(default=1.0, gt=0.0, description="mm a unit of the STL file, 25.4 for inches")
    offset_mm: Point = Field(default=(0.0, 0.0, 0.0), description="added to the STL file's points after scaling, mm")


class MoldStock(Table):
    """The block that the part is made from."""

    box_mm: Box | None = Field(default=None, description="the block; the part's own box if not given")
    top_mm: float = Field(default=0.0, ge=0.0, description="material on top of the part's box where no block is given")


class MoldMachine(Table):
    """The machine."""

    dialect: Literal["fanuc", "haas", "linuxcnc", "grbl"] = Field(
        default="fanuc", description="control that programs are written for"
    )
    rapid_mm_min: float = Field(default=30_000.0, gt=0.0, description="speed along the path of rapid motions, mm/min")
    acceleration_mm_s2: float = Field(default=3_000.0, gt=0.0, description="acceleration in cuts, mm/s2")
    rapid_mm_s2: float = Field(default=5_000.0, gt=0.0, description="acceleration of rapid motions, mm/s2")
    corner_mm: float = Field(default=0.01, gt=0.0, description="how far corners may be rounded off, mm")
    safe_mm: float = Field(default=10.0, gt=0.0, description="height of rapid motions above the stock")
    clearance_mm: float = Field(default=1.0, gt=0.0, description="height above material where rapids down end")
    tool_change_s: float = Field(default=4.0, ge=0.0, description="time of one tool change, s")

    @property
    def dynamics(self) -> Dynamics:
        """What machining times are computed with."""
        return Dynamics(
            rapid_mm_min=self.rapid_mm_min,
            acceleration_mm_s2=self.acceleration_mm_s2,
            rapid_mm_s2=self.rapid_mm_s2,
            corner_mm=self.corner_mm,
        )


class StageTable(Table):
    """What every stage has."""

    tool: int = Field(ge=1, description="number of the tool")
    spindle_rpm: float = Field(gt=0.0, description="spindle speed, rpm")
    feed_mm_min: float = Field(gt=0.0, description="feed of cuts, mm/min")
    plunge_mm_min: float = Field(gt=0.0, description="feed straight down, mm/min")
    ramp_mm_min: float | None = Field(default=None, gt=0.0, description="feed of helices and ramps; half the feed")
    link_mm_min: float | None = Field(default=None, gt=0.0, description="feed through cleared places; the feed of cuts")

    @property
    def feeds(self) -> StageFeeds:
        """Feeds as paths want them."""
        return StageFeeds(
            cut=self.feed_mm_min,
            plunge=self.plunge_mm_min,
            link=self.link_mm_min or self.feed_mm_min,
            ramp=self.ramp_mm_min or 0.5 * self.feed_mm_min,
        )


class Rough(StageTable):
    """Contour roughing."""

    axial_depth_mm: float = Field(gt=0.0, description="distance of the levels")
    radial_depth_mm: float = Field(gt=0.0, description="distance of the rings, at most the tool's radius")
    allowance_mm: float = Field(ge=0.0, description="left on the part")
    resolution_mm: float = Field(default=0.5, gt=0.0, description="longest piece of a contour while it is worked on")
    ramp_deg: float = Field(default=3.0, gt=0.0, lt=45.0, description="steepest angle of helices and ramps")


class Semi(StageTable):
    """Semi-finishing of what roughing left."""

    axial_depth_mm: float = Field(gt=0.0, description="distance of the levels")
    radial_depth_mm: float = Field(gt=0.0, description="distance of the rings, at most the tool's radius")
    allowance_mm: float = Field(ge=0.0, description="left on the part")
    least_mm: float = Field(default=0.1, gt=0.0, description="thinner material is left to finishing")
    resolution_mm: float = Field(default=0.4, gt=0.0, description="distance of the places that are looked at")
    direction: Literal["both", "climb"] = Field(default="both", description="whether cuts may run either way")
    method: Literal["greedy", "2-opt", "ils"] = Field(default="ils", description="search for the order of cuts")
    seed: int = Field(default=1, ge=0, description="of the search; equal seeds give equal programs")
    iterations: int | None = Field(default=None, ge=0, description="of the search at each level; 5 a cut, at least 500")
    budget_s: float | None = Field(
        default=None, gt=0.0, description="longest search at each level, s; with it, programs depend on the machine"
    )


class Finish(StageTable):
    """Finishing by scanning lines."""

    stepover_mm: float | None = Field(default=None, gt=0.0, description="distance of the rows")
    scallop_mm: float | None = Field(default=None, gt=0.0, description="height of scallops on level ground, instead")
    chord_mm: float = Field(default=0.005, gt=0.0, description="how far the path may lie from the exact one")
    pitch_mm: float = Field(default=0.3, gt=0.0, description="distance of the places dropped first along a row")
    direction: Literal["x", "y"] = Field(default="x", description="direction of the rows")
    steep_deg: float | None = Field(
        default=None, gt=0.0, lt=90.0, description="surfaces steeper than this get level lines instead of rows"
    )
    least_mm: float = Field(default=0.01, gt=0.0, description="thinner material is no reason to go there")


class Compare(Table):
    """What the chain is compared with."""

    conventional: bool = Field(default=True, description="whether scanning lines throughout are computed as well")


class MoldOutput(Table):
    """Where programs go."""

    folder: FilePath = Field(default=Path("programs"), description="folder of programs, relative to the job file's")
    name: str = Field(default="mold", pattern=r"^[A-Za-z0-9_\-]+$", description="first word of their names")
    dexel_mm: float = Field(default=0.2, gt=0.0, description="distance of the dexels of the stock between stages")


class MoldFile(Table):
    """A mold: part, stock, tools, and what each stage does."""

    part: Part = Field(description="the part")
    stock: MoldStock = Field(default_factory=MoldStock, description="the block")
    machine: MoldMachine = Field(default_factory=MoldMachine, description="the machine")
    tools: Annotated[tuple[Tool, ...], Strict(False)] = Field(
        description="the tools, each under [[tools]], at least one", json_schema_extra={"minItems": 1}
    )
    rough: Rough = Field(description="roughing")
    semi: Semi = Field(description="semi-finishing")
    finish: Finish = Field(description="finishing")
    compare: Compare = Field(default_factory=Compare, description="what the chain is compared with")
    output: MoldOutput = Field(default_factory=MoldOutput, description="where programs go")


class MoldJob(MoldFile):
    """A checked mold job; make it with `load_mold` or `mold_from_dict`. Its files' paths are joined to its folder.

    Attributes:
        path: the job file.
    """

    path: Path

    def tool_of(self, stage: StageTable) -> Tool:
        """The tool of a stage."""
        return next(t for t in self.tools if t.number == stage.tool)
