"""The lines above the numbers: names, a row of units, the sampling rate."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from twin.errors import MeasuredError
from twin.measured.table import distinct
from twin.measured.text.layout import Layout, fields_of
from twin.measured.text.marks import Marks, other
from twin.measured.units import find_unit, is_unit_text

_VALUE = r"\"?(?P<value>\d(?:[\d.,]|['\u2019\u00a0\u202f ](?=\d{3}))*(?:e[+-]?\d+)?)\"?"
_RATE = re.compile(
    r"(?:sampl\w*[\s_-]*(?:rate|freq\w*)|sample[\s_-]*rate|samples?[/ ]s(?:ec\w*)?|abtastrate|abtastfrequenz|"
    r"scan[\s_-]*rate|acquisition[\s_-]*rate|\bfs\b|\brate\b)"
    rf"\s*[\[(]?\s*(?P<unit1>k?hz|s/s)?\s*[\])]?\s*[:=,;\t ]+\s*{_VALUE}\s*(?P<unit2>k?hz|s/s)?",
    re.IGNORECASE,
)
_INTERVAL = re.compile(
    r"(?:sampl\w*[\s_-]*(?:interval|period|time)|delta[\s_-]*x|delta[\s_-]*t|\bdt\b|increment)"
    rf"\s*[\[(]?\s*(?P<unit1>[mun]?s(?:ec)?)?\s*[\])]?\s*[:=,;\t ]+\s*{_VALUE}\s*(?P<unit2>[mun]?s(?:ec)?)?",
    re.IGNORECASE,
)
_COMMENT = re.compile(r"^\s*(?:#+|%+|//+|!+|;+|')\s*")
#: A column of remarks, which may be empty throughout.
_REMARK = re.compile(r"comment|remark|note|bemerkung|kommentar|event|status", re.IGNORECASE)
#: A name with its unit in brackets, in a line that is set apart by blanks.
_WITH_UNIT = re.compile(r"[^\s\[(]+(?:\s*[\[(][^\])]*[\])])?")


@dataclass(frozen=True, slots=True)
class Header:
    """Names and units of the columns; ``named`` is False where the names are numbers given here."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    named: bool
    seen: tuple[tuple[str, ...], ...] = ()

    def repeats(self, fields: Sequence[str]) -> bool:
        """Whether a line is one of the header's lines again."""
        return tuple(fields) in self.seen


def find_header(
    path: Path, lines: Sequence[str], layout: Layout, columns: Sequence[str] | None, first_line: int = 1
) -> Header:
    """Names from the user, or from the last lines above the numbers.

    Raises:
        MeasuredError: as many names as columns are needed.
    """
    above = [fields for line in lines[: layout.first] if (fields := _fields(line, layout))]
    units = _units_row(above, layout)
    rows = above[:-1] if units else above
    last = rows[-1] if rows else []
    if len(last) == layout.width + 1 and _REMARK.match(last[-1]):
        last = last[:-1]
    elif len(last) > layout.width and layout.first < len(lines):
        written = len(fields_of(f"{lines[layout.first]}.", layout.delimiter)) if layout.delimiter else 0
        last = last[: layout.width] if written == len(last) else last  # the last columns are empty throughout
    names = last if _is_names(last, layout) else None
    seen = tuple(tuple(row) for row in (names, units) if row)
    spare = tuple(units) if units else ("",) * layout.width
    if columns is not None:
        if len(columns) != layout.width:
            raise MeasuredError(
                f"{path}:{layout.first + first_line}: {layout.width} columns, --columns gives {len(columns)} names: "
                f"{', '.join(columns)}"
            )
        return Header(tuple(columns), spare, True, seen)
    stated = next((row for row in reversed(rows) if _wordy(row, layout)), [])
    if names is None and len(stated) > 1 and not _is_rate_line(stated):
        hint = "; numbers with commas as group marks need quotes" if layout.delimiter == "," else ""
        raise MeasuredError(
            f"{path}:{layout.first + first_line}: {layout.width} columns of numbers below a header of {len(stated)} "
            f"names ({', '.join(stated)}); name every column by --columns, or give --delimiter and --decimal{hint}"
        )
    if names is None:
        return Header(tuple(f"column{i + 1}" for i in range(layout.width)), spare, False, seen)
    return Header(distinct(names), spare, True, seen)


def _fields(line: str, layout: Layout) -> list[str]:
    """Fields of a line above the numbers, without the mark of a comment."""
    bare = _COMMENT.sub("", line, count=1)
    fields = fields_of(bare, layout.delimiter)
    if layout.delimiter is None and len(fields) != layout.width:
        for wider in (re.split(r"\s{2,}|\t", bare.strip()), _WITH_UNIT.findall(bare)):
            if len(wider) == layout.width:
                return [f.strip() for f in wider]
    if layout.delimiter is None and 0 < sum(map(_is_bracketed, fields)) < len(fields):
        return [f.strip() for f in _WITH_UNIT.findall(bare)]
    return fields


def _is_bracketed(field: str) -> bool:
    """Whether a field is a unit in brackets: it belongs to the name before it."""
    return field[:1] in "[(" and field[-1:] in "])" and is_unit_text(field)


def _units_row(above: Sequence[list[str]], layout: Layout) -> list[str] | None:
    """The last line above the numbers when it is a row of units."""
    if not above or len(above[-1]) > layout.width:
        return None
    row = above[-1]
    stated = [f for f in row if f not in ("", "-", "[]", "[-]", "()")]
    known = sum(is_unit_text(f) or f[:1] in "[(" for f in stated)
    named_above = len(above) > 1 and _is_names(above[-2], layout)
    needed = 0.5 * len(stated) if named_above else len(stated)
    if not stated or known < needed or any(find_unit(f) is None and len(f) > 8 for f in row):
        return None
    return [f.strip("[](){}<> ") for f in row] + [""] * (layout.width - len(row))


def _is_names(row: Sequence[str], layout: Layout) -> bool:
    """Whether a line names the columns: as many fields, and text among them."""
    return len(row) == layout.width and _wordy(row, layout) and not layout.resembles(row)


def _wordy(row: Sequence[str], layout: Layout) -> bool:
    return any(f and layout.marks.number(f) is None for f in row)


def _is_rate_line(row: Sequence[str]) -> bool:
    text = " ".join(row)
    return ":" in text or "=" in text or _RATE.search(text) is not None or _INTERVAL.search(text) is not None


def stated_rate_hz(lines: Sequence[str], marks: Marks) -> float | None:
    """A sampling rate, or the inverse of an interval, stated in words above the numbers.

    Args:
        marks: of the numbers below.
    """
    for line in lines:
        if found := _RATE.search(line):
            scale = 1e3 if (found["unit1"] or found["unit2"] or "").lower() == "khz" else 1.0
            value = _value(found["value"], marks)
            if value:
                return scale * value
    for line in lines:
        if found := _INTERVAL.search(line):
            known = find_unit(found["unit1"] or found["unit2"] or "s")
            value = _value(found["value"], marks)
            if value and known is not None and known[0] == "time":
                return 1.0 / (value * known[1])
    return None


def _value(text: str, marks: Marks) -> float | None:
    """A number with the marks of the numbers below, or, if it is none then, with the other ones."""
    text = text.rstrip(".,")
    value = Marks(marks.decimal, True).number(text)
    return Marks(other(marks.decimal), True).number(text) if value is None else value
