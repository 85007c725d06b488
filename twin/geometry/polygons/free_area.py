"""Areas that a tool's axis may enter: whether they contain a line, their offsets, their parts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from twin.arrays import FloatArray
from twin.geometry.polygons.clip import DECIMALS
from twin.geometry.polygons.outline import Area, grown, pieces

#: By how much a line on the border may lie outside, mm.
_SLACK = 5.0 * 10.0**-DECIMALS


class FreeArea:
    """An area prepared for many queries.

    Args:
        area: polygon or multipolygon, mm.
    """

    def __init__(self, area: Area) -> None:
        self.area = area
        self._eased = shapely.buffer(area, _SLACK, join_style="mitre")
        shapely.prepare(self._eased)

    @property
    def empty(self) -> bool:
        """Whether the area is empty."""
        return bool(shapely.is_empty(self.area))

    def holds(self, line_mm: FloatArray) -> bool:
        """Whether a whole line, shape (n >= 2, 2), lies inside; the border belongs to it."""
        return bool(self._eased.covers(shapely.LineString(line_mm)))

    def holds_points(self, points_mm: FloatArray) -> FloatArray:
        """Which points, shape (n, 2), lie inside; shape (n,), bool."""
        return np.asarray(shapely.contains_xy(self._eased, points_mm[:, 0], points_mm[:, 1]))


def united(areas: Sequence[Area]) -> Area:
    """Union of areas."""
    return shapely.union_all(list(areas))


def shrunk(area: Area, by_mm: float, chord_mm: float) -> list[Area]:
    """The connected parts of an area offset inwards by a distance."""
    return pieces(shapely.simplify(grown(area, -by_mm, chord_mm), 0.5 * chord_mm))


def simplified(area: Area, by_mm: float) -> Area:
    """An area with fewer vertices, its border moved by this distance at most."""
    return shapely.simplify(area, by_mm)


def borders(polygon: Area) -> Iterator[FloatArray]:
    """A polygon's rings, the outer one first, the polygon on the left, closed, shape (n, 2)."""
    turned = shapely.orient_polygons(polygon)
    for ring in (turned.exterior, *turned.interiors):
        yield np.array(ring.coords)


def a_point_of(polygon: Area) -> FloatArray:
    """Some point inside, shape (2,)."""
    point = shapely.point_on_surface(polygon)
    return np.array([point.x, point.y])


def size_of(polygon: Area) -> float:
    """Area of a polygon, mm2."""
    return float(shapely.area(polygon))


def has_point(polygon: Area, point_mm: FloatArray) -> bool:
    """Whether a point lies inside a polygon."""
    return bool(shapely.contains_xy(polygon, point_mm[0], point_mm[1]))


def rows_of(free: FreeArea, spacing_mm: float) -> Iterator[list[FloatArray]]:
    """Parts of lines along x in a free area: for each row, from low y to high, its pieces from left to right."""
    if free.empty:
        return
    x0, y0, x1, y1 = shapely.bounds(free.area).tolist()
    count = max(1, int(np.ceil((y1 - y0) / spacing_mm - 1e-9)))
    for k in range(count + 1):
        y = min(max(y0 + k * (y1 - y0) / count, y0 + 1e-6), y1 - 1e-6)
        line = shapely.LineString([(x0 - 1.0, y), (x1 + 1.0, y)])
        parts = [p for p in shapely.get_parts(shapely.intersection(line, free.area)) if p.geom_type == "LineString"]
        found = sorted((np.array(p.coords) for p in parts if p.length > _SLACK), key=lambda p: float(p[:, 0].min()))
        yield [p if p[0, 0] <= p[-1, 0] else p[::-1] for p in found]
