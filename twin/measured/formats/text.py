"""Delimited text: CSV and TXT of any delimiter, with decimal commas, rows of units, repeated headers."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray
from twin.errors import MeasuredError
from twin.measured.formats.table import Table
from twin.measured.formats.text_header import Header, find_header, stated_rate_hz
from twin.measured.formats.text_layout import Layout, fields_of, find_layout, number

_LONGEST = 60


def read_text(
    path: Path,
    *,
    columns: Sequence[str] | None = None,
    delimiter: str | None = None,
    decimal: str | None = None,
    format_name: str = "delimited text",
) -> Table:
    """Read a text file of numbers in columns.

    Args:
        columns: names for the columns in place of those in the file; needed where the file has none.
        delimiter: ``""`` for white space, None to find it.
        decimal: ``.`` or ``,``, None to find it.

    Raises:
        MeasuredError: no rows of numbers; a line that is neither a row nor a header; names that do not fit.
    """
    return parse_text(
        path, text_of(path), columns=columns, delimiter=delimiter, decimal=decimal, format_name=format_name
    )


def text_of(path: Path) -> str:
    """The file's text: UTF-8, UTF-16 with its mark, or Windows-1252."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise MeasuredError(f"{path}: cannot be read: {(error.strerror or str(error)).lower()}") from error
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", errors="replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", errors="replace")


def parse_text(
    path: Path,
    text: str,
    *,
    columns: Sequence[str] | None = None,
    delimiter: str | None = None,
    decimal: str | None = None,
    format_name: str = "delimited text",
    first_line: int = 1,
) -> Table:
    """`read_text` for text at hand; ``first_line`` is the number of its first line in the file."""
    lines = text.splitlines()
    layout = find_layout(lines, delimiter, decimal)
    if layout is None:
        begin = next((line.strip() for line in lines if line.strip()), "")
        raise MeasuredError(
            f"{path}: no row of numbers found, expected columns of time and forces; it begins with {_cut(begin)!r}"
        )
    header = find_header(path, lines, layout, columns, first_line)
    body = _Body(path, layout, header, first_line)
    values, rows = body.read(lines)
    return Table(
        format=format_name,
        names=header.names,
        units=header.units,
        values=values,
        rows=rows,
        row_word="line",
        rate_hz=stated_rate_hz(lines[: layout.first]),
        named=header.named,
        notes=(_layout_note(layout), *body.notes()),
    )


def _layout_note(layout: Layout) -> str:
    names = {"\t": "tab", None: "white space"}
    mark = "decimal comma" if layout.decimal == "," else "decimal point"
    return f"columns separated by {names.get(layout.delimiter, repr(layout.delimiter))}, {mark}"


@dataclass(slots=True)
class _Body:
    """The rows below the header."""

    path: Path
    layout: Layout
    header: Header
    first_line: int
    _repeated: list[int] = field(default_factory=list)
    _cut_row: int | None = None

    def read(self, lines: Sequence[str]) -> tuple[FloatArray, np.ndarray[tuple[int], np.dtype[np.int64]]]:
        """Values of shape (n, k) and the line of each row."""
        first = self.layout.first
        fast = self._fast(lines[first:])
        if fast is not None:
            return fast, np.arange(first, first + len(fast)) + self.first_line
        values, rows = [], []
        last = max((i for i, line in enumerate(lines) if line.strip()), default=first)
        for index in range(first, last + 1):
            row = self._row(lines[index], index, last=index == last)
            if row is not None:
                values.append(row)
                rows.append(index + self.first_line)
        return np.array(values, np.float64), np.array(rows, np.int64)

    def notes(self) -> list[str]:
        """Notes on skipped lines."""
        notes = []
        if self._repeated:
            notes.append(f"repeated header at line {', '.join(map(str, self._repeated[:5]))} skipped")
        if self._cut_row is not None:
            notes.append(f"line {self._cut_row}, the last one, is cut short and skipped")
        return notes

    def _fast(self, lines: Sequence[str]) -> FloatArray | None:
        """All rows at once where every one is plain; None where they must be looked at one by one."""
        data = lines
        if self.layout.decimal == ",":
            data = [line.replace(".", "").replace(",", ".") for line in lines]
        end = len(data)
        while end and not data[end - 1].strip():
            end -= 1
        try:
            values = np.loadtxt(data[:end], delimiter=self.layout.delimiter, ndmin=2, comments=None)
        except ValueError:
            return None
        plain = values.shape == (end, self.layout.width) and bool(np.isfinite(values).all())
        return values if plain else None

    def _row(self, line: str, index: int, *, last: bool) -> list[float] | None:
        fields = fields_of(line, self.layout.delimiter)
        if not fields:
            return None
        if self.header.repeats(fields):
            self._repeated.append(index + self.first_line)
            return None
        values = [number(f, self.layout.decimal) for f in fields]
        if None in values or len(values) > self.layout.width:
            raise self._wrong(line, index, fields)
        if len(values) < self.layout.width:
            if last:
                self._cut_row = index + self.first_line
                return None
            values += [math.nan] * (self.layout.width - len(values))
        return [v for v in values if v is not None]

    def _wrong(self, line: str, index: int, fields: Sequence[str]) -> MeasuredError:
        bad = next((f for f in fields if number(f, self.layout.decimal) is None), None)
        what = f"{bad!r} is not a number" if bad is not None else f"{len(fields)} fields"
        return MeasuredError(
            f"{self.path}:{index + self.first_line}: {what}, expected {self.layout.width} numbers: {_cut(line)!r}"
        )


def _cut(line: str) -> str:
    text = re.sub(r"\s+", " ", line.strip())
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."
