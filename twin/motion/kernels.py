"""Sections and lower surface of a convex tool swept along a straight line; compiled.

Coordinates of a motion are ordered (w, u, v): w along the normal of the planes that cut it. For the vertical families
(yz: w = x, u = y, v = z; zx: w = y, u = x, v = z) v is the tool axis; for the horizontal one (xy: w = z, u = x, v = y)
w is. ``shape`` holds `twin.tools.shape.ToolShape.parameters` and, as an eighth entry, how far the shape's lowest point
lies below the tip (its circumscribed enlargement).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import njit

_GOLDEN = 0.6180339887498949
_SEARCH_STEPS = 42
_START_INTERVALS = 8
_MAX_DEPTH = 7
#: Sections that differ by less than this part of the tool's radius are the same but for rounding.
_SAME_SECTION = 1e-12


@njit
def profile_height(shape: FloatArray, rho: float) -> float:
    """Height of the tool's lower surface above its lowest point at distance rho <= largest radius from the axis."""
    if rho <= shape[0]:
        return 0.0
    if rho <= shape[3]:
        d = rho - shape[0]
        return shape[1] - math.sqrt(max(0.0, shape[1] * shape[1] - d * d))
    if shape[2] > 0.0:
        return shape[4] + (rho - shape[3]) / shape[2]
    return shape[4]


@njit
def profile_radius(shape: FloatArray, height: float) -> float:
    """Radius at a height above the lowest point, height in [0, shape height]."""
    if height >= shape[4]:
        return shape[3] + (height - shape[4]) * shape[2]
    d = shape[1] - height
    return shape[0] + math.sqrt(max(0.0, shape[1] * shape[1] - d * d))


@njit
def sphere_upper(
    a0: float,
    da: float,
    b0: float,
    db: float,
    c0: float,
    dc: float,
    radius: float,
    a: float,
    b: float,
    ta: float,
    tb: float,
) -> float:
    """Largest c on a sphere swept along (a0, b0, c0) + t (da, db, dc), t in [ta, tb], above the point (a, b).

    Returns -inf where the sweep does not cover (a, b). With b0 = db = b = 0 it is a swept disc in the (a, c) plane.
    """
    ea = a - a0
    eb = b - b0
    square = da * da + db * db
    if square == 0.0:
        rest = radius * radius - ea * ea - eb * eb
        if rest < 0.0:
            return -math.inf
        return c0 + max(dc * ta, dc * tb) + math.sqrt(rest)
    cross = ea * db - eb * da
    rest = radius * radius - cross * cross / square
    if rest < 0.0:
        return -math.inf
    root = math.sqrt(rest)
    middle = (ea * da + eb * db) / square
    half = root / math.sqrt(square)
    first = max(ta, middle - half)
    last = min(tb, middle + half)
    if first > last:
        return -math.inf
    best = middle + dc * root / math.sqrt(square * (square + dc * dc))
    t = min(max(best, first), last)
    off = t - middle
    return c0 + dc * t + math.sqrt(max(0.0, rest - square * off * off))


@njit
def _covering_times(
    w0: float, dw: float, u0: float, du: float, radius: float, w: float, u: float
) -> tuple[float, float]:
    """Interval of t in [0, 1] in which a disc moving in the (w, u) plane covers a point; empty when first > last."""
    ew = w - w0
    eu = u - u0
    square = dw * dw + du * du
    if square == 0.0:
        if ew * ew + eu * eu > radius * radius:
            return 1.0, 0.0
        return 0.0, 1.0
    cross = ew * du - eu * dw
    rest = radius * radius - cross * cross / square
    if rest < 0.0:
        return 1.0, 0.0
    middle = (ew * dw + eu * du) / square
    half = math.sqrt(rest / square)
    return max(0.0, middle - half), min(1.0, middle + half)


@njit
def lowest(
    shape: FloatArray, w0: float, dw: float, u0: float, du: float, z0: float, dz: float, w: float, u: float
) -> float:
    """Lowest point of the swept tool above the plan point (w, u); +inf where the sweep does not cover it."""
    base = z0 - shape[7]
    if shape[0] == 0.0 and shape[2] == 0.0:
        centre = base + shape[1]
        return -sphere_upper(w0, dw, u0, du, -centre, -dz, shape[1], w, u, 0.0, 1.0)
    first, last = _covering_times(w0, dw, u0, du, shape[6], w, u)
    if first > last:
        return math.inf
    if shape[1] == 0.0 and shape[2] == 0.0:
        return base + min(dz * first, dz * last)
    square = dw * dw + du * du
    if square == 0.0:
        rho = min(math.hypot(w - w0, u - u0), shape[6])
        return base + min(0.0, dz) + profile_height(shape, rho)
    if dz == 0.0:
        t = min(max(((w - w0) * dw + (u - u0) * du) / square, first), last)
        rho = min(math.hypot(w - w0 - t * dw, u - u0 - t * du), shape[6])
        return base + profile_height(shape, rho)
    return base + _lowest_by_search(shape, w - w0, dw, u - u0, du, dz, first, last)


@njit
def _lowest_by_search(
    shape: FloatArray, ew: float, dw: float, eu: float, du: float, dz: float, first: float, last: float
) -> float:
    """Minimum over t of dz t + profile(distance), a convex function, by golden section."""
    best = math.inf
    x0 = last - _GOLDEN * (last - first)
    x1 = first + _GOLDEN * (last - first)
    f0 = dz * x0 + profile_height(shape, min(math.hypot(ew - x0 * dw, eu - x0 * du), shape[6]))
    f1 = dz * x1 + profile_height(shape, min(math.hypot(ew - x1 * dw, eu - x1 * du), shape[6]))
    for t in (first, last):
        best = min(best, dz * t + profile_height(shape, min(math.hypot(ew - t * dw, eu - t * du), shape[6])))
    for _ in range(_SEARCH_STEPS):
        if f0 < f1:
            last = x1
            x1 = x0
            f1 = f0
            x0 = last - _GOLDEN * (last - first)
            f0 = dz * x0 + profile_height(shape, min(math.hypot(ew - x0 * dw, eu - x0 * du), shape[6]))
        else:
            first = x0
            x0 = x1
            f0 = f1
            x1 = first + _GOLDEN * (last - first)
            f1 = dz * x1 + profile_height(shape, min(math.hypot(ew - x1 * dw, eu - x1 * du), shape[6]))
    return min(best, f0, f1)


@njit
def highest(
    shape: FloatArray, w0: float, dw: float, u0: float, du: float, z0: float, dz: float, w: float, u: float
) -> float:
    """Top of the swept cutting part above the plan point (w, u); -inf where the sweep does not cover it."""
    first, last = _covering_times(w0, dw, u0, du, shape[6], w, u)
    if first > last:
        return -math.inf
    return z0 - shape[7] + shape[5] + max(dz * first, dz * last)


@njit
def _side_by_search(
    shape: FloatArray, h0: float, dh: float, u0: float, du: float, v0: float, dv: float, u: float, ta: float, tb: float
) -> float:
    """Maximum over t in [ta, tb] of v(t) + sqrt(r(h(t))^2 - (u - u(t))^2), -inf where no disc reaches u.

    The half chord is concave in t: find where the disc reaches farthest over u, then both ends of the interval in
    which it reaches at all, then the maximum inside.
    """
    a = ta
    b = tb
    for _ in range(_SEARCH_STEPS):
        x0 = b - _GOLDEN * (b - a)
        x1 = a + _GOLDEN * (b - a)
        g0 = profile_radius(shape, h0 + dh * x0) - abs(u - u0 - du * x0)
        g1 = profile_radius(shape, h0 + dh * x1) - abs(u - u0 - du * x1)
        if g0 > g1:
            b = x1
        else:
            a = x0
    top = 0.5 * (a + b)
    if profile_radius(shape, h0 + dh * top) < abs(u - u0 - du * top):
        for t in (ta, tb):
            if profile_radius(shape, h0 + dh * t) >= abs(u - u0 - du * t):
                top = t
        if profile_radius(shape, h0 + dh * top) < abs(u - u0 - du * top):
            return -math.inf
    first = _edge_of_reach(shape, h0, dh, u - u0, du, top, ta)
    last = _edge_of_reach(shape, h0, dh, u - u0, du, top, tb)
    best = -math.inf
    a = first
    b = last
    for _ in range(_SEARCH_STEPS):
        x0 = b - _GOLDEN * (b - a)
        x1 = a + _GOLDEN * (b - a)
        f0 = _side_at(shape, h0 + dh * x0, u - u0 - du * x0, v0 + dv * x0)
        f1 = _side_at(shape, h0 + dh * x1, u - u0 - du * x1, v0 + dv * x1)
        best = max(best, f0, f1)
        if f0 > f1:
            b = x1
        else:
            a = x0
    for t in (first, last):
        best = max(best, _side_at(shape, h0 + dh * t, u - u0 - du * t, v0 + dv * t))
    return best


@njit
def _side_at(shape: FloatArray, height: float, off: float, v: float) -> float:
    radius = profile_radius(shape, height)
    return v + math.sqrt(max(0.0, radius * radius - off * off))


@njit
def _edge_of_reach(shape: FloatArray, h0: float, dh: float, eu: float, du: float, inside: float, end: float) -> float:
    """The t nearest to ``end`` at which the disc still reaches over u, seen from one at which it does."""
    if profile_radius(shape, h0 + dh * end) >= abs(eu - du * end):
        return end
    a = inside
    b = end
    for _ in range(_SEARCH_STEPS):
        middle = 0.5 * (a + b)
        if profile_radius(shape, h0 + dh * middle) >= abs(eu - du * middle):
            a = middle
        else:
            b = middle
    return a


@njit
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
def side(
    shape: FloatArray, z0: float, dz: float, u0: float, du: float, v0: float, dv: float, z: float, u: float
) -> float:
    """Largest v of the swept tool's section at height z on the line u; -inf where there is none."""
    base = z0 - shape[7]
    ta, tb = _times_at_height(base, dz, z, 0.0, shape[5])
    if ta > tb:
        return -math.inf
    h0 = z - base
    if dz == 0.0:
        return sphere_upper(u0, du, 0.0, 0.0, v0, dv, profile_radius(shape, h0), u, 0.0, 0.0, 1.0)
    if du == 0.0 and dv == 0.0:
        radius = profile_radius(shape, max(h0 - dz * ta, h0 - dz * tb))
        return sphere_upper(u0, 0.0, 0.0, 0.0, v0, 0.0, radius, u, 0.0, 0.0, 1.0)
    if shape[2] == 0.0 and (shape[1] == 0.0 or shape[0] == 0.0):
        value = -math.inf
        if shape[1] > 0.0:
            sa, sb = _times_at_height(base, dz, z, 0.0, shape[4])
            if sa <= sb:
                value = sphere_upper(u0, du, base + shape[1], dz, v0, dv, shape[1], u, z, sa, sb)
        wa, wb = _times_at_height(base, dz, z, shape[4], shape[5])
        if wa <= wb:
            value = max(value, sphere_upper(u0, du, 0.0, 0.0, v0, dv, shape[6], u, 0.0, wa, wb))
        return value
    return _side_by_search(shape, h0, -dz, u0, du, v0, dv, u, ta, tb)


@njit
def _reach(shape: FloatArray, z0: float, dz: float, u0: float, du: float, z: float) -> float:
    """Largest u of the swept tool's section at height z; -inf where there is none."""
    base = z0 - shape[7]
    ta, tb = _times_at_height(base, dz, z, 0.0, shape[5])
    if ta > tb:
        return -math.inf
    a = ta
    b = tb
    best = max(
        u0 + du * ta + profile_radius(shape, z - base - dz * ta),
        u0 + du * tb + profile_radius(shape, z - base - dz * tb),
    )
    if dz == 0.0:
        return best
    for _ in range(_SEARCH_STEPS):
        x0 = b - _GOLDEN * (b - a)
        x1 = a + _GOLDEN * (b - a)
        f0 = u0 + du * x0 + profile_radius(shape, z - base - dz * x0)
        f1 = u0 + du * x1 + profile_radius(shape, z - base - dz * x1)
        best = max(best, f0, f1)
        if f0 > f1:
            b = x1
        else:
            a = x0
    return best


@njit
def _strip_at(
    shape: FloatArray, horizontal: bool, start: FloatArray, move: FloatArray, w: float, u: float
) -> tuple[float, float]:
    """The lo and hi of the section by the plane w at u; (inf, -inf) where there is none."""
    if horizontal:
        hi = side(shape, start[0], move[0], start[1], move[1], start[2], move[2], w, u)
        lo = -side(shape, start[0], move[0], start[1], move[1], -start[2], -move[2], w, u)
        return lo, hi
    lo = lowest(shape, start[0], move[0], start[1], move[1], start[2], move[2], w, u)
    hi = highest(shape, start[0], move[0], start[1], move[1], start[2], move[2], w, u)
    return max(lo, start[2] + min(0.0, move[2])), hi


@njit
def _range_of_u(
    shape: FloatArray, horizontal: bool, start: FloatArray, move: FloatArray, w: float
) -> tuple[float, float]:
    """Extent of the section by the plane w along u; empty when first > last."""
    if horizontal:
        if w < start[0] + min(0.0, move[0]):
            return math.inf, -math.inf
        high = _reach(shape, start[0], move[0], start[1], move[1], w)
        return -_reach(shape, start[0], move[0], -start[1], -move[1], w), high
    high = sphere_upper(start[0], move[0], 0.0, 0.0, start[1], move[1], shape[6], w, 0.0, 0.0, 1.0)
    low = -sphere_upper(start[0], move[0], 0.0, 0.0, -start[1], -move[1], shape[6], w, 0.0, 0.0, 1.0)
    return low, high


@njit
def _off_chord(u: float, v: float, ua: float, va: float, ub: float, vb: float) -> float:
    """Distance of a point from the chord between two others."""
    du = ub - ua
    dv = vb - va
    length = math.hypot(du, dv)
    if length == 0.0:
        return math.hypot(u - ua, v - va)
    return abs((u - ua) * dv - (v - va) * du) / length


@njit
def _is_new(
    shape: FloatArray,
    horizontal: bool,
    start: FloatArray,
    still: FloatArray,
    w: float,
    u: float,
    lo: float,
    hi: float,
    top: float,
    same: float,
) -> bool:
    """Whether a section reaches beyond that of the tool standing at the start, below the top of the material."""
    if not lo <= hi:
        return True
    lo_still, hi_still = _strip_at(shape, horizontal, start, still, w, u)
    if not lo_still <= hi_still:
        return True
    if not horizontal:
        hi, hi_still = min(hi, top), min(hi_still, top)
    return lo < lo_still - same or hi > hi_still + same


@njit
def section_nodes(
    shape: FloatArray,
    horizontal: bool,
    start: FloatArray,
    move: FloatArray,
    first_w: float,
    pitch: float,
    planes: int,
    chord: float,
    follows: bool,
    top: float,
    offsets: NDArray[np.int64],
    nodes: FloatArray,
    fresh: NDArray[np.bool_],
) -> int:
    """Strips of a swept tool on a run of planes, as `twin.geometry.column_cells.strips.Strips` holds them.

    Nodes are placed by halving until no chord of lo or hi stands off its curve by more than ``chord``, evenly in the
    angle whose cosine is u, which follows a round section's vertical ends.

    Args:
        follows: the tool's place at the start has been cut already. Then nodes where the section is no more than that
            of the tool standing there are not fresh, and no chords are refined between them: they cut nothing new.
        top: height above which there is no material; for vertical planes.
        fresh: shape as the rows of ``nodes``, filled.

    Returns:
        Number of nodes written, or -1 when ``nodes`` is too short.
    """
    stack = np.empty((_MAX_DEPTH + 2, 5))
    still = np.zeros(3)
    same = _SAME_SECTION * shape[6]
    written = 0
    offsets[0] = 0
    # planes that the whole tool passes straight through have one section
    across = not horizontal and move[1] == 0.0 and move[2] == 0.0
    passed_from = min(start[0], start[0] + move[0]) + shape[6]
    passed_to = max(start[0], start[0] + move[0]) - shape[6]
    for i in range(planes):
        w = first_w + i * pitch
        if across and i > 0 and w - pitch >= passed_from and w <= passed_to:
            count = offsets[i] - offsets[i - 1]
            if written + count > len(nodes):
                return -1
            for n in range(written, written + count):
                nodes[n, 0], nodes[n, 1], nodes[n, 2] = nodes[n - count, 0], nodes[n - count, 1], nodes[n - count, 2]
                fresh[n] = fresh[n - count]
            written += count
            offsets[i + 1] = written
            continue
        low, high = _range_of_u(shape, horizontal, start, move, w)
        half = 0.5 * (high - low)
        if not half > 1e-9 * shape[6]:
            offsets[i + 1] = written
            continue
        middle = 0.5 * (high + low)
        inset = 1.0 - 1e-12
        if written + 1 > len(nodes):
            return -1
        ua = middle - half * inset
        la, ha = _strip_at(shape, horizontal, start, move, w, ua)
        new_a = not follows or _is_new(shape, horizontal, start, still, w, ua, la, ha, top, same)
        first_node = written
        if la <= ha:
            nodes[written, 0] = ua
            nodes[written, 1] = la
            nodes[written, 2] = ha
            fresh[written] = new_a
            written += 1
        for piece in range(_START_INTERVALS):
            depth = 0
            stack[0, 0] = math.pi * (piece + 1) / _START_INTERVALS
            phi_a = math.pi * piece / _START_INTERVALS
            ub = middle - half * inset * math.cos(stack[0, 0])
            lb, hb = _strip_at(shape, horizontal, start, move, w, ub)
            stack[0, 1] = ub
            stack[0, 2] = lb
            stack[0, 3] = hb
            new_b = not follows or _is_new(shape, horizontal, start, still, w, ub, lb, hb, top, same)
            stack[0, 4] = 1.0 if new_b else 0.0
            while depth >= 0:
                phi_b = stack[depth, 0]
                ub = stack[depth, 1]
                lb = stack[depth, 2]
                hb = stack[depth, 3]
                new_b = stack[depth, 4] > 0.0
                phi = 0.5 * (phi_a + phi_b)
                um = middle - half * inset * math.cos(phi)
                lm, hm = _strip_at(shape, horizontal, start, move, w, um)
                new_m = not follows or _is_new(shape, horizontal, start, still, w, um, lm, hm, top, same)
                flat = not (new_a or new_b or new_m) or depth >= _MAX_DEPTH or not (la <= ha and lb <= hb and lm <= hm)
                if not flat:
                    flat = _off_chord(um, lm, ua, la, ub, lb) <= chord and _off_chord(um, hm, ua, ha, ub, hb) <= chord
                if flat:
                    if lb <= hb:
                        if written + 1 > len(nodes):
                            return -1
                        nodes[written, 0] = ub
                        nodes[written, 1] = lb
                        nodes[written, 2] = hb
                        fresh[written] = new_b
                        written += 1
                    phi_a = phi_b
                    new_a = new_b
                    ua = ub
                    la = lb
                    ha = hb
                    depth -= 1
                else:
                    depth += 1
                    stack[depth, 0] = phi
                    stack[depth, 1] = um
                    stack[depth, 2] = lm
                    stack[depth, 3] = hm
                    stack[depth, 4] = 1.0 if new_m else 0.0
        if written - first_node < 2:
            written = first_node
        offsets[i + 1] = written
    return written


@njit
def outside_sweeps(
    points: FloatArray,
    candidates: NDArray[np.bool_],
    counts: NDArray[np.int64],
    shapes: FloatArray,
    starts: FloatArray,
    moves: FloatArray,
    depth: float,
) -> None:
    """Clear the candidates that lie deeper than ``depth`` inside one of several swept tools.

    Args:
        points: shape (n, 3), mm.
        candidates: shape (n,), changed in place.
        counts: shape (n,), how many of the sweeps, from the first, count for each point.
        shapes, starts, moves: shapes (m, 8), (m, 3), (m, 3): each sweep's tool shape, start and motion of the tip.
    """
    for i in range(len(points)):
        if not candidates[i]:
            continue
        x = points[i, 0]
        y = points[i, 1]
        z = points[i, 2]
        for j in range(counts[i] - 1, -1, -1):
            s = starts[j]
            d = moves[j]
            if z < s[2] + min(0.0, d[2]):
                continue
            r = shapes[j, 6]
            if x < s[0] + min(0.0, d[0]) - r or x > s[0] + max(0.0, d[0]) + r:
                continue
            if y < s[1] + min(0.0, d[1]) - r or y > s[1] + max(0.0, d[1]) + r:
                continue
            if z < highest(shapes[j], s[0], d[0], s[1], d[1], s[2], d[2], x, y):
                if z > lowest(shapes[j], s[0], d[0], s[1], d[1], s[2], d[2], x, y) + depth:
                    candidates[i] = False
                    break
