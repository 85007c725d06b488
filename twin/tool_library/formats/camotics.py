"""Tool tables of CAMotics: ``.ctbl``, ``.json``, or the table in a project.

Tools are by number; each has its own unit. ``length`` is that of the cutting part. A cone (``conical``) ends in a
point, a ``snubnose`` in a flat tip; both reach ``diameter`` at ``length``. Flutes are not stored.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from twin.errors import ToolLibraryError
from twin.tool_library.fields import Fields
from twin.tool_library.kinds import kind_of_word
from twin.tool_library.quantities import unit_named
from twin.tool_library.raw_tool import RawTool, Size


def is_table(data: Any) -> bool:
    """Whether a JSON value is a table of tools by number."""
    return (
        isinstance(data, Mapping)
        and bool(data)
        and all(isinstance(v, Mapping) and ("shape" in v or "diameter" in v) for v in data.values())
    )


def table_tools(data: Mapping[str, Any], path: Path) -> Iterator[RawTool]:
    """The tools of a table.

    Raises:
        ToolLibraryError: an entry that is not a tool, or a key that is not a number.
    """
    for number, entry in data.items():
        source = f"{path}: tool {number!r}"
        if not number.isdecimal() or len(number) > 9:
            raise ToolLibraryError(f"{source}: expected a whole number in place of the name")
        unit = unit_named(entry.get("units")) or "mm"
        fields = Fields(entry, unit)
        word = fields.text("shape") or "cylindrical"
        diameter, length = fields.length("diameter", "diameter"), fields.length("flutes", "length")
        tip = fields.length("tip", "snub_diameter")
        kind = kind_of_word(word)
        if kind == "chamfer mill" and diameter is not None and length is not None and length.value > 0.0:
            fields.sizes["top"] = diameter
            rise = 0.5 * (diameter.value - (tip.value if tip is not None else 0.0))
            angle = math.degrees(math.atan2(rise, length.value))
            fields.sizes["taper"] = Size(angle, f"half angle of the cone = {angle:.4g} deg")
        yield RawTool(
            source=source,
            number=int(number),
            name=fields.text("description"),
            kind=kind,
            word=word,
            sizes=fields.sizes,
            notes=("flutes and helix angle: not stored in this format",),
            warnings=tuple(fields.warnings),
        )
