"""Lines of a level that cut something: rings or rows of a free area, without air cuts.

Lines are taken one after another. Stretches where the tool would cut less than a least depth are omitted; the
cut of a line is removed from the stock before the next one is considered. So each position is cut once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from twin.arrays import FloatArray
from twin.cam.passes.level_free_areas import CHORD_MM
from twin.cam.passes.pockets import subdivided
from twin.cam.slices import stretch_kernels as kernels
from twin.cam.stock.dexel import Dexels
from twin.cam.stock.rest import stock_heights
from twin.cam.stock.strokes import Strokes
from twin.geometry.polygons.free_area import FreeArea, borders, rows_of, shrunk
from twin.geometry.polygons.outline import pieces
from twin.tools.shape import ToolShape


@dataclass(frozen=True, slots=True, kw_only=True)
class CutOptions:
    """Which stretches count as cutting.

    Attributes:
        least_mm: material thinner than this above the tool is left.
        resolution_mm: distance of the points that are checked.
        bridge_mm: shorter gaps in a line are bridged.
    """

    least_mm: float
    resolution_mm: float
    bridge_mm: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cut:
    """A stretch of a level that cuts.

    Attributes:
        points_mm: of the tip, shape (n >= 2, 3).
        top_mm: highest tip at which the tool would touch the stock over its ends, first and last.
        row: number of the ring or row that it is part of.
    """

    points_mm: FloatArray
    top_mm: tuple[float, float]
    row: int

    @property
    def closed(self) -> bool:
        """Whether it ends where it begins."""
        return bool(np.all(self.points_mm[0] == self.points_mm[-1]))


def ring_layers(free_area: FreeArea, radial_depth_mm: float) -> Iterator[list[FloatArray]]:
    """The borders of a free area, then those further in, until nothing is left."""
    areas = pieces(free_area.area)
    while areas:
        yield [line for area in areas for line in borders(area)]
        areas = [inner for area in areas for inner in shrunk(area, radial_depth_mm, CHORD_MM)]


def row_layers(free_area: FreeArea, radial_depth_mm: float) -> Iterator[list[FloatArray]]:
    """Parallel lines along x, one row a layer, those of a row from left to right."""
    yield from rows_of(free_area, radial_depth_mm)


def cuts_of(
    layers: Iterable[list[FloatArray]], z_mm: float, tool: ToolShape, stock: Dexels, options: CutOptions
) -> Iterator[Cut]:
    """The parts of a level's lines that cut; the stock is lowered by them.

    Args:
        layers: lines in the plan; those of one layer are checked together.
    """
    for row, lines in enumerate(layers):
        fine = [subdivided(line, options.resolution_mm) for line in lines]
        if not fine:
            continue
        heights = stock_heights(stock, tool, np.concatenate(fine))
        found: list[Cut] = []
        begin = 0
        for line in fine:
            tips = heights[begin : begin + len(line)]
            begin += len(line)
            found += _runs(line, tips, z_mm, row, options)
        if found:
            stock.cut(tool, _strokes(found))
        yield from found


def _runs(line: FloatArray, tips: FloatArray, z_mm: float, row: int, options: CutOptions) -> Iterator[Cut]:
    marked = tips > z_mm + options.least_mm
    if not marked.any():
        return
    if np.all(line[0] == line[-1]) and not marked.all():
        # a closed line begins where it does not cut
        k = int(np.flatnonzero(~marked)[0])
        turn = np.concatenate((np.arange(k, len(line) - 1), np.arange(k + 1)))
        line, tips, marked = line[turn], tips[turn], marked[turn]
    bounds = np.empty((len(marked), 2), dtype=np.int64)
    spacing = np.linalg.norm(np.diff(line, axis=0), axis=1)
    count = kernels.runs(np.ascontiguousarray(marked), spacing, options.bridge_mm, bounds)
    for first, last in bounds[:count].tolist():
        a, b = max(0, first - 1), min(len(line) - 1, last + 1)
        points = np.column_stack((line[a : b + 1], np.full(b + 1 - a, z_mm)))
        if len(points) > 1:
            yield Cut(points_mm=points, top_mm=(float(tips[a]), float(tips[b])), row=row)


def _strokes(cuts: list[Cut]) -> Strokes:
    starts = np.concatenate([c.points_mm[:-1] for c in cuts])
    return Strokes(starts, np.concatenate([c.points_mm[1:] for c in cuts]), np.empty((0, 8)))
