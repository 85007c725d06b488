"""Stock as vertical dexels: one height for each point of a plan grid, lowered exactly by moving tools.

A part milled along z without undercuts has one height over each plan point, and so has its stock at every stage: one
number per dexel is enough. A height is exact at the dexel's own position, to rounding; between dexels nothing is
known. All material above a tool is removed with it; shank and holder are not considered.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from twin.arrays import FloatArray, frozen
from twin.cam.stock import dexel_kernels as kernels
from twin.cam.stock.strokes import CHORD_MM, Strokes
from twin.errors import StockError
from twin.geometry.threads import PARTS, run_all
from twin.motion.path import Move
from twin.tools.shape import ToolShape

#: This many strokes are not worth several threads.
_FEW = 64
#: Most dexels a model may have.
_MOST = 400_000_000


class Dexels:
    """Stock as heights over a grid; dexel (i, j) is at low + ((i, j) + 1/2) pitch.

    Args:
        low_mm, high_mm: corners of the plan, shape (2,).
        pitch_mm: distance of dexels; made a little smaller where it does not divide the plan.
        top_mm: height of the stock, a number or one for each dexel.
        floor_mm: its underside; heights never go below.

    Raises:
        StockError: a plan without extent, a pitch that is not possible, or a top below the floor.
    """

    def __init__(
        self,
        low_mm: ArrayLike,
        high_mm: ArrayLike,
        pitch_mm: float,
        top_mm: ArrayLike,
        floor_mm: float = -math.inf,
    ) -> None:
        self.low_mm, self.high_mm = frozen(low_mm, "low_mm", (2,)), frozen(high_mm, "high_mm", (2,))
        extent = self.high_mm - self.low_mm
        if not (extent > 0.0).all():
            raise StockError(f"dexels: plan from {self.low_mm} to {self.high_mm}; expected an extent above 0")
        if not (math.isfinite(pitch_mm) and pitch_mm > 0.0):
            raise StockError(f"dexels: pitch_mm = {pitch_mm:g}; expected a number above 0")
        nx, ny = (max(1, math.ceil(e / pitch_mm - 1e-9)) for e in extent)
        if nx * ny > _MOST:
            raise StockError(f"dexels: pitch_mm = {pitch_mm:g} makes {nx} x {ny} dexels; expected at most {_MOST}")
        self.pitch_mm: FloatArray = extent / (nx, ny)
        self.floor_mm = float(floor_mm)
        self.heights_mm: FloatArray = np.empty((nx, ny))
        self.heights_mm[:] = top_mm
        if not (self.heights_mm >= self.floor_mm).all():
            raise StockError(f"dexels: top_mm below floor_mm = {floor_mm:g}; expected a top not below the floor")
        self._maxima = np.empty((-(-nx // kernels.BLOCK), -(-ny // kernels.BLOCK)))
        kernels.block_maxima(self.heights_mm, self._maxima)

    @property
    def x_mm(self) -> FloatArray:
        """Positions of dexels along x, shape (nx,)."""
        return np.asarray(self.low_mm[0] + (np.arange(self.heights_mm.shape[0]) + 0.5) * self.pitch_mm[0])

    @property
    def y_mm(self) -> FloatArray:
        """Positions of dexels along y, shape (ny,)."""
        return np.asarray(self.low_mm[1] + (np.arange(self.heights_mm.shape[1]) + 0.5) * self.pitch_mm[1])

    @property
    def arrays(self) -> kernels.Stock:
        """The model as kernels take it; heights are shared."""
        (x, y), (pitch_x, pitch_y) = (self.low_mm + 0.5 * self.pitch_mm).tolist(), self.pitch_mm.tolist()
        grid = kernels.grid_of(x, y, pitch_x, pitch_y, self.floor_mm)
        return kernels.Stock(self.heights_mm, self._maxima, grid)

    @property
    def points_mm(self) -> FloatArray:
        """Plan positions of all dexels in the order of ``heights_mm.ravel()``, shape (nx ny, 2)."""
        x, y = np.meshgrid(self.x_mm, self.y_mm, indexing="ij")
        return np.column_stack((x.ravel(), y.ravel()))

    @property
    def cell_mm2(self) -> float:
        """Plan area of one dexel."""
        return float(self.pitch_mm[0] * self.pitch_mm[1])

    def copy(self) -> Dexels:
        """A model of its own with the same heights."""
        other = object.__new__(Dexels)
        other.low_mm, other.high_mm, other.pitch_mm, other.floor_mm = (
            self.low_mm,
            self.high_mm,
            self.pitch_mm,
            self.floor_mm,
        )
        other.heights_mm, other._maxima = self.heights_mm.copy(), self._maxima.copy()
        return other

    def volume_above_mm3(self, z_mm: ArrayLike) -> float:
        """Volume between heights, one or shape (nx, ny), and the stock where it is higher."""
        return float(np.maximum(self.heights_mm - np.asarray(z_mm), 0.0).sum()) * self.cell_mm2

    def cut(self, tool: ToolShape, strokes: Strokes, threads: int | None = None) -> None:
        """Lower the heights to the underside of a tool moving along strokes.

        The lowest strokes come first, so that most of the others find nothing left to cut: the turns of a helix, or
        the levels of roughing.

        Args:
            threads: how many work, None for all cores; heights do not depend on it.
        """
        strokes = strokes.from_lowest()
        rows = self._maxima.shape[0]
        parts = PARTS if len(strokes.starts_mm) + len(strokes.arcs) > _FEW else 1
        bounds = [rows * k // parts for k in range(parts + 1)]
        bands = [(a, b) for a, b in pairwise(bounds) if b > a]
        stock = (self.arrays, tool.meridian)
        run_all(
            [partial(kernels.cut_lines, *stock, strokes.starts_mm, strokes.ends_mm, *band) for band in bands], threads
        )
        if len(strokes.arcs):
            run_all([partial(kernels.cut_arcs, *stock, strokes.arcs, *band) for band in bands], threads)

    def cut_moves(
        self,
        moves: Iterable[Move],
        tools: Mapping[int, ToolShape],
        *,
        chord_mm: float = CHORD_MM,
        threads: int | None = None,
    ) -> None:
        """Lower the heights by moves of several tools; motions without a tool, or with tool 0, cut nothing.

        Rapid motions cut as well: material in their path is removed. Level arcs are exact; other arcs are cut by
        chords that lie off them by at most ``chord_mm``.
        """
        by_tool: dict[int, list[Move]] = {}
        for move in moves:
            if move.tool in tools:
                by_tool.setdefault(move.tool, []).append(move)
        for number, own in by_tool.items():
            self.cut(tools[number], Strokes.of_moves(own, chord_mm), threads)
