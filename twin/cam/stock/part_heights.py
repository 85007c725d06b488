"""A sliced workpiece as a height map: its uppermost material over a plan grid that suits the patches of its surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cam.stock import dexel_kernels
from twin.cam.stock.height_mesh_kernels import CELLS, HeightMap
from twin.workpiece.lattice import PatchGrid
from twin.workpiece.trislice import TriSlices

#: Part of a rectangle's area that is rounding.
_ROUNDING = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PartHeights:
    """Material between two heights over a plan grid.

    Attributes:
        heights: the heights; those at the border lie on the sides of the stock's box. The upper ones are lowered by
            `dexel_kernels.cut_lines` on ``stock``, of which they are a part.
        stock: the upper heights as that kernel takes them.
        firsts: shape (n, 2), column and row of the first node of each patch of the surface, in the patches' order.
        whole_box: whether the workpiece is a whole box, which a height map holds exactly.
    """

    heights: HeightMap
    stock: dexel_kernels.Stock
    firsts: NDArray[np.int64]
    whole_box: bool


def part_heights(workpiece: TriSlices, grid: PatchGrid) -> PartHeights:
    """The height map of a workpiece; a patch of its surface is `CELLS` nodes wide."""
    low, high = workpiece.low_mm, workpiece.high_mm
    finer = CELLS / grid.size
    # the vertices of the surface lie in the middle of the lattice's cells, the outermost ones on the box
    counts = [max(1, round((n - 2) * finer)) for n in grid.lattice.shape[:2]]
    x, y = (np.linspace(low[a], high[a], n + 1) for a, n in enumerate(counts))
    plan = float(np.prod(high[:2] - low[:2]))
    whole_box = bool(np.all(workpiece.areas_mm2(2) >= plan * (1.0 - _ROUNDING)))
    if whole_box:
        tops, bottoms = np.full((len(x), len(y)), high[2]), np.full((len(x), len(y)), low[2])
    else:
        tops, bottoms = _outermost(workpiece, x, y)
    maxima = np.empty((-(-len(x) // dexel_kernels.BLOCK), -(-len(y) // dexel_kernels.BLOCK)))
    dexel_kernels.block_maxima(tops, maxima)
    place = dexel_kernels.grid_of(float(x[0]), float(y[0]), float(x[1] - x[0]), float(y[1] - y[0]), float(low[2]))
    firsts = np.array([(p.ix * CELLS - round(finer), p.iy * CELLS - round(finer)) for p in grid.patches])
    return PartHeights(
        heights=HeightMap(tops, bottoms, x, y),
        stock=dexel_kernels.Stock(tops, maxima, place),
        firsts=firsts,
        whole_box=whole_box,
    )


def _outermost(workpiece: TriSlices, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Heights of the uppermost and the lowest material over a grid, both the lower ones of a neighbour without any."""
    low, high, pitch = workpiece.low_mm, workpiece.high_mm, workpiece.pitch_mm
    planes = np.clip(((x - low[0]) / pitch[0]).astype(np.int64), 0, workpiece.count(0) - 1)
    inside = np.clip(y, low[1] + 0.01 * pitch[1], high[1] - 0.01 * pitch[1])
    found = workpiece.line_ends(0, planes, 0, inside, (float(low[2]), float(high[2])))
    first, end = found.offsets[:-1], found.offsets[1:]
    held = (end > first).reshape(len(x), len(y))
    tops, bottoms = np.full(held.size, np.nan), np.full(held.size, np.nan)
    full = held.ravel()
    tops[full], bottoms[full] = found.ends_mm[end[full] - 1], found.ends_mm[first[full]]
    tops, bottoms = tops.reshape(held.shape), bottoms.reshape(held.shape)
    outside = np.where(held, np.inf, _lowest_neighbour(bottoms))
    tops[~held] = bottoms[~held] = np.where(np.isfinite(outside[~held]), outside[~held], low[2])
    return tops, bottoms


def _lowest_neighbour(values: FloatArray) -> FloatArray:
    """The least of the values around each node, inf where there is none."""
    padded = np.pad(np.where(np.isnan(values), np.inf, values), 1, constant_values=np.inf)
    nx, ny = values.shape
    return np.asarray(np.minimum.reduce([padded[i : i + nx, j : j + ny] for i in range(3) for j in range(3)]))
