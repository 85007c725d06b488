"""The tri-slice workpiece: slices in three directions that sweeps are subtracted from.

Two stores implement one interface (`twin.workpiece.store.SliceStore` plus `cut`): `CellSlices`, the fast one, and
`PolygonSlices`, a plain pyclipper reference that reads like the tri-slice paper and serves as the tests' oracle.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.column_cells.cells import CELL_PITCHES, CellFamily
from twin.geometry.column_cells.query_kernels import Planes, most_contain
from twin.geometry.column_cells.strips import NO_TOPS, Bins, HeightMap, Strips, Tops
from twin.geometry.polygons import clip
from twin.geometry.polygons.lines import LineEnds, ring_line_ends
from twin.geometry.polygons.region import Region
from twin.workpiece.stock import SliceSet
from twin.workpiece.store import PLANE_AXES

#: Areas that are taken for rounding: as a number, and as a share of the stock's plan.
LEAST_MM2, LEAST_SHARE = 1e-6, 1e-9
#: Edges of a cell that has many are merged where they stay this near, in pitches: a hundredth of a chord's deviation.
MERGE_PITCHES = 5e-5
#: Width of the bins in which a store that does not know better is taken to have material.
BIN_PITCHES = 1.0


class TriSlices(ABC):
    """The common part of both stores: planes, areas and volumes."""

    def __init__(self, slices: SliceSet) -> None:
        self.slices = slices

    @property
    def low_mm(self) -> FloatArray:
        """Lower corner of the stock's box, shape (3,)."""
        return self.slices.low_mm

    @property
    def high_mm(self) -> FloatArray:
        """Upper corner of the stock's box, shape (3,)."""
        return self.slices.high_mm

    @property
    def pitch_mm(self) -> FloatArray:
        """Distance of the planes along x, y, z, shape (3,)."""
        return self.slices.pitch_mm

    def count(self, axis: int) -> int:
        """Number of planes of a family."""
        return len(self.slices.regions[axis])

    def levels(self) -> int:
        """How many z planes there are up to the highest one with material: above it there is nothing to cut.

        Less than a millionth of a square millimetre, or a billionth of the stock's box, is rounding and no material.
        """
        extent = self.high_mm - self.low_mm
        least = min(LEAST_MM2, LEAST_SHARE * extent[0] * extent[1])
        held = np.flatnonzero(self.areas_mm2(2) > least)
        return int(held[-1]) + 1 if len(held) else 0

    @abstractmethod
    def cut(self, axis: int, strips: Strips, *, apply: bool = True) -> FloatArray:
        """Subtract strips from a family's planes; returns the area that each takes.

        Args:
            apply: False measures only.
        """

    def tops(self, axis: int, first: int, planes: int, range_u_mm: tuple[float, float], base_mm: float) -> Tops:  # noqa: ARG002
        """Heights of the material in columns of consecutive vertical planes, as far as the store knows them.

        Args:
            axis: 0 or 1.
            first, planes: the first plane, and how many.
            range_u_mm: along the planes.
            base_mm: material lower than this need not be found.
        """
        return NO_TOPS

    def bins(self, axis: int, met: tuple[int, int], low_mm: FloatArray, high_mm: FloatArray) -> Bins:
        """Material in a box on consecutive planes of a family, as far as the store knows it.

        Args:
            met: the first plane, and how many.
            low_mm, high_mm: corners of the box; material below it need not be found.
        """
        u = PLANE_AXES[axis][0]
        low, high = max(low_mm[u], self.low_mm[u]), min(high_mm[u], self.high_mm[u])
        size = float(BIN_PITCHES * self.pitch_mm[u])
        return Bins(np.full((met[1], max(1, int((high - low) / size) + 1)), math.inf), float(low), size)

    def height_map(self, axis: int, low_mm: FloatArray, high_mm: FloatArray) -> HeightMap:
        """Heights of the material in a box, by one family of vertical planes.

        Args:
            axis: 0 or 1.
            low_mm, high_mm: corners of the box; material below it need not be found.
        """
        low, pitch = float(self.low_mm[axis]), float(self.pitch_mm[axis])
        first = max(0, math.floor((low_mm[axis] - low) / pitch))
        last = min(self.count(axis) - 1, math.floor((high_mm[axis] - low) / pitch))
        bins = self.bins(axis, (first, max(0, last + 1 - first)), low_mm, high_mm)
        return HeightMap(bins.heights, low + first * pitch, bins.u_low, 1.0 / pitch, 1.0 / bins.size)

    @abstractmethod
    def areas_mm2(self, axis: int) -> FloatArray:
        """Areas of material on all planes of a family."""

    @abstractmethod
    def region(self, axis: int, k: int) -> Region:
        """Material on one plane as rings: outer ones counter-clockwise in (u, v), holes clockwise."""

    @abstractmethod
    def line_ends(
        self, axis: int, planes: NDArray[np.int64], fixed: int, at_mm: FloatArray, window_mm: tuple[float, float]
    ) -> LineEnds:
        """See `SliceStore.line_ends`."""

    @abstractmethod
    def count_votes(self, points_mm: FloatArray, enough: int, votes: NDArray[np.int8]) -> None:
        """For each point count the families whose nearest plane has material there, stopping at ``enough``.

        The box that holds the points must have been made ready by `prepare`.

        Args:
            points_mm: shape (n, 3).
            enough: 1 where a single family decides, 2 for a majority of the three.
            votes: shape (n,), starts at 0; at least ``enough`` on return where the point is in material.
        """

    def most_contain(self, points_mm: FloatArray) -> NDArray[np.bool_]:
        """Whether points (n, 3) lie in material on the nearest planes of at least two families; see `count_votes`."""
        votes = np.zeros(len(points_mm), dtype=np.int8)
        self.count_votes(points_mm, 2, votes)
        return np.asarray(votes >= 2)

    @abstractmethod
    def prepare(self, low_mm: FloatArray, high_mm: FloatArray) -> None:
        """Build the planes inside a box, before points are tested."""

    def area_mm2(self, axis: int, k: int) -> float:
        """Area of material on one plane."""
        return float(self.areas_mm2(axis)[k])

    def volume_mm3(self, axis: int) -> float:
        """Volume by the midpoint rule over one family's planes."""
        return float(np.sum(self.areas_mm2(axis)) * self.pitch_mm[axis])

    def contains(self, points_mm: FloatArray, axis: int) -> NDArray[np.bool_]:
        """Whether points (n, 3) lie in material on the nearest plane of a family; False more than half a pitch off."""
        votes = np.zeros(len(points_mm), dtype=np.int8)
        if len(points_mm):
            self.prepare(points_mm.min(axis=0), points_mm.max(axis=0))
        self._vote(np.ascontiguousarray(points_mm), axis, 0, 0, votes)
        return votes > 0

    @abstractmethod
    def _vote(self, points_mm: FloatArray, axis: int, least: int, most: int, votes: NDArray[np.int8]) -> None:
        """Add a family's votes for points whose votes so far lie in [least, most]."""


class CellSlices(TriSlices):
    """The fast store: column cells, see `twin.geometry.column_cells.store_kernels`."""

    def __init__(self, slices: SliceSet) -> None:
        super().__init__(slices)
        self._families = []
        for axis, (u, v) in enumerate(PLANE_AXES):
            low, high = slices.low_mm, slices.high_mm
            pitch = float(max(slices.pitch_mm[u], slices.pitch_mm[v]))
            cell = CELL_PITCHES * pitch
            corner = (float(low[u]), float(low[v])), (float(high[u]), float(high[v]))
            self._families.append(CellFamily(slices.regions[axis], *corner, cell, MERGE_PITCHES * pitch))

    def cut(self, axis: int, strips: Strips, *, apply: bool = True) -> FloatArray:
        """See `TriSlices.cut`."""
        return self._families[axis].cut(strips, apply=apply)

    def tops(self, axis: int, first: int, planes: int, range_u_mm: tuple[float, float], base_mm: float) -> Tops:
        """See `TriSlices.tops`."""
        return self._families[axis].tops(first, planes, range_u_mm, base_mm)

    def bins(self, axis: int, met: tuple[int, int], low_mm: FloatArray, high_mm: FloatArray) -> Bins:
        """See `TriSlices.bins`."""
        u, v = PLANE_AXES[axis]
        range_u, range_v = (low_mm[u], high_mm[u]), (low_mm[v], high_mm[v])
        return self._families[axis].bins(met, range_u, range_v, tops=axis != 2)

    def areas_mm2(self, axis: int) -> FloatArray:
        """See `TriSlices.areas_mm2`."""
        return self._families[axis].area_mm2

    def region(self, axis: int, k: int) -> Region:
        """See `TriSlices.region`."""
        return self._families[axis].region(k)

    def line_ends(
        self, axis: int, planes: NDArray[np.int64], fixed: int, at_mm: FloatArray, window_mm: tuple[float, float]
    ) -> LineEnds:
        """See `SliceStore.line_ends`."""
        return self._families[axis].line_ends(planes, fixed, at_mm, window_mm)

    @property
    def bytes_in_use(self) -> int:
        """Memory that the slices take, without what is kept ready for more."""
        return sum(family.bytes_in_use for family in self._families)

    @property
    def edges_per_cell(self) -> tuple[float, int]:
        """Mean and largest number of edges of the cells that have any; 0 without any."""
        counts = np.concatenate([family.edge_counts for family in self._families])
        return (float(counts.mean()), int(counts.max())) if len(counts) else (0.0, 0)

    def prepare(self, low_mm: FloatArray, high_mm: FloatArray) -> None:
        """See `TriSlices.prepare`: planes are built when first needed; those that are not built hold nothing."""
        for axis, family in enumerate(self._families):
            pitch = self.pitch_mm[axis]
            first = int(np.floor((low_mm[axis] - self.low_mm[axis]) / pitch))
            last = int(np.floor((high_mm[axis] - self.low_mm[axis]) / pitch))
            family.ensure(first, last + 1)

    def count_votes(self, points_mm: FloatArray, enough: int, votes: NDArray[np.int8]) -> None:
        """See `TriSlices.count_votes`; no more families are tested than it takes to decide."""
        for tested, axis in enumerate((0, 1, 2)):
            self._vote(points_mm, axis, enough - (3 - tested), enough - 1, votes)

    def most_contain(self, points_mm: FloatArray) -> NDArray[np.bool_]:
        """See `TriSlices.most_contain`."""
        inside = np.empty(len(points_mm), dtype=np.bool_)
        x, y, z = (family.tested(self._planes(axis)) for axis, family in enumerate(self._families))
        most_contain(points_mm, x, y, z, inside)
        return inside

    def _planes(self, axis: int) -> Planes:
        return Planes(axis, *PLANE_AXES[axis], float(self.low_mm[axis]), float(self.pitch_mm[axis]))

    def _vote(self, points_mm: FloatArray, axis: int, least: int, most: int, votes: NDArray[np.int8]) -> None:
        self._families[axis].vote(points_mm, self._planes(axis), votes, least, most)


class PolygonSlices(TriSlices):
    """The reference store: pyclipper polygons, cut whole, one slice at a time (the tri-slice paper, section 3.3)."""

    def __init__(self, slices: SliceSet) -> None:
        super().__init__(slices)
        self._paths = [[clip.to_paths(r.rings) for r in family] for family in slices.regions]
        self._areas = [np.array([clip.area_mm2(p) for p in family]) for family in self._paths]

    def cut(self, axis: int, strips: Strips, *, apply: bool = True) -> FloatArray:
        """See `TriSlices.cut`."""
        removed = np.zeros(len(strips.at))
        for i, k in enumerate(strips.at):
            outline = strips.outline(i)
            if outline is None:
                continue
            left = clip.difference(self._paths[axis][k], clip.to_paths([outline]))
            area = clip.area_mm2(left)
            removed[i] = self._areas[axis][k] - area
            if apply:
                self._paths[axis][k] = left
                self._areas[axis][k] = area
        return removed

    def areas_mm2(self, axis: int) -> FloatArray:
        """See `TriSlices.areas_mm2`."""
        return self._areas[axis]

    def region(self, axis: int, k: int) -> Region:
        """See `TriSlices.region`."""
        return clip.to_region(self._paths[axis][k])

    def line_ends(
        self,
        axis: int,
        planes: NDArray[np.int64],
        fixed: int,
        at_mm: FloatArray,
        window_mm: tuple[float, float],  # noqa: ARG002
    ) -> LineEnds:
        """See `SliceStore.line_ends`; the whole of every line, whatever the window."""
        rings = ([np.array(p) / clip.UNITS_PER_MM for p in self._paths[axis][k]] for k in planes)
        return ring_line_ends(rings, fixed, at_mm)

    def prepare(self, low_mm: FloatArray, high_mm: FloatArray) -> None:
        """Nothing to do: all planes are there from the start."""

    def count_votes(self, points_mm: FloatArray, enough: int, votes: NDArray[np.int8]) -> None:
        """See `TriSlices.count_votes`."""
        for axis in range(3):
            self._vote(points_mm, axis, 0, enough - 1, votes)

    def _vote(self, points_mm: FloatArray, axis: int, least: int, most: int, votes: NDArray[np.int8]) -> None:
        planes = np.floor((points_mm[:, axis] - self.low_mm[axis]) / self.pitch_mm[axis]).astype(int)
        for i, (point, k) in enumerate(zip(points_mm, planes, strict=True)):
            if least <= votes[i] <= most and 0 <= k < self.count(axis):
                u, v = (float(point[a]) for a in PLANE_AXES[axis])
                votes[i] += clip.inside(self._paths[axis][k], u, v)
