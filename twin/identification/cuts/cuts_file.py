"""The keys of a file of test cuts, one model for each table; strict, with a description of each key."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, Strict

from twin.identification.cuts.fit_settings import Fit
from twin.job.job_file import Tool
from twin.measured.settings import LogReading
from twin.settings.table import FilePath, Key, Point, Table

Direction: TypeAlias = Literal["slot", "up", "down"]
Window: TypeAlias = Annotated[tuple[float, float], Strict(False)]
Windows: TypeAlias = Annotated[tuple[Window, ...], Strict(False)]


class CutTool(Tool):
    """The tool of the cuts, keys as in a job; number and flute length are optional."""

    number: int = Field(default=1, ge=1, description="tool number, without meaning here")
    flute_length_mm: float = Field(
        default=0.0,
        gt=0.0,
        description="length of the cutting part, measured from the tip; as needed by the cuts if not given",
    )


class CutSource(Table):
    """Name of a cut, and where its force comes from."""

    name: Annotated[str, Key(unset="the log's name")] = Field(
        default="", description="name of the cut in tables and for holdout"
    )
    log: FilePath | None = Field(default=None, description="measured log, relative to this file's folder")
    mean_force_n: Point | None = Field(
        default=None,
        description="mean force [x, y, z] in place of a log, N; map and force_on apply as to columns Fx, Fy, Fz",
    )
    mean_error_n: Annotated[Point | None, Key(unset="unknown")] = Field(
        default=None, description="standard errors of mean_force_n, N"
    )
    job: FilePath | None = Field(
        default=None, description="job file in place of direction, depths, speed, feed and tool; it is replayed"
    )


class CutEngagement(Table):
    """Direction, depths, speed and feed of a straight cut."""

    direction: Direction | None = Field(
        default=None,
        description="slot, up (conventional) milling with the stock on the +y side of the tool axis, or down (climb) "
        "milling with it on the -y side; feed along +x, M3",
    )
    axial_depth_mm: float | None = Field(default=None, gt=0.0, description="axial depth of cut, mm")
    radial_depth_mm: Annotated[float | None, Key(unset="the diameter, for a slot")] = Field(
        default=None, gt=0.0, description="radial depth of cut, at most the tool's nominal diameter, mm"
    )
    spindle_rpm: float | None = Field(default=None, gt=0.0, description="spindle speed, rpm")
    feed_mm_min: float | None = Field(default=None, gt=0.0, description="feed rate, mm/min")


class Shared(LogReading, CutEngagement):
    """Keys of one cut that `[defaults]` may give for all cuts: engagement, how the log is read, and its steady part."""

    window_s: Annotated[Window | None, Key(unset="detected")] = Field(
        default=None, description="[from, to]: the steady cut, in the log's time, s"
    )
    air_s: Annotated[Windows | None, Key(unset="detected")] = Field(
        default=None, description="[[from, to], ...]: parts of the log without cutting, s"
    )
    zero: Literal["auto", "line", "constant", "none"] = Field(
        default="auto",
        description="amplifier zero to subtract: line or constant fitted to the air, or none; auto is line with air on "
        "both sides of the cut, constant with air on one side, none without air",
    )


class Cut(Shared, CutSource):
    """One test cut."""

    run_window_s: Annotated[Window | None, Key(unset="where it cuts")] = Field(
        default=None, description="[from, to]: the part of the job's run to use, machine time, s"
    )
    lag_s: Annotated[float | None, Key(unset="found by cross-correlation")] = Field(
        default=None, description="delay of the log: its time minus the machine time of the job's run, s"
    )
    spindle_angle_deg: Annotated[float | None, Key(unset="found")] = Field(
        default=None, description="angle of tooth 0 at the log's time 0, measured from +x in the direction of rotation"
    )
    holdout: bool = Field(default=False, description="keep this cut out of the fit, and report its errors")


class CutsFile(Table):
    """Test cuts with one tool in one material."""

    tool: CutTool | None = Field(
        default=None, description="the tool, keys as in a job; not needed if all cuts are jobs"
    )
    defaults: Shared = Field(default_factory=Shared, description="keys for all cuts that do not give them")
    fit: Fit = Field(default_factory=Fit, description="method and weights of the fit")
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
