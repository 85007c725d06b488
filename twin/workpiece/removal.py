"""Material removal: sweeps subtracted from the workpiece's slices in three directions."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from types import TracebackType
from typing import Self

import numpy as np

from twin.motion.sweep import Sweep
from twin.workpiece.trislice import TriSlices


class Removal:
    """Subtracts sweeps from a workpiece, the three families side by side in threads.

    Every family's planes are worked on by one thread only and in one order, so results do not depend on how many
    threads there are.
    """

    def __init__(self, workpiece: TriSlices, chord_mm: float, threads: int = 2) -> None:
        self.workpiece = workpiece
        self._chord_mm = chord_mm
        self._pool = ThreadPoolExecutor(max_workers=threads) if threads > 1 else None

    def cut(self, sweep: Sweep, *, apply: bool = True) -> float:
        """Take a sweep's volume out of the workpiece (or only measure it with ``apply=False``).

        Returns:
            Removed volume in mm3: the mean of what the three families say, each by the midpoint rule.
        """
        low, high = sweep.bounds_mm
        if np.any(high <= self.workpiece.low_mm) or np.any(low >= self.workpiece.high_mm):
            return 0.0
        if self._pool is None:
            volumes = [self._cut_family(axis, sweep, apply) for axis in range(3)]
        else:
            volumes = list(self._pool.map(lambda axis: self._cut_family(axis, sweep, apply), range(3)))
        return sum(volumes) / 3.0

    def _cut_family(self, axis: int, sweep: Sweep, apply: bool) -> float:
        piece = self.workpiece
        low, pitch = float(piece.low_mm[axis]), float(piece.pitch_mm[axis])
        strips = sweep.strips(axis, low, pitch, piece.count(axis), self._chord_mm)
        return float(np.sum(piece.cut(axis, strips, apply=apply)) * pitch)

    def close(self) -> None:
        """Let the threads go."""
        if self._pool is not None:
            self._pool.shutdown()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
