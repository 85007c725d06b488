"""The tool as a convex body of revolution, described by its meridian: radius r(z) and normal angle kappa(z).

All kinds are one family: a flat bottom disc, a corner arc, then a wall that is a cylinder or a cone.

    flat   disc R,      arc 0,  cylinder        ball   disc 0,       arc R,  cylinder
    bull   disc R - rc, arc rc, cylinder        taper  disc R - rc,  arc rc, cone of half angle beta

z is the height above the tip, kappa the angle between the outward normal and the tool axis: 0 where the normal points
down (the tip of a ball), 90 degrees on a cylinder (the tri-slice paper's section 3.3).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from twin.arrays import FloatArray
from twin.errors import ToolError
from twin.tools.meridian import Meridian

ToolKind: TypeAlias = Literal["flat", "ball", "bull", "taper"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolShape:
    """Meridian of the cutting part of a tool.

    Attributes:
        disc_mm: radius of the flat bottom.
        corner_radius_mm: radius of the corner arc, 0 for a sharp corner.
        taper_rad: half angle of the wall, 0 for a cylinder.
        height_mm: height of the cutting part above the tip (flute length).

    Raises:
        ToolError: a size that is not finite and positive, or a corner arc higher than the flutes.
    """

    disc_mm: float
    corner_radius_mm: float
    taper_rad: float = 0.0
    height_mm: float

    def __post_init__(self) -> None:
        for name in ("disc_mm", "corner_radius_mm", "taper_rad", "height_mm"):
            value = getattr(self, name)
            if not math.isfinite(value) or value < 0.0:
                raise ToolError(f"tool shape: {name} = {value}, expected a finite number not below 0")
        if self.disc_mm + self.corner_radius_mm <= 0.0 or self.height_mm <= 0.0:
            raise ToolError("tool shape: diameter and flute length must be greater than 0")
        if self.taper_rad >= 0.5 * math.pi:
            raise ToolError(f"tool shape: taper half angle {math.degrees(self.taper_rad)} deg, expected below 90")
        if self.arc_height_mm > self.height_mm * (1.0 + 1e-12):
            raise ToolError(
                f"tool shape: the corner arc ends {self.arc_height_mm} mm above the tip, "
                f"expected not above the flute length {self.height_mm} mm"
            )

    @property
    def arc_height_mm(self) -> float:
        """Height where the corner arc meets the wall."""
        return self.corner_radius_mm * (1.0 - math.sin(self.taper_rad))

    @property
    def arc_radius_mm(self) -> float:
        """Radius where the corner arc meets the wall."""
        return self.disc_mm + self.corner_radius_mm * math.cos(self.taper_rad)

    @property
    def max_radius_mm(self) -> float:
        """Largest radius, at the top of the cutting part."""
        return self.arc_radius_mm + (self.height_mm - self.arc_height_mm) * math.tan(self.taper_rad)

    @property
    def nominal_radius_mm(self) -> float:
        """Half the tool's nominal diameter: disc plus corner arc."""
        return self.disc_mm + self.corner_radius_mm

    @property
    def meridian(self) -> Meridian:
        """The form that kernels take."""
        return Meridian(
            disc=float(self.disc_mm),
            corner=float(self.corner_radius_mm),
            tangent=math.tan(self.taper_rad),
            arc_radius=float(self.arc_radius_mm),
            arc_height=float(self.arc_height_mm),
            height=float(self.height_mm),
            radius=float(self.max_radius_mm),
        )

    @property
    def parameters(self) -> FloatArray:
        """Shape (7,): disc, corner, tan(taper), arc radius, arc height, height, largest radius; mm."""
        return np.array(
            [
                self.disc_mm,
                self.corner_radius_mm,
                math.tan(self.taper_rad),
                self.arc_radius_mm,
                self.arc_height_mm,
                self.height_mm,
                self.max_radius_mm,
            ]
        )

    def circumscribed(self, chord_mm: float) -> ToolShape:
        """The shape enlarged sideways by a chord tolerance; its curves are offset outwards, its bottom is not.

        The corner arc keeps its centre and grows in radius; what would reach below the tip's plane is cut off there,
        so that floors stay exact.
        """
        if self.corner_radius_mm == 0.0:
            return ToolShape(
                disc_mm=self.disc_mm + chord_mm,
                corner_radius_mm=0.0,
                taper_rad=self.taper_rad,
                height_mm=self.height_mm,
            )
        return ToolShape(
            disc_mm=self.disc_mm,
            corner_radius_mm=self.corner_radius_mm + chord_mm,
            taper_rad=self.taper_rad,
            height_mm=self.height_mm + chord_mm,
        )

    def inscribed(self, inset_mm: float) -> ToolShape | None:
        """The shape that lies ``inset_mm`` inside this one, from ``inset_mm`` above its tip up to its top.

        Returns:
            None where the tool is too small for that.
        """
        corner = max(0.0, self.corner_radius_mm - inset_mm)
        disc = self.disc_mm - max(0.0, inset_mm - self.corner_radius_mm)
        height = self.height_mm - inset_mm
        if disc < 0.0 or disc + corner <= 0.0 or height <= corner * (1.0 - math.sin(self.taper_rad)):
            return None
        return ToolShape(disc_mm=disc, corner_radius_mm=corner, taper_rad=self.taper_rad, height_mm=height)

    def radius_mm(self, z_mm: ArrayLike) -> FloatArray:
        """Radius r(z) at heights above the tip; heights are clipped to [0, height]."""
        z = np.clip(np.asarray(z_mm, dtype=np.float64), 0.0, self.height_mm)
        arc = self.disc_mm + np.sqrt(np.maximum(0.0, self.corner_radius_mm**2 - (self.corner_radius_mm - z) ** 2))
        wall = self.arc_radius_mm + (z - self.arc_height_mm) * math.tan(self.taper_rad)
        return np.asarray(np.where(z < self.arc_height_mm, arc, wall))

    def kappa_rad(self, z_mm: ArrayLike) -> FloatArray:
        """Angle kappa(z) between the outward normal and the tool axis, 0 at a ball's tip."""
        z = np.asarray(z_mm, dtype=np.float64)
        wall = 0.5 * math.pi - self.taper_rad
        if self.corner_radius_mm == 0.0:
            return np.full(z.shape, wall)
        arc = np.arccos(np.clip(1.0 - z / self.corner_radius_mm, -1.0, 1.0))
        return np.asarray(np.where(z < self.arc_height_mm, arc, wall))

    def profile_mm(self, chord_mm: float = 0.01) -> FloatArray:
        """Polyline of the meridian from the axis at the tip to the top, shape (n, 2): radius and height."""
        points = [(0.0, 0.0)] if self.disc_mm > 0.0 else []
        if self.corner_radius_mm > 0.0:
            end = 0.5 * math.pi - self.taper_rad
            n = max(2, math.ceil(end / (2.0 * math.acos(max(0.0, 1.0 - chord_mm / self.corner_radius_mm)) + 1e-12)))
            for i in range(n + 1):
                kappa = end * i / n
                radius = self.disc_mm + self.corner_radius_mm * math.sin(kappa)
                points.append((radius, self.corner_radius_mm * (1.0 - math.cos(kappa))))
        else:
            points.append((self.disc_mm, 0.0))
        if self.height_mm > self.arc_height_mm:
            points.append((self.max_radius_mm, self.height_mm))
        return np.array(points)


def tool_shape(
    kind: ToolKind,
    diameter_mm: float,
    flute_length_mm: float,
    corner_radius_mm: float = 0.0,
    taper_deg: float = 0.0,
) -> ToolShape:
    """The shape of a catalogue tool.

    Args:
        kind: ``flat``, ``ball``, ``bull`` (needs a corner radius) or ``taper`` (needs a half angle; the diameter is
            that of the tip, where corner arc or bottom edge would meet a cylinder).
        diameter_mm: nominal diameter.
        flute_length_mm: height of the cutting part above the tip.
        corner_radius_mm: corner radius of a bull or taper tool.
        taper_deg: half angle of a taper tool.

    Raises:
        ToolError: corner radius larger than half the diameter, or a shape that `ToolShape` refuses.
    """
    radius = 0.5 * diameter_mm
    corner = {"flat": 0.0, "ball": radius}.get(kind, corner_radius_mm)
    if corner > radius:
        raise ToolError(f"tool shape: corner_radius_mm = {corner}, expected at most half the diameter, {radius}")
    taper = math.radians(taper_deg) if kind == "taper" else 0.0
    return ToolShape(disc_mm=radius - corner, corner_radius_mm=corner, taper_rad=taper, height_mm=flute_length_mm)
