"""The meridian of a tool as kernels take it: height, radius, slope, where it rests on a slope, its points; compiled."""

from __future__ import annotations

import math

from twin.arrays import FloatArray
from twin.jit import helper, njit
from twin.tools.meridian import Meridian

#: Largest number of Newton steps, and the relative change at which they end.
_MOST_STEPS, _CONVERGED = 80, 1e-9
#: Least square of a radius in a corner, mm2, where its derivative is computed.
_LEAST = 1e-24


@helper
def is_ball(tool: Meridian) -> bool:
    """Whether the lower side is a hemisphere below a cylinder."""
    return tool.disc == 0.0 and tool.tangent == 0.0


@helper
def is_flat(tool: Meridian) -> bool:
    """Whether the tool is a cylinder with a sharp corner."""
    return tool.corner == 0.0 and tool.tangent == 0.0


@helper
def profile_height(tool: Meridian, rho: float) -> float:
    """Height h(rho) of the tool's lower surface above the tip at a distance from the axis, at most the radius."""
    if rho <= tool.disc:
        return 0.0
    if rho <= tool.arc_radius:
        d = rho - tool.disc
        return tool.corner - math.sqrt(max(0.0, tool.corner * tool.corner - d * d))
    if tool.tangent > 0.0:
        return tool.arc_height + (rho - tool.arc_radius) / tool.tangent
    return tool.arc_height


@helper
def profile_slope(tool: Meridian, rho: float) -> float:
    """Slope h'(rho) of the meridian at a distance from the axis, up to the radius."""
    if rho <= tool.disc:
        return 0.0
    if rho < tool.arc_radius:
        d = rho - tool.disc
        rest = tool.corner * tool.corner - d * d
        return d / math.sqrt(rest) if rest > 0.0 else math.inf
    return 1.0 / tool.tangent if tool.tangent > 0.0 else math.inf


@helper
def resting_offset(tool: Meridian, slope: float, q: float, limit: float) -> float:
    """Offset along a straight edge at which the tool rests on it.

    The edge passes the axis at a distance q and rises by ``slope`` >= 0. Its point s that holds the tool has the
    largest slope s - h(sqrt(q q + s s)) of all s in [0, limit]. The meridian h is convex, so the derivative decreases:
    it is solved by Newton steps on the corner arc, in closed form elsewhere.
    """
    disc, corner, arc = tool.disc, tool.corner, tool.arc_radius
    if slope == 0.0:
        return 0.0
    flat = math.sqrt(max(0.0, disc * disc - q * q))
    wall = math.inf if tool.tangent == 0.0 else 1.0 / tool.tangent
    if q < arc and corner > 0.0:
        end = math.sqrt(arc * arc - q * q)
        if wall * end / arc >= slope:
            return min(limit, _offset_on_arc(tool, slope, q, wall))
        flat = end
    if tool.tangent > 0.0:
        if slope < wall:
            return min(limit, max(flat, slope * q / math.sqrt(wall * wall - slope * slope)))
        return limit
    return min(limit, flat)


@helper
def _offset_on_arc(tool: Meridian, slope: float, q: float, wall: float) -> float:
    """Offset on the corner arc, from the tangent t of the normal's angle kappa there.

    t s = slope rho, with rho = disc + corner t / sqrt(1 + t t) and s = sqrt(rho rho - q q): Newton steps in t that are
    kept in a bracket, from the slope itself to that of the wall.
    """
    disc, corner = tool.disc, tool.corner
    sine = max(0.0, (q - disc) / corner)
    low, high = slope, wall
    if sine > 0.0:
        low = max(slope, sine / math.sqrt(max(1e-300, 1.0 - sine * sine)))
    t = low * (1.0 + 1e-3) if sine > 0.0 else low
    for _ in range(_MOST_STEPS):
        root = math.sqrt(1.0 + t * t)
        rho = disc + corner * t / root
        s = math.sqrt(max(0.0, rho * rho - q * q))
        value = t * s - slope * rho
        if value > 0.0:
            high = min(high, t)
        else:
            low = max(low, t)
        following = -1.0
        if s > 0.0:
            turn = corner / (root * root * root)
            rise = s + t * rho * turn / s - slope * turn
            if rise > 0.0:
                following = t - value / rise
        if not low <= following <= high:
            following = 0.5 * (low + high) if high < math.inf else 2.0 * low
        done = abs(following - t) <= _CONVERGED * t
        t = following
        if done:
            break
    rho = disc + corner * t / math.sqrt(1.0 + t * t)
    return math.sqrt(max(0.0, rho * rho - q * q))


@helper
def profile_radius(tool: Meridian, height: float) -> float:
    """Radius at a height above the lowest point, in [0, tool height]."""
    if height >= tool.arc_height:
        return tool.arc_radius + (height - tool.arc_height) * tool.tangent
    d = tool.corner - height
    return tool.disc + math.sqrt(max(0.0, tool.corner * tool.corner - d * d))


@helper
def profile_spread(tool: Meridian, height: float) -> float:
    """Derivative of `profile_radius`; large, not infinite, at the lowest point of a corner."""
    if height >= tool.arc_height:
        return tool.tangent
    d = tool.corner - height
    return max(tool.tangent, d / math.sqrt(max(_LEAST, tool.corner * tool.corner - d * d)))


@helper
def farthest_height(tool: Meridian, slope: float) -> float:
    """Height at which `profile_radius` less ``slope`` times the height is largest, at most the tool's height."""
    if slope <= tool.tangent:
        return tool.height
    return tool.corner * (1.0 - slope / math.sqrt(1.0 + slope * slope))


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
