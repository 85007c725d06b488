"""The keys of a job file, one model a table; frozen, strict, and with a word on each key.

The descriptions are part of the error messages and of the JSON Schema. What concerns more than one key is in
`twin.job.rules`, so that it is checked even where another key is wrong.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import ConfigDict, Field, Strict

from twin.errors import JobError
from twin.record import ForceOn
from twin.settings.schema import toml_schema
from twin.settings.table import FilePath, Point, Table

#: The keys of a stock, of which one is given.
STOCKS = ("box_mm", "cylinder_mm", "stl")
WorkOffset: TypeAlias = Literal["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"]


class Program(Table):
    """The NC program."""

    file: FilePath = Field(description="NC program, relative to the job file's folder")
    dialect: Literal["fanuc", "haas", "linuxcnc", "grbl"] = Field(
        default="fanuc", description="control that the program is written for"
    )
    arc_centres: Literal["incremental", "absolute"] = Field(
        default="incremental", description="whether I, J, K are measured from the arc's start or are coordinates"
    )
    block_delete: bool = Field(
        default=False, description="block delete switch: true leaves out the blocks that begin with /"
    )
    units: Literal["mm", "inch"] = Field(default="mm", description="units until the program says G20 or G21")
    tool: int = Field(default=0, ge=0, description="tool in the spindle when the program starts, 0 for none")
    search_path: list[FilePath] = Field(
        default_factory=list, description="folders of subprogram files, searched after the program's own"
    )
    decimal_point: Literal["calculator", "increment"] = Field(
        default="calculator", description="X100 without a point: 100 mm, or 100 least increments of 0.001 mm"
    )
    compensation_startup: Literal["A", "B"] = Field(
        default="A", description="type of start-up and cancel of cutter compensation on FANUC and Haas"
    )


class Machine(Table):
    """The machine and its set-up. Points are places of the gauge point in machine coordinates."""

    rapid_mm_min: float = Field(default=48000.0, gt=0.0, description="speed along the path of rapid motions, mm/min")
    tool_change_s: float = Field(default=0.0, ge=0.0, description="time of one tool change, s")
    home_mm: Point | None = Field(
        default=None, description="gauge point at the reference point of G28; above the stock if not given"
    )
    start_mm: Point | None = Field(
        default=None, description="gauge point when the program starts; the reference point if not given"
    )
    offsets: dict[WorkOffset, Point] = Field(
        default={"G54": (0.0, 0.0, 0.0)}, description="work offsets: places of the work zeros, machine coordinates, mm"
    )


class Box(Table):
    """A box with its faces along the axes."""

    min: Point = Field(description="lower corner, mm")
    max: Point = Field(description="upper corner, mm")


class Cylinder(Table):
    """A cylinder along one of the axes."""

    axis: Literal["x", "y", "z"] = Field(default="z", description="direction of the cylinder")
    centre: Annotated[tuple[float, float], Strict(False)] = Field(
        description="centre on the two other axes: [x, y] for axis z, [x, z] for y, [y, z] for x, mm"
    )
    diameter: float = Field(gt=0.0, description="diameter, mm")
    min: float = Field(description="lower end along the axis, mm")
    max: float = Field(description="upper end along the axis, mm")


class Stock(Table):
    """The material before the first cut: a box, a cylinder, or a solid from an STL file."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [key]} for key in STOCKS]})

    box_mm: Box | None = Field(default=None, description="a box")
    cylinder_mm: Cylinder | None = Field(default=None, description="a cylinder")
    stl: FilePath | None = Field(
        default=None, description="STL file of a closed solid, relative to the job file's folder"
    )
    stl_scale: float = Field(default=1.0, gt=0.0, description="mm a unit of the STL file, 25.4 for inches")
    offset_mm: Point = Field(default=(0.0, 0.0, 0.0), description="added to the STL file's points after scaling, mm")
    wcs: WorkOffset = Field("G54", description="work offset that the stock's coordinates are given in")


class RigidPart(Table):
    """A cylinder of a tool that does not cut."""

    diameter_mm: float = Field(gt=0.0, description="diameter, mm")
    length_mm: float = Field(gt=0.0, description="length along the tool axis, mm")


class Cutting(Table):
    """Cutting coefficients of the tri-slice paper's eq. 2: per chip area (c) and per edge length (e)."""

    Ktc: float = Field(ge=0.0, description="tangential, per chip area, N/mm2")
    Kte: float = Field(description="tangential, per edge length, N/mm")
    Krc: float = Field(description="radial, per chip area, N/mm2")
    Kre: float = Field(description="radial, per edge length, N/mm")
    Kac: float = Field(description="axial, per chip area, N/mm2")
    Kae: float = Field(description="axial, per edge length, N/mm")
    source: str = Field(min_length=1, pattern=r"\S", description="where the coefficients come from")
    convention: Literal["meridian"] = Field(
        default="meridian", description="length that the edge terms count: along the tool's meridian"
    )
    standard_errors: Annotated[tuple[float, float, float, float, float, float], Strict(False)] | None = Field(
        default=None, description="standard errors of Ktc, Kte, Krc, Kre, Kac, Kae; kept with the run, not used"
    )
    correlation: Annotated[tuple[Annotated[tuple[float, ...], Strict(False)], ...], Strict(False)] | None = Field(
        default=None, description="correlation of these errors, six rows of six; kept with the run, not used"
    )


class Tool(Table):
    """A tool: cutting part, then shank, then holder, upwards from the tip."""

    number: int = Field(ge=1, description="tool number, the T word")
    name: str = Field(default="", description="a name for people")
    kind: Literal["flat", "ball", "bull", "taper"] = Field(description="shape of the cutting part")
    diameter_mm: float = Field(gt=0.0, description="diameter of the cutting part; of a taper tool's tip")
    teeth: int = Field(ge=1, le=100, description="number of flutes")
    helix_deg: float = Field(
        default=0.0, gt=-90.0, lt=90.0, description="helix angle, right hand positive; at 90 a flute would not rise"
    )
    flute_length_mm: float = Field(gt=0.0, description="height of the cutting part above the tip")
    corner_radius_mm: float | None = Field(default=None, gt=0.0, description="corner radius of a bull or taper tool")
    taper_deg: float | None = Field(default=None, gt=0.0, lt=90.0, description="half angle of a taper tool")
    length_mm: float = Field(
        default=0.0, ge=0.0, description="gauge length: from the tip to the gauge point, the H entry"
    )
    pitch_deg: Annotated[tuple[float, ...], Strict(False)] | None = Field(
        default=None, description="angle from each tooth to the next, one a tooth, 360 in all"
    )
    runout_mm: float = Field(default=0.0, ge=0.0, description="distance of the cutter's axis from the spindle's")
    runout_angle_deg: float = Field(default=0.0, description="direction of the runout, from the tip of the first tooth")
    shank: RigidPart | None = Field(default=None, description="shank above the flutes")
    holder: Annotated[tuple[RigidPart, ...], Strict(False)] = Field(
        default=(), description="holder above that, upwards"
    )
    cutting: Cutting | None = Field(
        default=None, description="coefficients for this tool instead of those of [cutting]"
    )


class Simulation(Table):
    """How finely the replay is computed."""

    slice_pitch_mm: float = Field(default=0.1, gt=0.0, description="distance of the slices in all three directions")
    step_mm: float = Field(default=0.1, gt=0.0, description="longest step along a motion")
    angle_step_deg: float = Field(default=1.0, gt=0.0, le=360.0, description="spindle angle between force samples")
    axial_step_mm: float = Field(default=0.1, gt=0.0, description="height of a cutting edge element")
    engagement: Literal["majority", "any"] = Field(
        default="majority",
        description="how many of the three slices must hold an edge point: two, or one as in the paper",
    )
    store: Literal["fast", "reference"] = Field(default="fast", description="implementation of the slices")
    preview_pitch_mm: float | None = Field(
        default=None, gt=0.0, description="cell size of the drawn workpiece; suits the stock if not given"
    )


class Output(Table):
    """Where the run goes."""

    mcap: FilePath | None = Field(
        default=None, description="archive of the run (.mcap), relative to the job file's folder"
    )
    rrd: FilePath | None = Field(default=None, description="rerun recording (.rrd), relative to the job file's folder")
    force_on: ForceOn = Field(default="tool", description="body that feels the forces in summary and export")


class Measured(Table):
    """A measured force log of this program, for comparisons: how it is read."""

    file: FilePath | None = Field(default=None, description="the log, relative to the job file's folder")
    map: str | None = Field(
        default=None, min_length=1, description="columns for the axes with their signs, e.g. x=-Fy,y=-Fx,z=Fz"
    )
    force_on: ForceOn = Field(default="tool", description="body that the mapped force acts on")
    columns: Annotated[tuple[str, ...], Strict(False)] | None = Field(
        default=None, description="names of all columns, with units, in place of the file's own"
    )
    unit: str | None = Field(
        default=None, min_length=1, description="unit of the forces, where the file does not say it"
    )
    rate_hz: float | None = Field(default=None, gt=0.0, description="sampling rate, where the file does not say it, Hz")
    delimiter: str | None = Field(default=None, description="delimiter of a text file")
    decimal: Literal[".", ","] | None = Field(default=None, description="decimal mark of a text file")
    group: str | None = Field(default=None, min_length=1, description="group, variable or topic in the file")
    lag_s: float | None = Field(
        default=None, description="how late the log is, s; found by cross-correlation if not given"
    )
    offset: str = Field(default="none", description="zero of the amplifier: none, air, BEGIN:END or X,Y,Z")
    windows: Annotated[tuple[str, ...], Strict(False)] = Field(
        default=(), description="windows of the comparison on the run's clock, BEGIN:END in s"
    )


class JobFile(Table):
    """A replay: NC program, machine, stock, tools, cutting coefficients, fineness and outputs."""

    program: Program = Field(description="the NC program")
    machine: Machine = Field(default_factory=Machine, description="the machine")
    stock: Stock = Field(description="the material before the first cut")
    tools: Annotated[tuple[Tool, ...], Strict(False)] = Field(
        description="the tools, each under [[tools]], at least one", json_schema_extra={"minItems": 1}
    )
    cutting: Cutting | None = Field(
        default=None, description="cutting coefficients; without them no forces are computed"
    )
    simulation: Simulation = Field(default_factory=Simulation, description="how finely the replay is computed")
    output: Output = Field(default_factory=Output, description="where the run goes")
    measured: Measured | None = Field(default=None, description="a measured log to compare the run with")


class Job(JobFile):
    """A checked job; make it with `load_job` or `job_from_dict`. Its files' paths are joined to the job's folder.

    Attributes:
        path: the job file.
        text: its text, for the archive.
    """

    path: Path
    text: str

    @property
    def forces(self) -> bool:
        """Whether any tool has cutting coefficients."""
        return any(self.coefficients(tool) is not None for tool in self.tools)

    def coefficients(self, tool: Tool) -> Cutting | None:
        """The coefficients of a tool: its own, or those for all."""
        return tool.cutting or self.cutting

    def tool(self, number: int) -> Tool:
        """The tool of that number.

        Raises:
            JobError: there is none.
        """
        for tool in self.tools:
            if tool.number == number:
                return tool
        known = ", ".join(str(tool.number) for tool in self.tools)
        raise JobError(str(self.path), [f"tools: no tool has the number {number}; expected one of {known}"])

    def with_store(self, store: str) -> Job:
        """The same job with another implementation of the slices."""
        return self.model_copy(update={"simulation": self.simulation.model_copy(update={"store": store})})

    def with_pitch(self, pitch_mm: float) -> Job:
        """The same job with slices at another distance."""
        update = {"slice_pitch_mm": pitch_mm}
        return self.model_copy(update={"simulation": self.simulation.model_copy(update=update)})

    def without_forces(self) -> Job:
        """The same job without cutting coefficients."""
        tools = tuple(tool.model_copy(update={"cutting": None}) for tool in self.tools)
        return self.model_copy(update={"cutting": None, "tools": tools})


def job_schema() -> dict[str, Any]:
    """JSON Schema of a job file; `load_job` checks more."""
    return toml_schema(JobFile, "Job of a machining twin")
