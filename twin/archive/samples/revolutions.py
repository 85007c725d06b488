"""Lowest, highest and mean forces of each spindle revolution, ``twin.RevolutionForce``, for viewers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.archive import schemas
from twin.archive.samples.fixed_records import FixedRecords
from twin.arrays import FloatArray
from twin.record import Step

#: Duration of a step in a mean, at least, s.
_LEAST_S = 1e-9
_TURN = 2.0 * math.pi
_LOADS = ("fx_{}_n", "fy_{}_n", "fz_{}_n", "resultant_{}_n", "torque_{}_nm")


class _Samples(NamedTuple):
    """Samples of consecutive steps.

    Attributes:
        turn, t_s, share_s: shape (n,), number of the revolution, machine time, and time that the sample stands for.
        nc_line: shape (n,).
        loads: shape (n, 5), Fx, Fy, Fz and their resultant, N, and the torque, N·m.
    """

    turn: FloatArray
    t_s: FloatArray
    share_s: FloatArray
    nc_line: NDArray[np.uint32]
    loads: FloatArray

    @classmethod
    def of(cls, steps: Sequence[Step]) -> _Samples:
        """Every sample of some steps."""
        samples = [s.samples for s in steps]
        counts = [len(s.t_s) for s in samples]
        force = np.concatenate([s.force_n for s in samples])
        return cls(
            np.floor(np.concatenate([s.spindle_angle_rad for s in samples]) / _TURN),
            np.concatenate([s.t_s for s in samples]),
            np.repeat([max(s.duration_s, _LEAST_S) / n for s, n in zip(steps, counts, strict=True)], counts),
            np.repeat(np.array([s.nc_line for s in steps], np.uint32), counts),
            np.column_stack((force, np.linalg.norm(force, axis=1), np.concatenate([s.torque_nm for s in samples]))),
        )

    def part(self, which: slice | NDArray[np.intp]) -> _Samples:
        """Some of the samples."""
        return _Samples(self.turn[which], self.t_s[which], self.share_s[which], self.nc_line[which], self.loads[which])

    def then(self, others: _Samples) -> _Samples:
        """These samples and others after them."""
        return _Samples(
            np.concatenate((self.turn, others.turn)),
            np.concatenate((self.t_s, others.t_s)),
            np.concatenate((self.share_s, others.share_s)),
            np.concatenate((self.nc_line, others.nc_line)),
            np.concatenate((self.loads, others.loads)),
        )

    @property
    def begins(self) -> NDArray[np.intp]:
        """First sample of each revolution."""
        return np.flatnonzero(np.diff(self.turn, prepend=math.nan) != 0.0)


class Revolutions:
    """Sums up the samples of a run, batch by batch."""

    def __init__(self) -> None:
        self._open: _Samples | None = None
        self._idle = False

    def records(self, steps: Sequence[Step], layout: FixedRecords, sequence: int) -> NDArray[np.void]:
        """Message records of the revolutions that further steps complete; each step has samples.

        Args:
            layout: of ``twin.RevolutionForce`` on its channel.
            sequence: number of the first message on the channel.
        """
        samples = _Samples.of(steps)
        if self._open is not None:
            samples = self._open.then(samples)
        last = int(samples.begins[-1])
        self._open = samples.part(slice(last, None))
        return self._encode(samples.part(slice(last)), layout, sequence)

    def rest(self, layout: FixedRecords, sequence: int) -> NDArray[np.void]:
        """The record of the revolution in progress, at the end of the run; see `records`."""
        samples, self._open = self._open, None
        return layout.empty(0, sequence) if samples is None else self._encode(samples, layout, sequence)

    def _encode(self, samples: _Samples, layout: FixedRecords, sequence: int) -> NDArray[np.void]:
        """Records of whole revolutions. Without forces in several revolutions, the first and the last are kept."""
        if not len(samples.t_s):
            return layout.empty(0, sequence)
        begins = samples.begins
        share = samples.share_s[:, None]
        mean = np.add.reduceat(samples.loads * share, begins) / np.add.reduceat(share, begins)
        low, high = (f.reduceat(samples.loads, begins) for f in (np.minimum, np.maximum))
        idle = ~(np.any(low, axis=1) | np.any(high, axis=1))
        kept = ~(idle & np.append(self._idle, idle[:-1]) & np.append(idle[1:], False))
        self._idle = bool(idle[-1])
        records = layout.empty(int(kept.sum()), sequence)
        for which, values in (("lowest", low), ("highest", high), ("mean", mean)):
            for column, load in enumerate(_LOADS):
                if (name := load.format(which)) in _NAMES:
                    records[name] = values[kept, column]
        first = samples.part(begins[kept])
        records["t_s"], records["nc_line"] = first.t_s, first.nc_line
        records["log_time"] = records["publish_time"] = np.rint(first.t_s * 1e9)
        return records


_NAMES = frozenset(name for name, _, _ in schemas.MESSAGES[schemas.REVOLUTION])
