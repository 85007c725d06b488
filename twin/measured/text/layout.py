"""Layout of a text file: delimiter, marks of numbers, kinds of columns, first row. Found by trials, never by suffix."""

from __future__ import annotations

import csv
import math
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from twin.measured.text.clocks import ClockKind, moment
from twin.measured.text.marks import Marks, settled

#: Delimiters that are tried, None for any white space; commas followed by a blank may occur with decimal commas.
_DELIMITERS = ("\t", ";", "|", ",", None)
_TRIED_LINES = 400
#: Lines that are long are tried up to about this many characters, but at least some of them.
_TRIED_CHARACTERS, _LEAST_LINES = 400_000, 20
#: A layout of plain numbers is taken without further trials when this share of the lines below its first row fits.
_ENOUGH = 0.9
#: A column is text when at least this share of its fields is neither a number nor empty.
_TEXT_SHARE = 0.2
#: A column of text costs a layout this many columns of numbers: a wrong delimiter makes text of parts of dates.
_TEXT_COST = 0.6
_HEX = re.compile(r"(?:0x)?[0-9a-f]+$", re.IGNORECASE)
_AM_PM = re.compile(r"(?<=\d)\s+(?=[AaPp]\.?[Mm]\b)")
_WHITE = re.compile(r"[ \t\f\v]+")
_QUOTED = re.compile(r'"([^"]*)"(?=\s|$)|(\S+)')

ColumnKind: TypeAlias = Literal["number", "text"] | ClockKind
_NUMBER: ColumnKind = "number"


@dataclass(frozen=True, slots=True)
class Layout:
    """Separation of fields and their kinds.

    Attributes:
        delimiter: None for white space.
        marks: how numbers are written.
        kinds: of each column.
        first: index of the first row.
    """

    delimiter: str | None
    marks: Marks
    kinds: tuple[ColumnKind, ...]
    first: int = 0

    @property
    def width(self) -> int:
        """Number of fields in a row."""
        return len(self.kinds)

    def fits(self, fields: Sequence[str]) -> bool:
        """Whether fields are a row: every one of its column's kind or empty, and a number or moment among them."""
        if len(fields) != self.width:
            return False
        found = [_fits(f, kind, self.marks) for f, kind in zip(fields, self.kinds, strict=True)]
        return None not in found and any(found)

    def fits_column(self, text: str, index: int) -> bool:
        """Whether a field is of its column's kind, or empty."""
        return _fits(text, self.kinds[index], self.marks) is not None

    def resembles(self, fields: Sequence[str]) -> bool:
        """Whether fields may be a damaged row: the first one and half of them fit."""
        if len(fields) != self.width or self.kinds[0] == "text":
            return False
        found = [_fits(f, kind, self.marks) for f, kind in zip(fields, self.kinds, strict=True)]
        return bool(found[0]) and 2 * sum(f is not None for f in found) >= self.width


@dataclass(frozen=True, slots=True)
class _Trial:
    """A layout that was tried: ``rows`` fit of ``lines`` below the first one that does."""

    layout: Layout
    rows: int
    lines: int

    @property
    def score(self) -> float:
        """Numbers that the layout makes of the sample, date and time as one; columns of text count against it."""
        kinds = self.layout.kinds
        clock = bool(set(kinds) - {"number", "text"})
        return self.rows * (kinds.count("number") + clock - _TEXT_COST * kinds.count("text"))

    @property
    def enough(self) -> bool:
        return self.rows >= _ENOUGH * self.lines


def fields_of(line: str, delimiter: str | None) -> list[str]:
    """A line's fields without blanks and quotes; empty fields after the last one are dropped."""
    if delimiter is None:
        if '"' in line:
            return [(quoted or plain).strip() for quoted, plain in _QUOTED.findall(line)]
        if not line.isascii() or "m" in line or "M" in line:
            line = _AM_PM.sub("", line).strip()
            return _WHITE.split(line) if line else []
        return line.split()
    if '"' in line:
        parts = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
    else:
        parts = line.split(delimiter)
    parts = [p.strip() for p in parts]
    while parts and not parts[-1]:
        parts.pop()
    return parts


def find_layout(lines: Sequence[str], delimiter: str | None = None, decimal: str | None = None) -> Layout | None:
    """The layout under which most lines are rows of one width; None where there is none.

    Plain numbers are tried first, then numbers with group marks, then columns of text, dates and times among them.

    Args:
        lines: the file's lines.
        delimiter: ``""`` for white space, None to find it.
        decimal: ``.`` or ``,``, None to find it.
    """
    delimiters = _DELIMITERS if delimiter is None else (delimiter or None,)
    decimals = (".", ",") if decimal is None else (decimal,)
    sample = _sample(lines)
    quoted = any('"' in line for line in sample)
    pairs = [(d, mark) for mark in decimals for d in delimiters if mark != d or (quoted and mark == ",")]
    plain = [t for d, mark in pairs if (t := _try(sample, d, Marks(mark))) is not None]
    best = max(plain, key=lambda t: (t.rows, t.layout.width), default=None)
    if best is None or not best.enough:
        tried = [t for d, mark in pairs if (t := _try(sample, d, Marks(mark, True))) is not None and t.enough]
        mixed = [t for d, mark in pairs for t in _try_kinds(sample, d, Marks(mark, decimal is not None))]
        mixed += [t for d, mark in pairs for t in _try_kinds(sample, d, Marks(mark, True))]
        best = max([*([best] if best else []), *tried, *mixed], key=lambda t: t.score, default=None)
    if best is None:
        return None
    made = _by_tabs(sample, best.layout, decimals) or best.layout
    marks = Marks(decimal, True) if decimal is not None else settled(_rows(sample, made), made.marks.decimal)
    made = Layout(made.delimiter, marks or made.marks, made.kinds)
    return Layout(made.delimiter, made.marks, made.kinds, _first_row(lines, made))


def _by_tabs(lines: Sequence[str], found: Layout, decimals: Sequence[str]) -> Layout | None:
    """The layout in which tabs separate and blanks group digits, where white space would divide the groups."""
    if found.delimiter is not None or not any("\t" in line for line in lines):
        return None
    most = found.kinds.count("text")
    tried = [t for mark in decimals for t in _try_kinds(lines, "\t", Marks(mark, True))]
    good = [t for t in tried if t.enough and t.layout.width > 1 and t.layout.kinds.count("text") <= most]
    return max(good, key=lambda t: t.score).layout if good else None


def is_settled(lines: Sequence[str], layout: Layout) -> bool:
    """Whether some number of the sample shows which mark is the decimal one."""
    return settled(_rows(_sample(lines), layout), layout.marks.decimal) is not None


def _rows(lines: Sequence[str], layout: Layout) -> list[list[str]]:
    """The numbers of the rows among lines, without the other columns."""
    numbers = [i for i, kind in enumerate(layout.kinds) if kind == "number"]
    rows = (fields_of(line, layout.delimiter) for line in lines)
    return [[row[i] for i in numbers] for row in rows if layout.fits(row)]


def number_rows(lines: Sequence[str], layout: Layout) -> list[list[str]]:
    """The numbers as written, of all rows, whatever marks they have."""
    numbers = [i for i, kind in enumerate(layout.kinds) if kind == "number"]
    rows = (fields_of(line, layout.delimiter) for line in lines[layout.first :])
    return [[row[i] for i in numbers] for row in rows if len(row) == layout.width]


def _try(lines: Sequence[str], delimiter: str | None, marks: Marks) -> _Trial | None:
    """A layout of numbers only."""
    widths: Counter[int] = Counter()
    split = [fields for line in lines if (fields := fields_of(line, delimiter))]
    good = [is_row(fields, marks) for fields in split]
    widths.update(len(fields) for fields, row in zip(split, good, strict=True) if row)
    if not widths:
        return None
    width, count = max(widths.items(), key=lambda item: (item[1], item[0]))
    return _Trial(Layout(delimiter, marks, (_NUMBER,) * width), count, _lines_below(good))


def _try_kinds(lines: Sequence[str], delimiter: str | None, marks: Marks) -> Iterator[_Trial]:
    """A layout with columns of text, dates and times: the width that most lines with a number or moment have."""
    split = [fields for line in lines if (fields := fields_of(line, delimiter))]
    kinds = [[_kind(f, marks) for f in fields] for fields in split]
    widths = Counter(len(k) for k in kinds if any(each not in ("text", "") for each in k))
    if not widths:
        return
    width = max(widths.items(), key=lambda item: (item[1], item[0]))[0]
    rows = [(f, k) for f, k in zip(split, kinds, strict=True) if len(k) == width and set(k) - {"text", ""}]
    found = tuple(_column_kind(*zip(*column, strict=True)) for column in _columns(rows))
    layout = Layout(delimiter, marks, found)
    fit = [layout.fits(fields) for fields in split]
    if True in fit and "number" in found:
        yield _Trial(layout, sum(fit), _lines_below(fit))


def _lines_below(rows: Sequence[bool]) -> int:
    """Lines from the first row on that another one follows: a row of settings may be far above."""
    pairs = [i for i in range(len(rows) - 1) if rows[i] and rows[i + 1]]
    return len(rows) - (pairs[0] if pairs else rows.index(True))


def _columns(rows: Sequence[tuple[list[str], list[str]]]) -> list[list[tuple[str, str]]]:
    """Fields of each column with their kinds."""
    return [list(column) for column in zip(*(zip(f, k, strict=True) for f, k in rows), strict=True)]


def _kind(text: str, marks: Marks) -> str:
    """Kind of one field, ``""`` for what stands for a missing number."""
    value = marks.number(text)
    if value is not None:
        return "" if math.isnan(value) else "number"
    found = moment(text)
    return "text" if found is None else found.kind


def _column_kind(texts: Sequence[str], kinds: Sequence[str]) -> ColumnKind:
    counts = Counter(k for k in kinds if k)
    strange = [t for t, k in zip(texts, kinds, strict=True) if k == "text"]
    if not counts:
        return "number"
    hexadecimal = len(strange) > 1 and all(map(_HEX.match, strange))
    if counts["text"] >= _TEXT_SHARE * counts.total() or hexadecimal:
        return "text"
    best = max((k for k in counts if k != "text"), key=lambda k: counts[k])
    for kind in ("date", "time", "stamp", "minutes"):
        if best == kind:
            return kind
    return "number"


def _fits(text: str, kind: ColumnKind, marks: Marks) -> bool | None:
    """True for a number or moment of a column's kind, False for an empty field or text, None for what does not fit."""
    if kind == "text":
        return False
    value = marks.number(text)
    if value is not None and (kind == "number" or math.isnan(value)):
        return not math.isnan(value)
    found = moment(text) if kind != "number" else None
    return True if found is not None and found.kind == kind else None


def _first_row(lines: Sequence[str], layout: Layout) -> int:
    """The first row that is followed by another one: a row of settings may be above the names."""
    first, latest, before = -1, -1, False
    for index, line in enumerate(lines):
        fields = fields_of(line, layout.delimiter)
        if not fields:
            continue
        row = layout.fits(fields)
        if before and (row or layout.resembles(fields)):
            return latest
        if row:
            latest = index
            first = index if first < 0 else first
        before = row
    return first


def _sample(lines: Sequence[str]) -> list[str]:
    """The first lines, where the header is, and some from the middle and the end."""
    usual = max(1, sum(map(len, lines[:_LEAST_LINES])) // _LEAST_LINES)
    half = min(max(_TRIED_CHARACTERS // usual, _LEAST_LINES), _TRIED_LINES) // 2
    middle = max(half, len(lines) // 2)
    end = max(middle + half, len(lines) - half // 4)
    return [*lines[:half], *lines[middle : middle + half], *lines[end:]]


def is_row(fields: Sequence[str], marks: Marks) -> bool:
    """Whether all fields are numbers or stand for missing ones, and one is a number."""
    values = [marks.number(f) for f in fields]
    return None not in values and any(v is not None and not math.isnan(v) for v in values)
