"""Numbers beyond any quantity of a machine: squares and products of several of them would not be numbers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import annotated_types as at
from pydantic import BaseModel

from twin.settings.problems import Location, Problem, declared, wrong

_LARGEST = 1e9
#: Least value of a quantity that is above 0: mm, deg, s, Hz, rpm.
_LEAST = 1e-9


def numbers_in(data: object) -> Iterator[tuple[Location, float]]:
    """Every number in tables and lists, with its location."""
    todo: list[tuple[Location, Any]] = [((), data)]
    while todo:
        location, value = todo.pop()
        if isinstance(value, Mapping):
            todo += [((*location, key), inner) for key, inner in reversed(list(value.items()))]
        elif isinstance(value, Sequence) and not isinstance(value, str):
            todo += [((*location, i), inner) for i, inner in reversed(list(enumerate(value)))]
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            yield location, value


def extremes(numbers: Iterable[tuple[Location, float]], model: type[BaseModel]) -> Iterator[Problem]:
    """Numbers that are too large, or too small where only positive ones make sense.

    Args:
        numbers: with their locations.
        model: which declares these locations.
    """
    for location, value in numbers:
        if abs(value) > _LARGEST:
            yield wrong(location, value, f"at most {_LARGEST:g} in magnitude")
        elif 0.0 < value < _LEAST and _is_positive(location, model):
            yield wrong(location, value, f"at least {_LEAST:g}")


def _is_positive(location: Location, model: type[BaseModel]) -> bool:
    _, field = declared(location, model)
    return field is not None and any(isinstance(note, at.Gt) and note.gt == 0 for note in field.metadata)
