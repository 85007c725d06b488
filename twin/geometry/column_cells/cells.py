"""The fast slice store: every plane of the workpiece as column cells (see `twin.geometry.column_cells.kernels`)."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells import kernels
from twin.geometry.column_cells.strips import Strips
from twin.geometry.polygons import line_kernels, lines
from twin.geometry.polygons.clip import union_convex
from twin.geometry.polygons.region import Region

#: Cells are squares of this many slice pitches.
CELL_PITCHES = 5
_FREE_LISTS = 40


class CellFamily:
    """Parallel planes of one direction as column cells.

    A plane is built from its region when it is first touched, planes of one and the same region only once, and a
    part of a plane gets cells of its own when it is first cut; so memory grows with what was touched.

    Args:
        regions: material on each plane at the start.
        low_uv_mm, high_uv_mm: corners of the stock's box in the planes.
        cell_mm: size of a cell.
    """

    def __init__(
        self,
        regions: Sequence[Region],
        low_uv_mm: tuple[float, float],
        high_uv_mm: tuple[float, float],
        cell_mm: float,
    ) -> None:
        self.grid = np.array([low_uv_mm[0], low_uv_mm[1], cell_mm])
        self.columns = max(1, math.ceil((high_uv_mm[0] - low_uv_mm[0]) / cell_mm * (1.0 - 1e-12)))
        self.tiles = max(1, math.ceil((high_uv_mm[1] - low_uv_mm[1]) / cell_mm * (1.0 - 1e-12)))
        self.area_mm2 = np.array([r.area_mm2 for r in regions], dtype=np.float64)
        self.table: NDArray[np.int64] = np.zeros((len(regions), self.columns), dtype=np.int64)
        shape = (1, math.ceil(self.tiles / kernels.PAGE_TILES))
        self.page: NDArray[np.int64] = np.zeros(shape, dtype=np.int64)
        self._own_table: NDArray[np.bool_] = np.zeros(1, dtype=np.bool_)
        self._own: NDArray[np.bool_] = np.zeros(shape, dtype=np.bool_)
        self._regions = regions
        self._alike = Counter(map(id, regions))
        self._templates: dict[int, NDArray[np.int64]] = {}
        self._used: NDArray[np.int64] = np.array([0, 1])
        self.cells: NDArray[np.int32] = np.zeros((0, 4), dtype=np.int32)
        self.pool = np.empty((1024, 5))
        self._free: NDArray[np.int64] = np.full(_FREE_LISTS + 1, -1, dtype=np.int64)
        self._free[-1] = 0
        self._make_scratch(1024)

    def _make_scratch(self, rows: int) -> None:
        self._segments = np.empty((rows, 8))
        self._toggles = np.empty((2, 4 * rows))
        self._out = np.empty((rows, 5))
        self._work = np.empty((rows, 5))

    @property
    def bytes_in_use(self) -> int:
        """Memory that cells, their edges and the tables of pages take, without what is kept ready for more."""
        cells, tables = self._used
        per_table = self.page.shape[1] * (self.page.itemsize + self._own.itemsize)
        edges, planes = self._free[-1], np.count_nonzero(self.table[:, 0])
        return int(
            cells * self.cells[0].nbytes
            + edges * self.pool[0].nbytes
            + tables * per_table
            + planes * self.table[0].nbytes
        )

    def built(self, k: int) -> bool:
        """Whether a plane has cells."""
        return bool(self.table[k, 0])

    def ensure(self, first: int, last: int) -> None:
        """Build the planes ``first`` to ``last - 1``, as far as they exist, that are not built yet."""
        first = max(0, first)
        for k in np.flatnonzero(self.table[first:last, 0] == 0) if last > first else ():
            self._build(first + int(k))

    def _build(self, k: int) -> None:
        region = id(self._regions[k])
        if self._alike[region] == 1:
            self.table[k] = self._fill(k, alone=True)
            return
        if region not in self._templates:
            self._templates[region] = self._fill(k, alone=False)
        self.table[k] = self._templates[region]

    def _fill(self, k: int, *, alone: bool) -> NDArray[np.int64]:
        """New cells for a plane's region; returns the table of each column."""
        edges = _ring_edges(self._regions[k])
        cursor = np.zeros(1, dtype=np.int64)
        tables = np.zeros(self.columns, dtype=np.int64)
        while True:
            answer = kernels.fill_plane(
                edges,
                alone,
                self.grid,
                self.tiles,
                tables,
                self.page,
                self._own_table,
                self._own,
                self._used,
                self.cells,
                self.pool,
                self._free,
                self._toggles[0],
                self._work,
                self._out,
                cursor,
            )
            if answer == kernels.DONE:
                return tables
            self._make_room(answer)

    def _make_room(self, answer: int) -> None:
        if answer == kernels.POOL_FULL:
            pool = np.empty((2 * len(self.pool), 5))
            pool[: len(self.pool)] = self.pool
            self.pool = pool
        elif answer == kernels.CELLS_FULL:
            self._lengthen(len(self.cells) + kernels.PAGE_TILES * self.page.shape[1], "cells")
        elif answer == kernels.TABLES_FULL:
            self._lengthen(64 + len(self.page), "page", "_own_table", "_own")
        else:
            self._make_scratch(2 * len(self._out))

    def _lengthen(self, more: int, *names: str) -> None:
        for name in names:
            old = getattr(self, name)
            new = np.zeros((len(old) + more, *old.shape[1:]), dtype=old.dtype)
            new[: len(old)] = old
            setattr(self, name, new)

    def cut(self, strips: Strips, *, apply: bool = True) -> FloatArray:
        """Subtract strips (or only measure with ``apply=False``); returns the area taken from each of their planes."""
        self.ensure(strips.first, strips.first + strips.planes)
        removed = np.zeros(strips.planes)
        cursor = np.zeros(3, dtype=np.int64)
        while True:
            answer = kernels.cut_planes(
                strips.first,
                strips.offsets,
                strips.nodes,
                strips.fresh,
                self.grid,
                self.tiles,
                self.table,
                self.page,
                self._own_table,
                self._own,
                self._used,
                self.cells,
                self.pool,
                self._free,
                self._segments,
                self._toggles[0],
                self._toggles[1],
                self._out,
                cursor,
                apply,
                removed,
            )
            if answer == kernels.DONE:
                break
            self._make_room(answer)
        if apply:
            self.area_mm2[strips.first : strips.first + strips.planes] -= removed
        return removed

    def line_ends(
        self, planes: NDArray[np.int64], fixed: int, at_mm: FloatArray, window_mm: tuple[float, float]
    ) -> lines.LineEnds:
        """Lines through planes, as `SliceStore.line_ends` gives them."""
        for k in planes[self.table[planes, 0] == 0]:
            self.ensure(int(k), int(k) + 1)
        kernel = line_kernels.cell_v_lines if fixed else line_kernels.cell_u_lines
        return lines.collect(
            len(planes) * len(at_mm),
            lambda offsets, ends, slopes: kernel(
                at_mm,
                window_mm,
                lines.MERGE_MM,
                self.table[planes],
                self.page,
                self.grid,
                self.tiles,
                self.cells,
                self.pool,
                offsets,
                ends,
                slopes,
            ),
        )

    def region(self, k: int) -> Region:
        """Material on a plane as rings."""
        if not self.built(k):
            return self._regions[k]
        room = 256 + 4 * self.columns
        while True:
            out = np.empty((room, 6))
            n = kernels.plane_trapezoids(
                self.table[k],
                self.page,
                self.grid,
                self.tiles,
                self.cells,
                self.pool,
                out,
            )
            if n >= 0:
                break
            room *= 4
        t = out[:n]
        lower = np.stack((t[:, [0, 2]], t[:, [1, 3]]), axis=1)
        upper = np.stack((t[:, [1, 5]], t[:, [0, 4]]), axis=1)
        return union_convex(np.concatenate((lower, upper), axis=1))


def _ring_edges(region: Region) -> FloatArray:
    """Non-vertical edges of a region's rings as rows (u0, v0, u1, v1, sign), sign +1 where material lies below."""
    rows = []
    for points in region.rings:
        after = np.roll(points, -1, axis=0)
        forward = after[:, 0] > points[:, 0]
        backward = after[:, 0] < points[:, 0]
        rows.append(np.column_stack((points[forward], after[forward], np.full(forward.sum(), -1.0))))
        rows.append(np.column_stack((after[backward], points[backward], np.full(backward.sum(), 1.0))))
    return np.concatenate(rows) if rows else np.empty((0, 5))
