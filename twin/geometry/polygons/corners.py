"""Corners of polygons, and how far they move from one plane to the next."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from scipy.spatial import cKDTree

from twin.arrays import FloatArray
from twin.geometry.polygons.shapes import Shape, outline_rings

#: A corner turns by at least the first; the corner that it is matched with may turn by as little as the second.
_SHARP, _WEAK = math.radians(8.0), math.radians(4.0)


@dataclass(frozen=True, slots=True, eq=False)
class Corners:
    """Convex corners of a polygon.

    Attributes:
        sharp_mm: shape (n, 2), those that turn by 8 degrees and more.
        weak_mm: shape (m, 2), those that turn by 4 degrees and more.
        rings: number of the polygon's rings.
    """

    sharp_mm: FloatArray
    weak_mm: FloatArray
    rings: int

    @classmethod
    def of(cls, shape: Shape, within_mm: float) -> Corners:
        """Corners of a polygon.

        Args:
            within_mm: steps and rings smaller than this are ignored.
        """
        rings = outline_rings(shapely.simplify(shape, within_mm, preserve_topology=False))
        empty = (np.empty((0, 2)), np.empty(0))
        found = [_turns(ring[:-1]) for ring in rings] or [empty]
        points, turns = (np.concatenate(part) for part in zip(*found, strict=True))
        return cls(points[turns >= _SHARP], points[turns >= _WEAK], len(rings))

    def wander_mm(self, other: Corners) -> float:
        """How far corners move to another plane; inf where one ends between them, or a ring does."""
        if self.rings != other.rings:
            return math.inf
        return max(_farthest(self.sharp_mm, other.weak_mm), _farthest(other.sharp_mm, self.weak_mm))


def _turns(ring: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Vertices of a ring and the angle by which it turns left in each, rad; material on the left."""
    along = np.roll(ring, -1, axis=0) - ring
    before = np.roll(along, 1, axis=0)
    cross = before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0]
    return ring, np.arctan2(cross, np.sum(before * along, axis=1))


def _farthest(points: FloatArray, others: FloatArray) -> float:
    """Largest distance of points from the nearest of others."""
    if len(points) == 0:
        return 0.0
    if len(others) == 0:
        return math.inf
    return float(np.max(cKDTree(others).query(points)[0]))
