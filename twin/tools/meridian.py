"""The numbers of a tool's meridian by name, as kernels take them."""

from __future__ import annotations

from typing import NamedTuple


class Meridian(NamedTuple):
    """Flat bottom, corner arc, then a cylinder or cone; see `twin.tools.shape.ToolShape`.

    Attributes:
        disc: radius of the flat bottom, mm.
        corner: radius of the corner arc, mm.
        tangent: tangent of the taper half angle, 0 for a cylinder.
        arc_radius, arc_height: where the corner arc meets the wall, mm.
        height, radius: top of the cutting part and largest radius, mm.
    """

    disc: float
    corner: float
    tangent: float
    arc_radius: float
    arc_height: float
    height: float
    radius: float
