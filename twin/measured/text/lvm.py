"""LabVIEW measurement files (.lvm): text with a header of its own, in one or more segments."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray
from twin.errors import MeasuredError
from twin.measured.table import Table
from twin.measured.text.lvm_clock import SegmentTimes, joined_times
from twin.measured.text.marks import Marks
from twin.measured.text.reader import opening_of, text_of

_END = "***End_of_Header***"
_SPECIAL = ("***Start_Special***", "***End_Special***")
_MAGIC = "LabVIEW Measurement"
#: The mark between a key of the file's own header and its value, whatever separates the columns.
_MARK = re.compile(r"[\t,;]")
_SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";"}


@dataclass(frozen=True, slots=True)
class _Style:
    """The file's own header: separator, marks, and how time is written: ``no``, ``one`` or ``multi``."""

    delimiter: str
    marks: Marks
    x_columns: str


@dataclass(slots=True)
class _Segment:
    """One segment: its header by key, its names, its rows with their line numbers."""

    head: dict[str, list[str]]
    names: list[str]
    rows: list[list[float]]
    lines: list[int]


def is_lvm(path: Path) -> bool:
    """Whether a file begins as a LabVIEW measurement file does."""
    return opening_of(path).startswith(_MAGIC)


def read_lvm(path: Path) -> Table:
    """All segments on one clock, that of their headers or of their columns of time.

    Raises:
        MeasuredError: a line that is not a row, segments with other channels, or that overlap in time.
    """
    lines = _without_special(text_of(path).splitlines())
    style = _settings(lines)
    segments = _segments(path, lines, style)
    if not segments:
        raise MeasuredError(f"{path}: no segment with numbers, expected a header that ends in {_END}, names and rows")
    first = segments[0]
    for segment in segments:
        if segment.names != first.names:
            raise MeasuredError(f"{path}:{segment.lines[0]}: segments with other channels, expected {first.names}")
    channels = [i for i, name in enumerate(first.names) if not _is_x(name, i)]
    parts = [_times(path, s, style, channels) for s in segments]
    times = joined_times(path, parts)
    units = _units(first.head, len(channels))
    names = [first.names[i] for i in channels]
    values = np.concatenate([part.values for part in parts])
    rows = np.concatenate([np.array(s.lines[: len(p.values)], np.int64) for s, p in zip(segments, parts, strict=True)])
    timed = times.t_s is not None
    return Table(
        format="LabVIEW measurement (.lvm)",
        names=("X_Value", *names) if timed else tuple(names),
        units=("s", *units) if timed else units,
        values=values if times.t_s is None else np.column_stack([times.t_s, values]),
        rows=rows,
        row_word="line",
        rate_hz=times.rate_hz,
        start_s=times.start_s,
        notes=tuple(times.notes),
    )


def _is_x(name: str, index: int) -> bool:
    """Whether a column holds times: the first one always, later ones by their name."""
    return index == 0 or name.lower().startswith("x_value")


def _times(path: Path, segment: _Segment, style: _Style, channels: Sequence[int]) -> SegmentTimes:
    values = np.array(segment.rows, np.float64)
    columns: list[FloatArray] = []
    if style.x_columns == "multi":
        owners = [max(i for i in range(c) if _is_x(segment.names[i], i)) for c in channels]
        columns = [values[:, i] for i in owners]
    elif style.x_columns == "one" and bool(np.isfinite(values[:, 0]).all()):
        columns = [values[:, 0]]
    return SegmentTimes.of(path, segment.head, segment.lines[0], style.marks, columns, values[:, channels])


def _without_special(lines: list[str]) -> list[str]:
    """The lines, those of special blocks empty: they may hold anything."""
    begin, end = _SPECIAL
    starts = [i for i, line in enumerate(lines) if line.startswith(begin)]
    for start in starts:
        stop = next((i for i in range(start, len(lines)) if lines[i].startswith(end)), None)
        if stop is not None:
            lines[start : stop + 1] = [""] * (stop + 1 - start)
    return lines


def _settings(lines: Sequence[str]) -> _Style:
    """Separator, decimal mark, and how time is written, from the file's header."""
    delimiter, decimal, x_columns = "\t", ".", "one"
    for line in lines:
        if line.startswith(_END):
            break
        key, value = [*map(str.strip, _MARK.split(line, maxsplit=1)), ""][:2]
        if key == "Separator":
            delimiter = _SEPARATORS.get(value.lower(), value or "\t")
        elif key == "Decimal_Separator":
            decimal = "," if value[:1] == "," else "."
        elif key == "X_Columns":
            x_columns = value.lower()
    return _Style(delimiter, Marks(decimal), x_columns)


def _segments(path: Path, lines: Sequence[str], style: _Style) -> list[_Segment]:
    """The file's segments; the first header is the file's own."""
    ends = [i for i, line in enumerate(lines) if line.startswith(_END)]
    if not ends:
        raise MeasuredError(f"{path}: no line {_END}, expected a LabVIEW measurement file")
    heads = ends[1:] or ends
    begin = ends[0] + 1 if len(ends) > 1 else 0
    made = []
    for k, end in enumerate(heads):
        limit = heads[k + 1] if k + 1 < len(heads) else None
        stop = _body_end(path, lines, end + 1, limit, style)
        fields = (line.rstrip().split(style.delimiter) for line in lines[begin:end])
        head = {p[0].strip(): p[1:] for p in fields if p[0].strip()}
        segment = _segment(path, lines, (end + 1, stop), head, style)
        if segment.rows:
            made.append(segment)
        begin = stop
    return made


def _body_end(path: Path, lines: Sequence[str], start: int, limit: int | None, style: _Style) -> int:
    """End of a segment's rows: the first line that begins with a word, where another header follows.

    Raises:
        MeasuredError: rows of numbers between that line and the end of the header: it is a damaged row.
    """
    if limit is None:
        return len(lines)
    body = [i for i in range(start, limit) if lines[i].strip()][1:]
    words = [i for i in body if (word := _first(lines[i], style)) and style.marks.number(word) is None]
    stop = words[0] if words else limit
    for index in body:
        if index > stop and style.marks.number(_first(lines[index], style) or "x") is not None:
            word = _first(lines[stop], style)
            raise MeasuredError(f"{path}:{stop + 1}: {word!r} is not a number, expected a row or a header")
    return stop


def _first(line: str, style: _Style) -> str:
    return line.partition(style.delimiter)[0].strip()


def _segment(
    path: Path, lines: Sequence[str], span: tuple[int, int], head: dict[str, list[str]], style: _Style
) -> _Segment:
    start, stop = span
    while start < stop and not lines[start].strip():
        start += 1
    names = [n.strip() for n in lines[start].rstrip("\r\n").split(style.delimiter)] if start < stop else []
    while names and names[-1].lower() in ("comment", ""):
        names.pop()
    segment = _Segment(head, names, [], [])
    for index, fields in _rows(lines, start + 1, stop, style):
        if style.x_columns == "no" and len(fields) < len(names) and fields[0]:
            fields = ["", *fields]
        values = [style.marks.number(f) for f in fields[: len(names)]] + [math.nan] * (len(names) - len(fields))
        if None in values:
            at = values.index(None)
            raise MeasuredError(
                f"{path}:{index + 1}: {fields[at]!r} is not a number, expected {len(names)} numbers (field {at + 1}, "
                f"{names[at]})"
            )
        segment.rows.append([v for v in values if v is not None])
        segment.lines.append(index + 1)
    return segment


def _rows(lines: Sequence[str], start: int, stop: int, style: _Style) -> Iterator[tuple[int, list[str]]]:
    for index in range(start, stop):
        if lines[index].strip():
            yield index, [f.strip() for f in lines[index].split(style.delimiter)]


def _units(head: dict[str, list[str]], count: int) -> tuple[str, ...]:
    units = [u.strip() for u in head.get("Y_Unit_Label", [])][:count]
    return tuple(units + [""] * (count - len(units)))
