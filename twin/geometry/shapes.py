"""The only door to shapely: regions as GEOS polygons, for offsets and Boolean operations on whole planes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.clip import DECIMALS, LEAST_AREA_MM2
from twin.geometry.region import Region, signed_area_mm2

#: An array of GEOS polygons, one a plane; it never leaves the modules that ask for it.
Shapes = NDArray[np.object_]


def to_shape(region: Region) -> shapely.Geometry:
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


def to_region(shape: shapely.Geometry) -> Region:
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


def _valid(shape: shapely.Geometry) -> shapely.Geometry:
    """Rounding may let rings of a plane touch where they should not."""
    return shape if shapely.is_valid(shape) else shapely.buffer(shape, 0.0)
