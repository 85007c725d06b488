"""Decimal and group marks of numbers in text: which of point and comma is which, decided for a whole file."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

_MISSING = frozenset(
    (
        *("", "nan", "+nan", "-nan", "na", "n/a", "#n/a", "#nv", "-", "--", "---", "null", "none"),
        *("inf", "-inf", "+inf", "1.#qnan", "-1.#ind"),
    )
)
#: Blanks (plain, no-break, narrow no-break, figure, thin) and apostrophes: they only ever group digits.
_BLANKS = " \u00a0\u202f\u2007\u2009"
_APOSTROPHES = "'\u2019"
_TAIL = r"(?:{d}\d*)?(?:[eE][+-]?\d+)?$"
#: Digits in groups of three, or in the Indian grouping; the mark between them is the group ``mark``.
_GROUPED = {
    d: re.compile(
        rf"[+-]?[1-9]\d{{0,2}}(?P<mark>[{_BLANKS}{_APOSTROPHES}{g}])\d{{3}}(?:(?P=mark)\d{{3}})*{_TAIL.format(d=re.escape(d))}"
    )
    for d, g in ((".", ","), (",", "."))
}
_INDIAN = re.compile(r"[+-]?[1-9]\d?(?:,\d{2})+,\d{3}(?:\.\d*)?$")
#: One mark with three digits after it: 1.234 in one country, 1234 in another.
_AMBIGUOUS = {m: re.compile(rf"[+-]?[1-9]\d{{0,2}}{re.escape(m)}\d{{3}}$") for m in ".,"}
_ANY = {m: re.compile(rf"[+-]?\d*{re.escape(m)}\d*(?:[eE][+-]?\d+)?$") for m in ".,"}
#: A column of at least this many whole numbers may be a force.
_MANY_VALUES = 10


def other(mark: str) -> str:
    """Comma for point, point for comma."""
    return "," if mark == "." else "."


@dataclass(frozen=True, slots=True)
class Marks:
    """How numbers are written.

    Attributes:
        decimal: ``.`` or ``,``.
        group: whether a lone ``.`` or ``,`` that is not the decimal mark may group digits, as in ``1,010``; blanks and
            apostrophes always may, and the other mark too where it cannot be meant otherwise, as in ``1,010.5``.
    """

    decimal: str = "."
    group: bool = False

    def number(self, text: str) -> float | None:
        """A field as a number: NaN for what stands for a missing one, None for text."""
        if not text.isascii():
            text = text.replace("\u2212", "-")
        plain = text if self.decimal == "." else "" if "." in text else text.replace(",", ".")
        try:
            value = float(plain)
        except ValueError:
            return math.nan if text.lower() in _MISSING else self._grouped(text)
        if "_" in text:
            return None
        return value if math.isfinite(value) else math.nan

    def _grouped(self, text: str) -> float | None:
        found = _GROUPED[self.decimal].match(text)
        if found is None:
            return float(text.replace(",", "")) if self.decimal == "." and _INDIAN.match(text) else None
        mark = found["mark"]
        if mark in ".," and not self.group and self.decimal not in text and text.count(mark) == 1:
            return None
        return float(text.replace(mark, "").replace(",", "."))


def foreign(text: str, marks: Marks) -> bool:
    """Whether a field is a number only with the other decimal mark."""
    return marks.number(text) is None and Marks(other(marks.decimal)).number(text) is not None


class UnclearMarksError(ValueError):
    """A number that may be read in two ways; ``text`` is it."""

    def __init__(self, text: str) -> None:
        self.text = text
        super().__init__(text)


def settled(rows: Sequence[Sequence[str]], decimal: str) -> Marks | None:
    """The marks, where some number shows which mark is the decimal one; None where none does.

    Args:
        rows: fields of rows.
        decimal: the mark under which the rows are numbers.
    """
    marked = [f for row in rows for f in row if "." in f or "," in f]
    proven = {m: any(_proves(f, m) for f in marked) for m in ".,"}
    if proven["."] != proven[","]:
        return Marks("." if proven["."] else ",", True)
    return Marks(decimal) if proven["."] else None


def weighed(rows: Sequence[Sequence[str]], delimiter: str | None) -> Marks:
    """The marks of a file in which every mark has one to three digits before it and three after it.

    A column that has whole numbers below 1000 and grouped ones settles it. Otherwise points are decimal points, unless
    another column has whole numbers of many values; commas may be either.

    Args:
        rows: fields of all rows.

    Raises:
        UnclearMarksError: nothing settles it.
    """
    columns = list(zip(*rows, strict=False))
    found = {m: [c for c in columns if any(_AMBIGUOUS[m].match(f) for f in c)] for m in ".," if m != delimiter}
    used = [m for m, those in found.items() if those]
    if not used:
        return Marks()
    for mark in used:
        if any(_mixed(column, mark) for column in found[mark]):
            return Marks(other(mark), True)
    rest = [c for c in columns if not any(c is taken for those in found.values() for taken in those)]
    if used == ["."] and not any(map(_whole, rest)):
        return Marks()
    mark = used[0]
    raise UnclearMarksError(next(f for f in found[mark][0] if _AMBIGUOUS[mark].match(f)))


def _proves(text: str, mark: str) -> bool:
    """Whether a number shows that a mark is the decimal one, or that the other one groups."""
    if _ANY[mark].match(text):
        return not _AMBIGUOUS[mark].match(text)
    found = _GROUPED[mark].match(text)
    return found is not None and (mark in text or text.count(found["mark"]) > 1)


def _mixed(column: Iterable[str], mark: str) -> bool:
    """Whether whole numbers below 1000 stand among those with a mark, and one of these ends in 0.

    A program that cuts zeros off after a decimal mark writes no ``1,010``.
    """
    marked = [f for f in column if mark in f]
    plain = [f.lstrip("+-") for f in column if mark not in f and f]
    small = bool(plain) and all(f.isdigit() and len(f) <= 3 for f in plain)
    return small and any(f.endswith("0") for f in marked) and all(_AMBIGUOUS[mark].match(f) for f in marked)


def _whole(column: Sequence[str]) -> bool:
    """Whether a column has whole numbers of many values that do not count up."""
    if not all(f.lstrip("+-").isdigit() for f in column) or len(set(column)) < _MANY_VALUES:
        return False
    values = list(map(int, column))
    return any(b < a for a, b in pairwise(values))
