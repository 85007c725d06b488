"""Points of a tool's meridian; compiled, because every step needs many of them."""

from __future__ import annotations

import math

from twin.arrays import FloatArray
from twin.jit import njit


@njit
def meridian_points(s: FloatArray, disc: float, corner: float, taper: float, out: FloatArray) -> None:
    """Radius, height and kappa at lengths along the meridian from the axis.

    Args:
        s: shape (n,), lengths over the flat bottom, the corner arc, the wall.
        out: shape (3, n).
    """
    arc = corner * (0.5 * math.pi - taper)
    sin_t, cos_t = math.sin(taper), math.cos(taper)
    wall_radius = disc + corner * cos_t
    wall_height = corner * (1.0 - sin_t)
    for i in range(len(s)):
        on_arc = s[i] - disc
        if on_arc < 0.0:
            out[0, i], out[1, i], out[2, i] = s[i], 0.0, 0.0
        elif on_arc < arc:
            kappa = on_arc / corner
            out[0, i] = disc + corner * math.sin(kappa)
            out[1, i] = corner * (1.0 - math.cos(kappa))
            out[2, i] = kappa
        else:
            out[0, i] = wall_radius + (on_arc - arc) * sin_t
            out[1, i] = wall_height + (on_arc - arc) * cos_t
            out[2, i] = 0.5 * math.pi - taper
