"""When the surface of the workpiece is shown, and which part of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from twin.arrays import FloatArray
from twin.record import WorkpiecePatch
from twin.workpiece.lattice import PatchGrid
from twin.workpiece.to_mesh import patch_grid, patch_mesh
from twin.workpiece.trislice import TriSlices

#: Key frames of the workpiece in a run.
FRAMES = 20


class Preview:
    """Meshes of the workpiece, patch by patch, at key frames.

    Args:
        pitch_mm: size of the mesh's cells; None for a fineness that suits the stock's size.
        every_s: machine time between key frames.
    """

    def __init__(self, workpiece: TriSlices, pitch_mm: float | None, every_s: float) -> None:
        self._workpiece = workpiece
        self._grid: PatchGrid = patch_grid(workpiece, pitch_mm=pitch_mm)
        self._every_s = every_s
        self._next_s = every_s

    def due(self, t_s: float) -> bool:
        """Whether it is time for the next key frame."""
        if t_s < self._next_s:
            return False
        self._next_s = t_s + self._every_s
        return True

    def all_patches(self, t_s: float) -> Iterator[WorkpiecePatch]:
        """The whole workpiece."""
        for patch in self._grid.patches:
            yield patch_mesh(self._workpiece, self._grid, patch, t_s)

    def changed_patches(self, t_s: float, changed: Iterable[tuple[FloatArray, FloatArray]]) -> Iterator[WorkpiecePatch]:
        """The patches that boxes touch, given by their lower and upper corners."""
        touched = {patch for low, high in changed for patch in self._grid.touching(low, high)}
        for patch in sorted(touched):
            yield patch_mesh(self._workpiece, self._grid, patch, t_s)
