"""The rows below the header of a text file: all at once where they are plain, else one by one."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray
from twin.errors import MeasuredError
from twin.measured.table import few
from twin.measured.text.clocks import ClockKind, Moment, moment, seconds_of
from twin.measured.text.header import Header
from twin.measured.text.layout import Layout, fields_of

_LONGEST = 60
#: Most line numbers that a note lists.
_MOST_LISTED = 5


def _two_numbers(name: str) -> tuple[ClockKind, float | None]:
    """Kind and size in s of times such as 10:30, by the column's name; None where it does not show."""
    if re.search(r"m+:s+", name, re.IGNORECASE):
        return "minutes", 1.0
    return "time", 60.0 if re.search(r"h+:m+", name, re.IGNORECASE) else None


def cut(line: str) -> str:
    """The beginning of a line for a message."""
    text = re.sub(r"\s+", " ", line.strip())
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


@dataclass(frozen=True, slots=True, eq=False)
class ClockColumn:
    """Times from columns of dates and times of day: shape (n,), s from the first one."""

    name: str
    t_s: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class ReadRows:
    """The rows: values of shape (n, k) of the columns of numbers, the line of each, times, and notes."""

    values: FloatArray
    rows: np.ndarray[tuple[int], np.dtype[np.int64]]
    clock: ClockColumn | None
    notes: list[str]


@dataclass(slots=True)
class Body:
    """The rows below the header."""

    path: Path
    layout: Layout
    header: Header
    first_line: int
    _repeated: list[int] = field(default_factory=list)
    _remarks: list[int] = field(default_factory=list)
    _cut_row: int | None = None

    def read(self, lines: Sequence[str]) -> ReadRows:
        """All rows.

        Raises:
            MeasuredError: a line that is not a row; the message names line and field.
        """
        first = self.layout.first
        fast = self._fast(lines[first:])
        if fast is not None:
            return ReadRows(fast, np.arange(first, first + len(fast)) + self.first_line, None, self._notes())
        values, rows, moments = [], [], []
        last = max((i for i, line in enumerate(lines) if line.strip()), default=first)
        for index in range(first, last + 1):
            row = self._row(lines[index], index, last=index == last)
            if row is not None:
                values.append(row[0])
                moments.append(row[1])
                rows.append(index + self.first_line)
        clock, notes = self._clock(moments)
        return ReadRows(np.array(values, np.float64), np.array(rows, np.int64), clock, [*self._notes(), *notes])

    def _notes(self) -> list[str]:
        notes = []
        names = [n for n, kind in zip(self.header.names, self.layout.kinds, strict=True) if kind == "text"]
        if names:
            notes.append(f"columns of text not read: {few(names)}")
        for lines, what in ((self._repeated, "repeated header"), (self._remarks, "text after the last column")):
            if lines:
                more = ", ..." if lines[_MOST_LISTED:] else ""
                notes.append(f"{what} at line {', '.join(map(str, lines[:_MOST_LISTED]))}{more} skipped")
        if self._cut_row is not None:
            notes.append(f"line {self._cut_row}, the last one, is cut short and skipped")
        return notes

    def _fast(self, lines: Sequence[str]) -> FloatArray | None:
        """All rows at once where every one is plain; None where they must be looked at one by one."""
        if set(self.layout.kinds) - {"number", "text"} or self.layout.delimiter == self.layout.marks.decimal:
            return None
        data = lines
        if self.layout.marks.decimal == ",":
            if any("." in line for line in lines):
                return None
            data = [line.replace(",", ".") for line in lines]
        end = len(data)
        while end and not data[end - 1].strip():
            end -= 1
        numbers = [i for i, kind in enumerate(self.layout.kinds) if kind == "number"]
        some = numbers if len(numbers) < self.layout.width else None
        try:
            values = np.loadtxt(data[:end], delimiter=self.layout.delimiter, ndmin=2, comments=None, usecols=some)
        except ValueError:
            return None
        plain = values.shape == (end, len(numbers)) and bool(np.isfinite(values).all())
        return values if plain else None

    def _row(self, line: str, index: int, *, last: bool) -> tuple[list[float], list[Moment | None]] | None:
        """Numbers, and moments, of one line; None for a line that is skipped."""
        fields = fields_of(line, self.layout.delimiter)
        if not fields:
            return None
        if self.header.repeats(fields):
            self._repeated.append(index + self.first_line)
            return None
        width = self.layout.width
        if len(fields) > width:
            if any(self.layout.marks.number(f) is not None for f in fields[width:]):
                raise self._wrong(line, index, fields, None)
            self._remarks.append(index + self.first_line)
        if len(fields) < width and last:
            self._cut_row = index + self.first_line
            return None
        return self._numbers(line, index, fields)

    def _numbers(self, line: str, index: int, fields: Sequence[str]) -> tuple[list[float], list[Moment | None]]:
        """The fields by the kinds of their columns; those missing at the end are NaN and None."""
        values: list[float] = []
        moments: list[Moment | None] = []
        for at, kind in enumerate(self.layout.kinds):
            text = fields[at] if at < len(fields) else ""
            if kind == "text":
                continue
            value = self.layout.marks.number(text)
            if kind == "number":
                if value is None:
                    raise self._wrong(line, index, fields, at)
                values.append(value)
                continue
            found = moment(text)
            if (found is None or found.kind != kind) and not (value is not None and math.isnan(value)):
                raise self._wrong(line, index, fields, at)
            moments.append(found)
        return values, moments

    def _clock(self, rows: Sequence[Sequence[Moment | None]]) -> tuple[ClockColumn | None, list[str]]:
        """Times of the first column with times of day, with the dates of the first column of dates."""
        kinds: list[ClockKind] = [k for k in self.layout.kinds if k != "number" and k != "text"]
        names = [n for n, k in zip(self.header.names, self.layout.kinds, strict=True) if k not in ("number", "text")]
        timed = [i for i, kind in enumerate(kinds) if kind != "date"]
        if not timed or not rows:
            return None, []
        at, kind = timed[0], kinds[timed[0]]
        if kind == "minutes" and not any(m.clear for row in rows if (m := row[at]) is not None):
            kind, size = _two_numbers(names[at])
            if size is None:
                return None, []
            rows = [[None if m is None else replace(m, seconds=size * m.seconds) for m in row] for row in rows]
        dated = kinds.index("date") if "date" in kinds and kind == "time" else at
        dates = [m.date if (m := row[dated]) is not None else "" for row in rows]
        seconds = np.array([m.seconds if (m := row[at]) is not None else math.nan for row in rows])
        try:
            t_s, notes = seconds_of(dates, seconds, kind)
        except ValueError as error:
            raise MeasuredError(f"{self.path}: column {names[dated]!r}: {error}") from None
        used = names[at] if dated == at else f"{names[dated]} and {names[at]}"
        return ClockColumn(names[at], t_s), [f"time from {used}, counted from the first one", *notes]

    def _wrong(self, line: str, index: int, fields: Sequence[str], at: int | None) -> MeasuredError:
        width = self.layout.width
        what, where = f"{len(fields)} fields", ""
        if at is not None:
            kind = self.layout.kinds[at]
            wanted = "number" if kind == "number" else "date" if kind == "date" else "time"
            what = f"{fields[at]!r} is not a {wanted}"
            where = f" (field {at + 1} of {width}, {self.header.names[at]})"
        elif self.layout.delimiter == "," and '"' not in line:
            where = "; numbers with commas as group marks need quotes"
        return MeasuredError(
            f"{self.path}:{index + self.first_line}: {what}, expected {width} numbers{where}: {cut(line)!r}"
        )
