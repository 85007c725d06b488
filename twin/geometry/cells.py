"""The fast slice store: every plane of the workpiece as column cells (see `twin.geometry.kernels`)."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry import kernels, line_kernels, lines
from twin.geometry.clip import union_convex
from twin.geometry.region import Region
from twin.geometry.strips import Strips

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
        self.row: NDArray[np.int64] = np.full(len(regions), -1, dtype=np.int64)
        self._rows = 0
        shape = (0, self.columns, math.ceil(self.tiles / kernels.PAGE_TILES))
        self.page: NDArray[np.int64] = np.zeros(shape, dtype=np.int64)
        self._own: NDArray[np.bool_] = np.zeros(shape, dtype=np.bool_)
        self._regions = regions
        self._alike = Counter(map(id, regions))
        self._templates: dict[int, NDArray[np.int64]] = {}
        self._used: NDArray[np.int64] = np.zeros(1, dtype=np.int64)
        self.state: NDArray[np.int8] = np.zeros(0, dtype=np.int8)
        self.start: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
        self.size: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
        self.room: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
        self.pool = np.empty((1024, 5))
        self._free: NDArray[np.int64] = np.full(_FREE_LISTS + 1, -1, dtype=np.int64)
        self._free[-1] = 0
        self._make_scratch(1024)

    def _make_scratch(self, rows: int) -> None:
        self._segments = np.empty((rows, 8))
        self._toggles = np.empty((2, 4 * rows))
        self._out = np.empty((rows, 5))
        self._work = np.empty((rows, 5))

    def ensure(self, first: int, last: int) -> None:
        """Build the planes ``first`` to ``last - 1``, as far as they exist, that are not built yet."""
        first = max(0, first)
        for k in np.flatnonzero(self.row[first:last] < 0) if last > first else ():
            self._build(first + int(k))

    def _build(self, k: int) -> None:
        region = id(self._regions[k])
        alone = self._alike[region] == 1
        if alone or region not in self._templates:
            self._templates[region] = self._fill(k)
        if self._rows == len(self.page):
            self._grow_rows()
        row, self._rows = self._rows, self._rows + 1
        self.page[row], self._own[row] = self._templates[region], alone
        if alone:
            del self._templates[region]
        self.row[k] = row

    def _grow_rows(self) -> None:
        rows = min(len(self.row), max(64, 2 * len(self.page)))
        for name in ("page", "_own"):
            old = getattr(self, name)
            new = np.empty((rows, *old.shape[1:]), dtype=old.dtype)
            new[: len(old)] = old
            setattr(self, name, new)

    def _fill(self, k: int) -> NDArray[np.int64]:
        """New cells for a plane's region; returns the first of each page."""
        cells = math.prod(self.page.shape[1:]) * kernels.PAGE_TILES
        place = int(self._used[0])
        if place + cells > len(self.state):
            self._grow_cells(place + cells)
        self._used[0] += cells
        edges = _ring_edges(self._regions[k])
        cursor = np.zeros(1, dtype=np.int64)
        while True:
            answer = kernels.fill_plane(
                edges,
                place,
                self.grid,
                self.columns,
                self.tiles,
                *(self.state, self.start, self.size, self.room, self.pool, self._free),
                self._toggles[0],
                self._work,
                self._out,
                cursor,
            )
            if answer == kernels.DONE:
                break
            self._make_room(answer)
        return np.asarray(place + np.arange(0, cells, kernels.PAGE_TILES).reshape(self.page.shape[1:]))

    def _grow_cells(self, needed: int) -> None:
        total = max(needed, 2 * len(self.state))
        for name in ("state", "start", "size", "room"):
            old = getattr(self, name)
            new = np.zeros(total, dtype=old.dtype)
            new[: len(old)] = old
            setattr(self, name, new)

    def _make_room(self, answer: int) -> None:
        if answer == kernels.POOL_FULL:
            pool = np.empty((2 * len(self.pool), 5))
            pool[: len(self.pool)] = self.pool
            self.pool = pool
        elif answer == kernels.CELLS_FULL:
            self._grow_cells(len(self.state) + kernels.PAGE_TILES)
        else:
            self._make_scratch(2 * len(self._out))

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
                self.row,
                self.page,
                self._own,
                self._used,
                *(self.state, self.start, self.size, self.room, self.pool, self._free),
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
        for k in planes[self.row[planes] < 0]:
            self.ensure(int(k), int(k) + 1)
        kernel = line_kernels.cell_v_lines if fixed else line_kernels.cell_u_lines
        return lines.collect(
            len(planes) * len(at_mm),
            lambda offsets, ends, slopes: kernel(
                at_mm,
                window_mm,
                lines.MERGE_MM,
                self.page[self.row[planes]],
                self.grid,
                self.tiles,
                *(self.state, self.start, self.size, self.pool),
                offsets,
                ends,
                slopes,
            ),
        )

    def region(self, k: int) -> Region:
        """Material on a plane as rings."""
        if self.row[k] < 0:
            return self._regions[k]
        room = 256 + 4 * self.columns
        while True:
            out = np.empty((room, 6))
            n = kernels.plane_trapezoids(
                self.page[self.row[k]],
                self.grid,
                self.tiles,
                self.state,
                self.start,
                self.size,
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
