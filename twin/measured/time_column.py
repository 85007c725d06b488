"""From a table to a raw log: which column is the time, in which unit, and what the sampling rate is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray
from twin.errors import MeasuredError
from twin.measured.axes import aliases
from twin.measured.log import GAP_INTERVALS, LARGEST, UNEVEN, UNEVEN_GAP, Channel, RawLog, gaps_of, listed, vector
from twin.measured.settings import AS_IN_FILE, LogReading
from twin.measured.table import Table
from twin.measured.units import ANGLE_NAME, TIME_NAME, find_unit, split_unit

#: A given rate and the one of the time column may differ by this much before it is worth a note.
_SAME_RATE = 0.01
_DAY_S = 86400.0
#: Moments since 1970 of a log, s.
_EPOCH_S = (6e8, 4e9)
#: Days since 1900 and since the year 0, as tables and MATLAB count them, of logs.
_DAY_NUMBERS = ((30_000.0, 60_000.0), (720_000.0, 760_000.0))
#: Over midnight a step may differ from the usual one by this many of it, or by this much.
_DAY_JUMP, _DAY_JUMP_S = 3.0, 1e-3
#: An example of names for columns ends in points where it would have this many further ones.
_MOST_IN_EXAMPLE = 20
#: Times that repeat must step this many times at least before a rate can be counted.
_LEAST_STEPS = 2
#: Rates outside are damage.
_POSSIBLE_HZ = (1e-6, 1e12)
#: Rates outside are a sign of a wrong unit of time.
_PLAUSIBLE_HZ = (20.0, 1e7)


def raw_log(path: Path, table: Table, reading: LogReading = AS_IN_FILE) -> RawLog:
    """Find the time and make the log.

    Args:
        reading: a sampling rate wins over the file; a spindle speed makes time of a column of the spindle angle where
            there is none of time.

    Raises:
        MeasuredError: neither a time column nor a rate; time that goes back; an unknown unit of time.
    """
    rate_hz, rpm = reading.rate_hz, reading.rpm
    if table.rate_hz is not None and not _POSSIBLE_HZ[0] <= table.rate_hz <= _POSSIBLE_HZ[1]:
        note = f"sampling rate {table.rate_hz:g} Hz in the file not used: not a rate of samples"
        table = replace(table, rate_hz=None, notes=(*table.notes, note))
    at, notes = _time_column(table)
    if at is None and rate_hz is None and rpm is not None:
        angle = _angle_column(table, reading.angle_column)
        if angle is not None:
            table, at = _timed_by_angle(table, angle, rpm), len(table.names)
    if at is None:
        t_s, rate, rows, more = _counted(path, table, rate_hz)
    else:
        t_s, rate, rows, more = _from_column(path, table, at, rate_hz)
    channels = [_channel(table, i, rows) for i in range(len(table.names)) if i != at]
    log = RawLog(
        source=path,
        format=table.format,
        t_s=vector(t_s, "t_s"),
        rate_hz=rate,
        columns={c.name: c for c in channels},
        notes=(*table.notes, *notes, *more),
        not_read=table.not_read,
    )
    return replace(log, notes=(*log.notes, *_gap_notes(log)))


def _channel(table: Table, index: int, rows: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> Channel:
    base, unit = split_unit(table.names[index])
    values = table.values[rows, index].copy()
    values.flags.writeable = False
    return Channel(name=table.names[index], base=base, unit=unit or table.units[index], values=values)


def _time_column(table: Table) -> tuple[int | None, list[str]]:
    """Index of the time column, and what was guessed."""
    marked = [i for i, name in enumerate(table.names) if _is_time(table, i)]
    if marked:
        return marked[0], []
    if table.clock is not None:
        return table.clock, []
    if len(table.names) < 2 or table.rate_hz is not None:
        return None, []
    first = table.values[:, 0]
    steps = np.diff(first[np.isfinite(first)])
    even = len(steps) > 2 and steps.min() > 0.0 and np.ptp(steps) < 0.01 * steps.mean() and steps.mean() < 0.5
    if even and (not table.named or not table.names[0]):
        return 0, ["first column taken as time in s: it grows evenly and nothing names it"]
    return None, []


def _is_time(table: Table, index: int) -> bool:
    base, unit = split_unit(table.names[index])
    known = find_unit(unit or table.units[index])
    if known is not None:
        return known[0] == "time" and (TIME_NAME.match(base) is not None or index == 0)
    return not unit and TIME_NAME.match(base) is not None


def _angle_column(table: Table, given: str | None = None) -> int | None:
    """Index of the column of an angle: the one given, or the only one by unit or name."""
    if given is not None:
        name = aliases(table.names).get(given)
        return None if name is None else table.names.index(name)
    found = []
    for index, name in enumerate(table.names):
        base, unit = split_unit(name)
        known = find_unit(unit or table.units[index])
        if (known is not None and known[0] == "angle") or (known is None and ANGLE_NAME.search(base)):
            found.append(index)
    return found[0] if len(found) == 1 else None


def _timed_by_angle(table: Table, index: int, rpm: float) -> Table:
    """The table with a column of time after the others, counted by a spindle angle."""
    name = table.names[index]
    known = find_unit(split_unit(name)[1] or table.units[index])
    values = table.values[:, index]
    size = known[1] if known is not None else 1.0 if np.nanmax(np.abs(values)) < 7.0 else np.pi / 180.0
    good = np.isfinite(values)
    turned = np.full(len(values), np.nan)
    turned[good] = np.unwrap(values[good] * size)
    t_s = (turned - turned[good][0]) / (2.0 * np.pi * rpm / 60.0)
    return replace(
        table,
        names=(*table.names, "time by angle"),
        units=(*table.units, "s"),
        values=np.column_stack([table.values, t_s]),
        notes=(*table.notes, f"time from the angle in column {name!r} at {rpm:g} rpm"),
    )


def _counted(
    path: Path, table: Table, rate_hz: float | None
) -> tuple[FloatArray, float, np.ndarray[tuple[int], np.dtype[np.bool_]], list[str]]:
    """Times counted by the rate."""
    rate = rate_hz or table.rate_hz
    if rate is None and (angle := _angle_column(table)) is not None:
        raise MeasuredError(
            f"{path}: no column of time, but one of an angle, {table.names[angle]!r}; give the spindle speed by --rpm "
            "to make time of it, or the sampling rate by --rate HZ"
        )
    if rate is None:
        raise MeasuredError(
            f"{path}: no column of time among {listed(table.names, table.not_read)}; give the sampling rate by "
            f"--rate HZ, or names for the columns by --columns, e.g. {_example(table)}"
        )
    origin = "as given" if rate_hz else "as in the file"
    if rate_hz and table.rate_hz and abs(rate_hz / table.rate_hz - 1.0) > _SAME_RATE:
        origin = f"as given; the file has {table.rate_hz:g} Hz"
    n = len(table.values)
    return table.start_s + np.arange(n) / rate, rate, np.ones(n, bool), [f"sampling rate {rate:g} Hz, {origin}"]


def _example(table: Table) -> str:
    names = ["t_s", "Fx_N", "Fy_N", "Fz_N"][: len(table.names)]
    rest = table.names[len(names) :]
    return ",".join([*names, *(rest if len(rest) < _MOST_IN_EXAMPLE else ("...",))])


def _from_column(
    path: Path, table: Table, at: int, rate_hz: float | None
) -> tuple[FloatArray, float, np.ndarray[tuple[int], np.dtype[np.bool_]], list[str]]:
    """Times from a column, in s."""
    base, unit = split_unit(table.names[at])
    unit = "s" if at == table.clock else unit or table.units[at]
    known = find_unit(unit) if unit else ("time", 1.0)
    if known is None or known[0] != "time":
        raise MeasuredError(f"{path}: time column {table.names[at]!r} is in {unit!r}, expected s, ms, us, ns, min or h")
    t_s = table.values[:, at] * known[1]
    rows = np.abs(t_s) < LARGEST
    notes = [] if rows.all() else [f"{int((~rows).sum())} rows without a time passed over"]
    t_s = t_s[rows]
    if len(t_s) < 2:
        raise MeasuredError(f"{path}: {len(t_s)} samples, expected at least 2")
    if not unit:
        t_s, more = _guessed_unit(t_s, table.names[at])
        notes += more
    if t_s[0] > 1e8:
        notes.append(f"time counted from the first sample, which is at {t_s[0]:.3f} s")
        t_s = t_s - t_s[0]
    t_s, rate, more = _steady(path, table, t_s, table.rows[rows], rate_hz)
    notes += more
    if not unit and not _PLAUSIBLE_HZ[0] <= rate <= _PLAUSIBLE_HZ[1]:
        notes.append(f"time column {base!r} has no unit: taken as s, which makes {rate:g} Hz; is it ms?")
    return t_s, rate, rows, notes


def _guessed_unit(t_s: FloatArray, name: str) -> tuple[FloatArray, list[str]]:
    """Times in s where the numbers are moments since 1970 in a smaller unit, or days of a calendar."""
    for size, unit in ((1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")):
        if _EPOCH_S[0] < t_s[0] * size < _EPOCH_S[1]:
            return (t_s - t_s[0]) * size, [f"column {name!r} taken as {unit} since 1970, counted from the first one"]
    span = float(t_s[-1] - t_s[0])
    day = any(low < t_s[0] < high for low, high in _DAY_NUMBERS)
    if day and span > 0.0 and (len(t_s) - 1) / span > _PLAUSIBLE_HZ[1]:
        return (t_s - t_s[0]) * _DAY_S, [f"column {name!r} taken as days of a calendar, counted from the first one"]
    return t_s, []


def _steady(
    path: Path, table: Table, t_s: FloatArray, rows: np.ndarray[tuple[int], np.dtype[np.int64]], rate_hz: float | None
) -> tuple[FloatArray, float, list[str]]:
    """Strictly increasing times and their rate."""
    t_s, notes = _over_midnight(t_s, table, rows)
    t_s, rate, more = _increasing(path, table, t_s, rows, rate_hz)
    return t_s, rate, [*notes, *more]


def _over_midnight(
    t_s: FloatArray, table: Table, rows: np.ndarray[tuple[int], np.dtype[np.int64]]
) -> tuple[FloatArray, list[str]]:
    """Seconds of the day counted on where they begin again at the end of a day."""
    steps = np.diff(t_s)
    over = np.flatnonzero(steps < 0.0)
    usual = float(np.median(steps)) if len(steps) else 0.0
    near = max(_DAY_JUMP * usual, _DAY_JUMP_S)
    if not len(over) or not usual > 0.0 or not np.all(np.abs(steps[over] + _DAY_S - usual) < near):
        return t_s, []
    t_s = t_s.copy()
    t_s[1:] += _DAY_S * np.cumsum(steps < 0.0)
    return t_s, [f"time passes midnight at {table.row_word} {rows[over[0] + 1]}: counted on"]


def _increasing(
    path: Path, table: Table, t_s: FloatArray, rows: np.ndarray[tuple[int], np.dtype[np.int64]], rate_hz: float | None
) -> tuple[FloatArray, float, list[str]]:
    """`_steady` for times that do not begin again."""
    steps = np.diff(t_s)
    back = np.flatnonzero(steps < 0.0)
    if len(back):
        i = int(back[0])
        raise MeasuredError(
            f"{path}:{rows[i + 1]}: time goes back, from {t_s[i]:.9g} s to {t_s[i + 1]:.9g} s "
            f"({table.row_word} {rows[i + 1]}); expected increasing time: split the file there"
        )
    if rate_hz is not None:
        return _at_rate(t_s, steps, rate_hz)
    if t_s[-1] <= t_s[0]:
        raise MeasuredError(f"{path}: the time does not increase at {t_s[0]:g} s, expected increasing time")
    if (steps == 0.0).any():
        if np.count_nonzero(steps) < _LEAST_STEPS and not table.rate_hz:
            raise MeasuredError(
                f"{path}: the time column is too coarse: {len(t_s)} samples at {np.count_nonzero(steps) + 1} times; "
                "give the sampling rate by --rate HZ"
            )
        rate = _rate_of_coarse(t_s, steps)
        if table.rate_hz and abs(rate / table.rate_hz - 1.0) < _SAME_RATE:
            rate = table.rate_hz
        note = f"time column too coarse, {int((steps == 0.0).sum())} times occur twice: time counted at {rate:g} Hz"
        return t_s[0] + np.arange(len(t_s)) / rate, float(rate), [note]
    rate = _rate_of(steps)
    notes = [f"sampling rate {rate:.6g} Hz, from the time column"]
    if table.rate_hz and abs(rate / table.rate_hz - 1.0) > _SAME_RATE:
        notes.append(f"the file's header has {table.rate_hz:g} Hz")
    jitter = float(np.median(np.abs(steps - np.median(steps)))) * rate
    if jitter > 0.05:
        notes.append(f"uneven sampling: half of the intervals are off by more than {100.0 * jitter:.0f} %")
    return t_s, rate, notes


def _rate_of_coarse(t_s: FloatArray, steps: FloatArray) -> float:
    """Samples a second where times repeat: between the beginnings of the second and the last run of equal times.

    The first run may begin, and the last one end, anywhere in its step.
    """
    begins = np.flatnonzero(steps > 0.0) + 1
    if len(begins) < 2:
        return (len(t_s) - 1) / float(t_s[-1] - t_s[0])
    return float(begins[-1] - begins[0]) / float(t_s[begins[-1]] - t_s[begins[0]])


def _rate_of(steps: FloatArray) -> float:
    """Samples a second, gaps left out; a rate within rounding of few digits is given with these."""
    middle = float(np.median(steps))
    uneven = float(np.median(np.abs(steps / middle - 1.0))) > UNEVEN
    near = steps[steps < (UNEVEN_GAP * float(np.percentile(steps, 95.0)) if uneven else GAP_INTERVALS * middle)]
    rate = 1.0 / float(near.mean())
    rounded = float(f"{rate:.6g}")
    return rounded if abs(rate / rounded - 1.0) < 1e-6 else rate


def _at_rate(t_s: FloatArray, steps: FloatArray, rate_hz: float) -> tuple[FloatArray, float, list[str]]:
    """Times counted by the rate that the user gives."""
    span = float(t_s[-1] - t_s[0])
    found = (len(t_s) - 1) / span if span > 0.0 else float("nan")
    notes = [f"sampling rate {rate_hz:g} Hz, as given"]
    if not abs(found / rate_hz - 1.0) <= _SAME_RATE:
        notes[0] += f"; the time column makes {found:.6g} Hz and is not used"
    return t_s[0] + np.arange(len(steps) + 1) / rate_hz, rate_hz, notes


def _gap_notes(log: RawLog) -> list[str]:
    gaps = gaps_of(log.t_s, log.rate_hz)
    if not gaps:
        return []
    listed = ", ".join(f"{a:.4f} to {b:.4f} s" for a, b in gaps[:3])
    return [f"{len(gaps)} gap{'s' if len(gaps) > 1 else ''} in the time: {listed}{', ...' if len(gaps) > 3 else ''}"]
