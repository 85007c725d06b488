"""The interface of every store of slices: the fast one and the reference one.

The workpiece is three families of parallel planes. Family ``axis`` (0 for x, 1 for y, 2 for z) has ``count(axis)``
planes at ``position(axis, k) = low[axis] + (k + 1/2) * pitch[axis]``. In-plane coordinates (u, v):

====  ============  =======
axis  planes        (u, v)
====  ============  =======
0     yz, normal x  (y, z)
1     zx, normal y  (x, z)
2     xy, normal z  (x, y)
====  ============  =======
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.polygons.lines import LineEnds
from twin.geometry.polygons.region import Region

#: In-plane axes (u, v) of each slice family.
PLANE_AXES: tuple[tuple[int, int], ...] = ((1, 2), (0, 2), (0, 1))


class SliceStore(Protocol):
    """Slices in three directions that can be cut and queried."""

    @property
    def low_mm(self) -> FloatArray:
        """Lower corner of the stock's box, shape (3,)."""

    @property
    def high_mm(self) -> FloatArray:
        """Upper corner of the stock's box, shape (3,)."""

    @property
    def pitch_mm(self) -> FloatArray:
        """Distance of the planes along x, y, z, shape (3,)."""

    def count(self, axis: int) -> int:
        """Number of planes of a family."""

    def area_mm2(self, axis: int, k: int) -> float:
        """Area of material on one plane."""

    def region(self, axis: int, k: int) -> Region:
        """Material on one plane as rings: outer ones counter-clockwise in (u, v), holes clockwise."""

    def line_ends(
        self, axis: int, planes: NDArray[np.int64], fixed: int, at_mm: FloatArray, window_mm: tuple[float, float]
    ) -> LineEnds:
        """Where straight lines enter and leave the material of slices, with the slope of the boundary there.

        Args:
            planes: numbers of the slices.
            fixed: in-plane coordinate that is constant on a line, 0 for u, 1 for v.
            at_mm: shape (n,), that coordinate for each line.
            window_mm: only ends in this range of the other coordinate are needed; others are undefined.

        Returns:
            all lines of the first slice, then those of the second, ...
        """

    def contains(self, points_mm: FloatArray, axis: int) -> NDArray[np.bool_]:
        """Whether points (n, 3) lie in material on the nearest plane of a family; False more than half a pitch off."""
