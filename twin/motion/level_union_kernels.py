"""Sections of many sweeps of one tool by planes across its axis: the union of all of them; compiled.

Sections of sweeps are taken as hulls of pairs of discs (`twin.motion.disc_kernels`). A line along v meets their union
in one or more intervals. Coordinates are those of `twin.motion.swept_kernels` for horizontal planes: w is the height.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells.strips import Bins, Strips
from twin.jit import helper, njit
from twin.motion.disc_kernels import disc_parts, radius_at
from twin.motion.envelope_kernels import DEPTH, NARROWEST, NODES, STRIPS, UnionPlanes
from twin.motion.node_kernels import INSET, NO_SECTION, SAME_SECTION, off_chord
from twin.motion.swept_kernels import BodyShape

#: Most intervals of a line, and numbers of a line: u, how many intervals, whether they are new, lo and hi of each.
_MOST = 24
_U, _COUNT, _NEW, _FIRST = 0, 1, 2, 3
_LINE = _FIRST + 2 * _MOST
#: Most discs by which the section of a sweep is described.
_DISCS = 64
#: So few hulls are all looked at closely; and where the union's ends are this many chord deviations off a line at
#: most, it is taken to be in one piece.
_FEW, _ALMOST = 3, 16.0
#: Columns of a hull: two discs; its range of u; from where to where along u its upper and lower tangents run, the v at
#: their beginning, and their slopes.
_U0, _V0, _R0, _U1, _V1, _R1, _FROM, _TO, _HA, _HB, _HV, _HS, _LA, _LB, _LV, _LS = range(16)
_HULL = 16
#: Columns of a piece of the union: the range of u, and lo and hi at its ends; its place among those over each other.
_PA, _PB, _LO_A, _LO_B, _HI_A, _HI_B, _LAYER, _FRESH_A, _FRESH_B = range(9)
_PIECE = 9


class _Plane(NamedTuple):
    """One plane: the hulls on it, and the disc at the start, of radius 0 where it is not cut already."""

    hulls: FloatArray
    chord: float
    same: float
    start_u: float
    start_v: float
    start_radius: float


@njit
def level_strips(
    body: BodyShape, sweeps: FloatArray, planes: UnionPlanes, bins: Bins, strips: Strips, used: NDArray[np.int64]
) -> bool:
    """Strips of the union of sweeps on consecutive planes across the tool axis, where there is material.

    Args:
        sweeps: shape (n, 6), (w, dw, u, du, v, dv).
        strips: its arrays are filled, of ``at`` the number of the plane from the first.
        used: shape (2,), filled: strips and nodes that were written.

    Returns:
        Whether they fit.
    """
    parts = np.empty((2 * _DISCS * len(sweeps), 6))
    hulls, active = np.empty((len(parts), _HULL)), np.empty(len(parts), dtype=np.int64)
    stack, left = np.empty((DEPTH + 2, _LINE)), np.empty(_LINE)
    pieces = np.empty((4 * len(strips.nodes) + 64, _PIECE))
    used[STRIPS], used[NODES] = 0, 0
    wall_from, wall_to = _same_between(body, sweeps)
    count, n, before = 0, 0, -math.inf
    for i in range(planes.planes):
        z = planes.first_w + i * planes.pitch
        same_hulls = wall_from <= before and z <= wall_to
        before = z
        if same_hulls and np.array_equal(bins.heights[i], bins.heights[i - 1]):
            if not _collect(pieces, n, i, strips, used):
                return False
            continue
        if not same_hulls:
            count = _hulls(body, sweeps, z, planes.chord, parts, hulls)
        radius = radius_at(body, z - sweeps[0, 0]) if planes.start_is_cut and z >= sweeps[0, 0] else 0.0
        same = SAME_SECTION * body.meridian.radius
        plane = _Plane(hulls[:count], planes.chord, same, sweeps[0, 2], sweeps[0, 4], radius)
        first, n = 0, 0
        while first < count and n >= 0:
            last, end = first + 1, hulls[first, _TO]
            while last < count and hulls[last, _FROM] <= end:
                end = max(end, hulls[last, _TO])
                last += 1
            n = _range(plane, (first, last), end, (i, bins), (active, stack, left), pieces, n)
            first = last
        if n < 0 or not _collect(pieces, n, i, strips, used):
            return False
    return True


@helper
def _same_between(body: BodyShape, sweeps: FloatArray) -> tuple[float, float]:
    """From which to which height all sections have the tool's whole radius; from inf where it tapers."""
    lowest, tip = math.inf, -math.inf
    for j in range(len(sweeps)):
        lowest = min(lowest, sweeps[j, 0], sweeps[j, 0] + sweeps[j, 1])
        tip = max(tip, sweeps[j, 0], sweeps[j, 0] + sweeps[j, 1])
    if body.meridian.tangent > 0.0:
        return math.inf, -math.inf
    same = SAME_SECTION * body.meridian.radius
    return tip + max(0.0, body.meridian.arc_height - body.drop) + same, lowest + body.meridian.height - body.drop


@helper
def _hulls(body: BodyShape, sweeps: FloatArray, z: float, chord: float, parts: FloatArray, hulls: FloatArray) -> int:
    """Write the hulls of a plane in order of where they begin along u; returns their number."""
    n = 0
    for k in range(disc_parts(body, sweeps, z, chord, _DISCS, parts)):
        low = min(parts[k, _U0] - parts[k, _R0], parts[k, _U1] - parts[k, _R1])
        high = max(parts[k, _U0] + parts[k, _R0], parts[k, _U1] + parts[k, _R1])
        if not high - low > NO_SECTION * body.meridian.radius:
            continue
        middle, half = 0.5 * (low + high), 0.5 * (high - low) * INSET
        at = n
        while at > 0 and hulls[at - 1, _FROM] > middle - half:
            hulls[at] = hulls[at - 1]
            at -= 1
        hulls[at, : _R1 + 1] = parts[k, : _R1 + 1]
        hulls[at, _FROM], hulls[at, _TO] = middle - half, middle + half
        _put_tangent(hulls[at], 1.0, _HA)
        _put_tangent(hulls[at], -1.0, _LA)
        n += 1
    return n


@helper
def _put_tangent(hull: FloatArray, sense: float, column: int) -> None:
    """Write where the line runs that touches both discs at the side of larger (1) or smaller (-1) v; nowhere where
    one disc holds the other.
    """
    du, dv, grown = hull[_U1] - hull[_U0], sense * (hull[_V1] - hull[_V0]), hull[_R1] - hull[_R0]
    square = du * du + dv * dv
    hull[column], hull[column + 1], hull[column + 2], hull[column + 3] = math.inf, -math.inf, 0.0, 0.0
    if square <= grown * grown or du == 0.0:
        return
    across = math.sqrt(square - grown * grown)
    right = 1.0 if du > 0.0 else -1.0
    nu, nv = (-grown * du - right * across * dv) / square, (-grown * dv + right * across * du) / square
    if nv <= 0.0:
        return
    ua, ub = hull[_U0] + hull[_R0] * nu, hull[_U1] + hull[_R1] * nu
    va, vb = sense * hull[_V0] + hull[_R0] * nv, sense * hull[_V1] + hull[_R1] * nv
    if ua > ub:
        ua, ub, va, vb = ub, ua, vb, va
    if ub > ua:
        hull[column], hull[column + 1], hull[column + 2] = ua, ub, sense * va
        hull[column + 3] = sense * (vb - va) / (ub - ua)


@helper
def _range(
    plane: _Plane,
    part: tuple[int, int],
    end: float,
    where: tuple[int, Bins],
    scratch: tuple[NDArray[np.int64], FloatArray, FloatArray],
    pieces: FloatArray,
    n: int,
) -> int:
    """Append the pieces of hulls that cover a range of u without a gap; returns their number, -1 where they do not fit.

    Args:
        part: the first of them and the end of them in ``plane.hulls``.
        end: of the range.
        where: number of the plane, and the bins.
        scratch: numbers of the hulls that matter in a bin, a stack of lines, and one line.
    """
    i, bins = where
    active, stack, left = scratch
    begin, since = plane.hulls[part[0], _FROM], part[0]
    first = max(0, int(math.floor((begin - bins.u_low) / bins.size)))
    last = min(bins.heights.shape[1] - 1, int(math.floor((end - bins.u_low) / bins.size)))
    for b in range(first, last + 1):
        u0, u1 = max(begin, bins.u_low + b * bins.size), min(end, bins.u_low + (b + 1) * bins.size)
        if bins.heights[i, b] == -math.inf or not u1 > u0:
            continue
        while plane.hulls[since, _TO] <= u0:
            since += 1
        count = 0
        for k in range(since, part[1]):
            if plane.hulls[k, _FROM] >= u1:
                break
            if plane.hulls[k, _TO] > u0:
                active[count] = k
                count += 1
        _line_at(plane, active[:count], u0, False, left)
        _line_at(plane, active[:count], u1, False, stack[0])
        _line_at(plane, active[:count], 0.5 * (u0 + u1), False, stack[1])
        solid = left[_COUNT] == 1.0 and stack[0, _COUNT] == 1.0 and stack[1, _COUNT] == 1.0
        solid = solid and _is_straight(left, stack[1], stack[0], _ALMOST * plane.chord)
        if solid and count > _FEW:
            count = _at_boundary(plane, active[:count], (u0, u1), stack[1])
        n = _refine(plane, active[:count], solid, stack, left, pieces, n)
        if n < 0:
            return -1
    return n


@helper
def _at_boundary(plane: _Plane, active: NDArray[np.int64], range_u: tuple[float, float], middle: FloatArray) -> int:
    """Keep the hulls that may reach the boundary of a union that is in one piece in a range of u; returns how many.

    The hull that is outermost in the middle reaches at least as far as at its ends everywhere, since hulls are convex;
    and none reaches beyond the lines through its middle and either end.
    """
    u0, u1 = range_u
    um = middle[_U]
    lo_bound, hi_bound = math.inf, -math.inf
    for k in active:
        lo, hi = _interval(plane.hulls[k], um)
        if lo == middle[_FIRST] or hi == middle[_FIRST + 1]:
            lo0, hi0 = _interval(plane.hulls[k], u0)
            lo1, hi1 = _interval(plane.hulls[k], u1)
            if lo == middle[_FIRST]:
                lo_bound = min(lo_bound, max(lo0, lo, lo1))
            if hi == middle[_FIRST + 1]:
                hi_bound = max(hi_bound, min(hi0, hi, hi1))
    kept = 0
    for k in active:
        lo0, hi0 = _interval(plane.hulls[k], u0)
        lo, hi = _interval(plane.hulls[k], um)
        lo1, hi1 = _interval(plane.hulls[k], u1)
        inside = lo0 <= hi0 and lo <= hi and lo1 <= hi1
        inside = inside and max(hi0, hi1, 2.0 * hi - min(hi0, hi1)) < hi_bound
        if not inside or min(lo0, lo1, 2.0 * lo - max(lo0, lo1)) <= lo_bound:
            active[kept] = k
            kept += 1
    return kept


@helper
def _line_at(plane: _Plane, active: NDArray[np.int64], u: float, solid: bool, line: FloatArray) -> None:
    """The intervals in which a line along v at u meets the union of hulls, by their numbers.

    Args:
        solid: whether the union is known to be in one piece, so that the outermost hulls are enough.
    """
    count = 0
    for k in active:
        lo, hi = _interval(plane.hulls[k], u)
        if lo <= hi and solid and count == 1:
            line[_FIRST], line[_FIRST + 1] = min(lo, line[_FIRST]), max(hi, line[_FIRST + 1])
        elif lo <= hi:
            count = _unite(line, count, lo, hi)
    line[_U], line[_COUNT], line[_NEW] = u, count, 1.0
    if count == 1 and plane.start_radius > 0.0:
        off = u - plane.start_u
        rest = plane.start_radius * plane.start_radius - off * off
        if rest > 0.0:
            root = math.sqrt(rest) + plane.same
            if line[_FIRST] >= plane.start_v - root and line[_FIRST + 1] <= plane.start_v + root:
                line[_NEW] = 0.0


@helper
def _interval(hull: FloatArray, u: float) -> tuple[float, float]:
    """Where a line along v at u meets a hull; (inf, -inf) where it does not."""
    lo, hi = math.inf, -math.inf
    rest = hull[_R0] * hull[_R0] - (u - hull[_U0]) * (u - hull[_U0])
    if rest >= 0.0:
        root = math.sqrt(rest)
        lo, hi = hull[_V0] - root, hull[_V0] + root
    rest = hull[_R1] * hull[_R1] - (u - hull[_U1]) * (u - hull[_U1])
    if rest >= 0.0:
        root = math.sqrt(rest)
        lo, hi = min(lo, hull[_V1] - root), max(hi, hull[_V1] + root)
    if hull[_HA] <= u <= hull[_HB]:
        hi = max(hi, hull[_HV] + hull[_HS] * (u - hull[_HA]))
    if hull[_LA] <= u <= hull[_LB]:
        lo = min(lo, hull[_LV] + hull[_LS] * (u - hull[_LA]))
    return lo, hi


@helper
def _unite(line: FloatArray, count: int, lo: float, hi: float) -> int:
    """Add an interval to those of a line, which are in order and do not touch; returns their number.

    Beyond the most that a line can hold, it is joined to the nearest one below.
    """
    first = 0
    while first < count and line[_FIRST + 2 * first + 1] < lo:
        first += 1
    last = first
    while last < count and line[_FIRST + 2 * last] <= hi:
        last += 1
    if first == last and count == _MOST:
        first = max(0, first - 1)
        last = first + 1
    if first < last:
        line[_FIRST + 2 * first] = min(lo, line[_FIRST + 2 * first])
        line[_FIRST + 2 * first + 1] = max(hi, line[_FIRST + 2 * last - 1])
        gone = last - first - 1
        for k in range(last, count if gone > 0 else last):
            line[_FIRST + 2 * (k - gone)] = line[_FIRST + 2 * k]
            line[_FIRST + 2 * (k - gone) + 1] = line[_FIRST + 2 * k + 1]
        return count - gone
    for k in range(count, first, -1):
        line[_FIRST + 2 * k] = line[_FIRST + 2 * k - 2]
        line[_FIRST + 2 * k + 1] = line[_FIRST + 2 * k - 1]
    line[_FIRST + 2 * first], line[_FIRST + 2 * first + 1] = lo, hi
    return count + 1


@helper
def _refine(
    plane: _Plane,
    active: NDArray[np.int64],
    solid: bool,
    stack: FloatArray,
    left: FloatArray,
    pieces: FloatArray,
    n: int,
) -> int:
    """Append the pieces between the line ``left`` and the first one in the stack; returns their number, -1 where they
    do not fit.

    Args:
        solid: see `_line_at`.
        stack: the second line is the one in the middle.
    """
    depth, known, least = 0, True, (stack[0, _U] - left[_U]) * NARROWEST
    while depth >= 0:
        right = stack[depth]
        middle = stack[depth + 1]
        if not known:
            _line_at(plane, active, 0.5 * (left[_U] + right[_U]), solid, middle)
        known = False
        alike = left[_COUNT] == right[_COUNT] and left[_COUNT] == middle[_COUNT]
        old = left[_NEW] == 0.0 and right[_NEW] == 0.0 and middle[_NEW] == 0.0
        straight = alike and (old or _is_straight(left, middle, right, plane.chord))
        if straight or right[_U] - left[_U] <= least:
            n = _put_pieces(left, right, straight, pieces, n)
            if n < 0:
                return -1
            left[:] = right
            depth -= 1
        else:
            depth += 1
    return n


@helper
def _is_straight(left: FloatArray, middle: FloatArray, right: FloatArray, chord: float) -> bool:
    """Whether no end of an interval is off the chord between two lines."""
    for k in range(_FIRST, _FIRST + 2 * int(left[_COUNT])):
        if off_chord(middle[_U], middle[k], left[_U], left[k], right[_U], right[k]) > chord:
            return False
    return True


@helper
def _put_pieces(left: FloatArray, right: FloatArray, straight: bool, pieces: FloatArray, n: int) -> int:
    """Append the pieces between two lines; between lines that do not go over into each other those of one go on."""
    a, b = left, right
    if not straight:
        if left[_COUNT] > 0.0:
            b = left
        else:
            a = right
    for layer in range(int(a[_COUNT])):
        if n >= len(pieces):
            return -1
        row, k = pieces[n], _FIRST + 2 * layer
        row[_PA], row[_PB], row[_LAYER] = left[_U], right[_U], layer
        row[_LO_A], row[_LO_B], row[_HI_A], row[_HI_B] = a[k], b[k], a[k + 1], b[k + 1]
        row[_FRESH_A], row[_FRESH_B] = a[_NEW], b[_NEW]
        n += 1
    return n


@helper
def _collect(pieces: FloatArray, n: int, i: int, strips: Strips, used: NDArray[np.int64]) -> bool:
    """Write a plane's pieces as strips, those of one layer after the other; returns whether they fit."""
    layer, more = 0, n > 0
    while more:
        more = False
        end, lo, hi = -math.inf, 0.0, 0.0
        for p in range(n):
            row = pieces[p]
            if row[_LAYER] > layer:
                more = True
            if row[_LAYER] != layer:
                continue
            if row[_PA] != end:
                if used[STRIPS] + 1 >= len(strips.offsets):
                    return False
                strips.at[used[STRIPS]] = i
                used[STRIPS] += 1
                lo = math.inf
            if used[NODES] + 2 > len(strips.nodes):
                return False
            if row[_PA] != end or row[_LO_A] != lo or row[_HI_A] != hi:
                _write(row[_PA], row[_LO_A], row[_HI_A], row[_FRESH_A] > 0.0, strips, used)
            end, lo, hi = row[_PB], row[_LO_B], row[_HI_B]
            _write(end, lo, hi, row[_FRESH_B] > 0.0, strips, used)
        layer += 1
    return True


@helper
def _write(u: float, lo: float, hi: float, new: bool, strips: Strips, used: NDArray[np.int64]) -> None:
    """Append a node to the last strip."""
    n = used[NODES]
    strips.nodes[n, 0], strips.nodes[n, 1], strips.nodes[n, 2] = u, lo, hi
    strips.fresh[n] = new
    used[NODES] += 1
    strips.offsets[used[STRIPS]] = used[NODES]
