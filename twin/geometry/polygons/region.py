"""Polygons on a plane: a `Ring` is one closed polyline, a `Region` a set of rings with its area."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from twin.arrays import FloatArray


def ring(points_mm: ArrayLike) -> FloatArray:
    """Check and freeze a closed polyline.

    Args:
        points_mm: shape (n >= 3, 2), the last point not repeating the first.

    Raises:
        ValueError: wrong shape, or a value that is not finite.
    """
    points = np.array(points_mm, dtype=np.float64)
    if points.ndim != 2 or points.shape[0] < 3 or points.shape[1] != 2:
        raise ValueError(f"points_mm must have shape (n >= 3, 2), got {points.shape}")
    if not np.isfinite(points).all():
        raise ValueError(f"points_mm must be finite, got {points[~np.isfinite(points).all(axis=1)][0]}")
    points.flags.writeable = False
    return points


def signed_area_mm2(points_mm: FloatArray) -> float:
    """Area of one ring, positive when it runs counter-clockwise (shoelace about its first vertex)."""
    q = points_mm - points_mm[0]
    return 0.5 * float(np.dot(q[:-1, 0], q[1:, 1]) - np.dot(q[1:, 0], q[:-1, 1]))


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """Material on a plane: outer rings counter-clockwise, holes clockwise, none crossing another.

    Attributes:
        rings: each of shape (n, 2), mm, read-only.
    """

    rings: tuple[FloatArray, ...] = ()

    @classmethod
    def of(cls, *rings: ArrayLike) -> Self:
        """A region from point lists, checked by `ring`."""
        return cls(tuple(ring(r) for r in rings))

    @property
    def area_mm2(self) -> float:
        """Area of the material: holes count negative."""
        return sum((signed_area_mm2(r) for r in self.rings), 0.0)

    @property
    def empty(self) -> bool:
        """Whether nothing is there."""
        return not self.rings
