"""Forces over a whole run: lowest, highest and mean of each spindle revolution; and which samples a recording keeps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.record import Step

#: Most rows of the envelope of a run: with more revolutions than that, each row stands for several.
MOST_ROWS = 40_000
#: Most samples in a recording, so that a viewer opens it within seconds; a share of them may come at once. Beyond that,
#: whole revolutions are left out.
MOST_SAMPLES, AT_ONCE = 8_000_000, 0.3
_TURN = 2.0 * math.pi
#: Duration of a step in a mean, at least, s.
_LEAST_S = 1e-9


class SampleColumns(NamedTuple):
    """Force samples of consecutive steps.

    Attributes:
        t_s: shape (n,), machine time.
        step, nc_line: shape (n,), number of the step and of its NC line.
        turn: shape (n,), number of the spindle revolution.
        share_s: shape (n,), time that each stands for in a mean.
        loads: shape (n, 5), Fx, Fy, Fz and their resultant, N, and the spindle torque, N·m.
    """

    t_s: FloatArray
    step: NDArray[np.int64]
    nc_line: NDArray[np.int64]
    turn: FloatArray
    share_s: FloatArray
    loads: FloatArray

    @classmethod
    def of(cls, steps: Sequence[Step]) -> SampleColumns:
        """Every sample of some steps."""
        samples = [s.samples for s in steps]
        counts = [len(s.t_s) for s in samples]
        force = np.concatenate([s.force_n for s in samples])
        return cls(
            np.concatenate([s.t_s for s in samples]),
            np.repeat(np.array([s.index for s in steps], np.int64), counts),
            np.repeat(np.array([s.nc_line for s in steps], np.int64), counts),
            np.floor(np.concatenate([s.spindle_angle_rad for s in samples]) / _TURN),
            np.repeat([max(s.duration_s, _LEAST_S) / max(1, n) for s, n in zip(steps, counts, strict=True)], counts),
            np.column_stack((force, np.linalg.norm(force, axis=1), np.concatenate([s.torque_nm for s in samples]))),
        )

    def part(self, which: slice | NDArray[np.bool_]) -> SampleColumns:
        """Some of the samples."""
        return SampleColumns(
            self.t_s[which],
            self.step[which],
            self.nc_line[which],
            self.turn[which],
            self.share_s[which],
            self.loads[which],
        )

    def then(self, others: SampleColumns) -> SampleColumns:
        """These samples and others after them."""
        return SampleColumns(
            np.concatenate((self.t_s, others.t_s)),
            np.concatenate((self.step, others.step)),
            np.concatenate((self.nc_line, others.nc_line)),
            np.concatenate((self.turn, others.turn)),
            np.concatenate((self.share_s, others.share_s)),
            np.concatenate((self.loads, others.loads)),
        )

    @property
    def begins(self) -> NDArray[np.int64]:
        """First sample of each revolution."""
        return np.flatnonzero(np.diff(self.turn, prepend=math.nan) != 0.0)


class EnvelopeRows(NamedTuple):
    """Rows of the envelope, each about one revolution or several.

    Attributes:
        t_s: shape (n,), machine time of the first sample of each.
        step, nc_line: shape (n,), step and NC line of that sample.
        low, high, mean: shape (n, 5), of the loads of `SampleColumns`.
    """

    t_s: FloatArray
    step: NDArray[np.int64]
    nc_line: NDArray[np.int64]
    low: FloatArray
    high: FloatArray
    mean: FloatArray


class Envelope:
    """Makes the envelope of a run from its samples, batch by batch.

    Args:
        planned_time_s: duration of the whole run.
    """

    def __init__(self, planned_time_s: float) -> None:
        self._tick_s = planned_time_s / MOST_ROWS
        self._open: SampleColumns | None = None

    def rows(self, samples: SampleColumns) -> EnvelopeRows | None:
        """The rows that further samples complete."""
        if self._open is not None:
            samples = self._open.then(samples)
        if not len(samples.t_s):
            return None
        begins = self._begins(samples)
        self._open = samples.part(slice(begins[-1], None))
        return _rows(samples.part(slice(begins[-1])), begins[:-1]) if len(begins) > 1 else None

    def rest(self) -> EnvelopeRows | None:
        """The row in progress, at the end of the run."""
        samples, self._open = self._open, None
        return None if samples is None else _rows(samples, self._begins(samples))

    def _begins(self, samples: SampleColumns) -> NDArray[np.int64]:
        """First sample of each row: of a revolution, but no more than one a tick."""
        begins = samples.begins
        if self._tick_s <= 0.0:
            return begins
        ticks = np.floor(samples.t_s[begins] / self._tick_s)
        return np.asarray(begins[np.diff(ticks, prepend=math.nan) != 0.0])


def _rows(samples: SampleColumns, begins: NDArray[np.int64]) -> EnvelopeRows:
    """Rows that begin at some of the samples."""
    share = samples.share_s[:, None]
    mean = np.add.reduceat(samples.loads * share, begins) / np.add.reduceat(share, begins)
    low, high = (f.reduceat(samples.loads, begins) for f in (np.minimum, np.maximum))
    return EnvelopeRows(samples.t_s[begins], samples.step[begins], samples.nc_line[begins], low, high, mean)


class Selection:
    """Chooses the samples that a recording keeps: all of them, or whole revolutions all along a long run.

    Args:
        planned_time_s: duration of the whole run.

    Attributes:
        complete: whether all samples so far were kept.
    """

    def __init__(self, planned_time_s: float) -> None:
        self._planned_s = planned_time_s
        self._kept = 0
        self._interrupted = False
        self.complete = True

    def of(self, samples: SampleColumns) -> SampleColumns:
        """Those that are kept; the curves are interrupted where some are left out."""
        if self._room(samples.t_s[:1], len(samples.t_s)):
            return samples
        begins = samples.begins.tolist()
        kept, loads = np.zeros(len(samples.t_s), dtype=np.bool_), samples.loads.copy()
        for first, end in zip(begins, [*begins[1:], len(kept)], strict=True):
            if self._room(samples.t_s[first : first + 1], end - first):
                kept[first:end] = True
            elif not self._interrupted:
                self._interrupted, self.complete = True, False
                loads[first], kept[first] = math.nan, True
        return samples._replace(loads=loads).part(kept)

    def _room(self, at_s: FloatArray, count: int) -> bool:
        """Keep some samples if there is room for them."""
        gone = float(at_s[0]) / self._planned_s if len(at_s) and self._planned_s > 0.0 else 1.0
        if self._kept + count > MOST_SAMPLES * (AT_ONCE + (1.0 - AT_ONCE) * gone):
            return False
        self._kept += count
        self._interrupted = False
        return True
