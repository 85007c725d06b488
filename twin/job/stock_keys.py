"""The keys of a job's stock."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import ConfigDict, Field, Strict

from twin.settings.table import FilePath, Key, Point, Table

#: The keys of a stock, of which one is given.
STOCKS = ("box_mm", "cylinder_mm", "stl")
WorkOffset: TypeAlias = Annotated[
    str,
    Field(pattern=r"^(G5[4-9]|G59\.[123]|G54\.1 P([1-9]|[1-9]\d|[12]\d\d|300))$"),
    Key(expected="G54 to G59, G59.1 to G59.3, or G54.1 P1 to P300"),
]


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

    box_mm: Box | None = Field(default=None, description="box: { min = [x, y, z], max = [x, y, z] }, mm")
    cylinder_mm: Cylinder | None = Field(
        default=None, description='cylinder: { axis = "z", centre = [x, y], diameter = 50, min = -20, max = 0 }, mm'
    )
    stl: FilePath | None = Field(
        default=None, description="STL file of a closed solid, relative to the job file's folder"
    )
    unit: Literal["mm", "inch", "m"] = Field(default="mm", description="unit of the STL file")
    stl_scale: float = Field(default=1.0, gt=0.0, description="further factor on the STL file's points")
    offset_mm: Point = Field(default=(0.0, 0.0, 0.0), description="shift of the STL file's points after scaling, mm")
    wcs: WorkOffset = Field("G54", description="work offset in which the stock's coordinates are given")
