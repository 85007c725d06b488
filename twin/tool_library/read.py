"""A tool library from a file of any known format, which is recognised by what the file holds."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from twin.errors import ToolLibraryError
from twin.settings.file_kinds import kind_by_suffix
from twin.tool_library.assemble import assemble, cleaned
from twin.tool_library.file_text import json_of, read_bytes, text_of, unpacked
from twin.tool_library.formats import freecad, job_tables
from twin.tool_library.formats.camotics import is_table, table_tools
from twin.tool_library.formats.fusion import fusion_tools
from twin.tool_library.formats.linuxcnc import is_tool_table, tool_table
from twin.tool_library.formats.plain_csv import csv_tools
from twin.tool_library.formats.vectric import vectric_tools
from twin.tool_library.formats.xml_tools import xml_tools
from twin.tool_library.library import ToolLibrary
from twin.tool_library.library_tool import LibraryTool
from twin.tool_library.quantities import LibraryUnit
from twin.tool_library.raw_tool import RawTool

_ZIP, _SQLITE = b"PK\x03\x04", b"SQLite format 3\0"
#: The heading of a table, where a list of JSON has no word.
_TOML = re.compile(r"\[\[?[A-Za-z_][\w.-]*\]")


def read_tool_library(path: str | PathLike[str], unit: LibraryUnit = "mm") -> ToolLibrary:
    """Read the tools of a library: Fusion 360, FreeCAD, LinuxCNC, CAMotics, Vectric, DIN 4000, Creo, CSV, or TOML.

    Args:
        path: the file.
        unit: unit of lengths in files that state none: ``mm`` or ``inch``.

    Returns:
        Its tools in the terms of the job file, with notes on what was assumed and warnings for values that cannot be
        right.

    Raises:
        ToolLibraryError: the file cannot be read, is not a tool library, is damaged, or has no tools.

    Example:
        >>> for tool in twin.read_tool_library("shop.tools").tools:
        ...     print(tool.number, tool.name, tool.kind, tool.diameter_mm, tool.obstacle)
    """
    path = Path(path)
    other = kind_by_suffix(path)
    if other is not None and path.is_file():
        raise ToolLibraryError(f"{path}: is not a tool library but {other}")
    form, tools = _read(read_bytes(path), path, unit)
    if not tools:
        raise ToolLibraryError(f"{path}: the {form} library has no tools; expected at least one")
    return ToolLibrary(path=path, format=form, tools=tuple(tools))


def _read(data: bytes, path: Path, unit: LibraryUnit) -> tuple[str, list[LibraryTool]]:
    """Format and tools of a file."""
    if data.startswith(_ZIP):
        return _json_tools(json_of(unpacked(data, path), path), path)
    if data.startswith(_SQLITE):
        return "Vectric", _assembled(vectric_tools(data, path))
    start = text_of(data[:400], path, legacy=True).lstrip("\ufeff \t\r\n")
    if start[:1] in ("{", "[") and not _TOML.match(start):
        return _json_tools(json_of(data, path), path)
    if start.startswith("<"):
        form, raw = xml_tools(data, path)
        return form, _assembled(raw)
    text = text_of(data, path, legacy=True)
    if job_tables.has_tables(text):
        return "TOML", [*job_tables.table_tools(text, path)]
    if is_tool_table(text):
        return "LinuxCNC", _assembled(tool_table(text, path, unit))
    return "CSV", [*csv_tools(text, path, unit)]


def _json_tools(data: Any, path: Path) -> tuple[str, list[LibraryTool]]:
    if isinstance(data, Mapping):
        tools = data.get("tools")
        if isinstance(data.get("data"), list):
            return "Fusion 360", _assembled(fusion_tools(data, path))
        if isinstance(tools, list):
            return "FreeCAD", _assembled(freecad.library_tools(data, path))
        if freecad.is_bit(data):
            return "FreeCAD", _assembled([freecad.bit_tool(data, path, None)])
        if isinstance(data.get("profile"), list):
            return "FreeCAD", _assembled([freecad.holder_tool(data, path)])
        table: Mapping[str, Any] = tools if isinstance(tools, Mapping) else data
        if is_table(table):
            return "CAMotics", _assembled(table_tools(table, path))
    elif isinstance(data, list) and data and isinstance(data[0], Mapping) and "geometry" in data[0]:
        return "Fusion 360", _assembled(fusion_tools(data, path))
    held = f"with {', '.join(cleaned(key) for key in [*data][:4])}" if isinstance(data, Mapping) else ""
    raise ToolLibraryError(
        f"{path}: JSON {held or 'without tools'} is not a tool library; expected one of Fusion 360, FreeCAD or CAMotics"
    )


def _assembled(raw: Iterable[RawTool]) -> list[LibraryTool]:
    return [assemble(tool) for tool in raw]
