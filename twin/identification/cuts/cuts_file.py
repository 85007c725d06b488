"""The keys of a file of test cuts, one model a table; strict, with a word on each key as in a job file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, Strict

from twin.identification.models.straight import Direction
from twin.job.model import Tool
from twin.measured.settings import LogReading
from twin.settings.table import FilePath, Point, Table

Name: TypeAlias = Literal["Ktc", "Kte", "Krc", "Kre", "Kac", "Kae"]
Method: TypeAlias = Literal["mean", "iterative", "waveform"]
Window: TypeAlias = Annotated[tuple[float, float], Strict(False)]
Texts: TypeAlias = Annotated[tuple[str, ...], Strict(False)]


class CutTool(Tool):
    """The tool of the cuts, keys as in a job; number and flute length may be left out."""

    number: int = Field(default=1, ge=1, description="tool number, without meaning here")
    flute_length_mm: float = Field(
        default=0.0, gt=0.0, description="height of the cutting part above the tip; as the cuts need it if not given"
    )


class Shared(LogReading):
    """What `[defaults]` may give for all cuts, and each cut for itself."""

    direction: Direction | None = Field(default=None, description="slot, up or down milling; feed along +x, M3")
    axial_depth_mm: float | None = Field(default=None, gt=0.0, description="axial depth of cut, mm")
    radial_depth_mm: float | None = Field(
        default=None, gt=0.0, description="radial depth of cut, mm of the nominal diameter"
    )
    spindle_rpm: float | None = Field(default=None, gt=0.0, description="spindle speed, rpm")
    feed_mm_min: float | None = Field(default=None, gt=0.0, description="feed, mm/min")
    window_s: Window | None = Field(
        default=None, description="from, to: the steady cut in the log's time; found if not given"
    )
    air_s: Annotated[tuple[Window, ...], Strict(False)] | None = Field(
        default=None, description="windows of the log without cutting; found if not given"
    )
    zero: Literal["auto", "line", "constant", "none"] = Field(
        default="auto",
        description="what is taken off: a line or a constant through the air, nothing, or what the air allows",
    )


class Cut(Shared):
    """One test cut."""

    name: str = Field(default="", description="name of the cut; that of its log, or its number, if not given")
    log: FilePath | None = Field(default=None, description="measured log, relative to this file's folder")
    mean_force_n: Point | None = Field(default=None, description="mean force x, y, z in place of a log, N")
    mean_error_n: Point | None = Field(default=None, description="standard errors of mean_force_n, N")
    job: FilePath | None = Field(default=None, description="job file of the cut, for any engagement; it is replayed")
    run_window_s: Window | None = Field(
        default=None, description="from, to: the part of the job's run that is used, machine time"
    )
    lag_s: float | None = Field(default=None, description="log's time less machine time of the job's run, s")
    spindle_angle_deg: float | None = Field(
        default=None,
        description="angle of tooth 0 at the log's time 0, from +x in the sense of rotation; found if not given",
    )
    holdout: bool = Field(default=False, description="report this cut, but do not fit it")


class Fit(Table):
    """How the coefficients are found."""

    method: Method = Field(default="mean", description="method, if the command line names none")
    holdout: Texts = Field(default=(), description="names of cuts that are reported and not fitted")
    weights: Literal["errors", "equal"] = Field(
        default="errors", description="cuts weighted by the standard errors of their means, or all alike"
    )
    fixed: dict[Name, float] = Field(default_factory=dict, description="coefficients that are given, not found")
    start: dict[Name, float] = Field(default_factory=dict, description="where the iterative search begins")
    lower: dict[Name, float] = Field(default_factory=dict, description="lower bounds of the iterative search")
    upper: dict[Name, float] = Field(default_factory=dict, description="upper bounds of the iterative search")
    runout: bool = Field(default=False, description="whether runout is unknown too (waveform)")
    harmonics: int | None = Field(
        default=None, ge=1, le=400, description="multiples of the spindle frequency that waveforms are compared in"
    )
    lowpass_hz: float | None = Field(
        default=None, gt=0.0, description="highest frequency that waveforms are compared in, Hz"
    )
    speed: Literal["found", "given"] = Field(
        default="found", description="spindle speed of a log: found within 1 % of the one given, or taken as given"
    )
    source: str | None = Field(
        default=None, min_length=1, pattern=r"\S", description="source that the coefficients are written with"
    )


class CutsFile(Table):
    """Test cuts with one tool in one material."""

    tool: CutTool | None = Field(
        default=None, description="the tool, keys as in a job; not needed if all cuts are jobs"
    )
    defaults: Shared = Field(default_factory=Shared, description="keys for all cuts that do not give them")
    fit: Fit = Field(default_factory=Fit, description="how the coefficients are found")
    cuts: Annotated[tuple[Cut, ...], Strict(False)] = Field(
        description="the test cuts, each under [[cuts]], at least one", json_schema_extra={"minItems": 1}
    )


class Cuts(CutsFile):
    """Checked test cuts: names given, defaults in place, files joined to the folder.

    Attributes:
        path: the file.
    """

    path: Path

    @property
    def held_out(self) -> frozenset[str]:
        """Names of the cuts that are not fitted."""
        return frozenset(self.fit.holdout) | {cut.name for cut in self.cuts if cut.holdout}
