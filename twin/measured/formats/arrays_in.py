"""Named arrays of a container (MATLAB, HDF5) as columns of one length."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from twin.errors import MeasuredError
from twin.measured.axes import guess_map
from twin.measured.formats.one_clock import Named, on_one_clock
from twin.measured.table import Table, few, table
from twin.measured.units import TIME_NAME, find_unit, split_unit

#: A matrix with more columns than this is not a log.
_MOST_COLUMNS = 64
_RATE = re.compile(
    r"^(?:fs|f_s|sampl\w*[\s_]*(?:rate|freq\w*)|samplerate|rate|frequency|abtastrate|srate|sr)$", re.IGNORECASE
)
_INTERVAL = re.compile(
    r"^(?:dt|ts|delta_?t|increment|wf_increment|sampl\w*[\s_]*(?:interval|period|time))$", re.IGNORECASE
)
_START = re.compile(r"^(?:t0|t_0|start|wf_start_offset|start_?time)$", re.IGNORECASE)


def columns_table(
    path: Path,
    format_name: str,
    arrays: Sequence[Named],
    scalars: Mapping[str, float],
    group: str | None = None,
    refused: Sequence[str] = (),
) -> Table:
    """Choose the arrays that are columns of one recording.

    Args:
        scalars: single numbers next to them, by path; a sampling rate or interval is searched among them.
        group: part of the container to read; None for all of it.
        refused: what else the file holds and cannot be read, each with the reason.

    Raises:
        MeasuredError: no columns; the same force several times; an unknown group.
    """
    arrays = _in_group(path, arrays, group)
    columns = [column for a in arrays for column in _columns(a)]
    if not columns:
        other = f"; not read: {few(refused, '; ')}" if refused else ""
        raise MeasuredError(f"{path}: no arrays of numbers found, expected a time and forces ({format_name}){other}")
    paths = [c.name for c in columns]
    columns = _short_names(columns)
    origin = dict(zip((c.name for c in columns), paths, strict=True))
    needed = _needed(columns)
    if not needed:
        columns, left = _of_one_length(columns)
        needed = [c.name for c in columns]
    else:
        left = []
    _refuse_several(path, columns)
    aligned = on_one_clock(path, columns, needed)
    left += aligned.not_read
    notes = [f"of another length, not read: {', '.join(left[:6])}"] if left and not aligned.not_read else []
    if refused:
        notes.append(f"not read: {few(refused, '; ')}")
    rate_hz, start_s = clock_of(_near(scalars, origin[needed[-1]]))
    return table(
        path,
        format_name,
        [(c.name, c.unit, c.values) for c in aligned.columns],
        rate_hz=aligned.rate_hz or rate_hz,
        start_s=next((s for s in (aligned.start_s, start_s) if s is not None), 0.0),
        notes=[*notes, *aligned.notes],
        not_read=[*left, *refused],
    )


def _near(scalars: Mapping[str, float], column: str) -> Mapping[str, float]:
    """The single numbers of the groups that hold a column, if a rate is among them."""
    near = {
        n: v for n, v in scalars.items() if f"/{column}/".startswith(f"/{n.rpartition('/')[0]}/".replace("//", "/"))
    }
    return near if clock_of(near)[0] is not None else scalars


def _needed(columns: Sequence[Named]) -> list[str]:
    """The columns named after the forces, and the time if it is about as long; none where names do not show."""
    forces = guess_map(c.name for c in columns)
    if forces is None:
        return []
    found = [name for _, name in forces.entries]
    longest = max(len(c.values) for c in columns if c.name in found)
    times = [c.name for c in columns if TIME_NAME.match(split_unit(c.name)[0]) and 2 * len(c.values) >= longest]
    return [*times[:1], *found]


def _of_one_length(columns: Sequence[Named]) -> tuple[list[Named], list[str]]:
    """The columns of the commonest length, and the others with theirs."""
    lengths = Counter(len(c.values) for c in columns)
    length = max(lengths, key=lambda n: (lengths[n], n))
    left = [f"{c.name} ({len(c.values)} samples)" for c in columns if len(c.values) != length]
    return [c for c in columns if len(c.values) == length], left


def _in_group(path: Path, arrays: Sequence[Named], group: str | None) -> list[Named]:
    if group is None:
        return list(arrays)
    inside = [a for a in arrays if a.name == group or a.name.startswith(f"{group.strip('/')}/")]
    if not inside:
        known = ", ".join(dict.fromkeys(a.name.rpartition("/")[0] or a.name for a in arrays))
        raise MeasuredError(f"{path}: no group {group!r}; expected one of {known}")
    return inside


def _columns(array: Named) -> list[Named]:
    """The columns that an array holds."""
    values = np.squeeze(array.values)
    if values.ndim == 1 and values.size >= 2:
        return [replace(array, values=values)]
    if values.ndim == 2 and min(values.shape) <= _MOST_COLUMNS:
        values = values if values.shape[0] >= values.shape[1] else values.T
        return [replace(array, name=f"{array.name}[{i + 1}]", values=values[:, i]) for i in range(values.shape[1])]
    return []


def _short_names(columns: list[Named]) -> list[Named]:
    """Names without the groups, as long as they differ."""
    short = [c.name.rpartition("/")[2] for c in columns]
    if len(set(short)) < len(short):
        return columns
    return [replace(c, name=name) for name, c in zip(short, columns, strict=True)]


def _refuse_several(path: Path, columns: list[Named]) -> None:
    """The same forces in several groups: which one is meant?"""
    groups: dict[str, list[str]] = {}
    for column in columns:
        group, _, name = column.name.rpartition("/")
        groups.setdefault(group, []).append(name)
    holding = [g for g, names in groups.items() if g and guess_map(names) is not None]
    if len(holding) > 1:
        raise MeasuredError(
            f"{path}: forces in several groups: {', '.join(holding)}; choose one by --group {holding[0]}"
        )


def clock_of(scalars: Mapping[str, float]) -> tuple[float | None, float | None]:
    """Sampling rate, Hz, and first time, s, from single numbers; None where none states it."""
    rate, start = None, None
    for name, value in scalars.items():
        base, unit = split_unit(name.rpartition("/")[2])
        known = find_unit(unit)
        if _RATE.match(base) and value > 0.0:
            rate = value * (known[1] if known is not None and known[0] == "rate" else 1.0)
        elif _INTERVAL.match(base) and value > 0.0 and rate is None:
            rate = 1.0 / (value * (known[1] if known is not None and known[0] == "time" else 1.0))
        elif _START.match(base):
            start = value
    return rate, start
