"""Forces in counts of a converter, with the counts per unit in the lines above the columns."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from twin.measured.axes import guess_map
from twin.measured.table import Table
from twin.measured.text.body import cut
from twin.measured.text.marks import Marks, other
from twin.measured.units import find_unit, split_unit

_NUMBER = r"\d[\d.,'\u00a0\u202f ]*(?:e[+-]?\d+)?"
_COUNT = r"(?:counts?|cnts?|cts|lsb|bits?|digits?|increments?)"
_FORCE = r"(?:kN|mN|daN|N|klbf|lbf|lb|kgf)"
_MARK = r"\s*[\"']?\s*[:=,;\t ]\s*[\"']?"
#: ``Counts per Unit Force``, also as ``cpf``; ``Counts per Force Unit``, ``Counts per Unit``, ``Fx counts/N``.
_COUNTS = re.compile(
    rf"{_COUNT}[\s_]*(?:per|pro|/)[\s_]*(?:(?:unit[\s_]*)?(?:(?P<what>force|torque)s?|(?P<unit>{_FORCE})\b)(?:[\s_]*units?)?"
    r"|units?\b)|\b(?:cfg)?cp(?P<short>[ft])\b",
    re.IGNORECASE,
)
#: ``0.01 N/count``, ``Scale [N/LSB]``, and ``1 count = 0.01 N``.
_SIZE = re.compile(rf"(?P<unit>\b{_FORCE}|(?<=\d){_FORCE})\s*(?:/|per)\s*{_COUNT}\b", re.IGNORECASE)
_EQUALS = re.compile(rf"\b{_COUNT}\s*[=:]\s*(?P<value>{_NUMBER})\s*(?P<unit>{_FORCE})\b", re.IGNORECASE)
_AXIS = re.compile(r"\bF[\s_]*(?P<axis>[xyz])(?![a-z])", re.IGNORECASE)
_UNIT = re.compile(rf"(?P<what>force|torque)[\s_]*units?{_MARK}(?P<unit>[a-z][^\s\"',;]*)", re.IGNORECASE)
_TORQUE = re.compile(r"^[TM][\s_]*[xyz]\b", re.IGNORECASE)
#: A scale in other words, whose sense is not known.
_OTHER_SCALE = re.compile(
    r"(?=.*\d).*(?:scal(?:e|ing)|factor|faktor|gain|sensitiv|resolution|calibrat|skalier)", re.IGNORECASE
)
_IN_COUNTS = re.compile(rf"(?:adc|raw|{_COUNT})$", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class _Scale:
    """Counts per unit that a line states: for one axis, or for all; ``unit`` is "" where another line has it."""

    what: str
    axis: str
    counts: tuple[float, ...]
    unit: str

    def of(self, axis: str) -> float | None:
        """Counts per unit of a force's axis."""
        if self.what != "force" or self.axis not in ("", axis):
            return None
        at = "xyz".index(axis)
        return self.counts[at] if len(self.counts) > at else self.counts[0] if len(self.counts) == 1 else None


def scaled(table: Table, above: Sequence[str], delimiter: str | None, marks: Marks) -> Table:
    """The table with columns in counts turned into the unit that the header states.

    Columns that state a unit of their own, and such with fractions, which are not counts, stay as they are.

    Args:
        above: the lines above the columns.
        delimiter, marks: of the columns.
    """
    scales = [scale for line in above if (scale := _scale(line, delimiter, marks))]
    if not scales:
        return _doubted(table, above)
    stated = {m["what"].lower(): m["unit"] for line in above if (m := _UNIT.search(line))}
    forces = guess_map(table.names)
    axes = {} if forces is None else {name: axis for axis, name in forces.entries}
    units, values, notes = list(table.units), table.values.copy(), list(table.notes)
    for index, name in enumerate(table.names):
        what = "force" if name in axes else "torque" if _TORQUE.match(name) else ""
        found = [(c, s) for s in scales if s.what == what and (c := s.of(axes[name]) if name in axes else s.counts[0])]
        if not found or not _in_counts(table, index):
            continue
        count, scale = next((each for each in found if each[1].axis), found[0])
        values[:, index] /= count
        units[index] = scale.unit or stated.get(what, "N" if what == "force" else "N-m")
        if what == "force":
            notes.append(f"column {name!r} in counts: {count:g} per {units[index]}, as in the header")
    names = tuple(split_unit(n)[0] if units[i] != table.units[i] else n for i, n in enumerate(table.names))
    return replace(table, names=names, units=tuple(units), values=values, notes=tuple(notes))


def _doubted(table: Table, above: Sequence[str]) -> Table:
    """The table with a note where forces may be counts: whole numbers without a unit, below a line about a scale."""
    forces = guess_map(table.names)
    if forces is None or not any(map(_OTHER_SCALE.match, above)):
        return table
    columns = [table.names.index(name) for _, name in forces.entries]
    if any(split_unit(table.names[i])[1] or table.units[i] or not _in_counts(table, i) for i in columns):
        return table
    line = next(line for line in above if _OTHER_SCALE.match(line))
    return replace(table, notes=(*table.notes, f"forces are whole numbers, and not scaled by {cut(line)!r}"))


def _scale(line: str, delimiter: str | None, marks: Marks) -> _Scale | None:
    """The scale that a line above the columns states."""
    axis = found["axis"].lower() if (found := _AXIS.search(line)) else ""
    if found := _EQUALS.search(line):
        values = [_value(found["value"], marks)]
        return _Scale("force", axis, (1.0 / values[0],), found["unit"]) if values[0] else None
    if found := _SIZE.search(line):
        before = re.search(rf"(?P<value>{_NUMBER})\s*$", line[: found.start()])
        sizes = (
            [v] if before and (v := _value(before["value"], marks)) else _values(line[found.end() :], delimiter, marks)
        )
        return _Scale("force", axis, tuple(1.0 / v for v in sizes), found["unit"]) if sizes else None
    if found := _COUNTS.search(line):
        counts = _values(line[found.end() :], delimiter, marks)
        what = "torque" if (found["what"] or found["short"] or "f")[0] in "tT" else "force"
        return _Scale(what, axis, tuple(counts), found["unit"] or "") if counts else None
    return None


def _values(text: str, delimiter: str | None, marks: Marks) -> list[float]:
    """The numbers after a key: one, with group marks, or one for each column."""
    text = re.sub(r"^[^\d]*(?=\d)|[\"']", "", text)
    parts = [p.strip() for p in text.split(delimiter) if p.strip()]
    whole = _value(text, marks)
    several = len(parts) > 2 and not any(re.match(r"0\d", p) for p in parts)
    if whole is not None and not several:
        return [whole]
    values = [v for p in parts if (v := _value(p.partition(" ")[0], marks)) is not None]
    return values if len(values) > 2 else values[:1]


def _in_counts(table: Table, index: int) -> bool:
    unit = (split_unit(table.names[index])[1] or table.units[index]).strip("[]() ")
    known = find_unit(unit) if unit else None
    if unit and not _IN_COUNTS.match(unit) and (known is None or known[0] != "other"):
        return False
    values = table.values[np.isfinite(table.values[:, index]), index]
    return bool((values == np.rint(values)).all())


def _value(text: str, marks: Marks) -> float | None:
    """A number above 0, with the marks of the numbers below, or, if it is none then, with the other ones."""
    text = text.strip().rstrip(".,; ")
    value = Marks(marks.decimal, True).number(text)
    value = Marks(other(marks.decimal), True).number(text) if value is None else value
    return value if value is not None and value > 0.0 else None
