"""Tools as XML: manufacturers' data by DIN 4000, and the libraries of Creo.

DIN 4000-82 (milling cutters): A1 diameter, A5 neck diameter, B2 (or B6) flute length, B3 length to the shank, B5
overall length, C3 shank diameter, F21 teeth, F3 and F4 direction and angle of the helix, G1 corner radius; decimal
commas. Meanings were compared with data of several manufacturers; other parts of the standard are listed only.

Creo: a cutter of seven parameters; ``ECorner`` is the distance of the corner's centre from the axis.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree

from twin.errors import ToolLibraryError
from twin.tool_library.fields import Fields
from twin.tool_library.kinds import kind_of_word
from twin.tool_library.quantities import unit_named
from twin.tool_library.raw_tool import RawTool, Size

#: Kinds of DIN 4000-82 by the number of the figure.
_FIGURES = dict(
    zip(
        ("1", "2", "3", "4", "5", "6", "8", "10", "12"),
        (
            "flat",
            "flat",
            "chamfer mill",
            "dovetail mill",
            "slot mill",
            "ball",
            "radius mill",
            "thread mill",
            "thread mill",
        ),
        strict=True,
    )
)
#: Kinds by the part of the standard.
_PARTS = {"DIN4000-80": "tap", "DIN4000-81": "drill", "DIN4000-88": "reamer"}
#: Largest file, bytes.
_LARGEST = 16_000_000
_NOT_MODELLED = ("Alpha", "Beta")


def xml_tools(data: bytes, path: Path) -> tuple[str, list[RawTool]]:
    """Format and tools of an XML file.

    Raises:
        ToolLibraryError: not XML, or not a tool library.
    """
    if len(data) > _LARGEST:
        raise ToolLibraryError(f"{path}: XML of more than {_LARGEST // 1_000_000} MB; expected a tool library")
    try:
        root = ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError, LookupError, RecursionError) as error:
        raise ToolLibraryError(f"{path}: not valid XML: {error}; the file is damaged or not a library") from error
    if root.tag == "Tool-Data":
        return "DIN 4000", [*_din_tools(root, path)]
    if root.tag == "ToolLibrary":
        return "Creo", [*_apt_tools(root, path)]
    expected = "expected Tool-Data (DIN 4000) or ToolLibrary (Creo)"
    raise ToolLibraryError(f"{path}: XML of the kind {root.tag[:60]!r} is not a tool library; {expected}")


def _din_tools(root: ElementTree.Element, path: Path) -> Iterator[RawTool]:
    for index, tool in enumerate(root.iter("Tool")):
        values: dict[str, str] = {}
        for item in tool.iter():
            name, value = item.find("PropertyName"), item.find("Value")
            if name is not None and name.text and value is not None and value.text:
                values.setdefault(name.text.strip(), value.text.strip())
        yield _din_tool(values, f"{path}: Tool[{index}]")


def _din_tool(values: Mapping[str, str], source: str) -> RawTool:
    fields = Fields(values, "mm")
    part, figure = values.get("NSM", ""), values.get("BLD", "")
    kind = _FIGURES.get(figure) if part == "DIN4000-82" else _PARTS.get(part)
    fields.length("diameter", "A1", "A11")
    fields.length("neck", "A5")
    fields.length("flutes", "B2", "B6", "B4")
    fields.length("shoulder", "B3")
    fields.length("overall", "B5")
    fields.length("shank", "C3")
    if kind == "flat":
        fields.length("corner", "G1")
    helix = fields.angle("helix", "F4") if part == "DIN4000-82" else None
    if helix is not None and values.get("F3") == "L":
        fields.sizes["helix"] = Size(-helix.value, f"{helix.text}, left-hand")
    return RawTool(
        source=source,
        name=" ".join(filter(None, (values.get("J22"), values.get("J21")))),
        kind=kind,
        word=f"{part} figure {figure}".strip(),
        sizes=fields.sizes,
        teeth=fields.whole("F21") if part == "DIN4000-82" else None,
        warnings=tuple(fields.warnings),
    )


def _apt_tools(root: ElementTree.Element, path: Path) -> Iterator[RawTool]:
    for index, tool in enumerate(root.iter("Tool")):
        cutter = tool.find("Cutter")
        values = {item.tag: item.text.strip() for item in tool.iter() if item.text and item.text.strip()}
        if cutter is not None:
            values["FluteLength"] = cutter.get("FluteLength", "")
        unit = unit_named(tool.get("Units"))
        fields = Fields(values, unit or "mm")
        diameter, corner = fields.length("diameter", "Diameter"), fields.length("corner", "Radius")
        centre = fields.length("centre", "ECorner")
        fields.sizes.pop("centre", None)
        fields.length("flutes", "FluteLength")
        fields.length("overall", "Length")
        angles = [fields.angle(name, name) for name in _NOT_MODELLED]
        for name in _NOT_MODELLED:
            fields.sizes.pop(name, None)
        milling = values.get("Type", "Milling").lower() == "milling"
        plain = milling and not any(angle is not None and angle.value for angle in angles)
        notes = ["helix angle: not stored in this format", *([] if unit else ["unit: not in the library, taken as mm"])]
        if plain and diameter and corner and centre and abs(centre.value + corner.value - 0.5 * diameter.value) > 1e-3:
            plain = False
        yield RawTool(
            source=f"{path}: Tool[{index}]",
            number=fields.whole("Pocket"),
            name=values.get("ID", ""),
            kind=_apt_kind(diameter, corner) if plain else kind_of_word("" if milling else values["Type"]),
            word=values.get("Type", "") if not milling else "profile with angles",
            sizes=fields.sizes,
            teeth=fields.whole("Teeth"),
            notes=tuple(notes),
            warnings=tuple(fields.warnings),
        )


def _apt_kind(diameter: Size | None, corner: Size | None) -> str:
    """The kind of a cutter without angles."""
    if corner is None or corner.value == 0.0:
        return "flat"
    return "ball" if diameter is not None and corner.value >= 0.5 * diameter.value * 0.999 else "bull"
