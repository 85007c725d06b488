"""Layout of a text file: delimiter, decimal mark, first line of numbers. Found by trials, never by suffix."""

from __future__ import annotations

import csv
import math
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

#: Delimiters that are tried, None for any white space; commas followed by a blank may occur with decimal commas.
_DELIMITERS = ("\t", ";", "|", ",", None)
_TRIED_LINES = 400
_MISSING = frozenset(
    (
        "",
        "nan",
        "+nan",
        "-nan",
        "na",
        "n/a",
        "#n/a",
        "#nv",
        "-",
        "--",
        "---",
        "null",
        "none",
        "inf",
        "-inf",
        "+inf",
        "1.#qnan",
        "-1.#ind",
    )
)
_CLOCK = re.compile(
    r"^(?:(\d{4})-(\d{1,2})-(\d{1,2})[T ])?(\d{1,2}):(\d{2}):(\d{2}(?:[.,]\d+)?)(?:Z|[+-]\d{2}:?\d{2})?$"
)


@dataclass(frozen=True, slots=True)
class Layout:
    """Separation of fields.

    Attributes:
        delimiter: None for white space.
        decimal: ``.`` or ``,``.
        width: number of fields in a row of numbers.
        first: index of the first row of numbers.
    """

    delimiter: str | None
    decimal: str
    width: int
    first: int


def fields_of(line: str, delimiter: str | None) -> list[str]:
    """A line's fields without blanks and quotes; empty fields after the last one are dropped."""
    if delimiter is None:
        return line.split()
    if '"' in line:
        parts = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
    else:
        parts = line.split(delimiter)
    parts = [p.strip() for p in parts]
    while parts and not parts[-1]:
        parts.pop()
    return parts


def number(text: str, decimal: str) -> float | None:
    """A field as a number: NaN for what stands for a missing one, None for text; times of day become seconds."""
    if decimal == ",":
        if "." in text and "," not in text and not _CLOCK.match(text):
            return None
        text = text.replace(".", "").replace(",", ".") if "," in text else text
    try:
        value = float(text)
    except ValueError:
        if text.lower() in _MISSING:
            return math.nan
        return _clock_s(text)
    return value if math.isfinite(value) and "_" not in text else math.nan if "_" not in text else None


def _clock_s(text: str) -> float | None:
    """Seconds of ``12:30:01.25`` or ``2024-05-01T12:30:01.25``, days counted from 1970."""
    found = _CLOCK.match(text)
    if found is None:
        return None
    year, month, day, hour, minute, second = found.groups()
    seconds = 3600.0 * int(hour) + 60.0 * int(minute) + float(second.replace(",", "."))
    if year is None:
        return seconds
    from datetime import date

    try:
        return seconds + 86400.0 * (date(int(year), int(month), int(day)) - date(1970, 1, 1)).days
    except ValueError:
        return None


def find_layout(lines: Sequence[str], delimiter: str | None = None, decimal: str | None = None) -> Layout | None:
    """The layout under which most lines are rows of numbers of one width; None where there are none.

    Args:
        lines: the file's lines.
        delimiter: ``""`` for white space, None to find it.
        decimal: ``.`` or ``,``, None to find it.
    """
    delimiters = _DELIMITERS if delimiter is None else (delimiter or None,)
    decimals = (".", ",") if decimal is None else (decimal,)
    sample = _sample(lines)
    tries = [_try(sample, d, mark) for mark in decimals for d in delimiters if mark != d]
    found = [each for each in tries if each is not None]
    if not found:
        return None
    _, width, used, mark = max(found, key=lambda each: each[:2])
    return Layout(used, mark, width, _first_row(lines, used, mark, width))


def _try(lines: Sequence[str], delimiter: str | None, decimal: str) -> tuple[int, int, str | None, str] | None:
    """How many lines are rows of numbers under a layout, and how many fields they have."""
    widths: Counter[int] = Counter()
    for line in lines:
        fields = fields_of(line, delimiter)
        if fields and is_row(fields, decimal):
            widths[len(fields)] += 1
    if not widths:
        return None
    width, count = max(widths.items(), key=lambda item: (item[1], item[0]))
    return count, width, delimiter, decimal


def _first_row(lines: Sequence[str], delimiter: str | None, decimal: str, width: int) -> int:
    """The first row of numbers that is followed by another one: a row of settings may be above the names."""
    first, latest, before = -1, -1, False
    for index, line in enumerate(lines):
        fields = fields_of(line, delimiter)
        if not fields:
            continue
        row = len(fields) == width and is_row(fields, decimal)
        if row and before:
            return latest
        if row:
            latest = index
            first = index if first < 0 else first
        before = row
    return first


def _sample(lines: Sequence[str]) -> list[str]:
    """The first lines, where the header is, and some from the middle."""
    half = _TRIED_LINES // 2
    middle = max(half, len(lines) // 2)
    return [*lines[:half], *lines[middle : middle + half]]


def is_row(fields: Sequence[str], decimal: str) -> bool:
    """Whether all fields are numbers or stand for missing ones, and one is a number."""
    values = [number(f, decimal) for f in fields]
    return None not in values and any(v is not None and not math.isnan(v) for v in values)
