"""How low a tool can go over a part's slices: upper envelope of profiles inflated by its sections; compiled.

A profile is the upper boundary of one section, as segments and convex corners. Inflated by a convex section of the
tool, a segment is moved by the point of the tool that touches it, and a corner becomes a piece of the tool's own
outline, from the point that touches one side to the point that touches the other. The envelope of all pieces of all
sections within the tool's radius is the inflated part's upper boundary (the tri-slice paper, eq. 1), known at evenly
spaced samples.

Heights of the tool's outline at a distance from its axis: 0 within the disc, then a corner arc.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.sorting_kernels import order_of
from twin.jit import helper, njit

#: Nodes of the table that finds where a bull-nose tool touches a slope.
_TABLE = 65
#: How alike neighbouring curvatures must be, for heights between sections to be interpolated.
_ALIKE = 4.0
#: Sections evaluated within a cell: the one touched at an end, and its neighbours.
_EVALUATED = 5
#: Slope between two sections above which there is a wall between them.
_CLIFF = 5.0
#: Gaps between sections at either end of a flat rim where it is evaluated between sections, and points in each.
_END_GAPS, _END_POINTS = 3, 4
#: Part of a step by which pieces reach further, so that a tool that just touches a wall counts as touching it.
_TIE = 1e-7
#: Sections closer than this are taken for one, mm.
_SAME_MM = 1e-7


#: Columns of a segment: u, v of its left end, u, v of its right end, outward normal, and how far the section's
#: segments up to this one reach to the right.
_LEFT_U, _LEFT_V, _RIGHT_U, _RIGHT_V, _NORMAL_U, _NORMAL_V, _REACH = range(7)
#: Columns of a corner: u, v, normal of the side to its right, normal of the side to its left.
_U, _V, _RIGHT_NORMAL_U, _RIGHT_NORMAL_V, _LEFT_NORMAL_U, _LEFT_NORMAL_V = range(6)
#: Numbers of a segment and of a corner.
SEGMENT_COLUMNS, CORNER_COLUMNS = 7, 6


class Outlines(NamedTuple):
    """Sections as rings.

    Attributes:
        points: shape (n, 2), rings one after the other, material on the left.
        rings: where each ring begins, and the end.
        sections: the first ring of each section, and the end.
    """

    points: FloatArray
    rings: NDArray[np.int64]
    sections: NDArray[np.int64]


class Pieces(NamedTuple):
    """Upper segments and convex corners of sections.

    Attributes:
        segments: shape (SEGMENT_COLUMNS, n), each section's with increasing u of the left end.
        segment_begins: where each section's segments begin, and the end.
        corners: shape (CORNER_COLUMNS, m), each section's with increasing u.
        corner_begins: where each section's corners begin, and the end.
        positions: shape (k,), where the sections lie, increasing.
    """

    segments: FloatArray
    segment_begins: NDArray[np.int64]
    corners: FloatArray
    corner_begins: NDArray[np.int64]
    positions: FloatArray


class ToolEnd(NamedTuple):
    """Radius of the tool's bottom and of its corner arc."""

    disc: float
    corner: float


class SampleRow(NamedTuple):
    """Even samples along a plane."""

    start: float
    step: float
    length: int


class _Bounds(NamedTuple):
    """First and one past the last segment of a section, and of its corners."""

    segment: int
    segment_end: int
    corner: int
    corner_end: int


class _Work(NamedTuple):
    """Work arrays: the table of a tool's section, pieces' shifts and ranges, rows of sections, two rows more."""

    offset: FloatArray
    slope: FloatArray
    pieces: FloatArray
    rows: FloatArray
    pair: FloatArray


@njit
def profile_pieces(
    outlines: Outlines,
    segments: FloatArray,
    segment_begins: NDArray[np.int64],
    corners: FloatArray,
    corner_begins: NDArray[np.int64],
) -> None:
    """Upper segments and convex corners of every section.

    Args:
        segments: shape (n, SEGMENT_COLUMNS), filled section by section, increasing in u of the left end.
        corners: shape (n, CORNER_COLUMNS), filled section by section, increasing in u.
        segment_begins, corner_begins: filled with where each section's rows begin, and the end.
    """
    points, rings, sections = outlines
    ns, nc = 0, 0
    for k in range(len(sections) - 1):
        segment_begins[k], corner_begins[k] = ns, nc
        for r in range(sections[k], sections[k + 1]):
            more_segments, more_corners = _ring_pieces(points[rings[r] : rings[r + 1]], segments[ns:], corners[nc:])
            ns += more_segments
            nc += more_corners
        _sort_rows(segments[segment_begins[k] : ns])
        _sort_rows(corners[corner_begins[k] : nc])
        reach = -math.inf
        for i in range(segment_begins[k], ns):
            reach = max(reach, segments[i, _RIGHT_U])
            segments[i, _REACH] = reach
    segment_begins[len(sections) - 1], corner_begins[len(sections) - 1] = ns, nc


@helper
def _ring_pieces(ring: FloatArray, segments: FloatArray, corners: FloatArray) -> tuple[int, int]:
    """Fill in the upper segments and convex corners of a ring; their numbers."""
    ns, nc = 0, 0
    pu, pv = ring[-1, 0], ring[-1, 1]
    au, av = ring[0, 0], ring[0, 1]
    length = math.hypot(au - pu, av - pv)
    mu, mv = (av - pv) / length, (pu - au) / length
    for i in range(len(ring)):
        j = i + 1 if i + 1 < len(ring) else 0
        bu, bv = ring[j, 0], ring[j, 1]
        length = math.hypot(bu - au, bv - av)
        if length == 0.0:
            continue
        nu, nv = (bv - av) / length, (au - bu) / length
        if nv > 0.0:
            segments[ns, _LEFT_U], segments[ns, _LEFT_V] = bu, bv
            segments[ns, _RIGHT_U], segments[ns, _RIGHT_V] = au, av
            segments[ns, _NORMAL_U], segments[ns, _NORMAL_V] = nu, nv
            ns += 1
        if mu * nv - mv * nu >= 0.0 and (mv > 0.0 or nv > 0.0 or (mu > 0.0 and nu < 0.0 and mv == nv)):
            corners[nc, _U], corners[nc, _V] = au, av
            corners[nc, _RIGHT_NORMAL_U], corners[nc, _RIGHT_NORMAL_V] = (mu, mv) if mv > 0.0 else (1.0, 0.0)
            corners[nc, _LEFT_NORMAL_U], corners[nc, _LEFT_NORMAL_V] = (nu, nv) if nv > 0.0 else (-1.0, 0.0)
            nc += 1
        au, av, mu, mv = bu, bv, nu, nv
    return ns, nc


@helper
def _sort_rows(rows: FloatArray) -> None:
    """Put rows in the order of their first number."""
    before = rows.copy()
    order = order_of(before[:, 0])
    for i in range(len(rows)):
        for column in range(rows.shape[1]):
            rows[i, column] = before[order[i], column]


@helper
def _first_from(numbers: FloatArray, least: float) -> int:
    """The first of some numbers that do not decrease that is at least this."""
    low, high = 0, len(numbers)
    while low < high:
        middle = (low + high) // 2
        if numbers[middle] < least:
            low = middle + 1
        else:
            high = middle
    return low


@helper
def _outline(s: float, d2: float, end: ToolEnd) -> float:
    """Height of the tool above its lowest point, at an offset s along a plane that is sqrt(d2) off its axis."""
    disc, corner = end
    if disc == 0.0:
        return corner - math.sqrt(max(0.0, corner * corner - d2 - s * s))
    over = math.sqrt(d2 + s * s) - disc
    return 0.0 if over <= 0.0 else corner - math.sqrt(max(0.0, corner * corner - over * over))


@helper
def _touch_table(d2: float, end: ToolEnd, width: float, offset: FloatArray, slope: FloatArray) -> None:
    """Offsets along the outline and the slopes there, from flat to upright."""
    disc, corner = end
    flat = math.sqrt(max(0.0, disc * disc - d2))
    for k in range(_TABLE):
        part = math.sin(0.5 * math.pi * k / (_TABLE - 1))
        s = flat + (width - flat) * part
        radius = math.sqrt(d2 + s * s)
        over = radius - disc
        offset[k] = s
        rest = corner * corner - over * over
        if k == _TABLE - 1 or rest <= 0.0:
            slope[k] = math.inf
        else:
            slope[k] = 0.0 if over <= 0.0 else over / math.sqrt(rest) * s / radius


@helper
def _touch(nu: float, nv: float, offset: FloatArray, slope: FloatArray) -> float:
    """Offset of the axis of a tool with a flat bottom from where it touches a side with this normal."""
    side = 1.0 if nu > 0.0 else -1.0
    if nu == 0.0:
        return 0.0
    if nv <= 0.0:
        return side * offset[-1]
    wanted = abs(nu) / nv
    k = np.searchsorted(slope, wanted)
    if k == 0:
        return side * offset[0]
    if k >= _TABLE - 1:
        return side * offset[_TABLE - 2] if wanted < math.inf else side * offset[-1]
    share = (wanted - slope[k - 1]) / (slope[k] - slope[k - 1])
    return side * (offset[k - 1] + share * (offset[k] - offset[k - 1]))


@helper
def _shifts(
    normals_u: FloatArray,
    normals_v: FloatArray,
    rho: float,
    ball: bool,
    offset: FloatArray,
    slope: FloatArray,
    shifts: FloatArray,
) -> None:
    """Offsets of the tool's axis along the plane from the points where it touches sides with these normals."""
    if ball:
        for i in range(len(normals_u)):
            shifts[i] = rho * normals_u[i]
    else:
        for i in range(len(normals_u)):
            shifts[i] = _touch(normals_u[i], normals_v[i], offset, slope)


@njit
def _spans(
    left: FloatArray,
    right: FloatArray,
    left_shifts: FloatArray,
    right_shifts: FloatArray,
    samples: SampleRow,
    first: FloatArray,
    last: FloatArray,
) -> None:
    """First and last sample that each piece covers; the first is beyond the last where it covers none.

    Most pieces of fine meshes cover none, so this loop has no branches: the compiler makes it do several at once.
    """
    start, inverse, most = samples.start, 1.0 / samples.step, samples.length - 1.0
    for i in range(len(left)):
        first[i] = max(0.0, np.ceil((left[i] + left_shifts[i] - start) * inverse - _TIE))
        last[i] = min(most, np.floor((right[i] + right_shifts[i] - start) * inverse + _TIE))


@helper
def _section_row(
    segments: FloatArray,
    corners: FloatArray,
    bounds: _Bounds,
    d2: float,
    end: ToolEnd,
    samples: SampleRow,
    work: _Work,
    row: FloatArray,
) -> None:
    """Raise a row of heights to the profile of one section, inflated by the tool's section at a distance sqrt(d2)."""
    start, step, n = samples
    radius = end.disc + end.corner
    width = math.sqrt(radius * radius - d2)
    ball = end.disc == 0.0
    offset, slope, pieces = work.offset, work.slope, work.pieces
    if not ball:
        _touch_table(d2, end, width, offset, slope)
    low, high = start - _TIE * step - width, start + (n - 1 + _TIE) * step + width
    a = bounds.segment + _first_from(segments[_REACH, bounds.segment : bounds.segment_end], low)
    b = a + _first_from(segments[_LEFT_U, a : bounds.segment_end], high)
    shifts, firsts, lasts = pieces[0, : b - a], pieces[2, : b - a], pieces[3, : b - a]
    _shifts(segments[_NORMAL_U, a:b], segments[_NORMAL_V, a:b], width, ball, offset, slope, shifts)
    _spans(segments[_LEFT_U, a:b], segments[_RIGHT_U, a:b], shifts, shifts, samples, firsts, lasts)
    for i in range(b - a):
        if firsts[i] <= lasts[i]:
            climb = -segments[_NORMAL_U, a + i] / segments[_NORMAL_V, a + i]
            left = segments[_LEFT_U, a + i] + shifts[i]
            height = segments[_LEFT_V, a + i] - _outline(shifts[i], d2, end) + climb * (start - left)
            climb *= step
            for k in range(int(firsts[i]), int(lasts[i]) + 1):
                row[k] = max(row[k], height + climb * k)
    a = bounds.corner + _first_from(corners[_U, bounds.corner : bounds.corner_end], low)
    b = a + _first_from(corners[_U, a : bounds.corner_end], high)
    rights, lefts, firsts, lasts = pieces[0, : b - a], pieces[1, : b - a], pieces[2, : b - a], pieces[3, : b - a]
    _shifts(corners[_RIGHT_NORMAL_U, a:b], corners[_RIGHT_NORMAL_V, a:b], width, ball, offset, slope, rights)
    _shifts(corners[_LEFT_NORMAL_U, a:b], corners[_LEFT_NORMAL_V, a:b], width, ball, offset, slope, lefts)
    _spans(corners[_U, a:b], corners[_U, a:b], lefts, rights, samples, firsts, lasts)
    corner, rho2 = end.corner, end.corner * end.corner - d2
    for i in range(b - a):
        if firsts[i] <= lasts[i]:
            u, v = corners[_U, a + i], corners[_V, a + i]
            for k in range(int(firsts[i]), int(lasts[i]) + 1):
                s = start + step * k - u
                if ball:
                    row[k] = max(row[k], v - corner + math.sqrt(max(0.0, rho2 - s * s)))
                else:
                    row[k] = max(row[k], v - _outline(s, d2, end))


@helper
def _bend(y: FloatArray, rows: FloatArray, j: int, i: int) -> float:
    """Half the second derivative across sections j - 1, j, j + 1; NaN where one of them is missing."""
    if j < 1 or j + 1 >= len(rows) or not (rows[j - 1, i] > -math.inf and rows[j + 1, i] > -math.inf):
        return math.nan
    h1, h2 = y[j] - y[j - 1], y[j + 1] - y[j]
    if h1 < _SAME_MM or h2 < _SAME_MM:
        return math.nan
    return ((rows[j + 1, i] - rows[j, i]) / h2 - (rows[j, i] - rows[j - 1, i]) / h1) / (h1 + h2)


@helper
def _between(y: FloatArray, rows: FloatArray, j: int, i: int) -> float:
    """By how much a smooth part is higher between sections than at section j, the highest."""
    bend = _bend(y, rows, j, i)
    if not bend < 0.0:
        return 0.0
    for other in (_bend(y, rows, j - 1, i), _bend(y, rows, j + 1, i)):
        if not (other < bend / _ALIKE and other > bend * _ALIKE):
            return 0.0
    climb = (rows[j, i] - rows[j - 1, i]) / (y[j] - y[j - 1]) + bend * (y[j] - y[j - 1])
    return -0.25 * climb * climb / bend


@helper
def _within_reach(positions: FloatArray, plane: float, radius: float) -> tuple[int, int]:
    """First and one past the last section that a tool at a plane can touch."""
    first = np.searchsorted(positions, plane - radius, side="right")
    return int(first), int(np.searchsorted(positions, plane + radius, side="left"))


@helper
def _highest(y: FloatArray, rows: FloatArray, smooth: bool, heights: FloatArray, best: NDArray[np.int64]) -> None:
    """The highest of all rows at every sample, and which it is."""
    heights[:] = -math.inf
    best[:] = -1
    for j in range(len(rows)):
        for i in range(len(heights)):
            if rows[j, i] > heights[i]:
                heights[i] = rows[j, i]
                best[i] = j
    if smooth:
        for i in range(len(heights)):
            if best[i] >= 0:
                heights[i] += _between(y, rows, best[i], i)


@helper
def _profile_row(segments: FloatArray, begin: int, end: int, samples: SampleRow, row: FloatArray) -> None:
    """Heights of a section itself, whose segments are given by where they begin and end."""
    start, step, _ = samples
    row[:] = -math.inf
    far = start + (len(row) - 1 + _TIE) * step
    for i in range(begin + _first_from(segments[_REACH, begin:end], start - _TIE * step), end):
        if segments[_LEFT_U, i] > far:
            break
        first = max(0, math.ceil((segments[_LEFT_U, i] - start) / step - _TIE))
        last = min(len(row) - 1, math.floor((segments[_RIGHT_U, i] - start) / step + _TIE))
        climb = -segments[_NORMAL_U, i] / segments[_NORMAL_V, i]
        for k in range(first, last + 1):
            row[k] = max(row[k], segments[_LEFT_V, i] + climb * (start + step * k - segments[_LEFT_U, i]))


@helper
def _most_pieces(segment_begins: NDArray[np.int64], corner_begins: NDArray[np.int64]) -> int:
    """Most segments or corners of a section."""
    most = 0
    for k in range(len(segment_begins) - 1):
        most = max(most, segment_begins[k + 1] - segment_begins[k], corner_begins[k + 1] - corner_begins[k])
    return most


@helper
def _work(pieces: Pieces, rows: int, samples: int) -> _Work:
    most = _most_pieces(pieces.segment_begins, pieces.corner_begins)
    return _Work(
        np.empty(_TABLE), np.empty(_TABLE), np.empty((4, most)), np.empty((rows, samples)), np.empty((2, samples))
    )


@helper
def _raise_ends(
    pieces: Pieces, plane: float, radius: float, samples: SampleRow, pair: FloatArray, heights: FloatArray
) -> None:
    """The rim of a flat bottom where it runs nearly along the sections: at its ends, farthest from the plane.

    There it turns far from one section to the next, so points on it between sections are evaluated, on the part
    between these.
    """
    positions = pieces.positions
    for side in (-1.0, 1.0):
        outer = int(np.searchsorted(positions, plane + side * radius)) - (1 if side < 0.0 else 0)
        for number in range(_END_GAPS):
            k, inner = outer - int(side) * number, outer - int(side) * (number + 1)
            if min(k, inner) < 0 or max(k, inner) >= len(positions) or abs(positions[k] - positions[inner]) < _SAME_MM:
                continue
            if side * (positions[k] - plane) <= -radius:
                break
            far = math.asin(min(1.0, side * (positions[k] - plane) / radius))
            near = math.asin(max(-1.0, side * (positions[inner] - plane) / radius))
            for i in range(0 if number == 0 else 1, _END_POINTS):
                angle = far + (near - far) * i / _END_POINTS
                at = plane + side * radius * math.sin(angle)
                for turn in (-1.0, 1.0):
                    begin = samples.start + turn * radius * math.cos(angle)
                    moved = SampleRow(begin, samples.step, samples.length)
                    _raise_between(pieces, (k, inner), at, moved, pair, heights)


@helper
def _raise_between(
    pieces: Pieces,
    neighbours: tuple[int, int],
    at: float,
    samples: SampleRow,
    pair: FloatArray,
    heights: FloatArray,
) -> None:
    """Raise heights to the part between two sections, if there is no wall between these.

    Args:
        neighbours: numbers of the sections.
        at: position between them.
        pair: work array, shape (2, n).
    """
    k, other = neighbours
    segments, begins, positions = pieces.segments, pieces.segment_begins, pieces.positions
    _profile_row(segments, begins[k], begins[k + 1], samples, pair[0])
    _profile_row(segments, begins[other], begins[other + 1], samples, pair[1])
    gap = positions[other] - positions[k]
    share = (at - positions[k]) / gap
    for i in range(len(heights)):
        if pair[0, i] > -math.inf and abs(pair[1, i] - pair[0, i]) <= _CLIFF * abs(gap):
            heights[i] = max(heights[i], pair[0, i] + share * (pair[1, i] - pair[0, i]))


@helper
def _raise_rows(
    pieces: Pieces, end: ToolEnd, plane: float, first: int, last: int, samples: SampleRow, work: _Work
) -> None:
    """Heights of the tool at a plane over each of the sections ``first`` to ``last - 1``, in rows of ``work``."""
    segments, segment_begins = pieces.segments, pieces.segment_begins
    corners, corner_begins = pieces.corners, pieces.corner_begins
    positions, rows = pieces.positions, work.rows
    for k in range(first, last):
        bounds = _Bounds(segment_begins[k], segment_begins[k + 1], corner_begins[k], corner_begins[k + 1])
        row = rows[k - first]
        row[:] = -math.inf
        _section_row(segments, corners, bounds, (plane - positions[k]) ** 2, end, samples, work, row)


@njit
def envelope(
    pieces: Pieces,
    end: ToolEnd,
    planes: FloatArray,
    samples: SampleRow,
    smooth: bool,
    heights: FloatArray,
    best: NDArray[np.int64],
) -> None:
    """Heights of the tool's lowest point over a part.

    Args:
        planes: shape (p,), where the tool's axis runs.
        samples: along the planes.
        smooth: whether heights are interpolated between sections where these change smoothly.
        heights: shape (p, n), filled; -inf where the tool touches nothing.
        best: shape (p, n), filled with the section that is touched, -1 for none.
    """
    positions, radius = pieces.positions, end.disc + end.corner
    most = 0
    for p in range(len(planes)):
        first, last = _within_reach(positions, planes[p], radius)
        most = max(most, last - first)
    work = _work(pieces, most, samples.length)
    for p in range(len(planes)):
        first, last = _within_reach(positions, planes[p], radius)
        _raise_rows(pieces, end, planes[p], first, last, samples, work)
        _highest(positions[first:last], work.rows[: last - first], smooth, heights[p], best[p])
        if smooth and end.corner == 0.0:
            _raise_ends(pieces, planes[p], radius, samples, work.pair, heights[p])
        for i in range(heights.shape[1]):
            if best[p, i] >= 0:
                best[p, i] += first


@njit
def refine(
    pieces: Pieces,
    end: ToolEnd,
    cells: FloatArray,
    touched: NDArray[np.int64],
    step: float,
    smooth: bool,
    heights: FloatArray,
) -> None:
    """Heights at finer samples within some cells, over the sections touched at the cells' ends and their neighbours.

    Args:
        cells: shape (c, 2): plane and first sample of each cell.
        touched: shape (c, 2): the sections touched at its ends, -1 for none.
        step: distance of the finer samples.
        heights: shape (c, n), filled; -inf where the tool touches nothing.
    """
    positions, radius, n = pieces.positions, end.disc + end.corner, heights.shape[1]
    work, here, best = _work(pieces, 2 * _EVALUATED, n), np.empty(n), np.empty(n, dtype=np.int64)
    for c in range(len(cells)):
        heights[c] = -math.inf
        plane, samples = cells[c, 0], SampleRow(cells[c, 1], step, n)
        begin, stop = _within_reach(positions, plane, radius)
        low, high = min(touched[c, 0], touched[c, 1]), max(touched[c, 0], touched[c, 1])
        together = low >= 0 and high - low < _EVALUATED
        for side in range(1 if together or low == high else 2):
            a, b = (low, high) if together else (touched[c, side], touched[c, side])
            if b < 0:
                continue
            first, last = max(begin, a - _EVALUATED // 2), min(stop, b + _EVALUATED // 2 + 1)
            last = max(first, last)
            _raise_rows(pieces, end, plane, first, last, samples, work)
            _highest(positions[first:last], work.rows[: last - first], smooth, here, best)
            for i in range(n):
                heights[c, i] = max(heights[c, i], here[i])
        if smooth and end.corner == 0.0:
            _raise_ends(pieces, plane, radius, samples, work.pair, heights[c])
