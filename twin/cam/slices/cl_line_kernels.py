"""How low a tool can go over a part's slices: upper envelope of profiles inflated by its sections; compiled.

A profile is the upper boundary of one section, as segments and convex corners. Inflated by a convex section of the
tool, a segment is moved by the point of the tool that touches it, and a corner becomes a piece of the tool's own
outline, from the point that touches one side to the point that touches the other. The envelope of all pieces of all
sections in reach is the inflated part's upper boundary (the tri-slice paper, eq. 1), known at evenly spaced places.

Heights of the tool's outline at a distance from its axis: 0 within the disc, then a corner arc.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import njit

#: Nodes of the table that finds where a bull-nose tool touches a slope.
_TABLE = 65
#: How alike neighbouring curvatures must be, for heights between sections to be interpolated.
_ALIKE = 4.0
#: Sections asked within a cell: the one touched at an end, and those beside it.
_ASKED = 5
#: Slope between two sections above which there is a wall between them.
_CLIFF = 5.0
#: Gaps between sections at either end of a flat rim where it is asked between sections, and places in each.
_END_GAPS, _END_PLACES = 3, 4
#: Part of a step by which pieces reach further, so that a tool that just touches a wall counts as touching it.
_TIE = 1e-7
#: Sections closer than this are taken for one, mm.
_SAME_MM = 1e-7


@njit
def profile_pieces(
    points: FloatArray,
    rings: NDArray[np.int64],
    sections: NDArray[np.int64],
    segments: FloatArray,
    segment_begins: NDArray[np.int64],
    corners: FloatArray,
    corner_begins: NDArray[np.int64],
) -> None:
    """Upper segments and convex corners of every section.

    Args:
        points: shape (n, 2), rings one after the other, material on the left.
        rings: where each ring begins, and the end.
        sections: the first ring of each section, and the end.
        segments: shape (n, 7), filled with rows u, v of the left end, u, v of the right end, outward normal, and how
            far the section's rows up to this one reach to the right; increasing in u of the left end.
        corners: shape (n, 6), filled with rows u, v, normal of the side to the right, normal of the side to the left;
            increasing in u.
        segment_begins, corner_begins: filled with where each section's rows begin, and the end.
    """
    ns, nc = 0, 0
    for k in range(len(sections) - 1):
        segment_begins[k], corner_begins[k] = ns, nc
        for r in range(sections[k], sections[k + 1]):
            first, last = rings[r], rings[r + 1]
            pu, pv = points[last - 1, 0], points[last - 1, 1]
            au, av = points[first, 0], points[first, 1]
            length = math.hypot(au - pu, av - pv)
            mu, mv = (av - pv) / length, (pu - au) / length
            for i in range(first, last):
                j = i + 1 if i + 1 < last else first
                bu, bv = points[j, 0], points[j, 1]
                length = math.hypot(bu - au, bv - av)
                if length == 0.0:
                    continue
                nu, nv = (bv - av) / length, (au - bu) / length
                if nv > 0.0:
                    segments[ns, 0], segments[ns, 1] = bu, bv
                    segments[ns, 2], segments[ns, 3] = au, av
                    segments[ns, 4], segments[ns, 5] = nu, nv
                    ns += 1
                if mu * nv - mv * nu >= 0.0 and (mv > 0.0 or nv > 0.0 or (mu > 0.0 and nu < 0.0 and mv == nv)):
                    corners[nc, 0], corners[nc, 1] = au, av
                    corners[nc, 2], corners[nc, 3] = (mu, mv) if mv > 0.0 else (1.0, 0.0)
                    corners[nc, 4], corners[nc, 5] = (nu, nv) if nv > 0.0 else (-1.0, 0.0)
                    nc += 1
                au, av, mu, mv = bu, bv, nu, nv
        _sort_rows(segments[segment_begins[k] : ns])
        _sort_rows(corners[corner_begins[k] : nc])
        reach = -math.inf
        for i in range(segment_begins[k], ns):
            reach = max(reach, segments[i, 2])
            segments[i, 6] = reach
    segment_begins[len(sections) - 1], corner_begins[len(sections) - 1] = ns, nc


@njit
def _sort_rows(rows: FloatArray) -> None:
    """Put rows in the order of their first number."""
    order = np.argsort(rows[:, 0], kind="mergesort")
    rows[:] = rows.copy()[order]


@njit
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


@njit
def _outline(s: float, d2: float, disc: float, corner: float) -> float:
    """Height of the tool above its lowest point, at a place s along a plane that is sqrt(d2) off its axis."""
    if disc == 0.0:
        return corner - math.sqrt(max(0.0, corner * corner - d2 - s * s))
    over = math.sqrt(d2 + s * s) - disc
    return 0.0 if over <= 0.0 else corner - math.sqrt(max(0.0, corner * corner - over * over))


@njit
def _touch_table(d2: float, disc: float, corner: float, width: float, place: FloatArray, slope: FloatArray) -> None:
    """Places along the outline and the slopes there, from flat to upright."""
    flat = math.sqrt(max(0.0, disc * disc - d2))
    for k in range(_TABLE):
        part = math.sin(0.5 * math.pi * k / (_TABLE - 1))
        s = flat + (width - flat) * part
        radius = math.sqrt(d2 + s * s)
        over = radius - disc
        place[k] = s
        rest = corner * corner - over * over
        if k == _TABLE - 1 or rest <= 0.0:
            slope[k] = math.inf
        else:
            slope[k] = 0.0 if over <= 0.0 else over / math.sqrt(rest) * s / radius


@njit
def _touch(nu: float, nv: float, place: FloatArray, slope: FloatArray) -> float:
    """Where a tool with a flat bottom stands along the plane, from where it touches a side with this normal."""
    side = 1.0 if nu > 0.0 else -1.0
    if nu == 0.0:
        return 0.0
    if nv <= 0.0:
        return side * place[-1]
    wanted = abs(nu) / nv
    k = np.searchsorted(slope, wanted)
    if k == 0:
        return side * place[0]
    if k >= _TABLE - 1:
        return side * place[_TABLE - 2] if wanted < math.inf else side * place[-1]
    share = (wanted - slope[k - 1]) / (slope[k] - slope[k - 1])
    return side * (place[k - 1] + share * (place[k] - place[k - 1]))


@njit
def _shifts(
    normals_u: FloatArray,
    normals_v: FloatArray,
    rho: float,
    round_end: bool,
    place: FloatArray,
    slope: FloatArray,
    shifts: FloatArray,
) -> None:
    """Where the tool stands along the plane, from the points where it touches sides with these normals."""
    if round_end:
        for i in range(len(normals_u)):
            shifts[i] = rho * normals_u[i]
    else:
        for i in range(len(normals_u)):
            shifts[i] = _touch(normals_u[i], normals_v[i], place, slope)


@njit
def _spans(
    left: FloatArray,
    right: FloatArray,
    left_shifts: FloatArray,
    right_shifts: FloatArray,
    start: float,
    step: float,
    count: int,
    first: FloatArray,
    last: FloatArray,
) -> None:
    """First and last place that each piece covers; the first is beyond the last where it covers none.

    Most pieces of fine meshes cover none, so this loop has no branches: the compiler makes it do several at once.
    """
    inverse, most = 1.0 / step, count - 1.0
    for i in range(len(left)):
        first[i] = max(0.0, np.ceil((left[i] + left_shifts[i] - start) * inverse - _TIE))
        last[i] = min(most, np.floor((right[i] + right_shifts[i] - start) * inverse + _TIE))


@njit
def _section_row(
    segments: FloatArray,
    corners: FloatArray,
    pieces: tuple[int, int, int, int],
    d2: float,
    disc: float,
    corner: float,
    start: float,
    step: float,
    place: FloatArray,
    slope: FloatArray,
    work: FloatArray,
    row: FloatArray,
) -> None:
    """Raise a row of heights to the inflated profile of one section, whose rows are given by where they begin and end.

    ``work`` has four rows, as long as the most pieces of a section.
    """
    n = len(row)
    radius = disc + corner
    width = math.sqrt(radius * radius - d2)
    round_end = disc == 0.0
    if not round_end:
        _touch_table(d2, disc, corner, width, place, slope)
    low, high = start - _TIE * step - width, start + (n - 1 + _TIE) * step + width
    a = pieces[0] + _first_from(segments[6, pieces[0] : pieces[1]], low)
    b = a + _first_from(segments[0, a : pieces[1]], high)
    shifts, firsts, lasts = work[0, : b - a], work[2, : b - a], work[3, : b - a]
    _shifts(segments[4, a:b], segments[5, a:b], width, round_end, place, slope, shifts)
    _spans(segments[0, a:b], segments[2, a:b], shifts, shifts, start, step, n, firsts, lasts)
    for i in range(b - a):
        if firsts[i] <= lasts[i]:
            climb = -segments[4, a + i] / segments[5, a + i]
            left = segments[0, a + i] + shifts[i]
            height = segments[1, a + i] - _outline(shifts[i], d2, disc, corner) + climb * (start - left)
            climb *= step
            for k in range(int(firsts[i]), int(lasts[i]) + 1):
                row[k] = max(row[k], height + climb * k)
    a = pieces[2] + _first_from(corners[0, pieces[2] : pieces[3]], low)
    b = a + _first_from(corners[0, a : pieces[3]], high)
    rights, lefts, firsts, lasts = work[0, : b - a], work[1, : b - a], work[2, : b - a], work[3, : b - a]
    _shifts(corners[2, a:b], corners[3, a:b], width, round_end, place, slope, rights)
    _shifts(corners[4, a:b], corners[5, a:b], width, round_end, place, slope, lefts)
    _spans(corners[0, a:b], corners[0, a:b], lefts, rights, start, step, n, firsts, lasts)
    rho2 = corner * corner - d2
    for i in range(b - a):
        if firsts[i] <= lasts[i]:
            u, v = corners[0, a + i], corners[1, a + i]
            for k in range(int(firsts[i]), int(lasts[i]) + 1):
                s = start + step * k - u
                if round_end:
                    row[k] = max(row[k], v - corner + math.sqrt(max(0.0, rho2 - s * s)))
                else:
                    row[k] = max(row[k], v - _outline(s, d2, disc, corner))


@njit
def _bend(y: FloatArray, rows: FloatArray, j: int, i: int) -> float:
    """Half the second derivative across sections j - 1, j, j + 1; NaN where one of them is missing."""
    if j < 1 or j + 1 >= len(rows) or not (rows[j - 1, i] > -math.inf and rows[j + 1, i] > -math.inf):
        return math.nan
    h1, h2 = y[j] - y[j - 1], y[j + 1] - y[j]
    if h1 < _SAME_MM or h2 < _SAME_MM:
        return math.nan
    return ((rows[j + 1, i] - rows[j, i]) / h2 - (rows[j, i] - rows[j - 1, i]) / h1) / (h1 + h2)


@njit
def _between(y: FloatArray, rows: FloatArray, j: int, i: int) -> float:
    """How much higher than at section j, the highest, a smooth part is between sections."""
    bend = _bend(y, rows, j, i)
    if not bend < 0.0:
        return 0.0
    for other in (_bend(y, rows, j - 1, i), _bend(y, rows, j + 1, i)):
        if not (other < bend / _ALIKE and other > bend * _ALIKE):
            return 0.0
    climb = (rows[j, i] - rows[j - 1, i]) / (y[j] - y[j - 1]) + bend * (y[j] - y[j - 1])
    return -0.25 * climb * climb / bend


@njit
def _reach(positions: FloatArray, plane: float, radius: float) -> tuple[int, int]:
    """First and one past the last section that a tool at a plane can touch."""
    first = np.searchsorted(positions, plane - radius, side="right")
    return int(first), int(np.searchsorted(positions, plane + radius, side="left"))


@njit
def _highest(y: FloatArray, rows: FloatArray, smooth: bool, heights: FloatArray, best: NDArray[np.int64]) -> None:
    """The highest of all rows at every place, and which it is."""
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


@njit
def _profile_row(segments: FloatArray, begin: int, end: int, start: float, step: float, row: FloatArray) -> None:
    """Heights of a section itself, whose segments are given by where they begin and end."""
    row[:] = -math.inf
    far = start + (len(row) - 1 + _TIE) * step
    for i in range(begin + _first_from(segments[6, begin:end], start - _TIE * step), end):
        if segments[0, i] > far:
            break
        first = max(0, math.ceil((segments[0, i] - start) / step - _TIE))
        last = min(len(row) - 1, math.floor((segments[2, i] - start) / step + _TIE))
        climb = -segments[4, i] / segments[5, i]
        for k in range(first, last + 1):
            row[k] = max(row[k], segments[1, i] + climb * (start + step * k - segments[0, i]))


@njit
def _most_pieces(segment_begins: NDArray[np.int64], corner_begins: NDArray[np.int64]) -> int:
    """Most segments or corners of a section."""
    most = 0
    for k in range(len(segment_begins) - 1):
        most = max(most, segment_begins[k + 1] - segment_begins[k], corner_begins[k + 1] - corner_begins[k])
    return most


@njit
def _raise_ends(
    segments: FloatArray,
    segment_begins: NDArray[np.int64],
    positions: FloatArray,
    plane: float,
    radius: float,
    start: float,
    step: float,
    two: FloatArray,
    heights: FloatArray,
) -> None:
    """The rim of a flat bottom where it runs nearly along the sections: at its ends, farthest from the plane.

    There it turns far from one section to the next, so places on it between sections are asked, of the part between
    these.
    """
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
            for i in range(0 if number == 0 else 1, _END_PLACES):
                angle = far + (near - far) * i / _END_PLACES
                at = plane + side * radius * math.sin(angle)
                for turn in (-1.0, 1.0):
                    begin = start + turn * radius * math.cos(angle)
                    _raise_between(segments, segment_begins, positions, k, inner, at, begin, step, two, heights)


@njit
def _raise_between(
    segments: FloatArray,
    segment_begins: NDArray[np.int64],
    positions: FloatArray,
    k: int,
    other: int,
    at: float,
    start: float,
    step: float,
    two: FloatArray,
    heights: FloatArray,
) -> None:
    """Raise heights to the part between two sections, if there is no wall between these."""
    _profile_row(segments, segment_begins[k], segment_begins[k + 1], start, step, two[0])
    _profile_row(segments, segment_begins[other], segment_begins[other + 1], start, step, two[1])
    gap = positions[other] - positions[k]
    share = (at - positions[k]) / gap
    for i in range(len(heights)):
        if two[0, i] > -math.inf and abs(two[1, i] - two[0, i]) <= _CLIFF * abs(gap):
            heights[i] = max(heights[i], two[0, i] + share * (two[1, i] - two[0, i]))


@njit
def envelope(
    segments: FloatArray,
    segment_begins: NDArray[np.int64],
    corners: FloatArray,
    corner_begins: NDArray[np.int64],
    positions: FloatArray,
    planes: FloatArray,
    disc: float,
    corner: float,
    start: float,
    step: float,
    smooth: bool,
    heights: FloatArray,
    best: NDArray[np.int64],
) -> None:
    """Heights of the tool's lowest point over a part.

    Args:
        segments, corners: from `profile_pieces`, transposed: one row a column of it.
        segment_begins, corner_begins: from `profile_pieces`.
        positions: shape (m,), where the sections lie, increasing.
        planes: shape (p,), where the tool's axis runs.
        disc, corner: radius of the tool's bottom and of its corner arc.
        start, step: places along the planes at which heights are wanted.
        smooth: whether heights are interpolated between sections where these change smoothly.
        heights: shape (p, n), filled; -inf where the tool touches nothing.
        best: shape (p, n), filled with the section that is touched, -1 for none.
    """
    radius = disc + corner
    most = 0
    for p in range(len(planes)):
        first, last = _reach(positions, planes[p], radius)
        most = max(most, last - first)
    rows, two = np.empty((most, heights.shape[1])), np.empty((2, heights.shape[1]))
    place, slope = np.empty(_TABLE), np.empty(_TABLE)
    work = np.empty((4, _most_pieces(segment_begins, corner_begins)))
    for p in range(len(planes)):
        first, last = _reach(positions, planes[p], radius)
        near = rows[: last - first]
        near[:] = -math.inf
        for k in range(first, last):
            _section_row(
                segments,
                corners,
                (segment_begins[k], segment_begins[k + 1], corner_begins[k], corner_begins[k + 1]),
                (planes[p] - positions[k]) ** 2,
                disc,
                corner,
                start,
                step,
                place,
                slope,
                work,
                near[k - first],
            )
        _highest(positions[first:last], near, smooth, heights[p], best[p])
        if smooth and corner == 0.0:
            _raise_ends(segments, segment_begins, positions, planes[p], radius, start, step, two, heights[p])
        for i in range(heights.shape[1]):
            if best[p, i] >= 0:
                best[p, i] += first


@njit
def refine(
    segments: FloatArray,
    segment_begins: NDArray[np.int64],
    corners: FloatArray,
    corner_begins: NDArray[np.int64],
    positions: FloatArray,
    cells: FloatArray,
    sections: NDArray[np.int64],
    disc: float,
    corner: float,
    step: float,
    smooth: bool,
    heights: FloatArray,
) -> None:
    """Heights at finer places within some cells, of the sections touched at the cells' ends and those beside them.

    Args:
        cells: shape (c, 2): plane and first place of each cell.
        sections: shape (c, 2): the sections touched at its ends, -1 for none.
        step: distance of the finer places.
        heights: shape (c, n), filled; -inf where the tool touches nothing.
    """
    radius = disc + corner
    n = heights.shape[1]
    rows, two, here = np.empty((2 * _ASKED, n)), np.empty((2, n)), np.empty(n)
    best = np.empty(n, dtype=np.int64)
    beside = _ASKED // 2
    place, slope = np.empty(_TABLE), np.empty(_TABLE)
    work = np.empty((4, _most_pieces(segment_begins, corner_begins)))
    for c in range(len(cells)):
        heights[c] = -math.inf
        begin, end = _reach(positions, cells[c, 0], radius)
        low, high = min(sections[c, 0], sections[c, 1]), max(sections[c, 0], sections[c, 1])
        together = low >= 0 and high - low < _ASKED
        for side in range(1 if together or low == high else 2):
            a, b = (low, high) if together else (sections[c, side], sections[c, side])
            if b < 0:
                continue
            first, last = max(begin, a - beside), min(end, b + beside + 1)
            near = rows[: max(0, last - first)]
            near[:] = -math.inf
            for k in range(first, last):
                _section_row(
                    segments,
                    corners,
                    (segment_begins[k], segment_begins[k + 1], corner_begins[k], corner_begins[k + 1]),
                    (cells[c, 0] - positions[k]) ** 2,
                    disc,
                    corner,
                    cells[c, 1],
                    step,
                    place,
                    slope,
                    work,
                    near[k - first],
                )
            _highest(positions[first : max(first, last)], near, smooth, here, best)
            for i in range(n):
                heights[c, i] = max(heights[c, i], here[i])
        if smooth and corner == 0.0:
            plane, begin_at = cells[c, 0], cells[c, 1]
            _raise_ends(segments, segment_begins, positions, plane, radius, begin_at, step, two, heights[c])
