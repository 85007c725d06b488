"""Settings of a machine as TOML: any field of `gcode.settings.MachineSettings`, lengths in mm.

decimal_point = "increment"
home_mm = [0, 0, 250]

[offsets]
G54 = [100, 50, -200]
"G54.1 P7" = [0, 0, 0]

[tools.1]
length_mm = 120.5
diameter_mm = 10

[variables]
500 = 1.5
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from types import MappingProxyType
from typing import Any

from gcode.events import Point
from gcode.settings import ALL_OFFSETS, Limits, MachineSettings, ToolOffset
from gcode.tables.text_file import read_text
from gcode.tables.toml_document import Node, load_document

_ADDITIONAL = re.compile(r"(G54\.1)\s*(P\d+)")


def read_settings(path: Path | str) -> MachineSettings:
    """Reads the settings of a machine.

    Args:
        path: a ``.toml`` file. Folders in its ``search_path`` are relative to its own.

    Raises:
        GcodeError: for a file that cannot be read, a text that is not TOML (``settings-syntax``), an unknown key
            (``settings-key``), and a value that is not as expected (``settings-value``).
    """
    path = Path(path)
    top = load_document(path, read_text(path, (".toml",)))
    values = {key: _FIELDS[key](node) for key, node in top.known(_FIELDS)}
    if "search_path" in values:
        values["search_path"] = tuple(path.parent / folder for folder in values["search_path"])
    return MachineSettings(**values)


def tools_of(top: Node, *, only: bool = False) -> dict[int, ToolOffset]:
    """The tools of a document, by number.

    Args:
        only: refuse any other key.
    """
    nodes = dict(top.known(("tools",)) if only else top.table())
    return _tools(nodes["tools"]) if "tools" in nodes else {}


def _tools(node: Node) -> dict[int, ToolOffset]:
    return {number: _tool(tool) for number, tool in node.numbered("tool number")}


def _tool(node: Node) -> ToolOffset:
    nodes = dict(node.known((*_TOOL_FIELDS, *_DIAMETERS)))
    values: dict[str, Any] = {key: _TOOL_FIELDS[key](nodes[key]) for key in nodes if key not in _DIAMETERS}
    for diameter, radius in _DIAMETERS.items():
        if diameter in nodes:
            if radius in nodes:
                raise nodes[diameter].error(
                    f"{diameter} together with {radius} in {node.name}", "one of them", at_key=True
                )
            values[radius] = nodes[diameter].number() / 2.0
    return ToolOffset(**values)


def _offset_name(key: str, node: Node) -> str:
    """A work offset's name as `MachineSettings.offsets` has it."""
    name = _ADDITIONAL.sub(r"\1 \2", key.strip().upper())
    if name not in ALL_OFFSETS:
        expected = f"G54 to G59, G59.1 to G59.3, or {ALL_OFFSETS[-1].replace(' P', ' P1 to P')}"
        raise node.error(f"{key!r} is not a work offset", expected, at_key=True)
    return name


def _by_offset(node: Node, read: Callable[[Node], Any]) -> dict[str, Any]:
    named: dict[str, Any] = {}
    for key, value in node.table():
        name = _offset_name(key, value)
        if name in named:
            raise value.error(f"{name} is given twice in {node.name}", "each work offset once", at_key=True)
        named[name] = read(value)
    return named


def _wcs(node: Node) -> str:
    return _offset_name(node.text(), node)


def _offsets(node: Node) -> dict[str, Point]:
    return _by_offset(node, Node.point)


def _rotations(node: Node) -> dict[str, float]:
    return _by_offset(node, Node.number)


def _reference_points(node: Node) -> dict[int, Point]:
    return {number: point.point() for number, point in node.numbered("number of a reference point after the first", 2)}


def _variables(node: Node) -> dict[int, float]:
    return {number: value.number() for number, value in node.numbered("variable", 1)}


def _m_codes(node: Node) -> dict[int, str]:
    return {number: value.text("none") for number, value in node.numbered("M code", 0)}


def _limits(node: Node) -> Limits:
    return Limits(**{key: value.whole(1) for key, value in node.known(f.name for f in fields(Limits))})


def _tolerance(node: Node) -> float:
    if node.number() < 0.0:
        raise node.error(f"{node.name} is {node.value}", "a length of 0 or more, mm")
    return node.number()


def _choice(*allowed: str) -> Callable[[Node], str]:
    return lambda node: node.text(*allowed)


#: Reader of each field of `ToolOffset`.
_TOOL_FIELDS: Mapping[str, Callable[[Node], Any]] = MappingProxyType(
    {
        **{f.name: Node.number for f in fields(ToolOffset) if f.name.endswith("_mm")},
        "pocket": Node.whole,
        "orientation": Node.whole,
        "comment": Node.text,
    }
)
#: Diameters may replace radii.
_DIAMETERS: Mapping[str, str] = MappingProxyType({"diameter_mm": "radius_mm", "diameter_wear_mm": "radius_wear_mm"})

#: Reader of each field of `MachineSettings`.
_FIELDS: Mapping[str, Callable[[Node], Any]] = MappingProxyType(
    {
        "offsets": _offsets,
        "rotations_deg": _rotations,
        "wcs": _wcs,
        "shift_mm": Node.point,
        "external_offset_mm": Node.point,
        "home_mm": Node.point,
        "reference_points_mm": _reference_points,
        "start_mm": Node.point,
        "tools": _tools,
        "tool": Node.whole,
        "variables": _variables,
        "search_path": Node.texts,
        "arc_tolerance_mm": _tolerance,
        "arc_centres": _choice("incremental", "absolute"),
        "block_delete": Node.flag,
        "optional_stop": Node.flag,
        "units": _choice("mm", "inch"),
        "g70_units": Node.flag,
        "machine_units": _choice("mm", "inch"),
        "decimal_point": _choice("calculator", "increment"),
        "compensation_startup": _choice("A", "B"),
        "m_codes": _m_codes,
        "limits": _limits,
    }
)
