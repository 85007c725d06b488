"""Tools of a job, a mold job or test cuts that name a library, filled with the sizes of its tool."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from twin.errors import ToolLibraryError
from twin.settings.problems import Location, Problem, show

if TYPE_CHECKING:
    from twin.tool_library import LibraryTool, LibraryUnit, ToolLibrary

#: Values of a tool that is not found, so that the other tables are checked.
_PLACEHOLDER = {"number": 1, "kind": "flat", "diameter_mm": 1.0, "teeth": 1, "flute_length_mm": 1.0}


class _Libraries:
    """The libraries of a job, each read once.

    Attributes:
        folder: folder to which their paths are relative.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._read: dict[tuple[str, LibraryUnit], ToolLibrary] = {}

    def read(self, name: str, unit: LibraryUnit) -> ToolLibrary:
        """A library by its path in the job file."""
        # the readers of all formats are loaded only where a job names a library
        from twin.tool_library import read_tool_library

        if (name, unit) not in self._read:
            self._read[name, unit] = read_tool_library(self.folder / name, unit)
        return self._read[name, unit]


def with_library_tools(data: Mapping[str, Any], folder: Path) -> tuple[dict[str, Any], list[Problem]]:
    """A file's tables with the tools of the libraries they name, and what is wrong with these.

    A tool's own keys win.

    Args:
        data: the tables as in the file, right or wrong; tools are in the list ``tools`` or the table ``tool``.
        folder: folder to which the libraries' paths are relative.
    """
    libraries, problems = _Libraries(folder), list[Problem]()
    filled, tools = dict(data), data.get("tools")
    if isinstance(tools, list | tuple):
        filled["tools"] = [_filled(tool, ("tools", i), libraries, problems) for i, tool in enumerate(tools)]
    if "tool" in data:
        filled["tool"] = _filled(data["tool"], ("tool",), libraries, problems)
    return filled, problems


def _filled(table: Any, location: Location, libraries: _Libraries, problems: list[Problem]) -> Any:
    """One tool; a placeholder where the library does not have it."""
    name = table.get("from") if isinstance(table, Mapping) else None
    if not isinstance(name, str | Path) or not str(name).strip():
        return table
    number, own_name = table.get("number"), table.get("name")
    stated = table.get("library_unit")
    unit: LibraryUnit | None = "inch" if stated == "inch" else "mm" if stated in (None, "mm") else None
    wrong_type = (number is not None and type(number) is not int) or not isinstance(own_name, str | None)
    if wrong_type or unit is None:
        return {**_PLACEHOLDER, **table}
    try:
        tool = libraries.read(str(name), unit).find(number, own_name or None)
        keys = _keys(tool, table)
        source = tool.source.removeprefix(f"{libraries.folder}{os.sep}")
    except ToolLibraryError as error:
        problems.append(Problem(location, f".from = {show(str(name))}: {error}"))
        return {**_PLACEHOLDER, **table}
    return {**keys, "origin": f"{source}, {tool.title}", **_assumed(tool, table), **table}


def _keys(tool: LibraryTool, own: Mapping[str, Any]) -> dict[str, Any]:
    """The keys that the library gives.

    Raises:
        ToolLibraryError: a tool that cannot be simulated, and whose kind the job does not give.
    """
    from twin.tool_library.kinds import SIMULATED

    kind = own.get("kind")
    if tool.kind not in SIMULATED and kind is None:
        return tool.as_job_table()
    return tool.job_keys(kind if isinstance(kind, str) else None)


def _assumed(tool: LibraryTool, own: Mapping[str, Any]) -> dict[str, str]:
    """Assumptions on the library's entry, as a caution; empty for none."""
    assumed = [note for note in tool.notes if not note.startswith("helix angle")]
    if tool.helix_deg is None and "helix_deg" not in own:
        assumed.append("helix_deg is not in the library, 0 is used")
    assumed += tool.warnings
    return {"caution": "; ".join(assumed)} if assumed else {}
