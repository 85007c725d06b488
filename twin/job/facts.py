"""Values of a settings file that can be trusted although it has mistakes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from twin.settings.problems import Location


class Facts:
    """Values of a job file by location; those with a mistake in them are as if they were absent.

    Args:
        data: the file's tables.
        mistakes: their locations.
        default: value of a key that is not given, None where there is none.
    """

    def __init__(
        self, data: Mapping[str, Any], mistakes: Iterable[Location], default: Callable[[Location], Any]
    ) -> None:
        self._data = data
        self._mistakes = frozenset(mistakes)
        self._default = default

    def get(self, *location: str | int) -> Any:
        """The value at a location, its default when it is not given, None without either."""
        if self.doubtful(*location):
            return None
        if not self.given(*location):
            return self._default(location)
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

    def tools(self) -> Iterator[ToolFacts]:
        """The tools one by one."""
        for index in range(self.count("tools")):
            yield ToolFacts(self, index)


class ToolFacts:
    """The values of one tool.

    Attributes:
        number: its number, None where that is wrong.
    """

    def __init__(self, facts: Facts, index: int) -> None:
        self._facts = facts
        self._index = index
        self.number: int | None = self.get("number")

    def at(self, *keys: str | int) -> Location:
        """Location of a key of this tool."""
        return ("tools", self._index, *keys)

    def get(self, *keys: str | int) -> Any:
        """See `Facts.get`."""
        return self._facts.get(*self.at(*keys))

    def given(self, *keys: str | int) -> bool:
        """See `Facts.given`."""
        return self._facts.given(*self.at(*keys))
