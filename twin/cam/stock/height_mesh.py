"""A height map as triangles, tile by tile, while tools lower it."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cam.stock import height_mesh_kernels as kernels

#: Tiles that are computed with one call.
_TOGETHER = 32
#: Least change that is drawn, as a part of the distance that triangles may lie off the map.
_VISIBLE = 0.5


class TileMesh(NamedTuple):
    """The surface of one tile.

    Attributes:
        vertices_mm, normals: shape (n, 3) float32.
        triangles: shape (m, 3) uint32, counter-clockwise seen from outside.
    """

    vertices_mm: NDArray[np.float32]
    normals: NDArray[np.float32]
    triangles: NDArray[np.uint32]


class HeightTiles:
    """Tiles of a height map: which have changed since they were drawn, and their triangles.

    Args:
        heights: the map; its upper heights may be lowered between calls.
        firsts: shape (n, 2), column and row of each tile's first node; it may lie outside of the map.
        limit_mm: how far triangles may lie off the map.
    """

    def __init__(self, heights: kernels.HeightMap, firsts: NDArray[np.int64], limit_mm: float) -> None:
        self._map = heights
        self._firsts = firsts
        self._limit_mm = limit_mm
        self._drawn_mm = heights.tops.copy()

    def changed(self, low_mm: FloatArray, high_mm: FloatArray) -> NDArray[np.int64]:
        """Numbers of the tiles that are drawn visibly higher than they are.

        Args:
            low_mm, high_mm: corners of a box in plan outside of which nothing was cut, shape (2,).
        """
        near = np.ones(len(self._firsts), dtype=np.bool_)
        for axis, at in enumerate((self._map.x, self._map.y)):
            first, end = np.searchsorted(at, low_mm[axis]), np.searchsorted(at, high_mm[axis])
            near &= (self._firsts[:, axis] + kernels.CELLS >= first) & (self._firsts[:, axis] <= end)
        numbers = np.flatnonzero(near)
        found = np.zeros(len(numbers), dtype=np.bool_)
        least = _VISIBLE * self._limit_mm
        kernels.changed_tiles(self._map.tops, self._drawn_mm, self._firsts[numbers], least, found)
        return numbers[found]

    def draw(self, numbers: NDArray[np.int64]) -> Iterator[TileMesh]:
        """The surface of tiles, in order; from now on they count as drawn."""
        for at in range(0, len(numbers), _TOGETHER):
            yield from self._draw(self._firsts[numbers[at : at + _TOGETHER]])

    def _draw(self, firsts: NDArray[np.int64]) -> Iterator[TileMesh]:
        n = len(firsts)
        vertices, triangles = n * kernels.MOST_VERTICES, n * kernels.MOST_TRIANGLES
        out = kernels.TileMeshes(
            np.empty((vertices, 3), np.float32),
            np.empty((vertices, 3), np.float32),
            np.empty((triangles, 3), np.uint32),
            np.empty((n + 1, 2), np.int64),
        )
        kernels.tile_meshes(self._map, firsts, self._limit_mm, _table(), out)
        ends = out.ends.tolist()
        for t, (column, row) in enumerate(firsts.tolist()):
            area = slice(max(0, column), column + kernels.CELLS + 1), slice(max(0, row), row + kernels.CELLS + 1)
            self._drawn_mm[area] = self._map.tops[area]
            (v0, m0), (v1, m1) = ends[t], ends[t + 1]
            yield TileMesh(out.vertices[v0:v1].copy(), out.normals[v0:v1].copy(), out.triangles[m0:m1].copy())


@cache
def _table() -> NDArray[np.int64]:
    table = np.empty((kernels.TRIANGLES, 6), dtype=np.int64)
    kernels.division_table(table)
    return table
