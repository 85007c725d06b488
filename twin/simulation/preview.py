"""The workpiece's surface at key frames: when it is drawn, and which part of it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from twin.arrays import FloatArray
from twin.record import WorkpiecePatch
from twin.simulation.material import Material
from twin.workpiece.lattice import PatchGrid
from twin.workpiece.to_mesh import patch_grid, patch_mesh
from twin.workpiece.trislice import TriSlices

#: Key frames of the workpiece in a run.
FRAMES = 20
#: A straight motion of the tool tip: start and end, shape (3,), mm, and its duration, s.
Piece: TypeAlias = tuple[FloatArray, FloatArray, float]


class Preview:
    """Meshes of the workpiece, patch by patch, at key frames.

    Args:
        grid: the patches, None to draw nothing.
        every_s: machine time between key frames.
    """

    def __init__(self, grid: PatchGrid | None, every_s: float) -> None:
        self._grid = grid
        self._next_s = every_s
        self._every_s = every_s

    @classmethod
    def of(cls, workpiece: TriSlices, pitch_mm: float | None, every_s: float) -> Preview:
        """The preview of a workpiece.

        Args:
            pitch_mm: size of the mesh's cells; None for a fineness that suits the stock's size.
            every_s: machine time between key frames.
        """
        return cls(patch_grid(workpiece, pitch_mm=pitch_mm), every_s)

    @classmethod
    def none(cls) -> Preview:
        """A preview that draws nothing."""
        return cls(None, math.inf)

    def parts(self, start_mm: FloatArray, end_mm: FloatArray, duration_s: float) -> Iterator[Piece]:
        """A straight motion in parts that take no longer than the time between key frames."""
        count = max(1, math.ceil(duration_s / self._every_s)) if np.any(end_mm != start_mm) else 1
        ends = [start_mm + (end_mm - start_mm) * (i / count) for i in range(count)] + [end_mm]
        for a, b in pairwise(ends):
            yield a, b, duration_s / count

    def whole(self, workpiece: TriSlices) -> Iterator[WorkpiecePatch]:
        """All of the workpiece, at program start."""
        if self._grid is None:
            return
        for patch in self._grid.patches:
            yield patch_mesh(workpiece, self._grid, patch, 0.0)

    def frame(self, material: Material, t_s: float) -> Iterator[WorkpiecePatch]:
        """The changed patches, if it is time for the next key frame."""
        if t_s >= self._next_s:
            self._next_s = t_s + self._every_s
            yield from self.changes(material, t_s)

    def changes(self, material: Material, t_s: float) -> Iterator[WorkpiecePatch]:
        """The patches in which material was removed since they were last drawn."""
        boxes = material.take_changed()
        if self._grid is None:
            return
        touched = {patch for low, high in boxes for patch in self._grid.touching(low, high)}
        for patch in sorted(touched):
            yield patch_mesh(material.workpiece, self._grid, patch, t_s)
