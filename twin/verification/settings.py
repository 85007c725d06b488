"""Tolerances of a verification: keys of a TOML file, options of ``twin verify``, keywords of `verify`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, Strict, model_validator

from twin.settings.table import Key, Table
from twin.workpiece.solids.units import Unit


class VerifySettings(Table):
    """Tolerances and extent of a verification; lengths in mm."""

    unit: Unit = Field(default="mm", description="unit of the STL file; auto: the one in which its size is plausible")
    tolerance_mm: float = Field(default=0.02, gt=0.0, description="permitted depth of gouges")
    excess_mm: Annotated[float | None, Key(unset="the tolerance")] = Field(
        default=None, gt=0.0, description="permitted height of excess material, e.g. allowance and scallops"
    )
    region_mm: Annotated[
        tuple[float, float, float, float] | None,
        Strict(False),
        Key(metavar="X0 Y0 X1 Y1", unset="the design's box"),
    ] = Field(default=None, description="region to verify: x0, y0, x1, y1")
    pitch_mm: Annotated[float | None, Key(unset="the job's")] = Field(
        default=None, gt=0.0, description="distance between slices in the replay"
    )

    @model_validator(mode="after")
    def _region_has_an_extent(self) -> VerifySettings:
        region = self.region_mm
        if region is not None and not (region[0] < region[2] and region[1] < region[3]):
            raise ValueError(f"region_mm must have its lower corner first, got {list(region)}")
        return self
