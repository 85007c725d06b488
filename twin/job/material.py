"""Tables of cutting coefficients that name a material, filled with its values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from twin.errors import MaterialError
from twin.materials import Material, find_material
from twin.materials.library import near_names
from twin.settings.problems import Location, Problem, wrong

_COEFFICIENTS = ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae")
#: Keys that are about the numbers of a row, and do not hold for other numbers.
_CHANGED = (*_COEFFICIENTS, "law", "mt", "mr", "ma")


def with_materials(data: Mapping[str, Any]) -> tuple[dict[str, Any], list[Problem]]:
    """A job's tables with the values of the materials they name, and the names that are unknown.

    A table's own keys win. Where it changes a coefficient without a source of its own, the source reports the change.

    Args:
        data: the tables as in the file, right or wrong.
    """
    filled: dict[str, Any] = dict(data)
    problems: list[Problem] = []
    if "cutting" in filled:
        filled["cutting"] = _filled(filled["cutting"], ("cutting",), problems)
    tools = filled.get("tools")
    if isinstance(tools, list | tuple):
        filled["tools"] = [_with_cutting(tool, ("tools", i), problems) for i, tool in enumerate(tools)]
    return filled, problems


def _with_cutting(tool: Any, location: Location, problems: list[Problem]) -> Any:
    if not isinstance(tool, Mapping) or "cutting" not in tool:
        return tool
    return {**tool, "cutting": _filled(tool["cutting"], (*location, "cutting"), problems)}


def _filled(table: Any, location: Location, problems: list[Problem]) -> Any:
    """One table of coefficients; placeholders where its material is unknown, so that its other keys are checked."""
    name = table.get("material") if isinstance(table, Mapping) else None
    if not isinstance(name, str) or not name.strip():
        return table
    try:
        row = find_material(name)
    except MaterialError:
        problems.append(
            wrong((*location, "material"), name, f"a name of the table (twin materials): {near_names(name)}")
        )
        return {**dict.fromkeys(_COEFFICIENTS, 0.0), **table}
    return {**row.cutting(), **_source(row, table), **table, "material": row.name}


def _source(row: Material, table: Mapping[str, Any]) -> dict[str, str]:
    changed = [key for key in _CHANGED if key in table and table[key] != getattr(row, key)]
    return {"source": f"{row.source}; changed in the job: {', '.join(changed)}"} if changed else {}
