"""Libraries of Fusion 360, HSM and Inventor CAM: ``.json``, or ``.tools``, a zip file that holds ``tools.json``.

Each tool has its own unit, which its holder may replace by another one. ``expressions`` are texts with units, and where
one is a plain quantity it is what the user typed: it is taken in place of the value in ``geometry``. TA is half the
angle of a cone in degrees; some programs write radians, which the shaft's diameter shows. Segments of shafts and
holders are listed from the tip upwards. The helix angle is not stored.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from twin.errors import ToolLibraryError
from twin.tool_library.fields import Fields
from twin.tool_library.kinds import kind_of_word
from twin.tool_library.quantities import LibraryUnit, angle_deg, length_mm, unit_named, whole
from twin.tool_library.raw_tool import Frustum, RawTool, Size

#: Names of sizes, their keys in ``geometry``, and the expressions that replace them.
_SIZES = (
    ("diameter", "DC", "tool_diameter"),
    ("corner", "RE", "tool_cornerRadius"),
    ("flutes", "LCF", "tool_fluteLength"),
    ("shoulder", "shoulder-length", "tool_shoulderLength"),
    ("neck", "shoulder-diameter", "tool_shoulderDiameter"),
    ("stickout", "LB", "tool_bodyLength"),
    ("overall", "OAL", "tool_overallLength"),
    ("shank", "SFDM", "tool_shaftDiameter"),
    ("gauge", "assemblyGaugeLength", "tool_assemblyGaugeLength"),
    ("tip", "tip-diameter", "tool_tipDiameter"),
    ("top", "DCX", "tool_maximumCuttingDiameter"),
)
_NOT_STORED = "helix angle: not stored in this format"


def fusion_tools(data: Any, path: Path) -> Iterator[RawTool]:
    """The entries of a library.

    Args:
        data: the value of the JSON file.
        path: the file.

    Raises:
        ToolLibraryError: an entry that is not a tool.
    """
    entries = data["data"] if isinstance(data, Mapping) else data
    for index, entry in enumerate(entries):
        if not isinstance(entry, Mapping):
            raise ToolLibraryError(f"{path}: data[{index}] is not a tool; expected an object with type and geometry")
        yield _tool(entry, f"{path}: data[{index}]")


def _tool(entry: Mapping[str, Any], source: str) -> RawTool:
    notes: list[str] = []
    unit = unit_named(entry.get("unit"))
    if unit is None:
        unit = "mm"
        notes.append("unit: not in the library, taken as mm")
    word = entry.get("type")
    word = word if isinstance(word, str) else ""
    expressions, post = _table(entry, "expressions"), _table(entry, "post-process")
    fields = Fields({**_table(entry, "geometry"), **post}, unit)
    _read_sizes(fields, expressions, notes)
    if _table(entry, "geometry").get("HAND") is False:
        notes.append("left-hand tool: it cuts under M4")
    kind = kind_of_word(word)
    _read_taper(fields, expressions, kind, notes)
    tapered = entry.get("tapered-type")
    _fit_kind(fields, kind, tapered if isinstance(tapered, str) else "", notes)
    holder = entry if kind == "holder" else _table(entry, "holder")
    holder_unit = unit_named(holder.get("unit")) or unit
    return RawTool(
        source=source,
        number=_replaced(fields, expressions, notes),
        name=_text(entry, "description"),
        kind=kind,
        word=word,
        sizes=fields.sizes,
        teeth=fields.whole("NOF"),
        shaft=tuple(_segments(_table(entry, "shaft"), fields, unit)),
        holder=tuple(_segments(holder, fields, holder_unit)),
        holder_name=_text(holder, "description"),
        notes=(*notes, *([_NOT_STORED] if kind != "holder" else [])),
        warnings=tuple(fields.warnings),
    )


def _table(entry: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    value = entry.get(key)
    return value if isinstance(value, Mapping) else {}


def _text(entry: Mapping[str, Any], key: str) -> str:
    value = entry.get(key)
    return value if isinstance(value, str) else ""


def _read_sizes(fields: Fields, expressions: Mapping[str, Any], notes: list[str]) -> None:
    for name, key, expression in _SIZES:
        stored = fields.length(name, key)
        text = expressions.get(expression)
        if not isinstance(text, str):
            continue
        try:
            value = length_mm(text, fields.unit)
        except ValueError:
            continue  # a formula; its value is the one in geometry
        if stored is not None and not math.isclose(value, stored.value, rel_tol=1e-3, abs_tol=1e-6):
            notes.append(f"{stored.text}: the expression {expression} = {text.strip()} is used instead")
        fields.sizes[name] = Size(value, f"{expression} = {text.strip()}")


def _replaced(fields: Fields, expressions: Mapping[str, Any], notes: list[str]) -> int | None:
    """The tool number, from its expression where there is one."""
    stored, text = fields.whole("number"), expressions.get("tool_number")
    try:
        number = whole(text) if isinstance(text, str) else stored
    except ValueError:
        return stored
    if number != stored and stored is not None:
        notes.append(f"number = {stored}: the expression tool_number = {number} is used instead")
    return number


def _read_taper(fields: Fields, expressions: Mapping[str, Any], kind: str | None, notes: list[str]) -> None:
    """The half angle of a cone in degrees."""
    taper, text = fields.angle("taper", "TA"), expressions.get("tool_taperAngle")
    if isinstance(text, str):
        try:
            fields.sizes["taper"] = Size(angle_deg(text), f"tool_taperAngle = {text.strip()}")
        except ValueError:
            pass
        else:
            return
    if taper is None or kind not in ("taper", "face mill") or not 0.0 < taper.value < 0.5 * math.pi:
        return
    diameter, flutes = fields.sizes.get("diameter"), fields.sizes.get("flutes")
    wide = fields.sizes.get("neck") or fields.sizes.get("shank")
    if diameter is None or flutes is None or wide is None or wide.value <= diameter.value:
        return
    as_degrees, as_radians = (
        abs(diameter.value + 2.0 * flutes.value * math.tan(angle) - wide.value)
        for angle in (math.radians(taper.value), taper.value)
    )
    if as_radians < 0.5 * as_degrees:
        degrees = math.degrees(taper.value)
        fields.sizes["taper"] = Size(degrees, f"TA = {taper.value:g} rad")
        notes.append(f"TA = {taper.value:g} taken as radians, {degrees:.4g} deg: the cone then fits {wide.text}")


def _fit_kind(fields: Fields, kind: str | None, tapered: str, notes: list[str]) -> None:
    """Which diameters of a cone the keys mean; only cones have these."""
    sizes = fields.sizes
    if kind == "chamfer mill":
        sizes.pop("top", None)
        sizes.pop("corner", None)
        if "diameter" in sizes:
            sizes["top"] = sizes["diameter"]
        return
    sizes.pop("tip", None)
    if kind != "face mill":
        sizes.pop("top", None)
    diameter, corner = sizes.get("diameter"), sizes.get("corner")
    if kind != "taper" or "ball" not in tapered or diameter is None or corner is None or corner.value <= 0.0:
        return
    if 2.0 * corner.value < diameter.value * (1.0 - 1e-2):
        sizes["tip"], sizes["top"] = Size(2.0 * corner.value, corner.text), diameter
        notes.append(f"tapered ball: {corner.text} is the ball at the tip, {diameter.text} the upper end of the cone")


def _segments(body: Mapping[str, Any], fields: Fields, unit: LibraryUnit) -> Iterator[Frustum]:
    """The segments of a shaft or holder, upwards."""
    segments = body.get("segments")
    for index, segment in enumerate(segments if isinstance(segments, list) else []):
        values = segment if isinstance(segment, Mapping) else {}
        piece = Fields(values, unit)
        sizes = [piece.length(key, key) for key in ("lower-diameter", "upper-diameter", "height")]
        fields.warnings += [f"segment {index + 1}: {warning}" for warning in piece.warnings]
        lower, upper, height = sizes
        if lower is None or upper is None or height is None:
            fields.warnings += [] if piece.warnings else [f"segment {index + 1}: expected height and two diameters"]
        else:
            yield Frustum(lower_mm=lower.value, upper_mm=upper.value, length_mm=height.value)
