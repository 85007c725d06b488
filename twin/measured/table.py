"""Result of every reader of a format: columns of numbers, their names and units."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray
from twin.errors import MeasuredError

#: Most names that a message lists.
_MOST_NAMED = 100
#: In a name: text after them would pass for a line of its own.
_LINE_ENDS = re.compile(r"\s*[\r\n\t\v\f]\s*")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Table:
    """Columns of one file, before time and units are understood.

    Attributes:
        names: of the columns, as in the file.
        units: of the columns where the file states them apart from the names, else ``""``.
        values: shape (n, k); NaN where there is no number.
        rows: shape (n,), line or row number in the file of each row, counted from 1.
        row_word: what ``rows`` counts: ``line``, ``row``, ``sample``.
        rate_hz: sampling rate that the file states, or None.
        start_s: time of the first sample where there is no column of time.
        clock: the column that was made of dates and times of day, s from the first one; None without.
        not_read: columns that are in the file and not here, each with the reason.
        named: whether the names are the file's or the user's own, not numbers given here.
    """

    format: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    values: FloatArray
    rows: np.ndarray[tuple[int], np.dtype[np.int64]]
    row_word: str = "row"
    rate_hz: float | None = None
    start_s: float = 0.0
    clock: int | None = None
    named: bool = True
    notes: tuple[str, ...] = field(default=())
    not_read: tuple[str, ...] = field(default=())


def few(names: Sequence[str], mark: str = ", ") -> str:
    """Names for a message: all, or the first of very many and the number of the others."""
    more = f" and {len(names) - _MOST_NAMED} more" if len(names) > _MOST_NAMED else ""
    return mark.join(names[:_MOST_NAMED]) + more


def distinct(names: Sequence[str]) -> tuple[str, ...]:
    """Names on one line that differ: a second ``Fx`` becomes ``Fx (2)``, an empty one ``column3``."""
    made: list[str] = []
    counts: Counter[str] = Counter()
    for index, name in enumerate(names):
        base = _LINE_ENDS.sub(" ", name) or f"column{index + 1}"
        count = counts[base]
        made.append(base if not count else f"{base} ({count + 1})")
        counts.update([made[-1], *(made[-1][: m.start()] for m in re.finditer(r" \(", made[-1]))])
    return tuple(made)


def table(
    path: Path,
    format_name: str,
    columns: Sequence[tuple[str, str, FloatArray]],
    *,
    rate_hz: float | None = None,
    start_s: float = 0.0,
    row_word: str = "sample",
    notes: Sequence[str] = (),
    not_read: Sequence[str] = (),
) -> Table:
    """A table from columns of equal length.

    Args:
        columns: name, unit, values.

    Raises:
        MeasuredError: no columns, or columns of different length.
    """
    if not columns:
        raise MeasuredError(f"{path}: no column of numbers found, expected a time and forces ({format_name})")
    lengths = {name: len(values) for name, _, values in columns}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{name} {n}" for name, n in lengths.items())
        raise MeasuredError(f"{path}: columns of different length: {listed}; choose columns of one length by --columns")
    values = np.column_stack([values.astype(np.float64) for _, _, values in columns])
    return Table(
        format=format_name,
        names=distinct([name for name, _, _ in columns]),
        units=tuple(unit for _, unit, _ in columns),
        values=values,
        rows=np.arange(1, len(values) + 1),
        row_word=row_word,
        rate_hz=rate_hz,
        start_s=start_s,
        notes=tuple(notes),
        not_read=tuple(not_read),
    )
