"""Material removal: sweeps subtracted from the workpiece's slices in three directions.

The polygon arithmetic is in `twin.geometry.column_cells.cut_kernels`.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from types import TracebackType
from typing import Self

import numpy as np

from twin.arrays import FloatArray
from twin.geometry.column_cells.strips import NO_TOPS, Tops
from twin.motion.sweep import Sweep
from twin.workpiece.trislice import TriSlices

#: Families in the order in which threads take them: those across the tool axis cost most.
_ORDER = (0, 1, 2)
#: Sweeps no longer than this many pitches are cut only where there is material in their way.
_SHORT_PITCHES = 3.0


class Removal:
    """Subtracts sweeps from a workpiece, the three families in parallel threads.

    Every family's planes are cut by one thread only and in one order, so results do not depend on the number of
    threads.
    """

    def __init__(self, workpiece: TriSlices, chord_mm: float, threads: int = 2) -> None:
        self.workpiece = workpiece
        self._chord_mm = chord_mm
        self._last: tuple[TriSlices, Sweep] | None = None
        self._pool = ThreadPoolExecutor(max_workers=threads) if threads > 1 else None

    def cut(self, sweep: Sweep, *, apply: bool = True) -> float:
        """Take a sweep's volume out of the workpiece (or only measure it with ``apply=False``).

        Returns:
            Removed volume in mm3: the mean of the three families, each by the midpoint rule.
        """
        return float(self.cut_all([sweep], apply=apply)[0])

    def cut_all(self, sweeps: Sequence[Sweep], *, apply: bool = True) -> FloatArray:
        """Take the volumes of several sweeps out, one after the other.

        Returns:
            Removed volume of each, as `cut` gives it.
        """
        last = self._last[1] if self._last is not None and self._last[0] is self.workpiece else None
        levels = self.workpiece.levels()

        def family(axis: int) -> list[float]:
            earlier = (last, *sweeps[:-1]) if apply else [None] * len(sweeps)
            return [
                self._cut_family(axis, sweep, levels, apply, sweep.follows(before)) if self._touched(sweep) else 0.0
                for sweep, before in zip(sweeps, earlier, strict=True)
            ]

        volumes = list(map(family, _ORDER) if self._pool is None else self._pool.map(family, _ORDER))
        if apply and sweeps:
            self._last = (self.workpiece, sweeps[-1])
        return np.asarray(np.sum(volumes, axis=0) / 3.0)

    def _touched(self, sweep: Sweep) -> bool:
        low, high = sweep.bounds_mm
        return bool(np.all(high > self.workpiece.low_mm) and np.all(low < self.workpiece.high_mm))

    def _cut_family(self, axis: int, sweep: Sweep, levels: int, apply: bool, follows: bool) -> float:
        piece = self.workpiece
        low, pitch = float(piece.low_mm[axis]), float(piece.pitch_mm[axis])
        count = levels if axis == 2 else piece.count(axis)
        top = float(piece.low_mm[2] + (levels + 0.5) * piece.pitch_mm[2])  # where the next plane is, which is empty
        tops = self._tops(axis, sweep, count) if follows and axis != 2 else NO_TOPS
        strips = sweep.strips(axis, low, pitch, count, self._chord_mm, start_is_cut=follows, top_mm=top, tops=tops)
        return float(np.sum(piece.cut(axis, strips, apply=apply)) * pitch)

    def _tops(self, axis: int, sweep: Sweep, count: int) -> Tops:
        """Heights of the material about a short sweep: most of what it sweeps has been cut by those before it."""
        piece = self.workpiece
        pitch = float(piece.pitch_mm[axis])
        if sweep.length_mm > _SHORT_PITCHES * pitch:
            return NO_TOPS
        first, planes = sweep.planes_met(axis, float(piece.low_mm[axis]), pitch, count)
        low, high = sweep.bounds_mm
        return piece.tops(axis, first, planes, (float(low[1 - axis]), float(high[1 - axis])), float(low[2]))

    def close(self) -> None:
        """Stop the threads."""
        if self._pool is not None:
            self._pool.shutdown()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
