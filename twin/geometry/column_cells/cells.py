"""The fast slice store: the workpiece's planes as column cells (see `twin.geometry.column_cells.store_kernels`)."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells import store_kernels as layout
from twin.geometry.column_cells.bin_kernels import bin_tops, occupied_columns
from twin.geometry.column_cells.cut_kernels import cut_planes
from twin.geometry.column_cells.edge_kernels import EDGE_COLUMNS
from twin.geometry.column_cells.fill_kernels import fill_plane
from twin.geometry.column_cells.line_kernels import cell_lines
from twin.geometry.column_cells.query_kernels import Family, Planes, contains, plane_trapezoids, top_heights
from twin.geometry.column_cells.strips import NO_TOPS, Bins, Strips, Tops
from twin.geometry.polygons import lines
from twin.geometry.polygons.clip import union_convex
from twin.geometry.polygons.region import Region

#: Cells are squares of this many slice pitches.
CELL_PITCHES = 5
_FREE_LISTS = 40
_T = TypeVar("_T", bound=np.generic)


class CellFamily:
    """Parallel planes of one direction as column cells.

    A plane is built from its region when it is first touched, planes of one and the same region only once, and a
    part of a plane gets cells of its own when it is first cut; so memory grows with what was touched.

    Args:
        regions: material on each plane at the start.
        low_uv_mm, high_uv_mm: corners of the stock's box in the planes.
        cell_mm: size of a cell.
        merge_mm: edges of a cell that has many are merged where they stay this near; 0 for none. Less than a chord's
            deviation.
    """

    def __init__(
        self,
        regions: Sequence[Region],
        low_uv_mm: tuple[float, float],
        high_uv_mm: tuple[float, float],
        cell_mm: float,
        merge_mm: float = 0.0,
    ) -> None:
        columns, tiles = (
            max(1, math.ceil((high - low) / cell_mm * (1.0 - 1e-12)))
            for low, high in zip(low_uv_mm, high_uv_mm, strict=True)
        )
        self.grid = layout.Grid(float(low_uv_mm[0]), float(low_uv_mm[1]), float(cell_mm), columns, tiles)
        self.area_mm2 = np.array([r.area_mm2 for r in regions], dtype=np.float64)
        self.store = _empty_store(len(regions), columns, math.ceil(tiles / layout.PAGE_TILES))
        self._scratch = _scratch(1024)
        self._merge_mm = merge_mm
        self._regions = regions
        self._alike = Counter(map(id, regions))
        self._templates: dict[int, NDArray[np.int64]] = {}

    @property
    def bytes_in_use(self) -> int:
        """Memory that cells, their edges and the tables of pages take, without what is kept ready for more."""
        store = self.store
        cells, tables = store.used
        per_table = store.page.shape[1] * (store.page.itemsize + store.own.itemsize)
        edges, planes = store.free[-1], np.count_nonzero(store.table[:, 0])
        return int(
            cells * store.cells[0].nbytes
            + edges * store.pool[0].nbytes
            + tables * per_table
            + planes * store.table[0].nbytes
        )

    @property
    def edge_counts(self) -> NDArray[np.int64]:
        """Number of edges of each cell that has any."""
        sizes = self.store.cells[: self.store.used[0], layout.SIZE]
        return sizes[sizes > 0].astype(np.int64)

    def built(self, k: int) -> bool:
        """Whether a plane has cells."""
        return bool(self.store.table[k, 0])

    def ensure(self, first: int, last: int) -> None:
        """Build the planes ``first`` to ``last - 1``, as far as they exist, that are not built yet."""
        first = max(0, first)
        for k in np.flatnonzero(self.store.table[first:last, 0] == 0) if last > first else ():
            self._build(first + int(k))

    def _build(self, k: int) -> None:
        region = id(self._regions[k])
        if self._alike[region] == 1:
            self.store.table[k] = self._fill(k, alone=True)
            return
        if region not in self._templates:
            self._templates[region] = self._fill(k, alone=False)
        self.store.table[k] = self._templates[region]

    def _fill(self, k: int, *, alone: bool) -> NDArray[np.int64]:
        """New cells for a plane's region; returns the table of each column."""
        edges = _ring_edges(self._regions[k])
        cursor = np.zeros(1, dtype=np.int64)
        tables = np.zeros(self.grid.columns, dtype=np.int64)
        while True:
            answer = fill_plane(edges, alone, self.grid, self.store, tables, self._scratch, cursor)
            if answer == layout.DONE:
                return tables
            self._make_room(answer)

    def _make_room(self, answer: int) -> None:
        """Lengthen the arrays that a kernel found too short."""
        store = self.store
        if answer == layout.POOL_FULL:
            self.store = store._replace(pool=_longer(store.pool, len(store.pool)))
        elif answer == layout.CELLS_FULL:
            self.store = store._replace(
                cells=_longer(store.cells, len(store.cells) + layout.PAGE_TILES * store.page.shape[1])
            )
        elif answer == layout.TABLES_FULL:
            self.store = store._replace(
                page=_longer(store.page, 64 + len(store.page)),
                own_table=_longer(store.own_table, 64 + len(store.page)),
                own=_longer(store.own, 64 + len(store.page)),
            )
        else:
            self._scratch = _scratch(2 * len(self._scratch.out))

    def cut(self, strips: Strips, *, apply: bool = True) -> FloatArray:
        """Subtract strips (or only measure with ``apply=False``); returns the area that each takes."""
        if len(strips.at):
            self.ensure(int(strips.at[0]), int(strips.at[-1]) + 1)
        removed = np.zeros(len(strips.at))
        cursor = np.zeros(3, dtype=np.int64)
        merge_mm = self._merge_mm if apply else -1.0
        while True:
            answer = cut_planes(self.store, self.grid, strips, self._scratch, cursor, merge_mm, removed)
            if answer == layout.DONE:
                break
            self._make_room(answer)
        if apply:
            np.subtract.at(self.area_mm2, strips.at, removed)
        return removed

    def tops(self, first: int, planes: int, range_u_mm: tuple[float, float], base_mm: float) -> Tops:
        """Heights of the material above ``base_mm`` on consecutive planes in the columns of a range of u."""
        grid = self.grid
        begin, end = (math.floor((u - grid.u_low) / grid.size) for u in range_u_mm)
        begin, end = max(0, begin), min(grid.columns, end + 1)
        if end <= begin or planes <= 0:
            return NO_TOPS
        heights = np.empty((planes, end - begin))
        top_heights(self.store, grid, first, begin, base_mm, heights)
        return Tops(heights, grid.u_low + begin * grid.size, grid.size)

    def bins(
        self, met: tuple[int, int], range_u_mm: tuple[float, float], range_v_mm: tuple[float, float], *, tops: bool
    ) -> Bins:
        """Material on consecutive planes in bins of a range of u and v.

        Args:
            met: the first plane, and how many.
            tops: whether the height of the highest material is wanted, for which that above the range counts, too; or
                only whether there is any.
        """
        grid, (first, planes) = self.grid, met
        begin, end = (math.floor((u - grid.u_low) / grid.size) for u in range_u_mm)
        begin, end = max(0, begin), min(grid.columns, end + 1)
        self.ensure(first, first + planes)
        heights = np.empty((planes, max(0, end - begin), CELL_PITCHES if tops else 1))
        if tops:
            bin_tops(self.store, grid, first, begin, range_v_mm[0], heights)
        else:
            occupied_columns(self.store, grid, first, begin, range_v_mm, heights)
            heights = np.repeat(heights, CELL_PITCHES, axis=2)
        flat = heights.reshape(planes, CELL_PITCHES * heights.shape[1])
        return Bins(flat, grid.u_low + begin * grid.size, grid.size / CELL_PITCHES)

    def line_ends(
        self, planes: NDArray[np.int64], fixed: int, at_mm: FloatArray, window_mm: tuple[float, float]
    ) -> lines.LineEnds:
        """Lines through planes, as `SliceStore.line_ends` gives them."""
        for k in planes[self.store.table[planes, 0] == 0]:
            self.ensure(int(k), int(k) + 1)
        tables = self.store.table[planes]
        return lines.collect(
            len(planes) * len(at_mm),
            lambda out: cell_lines(at_mm, fixed, window_mm, lines.MERGE_MM, tables, self.grid, self.store, out),
        )

    def vote(self, points_mm: FloatArray, planes: Planes, votes: NDArray[np.int8], least: int, most: int) -> None:
        """Vote for each point (n, 3) with material on the nearest plane and ``least`` to ``most`` votes so far."""
        contains(points_mm, planes, self.grid, self.store, votes, least, most)

    def tested(self, planes: Planes) -> Family:
        """The family as a test of points takes it."""
        return Family(planes, self.grid, self.store)

    def region(self, k: int) -> Region:
        """Material on a plane as rings."""
        if not self.built(k):
            return self._regions[k]
        room = 256 + 4 * self.grid.columns
        while True:
            out = np.empty((room, 6))
            n = plane_trapezoids(self.store.table[k], self.grid, self.store, out)
            if n >= 0:
                break
            room *= 4
        t = out[:n]
        lower = np.stack((t[:, [0, 2]], t[:, [1, 3]]), axis=1)
        upper = np.stack((t[:, [1, 5]], t[:, [0, 4]]), axis=1)
        return union_convex(np.concatenate((lower, upper), axis=1))


def _empty_store(planes: int, columns: int, blocks: int) -> layout.CellStore:
    """A store without cells; table 0 stands for planes that are not built."""
    free: NDArray[np.int64] = np.full(_FREE_LISTS + 1, -1, dtype=np.int64)
    free[-1] = 0
    return layout.CellStore(
        table=np.zeros((planes, columns), dtype=np.int64),
        page=np.zeros((1, blocks), dtype=np.int64),
        own_table=np.zeros(1, dtype=np.bool_),
        own=np.zeros((1, blocks), dtype=np.bool_),
        used=np.array([0, 1], dtype=np.int64),
        cells=np.zeros((0, 4), dtype=np.int32),
        pool=np.empty((1024, EDGE_COLUMNS)),
        free=free,
    )


def _scratch(rows: int) -> layout.Scratch:
    return layout.Scratch(
        segments=np.empty((rows, 8)),
        toggles_lo=np.empty(4 * rows),
        toggles_hi=np.empty(4 * rows),
        work=np.empty((rows, EDGE_COLUMNS)),
        out=np.empty((rows, EDGE_COLUMNS)),
    )


def _longer(old: NDArray[_T], more: int) -> NDArray[_T]:
    """A copy of an array with more rows, 0 at first."""
    new = np.zeros((len(old) + more, *old.shape[1:]), dtype=old.dtype)
    new[: len(old)] = old
    return new


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
