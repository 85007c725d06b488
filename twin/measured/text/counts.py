"""Forces in counts of a converter, with the counts per unit in the lines above the columns."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from twin.measured.axes import guess_map
from twin.measured.table import Table
from twin.measured.text.marks import Marks
from twin.measured.units import find_unit, split_unit

_MARK = r"\s*[\"']?\s*[:=,;\t ]\s*[\"']?"
_COUNTS = re.compile(
    rf"counts?[\s_]*(?:per|/)[\s_]*(?:unit[\s_]*)?(?P<what>force|torque){_MARK}(?P<value>[\d.,' ]+(?:e[+-]?\d+)?)",
    re.IGNORECASE,
)
_UNIT = re.compile(rf"(?P<what>force|torque)[\s_]*units?{_MARK}(?P<unit>[^\s\"',;]+)", re.IGNORECASE)
_TORQUE = re.compile(r"^[TM][\s_]*[xyz]\b", re.IGNORECASE)


def scaled(table: Table, above: Sequence[str]) -> Table:
    """The table with columns in counts turned into the unit that the header states.

    Columns that state a unit of their own, and such with fractions, which are not counts, stay as they are.

    Args:
        above: the lines above the columns.
    """
    counts = {m["what"].lower(): c for line in above if (m := _COUNTS.search(line)) and (c := _value(m["value"]))}
    if not counts:
        return table
    stated = {m["what"].lower(): m["unit"] for line in above if (m := _UNIT.search(line))}
    forces = guess_map(table.names)
    forces_of = {name for _, name in forces.entries} if forces is not None else set()
    units, values, notes = list(table.units), table.values.copy(), list(table.notes)
    for index, name in enumerate(table.names):
        what = "force" if name in forces_of else "torque" if _TORQUE.match(name) else ""
        if what not in counts or not _in_counts(table, index):
            continue
        values[:, index] /= counts[what]
        units[index] = stated.get(what, "N" if what == "force" else "N-m")
        if what == "force":
            notes.append(f"column {name!r} in counts: {counts[what]:g} per {units[index]}, as in the header")
    return replace(table, units=tuple(units), values=values, notes=tuple(notes))


def _in_counts(table: Table, index: int) -> bool:
    unit = split_unit(table.names[index])[1] or table.units[index]
    known = find_unit(unit) if unit else None
    if unit and (known is None or known[0] != "other"):
        return False
    values = table.values[np.isfinite(table.values[:, index]), index]
    return bool((values == np.rint(values)).all())


def _value(text: str) -> float | None:
    value = Marks(group=True).number(text.strip().rstrip(".,"))
    return value if value is not None and value > 0.0 else None
