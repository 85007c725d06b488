"""Values given in addition to an NC program: options of ``twin job`` and ``twin replay``, keywords of Python."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from twin.settings.table import FilePath, Key, Table


class DraftSettings(Table):
    """Values for a job that is drafted from an NC program; lengths in mm."""

    material: Annotated[str | None, Key(metavar="NAME", unset="no forces")] = Field(
        default=None,
        description="material of the workpiece, for the cutting coefficients; twin materials lists the names",
    )
    tools: Annotated[FilePath | None, Key(metavar="LIBRARY", unset="the program's comments")] = Field(
        default=None, description="tool library in which the program's tool numbers are looked up"
    )
    stock: Annotated[str | None, Key(metavar="STOCK", unset="around the cutting motions")] = Field(
        default=None,
        description="stock: 'box X Y Z', 'cylinder D H' or the name of an STL file; a box or a cylinder is centred "
        "over the cutting motions, with its top where cutting begins, or 'at X Y Z': centre in X and Y, top in Z",
    )
    margin_mm: float = Field(
        default=0.0, ge=0.0, description="stock around the cutting motions on each side; not with a stock that is given"
    )
    pitch_mm: Annotated[float | None, Key(unset="to suit tools and program")] = Field(
        default=None, gt=0.0, description="distance between the slices of the workpiece"
    )
    angle_step_deg: Annotated[float | None, Key(unset="to suit the program")] = Field(
        default=None, gt=0.0, le=360.0, description="spindle angle between force samples"
    )
    dialect: Literal["auto", "fanuc", "haas", "linuxcnc", "grbl"] = Field(
        default="auto", description="control that the program is written for; auto takes the likeliest"
    )
    tool: Annotated[int | None, Key(metavar="N", unset="from the program")] = Field(
        default=None, ge=0, description="tool in the spindle when the program starts"
    )
    m_codes: Annotated[tuple[int, ...], Key(options=("--m-code",), metavar="N")] = Field(
        default=(), description="number of an M code of the machine builder that moves nothing"
    )
