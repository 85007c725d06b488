"""Separate polygons on planes: their size and position, pairs close to each other, their triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from twin.arrays import FloatArray, places_in_runs
from twin.geometry.polygons.clip import DECIMALS
from twin.geometry.polygons.shapes import Shape, Shapes, outline_rings

_POLYGON = 3
#: Middles of circles are found to this part of a piece's size.
_MIDDLE = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class Pieces:
    """Separate polygons.

    Attributes:
        shapes: shape (n,).
        planes: shape (n,), number of the plane of each, increasing.
    """

    shapes: Shapes
    planes: NDArray[np.int64]

    @classmethod
    def of(cls, shapes: Shapes, least_width_mm: float) -> Pieces:
        """The connected parts of one shape per plane; those of a smaller mean width are omitted."""
        parts, planes = shapely.get_parts(shapes, return_index=True)
        width = 2.0 * shapely.area(parts) / np.maximum(shapely.length(parts), 1e-300)
        wanted = (shapely.get_type_id(parts) == _POLYGON) & (width > least_width_mm)
        return cls(parts[wanted], planes[wanted].astype(np.int64))

    def some(self, which: NDArray[np.int64]) -> Pieces:
        """A part of them."""
        return Pieces(self.shapes[which], self.planes[which])

    @property
    def areas_mm2(self) -> FloatArray:
        """Shape (n,)."""
        return np.asarray(shapely.area(self.shapes))

    @property
    def bounds_mm(self) -> FloatArray:
        """Shape (n, 4): low u, low v, high u, high v."""
        return np.asarray(shapely.bounds(self.shapes))

    @property
    def centroids_mm(self) -> FloatArray:
        """Shape (n, 2)."""
        return np.asarray(shapely.get_coordinates(shapely.centroid(self.shapes)))

    def outline_points(self, most: int) -> tuple[FloatArray, NDArray[np.int64]]:
        """Points of the outlines, about ``most`` per piece at most, and the piece of each."""
        points, of = shapely.get_coordinates(self.shapes, return_index=True)
        counts = np.bincount(of, minlength=len(self.shapes))
        every = np.maximum(1, counts // most)
        kept = places_in_runs(counts) % every[of] == 0
        return points[kept], of[kept].astype(np.int64)

    def middles(self, least_share: float) -> tuple[FloatArray, NDArray[np.int64]]:
        """Middles of the largest circles inside of pieces, and the piece of each.

        Args:
            least_share: pieces with a smaller area, as a part of their outline's length squared, are omitted: the
                middle of a long thin one is not well defined.
        """
        fat = np.flatnonzero(self.areas_mm2 > least_share * shapely.length(self.shapes) ** 2)
        size = np.sqrt(self.areas_mm2[fat])
        circles = shapely.maximum_inscribed_circle(self.shapes[fat], tolerance=_MIDDLE * size)
        return np.asarray(shapely.get_coordinates(shapely.get_point(circles, 0))), fat.astype(np.int64)

    def near_pairs(self, distance_mm: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Pairs of pieces on neighbouring planes at this distance at most, seen along the normal."""
        firsts = np.searchsorted(self.planes, np.arange(self.planes[-1] + 2))
        pairs = [np.empty((2, 0), dtype=np.int64)]
        for low, middle, high in zip(np.concatenate(([0], firsts[:-2])), firsts[:-1], firsts[1:], strict=True):
            if high > middle > low:
                tree = shapely.STRtree(self.shapes[low:middle])
                found = tree.query(self.shapes[middle:high], predicate="dwithin", distance=distance_mm)
                pairs.append(found + np.array([[middle], [low]]))
        one, other = np.concatenate(pairs, axis=1)
        return one, other


def prism_parts(shape: Shape) -> tuple[FloatArray, FloatArray]:
    """Triangles and edges of a prism over a polygon, rounded to 1e-5 mm.

    Returns:
        triangles that fill the polygon, counter-clockwise, shape (t, 3, 2), and its edges, material on their left,
        shape (e, 2, 2); every edge is the side of one triangle.
    """
    rounded = shapely.set_precision(shape, 10.0**-DECIMALS)
    parts = [p for p in shapely.get_parts(rounded) if shapely.get_type_id(p) == _POLYGON]
    if not parts:
        return np.empty((0, 3, 2)), np.empty((0, 2, 2))
    whole = shapely.multipolygons(parts)
    flat = shapely.get_parts(shapely.constrained_delaunay_triangles(whole))
    caps = shapely.get_coordinates(shapely.orient_polygons(flat)).reshape(-1, 4, 2)[:, :3]
    edges = [np.stack((r[:-1], r[1:]), axis=1) for r in outline_rings(whole)]
    return caps, np.concatenate(edges)
