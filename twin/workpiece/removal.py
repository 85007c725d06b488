"""Material removal: sweeps subtracted from the workpiece's slices in three directions.

The polygon arithmetic is in `twin.geometry.column_cells.cut_kernels`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from types import TracebackType
from typing import NamedTuple, Self, TypeAlias

import numpy as np

from twin.arrays import FloatArray
from twin.geometry.column_cells.strips import NO_TOPS, Tops
from twin.motion.chain import Chain, follows
from twin.motion.sweep import Sweep
from twin.motion.union import SweepUnion
from twin.workpiece.retraced import Retraced
from twin.workpiece.trislice import TriSlices

#: Families in the order in which threads take them: those across the tool axis cost most.
_ORDER = (0, 1, 2)
#: Sweeps no longer than this many pitches are cut only where there is material in their way.
_SHORT_PITCHES = 3.0
#: At least this many sweeps are cut as a union; none of them begins farther from the end of the one before, or is
#: longer, than this many diameters.
_UNITED, _CLOSE_DIAMETERS = 3, 4.0
#: After this many chains that left the volume at their end to the next sweep, one is cut whole.
_CHAINS_LEFT = 3


#: What is subtracted at once.
Swept: TypeAlias = Sweep | Chain | SweepUnion


class _Cut(NamedTuple):
    """A sweep to be subtracted, and the parts of it that need not be; see `Sweep.strips` and `Chain.strips`."""

    sweep: Swept
    start_is_cut: bool
    end_is_left: bool
    band_mm: float


class Removal:
    """Subtracts sweeps from a workpiece, the three families in parallel threads.

    Every family's planes are cut by one thread only and in one order, so results do not depend on the number of
    threads.
    """

    def __init__(self, workpiece: TriSlices, chord_mm: float, threads: int = 2) -> None:
        self.workpiece = workpiece
        self._chord_mm = chord_mm
        self._last: tuple[TriSlices, Swept] | None = None
        self._left = 0
        self._retraced = Retraced()
        self._pool = ThreadPoolExecutor(max_workers=threads) if threads > 1 else None

    def cut(self, sweep: Sweep, *, apply: bool = True) -> float:
        """Take a sweep's volume out of the workpiece (or only measure it with ``apply=False``).

        Returns:
            Removed volume in mm3: the mean of the three families, each by the midpoint rule.
        """
        return float(self.cut_all([sweep], apply=apply)[0])

    def cut_all(self, sweeps: Sequence[Swept], *, apply: bool = True, after: Sweep | None = None) -> FloatArray:
        """Take the volumes of several sweeps out, one after the other.

        Args:
            after: the sweep that will be subtracted next, where that is known: chains may leave it some of their
                volume, see `twin.motion.chain`.

        Returns:
            Removed volume of each, as `cut` gives it.
        """
        levels = self.workpiece.levels()
        cuts = self._cuts(sweeps, after) if apply else [_Cut(sweep, False, False, math.inf) for sweep in sweeps]

        def family(axis: int) -> list[float]:
            return [self._cut_family(axis, cut, levels, apply) if self._touched(cut.sweep) else 0.0 for cut in cuts]

        volumes = list(map(family, _ORDER) if self._pool is None else self._pool.map(family, _ORDER))
        if apply and sweeps:
            self._last = (self.workpiece, sweeps[-1])
        return np.asarray(np.sum(volumes, axis=0) / 3.0)

    @property
    def left(self) -> Sweep | None:
        """The body at rest at the end of the last chain, if that was left to the sweep that comes next."""
        if self._left == 0 or self._last is None:
            return None
        last = self._last[1]
        return Sweep(last.body, last.end_mm, last.end_mm)

    def _cuts(self, sweeps: Sequence[Swept], after: Sweep | None) -> list[_Cut]:
        """Several sweeps, each with the parts of it that need not be cut.

        The body between two chains that go down is left to the second, which goes deeper there; of two sweeps that
        rise, or are cut one by one, the first cuts it.
        """
        before = self._last[1] if self._last is not None and self._last[0] is self.workpiece else None
        cuts = []
        for sweep, following in zip(sweeps, (*sweeps[1:], after), strict=True):
            start_is_cut = self._left == 0 and follows(sweep, before)
            left = isinstance(sweep, Chain) and sweep.descends and self._left < _CHAINS_LEFT
            left = left and following is not None and follows(following, sweep)
            cut: Swept = sweep
            band_mm = math.inf
            if isinstance(sweep, Chain):
                band_mm = self._retraced.band_mm(sweep)
                united = self.united(sweep.sweeps) if band_mm == math.inf else []
                if len(united) == 1:
                    cut, left = united[0], False
                self._retraced.add(sweep, end_is_left=left)
            self._left = self._left + 1 if left else 0
            cuts.append(_Cut(cut, start_is_cut, left, band_mm))
            before = sweep
        return cuts

    def _touched(self, sweep: Swept) -> bool:
        low, high = sweep.bounds_mm
        return bool(np.all(high > self.workpiece.low_mm) and np.all(low < self.workpiece.high_mm))

    def _cut_family(self, axis: int, cut: _Cut, levels: int, apply: bool) -> float:
        piece, sweep = self.workpiece, cut.sweep
        if isinstance(sweep, SweepUnion):
            return self._cut_union(axis, sweep, levels, start_is_cut=cut.start_is_cut)
        low, pitch = float(piece.low_mm[axis]), float(piece.pitch_mm[axis])
        count = levels if axis == 2 else piece.count(axis)
        top = self._top_mm(levels)
        if isinstance(sweep, Chain):
            settled = self._settled(axis, sweep, count) if cut.band_mm >= 0.0 else 0
            alone = self._cut_alone(sweep, cut, settled, top, apply) if settled else 0.0
            strips = sweep.strips(
                axis,
                low,
                pitch,
                count,
                self._chord_mm,
                from_plane=settled,
                start_is_cut=cut.start_is_cut,
                end_is_left=cut.end_is_left,
                top_mm=top,
                band_mm=cut.band_mm,
            )
            return alone + float(np.sum(piece.cut(axis, strips, apply=apply)) * pitch)
        known = cut.start_is_cut and axis != 2
        tops = self._tops(axis, sweep, count) if known else NO_TOPS
        strips = sweep.strips(
            axis, low, pitch, count, self._chord_mm, start_is_cut=cut.start_is_cut, top_mm=top, tops=tops
        )
        return float(np.sum(piece.cut(axis, strips, apply=apply)) * pitch)

    def _cut_union(self, axis: int, union: SweepUnion, levels: int, *, start_is_cut: bool) -> float:
        """Cut a family's planes where a union meets material; returns the volume."""
        piece = self.workpiece
        low, pitch = float(piece.low_mm[axis]), float(piece.pitch_mm[axis])
        met = union.planes_met(axis, low, pitch, levels if axis == 2 else piece.count(axis))
        if met[1] <= 0:
            return 0.0
        strips = union.strips(
            axis,
            low + 0.5 * pitch,
            pitch,
            met,
            self._chord_mm,
            bins=piece.bins(axis, met, *union.bounds_mm),
            top_mm=self._top_mm(levels),
            start_is_cut=start_is_cut,
        )
        return float(np.sum(piece.cut(axis, strips)) * pitch)

    def _top_mm(self, levels: int) -> float:
        """Where the first plane above the material is, which is empty."""
        return float(self.workpiece.low_mm[2] + (levels + 0.5) * self.workpiece.pitch_mm[2])

    def united(self, sweeps: Sequence[Sweep]) -> list[Sweep | SweepUnion]:
        """Sweeps of one body, in unions where several are close to each other and reach above the material."""
        top_mm = self._top_mm(self.workpiece.levels())
        found: list[Sweep | SweepUnion] = []
        for together in _close(sweeps):
            union = SweepUnion.of(together)
            if len(together) < _UNITED or not union.reaches_above(top_mm):
                found.extend(together)
            else:
                found.append(union)
        return found

    def _settled(self, axis: int, chain: Chain, count: int) -> int:
        """The first plane of a family on which the chain's section is in one piece; see `Chain.settled_mm`."""
        if axis != 2 or chain.settled_mm == -math.inf:
            return 0
        low, pitch = float(self.workpiece.low_mm[2]), float(self.workpiece.pitch_mm[2])
        return min(count, max(0, math.ceil((chain.settled_mm - low) / pitch - 0.5)))

    def _cut_alone(self, chain: Chain, cut: _Cut, below: int, top_mm: float, apply: bool) -> float:
        """Cut a chain's sweeps one by one on the planes across the tool axis below an index; returns the volume."""
        piece, volume, start_is_cut = self.workpiece, 0.0, cut.start_is_cut
        low, pitch = float(piece.low_mm[2]), float(piece.pitch_mm[2])
        for sweep in chain.sweeps:
            strips = sweep.strips(2, low, pitch, below, self._chord_mm, start_is_cut=start_is_cut, top_mm=top_mm)
            volume += float(np.sum(piece.cut(2, strips, apply=apply)) * pitch)
            start_is_cut = True
        return volume

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


def _close(sweeps: Sequence[Sweep]) -> Iterator[list[Sweep]]:
    """Consecutive sweeps that are short and close to each other."""
    held: list[Sweep] = []
    for sweep in sweeps:
        reach = _CLOSE_DIAMETERS * 2.0 * sweep.body.radius_mm
        far = held and float(np.abs(sweep.start_mm - held[-1].end_mm).max()) > reach
        if held and (far or sweep.length_mm > reach or held[-1].length_mm > reach):
            yield held
            held = []
        held.append(sweep)
    if held:
        yield held
