"""Structuring elements: the bodies that a part is inflated with, by their sections at a distance.

Two kinds. A centred ball is the element of the tri-slice paper: its reference point is its centre, and it is its own
mirror image. A tool has its tip as reference point; the part is inflated with the tool upside down, so that the
inflated part is exactly what the tip must stay out of. Tools are taken to reach up without end, with the radius of
their shank: what lies below an overhang is out of reach.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from twin.arrays import FloatArray
from twin.errors import ToolError
from twin.tools.shape import ToolShape


@dataclass(frozen=True, slots=True, kw_only=True)
class StructuringElement:
    """A ball about its centre, or an end mill above its tip.

    Attributes:
        disc_mm: radius of the flat bottom, 0 for balls.
        corner_radius_mm: radius of the corner arc, 0 for flat tools.
        drop_mm: how far the body reaches below its reference point: the radius of a centred ball, the allowance of a
            tool.
        centred: whether this is a ball about its centre; it ends at the top as it does at the bottom.
    """

    disc_mm: float
    corner_radius_mm: float
    drop_mm: float
    centred: bool

    def __post_init__(self) -> None:
        for name in ("disc_mm", "corner_radius_mm"):
            value = getattr(self, name)
            if not math.isfinite(value) or value < 0.0:
                raise ToolError(f"structuring element: {name} = {value}, expected a finite number not below 0")
        if self.radius_mm <= 0.0:
            raise ToolError("structuring element: radius 0 mm, expected a number above 0")

    @classmethod
    def ball(cls, radius_mm: float) -> StructuringElement:
        """A ball; its reference point is its centre."""
        return cls(disc_mm=0.0, corner_radius_mm=radius_mm, drop_mm=radius_mm, centred=True)

    @classmethod
    def tool(cls, shape: ToolShape) -> StructuringElement:
        """A ball, flat or bull-nose end mill; its reference point is its tip.

        Raises:
            ToolError: a taper, which has no end upwards.
        """
        if shape.taper_rad > 0.0:
            raise ToolError("offsets with taper tools: not possible; expected a ball, flat or bull-nose tool")
        return cls(disc_mm=shape.disc_mm, corner_radius_mm=shape.corner_radius_mm, drop_mm=0.0, centred=False)

    def with_allowance(self, allowance_mm: float) -> StructuringElement:
        """The element inflated by a ball, so that this much is left on the part everywhere.

        Raises:
            ToolError: a negative allowance larger than the corner arc.
        """
        if self.corner_radius_mm + allowance_mm < 0.0:
            raise ToolError(
                f"allowance {allowance_mm:g} mm; "
                f"expected not below {0.0 - self.corner_radius_mm:g}, the tool's corner radius"
            )
        return StructuringElement(
            disc_mm=self.disc_mm,
            corner_radius_mm=self.corner_radius_mm + allowance_mm,
            drop_mm=self.drop_mm + allowance_mm,
            centred=self.centred,
        )

    @property
    def radius_mm(self) -> float:
        """Largest radius."""
        return self.disc_mm + self.corner_radius_mm

    def z_radii_mm(self, above_mm: FloatArray) -> FloatArray:
        """Radius that a section must be inflated by on a plane normal to z that is this far below it (eq. 1).

        Args:
            above_mm: height of sections above the plane.

        Returns:
            shape of ``above_mm``; NaN where the section does not reach the plane.
        """
        height = np.asarray(above_mm, dtype=np.float64) + self.drop_mm
        below = self.corner_radius_mm - height
        arc = self.disc_mm + np.sqrt(np.maximum(0.0, self.corner_radius_mm**2 - below**2))
        top = np.where(below >= 0.0, arc, arc if self.centred else self.radius_mm)
        gone = (height < 0.0) | ((height > 2.0 * self.corner_radius_mm) if self.centred else False)
        return np.asarray(np.where(gone, np.nan, top))

    def ball_radii_mm(self, distance_mm: FloatArray) -> FloatArray:
        """Radius sqrt(r^2 - d^2) of a centred ball's section at a distance (eq. 1), NaN beyond r."""
        left = self.corner_radius_mm**2 - np.asarray(distance_mm, dtype=np.float64) ** 2
        return np.asarray(np.where(left < 0.0, np.nan, np.sqrt(np.maximum(left, 0.0))))
