"""Tools in job files, and in files of tables ``[[tools]]`` such as ``twin tools -o tools.toml`` writes.

A tool that names a library itself is listed with the sizes that are given with it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from twin.errors import SettingsError, ToolLibraryError
from twin.settings.toml_file import parse_toml
from twin.tool_library.assemble import assemble
from twin.tool_library.fields import Fields
from twin.tool_library.kinds import kind_of_word
from twin.tool_library.library_tool import LibraryTool, ToolCylinder
from twin.tool_library.raw_tool import RawTool

_TABLES = re.compile(r"^\s*\[\[\s*tools\s*\]\]", re.MULTILINE)
_LARGEST_MM = 1e5


def has_tables(text: str) -> bool:
    """Whether a text has tables of tools."""
    return _TABLES.search(text) is not None


def table_tools(text: str, path: Path) -> Iterator[LibraryTool]:
    """The tools of a TOML text.

    Raises:
        ToolLibraryError: not TOML.
    """
    try:
        tables = parse_toml(text, str(path)).get("tools")
    except SettingsError as error:
        raise ToolLibraryError(str(error)) from error
    for index, table in enumerate(tables if isinstance(tables, list) else []):
        if isinstance(table, Mapping):
            yield _tool(table, f"{path}: tools[{index}]")


def _tool(table: Mapping[str, Any], source: str) -> LibraryTool:
    fields = Fields(table, "mm")
    for name, key in (("diameter", "diameter_mm"), ("corner", "corner_radius_mm"), ("flutes", "flute_length_mm")):
        fields.length(name, key)
    gauge = fields.length("gauge", "length_mm")
    if gauge is not None and gauge.value == 0.0:
        del fields.sizes["gauge"]
    fields.angle("taper", "taper_deg")
    fields.angle("helix", "helix_deg")
    word = fields.text("kind")
    shank = [*_cylinders([table["shank"]], "shank", fields.warnings)] if "shank" in table else []
    holder = [*_cylinders(table.get("holder"), "holder", fields.warnings)]
    notes = ("the library that it names is not read",) if "from" in table else ()
    tool = assemble(
        RawTool(
            source=source,
            number=fields.whole("number"),
            name=fields.text("name"),
            kind=kind_of_word(word),
            word=word,
            sizes=fields.sizes,
            teeth=fields.whole("teeth"),
            notes=notes,
            warnings=tuple(fields.warnings),
        )
    )
    return replace(tool, shank=shank[0] if shank else None, holder=tuple(holder))


def _cylinders(tables: Any, what: str, warnings: list[str]) -> Iterator[ToolCylinder]:
    """The cylinders of a shank or holder; those that are none are left out with a warning."""
    for index, table in enumerate(tables if isinstance(tables, list) else []):
        piece = Fields(table if isinstance(table, Mapping) else {}, "mm")
        diameter, length = piece.length("diameter", "diameter_mm"), piece.length("length", "length_mm")
        if diameter and length and 0.0 < diameter.value <= _LARGEST_MM and 0.0 < length.value <= _LARGEST_MM:
            yield ToolCylinder(diameter_mm=diameter.value, length_mm=length.value)
        else:
            warnings.append(f"{what}[{index}]: expected diameter_mm and length_mm above 0")
