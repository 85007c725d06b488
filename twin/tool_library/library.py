"""A tool library, and one tool picked from it by number or name."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from twin.errors import ToolLibraryError
from twin.tool_library.library_tool import LibraryTool
from twin.tool_library.quantities import LibraryUnit

__all__ = ["LibraryUnit", "ToolLibrary"]

#: Most tools named in a message.
_NAMED = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolLibrary:
    """The tools of a library file.

    Attributes:
        path: the file.
        format: its format, e.g. ``Fusion 360``.
        tools: its tools in the file's order, those that cannot be simulated too.
        notes: what was assumed of the file as a whole.

    Example:
        >>> library = twin.read_tool_library("shop.tools")
        >>> library.find(number=3).as_job_table()
    """

    path: Path
    format: str
    tools: tuple[LibraryTool, ...]
    notes: tuple[str, ...] = ()

    @property
    def shared_numbers(self) -> dict[int, tuple[LibraryTool, ...]]:
        """Numbers that several different tools have, with these."""
        numbers: dict[int, list[LibraryTool]] = {}
        for tool in self.tools:
            if tool.number is not None and tool not in numbers.setdefault(tool.number, []):
                numbers[tool.number].append(tool)
        return {number: tuple(tools) for number, tools in numbers.items() if len(tools) > 1}

    def find(self, number: int | None = None, name: str | None = None) -> LibraryTool:
        """The tool of a number, or of a name.

        With both, the name picks the tool; the number only decides between tools of one name. Upper and lower case are
        alike where no name is equal.

        Raises:
            ToolLibraryError: no such tool, or several; the message has the nearest names, or all of them.
        """
        if number is None and name is None:
            raise ToolLibraryError(f"{self.path}: neither number nor name of a tool is given; expected one of them")
        found = self._numbered(number) if name is None else self._named(name)
        if name is not None and len(found) > 1 and number is not None:
            found = [tool for tool in found if tool.number == number] or found
        if len(found) > 1 and any(tool != found[0] for tool in found):
            raise ToolLibraryError(self._several(number, name, found))
        return found[0]

    def _numbered(self, number: int | None) -> list[LibraryTool]:
        found = [tool for tool in self.tools if tool.number == number]
        if not found:
            numbers = sorted({tool.number for tool in self.tools if tool.number is not None})
            expected = f"one of {_listed(map(str, numbers))}" if numbers else "a name: its tools have no numbers"
            raise ToolLibraryError(f"{self.path}: no tool has the number {number}; expected {expected}")
        return found

    def _named(self, name: str) -> list[LibraryTool]:
        found = [tool for tool in self.tools if tool.name == name]
        found = found or [tool for tool in self.tools if tool.name.casefold() == name.casefold()]
        if not found:
            names = [tool.name for tool in self.tools if tool.name]
            near = difflib.get_close_matches(name, names, n=3, cutoff=0.4)
            hint = f"did you mean {' or '.join(map(_quoted, near))}?" if near else f"expected one of {_names(names)}"
            raise ToolLibraryError(f"{self.path}: no tool has the name {_quoted(name)}; {hint}")
        return found

    def _several(self, number: int | None, name: str | None, found: Sequence[LibraryTool]) -> str:
        if name is None:
            names = _listed(_quoted(tool.name) for tool in found)
            return f"{self.path}: {len(found)} tools have the number {number}: {names}; expected the name of one"
        numbers = _listed("none" if tool.number is None else str(tool.number) for tool in found)
        what = f"{len(found)} tools have the name {_quoted(name)}"
        return f"{self.path}: {what}, with the numbers {numbers}; expected the number of one"


def _quoted(name: str) -> str:
    return f'"{name}"'


def _names(names: Sequence[str]) -> str:
    return _listed(map(_quoted, names)) if names else "a number: its tools have no names"


def _listed(texts: object) -> str:
    """The first few of many texts."""
    items = list(texts)  # type: ignore[call-overload]
    more = f" and {len(items) - _NAMED} more" if len(items) > _NAMED else ""
    return ", ".join(items[:_NAMED]) + more
