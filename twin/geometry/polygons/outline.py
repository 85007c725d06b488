"""Areas and lines on a plane by GEOS: offset areas, their outlines inside a window, lines inside an area."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
import shapely

from twin.arrays import FloatArray
from twin.geometry.polygons.clip import DECIMALS

#: A shapely polygon or multipolygon.
Area: TypeAlias = Any

#: Areas and lines smaller than this result from rounding, mm2 and mm.
_LEAST = 1e-6


def box_area(low_mm: Sequence[float], high_mm: Sequence[float]) -> Area:
    """A rectangle."""
    return shapely.box(low_mm[0], low_mm[1], high_mm[0], high_mm[1])


def grown(area: Area, by_mm: float, chord_mm: float) -> Area:
    """An area offset outwards by a distance; arcs become chords that deviate outwards by ``chord_mm`` at most."""
    if by_mm == 0.0:
        return area
    if by_mm < 0.0:
        return shapely.buffer(area, by_mm, quad_segs=_segments(-by_mm, chord_mm))
    # the corners of the chords lie on the circle: a larger circle puts the chords' middles on the true one
    return shapely.buffer(area, by_mm + chord_mm, quad_segs=_segments(by_mm, chord_mm))


def _segments(radius_mm: float, chord_mm: float) -> int:
    half = math.acos(max(0.0, 1.0 - chord_mm / (radius_mm + chord_mm)))
    return max(2, math.ceil(0.25 * math.pi / half))


def outlines(area: Area, window: Area) -> list[FloatArray]:
    """The boundary lines of an area inside a window, with the area on their left.

    Returns:
        shape (n, 2) each; closed lines end where they begin.
    """
    lines: list[FloatArray] = []
    for polygon in shapely.get_parts(area):
        turned = shapely.orient_polygons(polygon)
        for ring in (turned.exterior, *turned.interiors):
            lines += _inside(ring, window)
    return lines


def _inside(ring: Any, window: Area) -> list[FloatArray]:
    if window.covers(ring):
        return [np.array(ring.coords)]
    parts = shapely.line_merge(shapely.intersection(shapely.LineString(ring), window), directed=True)
    found = [p for p in shapely.get_parts(parts) if p.geom_type == "LineString" and p.length > _LEAST]
    return [np.round(np.array(p.coords), DECIMALS) for p in found]


def minus(area: Area, other: Area) -> Area:
    """The part of an area that is not in another."""
    return shapely.difference(area, other)


def pieces(area: Area) -> list[Area]:
    """The connected parts of an area."""
    return [p for p in shapely.get_parts(area) if p.geom_type == "Polygon" and p.area > _LEAST]


def holds(area: Area, line: FloatArray) -> bool:
    """Whether an area contains a whole line, shape (n >= 2, 2); its boundary belongs to it, within rounding."""
    return bool(shapely.buffer(area, 2.0 * 10.0**-DECIMALS, join_style="mitre").covers(shapely.LineString(line)))


def nearest_area(areas: Sequence[Area], point: FloatArray) -> int:
    """Number of the area nearest to a point."""
    return int(np.argmin(shapely.distance(np.array(areas, dtype=object), shapely.Point(point))))


def line_distance_mm(one: FloatArray, other: FloatArray) -> float:
    """Least distance of two polylines, shape (n >= 2, 2)."""
    return float(shapely.distance(shapely.LineString(one), shapely.LineString(other)))
