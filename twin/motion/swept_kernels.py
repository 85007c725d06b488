"""Surface of a convex tool swept along a straight line; compiled.

Coordinates of a motion are ordered (w, u, v): w along the normal of the planes that cut it. For the vertical families
(yz: w = x, u = y, v = z; zx: w = y, u = x, v = z) v is the tool axis; for the horizontal one (xy: w = z, u = x, v = y)
w is. The parameter t runs from 0 to 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import helper, njit
from twin.tools.meridian import Meridian
from twin.tools.meridian_kernels import (
    farthest_height,
    is_ball,
    is_flat,
    profile_height,
    profile_radius,
    profile_slope,
    profile_spread,
    resting_offset,
)

#: Most steps of a search, every how many a bracket is halved, and the part of its first width at which it ends.
_SEARCH_STEPS, _BISECT_EACH, _SEARCHED = 80, 3, 1e-7
#: Sweeps in a group.
GROUP = 8
#: A point nearer to the axis than this part of the flat bottom's radius is on it.
_ON_BOTTOM = 1.0 - 1e-12
_RADIUS = Meridian._fields.index("radius")


class BodyShape(NamedTuple):
    """A body of revolution on the tool axis.

    Attributes:
        meridian: heights above the body's lowest point.
        drop: how far that lies below the tool tip, mm.
    """

    meridian: Meridian
    drop: float


class Motion(NamedTuple):
    """A point moving in a straight line: (w + t dw, u + t du, v + t dv), t from 0 to 1; mm."""

    w: float
    dw: float
    u: float
    du: float
    v: float
    dv: float


@helper
def upside_down(motion: Motion) -> Motion:
    """A motion mirrored in v = 0."""
    return Motion(motion.w, motion.dw, motion.u, motion.du, -motion.v, -motion.dv)


@helper
def sphere_upper(motion: Motion, radius: float, w: float, u: float, first: float, last: float) -> float:
    """Largest v on a sphere swept along a motion, t in [first, last], above the point (w, u).

    Returns -inf where the sweep does not cover (w, u).
    """
    ew = w - motion.w
    eu = u - motion.u
    square = motion.dw * motion.dw + motion.du * motion.du
    if square == 0.0:
        rest = radius * radius - ew * ew - eu * eu
        if rest < 0.0:
            return -math.inf
        return motion.v + max(motion.dv * first, motion.dv * last) + math.sqrt(rest)
    cross = ew * motion.du - eu * motion.dw
    rest = radius * radius - cross * cross / square
    if rest < 0.0:
        return -math.inf
    root = math.sqrt(rest)
    middle = (ew * motion.dw + eu * motion.du) / square
    half = root / math.sqrt(square)
    first = max(first, middle - half)
    last = min(last, middle + half)
    if first > last:
        return -math.inf
    best = middle + motion.dv * root / math.sqrt(square * (square + motion.dv * motion.dv))
    t = min(max(best, first), last)
    off = t - middle
    return motion.v + motion.dv * t + math.sqrt(max(0.0, rest - square * off * off))


@helper
def disc_upper(u0: float, du: float, v0: float, dv: float, radius: float, u: float, first: float, last: float) -> float:
    """Largest v at u on a disc in the (u, v) plane swept along (u0 + t du, v0 + t dv); -inf where there is none."""
    return sphere_upper(Motion(u0, du, 0.0, 0.0, v0, dv), radius, u, 0.0, first, last)


@helper
def _covering_times(motion: Motion, radius: float, w: float, u: float) -> tuple[float, float]:
    """Interval of t in [0, 1] in which a disc moving in the (w, u) plane covers a point; empty when first > last."""
    ew = w - motion.w
    eu = u - motion.u
    square = motion.dw * motion.dw + motion.du * motion.du
    if square == 0.0:
        if ew * ew + eu * eu > radius * radius:
            return 1.0, 0.0
        return 0.0, 1.0
    cross = ew * motion.du - eu * motion.dw
    rest = radius * radius - cross * cross / square
    if rest < 0.0:
        return 1.0, 0.0
    middle = (ew * motion.dw + eu * motion.du) / square
    half = math.sqrt(rest / square)
    return max(0.0, middle - half), min(1.0, middle + half)


@njit
def lowest(body: BodyShape, motion: Motion, w: float, u: float) -> float:
    """Lowest point of the swept body above the plan point (w, u); +inf where the sweep does not cover it."""
    tool = body.meridian
    base = motion.v - body.drop
    if is_ball(tool):
        centre = Motion(motion.w, motion.dw, motion.u, motion.du, base + tool.corner, motion.dv)
        return -sphere_upper(upside_down(centre), tool.corner, w, u, 0.0, 1.0)
    first, last = _covering_times(motion, tool.radius, w, u)
    if first > last:
        return math.inf
    if is_flat(tool):
        return base + min(motion.dv * first, motion.dv * last)
    off = Motion(w - motion.w, motion.dw, u - motion.u, motion.du, 0.0, motion.dv)
    square = motion.dw * motion.dw + motion.du * motion.du
    if square == 0.0:
        return base + min(0.0, motion.dv) + profile_height(tool, min(math.hypot(off.w, off.u), tool.radius))
    if motion.dv == 0.0:
        t = min(max((off.w * motion.dw + off.u * motion.du) / square, first), last)
        return base + profile_height(tool, _distance(tool, off, t))
    return base + _lowest_on_slope(tool, off, square, first, last)


@helper
def _distance(tool: Meridian, off: Motion, t: float) -> float:
    """Distance of a plan point from the tool axis, at most the tool's radius; ``off`` is its offset at t = 0."""
    return min(math.hypot(off.w - t * off.dw, off.u - t * off.du), tool.radius)


@helper
def _height_at(tool: Meridian, off: Motion, t: float) -> float:
    """Height of the tool's lower surface over a plan point; see `_distance`."""
    return off.dv * t + profile_height(tool, _distance(tool, off, t))


@helper
def _rise_at(tool: Meridian, off: Motion, t: float) -> float:
    """Derivative of `_height_at`; nan where it is not known."""
    w, u = off.w - t * off.dw, off.u - t * off.du
    rho = math.hypot(w, u)
    if rho == 0.0:
        return off.dv
    return off.dv - profile_slope(tool, rho) * (w * off.dw + u * off.du) / rho


@helper
def _lowest_on_slope(tool: Meridian, off: Motion, square: float, first: float, last: float) -> float:
    """Minimum of `_height_at`, a convex function of t, in [first, last]; ``square`` is that of the length in plan.

    The tool is lowest where it would rest on an edge that rises as the motion does.
    """
    if _rise_at(tool, off, last) <= 0.0:
        return _height_at(tool, off, last)
    if _rise_at(tool, off, first) >= 0.0:
        return _height_at(tool, off, first)
    length = math.sqrt(square)
    middle = (off.w * off.dw + off.u * off.du) / square
    q = abs(off.w * off.du - off.u * off.dw) / length
    s = resting_offset(tool, abs(off.dv) / length, q, math.sqrt(max(0.0, tool.radius * tool.radius - q * q)))
    t = middle - math.copysign(s / length, off.dv)
    return _height_at(tool, off, min(max(t, first), last))


@njit
def highest(body: BodyShape, motion: Motion, w: float, u: float) -> float:
    """Top of the swept body above the plan point (w, u); -inf where the sweep does not cover it."""
    first, last = _covering_times(motion, body.meridian.radius, w, u)
    if first > last:
        return -math.inf
    return motion.v - body.drop + body.meridian.height + max(motion.dv * first, motion.dv * last)


@helper
def _half_chord_by_search(tool: Meridian, disc: Motion, u: float, ta: float, tb: float) -> float:
    """Maximum over t in [ta, tb] of v(t) + sqrt(r(w(t))^2 - (u - u(t))^2), -inf where no disc reaches u.

    The times at which a disc reaches u are an interval, and the half chord is concave in it. So there is one time
    before which `_trend` is positive, and after which it is negative: found by secant steps kept in a bracket.

    Args:
        disc: the section's centre; w is its height above the tool's lowest point.
    """
    a, b = ta, tb
    at_a, a_reaches = _trend(tool, disc, u, a)
    at_b, b_reaches = _trend(tool, disc, u, b)
    if at_a <= 0.0:
        return _half_chord_end(tool, disc, u, a) if a_reaches else -math.inf
    if at_b >= 0.0:
        return _half_chord_end(tool, disc, u, b) if b_reaches else -math.inf
    best, side_moved = -math.inf, 0
    for step in range(_SEARCH_STEPS):
        t = 0.5 * (a + b)
        if a_reaches and b_reaches and step % _BISECT_EACH:
            t = (a * at_b - b * at_a) / (at_b - at_a)
        value, reaches = _trend(tool, disc, u, t)
        if reaches:
            best = max(best, _half_chord_end(tool, disc, u, t))
        if value > 0.0:
            a, at_a, a_reaches = t, value, reaches
            at_b = 0.5 * at_b if side_moved == 1 else at_b
            side_moved = 1
        else:
            b, at_b, b_reaches = t, value, reaches
            at_a = 0.5 * at_a if side_moved == -1 else at_a
            side_moved = -1
        if (b - a <= _SEARCHED * (tb - ta) and best > -math.inf) or value == 0.0:
            break
    return best


@helper
def _trend(tool: Meridian, disc: Motion, u: float, t: float) -> tuple[float, bool]:
    """A number with the sign of the half chord's derivative, and whether the section reaches over the line u.

    Where it does not, the number is the derivative of how far it reaches.
    """
    height = disc.w + disc.dw * t
    radius = profile_radius(tool, height)
    spread = disc.dw * profile_spread(tool, height)
    off = u - disc.u - disc.du * t
    rest = radius * radius - off * off
    if rest >= 0.0:
        return disc.dv * math.sqrt(rest) + radius * spread + off * disc.du, True
    return spread + math.copysign(disc.du, off * disc.du), False


@helper
def _half_chord_end(tool: Meridian, disc: Motion, u: float, t: float) -> float:
    """The v at which the line u leaves a section at height w."""
    radius = profile_radius(tool, disc.w + disc.dw * t)
    off = u - disc.u - disc.du * t
    return disc.v + disc.dv * t + math.sqrt(max(0.0, radius * radius - off * off))


@helper
def _times_at_height(base: float, dz: float, z: float, low: float, high: float) -> tuple[float, float]:
    """Interval of t in [0, 1] with low <= z - base - dz t <= high; empty when first > last."""
    if dz == 0.0:
        if low <= z - base <= high:
            return 0.0, 1.0
        return 1.0, 0.0
    t0 = (z - base - low) / dz
    t1 = (z - base - high) / dz
    return max(0.0, min(t0, t1)), min(1.0, max(t0, t1))


@njit
def side(body: BodyShape, motion: Motion, z: float, u: float) -> float:
    """Largest v of the swept body's section at height z on the line u; -inf where there is none.

    Args:
        motion: w is the height.
    """
    tool = body.meridian
    base, dz = motion.w - body.drop, motion.dw
    ta, tb = _times_at_height(base, dz, z, 0.0, tool.height)
    if ta > tb:
        return -math.inf
    h0 = z - base
    if dz == 0.0:
        return disc_upper(motion.u, motion.du, motion.v, motion.dv, profile_radius(tool, h0), u, 0.0, 1.0)
    if motion.du == 0.0 and motion.dv == 0.0:
        radius = profile_radius(tool, max(h0 - dz * ta, h0 - dz * tb))
        return disc_upper(motion.u, 0.0, motion.v, 0.0, radius, u, 0.0, 1.0)
    if tool.tangent == 0.0:
        return _side_of_cylinder(tool, motion, base, z, u)
    return _half_chord_by_search(tool, Motion(h0, -dz, motion.u, motion.du, motion.v, motion.dv), u, ta, tb)


@helper
def _side_of_cylinder(tool: Meridian, motion: Motion, base: float, z: float, u: float) -> float:
    """As `side` for a tool with a cylindrical wall, whose lowest point begins at the height ``base``."""
    value = -math.inf
    if tool.corner > 0.0:
        first, last = _times_at_height(base, motion.dw, z, 0.0, tool.arc_height)
        if first <= last and is_ball(tool):
            centre = Motion(motion.u, motion.du, base + tool.corner, motion.dw, motion.v, motion.dv)
            value = sphere_upper(centre, tool.corner, u, z, first, last)
        elif first <= last:
            disc = Motion(z - base, -motion.dw, motion.u, motion.du, motion.v, motion.dv)
            value = _half_chord_by_search(tool, disc, u, first, last)
    first, last = _times_at_height(base, motion.dw, z, tool.arc_height, tool.height)
    if first <= last:
        wall = disc_upper(motion.u, motion.du, motion.v, motion.dv, tool.radius, u, first, last)
        value = max(value, wall)
    return value


@njit
def reach(body: BodyShape, motion: Motion, z: float) -> float:
    """Largest u of the swept body's section at height z; -inf where there is none.

    Args:
        motion: w is the height.
    """
    tool = body.meridian
    base = motion.w - body.drop
    a, b = _times_at_height(base, motion.dw, z, 0.0, tool.height)
    if a > b:
        return -math.inf
    best = max(_reach_at(tool, motion, z - base, a), _reach_at(tool, motion, z - base, b))
    if motion.dw == 0.0:
        return best
    height = farthest_height(tool, motion.du / motion.dw)
    t = min(max((z - base - height) / motion.dw, a), b)
    return max(best, _reach_at(tool, motion, z - base, t))


@helper
def _reach_at(tool: Meridian, motion: Motion, height: float, t: float) -> float:
    """Largest u of the body's section at one time; ``height`` above its lowest point at t = 0."""
    return motion.u + motion.du * t + profile_radius(tool, height - motion.dw * t)


class Sweeps(NamedTuple):
    """Several swept bodies.

    Attributes:
        bodies: shape (m, 8), the numbers of each `BodyShape` in their order.
        starts, moves: shape (m, 3), start and motion of the tool tip, mm.
        behind: shape (m,), how far a whole sweep must lie behind the tangent plane of a tool's surface for none of it
            to reach the tangent point, mm; inf where bodies are those of another tool.
        boxes: shape (groups, 6), middle and half the size of a box about the tips of each `GROUP` sweeps.
        far: shape (groups,), largest ``behind`` of each group.
    """

    bodies: FloatArray
    starts: FloatArray
    moves: FloatArray
    behind: FloatArray
    boxes: FloatArray
    far: FloatArray


class Fronts(NamedTuple):
    """Points on the surface of a tool at several positions.

    Attributes:
        tool: the tool's shape, as it is given, heights from its tip.
        tips: shape (steps, 3), positions, mm.
        steps: shape (n,), the position to which each point belongs.
    """

    tool: Meridian
    tips: FloatArray
    steps: NDArray[np.int32]


@helper
def _body_of(bodies: FloatArray, j: int) -> BodyShape:
    """The body in a row."""
    return BodyShape(
        Meridian(bodies[j, 0], bodies[j, 1], bodies[j, 2], bodies[j, 3], bodies[j, 4], bodies[j, 5], bodies[j, 6]),
        bodies[j, 7],
    )


@njit
def outside_sweeps(
    points: FloatArray,
    candidates: NDArray[np.bool_],
    counts: NDArray[np.int64],
    sweeps: Sweeps,
    depth: float,
    fronts: Fronts,
) -> None:
    """Clear the candidates that lie deeper than ``depth`` inside one of several swept bodies.

    A body that lies behind the plane that touches a tool at a point of its surface cannot hold that point, so most
    earlier positions of the same tool need no closer look.

    Args:
        points: shape (n, 3), mm.
        candidates: shape (n,), changed in place.
        counts: shape (n,), how many of the sweeps, from the first, count for each point.
        fronts: the tool on whose surface the points lie; without steps for points anywhere.
    """
    bodies, starts, moves, behind = sweeps.bodies, sweeps.starts, sweeps.moves, sweeps.behind
    on_tool = len(fronts.steps) > 0
    for i in range(len(points)):
        if not candidates[i]:
            continue
        x = points[i, 0]
        y = points[i, 1]
        z = points[i, 2]
        touching = Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        if on_tool:
            touching = _tangent_plane(fronts, i, x, y, z)
        j = counts[i]
        while j > 0:
            j -= 1
            if on_tool and (j + 1 == counts[i] or j % GROUP == GROUP - 1):
                group = j // GROUP
                if _group_is_behind(touching, sweeps.boxes, group, -sweeps.far[group]):
                    j = group * GROUP
                    continue
            if on_tool and _is_behind(touching, starts, moves, j, -behind[j]):
                continue
            motion = Motion(starts[j, 0], moves[j, 0], starts[j, 1], moves[j, 1], starts[j, 2], moves[j, 2])
            if _in_box(motion, bodies[j, _RADIUS], x, y, z) and _inside(_body_of(bodies, j), motion, depth, x, y, z):
                candidates[i] = False
                break


@helper
def _tangent_plane(fronts: Fronts, i: int, x: float, y: float, z: float) -> Motion:
    """The tool tip (w, u, v) of a point on the tool's surface, and the outward normal (dw, du, dv) there."""
    tips, tool, s = fronts.tips, fronts.tool, fronts.steps[i]
    east, north = x - tips[s, 0], y - tips[s, 1]
    rho = math.hypot(east, north)
    if rho < tool.disc * _ON_BOTTOM:
        sine, cosine = 0.0, 1.0
    elif z - tips[s, 2] < tool.arc_height:
        sine = min(1.0, max(0.0, rho - tool.disc) / tool.corner)
        cosine = math.sqrt(1.0 - sine * sine)
    else:
        sine = 1.0 / math.sqrt(1.0 + tool.tangent * tool.tangent)
        cosine = tool.tangent * sine
    if rho == 0.0:
        return Motion(tips[s, 0], 0.0, tips[s, 1], 0.0, tips[s, 2], -cosine)
    return Motion(tips[s, 0], sine * east / rho, tips[s, 1], sine * north / rho, tips[s, 2], -cosine)


@helper
def _group_is_behind(touching: Motion, boxes: FloatArray, group: int, most: float) -> bool:
    """Whether all tips in a box are less than ``most`` before a tangent plane's tip; see `_is_behind`."""
    at = (
        (boxes[group, 0] - touching.w) * touching.dw
        + (boxes[group, 1] - touching.u) * touching.du
        + (boxes[group, 2] - touching.v) * touching.dv
    )
    reach = boxes[group, 3] * abs(touching.dw) + boxes[group, 4] * abs(touching.du) + boxes[group, 5] * abs(touching.dv)
    return at + reach < most


@helper
def _is_behind(touching: Motion, starts: FloatArray, moves: FloatArray, j: int, most: float) -> bool:
    """Whether the tip of a sweep is less than ``most`` before a tangent plane's tip, at its start and its end."""
    at = (
        (starts[j, 0] - touching.w) * touching.dw
        + (starts[j, 1] - touching.u) * touching.du
        + (starts[j, 2] - touching.v) * touching.dv
    )
    along = moves[j, 0] * touching.dw + moves[j, 1] * touching.du + moves[j, 2] * touching.dv
    return at < most and at + along < most


@helper
def _in_box(motion: Motion, radius: float, x: float, y: float, z: float) -> bool:
    """Whether a point lies in the box of a sweep, above the tip's lower end; w is x, u is y, v is z."""
    if z < motion.v + min(0.0, motion.dv):
        return False
    if x < motion.w + min(0.0, motion.dw) - radius or x > motion.w + max(0.0, motion.dw) + radius:
        return False
    return motion.u + min(0.0, motion.du) - radius <= y <= motion.u + max(0.0, motion.du) + radius


@helper
def _inside(body: BodyShape, motion: Motion, depth: float, x: float, y: float, z: float) -> bool:
    """Whether a point lies deeper than ``depth`` above the lower surface of a sweep, and below its top."""
    return z > lowest(body, motion, x, y) + depth and z < highest(body, motion, x, y)
