"""Tool databases of Vectric's programs (``.vtdb``), which are SQLite files.

``tool_geometry`` has the sizes, each row in its own unit; ``tool_cutting_data`` has the tool number, through
``tool_entity``; the name is that of the tree of tools, or a pattern. Angles are between both sides of a cone.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from twin.errors import ToolLibraryError
from twin.tool_library.fields import Fields
from twin.tool_library.quantities import LibraryUnit
from twin.tool_library.raw_tool import RawTool, Size

#: Kinds by the number in ``tool_type``; the angle of a tapered ball is not described, so that it is not used.
_KINDS: dict[object, str] = {
    0: "ball",
    1: "flat",
    2: "bull",
    3: "chamfer mill",
    4: "chamfer mill",
    5: "taper",
    6: "drill",
    7: "thread mill",
    8: "form mill",
    9: "drag knife",
}
_MOST_TOOLS = 20_000
#: Steps of the database after which a query is ended.
_MOST_STEPS = 50_000_000
_STEPS_BETWEEN = 100_000
_NOT_STORED = "shank, holder and helix angle: not stored in this format"


def vectric_tools(data: bytes, path: Path) -> Iterator[RawTool]:
    """The tools of a database.

    Raises:
        ToolLibraryError: a damaged file, or one without the table of tools.
    """
    try:
        rows, names, numbers = _read(data)
    except (sqlite3.Error, OverflowError, UnicodeDecodeError) as error:
        expected = "expected the tool database of a Vectric program"
        raise ToolLibraryError(f"{path}: the SQLite file cannot be used ({error}); {expected}") from error
    for index, row in enumerate(rows):
        key = row.get("id")
        yield _tool(row, names.get(key, ""), numbers.get(key), f"{path}: tool_geometry[{index}]")


def _read(data: bytes) -> tuple[list[dict[str, Any]], dict[Any, str], dict[Any, Any]]:
    """Rows of sizes, names and numbers by the rows' keys."""
    steps = iter(range(_MOST_STEPS // _STEPS_BETWEEN))
    connection = sqlite3.connect(":memory:")
    try:
        connection.deserialize(data)
        connection.set_progress_handler(lambda: next(steps, None) is None, _STEPS_BETWEEN)
        connection.execute("PRAGMA trusted_schema = OFF")
        rows = _rows(connection, "SELECT * FROM tool_geometry")
        names = _rows(connection, "SELECT tool_geometry_id AS id, name FROM tool_tree_entry", optional=True)
        numbers = _rows(
            connection,
            "SELECT e.tool_geometry_id AS id, c.tool_number AS number FROM tool_entity e JOIN tool_cutting_data c "
            "ON c.id = e.tool_cutting_data_id WHERE c.tool_number > 0 ORDER BY c.tool_number DESC",
            optional=True,
        )
    finally:
        connection.close()
    return rows, {r["id"]: r["name"] for r in names}, {r["id"]: r["number"] for r in numbers}


def _rows(connection: sqlite3.Connection, query: str, *, optional: bool = False) -> list[dict[str, Any]]:
    """The rows of a query as columns by name; none where an optional table is missing."""
    try:
        found = connection.execute(f"{query} LIMIT {_MOST_TOOLS}")
        heads = [head[0] for head in found.description]
        return [dict(zip(heads, row, strict=True)) for row in found]
    except sqlite3.OperationalError:
        if optional:
            return []
        raise


def _tool(row: Mapping[str, Any], name: str, number: Any, source: str) -> RawTool:
    unit: LibraryUnit = "inch" if row.get("units") == 1 else "mm"
    fields = Fields({**row, "number": number}, unit)
    fields.length("diameter", "diameter")
    fields.length("flutes", "flute_length")
    number_of_type = row.get("tool_type")
    kind = _KINDS.get(number_of_type, "unknown") if isinstance(number_of_type, int) else "unknown"
    if kind == "bull":
        fields.length("corner", "tip_radius")
    elif kind == "chamfer mill":
        fields.length("tip", "flat_diameter")
        angle = fields.angle("taper", "included_angle")
        if angle is not None:
            fields.sizes["taper"] = Size(0.5 * angle.value, f"half of {angle.text}")
        if "diameter" in fields.sizes:
            fields.sizes["top"] = fields.sizes["diameter"]
    known = kind not in ("drag knife", "unknown")
    return RawTool(
        source=source,
        number=fields.whole("number"),
        name=name if isinstance(name, str) and name.strip() else fields.text("name_format"),
        kind=kind if known else None,
        word=kind,
        sizes=fields.sizes,
        teeth=fields.whole("num_flutes"),
        notes=(_NOT_STORED,),
        warnings=tuple(fields.warnings),
    )
