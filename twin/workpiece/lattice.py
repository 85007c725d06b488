"""The lattice that surfaces are drawn on: nodes where slices of all three families meet, in blocks."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.errors import StockError
from twin.workpiece.store import SliceStore

#: Where no pitch is given, the longest side of the stock has this many cells.
CELLS_ALONG = 200


@dataclass(frozen=True, slots=True, eq=False)
class Lattice:
    """Positions of the nodes along x, y and z.

    The first and the last node of each axis lie half a slice pitch outside of the stock's box; all others lie on
    slices, among them the first and the last one.

    Attributes:
        nodes_mm: increasing, one array an axis.
        planes: number of the slice that each node lies on, -1 for the first and the last.
    """

    nodes_mm: tuple[FloatArray, FloatArray, FloatArray]
    planes: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]

    @classmethod
    def of(cls, store: SliceStore, pitch_mm: float | None = None) -> Lattice:
        """A lattice for a store.

        Args:
            pitch_mm: largest distance of the nodes, as far as the slices are close enough; None for a fineness that
                suits the stock's size.

        Raises:
            StockError: a pitch that is not above 0.
        """
        pitch = float(np.max(store.high_mm - store.low_mm)) / CELLS_ALONG if pitch_mm is None else pitch_mm
        if not (pitch > 0.0 and math.isfinite(pitch)):
            raise StockError(f"mesh pitch {pitch:g} mm; expected a number above 0")
        axes = [_axis(store, axis, pitch) for axis in range(3)]
        return cls((axes[0][0], axes[1][0], axes[2][0]), (axes[0][1], axes[1][1], axes[2][1]))

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of nodes along x, y and z."""
        return len(self.nodes_mm[0]), len(self.nodes_mm[1]), len(self.nodes_mm[2])


def _axis(store: SliceStore, axis: int, pitch_mm: float) -> tuple[FloatArray, NDArray[np.int64]]:
    """Nodes along one axis and the planes that they lie on."""
    low, high, pitch = (float(a[axis]) for a in (store.low_mm, store.high_mm, store.pitch_mm))
    last = store.count(axis) - 1
    every = max(1, math.floor(pitch_mm / pitch * (1.0 + 1e-9)))
    planes = np.unique(np.rint(np.linspace(0, last, 1 + math.ceil(last / every))).astype(np.int64))
    nodes = np.concatenate(([low - 0.5 * pitch], low + (planes + 0.5) * pitch, [high + 0.5 * pitch]))
    return nodes, np.concatenate(([-1], planes, [-1]))


class Patch(NamedTuple):
    """A block of the lattice: a range of cells along x and y, all of them along z."""

    ix: int
    iy: int

    @property
    def name(self) -> str:
        """E.g. ``x0_y2``."""
        return f"x{self.ix}_y{self.iy}"


@dataclass(frozen=True, slots=True, eq=False)
class PatchGrid:
    """A lattice in blocks of ``size`` by ``size`` cells."""

    lattice: Lattice
    size: int

    @property
    def patches(self) -> tuple[Patch, ...]:
        """All blocks."""
        nx, ny = self._counts()
        return tuple(Patch(ix, iy) for ix in range(nx) for iy in range(ny))

    def cells(self, patch: Patch) -> tuple[tuple[int, int], tuple[int, int]]:
        """First and one past the last cell of a block along x and y."""
        ends = [
            (i * self.size, min((i + 1) * self.size, n - 1)) for i, n in zip(patch, self.lattice.shape, strict=False)
        ]
        return ends[0], ends[1]

    def _counts(self) -> tuple[int, int]:
        nx, ny, _ = self.lattice.shape
        return math.ceil((nx - 1) / self.size), math.ceil((ny - 1) / self.size)
