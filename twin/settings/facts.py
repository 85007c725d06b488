"""Values of a settings file that can be trusted although it has mistakes."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any, get_args

from pydantic import BaseModel

from twin.settings.extremes import extremes, numbers_in
from twin.settings.keys import fields_of
from twin.settings.problems import Location, Problem


class Facts:
    """Values of a job file by location; those with a mistake in them are as if they were absent.

    Args:
        data: the file's tables.
        mistakes: their locations.
        model: the file's table, for defaults.
        no_default: locations whose default is only a placeholder.
    """

    def __init__(
        self,
        data: Mapping[str, Any],
        mistakes: Iterable[Location],
        model: type[BaseModel],
        no_default: Collection[Location] = (),
    ) -> None:
        self._data = data
        self._mistakes = frozenset(mistakes)
        self._model = model
        self._no_default = no_default

    def get(self, *location: str | int) -> Any:
        """The value at a location, its default when it is not given, None without either."""
        if self.doubtful(*location):
            return None
        if not self.given(*location):
            return None if location in self._no_default else default_of(self._model, location)
        value: Any = self._data
        for key in location:
            value = value[key]
        return value

    def given(self, *location: str | int) -> bool:
        """Whether a location is in the file, right or wrong."""
        value: Any = self._data
        for key in location:
            if isinstance(key, int):
                if not isinstance(value, Sequence) or isinstance(value, str) or key >= len(value):
                    return False
            elif not isinstance(value, Mapping) or key not in value:
                return False
            value = value[key]
        return True

    def numbers(self) -> Iterator[tuple[Location, float]]:
        """Every number in the file that is not in a mistake, with its location."""
        return (found for found in numbers_in(self._data) if not self.wrong(*found[0]))

    def extremes(self) -> Iterator[Problem]:
        """Numbers beyond any quantity of a machine."""
        return extremes(self.numbers(), self._model)

    def wrong(self, *location: str | int) -> bool:
        """Whether a mistake is at a location or above it."""
        return any(location[:n] in self._mistakes for n in range(len(location) + 1))

    def doubtful(self, *location: str | int) -> bool:
        """Whether a mistake is at a location, above it or below it."""
        return self.wrong(*location) or any(place[: len(location)] == location for place in self._mistakes)

    def count(self, *location: str | int) -> int:
        """Length of a list, 0 where there is none."""
        n = 0
        while self.given(*location, n):
            n += 1
        return n


def default_of(model: type[BaseModel], location: Location) -> Any:
    """Value of a key that is not given; None where it has no default."""
    table = model
    for key in location[:-1]:
        if isinstance(key, int):
            continue
        fields = fields_of(table)
        annotation = fields[key].annotation if key in fields else None
        inner = next((a for a in (annotation, *get_args(annotation)) if _is_table(a)), None)
        if inner is None:
            return None
        table = inner
    field = fields_of(table).get(str(location[-1]))
    return None if field is None or field.is_required() or field.default_factory else field.default


def _is_table(annotation: Any) -> bool:
    return isinstance(annotation, type) and issubclass(annotation, BaseModel)
