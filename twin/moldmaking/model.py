"""The keys of a mold job, one model per table; tools are those of a replay's job file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, Strict, model_validator

from twin.cam.passes.roughing import StageFeeds
from twin.cam.path.machining_time import Dynamics
from twin.job.job_file import Tool
from twin.job.stock_keys import Box
from twin.settings.table import FilePath, Key, Point, Table
from twin.workpiece.solids.units import Unit


class Part(Table):
    """The part to be made."""

    stl: FilePath = Field(description="STL file of a closed solid, relative to the job file's folder")
    unit: Unit = Field(default="mm", description="unit of the STL file; auto: the one in which its size is plausible")
    scale: float = Field(default=1.0, gt=0.0, description="further factor on the STL file's points")
    offset_mm: Point = Field(default=(0.0, 0.0, 0.0), description="added to the STL file's points after scaling, mm")


class MoldStock(Table):
    """The stock that the part is made from."""

    box_mm: Annotated[Box | None, Key(unset="the part's box")] = Field(default=None, description="the stock's box")
    top_mm: float = Field(default=0.0, ge=0.0, description="stock above the part's box, if box_mm is not given")


class MoldMachine(Table):
    """The machine."""

    dialect: Literal["fanuc", "haas", "linuxcnc", "grbl"] = Field(
        default="fanuc", description="control that the programs are written for"
    )
    rapid_mm_min: float = Field(default=30_000.0, gt=0.0, description="rapid traverse rate along the path, mm/min")
    acceleration_mm_s2: float = Field(default=3_000.0, gt=0.0, description="acceleration at feed, mm/s2")
    rapid_mm_s2: float = Field(default=5_000.0, gt=0.0, description="acceleration at rapid traverse, mm/s2")
    corner_mm: float = Field(default=0.01, gt=0.0, description="corner blending tolerance, mm")
    safe_mm: float = Field(default=10.0, gt=0.0, description="height of rapids above the stock")
    clearance_mm: float = Field(
        default=1.0,
        gt=0.0,
        description="height above the material at which a rapid down ends and the plunge feed begins",
    )
    tool_change_s: float = Field(default=4.0, ge=0.0, description="time of one tool change, s")

    @property
    def dynamics(self) -> Dynamics:
        """Dynamics that machining times are computed with."""
        return Dynamics(
            rapid_mm_min=self.rapid_mm_min,
            acceleration_mm_s2=self.acceleration_mm_s2,
            rapid_mm_s2=self.rapid_mm_s2,
            corner_tolerance_mm=self.corner_mm,
        )


class StageTable(Table):
    """Keys of every stage."""

    tool: int = Field(ge=1, description="number of the tool")
    spindle_rpm: float = Field(gt=0.0, description="spindle speed, rpm")
    feed_mm_min: float = Field(gt=0.0, description="cutting feed, mm/min")
    plunge_mm_min: float = Field(gt=0.0, description="plunge feed, mm/min")
    ramp_mm_min: Annotated[float | None, Key(unset="half the cutting feed")] = Field(
        default=None, gt=0.0, description="feed of helices and ramps"
    )
    link_mm_min: Annotated[float | None, Key(unset="the cutting feed")] = Field(
        default=None, gt=0.0, description="feed of links in cleared areas"
    )

    @property
    def feeds(self) -> StageFeeds:
        """Feeds of the stage's moves."""
        return StageFeeds(
            cut=self.feed_mm_min,
            plunge=self.plunge_mm_min,
            link=self.link_mm_min or self.feed_mm_min,
            ramp=self.ramp_mm_min or 0.5 * self.feed_mm_min,
        )


class LevelStage(StageTable):
    """Keys of the stages that cut level by level."""

    axial_depth_mm: float = Field(gt=0.0, description="axial depth of cut: distance between levels")
    radial_depth_mm: float = Field(
        gt=0.0, description="radial depth of cut: distance between rings, at most the tool radius"
    )
    allowance_mm: float = Field(ge=0.0, description="allowance: stock to leave on the part")


class Rough(LevelStage):
    """Contour roughing."""

    resolution_mm: float = Field(default=0.5, gt=0.0, description="longest piece of a contour during computation")
    ramp_deg: float = Field(default=3.0, gt=0.0, lt=45.0, description="steepest angle of helices and ramps")


class Semi(LevelStage):
    """Semi-finishing of the rest material after roughing."""

    least_mm: float = Field(default=0.1, gt=0.0, description="thinner rest material is left to finishing")
    resolution_mm: float = Field(
        default=0.4, gt=0.0, description="distance of the positions where rest material is checked"
    )
    direction: Literal["both", "climb"] = Field(
        default="both", description="both: climb and conventional cuts; climb: climb cuts only"
    )
    method: Literal["greedy", "2-opt", "ils"] = Field(default="ils", description="search method for the order of cuts")
    seed: int = Field(default=1, ge=0, description="seed of the search; equal seeds give equal programs")
    iterations: Annotated[int | None, Key(unset="5 per cut, at least 500")] = Field(
        default=None, ge=0, description="iterations of the search at each level"
    )
    budget_s: Annotated[float | None, Key(unset="no limit")] = Field(
        default=None, gt=0.0, description="longest search time at each level; with it, programs depend on the computer"
    )


class Finish(StageTable):
    """Finishing by rows, and by level lines on steep faces."""

    stepover_mm: Annotated[float | None, Key(unset="from scallop_mm")] = Field(
        default=None, gt=0.0, description="stepover: distance between rows"
    )
    scallop_mm: Annotated[float | None, Key(unset="from stepover_mm")] = Field(
        default=None, gt=0.0, description="scallop height on level faces, instead of the stepover"
    )
    chord_mm: float = Field(default=0.005, gt=0.0, description="chord tolerance: largest deviation from the exact path")
    pitch_mm: float = Field(default=0.3, gt=0.0, description="distance of the first drop-cutter positions along a row")
    direction: Literal["x", "y"] = Field(default="x", description="axis that the rows run along")
    steep_deg: Annotated[float | None, Key(unset="rows everywhere")] = Field(
        default=None, gt=0.0, lt=90.0, description="steeper faces are cut along level lines"
    )
    least_mm: float = Field(default=0.01, gt=0.0, description="thinner rest material is not cut")


class Compare(Table):
    """Comparison with raster roughing and raster semi-finishing; `conventional` is the key's former name."""

    raster_baseline: bool = Field(default=True, description="whether the raster baseline is computed as well")

    @model_validator(mode="before")
    @classmethod
    def _former_name(cls, values: Any) -> Any:
        if isinstance(values, Mapping) and "conventional" in values and "raster_baseline" not in values:
            return {("raster_baseline" if key == "conventional" else key): v for key, v in values.items()}
        return values


class MoldOutput(Table):
    """Files of the programs."""

    folder: FilePath = Field(
        default=Path("programs"), description="folder of the programs, relative to the job file's folder"
    )
    name: str = Field(default="mold", pattern=r"^[A-Za-z0-9_\-]+$", description="first part of their file names")
    dexel_mm: float = Field(
        default=0.2, gt=0.0, description="distance of the dexels that keep the stock between stages"
    )


class MoldFile(Table):
    """A mold: part, stock, machine, tools and stages."""

    part: Part = Field(description="the part")
    stock: MoldStock = Field(default_factory=MoldStock, description="the stock")
    machine: MoldMachine = Field(default_factory=MoldMachine, description="the machine")
    tools: Annotated[tuple[Tool, ...], Strict(False)] = Field(
        description="the tools, each under [[tools]], at least one", json_schema_extra={"minItems": 1}
    )
    rough: Rough = Field(description="roughing")
    semi: Semi = Field(description="semi-finishing")
    finish: Finish = Field(description="finishing")
    compare: Compare = Field(default_factory=Compare, description="comparison with a raster baseline")
    output: MoldOutput = Field(default_factory=MoldOutput, description="files of the programs")


class MoldJob(MoldFile):
    """A checked mold job; make it with `load_mold` or `mold_from_dict`. Its files' paths are joined to its folder.

    Attributes:
        path: the job file.
    """

    path: Path

    def with_folder(self, folder: Path) -> MoldJob:
        """The same job with its programs in another folder."""
        return self.model_copy(update={"output": self.output.model_copy(update={"folder": folder})})

    def with_unit(self, unit: Unit) -> MoldJob:
        """The same job with another unit of its STL file."""
        return self.model_copy(update={"part": self.part.model_copy(update={"unit": unit})})

    def tool_of(self, stage: StageTable) -> Tool:
        """The tool of a stage."""
        return next(t for t in self.tools if t.number == stage.tool)
