"""The clock of LabVIEW measurement files: columns of time, and the moments and steps in the headers of segments."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray
from twin.errors import MeasuredError
from twin.measured.formats.one_clock import Named, on_one_clock
from twin.measured.text.clocks import day_of, moment
from twin.measured.text.marks import Marks

#: Times of two columns are equal within this part of a step.
_SAME = 0.01
#: A segment that begins this many steps away from the end of the last one's follows it without a gap.
_FOLLOWS = 1.5
#: ... or by less than this part of the last digit of the moments.
_UNSURE = 0.9


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentTimes:
    """One segment.

    Attributes:
        line: of its first row.
        x_s: shape (n,), its own times: of its column, or counted from X0 by Delta_X.
        values: shape (n, k).
        counted: whether the times were counted.
        step_s: between samples.
        stamp: moment in the header, None without.
        resolution_s: last digit of the moment.
        notes: on channels that were brought on one clock.
    """

    line: int
    x_s: FloatArray
    values: FloatArray
    counted: bool
    step_s: float
    stamp: datetime | None
    resolution_s: float
    notes: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        path: Path,
        head: dict[str, list[str]],
        line: int,
        marks: Marks,
        columns: Sequence[FloatArray],
        values: FloatArray,
    ) -> SegmentTimes:
        """A segment by its header and its columns of time.

        Args:
            columns: none, one for all channels, or one for each.
            values: shape (n, k).
        """
        steps = _numbers(head.get("Delta_X", []), marks)
        stamps = [_stamp(d, t) for d, t in zip(head.get("Date", []), head.get("Time", []), strict=False)]
        stamp = next((s for s in stamps if s is not None), None)
        step = next((s for s in steps if s > 0.0), math.nan)
        waves, counted = _waves(columns, values, steps, _numbers(head.get("X0", []), marks), stamps, step)
        if not counted and not step > 0.0:
            step = float(np.median(np.diff(columns[0]))) if len(values) > 1 else math.nan
        notes: tuple[str, ...] = ()
        x_s: FloatArray
        if waves is None:
            x_s = columns[0] if columns else _first(head, marks) + step * np.arange(len(values), dtype=np.float64)
        else:
            aligned = on_one_clock(path, waves, [w.name for w in waves])
            values = np.column_stack([c.values for c in aligned.columns])
            x_s = (aligned.start_s or 0.0) + step * np.arange(len(values), dtype=np.float64)
            notes = tuple(aligned.notes)
        digits = len((head.get("Time") or [""])[0].replace(",", ".").partition(".")[2].strip())
        return cls(
            line=line,
            x_s=x_s,
            values=values,
            counted=counted,
            step_s=step,
            stamp=stamp,
            resolution_s=10.0**-digits,
            notes=notes,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class JoinedTimes:
    """The times of all segments: as a column, or counted by a rate."""

    t_s: FloatArray | None
    rate_hz: float | None
    start_s: float
    notes: list[str] = field(default_factory=list)


def joined_times(path: Path, parts: Sequence[SegmentTimes]) -> JoinedTimes:
    """The segments on one clock.

    Raises:
        MeasuredError: segments of several rates, that overlap, or whose column of time begins again without a moment in
            the header.
    """
    first = parts[0]
    notes = list(dict.fromkeys(note for part in parts for note in part.notes))
    rate = 1.0 / first.step_s if first.step_s > 0.0 else None
    if len(parts) == 1:
        start = float(first.x_s[0]) if first.counted and math.isfinite(first.x_s[0]) else 0.0
        return JoinedTimes(t_s=None if first.counted else first.x_s, rate_hz=rate, start_s=start, notes=notes)
    if rate is None and first.counted:
        raise MeasuredError(f"{path}: several segments without times or Delta_X, expected one of them")
    times = [first.x_s]
    unclocked = 0
    for number, part in enumerate(parts[1:], 2):
        last = float(times[-1][-1])
        if min(part.step_s, first.step_s) > 0.0 and abs(part.step_s / first.step_s - 1.0) > _SAME:
            raise MeasuredError(
                f"{path}:{part.line}: segment {number} is sampled at {1.0 / part.step_s:g} Hz, the first one at "
                f"{1.0 / first.step_s:g} Hz; expected one rate: split the file there"
            )
        shifted = _placed(path, number, part, parts[number - 2], first, last)
        unclocked += shifted is None
        times.append(part.x_s - part.x_s[0] + last + part.step_s if shifted is None else shifted)
    notes.append(f"{len(parts)} segments joined")
    if unclocked:
        notes[-1] += f", {unclocked} without a gap: their headers state no later time"
    return JoinedTimes(t_s=np.concatenate(times), rate_hz=rate, start_s=0.0, notes=notes)


def _placed(
    path: Path, number: int, part: SegmentTimes, before: SegmentTimes, first: SegmentTimes, last_s: float
) -> FloatArray | None:
    """Times of a segment on the clock of the first one; None where nothing states them."""
    later = (part.stamp - first.stamp).total_seconds() if part.stamp and first.stamp else 0.0
    goes_on = float(part.x_s[0]) > float(before.x_s[-1])
    agrees = abs(later - float(part.x_s[0] - first.x_s[0])) <= max(part.step_s, first.resolution_s)
    if goes_on and (later == 0.0 or agrees):
        return part.x_s
    resolution = max(first.resolution_s, part.resolution_s)
    if later < 0.0 and part.counted:
        raise MeasuredError(
            f"{path}:{part.line}: segment {number} begins {-later:g} s before the first one by its header; "
            "expected later moments: split the file there"
        )
    if later <= 0.0:
        if part.counted or (part.stamp and later == 0.0 and last_s + part.step_s < resolution):
            return None
        raise MeasuredError(
            f"{path}:{part.line}: the time of segment {number} begins again at {part.x_s[0]:g} s, and its header has "
            "no later Date and Time; expected increasing time: split the file there"
        )
    t_s = part.x_s + later
    step = part.step_s if part.step_s > 0.0 else 0.0
    off = float(t_s[0]) - (last_s + step)
    if abs(off) <= max(_FOLLOWS * step, _UNSURE * resolution):
        return t_s - off
    if off < 0.0:
        raise MeasuredError(
            f"{path}:{part.line}: segment {number} begins at {t_s[0]:g} s by its header, before the end of the last "
            f"one at {last_s:g} s; expected increasing time: split the file there"
        )
    return t_s


def _waves(
    columns: Sequence[FloatArray],
    values: FloatArray,
    steps: Sequence[float],
    x0: Sequence[float],
    stamps: Sequence[datetime | None],
    step: float,
) -> tuple[list[Named] | None, bool]:
    """The channels with their own starts, None where all have the same; and whether times are counted."""
    count = values.shape[1]
    if len(columns) > 1:
        if all(_equal(c, columns[0]) for c in columns):
            return None, False
        waves = []
        for i, x in enumerate(columns):
            good = np.isfinite(x) & np.isfinite(values[:, i])
            own = float(np.median(np.diff(x[good]))) if good.sum() > 1 else step
            waves.append(Named(f"channel {i + 1}", "", values[good, i], 1.0 / own, float(x[good][0])))
        return waves, True
    if columns:
        return None, False
    starts = [(x0[i] if i < len(x0) else 0.0) + _since(stamps, i) for i in range(count)]
    rates = [1.0 / s if s > 0.0 else None for s in steps[:count]] or [None]
    if max(starts) - min(starts) <= _SAME * (step if step > 0.0 else 1.0) and len(set(rates)) == 1:
        return None, True
    rates += [rates[0]] * (count - len(rates))
    return [Named(f"channel {i + 1}", "", values[:, i], rates[i], starts[i]) for i in range(count)], True


def _since(stamps: Sequence[datetime | None], index: int) -> float:
    """Seconds of a channel's moment after the first channel's."""
    own, first = (stamps[index] if index < len(stamps) else None), stamps[0] if stamps else None
    return (own - first).total_seconds() if own is not None and first is not None else 0.0


def _equal(one: FloatArray, two: FloatArray) -> bool:
    usual = float(np.nanmedian(np.abs(np.diff(two)))) if len(two) > 1 else 1.0
    return bool(np.all(np.abs(one - two) <= _SAME * usual))


def _first(head: dict[str, list[str]], marks: Marks) -> float:
    return next(iter(_numbers(head.get("X0", []), marks)), 0.0)


def _numbers(fields: Sequence[str], marks: Marks) -> list[float]:
    """The numbers of a line of the header, also with the other decimal mark."""
    made = []
    for text in fields:
        value = marks.number(text.strip())
        value = Marks("," if marks.decimal == "." else ".").number(text.strip()) if value is None else value
        if value is not None and not math.isnan(value):
            made.append(value)
    return made


def _stamp(day: str, time: str) -> datetime | None:
    found = moment(f"{day.strip()} {time.strip()}")
    if found is None or found.kind != "stamp":
        return None
    first = day_of(found.date)
    return None if first is None else datetime(first.year, first.month, first.day) + timedelta(seconds=found.seconds)
