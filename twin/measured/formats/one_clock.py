"""Channels that start at different moments, or have different lengths, on one clock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray
from twin.errors import MeasuredError

#: Rates that differ by less than this part are one rate.
_SAME_RATE = 1e-6
#: Samples of two channels that are nearer than this part of an interval are at the same time.
_SAME_TIME = 0.01
#: Channels must have this share of the longest one in common.
_LEAST_COMMON = 0.5
#: Starts are at most this far from the clock's zero; steps are larger, and smaller, than these.
_LATEST_S, _STEPS_S = 1e12, (1e-12, 1e6)


@dataclass(frozen=True, slots=True)
class Named:
    """An array with its path in the file.

    Attributes:
        name: ``group/name``.
        unit: ``""`` if not stated.
        values: shape (n,) or (n, k).
        rate_hz: its own sampling rate, if stated.
        start_s: time of its first sample on a clock that all arrays of the file share, if stated.
    """

    name: str
    unit: str
    values: FloatArray
    rate_hz: float | None = None
    start_s: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Aligned:
    """Columns of equal length that begin at one time.

    Attributes:
        rate_hz: common rate, None where none is stated.
        start_s: time of the first row on the clock of the file's starts, None where none is stated.
        notes: what was done.
        not_read: columns that do not fit, each with the reason.
    """

    columns: list[Named]
    rate_hz: float | None
    start_s: float | None
    notes: list[str]
    not_read: list[str]


def on_one_clock(path: Path, columns: Sequence[Named], needed: Sequence[str]) -> Aligned:
    """The samples that the needed columns have in common; other columns that lack some of them are left out.

    Where no column states its start all begin together. Between the samples of a column that is off by a part of an
    interval the values are linear.

    Args:
        columns: each of shape (n,).
        needed: names of columns that cannot be left out.

    Raises:
        MeasuredError: needed columns at several rates, without a common time, or of very different lengths.
    """
    must = [c for c in columns if c.name in needed]
    for column in must:
        if column.start_s is not None and not abs(column.start_s) < _LATEST_S:
            raise MeasuredError(f"{path}: {column.name} starts at {column.start_s:g} s, expected a time of a recording")
    rate = _rate(path, must)
    stated = [c.start_s for c in columns if c.start_s is not None]
    notes = []
    if stated and any(c.start_s is None for c in must):
        names = ", ".join(c.name for c in must if c.start_s is None)
        notes.append(f"no start stated for {names}: taken as the earliest of the others")
    first = min(stated, default=0.0)
    step = 1.0 / rate if rate else 1.0
    offsets = {c.name: 0.0 if c.start_s is None or not rate else (c.start_s - first) / step for c in columns}
    begin = max(offsets[c.name] for c in must)
    count = int(np.floor(min(offsets[c.name] + len(c.values) for c in must) - begin + _SAME_TIME))
    _check_common(path, must, offsets, count, step)
    kept, left = [], []
    for column in columns:
        lag = begin - offsets[column.name]
        if rate and column.rate_hz and abs(column.rate_hz / rate - 1.0) > _SAME_RATE:
            left.append(f"{column.name} ({column.rate_hz:g} Hz)")
        elif lag < -_SAME_TIME or lag + count > len(column.values) + _SAME_TIME:
            left.append(f"{column.name} ({len(column.values)} samples)")
        else:
            kept.append(replace(column, values=_from(column.values, lag, count)))
    notes += _notes(must, offsets, begin, count, step)
    if left:
        notes.append(f"not read, of another length or clock: {', '.join(left[:6])}{', ...' if left[6:] else ''}")
    return Aligned(
        columns=kept, rate_hz=rate, start_s=first + begin * step if stated else None, notes=notes, not_read=left
    )


def _rate(path: Path, columns: Sequence[Named]) -> float | None:
    rates = [c.rate_hz for c in columns if c.rate_hz and _STEPS_S[0] < 1.0 / c.rate_hz < _STEPS_S[1]]
    if rates and max(rates) / min(rates) - 1.0 > _SAME_RATE:
        listed = ", ".join(f"{c.name} {c.rate_hz:g} Hz" for c in columns if c.rate_hz)
        raise MeasuredError(f"{path}: channels at several rates: {listed}; choose a group of one rate by --group")
    return rates[0] if rates else None


def _check_common(path: Path, columns: Sequence[Named], offsets: dict[str, float], count: int, step: float) -> None:
    longest = max(len(c.values) for c in columns)
    if count >= max(2.0, _LEAST_COMMON * longest):
        return
    if len({round(offsets[c.name], 2) for c in columns}) > 1:
        spans = [(c.name, offsets[c.name] * step, (offsets[c.name] + len(c.values) - 1) * step) for c in columns]
        listed = ", ".join(f"{name} {a:.6g} to {b:.6g} s" for name, a, b in spans)
        raise MeasuredError(
            f"{path}: channels that start at different times, with {max(count, 0)} common samples: {listed}; expected "
            "forces recorded together"
        )
    listed = ", ".join(f"{c.name} {len(c.values)}" for c in columns)
    raise MeasuredError(f"{path}: columns of different length: {listed} samples; expected forces recorded together")


def _from(values: FloatArray, lag: float, count: int) -> FloatArray:
    """``count`` samples from ``lag`` intervals after the first one."""
    whole = round(lag)
    if abs(lag - whole) <= _SAME_TIME:
        return values[whole : whole + count]
    between: FloatArray = np.interp(lag + np.arange(count), np.arange(len(values)), values)
    return between


def _notes(columns: Sequence[Named], offsets: dict[str, float], begin: float, count: int, step: float) -> list[str]:
    starts = {c.name: offsets[c.name] for c in columns}
    if max(starts.values()) - min(starts.values()) > _SAME_TIME:
        listed = ", ".join(f"{name} {at * step:.6g} s" for name, at in starts.items())
        between = any(abs(begin - at - round(begin - at)) > _SAME_TIME for at in starts.values())
        more = ", linear between samples" if between else ""
        return [f"channels start at different times ({listed}): the {count} samples in common{more}"]
    lengths = {c.name: len(c.values) for c in columns}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{name} {n}" for name, n in lengths.items())
        return [f"columns of different length ({listed}): the first {count} samples"]
    return []
