"""What a tool path is made with: options of the command line, or keys of a TOML file."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, Strict, ValidationError, model_validator

from twin.errors import ToolPathError
from twin.settings.problems import problems_of

Corners = Annotated[tuple[float, float, float, float], Strict(False)]
Box = Annotated[tuple[float, float, float, float, float, float], Strict(False)]


class PathSettings(BaseModel):
    """A tool path's parameters; lengths mm, feeds mm/min."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", allow_inf_nan=False)

    strategy: Literal["contour", "scan"] = Field(description="contour: levels of equal height; scan: parallel rows")
    tool: str = Field(description="tool, as 'ball 8', 'flat 10', 'bull 12 r2'")
    pitch_mm: float = Field(default=0.1, gt=0.0, description="distance of the part's slices")
    tolerance_mm: float = Field(default=0.02, gt=0.0, description="accuracy wanted; a pitch too coarse for it is told")
    exact: bool = Field(default=False, description="scan: rows from the triangles, by drop-cutter, not from slices")
    stepover_mm: float = Field(default=0.5, gt=0.0, description="scan: distance of the rows")
    allowance_mm: float = Field(default=0.0, ge=0.0, description="material to leave on the part")
    layers: int = Field(default=1, ge=0, description="layers of roughing; contour: 0 for as many as clear the stock")
    axial_depth_mm: float = Field(
        default=1.0, gt=0.0, description="scan: depth of a layer; contour: distance of the levels"
    )
    radial_depth_mm: float | None = Field(
        default=None, gt=0.0, description="contour: distance of the layers; 0.4 of the diameter if not given"
    )
    direction: Literal["x", "y"] = Field(default="x", description="scan: axis that rows run along")
    zigzag: bool = Field(default=True, description="scan: rows to and fro, else all one way")
    climb: bool = Field(default=True, description="climb milling, else conventional")
    region_mm: Corners | None = Field(
        default=None, description="[x0, y0, x1, y1]: where the tip may be; scan: the part's box, contour: the stock's"
    )
    overhang_mm: float | None = Field(
        default=None, ge=0.0, description="how far the tip may go beyond it; scan: 0, contour: the tool's radius"
    )
    floor_z_mm: float | None = Field(default=None, description="lowest tip; the part's lowest point if not given")
    stock_mm: Box | None = Field(
        default=None, description="[x0, y0, z0, x1, y1, z1]: the stock; the part's box if not given"
    )
    remaining_mm: float | None = Field(
        default=None, ge=0.0, description="material left on the part before; all of the stock if not given"
    )
    feed_mm_min: float = Field(default=600.0, gt=0.0, description="feed of cuts")
    plunge_mm_min: float = Field(default=200.0, gt=0.0, description="feed down: plunges, ramps, helices")
    link_mm_min: float | None = Field(default=None, gt=0.0, description="feed along the surface between passes")
    lead_mm_min: float | None = Field(default=None, gt=0.0, description="feed of leads")
    spindle_rpm: float = Field(default=3600.0, gt=0.0, description="spindle speed")
    safe_z_mm: float | None = Field(default=None, description="height of rapids; 5 mm above the stock if not given")
    clearance_mm: float = Field(default=1.0, gt=0.0, description="above material, where rapids end")
    stay_down_mm: float | None = Field(
        default=None, ge=0.0, description="longest way between passes along the surface; suits the step if not given"
    )
    low_links: bool = Field(default=False, description="rapids at clearance above what is left, where it is known")
    entry: Literal["plunge", "ramp", "helix"] = Field(default="ramp", description="way into material")
    ramp_deg: float = Field(default=3.0, gt=0.0, lt=90.0, description="steepest ramp and helix")
    helix_mm: float | None = Field(default=None, gt=0.0, description="radius of helices; 0.4 of the diameter")
    lead_mm: float = Field(default=0.0, ge=0.0, description="radius of leads, 0 for none")
    thin_mm: float = Field(default=0.0002, ge=0.0, description="points this near to a chord are left out; 0 keeps all")
    arcs_mm: float | None = Field(default=None, gt=0.0, description="tolerance of arcs; none are fitted if not given")
    gouge_mm: float = Field(default=0.0005, ge=0.0, description="how much of either may lie towards the material")
    tool_number: int = Field(default=1, ge=1, description="T and H word")
    teeth: int = Field(default=2, ge=1, le=100, description="number of flutes, for the job file")
    coolant: Literal["off", "mist", "flood"] = Field(default="flood", description="coolant")
    dialect: Literal["fanuc", "haas", "linuxcnc", "grbl"] = Field(default="fanuc", description="control")
    decimals: int = Field(default=4, ge=1, le=6, description="digits after the point of coordinates")
    program_number: int | None = Field(default=None, ge=1, description="O word, FANUC and Haas")

    @model_validator(mode="after")
    def _consistent(self) -> PathSettings:
        for name, box in (("region_mm", self.region_mm), ("stock_mm", self.stock_mm)):
            if box is not None and not all(a < b for a, b in zip(box, box[len(box) // 2 :], strict=False)):
                raise ValueError(f"{name} must have its lower corner first, got {list(box)}")
        if self.strategy == "contour" and self.exact:
            raise ValueError("exact is for scans; a contour is made from slices")
        if self.strategy == "scan" and self.layers == 0:
            raise ValueError("layers must be at least 1 for a scan, got 0")
        if self.strategy == "scan" and self.stepover_mm < self.thin_mm:
            raise ValueError(f"stepover_mm must be above thin_mm, got {self.stepover_mm}")
        return self


def settings_of(values: Mapping[str, Any], source: str) -> PathSettings:
    """Settings from keys and values.

    Args:
        source: file, or what else to name in messages.

    Raises:
        ToolPathError: every mistake, one line each.
    """
    try:
        return PathSettings.model_validate(values)
    except ValidationError as error:
        found = error.errors(include_url=False)
        texts = [str(p) for p in problems_of([e for e in found if e["loc"]], PathSettings)]
        texts += [e["msg"].removeprefix("Value error, ") for e in found if not e["loc"]]
        raise ToolPathError("\n".join(f"{source}: {text}" for text in texts)) from None


def read_settings(path: Path) -> dict[str, Any]:
    """Keys and values of a TOML file; they are checked with all others by `settings_of`.

    Raises:
        ToolPathError: the file cannot be read, or is no TOML.
    """
    try:
        return tomllib.loads(path.read_text("utf-8"))
    except OSError as error:
        raise ToolPathError(f"{path}: cannot be read: {error.strerror}; expected a TOML file") from error
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ToolPathError(f"{path}: no valid TOML: {error}") from error
