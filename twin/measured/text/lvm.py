"""LabVIEW measurement files (.lvm): text with a header of its own, in one or more segments."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from twin.errors import MeasuredError
from twin.measured.table import Table
from twin.measured.text.marks import Marks
from twin.measured.text.reader import text_of

_END = "***End_of_Header***"
_MAGIC = "LabVIEW Measurement"
_SEPARATORS = {"tab": "\t", "comma": ","}


@dataclass(slots=True)
class _Segment:
    """One segment: its header by key, its names, its rows with their line numbers."""

    head: dict[str, list[str]]
    names: list[str]
    rows: list[list[float]]
    lines: list[int]


def is_lvm(path: Path) -> bool:
    """Whether a file begins as a LabVIEW measurement file does."""
    with path.open("rb") as file:
        return file.read(64).lstrip(b"\xef\xbb\xbf").startswith(_MAGIC.encode())


def read_lvm(path: Path) -> Table:
    """All segments one after the other.

    Raises:
        MeasuredError: a line that is not a row, segments with other channels, one time column for each channel.
    """
    lines = text_of(path).splitlines()
    delimiter, decimal, x_columns = _settings(lines)
    if x_columns == "multi":
        raise MeasuredError(f"{path}: a time column for every channel (X_Columns Multi); expected X_Columns One or No")
    segments = _segments(path, lines, delimiter, decimal)
    if not segments:
        raise MeasuredError(f"{path}: no segment with numbers, expected a header that ends in {_END}, names and rows")
    first = segments[0]
    if any(s.names != first.names for s in segments):
        raise MeasuredError(f"{path}:{segments[1].lines[0]}: segments with other channels, expected {first.names}")
    channels = first.names[1:]
    values = np.array([row for s in segments for row in s.rows], np.float64)
    rows = np.array([line for s in segments for line in s.lines], np.int64)
    rate = _rate_hz(first.head)
    with_time = x_columns == "one" and bool(np.isfinite(values[:, 0]).all())
    names = ["X_Value", *channels] if with_time else channels
    units = _units(first.head, len(channels))
    note = [f"{len(segments)} segments joined"] if len(segments) > 1 else []
    return Table(
        format="LabVIEW measurement (.lvm)",
        names=tuple(names),
        units=(("s", *units) if with_time else units),
        values=values if with_time else values[:, 1:],
        rows=rows,
        row_word="line",
        rate_hz=rate,
        start_s=_first_number(first.head.get("X0", []), decimal) or 0.0,
        notes=tuple(note),
    )


def _settings(lines: Sequence[str]) -> tuple[str, str, str]:
    """Separator, decimal mark, and how time is written, from the file's header."""
    delimiter, decimal, x_columns = "\t", ".", "one"
    for line in lines:
        if line.startswith(_END):
            break
        key, _, value = line.replace(",", "\t", 1).partition("\t") if "\t" not in line else line.partition("\t")
        value = value.strip()
        if key == "Separator":
            delimiter = _SEPARATORS.get(value.lower(), value or "\t")
        elif key == "Decimal_Separator":
            decimal = value[:1] or "."
        elif key == "X_Columns":
            x_columns = value.lower()
    return delimiter, decimal, x_columns


def _segments(path: Path, lines: Sequence[str], delimiter: str, decimal: str) -> list[_Segment]:
    """The file's segments; the first header is the file's own."""
    ends = [i for i, line in enumerate(lines) if line.startswith(_END)]
    if not ends:
        raise MeasuredError(f"{path}: no line {_END}, expected a LabVIEW measurement file")
    heads = ends[1:] or ends
    made = []
    for k, end in enumerate(heads):
        begin = ends[ends.index(end) - 1] + 1 if ends.index(end) else 0
        stop = _body_end(lines, end + 1, heads[k + 1] if k + 1 < len(heads) else len(lines))
        head = {p[0]: p[1:] for p in (line.rstrip().split(delimiter) for line in lines[begin:end]) if p[0]}
        segment = _segment(path, lines, (end + 1, stop), head, (delimiter, decimal))
        if segment.rows:
            made.append(segment)
    return made


def _body_end(lines: Sequence[str], start: int, limit: int) -> int:
    """End of a segment's rows: the next segment's header begins with ``Channels``."""
    return next((i for i in range(start, limit) if lines[i].startswith("Channels")), limit)


def _segment(
    path: Path, lines: Sequence[str], span: tuple[int, int], head: dict[str, list[str]], style: tuple[str, str]
) -> _Segment:
    start, stop = span
    delimiter, decimal = style
    while start < stop and not lines[start].strip():
        start += 1
    names = [n.strip() for n in lines[start].rstrip("\r\n").split(delimiter)] if start < stop else []
    if names and names[-1].lower() == "comment":
        names.pop()
    segment = _Segment(head, names, [], [])
    for index in range(start + 1, stop):
        if not lines[index].strip():
            continue
        fields = [f.strip() for f in lines[index].split(delimiter)][: len(names)]
        values = [Marks(decimal).number(f) for f in fields] + [math.nan] * (len(names) - len(fields))
        if None in values:
            bad = fields[values.index(None)]
            raise MeasuredError(f"{path}:{index + 1}: {bad!r} is not a number, expected {len(names)} numbers")
        segment.rows.append([v for v in values if v is not None])
        segment.lines.append(index + 1)
    return segment


def _rate_hz(head: dict[str, list[str]]) -> float | None:
    step = _first_number(head.get("Delta_X", []), ",") or _first_number(head.get("Delta_X", []), ".")
    return 1.0 / step if step else None


def _first_number(fields: Sequence[str], decimal: str) -> float | None:
    for field in fields:
        value = Marks(decimal).number(field.strip())
        if value is not None and not math.isnan(value):
            return value
    return None


def _units(head: dict[str, list[str]], count: int) -> tuple[str, ...]:
    units = [u.strip() for u in head.get("Y_Unit_Label", [])][:count]
    return tuple(units + [""] * (count - len(units)))
