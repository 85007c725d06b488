"""Named arrays of a container (MATLAB, HDF5) as columns of one length."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from twin.arrays import FloatArray
from twin.errors import MeasuredError
from twin.measured.axes import guess_map
from twin.measured.table import Table, table
from twin.measured.units import find_unit, split_unit

#: A matrix with more columns than this is not a log.
_MOST_COLUMNS = 64
_RATE = re.compile(
    r"^(?:fs|f_s|sampl\w*[\s_]*(?:rate|freq\w*)|samplerate|rate|frequency|abtastrate|srate|sr)$", re.IGNORECASE
)
_INTERVAL = re.compile(
    r"^(?:dt|ts|delta_?t|increment|wf_increment|sampl\w*[\s_]*(?:interval|period|time))$", re.IGNORECASE
)
_START = re.compile(r"^(?:t0|t_0|start|wf_start_offset|start_?time)$", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Named:
    """An array with its path in the container, ``group/name``, and its unit, ``""`` if not stated."""

    name: str
    unit: str
    values: FloatArray


def columns_table(
    path: Path, format_name: str, arrays: Sequence[Named], scalars: Mapping[str, float], group: str | None = None
) -> Table:
    """Choose the arrays that are columns of one recording.

    Args:
        scalars: single numbers next to them, by path; a sampling rate or interval is searched among them.
        group: part of the container to read; None for all of it.

    Raises:
        MeasuredError: no columns; the same force several times; an unknown group.
    """
    arrays = _in_group(path, arrays, group)
    columns = [column for a in arrays for column in _columns(a)]
    lengths = Counter(len(c.values) for c in columns)
    if not lengths:
        raise MeasuredError(f"{path}: no arrays of numbers found, expected a time and forces ({format_name})")
    length = max(lengths, key=lambda n: (lengths[n], n))
    chosen = [c for c in columns if len(c.values) == length]
    notes = []
    if left := [c.name for c in columns if len(c.values) != length]:
        notes.append(f"of another length than {length}, not read: {', '.join(left[:6])}{', ...' if left[6:] else ''}")
    chosen = _short_names(chosen)
    _refuse_several(path, chosen)
    rate_hz, start_s = _clock(scalars)
    rows = [(c.name, c.unit, c.values) for c in chosen]
    return table(path, format_name, rows, rate_hz=rate_hz, start_s=start_s, notes=notes)


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
        return [Named(array.name, array.unit, values)]
    if values.ndim == 2 and min(values.shape) <= _MOST_COLUMNS:
        values = values if values.shape[0] >= values.shape[1] else values.T
        return [Named(f"{array.name}[{i + 1}]", array.unit, values[:, i]) for i in range(values.shape[1])]
    return []


def _short_names(columns: list[Named]) -> list[Named]:
    """Names without the groups, as long as they differ."""
    short = [c.name.rpartition("/")[2] for c in columns]
    if len(set(short)) < len(short):
        return columns
    return [Named(name, c.unit, c.values) for name, c in zip(short, columns, strict=True)]


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


def _clock(scalars: Mapping[str, float]) -> tuple[float | None, float]:
    """Sampling rate, Hz, and first time, s, from single numbers."""
    rate, start = None, 0.0
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


def flatten(data: Any, prefix: str, arrays: list[Named], scalars: dict[str, float]) -> None:
    """Nested mappings as arrays and single numbers by path; other values are skipped."""
    if isinstance(data, Mapping):
        for key, value in data.items():
            flatten(value, f"{prefix}/{key}" if prefix else str(key), arrays, scalars)
        return
    try:
        values = np.asarray(data)
        numeric = values.dtype.kind in "fiub"
    except ValueError:
        return
    if not numeric:
        return
    if values.size == 1:
        scalars[prefix] = float(values.reshape(()))
    else:
        arrays.append(Named(prefix, "", values.astype(np.float64)))
