"""Sections inflated by a radius that depends on their distance, and united: the tri-slice paper, eq. 1."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import TypeAlias

import numpy as np
import shapely
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.polygons.guards import guarded
from twin.geometry.polygons.shapes import Shape, Shapes
from twin.geometry.threads import run_all

#: Neighbours compared at a time.
_PAIRS = 16
#: Least radius that a section is inflated by to hold its neighbour, mm; how often it is doubled, and then halved.
_LEAST_MM = 1e-4
_DOUBLINGS, _HALVINGS = 9, 3
#: From heights above a plane to radii, NaN out of reach.
Radii: TypeAlias = Callable[[FloatArray], FloatArray]


def arc_segments(radius_mm: float, chord_mm: float) -> int:
    """Segments of a quarter circle for which no chord deviates inwards by more than ``chord_mm``."""
    half = math.acos(max(0.0, 1.0 - chord_mm / radius_mm))
    return max(2, math.ceil(0.25 * math.pi / half))


class Convolution:
    """Sections ready to be inflated by the radius that belongs to their distance, and united (eq. 1).

    Sections made redundant by a neighbour are omitted, see `margins`: that changes only the positions of chords.
    """

    def __init__(
        self,
        shapes: Shapes,
        positions_mm: FloatArray,
        radii: Radii,
        radius_mm: float,
        chord_mm: float,
        *,
        threads: int | None = None,
        edges: Shapes | None = None,
    ) -> None:
        """Compare neighbours.

        Args:
            shapes: sections at ``positions_mm``, which increase.
            positions_mm: shape (n,).
            radii: from heights above a plane to radii, NaN out of reach.
            radius_mm: the largest of these.
            chord_mm: inward deviation allowed for chords of the largest arcs.
            threads: threads to work with, all cores if None.
            edges: the sections' boundaries, where these are less than the polygons': without a frame that represents
                the surroundings.
        """
        shapes = guarded(shapes, radius_mm)
        self._shapes, self._positions, self._radii = shapes, positions_mm, radii
        self._segments = arc_segments(radius_mm, chord_mm)
        self._threads = threads
        self._some = ~shapely.is_empty(shapes)
        shapely.bounds(shapes)  # boxes are cached at the first call, which threads must not do concurrently
        self._up, self._down = margins(shapes, shapely.boundary(shapes) if edges is None else edges, threads)

    def on(self, planes_mm: FloatArray) -> Shapes:
        """The union on every plane."""
        made = np.empty(len(planes_mm), dtype=object)
        made[:] = run_all([partial(self._plane, at) for at in planes_mm.tolist()], self._threads)
        return made

    def _plane(self, at_mm: float) -> Shape:
        radius = self._radii(self._positions - at_mm)
        wanted = needed(radius, self._up, self._down) & self._some
        return shapely.union_all(shapely.buffer(self._shapes[wanted], radius[wanted], quad_segs=self._segments))


def margins(shapes: Shapes, edges: Shapes, threads: int | None) -> tuple[FloatArray, FloatArray]:
    """By how much sections lie inside their neighbours, or protrude from them.

    A section inflated by r lies inside of its neighbour inflated by q as soon as r - q is not above the margin: where
    the section is inside, the margin is its distance from the neighbour's boundary; where it protrudes, minus the
    radius that the neighbour must be inflated by to hold it, found by trying, up to a tenth too large. Sections at
    jumps are not omitted: there is no such radius, or a large one.

    Returns:
        margins of each section in the next, and of each in the last one before it; -inf where there is none.
    """
    up, down = np.full(len(shapes), -np.inf), np.full(len(shapes), -np.inf)

    def some(first: int) -> None:
        last = min(first + _PAIRS, len(shapes) - 1)
        same = np.array([a is b for a, b in pairwise(shapes[first : last + 1])], dtype=bool)
        # GEOS builds indexes in prepared polygons when it first needs them: threads must not share these
        own, lines = _copies(shapes[first : last + 1]), _copies(edges[first : last + 1])
        shapely.prepare(own)
        apart = np.where(same, 0.0, np.nan_to_num(shapely.distance(lines[:-1], lines[1:]), nan=0.0))
        up[first:last] = _margins_in(own[:-1], own[1:], same, apart)
        down[first + 1 : last + 1] = _margins_in(own[1:], own[:-1], same, apart)

    run_all([partial(some, first) for first in range(0, len(shapes) - 1, _PAIRS)], threads)
    return up, down


def _copies(shapes: Shapes) -> Shapes:
    """Polygons or lines that share nothing with the given ones."""
    return np.asarray(shapely.from_wkb(shapely.to_wkb(shapes)), dtype=object)


def _margins_in(shapes: Shapes, others: Shapes, same: NDArray[np.bool_], apart: FloatArray) -> FloatArray:
    found = np.full(len(shapes), -np.inf)
    inside = same | shapely.covers(others, shapes)
    found[inside] = apart[inside]
    out = np.flatnonzero(~inside & ~shapely.is_empty(others))
    found[out] = -_holding(shapes[out], others[out], apart[out])
    return found


def _holding(shapes: Shapes, others: Shapes, apart: FloatArray) -> FloatArray:
    """Radius by which each of the others must be inflated to hold a shape, up to a tenth more; inf where it is large.

    Doubled from a little above the distance of the boundaries until it does, then halved.
    """
    fails, holds = np.zeros(len(shapes)), np.full(len(shapes), np.inf)
    radius = 1.05 * apart + _LEAST_MM
    for step in range(_DOUBLINGS + _HALVINGS):
        todo = np.flatnonzero(~np.isfinite(holds) if step < _DOUBLINGS else (fails > 0.0) & np.isfinite(holds))
        held = np.zeros(len(shapes), dtype=bool)
        held[todo] = shapely.covers(shapely.buffer(others[todo], radius[todo]), shapes[todo])
        holds[held] = radius[held]
        missed = np.setdiff1d(todo, np.flatnonzero(held))
        fails[missed] = radius[missed]
        radius = np.where(np.isfinite(holds), np.sqrt(fails * np.where(np.isfinite(holds), holds, 0.0)), 2.0 * radius)
    return holds


def needed(radius_mm: FloatArray, up: FloatArray, down: FloatArray) -> NDArray[np.bool_]:
    """Sections within reach that no neighbour makes redundant; of two equal ones the first is kept.

    Args:
        radius_mm: radius of each section, NaN out of reach.
        up, down: see `margins`.
    """
    keep = ~np.isnan(radius_mm)
    more = radius_mm[:-1] - radius_mm[1:]
    by_next, by_last = more <= up[:-1], -more <= down[1:]
    keep[:-1] &= ~(by_next & ~by_last)
    keep[1:] &= ~by_last
    return keep
