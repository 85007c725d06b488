"""The keys of a job file, one model for each table; frozen, strict, and with a description of each key.

The descriptions are part of the error messages, of the JSON Schema and of the page. Rules between keys are in
`twin.job.rules`, so that they are checked even where another key is wrong.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import ConfigDict, Field, Strict

from twin.errors import JobError
from twin.job.limits import PITCH_LIMITS
from twin.job.stock_keys import Stock, WorkOffset
from twin.materials import find_material
from twin.measured.settings import CompareSettings, LogFile
from twin.settings.check import checked
from twin.settings.facts import Facts
from twin.settings.force_on import ForceOn
from twin.settings.json_schema import toml_schema
from twin.settings.kept_samples import KeptSamples
from twin.settings.table import FilePath, Key, Point, Table

SixNumbers: TypeAlias = Annotated[tuple[float, float, float, float, float, float], Strict(False)]
Interval: TypeAlias = Annotated[tuple[float, float], Strict(False)]
_Coefficient: TypeAlias = Annotated[float, Key(unset="required, or that of the material")]
_OF_LIBRARY = "required, or that of the library"
_Exponent: TypeAlias = Annotated[float | None, Key(unset="0")]
MCode: TypeAlias = Annotated[int, Strict(False), Field(ge=0)]
Rows: TypeAlias = Annotated[tuple[Annotated[tuple[float, ...], Strict(False)], ...], Strict(False)]
RapidPath: TypeAlias = Literal["independent", "straight"]
#: Path of rapids on each control as delivered: FANUC parameter 1401 bit 1 is 0, Haas setting 335 is off; LinuxCNC and
#: GRBL move all axes in a straight line.
RAPIDS: dict[str, RapidPath] = {
    "fanuc": "independent",
    "haas": "independent",
    "linuxcnc": "straight",
    "grbl": "straight",
}


class Program(Table):
    """The NC program."""

    file: FilePath = Field(description="NC program, relative to the job file's folder")
    dialect: Literal["fanuc", "haas", "linuxcnc", "grbl", "auto"] = Field(
        default="fanuc", description="control that the program is written for; auto takes the likeliest"
    )
    arc_centres: Literal["incremental", "absolute"] = Field(
        default="incremental",
        description="arc centre I, J, K: distance from the arc's start (incremental), or coordinates (absolute)",
    )
    block_delete: bool = Field(
        default=False, description="block delete switch: true skips the blocks that begin with /"
    )
    units: Literal["mm", "inch"] = Field(
        default="mm", description="units in force until the program's first G20 or G21"
    )
    g70_units: bool = Field(
        default=False, description="G70 and G71 set inches and millimetres, as on Mach3 and in some posts of NX"
    )
    tool: int = Field(default=0, ge=0, description="tool in the spindle when the program starts, 0 for none")
    search_path: list[FilePath] = Field(
        default_factory=list, description="folders to search for subprogram files after the program's own folder"
    )
    decimal_point: Literal["calculator", "increment"] = Field(
        default="calculator",
        description="X100 without a decimal point: 100 mm (calculator), or 100 increments of 0.001 mm (increment)",
    )
    compensation_startup: Literal["A", "B"] = Field(
        default="A", description="start-up and cancel type of cutter compensation on FANUC and Haas"
    )
    m_codes: dict[MCode, Literal["none"]] = Field(
        default_factory=dict,
        description='M codes of the machine builder, by number: { 72 = "none" } for one that moves nothing',
    )


class Machine(Table):
    """The machine and its setup. Points are positions of the gauge point in machine coordinates."""

    rapid: Annotated[RapidPath | None, Key(unset="as the control: independent for fanuc and haas")] = Field(
        default=None,
        description="path of rapids: each axis at its own rate until it arrives (independent), or a straight line "
        "(straight)",
    )
    rapid_mm_min: float = Field(
        default=48000.0,
        gt=0.0,
        description="rapid traverse rate, of each axis (independent) or along the path (straight), mm/min",
    )
    axis_rapid_mm_min: Annotated[Point | None, Key(unset="rapid_mm_min for each")] = Field(
        default=None, description="rapid traverse rates of X, Y and Z (independent), above 0, mm/min"
    )
    max_feed_mm_min: Annotated[float | None, Key(unset="rapid_mm_min")] = Field(
        default=None, gt=0.0, description="highest feed of the machine, mm/min; a program above it gets a warning"
    )
    max_spindle_rpm: Annotated[float | None, Key(unset="not checked")] = Field(
        default=None, gt=0.0, description="highest spindle speed, rev/min; a program above it gets a warning"
    )
    tool_change_s: float = Field(default=0.0, ge=0.0, description="time of one tool change, s")
    home_mm: Annotated[Point | None, Key(unset="above the stock")] = Field(
        default=None, description="position of the gauge point at the G28 reference point, mm"
    )
    start_mm: Annotated[Point | None, Key(unset="the reference point")] = Field(
        default=None, description="position of the gauge point when the program starts, mm"
    )
    offsets: dict[WorkOffset, Point] = Field(
        default={"G54": (0.0, 0.0, 0.0)},
        description="work offsets, G54 to G59, G59.1 to G59.3 and G54.1 P1 to P300: positions of the work zeros, mm; "
        "only those listed can be used",
    )


class RigidPart(Table):
    """A cylinder of a tool that does not cut."""

    diameter_mm: float = Field(gt=0.0, description="diameter, mm")
    length_mm: float = Field(gt=0.0, description="length along the tool axis, mm")


def _required_without_material(schema: dict[str, Any]) -> None:
    """JSON Schema of the coefficients: all of them, or a material."""
    schema["anyOf"] = [{"required": ["material"]}, {"required": schema.pop("required")}]


class Cutting(Table):
    """Cutting coefficients of the tri-slice paper's eq. 2: per chip area (c) and per edge length (e)."""

    model_config = ConfigDict(json_schema_extra=_required_without_material)

    material: Annotated[str | None, Key(unset="none")] = Field(
        default=None,
        min_length=1,
        description="name of a material in the table of twin materials; its values stand for the keys not given here",
    )
    law: Annotated[Literal["linear-edge", "kienzle"] | None, Key(unset="linear-edge")] = Field(
        default=None, description="force law: linear-edge, or kienzle with the exponents mt, mr, ma"
    )
    Ktc: _Coefficient = Field(ge=0.0, description="tangential, per chip area, N/mm2; under kienzle at a chip of 1 mm")
    Kte: _Coefficient = Field(description="tangential, per edge length, N/mm")
    Krc: _Coefficient = Field(description="radial, per chip area, N/mm2; under kienzle at a chip of 1 mm")
    Kre: _Coefficient = Field(description="radial, per edge length, N/mm")
    Kac: _Coefficient = Field(description="axial, per chip area, N/mm2; under kienzle at a chip of 1 mm")
    Kae: _Coefficient = Field(description="axial, per edge length, N/mm")
    mt: _Exponent = Field(default=None, ge=0.0, lt=1.0, description="kienzle only: exponent of the tangential force")
    mr: _Exponent = Field(default=None, ge=0.0, lt=1.0, description="kienzle only: exponent of the radial force")
    ma: _Exponent = Field(default=None, ge=0.0, lt=1.0, description="kienzle only: exponent of the axial force")
    source: Annotated[str | None, Key(unset="a warning")] = Field(
        default=None, min_length=1, pattern=r"\S", description="source of the coefficients, e.g. a paper or a test"
    )
    convention: Literal["meridian"] = Field(
        default="meridian",
        description="edge length that Kte, Kre and Kae refer to: along the tool's profile (meridian), not the helix",
    )
    chip_range_mm: Annotated[Interval | None, Key(unset="not checked")] = Field(
        default=None,
        description="uncut chip thickness that the coefficients hold for, [lowest, highest], mm; runs outside it warn",
    )
    speed_range_m_min: Annotated[Interval | None, Key(unset="not checked")] = Field(
        default=None,
        description="cutting speed that the coefficients hold for, [lowest, highest], m/min; runs outside it warn",
    )
    caution: Annotated[str | None, Key(unset="none")] = Field(
        default=None, min_length=1, description="text printed with the warnings of every run that uses the coefficients"
    )
    standard_errors: Annotated[SixNumbers | None, Key(unset="none")] = Field(
        default=None, description="standard errors of Ktc, Kte, Krc, Kre, Kac, Kae; archived with the run, not used"
    )
    correlation: Annotated[Rows | None, Key(unset="none")] = Field(
        default=None, description="correlation of these errors, six rows of six; archived with the run, not used"
    )


def _required_without_library(schema: dict[str, Any]) -> None:
    """JSON Schema of a tool: all required keys, or a library with number or name."""
    named = [{"required": ["number"]}, {"required": ["name"]}]
    schema["anyOf"] = [{"required": ["from"], "anyOf": named}, {"required": schema.pop("required")}]


class Tool(Table):
    """A tool: cutting part, then shank, then holder, upwards from the tip."""

    model_config = ConfigDict(json_schema_extra=_required_without_library)

    from_: Annotated[FilePath | None, Key(unset="none")] = Field(
        default=None,
        alias="from",
        description="tool library, relative to the job file's folder; its tool of that number or name gives the keys "
        "that are not given here",
    )
    library_unit: Annotated[Literal["mm", "inch"] | None, Key(unset="mm")] = Field(
        default=None, description="unit of a library that states none, as LinuxCNC's: mm or inch"
    )
    number: Annotated[int, Key(unset=_OF_LIBRARY)] = Field(ge=1, description="tool number, the T word")
    name: str = Field(default="", description="human-readable name; with from, the name of the tool in the library")
    kind: Annotated[Literal["flat", "ball", "bull", "taper"], Key(unset=_OF_LIBRARY)] = Field(
        description="shape of the cutting part"
    )
    diameter_mm: Annotated[float, Key(unset=_OF_LIBRARY)] = Field(
        gt=0.0, description="diameter of the cutting part; for a taper tool, diameter at the tip"
    )
    teeth: Annotated[int, Key(unset=_OF_LIBRARY)] = Field(ge=1, le=100, description="number of flutes")
    helix_deg: float = Field(default=0.0, gt=-90.0, lt=90.0, description="helix angle, right-hand positive")
    flute_length_mm: Annotated[float, Key(unset=_OF_LIBRARY)] = Field(
        gt=0.0, le=1000.0, description="length of the cutting part, measured from the tip"
    )
    corner_radius_mm: float | None = Field(
        default=None, gt=0.0, description="corner radius: required for bull, optional for taper, not for other kinds"
    )
    taper_deg: float | None = Field(
        default=None, gt=0.0, lt=90.0, description="half angle of the taper: required for taper, not for other kinds"
    )
    length_mm: float = Field(
        default=0.0, ge=0.0, description="gauge length from tip to gauge point; it is also the tool length offset (H)"
    )
    offset_radius_mm: Annotated[float | None, Key(unset="half the diameter")] = Field(
        default=None,
        description="radius in its offset for cutter compensation (D); 0 for a path of the tool centre",
    )
    pitch_deg: Annotated[Annotated[tuple[float, ...], Strict(False)] | None, Key(unset="constant pitch")] = Field(
        default=None, description="variable pitch: angle from each tooth to the next, one per tooth, 360 in total"
    )
    runout_mm: float = Field(
        default=0.0,
        ge=0.0,
        description="radial runout: distance from the spindle axis to the cutter axis, half the indicator reading, mm",
    )
    runout_angle_deg: float = Field(
        default=0.0,
        description="direction of the runout, measured from the tip of the first tooth in the direction of rotation",
    )
    shank: Annotated[RigidPart | None, Key(unset="without a holder, the largest diameter goes on")] = Field(
        default=None, description="shank above the flutes: { diameter_mm, length_mm }"
    )
    holder: Annotated[tuple[RigidPart, ...], Strict(False), Key(unset="none")] = Field(
        default=(), description="holder above the shank, from the bottom up: list of { diameter_mm, length_mm }"
    )
    cutting: Annotated[Cutting | None, Key(unset="those of [cutting]")] = Field(
        default=None, description="coefficients for this tool"
    )
    origin: Annotated[str | None, Key(unset="the entry of the library")] = Field(
        default=None, min_length=1, description="source of the sizes, e.g. a catalogue; archived with the run"
    )
    caution: Annotated[str | None, Key(unset="none, or assumptions on the library")] = Field(
        default=None, min_length=1, description="text printed with the warnings of every run with the tool"
    )


class Simulation(Table):
    """Resolution of the replay."""

    slice_pitch_mm: float = Field(
        default=0.1,
        gt=0.0,
        description="distance between slices; at most the diameter of the thinnest tool",
    )
    step_mm: float = Field(default=0.1, gt=0.0, description="longest step of the tool along a motion")
    angle_step_deg: float = Field(
        default=1.0, gt=0.0, le=360.0, description="spindle angle between force samples; must divide 360"
    )
    axial_step_mm: float = Field(
        default=0.1,
        gt=0.0,
        description="height of a cutting edge element along the tool axis; at most half the shortest flute length",
    )
    engagement: Literal["majority", "any"] = Field(
        default="majority",
        description="slices that must contain an edge point, of the three nearest to it: two (majority), or one (any), "
        "the paper's rule",
    )
    store: Literal["fast", "reference"] = Field(
        default="fast", description="storage of the slices: column cells (fast), or plain polygons (reference, slow)"
    )
    preview_pitch_mm: Annotated[float | None, Key(unset="to suit the stock")] = Field(
        default=None, gt=0.0, description="cell size of the workpiece as drawn, mm; no effect on results"
    )


class Output(Table):
    """Outputs of the run."""

    mcap: Annotated[FilePath | None, Key(unset="none")] = Field(
        default=None, description="archive of the run (.mcap), relative to the job file's folder"
    )
    rrd: Annotated[FilePath | None, Key(unset="none")] = Field(
        default=None, description="rerun recording (.rrd), relative to the job file's folder"
    )
    force_on: ForceOn = Field(default="tool", description="body on which the forces in summary and export act")
    samples: KeptSamples = Field(default="all", description="force samples in the archive: see below")


class Measured(CompareSettings, LogFile):
    """A measured force log of this program: its file, reading, corrections and windows."""


class JobFile(Table):
    """A replay: NC program, machine, stock, tools, cutting coefficients, resolution and outputs."""

    program: Program = Field(description="the NC program")
    machine: Machine = Field(default_factory=Machine, description="the machine")
    stock: Stock = Field(description="the material before the first cut")
    tools: Annotated[tuple[Tool, ...], Strict(False)] = Field(
        description="the tools, each under [[tools]], at least one", json_schema_extra={"minItems": 1}
    )
    cutting: Cutting | None = Field(
        default=None, description="cutting coefficients; without them no forces are computed"
    )
    simulation: Simulation = Field(default_factory=Simulation, description="resolution of the replay")
    output: Output = Field(default_factory=Output, description="outputs of the run")
    measured: Measured | None = Field(default=None, description="a measured log to compare the run with")


class Job(JobFile):
    """A checked job, made by `load_job` or `job_from_dict`; its tables are attributes by their names in the file.

    Paths of files are joined to the job's folder. A job does not change: `with_simulation` and `without_forces` give
    others.

    Attributes:
        path: the job file.
        text: its text, for the archive.

    Example:
        >>> coarse = twin.load_job("job.toml").with_simulation(slice_pitch_mm=0.4)
        >>> twin.replay(coarse).summary.removed_volume_mm3
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

    def with_simulation(self, **values: Any) -> Job:
        """The same job with other values of its ``[simulation]`` table, e.g. ``slice_pitch_mm=0.2``.

        Raises:
            JobError: wrong names or values, or a pitch that does not suit stock and tools; with every mistake.
        """
        simulation = checked(Simulation, {**self.simulation.model_dump(), **values}, "simulation", JobError)
        made = self.model_copy(update={"simulation": simulation})
        facts = Facts(made.model_dump(include={"simulation", "stock", "tools"}, exclude_none=True), [], JobFile)
        problems = [str(problem) for rule in PITCH_LIMITS for problem in rule(facts, self.path.parent)]
        if problems:
            raise JobError(str(self.path), problems)
        return made

    def with_material(self, name: str) -> Job:
        """The same job with the cutting coefficients of a material for all tools, in place of its own.

        Args:
            name: see `twin.find_material`.

        Raises:
            MaterialError: there is none; the message has the nearest names.
        """
        cutting = Cutting.model_validate(find_material(name).cutting())
        return self.without_forces().model_copy(update={"cutting": cutting})

    def with_program(self, **values: Any) -> Job:
        """The same job with other values of its ``[program]`` table, e.g. ``tool=1``.

        Raises:
            JobError: wrong names or values; the message has every mistake.
        """
        program = checked(Program, {**self.program.model_dump(), **values}, "program", JobError)
        if program.tool:
            self.tool(program.tool)
        return self.model_copy(update={"program": program})

    def without_forces(self) -> Job:
        """The same job without cutting coefficients."""
        tools = tuple(tool.model_copy(update={"cutting": None}) for tool in self.tools)
        return self.model_copy(update={"cutting": None, "tools": tools})


def job_schema() -> dict[str, Any]:
    """JSON Schema of a job file; `load_job` checks more."""
    return toml_schema(JobFile, "Job of a machining twin")
