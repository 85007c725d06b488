"""Pockets of all levels as trees, and the rings that clear one of them.

The free area of a level falls into parts, here pockets; each lies below one of the level above. A pocket is cleared
with all that lies under it before the next one is begun, so the tool does not travel between them level by level.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from twin.arrays import FloatArray, places_in_runs
from twin.cam.passes.level_free_areas import CHORD_MM
from twin.geometry.polygons.free_area import FreeArea, a_point_of, borders, has_point, shrunk, size_of
from twin.geometry.polygons.outline import Area, pieces


@dataclass(slots=True, eq=False)
class Pocket:
    """One part of a level's free area.

    Attributes:
        level: number of the level, from the top.
        area: polygon of the tool's axis.
        below: the pockets under it.
    """

    level: int
    area: Area
    below: list[Pocket] = field(default_factory=list)


def pocket_forest(free_areas: Sequence[FreeArea], least_mm2: float) -> list[Pocket]:
    """The pockets of the first level that each belongs to, with those below.

    Args:
        least_mm2: pockets smaller than this are omitted, for a tool cannot enter them; those below them too.
    """
    tops: list[Pocket] = []
    last: list[Pocket] = []
    for number, free_area in enumerate(free_areas):
        here = [Pocket(number, p) for p in pieces(free_area.area) if size_of(p) >= least_mm2]
        for pocket in here:
            point = a_point_of(pocket.area)
            parent = next((p for p in last if has_point(p.area, point)), None)
            if parent is not None:
                parent.below.append(pocket)
            elif number == 0:
                tops.append(pocket)
        last = here
    return tops


def in_depth(tops: Sequence[Pocket], start_mm: FloatArray) -> Iterator[Pocket]:
    """Each pocket before those below it; of neighbours the nearest first."""
    at = start_mm
    left = list(tops)
    while left:
        points = [_nearest(p.area, at) for p in left]
        k = int(np.argmin([np.linalg.norm(p - at) for p in points]))
        pocket = left.pop(k)
        yield pocket
        at = points[k]
        for lower in in_depth(pocket.below, at):
            yield lower
            at = _nearest(lower.area, at)


def _nearest(polygon: Area, point_mm: FloatArray) -> FloatArray:
    """The vertex of a polygon's outer ring nearest to a point."""
    ring = next(borders(polygon))
    nearest: FloatArray = ring[int(np.argmin(np.linalg.norm(ring - point_mm, axis=1)))]
    return nearest


def clearing_rings(
    pocket: Area, radial_depth_mm: float, start_mm: FloatArray | None, *, outwards: bool
) -> list[FloatArray]:
    """Closed lines that clear a pocket: its border, and borders further in by the radial depth until nothing is left.

    Args:
        start_mm: where the tool comes from, for the order.
        outwards: from the innermost ring out; else from the border inwards.

    Returns:
        lines with the pocket on their left, shape (n, 2), first and last point the same; each begins near the end of
        the one before.
    """
    ordered: list[FloatArray] = []
    at = start_mm
    for ring in _rings(pocket, radial_depth_mm, at, outwards):
        line = begun_near(ring, at)
        ordered.append(line)
        at = line[-1]
    return ordered


def _rings(area: Area, depth_mm: float, at: FloatArray | None, outwards: bool) -> Iterator[FloatArray]:
    """The rings of the tree of shrunk areas, children first where the tool goes outwards."""
    own = list(borders(area))
    if not outwards:
        yield from own
        at = own[-1][-1]
    left = shrunk(area, depth_mm, CHORD_MM)
    while left:
        k = 0 if at is None else int(np.argmin([np.linalg.norm(_nearest(p, at) - at) for p in left]))
        for ring in _rings(left.pop(k), depth_mm, at, outwards):
            yield ring
            at = ring[-1]
    if outwards:
        yield from reversed(own)


def begun_near(line_mm: FloatArray, point_mm: FloatArray | None) -> FloatArray:
    """A closed line begun at its vertex nearest to a point."""
    if point_mm is None or np.any(line_mm[0] != line_mm[-1]):
        return line_mm
    k = int(np.argmin(np.linalg.norm(line_mm - point_mm, axis=1)))
    return np.concatenate((line_mm[k:-1], line_mm[: k + 1]))


def subdivided(line_mm: FloatArray, longest_mm: float) -> FloatArray:
    """A line whose pieces are no longer than a length: further points on the long ones (the mold paper, its Fig. 5)."""
    lengths = np.linalg.norm(np.diff(line_mm, axis=0), axis=1)
    counts = np.maximum(1, np.ceil(lengths / longest_mm - 1e-9)).astype(np.int64)
    first = np.repeat(np.arange(len(counts)), counts)
    part = (places_in_runs(counts) / counts[first])[:, None]
    points = line_mm[first] * (1.0 - part) + line_mm[first + 1] * part
    return np.concatenate((points, line_mm[-1:]))
