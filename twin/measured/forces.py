"""From a raw log to forces on the tool: axis map, units, signs; spindle angle and trigger where they are recorded."""

from __future__ import annotations

import re
from collections.abc import Iterable
from os import PathLike

import numpy as np

from twin.arrays import FloatArray, frozen
from twin.errors import MeasuredError
from twin.measured.axes import AxisMap, Term, aliases, guess_map
from twin.measured.log import AXES, LARGEST, Channel, ForceLog, RawLog, gaps_of, vector
from twin.measured.read import read_log
from twin.measured.settings import AS_IN_FILE, LogReading
from twin.measured.units import ANGLE_NAME, LOGICAL, find_unit

_TRIGGER = re.compile(r"trig|tacho|pulse|once|key[\s_]*phas|\bindex\b|z[\s_]*phase|marker", re.IGNORECASE)


def read_forces(path: str | PathLike[str], reading: LogReading = AS_IN_FILE) -> ForceLog:
    """Forces on the tool from a log of any known format.

    Raises:
        MeasuredError: see `twin.measured.read.read_log` and `force_log`.
    """
    return force_log(read_log(path, reading), reading)


def force_log(raw: RawLog, reading: LogReading = AS_IN_FILE) -> ForceLog:
    """Forces on the tool in machine axes.

    The map is applied first: it gives the force on the body ``force_on`` in machine axes. Where that is the workpiece,
    all three signs are then reversed. A map that already reverses them goes with ``force_on="tool"``.

    Args:
        reading: axis map (without one the columns that are named after the axes), body that the mapped force acts on,
            unit of the force columns, columns of the spindle angle and of a once-per-revolution pulse.

    Raises:
        MeasuredError: columns that cannot be decided, are unknown, or are in no unit of force.
    """
    unit, force_on = reading.unit, reading.force_on
    axis_map, notes = _map_for(raw, reading.axis_map)
    names = aliases(raw.columns)
    terms = axis_map.terms(names)
    used = dict.fromkeys(column for parts in terms.values() for _, column in parts)
    factors = {}
    for column in used:
        scaled = any(abs(factor) != 1.0 for parts in terms.values() for factor, name in parts if name == column)
        factors[column], more = _newtons(raw, raw.columns[column], unit, scaled=scaled)
        notes += more
    rows = np.all([np.abs(raw.columns[c].values) < LARGEST for c in used], axis=0)
    if rows.sum() < 2:
        raise MeasuredError(
            f"{raw.source}: {int(rows.sum())} rows with numbers in {', '.join(used)}, expected at least 2"
        )
    if not rows.all():
        first = float(raw.t_s[np.argmin(rows)])
        notes.append(f"{int((~rows).sum())} rows without a number omitted, the first at {first:.4f} s")
    sign = -1.0 if force_on == "workpiece" else 1.0
    if force_on == "workpiece":
        notes.append("signs reversed: the log is the force on the workpiece, here it is the force on the tool")
    force = np.zeros((int(rows.sum()), 3))
    for axis, parts in terms.items():
        for factor, column in parts:
            force[:, AXES.index(axis)] += sign * factor * factors[column] * raw.columns[column].values[rows]
    if missing := [a for a in AXES if a not in terms]:
        notes.append(f"not measured: {', '.join(missing)}")
    t_s = raw.t_s[rows]
    angle, more = _angle(raw, names, rows, reading.angle_column, used)
    notes += more
    pulses, more = _trigger(raw, names, reading.trigger_column, used)
    return ForceLog(
        t_s=vector(t_s, "t_s"),
        force_n=frozen(force, "force_n", (None, 3)),
        rate_hz=raw.rate_hz,
        channels=_channel_texts(raw, terms),
        source=raw.source,
        axes=tuple(a for a in AXES if a in terms),
        force_on=force_on,
        unit=unit or raw.columns[next(iter(used))].unit,
        spindle_angle_rad=angle,
        trigger_s=pulses,
        gaps=gaps_of(t_s, raw.rate_hz),
        notes=(*raw.notes, *notes, *more),
    )


def _map_for(raw: RawLog, axis_map: AxisMap | None) -> tuple[AxisMap, list[str]]:
    if axis_map is not None:
        return axis_map, [f"axes {axis_map}"]
    candidates = [c.name for c in raw.columns.values() if _may_be_force(c)]
    guessed = guess_map(candidates)
    if guessed is not None:
        return guessed, [f"axes {guessed}, by the columns' names"]
    by_name = guess_map(raw.columns)
    if by_name is not None:
        return by_name, []
    offer = _offer(candidates or list(raw.columns))
    if not offer:
        raise MeasuredError(f"{raw.source}: no columns of numbers besides the time; columns are {raw.listing()}")
    example = ",".join(f"{axis}={name}" for axis, name in zip(AXES, offer, strict=False))
    raise MeasuredError(
        f"{raw.source}: the names do not show which columns are Fx, Fy and Fz; columns are {raw.listing()}; "
        f'give them with their signs, e.g. --map "{example}"'
    )


def _offer(names: list[str]) -> list[str]:
    """A column for each axis in an example: named after it where there is one."""
    alike = [next((n for n in names if re.search(rf"f[\s_.-]*{axis}", n, re.IGNORECASE)), "") for axis in AXES]
    return alike if all(alike) else names[:3]


def _may_be_force(channel: Channel) -> bool:
    known = find_unit(channel.unit) if channel.unit else None
    return known is None or known[0] in ("force", "voltage", "charge")


def _newtons(raw: RawLog, channel: Channel, unit: str | None, *, scaled: bool) -> tuple[float, list[str]]:
    """Newtons for one unit of a channel."""
    stated = unit or channel.unit
    if not stated:
        return 1.0, [f"column {channel.name!r} has no unit: taken as N"]
    known = find_unit(stated)
    if known is not None and known[0] == "force":
        return known[1], []
    if known is not None and known[0] in ("voltage", "charge") and scaled:
        return 1.0, [f"column {channel.name!r} in {stated}: the factor of the axis map is taken as N/{stated}"]
    if stated == LOGICAL:
        raise MeasuredError(f"{raw.source}: column {channel.name!r} holds true and false, expected forces")
    hint = "; with a known sensitivity give its factor in the map, e.g. x=2.5*" + channel.base if known else ""
    raise MeasuredError(
        f"{raw.source}: column {channel.name!r} is in {stated!r}, expected a unit of force (N, kN, lbf) or --unit{hint}"
    )


def _channel_texts(raw: RawLog, terms: dict[str, tuple[Term, ...]]) -> tuple[str, str, str]:
    """Source of each axis, human-readable."""
    texts = []
    for axis in AXES:
        text = ""
        for factor, column in terms.get(axis, ()):
            size = "" if abs(factor) == 1.0 else f"{abs(factor):g}*"
            text += f"{'-' if factor < 0.0 else '+' if text else ''}{size}{raw.columns[column].base}"
        texts.append(text)
    return texts[0], texts[1], texts[2]


def _find(
    raw: RawLog, names: dict[str, str], given: str | None, pattern: re.Pattern[str], used: Iterable[str]
) -> Channel | None:
    """A column by the name given, or the only one whose name fits."""
    if given is not None:
        name = names.get(given) or names.get(given.strip().lower())
        if name is None:
            raise MeasuredError(f"{raw.source}: no column {given!r}; columns are {raw.listing()}")
        return raw.columns[name]
    taken = set(used)
    fits = [c for c in raw.columns.values() if pattern.search(c.base) and c.name not in taken]
    return fits[0] if len(fits) == 1 else None


def _angle(
    raw: RawLog,
    names: dict[str, str],
    rows: np.ndarray[tuple[int], np.dtype[np.bool_]],
    given: str | None,
    used: Iterable[str],
) -> tuple[FloatArray | None, list[str]]:
    channel = _find(raw, names, given, ANGLE_NAME, used)
    if channel is None:
        return None, []
    known = find_unit(channel.unit) if channel.unit else None
    values = channel.values[rows]
    if (known is not None and known[0] != "angle") or not np.isfinite(values).all():
        return None, [f"column {channel.name!r} not used as spindle angle: expected numbers in deg or rad"]
    guessed = 1.0 if np.abs(values).max() < 7.0 else np.pi / 180.0
    size = known[1] if known is not None else guessed
    angle = np.unwrap(values * size)
    return vector(angle, "spindle_angle_rad"), [f"spindle angle from column {channel.name!r}"]


def _trigger(
    raw: RawLog, names: dict[str, str], given: str | None, used: Iterable[str]
) -> tuple[FloatArray | None, list[str]]:
    channel = _find(raw, names, given, _TRIGGER, used)
    if channel is None:
        return None, []
    good = np.isfinite(channel.values)
    values, t_s = channel.values[good], raw.t_s[good]
    low, high = (float(v) for v in (values.min(initial=0.0), values.max(initial=0.0)))
    if not high > low:
        return None, [f"column {channel.name!r} has no pulses"]
    over = (values - 0.5 * (low + high)) / (high - low)
    up = np.flatnonzero((over[:-1] < 0.0) & (over[1:] >= 0.0))
    part = -over[up] / (over[up + 1] - over[up])
    pulses = t_s[up] + part * (t_s[up + 1] - t_s[up])
    return vector(pulses, "trigger_s"), [f"{len(pulses)} pulses of the spindle in column {channel.name!r}"]
