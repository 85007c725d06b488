"""Measured force logs: as in the file, and as forces on the tool in machine axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

import numpy as np

from twin.arrays import FloatArray, frozen
from twin.measured.table import few
from twin.settings.force_on import ForceOn

#: First and last moment that a gap lies between, s.
Gap: TypeAlias = tuple[float, float]
AXES = ("x", "y", "z")
#: Larger numbers are damage: neither forces nor times.
LARGEST = 1e30
#: Two samples further apart than this many sampling intervals have a gap between them.
GAP_INTERVALS = 1.75
#: Samples are uneven when half of the steps are off by more than this part of the interval ...
UNEVEN = 0.1
#: ... and have a gap where a step is this many times longer than nearly all of them.
UNEVEN_GAP = 5.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Correction:
    """A correction made to a log on purpose, to be printed and stored.

    Attributes:
        kind: ``offset``, ``drift``, ``resample``, ``lowpass``, ``notch``, ``lag``, ``phase``.
        text: one human-readable line.
        values: the numbers, units in the names.
    """

    kind: str
    text: str
    values: dict[str, float | str | list[float]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Channel:
    """One column of a file.

    Attributes:
        name: as in the file, its unit included where the name holds it, e.g. ``Fx [N]``.
        base: the name without unit, e.g. ``Fx``.
        unit: as in the file or as given, ``""`` where not stated.
        values: shape (n,), in that unit; NaN where the file has no number.
    """

    name: str
    base: str
    unit: str
    values: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RawLog:
    """A file's columns before the axis map.

    Attributes:
        source: the file.
        format: what it was read as, e.g. ``delimited text``.
        t_s: shape (n,), strictly increasing, as in the file.
        rate_hz: sampling rate.
        columns: by name as in the file, in the file's order, without the time column.
        notes: how it was read, one line each.
        not_read: columns that are in the file and not here, each with the reason.
    """

    source: Path
    format: str
    t_s: FloatArray
    rate_hz: float
    columns: dict[str, Channel] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    not_read: tuple[str, ...] = ()

    def listing(self) -> str:
        """The columns for a message: ``Time, Fx [N], Fy [N]``."""
        names = [f"{c.name} [{c.unit}]" if c.unit and c.unit not in c.name else c.name for c in self._all()]
        return listed(names, self.not_read)

    def _all(self) -> list[Channel]:
        return list(self.columns.values())


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForceLog:
    """Measured forces on the tool in machine axes, sign conventions as in `twin.record.ForceSamples`.

    Attributes:
        t_s: shape (n,), strictly increasing, clock of the log.
        force_n: shape (n, 3), x, y, z; zero on an axis that is not in ``axes``.
        rate_hz: sampling rate.
        channels: source of each axis, e.g. ``-Fy [N]``, order x, y, z; ``""`` for an axis that is not measured.
        axes: the axes that were measured.
        force_on: the body that the log's own numbers act on; ``force_n`` is always the force on the tool.
        unit: that the forces were taken to be in, ``""`` where not stated.
        spindle_angle_rad: shape (n,), continuous, or None.
        trigger_s: moments of a once-per-revolution pulse, or None.
        gaps: where samples are missing.
        notes: how it was read, one line each.
        corrections: those made afterwards, in order.
    """

    t_s: FloatArray
    force_n: FloatArray
    rate_hz: float
    channels: tuple[str, str, str]
    source: Path
    axes: tuple[str, ...] = AXES
    force_on: ForceOn = "tool"
    unit: str = ""
    spindle_angle_rad: FloatArray | None = None
    trigger_s: FloatArray | None = None
    gaps: tuple[Gap, ...] = ()
    notes: tuple[str, ...] = ()
    corrections: tuple[Correction, ...] = ()

    @property
    def duration_s(self) -> float:
        """From the first sample to the last."""
        return float(self.t_s[-1] - self.t_s[0])

    @property
    def span_s(self) -> tuple[float, float]:
        """Times of the first and the last sample."""
        return float(self.t_s[0]), float(self.t_s[-1])


def listed(names: Sequence[str], not_read: Sequence[str]) -> str:
    """Columns for a message, also those that were not read."""
    return (few(names) or "none") + (f"; not read: {few(not_read)}" if not_read else "")


def gaps_of(t_s: FloatArray, rate_hz: float) -> tuple[Gap, ...]:
    """Jumps of the time; in samples that are uneven throughout, jumps far beyond their steps.

    Args:
        t_s: shape (n,), increasing.
    """
    steps = np.diff(t_s) * rate_hz
    uneven = len(steps) > 0 and float(np.median(np.abs(steps - 1.0))) > UNEVEN
    most = UNEVEN_GAP * float(np.percentile(steps, 95.0)) if uneven else GAP_INTERVALS
    leaps = np.flatnonzero(steps > most)
    return tuple((float(t_s[i]), float(t_s[i + 1])) for i in leaps)


def vector(values: FloatArray, name: str) -> FloatArray:
    """A read-only copy of shape (n,)."""
    return frozen(values, name, (None,))
