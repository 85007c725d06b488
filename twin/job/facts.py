"""Values of the tools in a job file that can be trusted although it has mistakes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from twin.settings.facts import Facts
from twin.settings.problems import Location


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


def tools_of(facts: Facts) -> Iterator[ToolFacts]:
    """The tools one by one."""
    for index in range(facts.count("tools")):
        yield ToolFacts(facts, index)
