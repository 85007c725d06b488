"""Delimited text: CSV and TXT of any delimiter, with decimal commas, group marks, dates, text, repeated headers."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from twin.errors import MeasuredError
from twin.measured.table import Table
from twin.measured.text.body import Body, cut
from twin.measured.text.counts import scaled
from twin.measured.text.header import Header, find_header, stated_rate_hz
from twin.measured.text.layout import ColumnKind, Layout, fields_of, find_layout, is_settled, number_rows
from twin.measured.text.marks import Marks, UnclearMarksError, foreign, settled, weighed

#: Characters of a row, at most; what is beyond them in a line above the rows is not read.
_LONGEST_LINE = 1 << 15
_UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")


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


def opening_of(path: Path) -> str:
    """The first characters of a file, those of other codes than UTF-16 as Windows-1252."""
    with path.open("rb") as file:
        data = file.read(400)
    if data[:2] in _UTF16_MARKS:
        return data.decode("utf-16", errors="replace")
    return data.removeprefix(b"\xef\xbb\xbf").decode("cp1252", errors="replace")


def text_of(path: Path) -> str:
    """The file's text: UTF-8, UTF-16 with its mark, or Windows-1252."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise MeasuredError(f"{path}: cannot be read: {(error.strerror or str(error)).lower()}") from error
    if data[:2] in _UTF16_MARKS:
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
    long = {index: len(line) for index, line in enumerate(lines) if len(line) > _LONGEST_LINE}
    for index in long:
        lines[index] = lines[index][:_LONGEST_LINE]
    layout = find_layout(lines, delimiter, decimal)
    if layout is None:
        raise _no_rows(path, lines)
    for index, length in long.items():
        if index >= layout.first:
            raise MeasuredError(
                f"{path}:{index + first_line}: a line of {length} characters, expected a row of at most {_LONGEST_LINE}"
            )
    if decimal is None and ("." in text or "," in text) and not is_settled(lines, layout):
        layout = replace(layout, marks=_weighed(path, lines, layout, first_line))
    _check_line_above(path, lines, layout, first_line)
    header = find_header(path, lines, layout, columns, first_line)
    layout = replace(layout, kinds=tuple(map(_named_kind, layout.kinds, header.names)))
    body = Body(path, layout, header, first_line)
    read = body.read(lines)
    kept = [i for i, kind in enumerate(layout.kinds) if kind == "number"]
    names, units = [header.names[i] for i in kept], [header.units[i] for i in kept]
    values = read.values
    if read.clock is not None:
        names, units, values = [*names, read.clock.name], [*units, "s"], np.column_stack([values, read.clock.t_s])
    found = Table(
        format=format_name,
        names=tuple(names),
        units=tuple(units),
        values=values,
        rows=read.rows,
        row_word="line",
        rate_hz=stated_rate_hz(lines[: layout.first], layout.marks),
        named=header.named,
        clock=None if read.clock is None else len(names) - 1,
        notes=(_layout_note(layout), *read.notes),
        not_read=tuple(_not_read(lines, layout, header, first_line, read.clock is None)),
    )
    return scaled(found, lines[: layout.first], layout.delimiter, layout.marks)


def _not_read(lines: Sequence[str], layout: Layout, header: Header, first_line: int, timeless: bool) -> Iterator[str]:
    """Columns of text, and of moments that make no time, each with its first field and line."""
    fields = fields_of(lines[layout.first], layout.delimiter)
    for name, kind, text in zip(header.names, layout.kinds, fields, strict=False):
        where = f"{cut(text)!r} in line {layout.first + first_line}"
        if kind == "text" and foreign(text, layout.marks):
            yield f"{name} ({where}: expected a {_mark_word(layout.marks.decimal)} as in other columns)"
        elif kind == "text":
            yield f"{name} (text, {where})"
        elif kind == "minutes" and timeless:
            yield f"{name} ({where}: mm:ss or hh:mm? name it '{name} [mm:ss]' by --columns)"
        elif kind == "date" and timeless:
            yield f"{name} ({where}: a date without a time)"


def _check_line_above(path: Path, lines: Sequence[str], layout: Layout, first_line: int) -> None:
    """Refuse a damaged row that would be taken for the names."""
    at = next((i for i in range(layout.first - 1, -1, -1) if lines[i].strip()), None)
    if at is None:
        return
    fields = fields_of(lines[at], layout.delimiter)
    mixed = any(foreign(f, layout.marks) for f in fields) and all(
        foreign(f, layout.marks) or layout.fits_column(f, i) for i, f in enumerate(fields[: layout.width])
    )
    if not layout.fits(fields) and (layout.resembles(fields) or (mixed and len(fields) == layout.width)):
        bad = next(i for i, text in enumerate(fields) if not layout.fits_column(text, i))
        why = f", {_mark_word(layout.marks.decimal)} as in other columns" if foreign(fields[bad], layout.marks) else ""
        where = f"(field {bad + 1} of {layout.width}{why})"
        raise MeasuredError(
            f"{path}:{at + first_line}: {fields[bad]!r} is not a number, expected {layout.width} numbers {where}: "
            f"{cut(lines[at])!r}"
        )


def _no_rows(path: Path, lines: Sequence[str]) -> MeasuredError:
    begin = next((line.strip() for line in lines if line.strip()), "")
    return MeasuredError(
        f"{path}: no row of numbers found, expected columns of time and forces; it begins with {cut(begin)!r}"
    )


def _weighed(path: Path, lines: Sequence[str], layout: Layout, first_line: int) -> Marks:
    """The marks of numbers, from all rows."""
    rows = number_rows(lines, layout)
    try:
        quoted = any('"' in line for line in lines)
        return settled(rows, layout.marks.decimal) or weighed(rows, None if quoted else layout.delimiter)
    except UnclearMarksError as error:
        at = next(i for i, line in enumerate(lines) if i >= layout.first and error.text in line)
        mark = "," if "," in error.text else "."
        small, large = error.text.replace(mark, "."), error.text.replace(mark, "")
        raise MeasuredError(
            f"{path}:{at + first_line}: {error.text!r} may be {small} or {large}, and no other number shows which; "
            f"give the decimal mark by --decimal , or --decimal ."
        ) from None


def _named_kind(kind: ColumnKind, name: str) -> ColumnKind:
    """A column that its name declares to be hexadecimal is text, whatever digits it has."""
    return "text" if re.search(r"\bhex\b|\b0x", name, re.IGNORECASE) else kind


def _layout_note(layout: Layout) -> str:
    names = {"\t": "tab", None: "white space"}
    mark = _mark_word(layout.marks.decimal)
    return f"columns separated by {names.get(layout.delimiter, repr(layout.delimiter))}, {mark}"


def _mark_word(decimal: str) -> str:
    return "decimal comma" if decimal == "," else "decimal point"
