"""Where a dropped tool touches, by nothing but the definition: the largest z - h(r) over all points of a triangle.

h is the meridian of `ToolShape.profile` read anew here; the function is concave on a triangle, so that a golden section
in a golden section finds its maximum. Slow, and nothing in common with the kernels.
"""

from __future__ import annotations

import math

import numpy as np

from twin.arrays import FloatArray
from twin.tools.shape import ToolShape

_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
#: Narrows 10 mm to 4e-8 mm.
_STEPS = 40
#: Slope at which the tool's underside goes on beyond its radius, steeper than any face of a test.
_BEYOND = 1e6


def underside(tool: ToolShape, rho: FloatArray) -> FloatArray:
    """Height above the tip at a distance from the axis; a steep cone beyond the radius keeps it convex."""
    off = np.minimum(np.maximum(rho - tool.disc_mm, 0.0), tool.corner_radius_mm)
    height = tool.corner_radius_mm - np.sqrt(tool.corner_radius_mm**2 - off**2)
    if tool.taper_rad > 0.0:
        wall = tool.arc_height_mm + (rho - tool.arc_radius_mm) / math.tan(tool.taper_rad)
        height = np.where(rho > tool.arc_radius_mm, wall, height)
    over = rho - tool.max_radius_mm
    edge = tool.height_mm if tool.taper_rad > 0.0 else tool.corner_radius_mm
    return np.where(over > 0.0, edge + _BEYOND * over, height)


def dropped(triangles: FloatArray, tool: ToolShape, points: FloatArray, floor: float) -> FloatArray:
    """Tip heights over points, shape (..., m, 2), by triangles, shape (..., n, 3, 3)."""
    corner = np.moveaxis(triangles, (-2, -1), (0, 1))[..., None]
    begin, along, across = corner[0], corner[1] - corner[0], corner[2] - corner[0]
    at = np.moveaxis(points, -1, 0)[..., None, :]
    begin = np.stack(np.broadcast_arrays(begin[0] - at[0], begin[1] - at[1], begin[2]))
    shape = begin.shape[1:]

    def over_v(u: FloatArray) -> FloatArray:
        x, y, z = begin + u * along

        def value(v: FloatArray) -> FloatArray:
            return z + v * across[2] - underside(tool, np.hypot(x + v * across[0], y + v * across[1]))

        return largest(value, np.zeros(shape), 1.0 - u)

    best = largest(over_v, np.zeros(shape), np.ones(shape)).max(axis=-2)
    return np.maximum(best, floor)


def largest(f, low: FloatArray, high: FloatArray) -> FloatArray:  # type: ignore[no-untyped-def]
    """Maximum of concave functions between bounds, elementwise."""
    best = np.maximum(f(low), f(high))
    a, b = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    fa, fb = f(a), f(b)
    for _ in range(_STEPS):
        left = fa >= fb
        low, high = np.where(left, low, a), np.where(left, b, high)
        a, b = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        best = np.maximum(best, np.maximum(fa, fb))
        fa, fb = f(a), f(b)
    return np.maximum(best, np.maximum(fa, fb))
