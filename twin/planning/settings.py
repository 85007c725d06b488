"""Parameters of tool paths and reach analyses: keys of a TOML file, options of a command, keywords of a function."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import Field, Strict, model_validator

from twin.settings.table import Key, Table
from twin.workpiece.solids.units import Unit

Corners: TypeAlias = Annotated[tuple[float, float, float, float], Strict(False)]
BoxCorners: TypeAlias = Annotated[tuple[float, float, float, float, float, float], Strict(False)]


class PathSettings(Table):
    """Parameters of a tool path; lengths in mm, feeds in mm/min."""

    strategy: Literal["contour", "scan"] = Field(description="contour: levels of constant height; scan: parallel rows")
    tool: Annotated[str, Key(metavar="TOOL")] = Field(description="tool: 'ball 8', 'flat 10', 'bull 12 r2'")
    unit: Unit = Field(default="mm", description="unit of the STL file; auto: the one in which its size is plausible")
    pitch_mm: float = Field(default=0.1, gt=0.0, description="distance between the part's slices")
    tolerance_mm: float = Field(
        default=0.02, gt=0.0, description="required accuracy; a pitch that may be too coarse for it gives a warning"
    )
    exact: Annotated[bool, Key(options=("--exact/--slices",))] = Field(
        default=False, description="scan: rows by drop-cutter on the triangles (exact), else from slices"
    )
    stepover_mm: float = Field(default=0.5, gt=0.0, description="scan: stepover, the distance between rows")
    allowance_mm: float = Field(default=0.0, ge=0.0, description="allowance: stock to leave on the part")
    layers: int = Field(
        default=1, ge=0, description="number of roughing layers; contour: 0 for as many as it takes to clear the stock"
    )
    axial_depth_mm: float = Field(
        default=1.0, gt=0.0, description="axial depth of cut: step-down between layers (scan) or levels (contour)"
    )
    radial_depth_mm: Annotated[float | None, Key(unset="0.4 of the diameter")] = Field(
        default=None, gt=0.0, description="contour: radial depth of cut, the distance between layers"
    )
    direction: Literal["x", "y"] = Field(default="x", description="scan: axis along which the rows run")
    zigzag: Annotated[bool, Key(options=("--zigzag/--one-way",))] = Field(
        default=True, description="scan: zigzag rows, or all rows in one direction"
    )
    climb: Annotated[bool, Key(options=("--climb/--conventional",))] = Field(
        default=True, description="climb or conventional milling"
    )
    region_mm: Annotated[
        Corners | None, Key(metavar="X0 Y0 X1 Y1", unset="scan: the part's box, contour: the stock's")
    ] = Field(default=None, description="boundary that the tool axis stays in: x0, y0, x1, y1")
    overhang_mm: Annotated[float | None, Key(unset="scan: 0, contour: the tool radius")] = Field(
        default=None, ge=0.0, description="how far the tool axis may go beyond the boundary"
    )
    floor_z_mm: Annotated[float | None, Key(unset="the part's lowest point")] = Field(
        default=None, description="lowest Z of the tool tip"
    )
    stock_mm: Annotated[BoxCorners | None, Key(metavar="X0 Y0 Z0 X1 Y1 Z1", unset="the part's box")] = Field(
        default=None, description="box of stock: x0, y0, z0, x1, y1, z1"
    )
    remaining_mm: Annotated[float | None, Key(unset="all of the stock")] = Field(
        default=None, ge=0.0, description="thickness of rest material on the part before this path"
    )
    feed_mm_min: float = Field(default=600.0, gt=0.0, description="cutting feed")
    plunge_mm_min: Annotated[float, Key(options=("--plunge-feed",))] = Field(
        default=200.0, gt=0.0, description="feed in plunges, ramps and helices"
    )
    link_mm_min: Annotated[float | None, Key(options=("--link-feed",), unset="the cutting feed")] = Field(
        default=None, gt=0.0, description="feed in links along the surface between passes"
    )
    lead_mm_min: Annotated[float | None, Key(options=("--lead-feed",), unset="the cutting feed")] = Field(
        default=None, gt=0.0, description="feed in lead-ins and lead-outs"
    )
    spindle_rpm: float = Field(default=3600.0, gt=0.0, description="spindle speed")
    safe_z_mm: Annotated[float | None, Key(unset="5 mm above the stock")] = Field(
        default=None, description="Z of rapids, in part coordinates"
    )
    clearance_mm: float = Field(
        default=1.0,
        gt=0.0,
        description="height above the material at which a rapid down ends and the plunge feed begins",
    )
    stay_down_mm: Annotated[float | None, Key(unset="3 stepovers or radial depths")] = Field(
        default=None, ge=0.0, description="longest link along the surface between passes; longer ones retract"
    )
    low_links: bool = Field(
        default=False,
        description="rapid at clearance above the rest material, where it is known, instead of at the safe Z",
    )
    entry: Literal["plunge", "ramp", "helix"] = Field(default="ramp", description="type of entry into material")
    ramp_deg: Annotated[float, Key(options=("--ramp-angle",))] = Field(
        default=3.0, gt=0.0, lt=90.0, description="steepest angle of ramps and helices"
    )
    helix_mm: Annotated[float | None, Key(options=("--helix-radius",), unset="0.4 of the diameter")] = Field(
        default=None, gt=0.0, description="radius of helices"
    )
    lead_mm: float = Field(default=0.0, ge=0.0, description="lead-in/lead-out radius, 0 for none")
    thin_mm: float = Field(default=0.0002, ge=0.0, description="points this close to a chord are omitted; 0 keeps all")
    arcs_mm: Annotated[float | None, Key(unset="no arcs")] = Field(
        default=None, gt=0.0, description="tolerance for fitting arcs"
    )
    gouge_mm: float = Field(
        default=0.0005, ge=0.0, description="largest deviation towards the part from omitting points and fitting arcs"
    )
    tool_number: int = Field(default=1, ge=1, description="tool number for the T and H words")
    teeth: int = Field(default=2, ge=1, le=100, description="number of flutes, for the job file")
    coolant: Literal["off", "mist", "flood"] = Field(default="flood", description="coolant")
    dialect: Literal["fanuc", "haas", "linuxcnc", "grbl"] = Field(default="fanuc", description="control")
    decimals: int = Field(default=4, ge=1, le=6, description="decimal places of coordinates")
    program_number: Annotated[int | None, Key(unset="none")] = Field(
        default=None, ge=1, description="program number (O word) for FANUC and Haas"
    )

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


class ReachSettings(Table):
    """Parameters of a reach analysis; lengths in mm."""

    tools: Annotated[
        tuple[str, ...], Strict(False), Key(options=("--tool",), metavar="TOOL", unset="none, if `largest` is set")
    ] = Field(default=(), description="tools: 'ball 8', 'flat 10', 'bull 12 r2'")
    unit: Unit = Field(default="mm", description="unit of the STL file; auto: the one in which its size is plausible")
    pitch_mm: Annotated[float | None, Key(unset="longest side / 600, or largest tool / 500 if more")] = Field(
        default=None, gt=0.0, description="largest distance between the part's slices"
    )
    thin_mm: Annotated[float | None, Key(unset="the resolution of the slices")] = Field(
        default=None, ge=0.0, description="uncut material thinner than this is ignored"
    )
    above: Annotated[bool, Key(options=("--above",))] = Field(
        default=False, description="ball tools reach the part from above only, not from any side"
    )
    largest: Annotated[bool, Key(options=("--largest",))] = Field(
        default=False, description="find the largest ball tool that finishes the part"
    )
