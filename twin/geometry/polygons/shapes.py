"""The only door to shapely: regions as GEOS polygons, for offsets and Boolean operations on whole planes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
import shapely
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.polygons.clip import DECIMALS, LEAST_AREA_MM2
from twin.geometry.polygons.region import Region, signed_area_mm2

#: A GEOS polygon, or several in one.
Shape: TypeAlias = Any
#: An array of them, one a plane.
Shapes: TypeAlias = NDArray[np.object_]


def to_shape(region: Region) -> Shape:
    """A region as one polygon, or several."""
    rings = [shapely.linearrings(r) for r in region.rings]
    signs = [signed_area_mm2(r) for r in region.rings]
    outers = [r for r, s in zip(rings, signs, strict=True) if s > 0.0]
    holes = [r for r, s in zip(rings, signs, strict=True) if s <= 0.0]
    if len(outers) == 1:
        return _valid(shapely.polygons(outers[0], holes or None))
    if not outers:
        return shapely.MultiPolygon()
    return _valid(shapely.build_area(shapely.multilinestrings(outers + holes)))


def to_shapes(regions: Sequence[Region]) -> Shapes:
    """Regions as polygons; equal objects are converted once."""
    made = {id(r): r for r in regions}
    known = {key: to_shape(region) for key, region in made.items()}
    shapes = np.empty(len(regions), dtype=object)
    shapes[:] = [known[id(r)] for r in regions]
    return shapes


def to_region(shape: Shape) -> Region:
    """Polygons as a region, vertices rounded to 1e-5 mm."""
    rings: list[FloatArray] = []
    for part in shapely.get_parts(shapely.orient_polygons(shapely.set_precision(shape, 10.0**-DECIMALS))):
        if shapely.get_type_id(part) != 3:
            continue
        for line in (part.exterior, *part.interiors):
            points = np.round(shapely.get_coordinates(line)[:-1], DECIMALS) + 0.0
            if len(points) >= 3 and abs(signed_area_mm2(points)) > LEAST_AREA_MM2:
                rings.append(points)
    return Region.of(*rings)


def box_shape(low_u_mm: float, low_v_mm: float, high_u_mm: float, high_v_mm: float) -> Shape:
    """A rectangle."""
    return shapely.box(low_u_mm, low_v_mm, high_u_mm, high_v_mm)


def minus(one: Shape | Shapes, other: Shape | Shapes) -> Shapes:
    """One without the other, plane by plane; a single polygon stands for all planes."""
    return np.asarray(shapely.difference(one, other), dtype=object)


def boundaries(shapes: Shapes) -> Shapes:
    """Boundary lines of polygons."""
    return np.asarray(shapely.boundary(shapes), dtype=object)


def grown_each(shapes: Shapes, radius_mm: float, segments: int) -> Shapes:
    """Every polygon inflated alone.

    Args:
        segments: segments a quarter circle.
    """
    return np.asarray(shapely.buffer(shapes, radius_mm, quad_segs=segments), dtype=object)


def outline_rings(shape: Shape) -> list[FloatArray]:
    """All rings of a polygon, outer ones counter-clockwise, holes clockwise; the last point repeats the first."""
    parts = shapely.get_parts(shapely.orient_polygons(shape))
    return [shapely.get_coordinates(r) for p in parts for r in (p.exterior, *p.interiors)]


def united(shapes: Shapes) -> Shape:
    """One polygon of all."""
    return shapely.union_all(shapes)


def cut_along(shape: Shape, fixed: int, at_mm: float) -> list[tuple[float, float]]:
    """Ranges of a polygon on a line where one coordinate (0 for u, 1 for v) is fixed, in the other coordinate."""
    low, high = shapely.bounds(shape)[[1 - fixed, 3 - fixed]]
    ends = [(at_mm, low - 1.0), (at_mm, high + 1.0)] if fixed == 0 else [(low - 1.0, at_mm), (high + 1.0, at_mm)]
    parts = shapely.get_parts(shapely.intersection(shape, shapely.linestrings(ends)))
    spans = [shapely.get_coordinates(p)[:, 1 - fixed] for p in parts]
    return [(float(s.min()), float(s.max())) for s in spans if len(s) > 1]


def _valid(shape: Shape) -> Shape:
    """Rounding may let rings of a plane touch where they should not."""
    return shape if shapely.is_valid(shape) else shapely.buffer(shape, 0.0)
