"""Arcs of plain lines: centres and feeds as `phases.arcs` computes them, for many arcs at once.

Lengths and angles whose last bit counts are computed by `math`, whose functions differ from numpy's in it. Comparisons
leave a margin: an arc near a limit is not accepted here, and is then decided by the block alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gcode.bulk.plain_rules import PlainRules, PlainStart
from gcode.control.coordinates import SAME_POSITION_MM
from gcode.events import PLANE_AXES

Floats = NDArray[np.float64]

#: Margin of comparisons, relative and in mm.
_MARGIN = 1e-9
#: Most that R may be too short beyond the control's tolerance; `phases.arcs` allows twice as much for rounding.
_ROUNDING_MM = 5e-10


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ArcWords:
    """k arcs as they are programmed.

    Attributes:
        start_mm: (k, 3) where each starts, machine coordinates.
        end_mm: (k, 3) where each ends.
        named: (k, 3) True for the axes that have a word.
        offset: (k, 3) numbers of I, J, K in the program's unit, nan without the word.
        radius: (k,) numbers of R, nan without it.
        turns: (k,) -1 for G2, +1 for G3.
        feed_mm_min: (k,) the F that holds.
    """

    start_mm: Floats
    end_mm: Floats
    named: NDArray[np.bool_]
    offset: Floats
    radius: Floats
    turns: NDArray[np.int64]
    feed_mm_min: Floats

    def before(self, count: int) -> ArcWords:
        """The first `count` of them."""
        return ArcWords(**{name: getattr(self, name)[:count] for name in self.__slots__})


def arc_centres(words: ArcWords, start: PlainStart, rules: PlainRules) -> tuple[Floats, NDArray[np.bool_]]:
    """Centres of arcs, machine coordinates, mm.

    Returns:
        (k, 3) centres, level with the start along the plane's normal, and (k,) True for the arcs that the control
        certainly accepts; the centres of others mean nothing.
    """
    i, j, normal = PLANE_AXES[start.plane]
    by_radius = ~np.isnan(words.radius)
    given = ~np.isnan(words.offset)
    accepted = (by_radius != given.any(axis=1)) & ~given[:, normal]
    if start.absolute_centres:
        accepted &= by_radius | (given[:, i] & given[:, j])
    if rules.needs_axis_words:
        accepted &= words.named[:, i] | words.named[:, j]
    centre = words.start_mm.copy()
    for axis in (i, j):
        origin = start.zero_mm[axis] if start.absolute_centres else words.start_mm[:, axis]
        centre[:, axis] = origin + np.where(given[:, axis], words.offset[:, axis] * start.unit_mm, 0.0)
    ends = words.start_mm[:, (i, j)], words.end_mm[:, (i, j)]
    accepted &= by_radius | (_radii_agree(ends, centre[:, (i, j)], start) & _closed_exactly(*ends))
    index = np.flatnonzero(by_radius)
    if index.size:
        chosen = ends[0][index], ends[1][index]
        centre[index[:, None], (i, j)], possible = _from_radius(
            chosen, words.radius[index] * start.unit_mm, words.turns[index], rules
        )
        accepted[index] &= possible
    return centre, accepted


def _radii_agree(ends: tuple[Floats, Floats], centre: Floats, start: PlainStart) -> NDArray[np.bool_]:
    first, last = (np.hypot(end[:, 0] - centre[:, 0], end[:, 1] - centre[:, 1]) for end in ends)
    tolerance = start.arc_tolerance
    largest = np.maximum(first, last)
    radius = first if tolerance.of_start_radius else largest
    limit = np.maximum(
        tolerance.absolute_mm, np.minimum(tolerance.relative * radius, tolerance.most * tolerance.absolute_mm)
    )
    agree: NDArray[np.bool_] = np.abs(first - last) <= limit * (1.0 - _MARGIN) - _MARGIN * 1e-3
    agree &= largest > 2.0 * SAME_POSITION_MM
    return agree


def _closed_exactly(first: Floats, last: Floats) -> NDArray[np.bool_]:
    """True but for arcs whose end is moved onto their start because rounding alone separates them."""
    exact: NDArray[np.bool_] = (first == last).all(axis=1) & (np.signbit(first) == np.signbit(last)).all(axis=1)
    exact |= np.hypot(*(last - first).T) > 2.0 * SAME_POSITION_MM
    return exact


def _from_radius(
    ends: tuple[Floats, Floats], radius: Floats, turns: NDArray[np.int64], rules: PlainRules
) -> tuple[Floats, NDArray[np.bool_]]:
    """Centres from R in the plane, and True where there certainly is one."""
    first, last = ends
    along, across = (last - first).T
    chord = hypot(along, across)
    possible = chord > 2.0 * SAME_POSITION_MM
    possible &= chord / 2.0 - np.abs(radius) <= rules.radius_tolerance_mm + _ROUNDING_MM
    height = np.sqrt(np.maximum(radius * radius - chord * chord / 4.0, 0.0))
    side = np.copysign(1.0, radius) * turns
    length = np.where(possible, chord, 1.0)
    centre = np.empty_like(first)
    centre[:, 0] = first[:, 0] + along / 2.0 - side * height * across / length
    centre[:, 1] = first[:, 1] + across / 2.0 + side * height * along / length
    return centre, possible


def path_feeds(words: ArcWords, centre: Floats, plane: int) -> Floats:
    """Feeds along the path of helices whose F is the feed along the arc in the plane, mm/min."""
    i, j, normal = PLANE_AXES[plane]
    first, last = words.start_mm - centre, words.end_mm - centre
    radius = hypot(first[:, i], first[:, j]) + hypot(last[:, i], last[:, j])
    begin, end = (arctangent(ends[:, j], ends[:, i]) for ends in (first, last))
    swept = (words.turns * (end - begin)) % (2.0 * math.pi)
    closed = (words.start_mm[:, (i, j)] == words.end_mm[:, (i, j)]).all(axis=1)
    arc = np.where(closed | (swept == 0.0), 2.0 * math.pi, swept) * radius / 2.0
    return words.feed_mm_min * hypot(arc, words.end_mm[:, normal] - words.start_mm[:, normal]) / arc


def hypot(a: Floats, b: Floats) -> Floats:
    """Python's ``hypot`` of each pair, to the last bit."""
    return np.fromiter(map(math.hypot, a.tolist(), b.tolist()), np.float64, len(a))


def arctangent(a: Floats, b: Floats) -> Floats:
    """Python's ``atan2`` of each pair, to the last bit."""
    return np.fromiter(map(math.atan2, a.tolist(), b.tolist()), np.float64, len(a))
