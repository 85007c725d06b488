"""The workpiece's surface while it is machined: what has changed of it, five times a second of machine time.

The slices are exact, and far too slow to be drawn that often; and sweeps wait before they are subtracted from them. So
a height map of the workpiece is cut by every step at once, and drawn in tiles no finer than needed. It follows the
records alone, so the simulation is the same without it. What a height map cannot hold, such as material above a recess,
is drawn at the start and at the end, with the surface of the slices.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby, pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from twin.cam.stock import dexel_kernels
from twin.cam.stock.height_mesh import HeightTiles
from twin.cam.stock.part_heights import part_heights
from twin.record import Collision, Record, Step, WorkpiecePatch
from twin.simulation.tools import ToolSetup
from twin.workpiece.lattice import PatchGrid
from twin.workpiece.to_mesh import PATCH_CELLS, patch_grid, patch_mesh
from twin.workpiece.trislice import TriSlices

#: Machine time between frames, s.
EVERY_S = 0.2
#: Most bytes of meshes in a run: where they come faster than the run goes on, frames are further apart. A share of them
#: is there from the start.
MOST_BYTES, AT_ONCE = 120e6, 0.25
#: How far the drawn surface may lie off the height map, in cells of the surface at the end.
LIMIT = 0.05
#: Distance, in the same unit, that the tool moves before something visible has changed.
VISIBLE = 0.5
#: Most patches along x and y.
MOST_PATCHES = 32
#: Kinds of collisions in which the cutting part removes material.
_CUTTING = ("rapid", "spindle-stopped")

Point: TypeAlias = tuple[float, float, float]
#: A tool and its motion: start and end of the tip.
Stroke: TypeAlias = tuple[int, Point, Point]


class Preview:
    """Follows a replay's records and draws the workpiece.

    Args:
        workpiece: the slices before the first cut.
        tools: by number.
        planned_s: machine time of the whole program.
        pitch_mm: size of the cells of the surface at the end; None for a fineness that suits the stock's size.
    """

    def __init__(
        self, workpiece: TriSlices, tools: Mapping[int, ToolSetup], planned_s: float, pitch_mm: float | None = None
    ) -> None:
        self._workpiece = workpiece
        self._tools = tools
        self._planned_s = planned_s
        self._bytes = 0.0
        self._grid = preview_grid(workpiece, pitch_mm)
        self._part = part_heights(workpiece, self._grid)
        self._cell_mm = float(np.max(np.diff(self._grid.lattice.nodes_mm[0])))
        self._tiles = HeightTiles(self._part.heights, self._part.firsts, LIMIT * self._cell_mm)
        self._patches = self._grid.patches
        self._stale: NDArray[np.bool_] = np.full(len(self._patches), self._part.whole_box)
        self._strokes: list[Stroke] = []
        self._held: list[Stroke] = []
        self._frame_s, self._moved_mm = 0.0, 0.0

    def start(self) -> Iterator[WorkpiecePatch]:
        """The whole surface before the first cut."""
        every = np.arange(len(self._patches))
        yield from self._drawn(every, 0.0) if self._part.whole_box else self._exact(every, 0.0)

    def along(self, records: Iterable[Record]) -> Iterator[Record]:
        """Records with the patches between them, each after the step at whose end, or within which, it is due."""
        for record in records:
            yield record
            if isinstance(record, Step):
                yield from self._step(record)
            elif isinstance(record, Collision) and record.kind in _CUTTING:
                self._strokes += self._held
                self._held.clear()

    def end(self, t_s: float) -> Iterator[WorkpiecePatch]:
        """The surface of the slices wherever it was cut."""
        self._stale[self._cut()] = True
        yield from self._exact(np.flatnonzero(self._stale), t_s)

    def _step(self, step: Step) -> Iterator[WorkpiecePatch]:
        if step.tool not in self._tools or step.start_mm == step.end_mm:
            return
        if step.rapid or step.spindle_rpm == 0.0:
            self._held.append((step.tool, step.start_mm, step.end_mm))
            return
        self._held.clear()
        count = max(1, math.ceil(2.0 * step.duration_s / EVERY_S))
        part_s = step.duration_s / count
        part_mm = math.dist(step.start_mm, step.end_mm) / count
        ends = np.linspace(step.start_mm, step.end_mm, count + 1).tolist()
        for k, (begin, end) in enumerate(pairwise(ends), start=1):
            self._strokes.append((step.tool, begin, end))
            self._moved_mm += part_mm
            now_s = step.t_s + k * part_s
            if now_s + part_s > self._frame_s + EVERY_S and self._moved_mm >= VISIBLE * self._cell_mm:
                if self._bytes > MOST_BYTES * (AT_ONCE + (1.0 - AT_ONCE) * now_s / self._planned_s):
                    continue
                self._frame_s, self._moved_mm = now_s, 0.0
                numbers = self._cut()
                self._stale[numbers] = True
                yield from self._drawn(numbers, now_s)

    def _cut(self) -> NDArray[np.int64]:
        """Cut the strokes out of the height map; the patches that have changed visibly."""
        if not self._strokes:
            return np.zeros(0, dtype=np.int64)
        low, high = np.full(2, np.inf), np.full(2, -np.inf)
        bands = len(self._part.stock.maxima)
        for tool, group in groupby(self._strokes, key=lambda stroke: stroke[0]):
            ends = np.array([(begin, end) for _, begin, end in group])
            meridian = self._tools[tool].cutter.shape.meridian
            dexel_kernels.cut_lines(
                self._part.stock, meridian, np.ascontiguousarray(ends[:, 0]), np.ascontiguousarray(ends[:, 1]), 0, bands
            )
            low = np.minimum(low, ends[..., :2].min(axis=(0, 1)) - meridian.radius)
            high = np.maximum(high, ends[..., :2].max(axis=(0, 1)) + meridian.radius)
        self._strokes.clear()
        return self._tiles.changed(low, high)

    def _drawn(self, numbers: NDArray[np.int64], t_s: float) -> Iterator[WorkpiecePatch]:
        """Patches of the height map."""
        for number, mesh in zip(numbers.tolist(), self._tiles.draw(numbers), strict=True):
            self._bytes += mesh.vertices_mm.nbytes + mesh.normals.nbytes + mesh.triangles.nbytes
            yield WorkpiecePatch(
                t_s=t_s,
                patch=self._patches[number].name,
                vertices_mm=mesh.vertices_mm,
                normals=mesh.normals,
                triangles=mesh.triangles,
            )

    def _exact(self, numbers: NDArray[np.int64], t_s: float) -> Iterator[WorkpiecePatch]:
        """Patches of the slices' surface."""
        for number in numbers.tolist():
            yield patch_mesh(self._workpiece, self._grid, self._patches[number], t_s)


def preview_grid(workpiece: TriSlices, pitch_mm: float | None = None) -> PatchGrid:
    """The patches of a workpiece, no more than `MOST_PATCHES` along x or y."""
    cells = max(patch_grid(workpiece, pitch_mm=pitch_mm).lattice.shape[:2]) - 1
    size = PATCH_CELLS
    while size * MOST_PATCHES < cells:
        size *= 2
    return patch_grid(workpiece, pitch_mm=pitch_mm, size=size)
