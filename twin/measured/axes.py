"""The axis map: which column of a log, with which sign, is the force along each machine axis."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TypeAlias

from twin.errors import MeasuredError
from twin.measured.log import AXES
from twin.measured.table import few
from twin.measured.units import split_unit

#: Factor and column.
Term: TypeAlias = tuple[float, str]

_SCALE = re.compile(r"^(\d+(?:\.\d*)?(?:[eE][+-]?\d+)?|\.\d+)\s*\*\s*")
_EXAMPLE = "x=-Fy,y=-Fx,z=Fz"
_FORCE_NAMES = tuple(
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        r"(?:^|[\s_./:-])f[\s_.-]*{axis}(?:$|[\s_./:(\d-])",
        r"(?:force|kraft|load|kraefte|kräfte|fuerza|effort)[\s_.:-]*{axis}(?:$|[\s_./:-])",
        r"(?:^|[\s_./:-]){axis}[\s_.:-]*(?:axis)?[\s_.:-]*(?:force|kraft|load|effort)",
        r"^{axis}$",
    )
)
_VECTOR = re.compile(
    r"(?P<base>(?:.*[/.])?(?:f|forces?|kraft|kr(?:ä|ae)fte|loads?))[\[{(](?P<index>\d+)[\]})]$", re.IGNORECASE
)
_NOT_MEASURED = re.compile(r"(?:^|[\s_.(-])(?:sim|simul|model|pred|calc|comp|theor|fit|est)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class AxisMap:
    """Terms for each axis, e.g. ``x=-Fy,y=-Fx,z=Fz``.

    A term is a sign, perhaps a factor (``2.5*Fx``, for a channel whose sensitivity is known), and a column: its name in
    the file with or without the unit, in any case, or ``#3`` for the third one. Sums are allowed: ``x=Fx12+Fx34``. An
    axis that is omitted is not measured.

    Attributes:
        entries: axis and the text of its sum, in the order x, y, z.
    """

    entries: tuple[tuple[str, str], ...]

    @classmethod
    def parse(cls, text: str) -> AxisMap:
        """A map from its text.

        Raises:
            MeasuredError: not a map: the message names the wrong part.
        """
        found: dict[str, str] = {}
        for part in _parts(text):
            axis, equals, column = (p.strip() for p in part.partition("="))
            axis = axis.lower().removeprefix("f")
            if not equals or axis not in AXES or not column.strip("+- "):
                raise MeasuredError(
                    f"axis map {text!r}: {part.strip()!r} is not axis = column, expected e.g. {_EXAMPLE}"
                )
            if axis in found:
                raise MeasuredError(f"axis map {text!r}: {axis} is given twice, expected e.g. {_EXAMPLE}")
            found[axis] = column
        if not found:
            raise MeasuredError(f"axis map {text!r} is empty, expected e.g. {_EXAMPLE}")
        return cls(tuple((axis, found[axis]) for axis in AXES if axis in found))

    def __str__(self) -> str:
        return ",".join(f"{axis}={column}" for axis, column in self.entries)

    @property
    def left_handed(self) -> bool:
        """Whether the map mirrors the log's axes: no position of a dynamometer does, only a wrong sign or column.

        Known of maps with one column for each axis, named after the axes, or as ``#2`` in their order.
        """
        columns = [text.lstrip("+- ") for _, text in self.entries]
        if len(columns) != len(AXES):
            return False
        order = _axes_of([_SCALE.sub("", column) for column in columns])
        if order is None:
            return False
        swaps = sum(a > b for a, b in combinations(order, 2))
        signs = sum(text.startswith("-") for _, text in self.entries)
        return (swaps + signs) % 2 == 1

    def terms(self, names: Mapping[str, str]) -> dict[str, tuple[Term, ...]]:
        """Factors and columns for each axis.

        Args:
            names: columns by all of their names, see `aliases`.

        Raises:
            MeasuredError: an unknown column.
        """
        made = {}
        for axis, text in self.entries:
            found = _sum(text, names)
            if found is None:
                known = few(list(dict.fromkeys(names.values())))
                raise MeasuredError(f"axis map {str(self)!r}: no column {text.lstrip('+-')!r}; columns are {known}")
            made[axis] = found
        return made


def mirrored(axis_map: AxisMap | None, force_on: str) -> Iterator[str]:
    """A warning where a map mirrors the axes of a force on the workpiece.

    A map to the force on the tool may: it has the signs of the reaction.
    """
    if axis_map is not None and axis_map.left_handed and force_on == "workpiece":
        yield (
            f"the axis map {axis_map} mirrors the log's axes, which no position of a dynamometer does: check its signs "
            "and columns, or omit force_on if the signs are those of the force on the tool"
        )


def _axes_of(columns: Sequence[str]) -> tuple[int, ...] | None:
    """The axis, 0 to 2, that each of three columns is named after; None where that is not known."""
    if all(re.fullmatch(r"#\d+", column) for column in columns):
        numbers = [int(column[1:]) for column in columns]
        order = tuple(sorted(numbers).index(number) for number in numbers)
    else:
        named = [[k for k, a in enumerate(AXES) if any(_matches(p, a, c) for p in _FORCE_NAMES)] for c in columns]
        order = tuple(axes[0] for axes in named if len(axes) == 1)
    return order if sorted(order) == list(range(len(AXES))) else None


def aliases(columns: Iterable[str]) -> dict[str, str]:
    """Columns by their names, lower-case names, names without unit, and numbers; what is not unique is omitted."""
    names = list(columns)
    made: dict[str, str] = {}
    bases = [split_unit(n)[0] for n in names]
    for keys in (names, bases, list(map(_key, names)), list(map(_key, bases))):
        counts = Counter(keys)
        for name, key in zip(names, keys, strict=True):
            if counts[key] == 1:
                made.setdefault(key, name)
    for index, name in enumerate(names):
        made.setdefault(f"#{index + 1}", name)
    return made


def guess_map(columns: Iterable[str]) -> AxisMap | None:
    """The map that follows from the names, ``x=Fx,y=Fy,z=Fz``; None where none follows, or more than one.

    Where measured and computed forces stand side by side, those that are named as computed are omitted.
    """
    names = list(columns)
    for among in (names, [n for n in names if not _NOT_MEASURED.search(n)]):
        for patterns in (*((p,) for p in _FORCE_NAMES), _FORCE_NAMES[:-1]):
            found = {axis: [n for n in among if any(_matches(p, axis, n) for p in patterns)] for axis in AXES}
            if all(len(found[axis]) == 1 for axis in AXES):
                return AxisMap(tuple((axis, found[axis][0]) for axis in AXES))
    return _vector(names)


def _vector(names: list[str]) -> AxisMap | None:
    """The three elements of the only vector of forces, in their order: ``F[1]``, ``F[2]``, ``F[3]``."""
    vectors: dict[str, dict[str, str]] = {}
    for name in names:
        if found := _VECTOR.match(name):
            vectors.setdefault(found["base"], {})[found["index"]] = name
    whole = [v for v in vectors.values() if sorted(v) == ["1", "2", "3"]]
    if len(vectors) != 1 or not whole:
        return None
    return AxisMap(tuple((axis, whole[0][str(k)]) for k, axis in enumerate(AXES, 1)))


def _matches(pattern: re.Pattern[str], axis: str, name: str) -> bool:
    base, _ = split_unit(name)
    return re.search(pattern.pattern.replace("{axis}", axis), base, re.IGNORECASE) is not None


def _parts(text: str) -> list[str]:
    """The map's parts: a comma or semicolon ends one where an axis follows."""
    return [p for p in re.split(r"[,;\s]+(?=[fF]?[xyzXYZ]\s*=)", text.strip().strip(",;")) if p.strip()]


def _key(text: str) -> str:
    return re.sub(r"\s+", " ", text.strip().lower())


def _sum(text: str, names: Mapping[str, str]) -> tuple[Term, ...] | None:
    """A sum's terms; names may hold + and - themselves, so the longest first column that is known is taken."""
    text = text.strip()
    sign = -1.0 if text.startswith("-") else 1.0
    rest = text.lstrip("+-").strip() if text[:1] in "+-" else text
    if scale := _SCALE.match(rest):
        sign, rest = sign * float(scale[1]), rest[scale.end() :]
    for end in [len(rest), *(i for i in range(len(rest) - 1, 0, -1) if rest[i] in "+-")]:
        column = names.get(rest[:end].strip()) or names.get(_key(rest[:end]))
        if column is None:
            continue
        if end == len(rest):
            return ((sign, column),)
        if (others := _sum(rest[end:], names)) is not None:
            return ((sign, column), *others)
    return None
