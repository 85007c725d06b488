"""Tool bits, libraries and holders of FreeCAD: ``.fctb``, ``.fctl``, ``.fcholder``.

A library lists numbers and files of bits, which are next to it or in a folder ``Bit`` or ``ToolBits`` alongside. Sizes
are texts with units in the user's notation (``6.0000 mm``, ``30,0 mm``, ``0.25 in``). Bits of earlier versions name the
shape by its file only, and the corner by the radius of the flat bottom. Angles of V-bits, chamfer mills and tapered
balls are angles between both sides. A bit may name a holder, an outline of radius and height above the face that the
bit comes out of.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from twin.errors import ToolLibraryError
from twin.tool_library.fields import Fields
from twin.tool_library.file_text import json_of, read_bytes
from twin.tool_library.kinds import kind_of_word
from twin.tool_library.raw_tool import Frustum, RawTool, Size

_BIT_FOLDERS = ("", "Bit", "../Bit", "ToolBits", "../ToolBits", "bits")
_HOLDER_FOLDERS = ("", "ToolHolder", "../ToolHolder", "Holder", "../Holder")
_MOST_BITS = 5000
_NOT_STORED = "helix angle: not stored in this format"


def library_tools(data: Mapping[str, Any], path: Path) -> Iterator[RawTool]:
    """The entries of a library (``.fctl``), each from the file of its bit.

    Raises:
        ToolLibraryError: an entry without number and file, no bit file at all, or one that is damaged.
    """
    entries = data["tools"]
    if len(entries) > _MOST_BITS:
        raise ToolLibraryError(f"{path}: {len(entries)} tools; expected at most {_MOST_BITS}")
    missing = 0
    for index, entry in enumerate(entries):
        source = f"{path}: tools[{index}]"
        name = entry.get("path") if isinstance(entry, Mapping) else None
        if not isinstance(name, str) or not name.strip():
            raise ToolLibraryError(f"{source} names no file of a bit; expected nr and path")
        number = Fields(entry, "mm")
        file = _next_to(path, name, _BIT_FOLDERS, ".fctb")
        if file is None:
            missing += 1
            yield RawTool(source=source, number=number.whole("nr"), name=name, kind="missing bit", sizes={}, teeth=None)
        else:
            bit = json_of(read_bytes(file), file)
            if not is_bit(bit):
                raise ToolLibraryError(f"{file}: is not a tool bit of FreeCAD; expected shape and parameter")
            yield bit_tool(bit, file, number.whole("nr"), tuple(number.warnings))
    if entries and missing == len(entries):
        raise ToolLibraryError(f"{path}: none of its {missing} bits is there; expected them next to it or in ../Bit")


def is_bit(data: Any) -> bool:
    """Whether a JSON value is a tool bit."""
    return isinstance(data, Mapping) and isinstance(data.get("parameter"), Mapping)


def bit_tool(data: Mapping[str, Any], path: Path, number: int | None, warnings: tuple[str, ...] = ()) -> RawTool:
    """The tool of a bit (``.fctb``).

    Args:
        data: the value of its JSON file.
        path: the file.
        number: its number in the library.
        warnings: values of the library's entry that could not be read.
    """
    attribute = data.get("attribute")
    values = {**(attribute if isinstance(attribute, Mapping) else {}), **data["parameter"]}
    fields = Fields(values, "mm")
    notes = [_NOT_STORED] if fields.angle("helix", "HelixAngle") is None else []
    word = _word(data)
    kind = kind_of_word(word)
    _read_sizes(fields)
    kind = _fit_kind(fields, kind, word, notes)
    holder, holder_name = _holder(fields, path)
    return RawTool(
        source=str(path),
        number=number,
        name=_name(data, path),
        kind=kind,
        word=word,
        sizes=fields.sizes,
        teeth=fields.whole("Flutes"),
        holder=holder,
        holder_name=holder_name,
        notes=tuple(notes),
        warnings=(*warnings, *fields.warnings),
    )


def holder_tool(data: Mapping[str, Any], path: Path) -> RawTool:
    """A holder (``.fcholder``) as an entry of its own."""
    fields = Fields(data, "mm")
    holder = tuple(_outline(data, fields))
    warnings = tuple(fields.warnings)
    return RawTool(source=str(path), name=_name(data, path), kind="holder", sizes={}, holder=holder, warnings=warnings)


def _word(data: Mapping[str, Any]) -> str:
    """The type of a bit: its shape's name, or that of its shape's file."""
    named = data.get("shape-type") or data.get("shape") or data.get("template")
    word = named if isinstance(named, str) else ""
    return word.replace("\\", "/").rpartition("/")[2].removesuffix(".fcstd").removesuffix(".FCStd")


def _name(data: Mapping[str, Any], path: Path) -> str:
    name = data.get("name")
    return name if isinstance(name, str) and name.strip() else path.stem


def _read_sizes(fields: Fields) -> None:
    diameter = fields.length("diameter", "Diameter")
    fields.length("flutes", "CuttingEdgeHeight", "CuttingEdgeLength")
    fields.length("overall", "Length")
    fields.length("shank", "ShankDiameter")
    fields.length("neck", "NeckDiameter")
    fields.length("stickout", "Stickout")
    if fields.sizes.get("stickout", Size(1.0, "")).value == 0.0:
        del fields.sizes["stickout"]
    if fields.length("corner", "CornerRadius", "TorusRadius") is not None:
        return
    flat = fields.length("corner", "FlatRadius")
    if flat is not None and diameter is not None:
        fields.sizes["corner"] = Size(0.5 * diameter.value - flat.value, f"half of {diameter.text} less {flat.text}")


def _fit_kind(fields: Fields, kind: str | None, word: str, notes: list[str]) -> str | None:
    """The sizes of a cone; the kind, which is a taper tool for a ball with an angle."""
    if kind != "bull":
        fields.sizes.pop("corner", None)
    if kind == "chamfer mill":
        _fit_chamfer(fields, word)
    elif kind == "taper" or (kind == "ball" and (fields.angle("taper", "TaperAngle") or Size(0.0, "")).value > 0.0):
        _fit_tapered_ball(fields, kind, notes)
        return "taper"
    return kind


def _fit_chamfer(fields: Fields, word: str) -> None:
    """A V-bit or chamfer mill: a cone from its tip to its diameter, half as wide as the angle between its sides."""
    sizes = fields.sizes
    fields.length("tip", "TipDiameter")
    angle = fields.angle("taper", "CuttingEdgeAngle")
    if angle is not None:
        sizes["taper"] = Size(0.5 * angle.value, f"half of {angle.text}")
    if "diameter" in sizes:
        sizes["top"] = sizes["diameter"]
    if "chamfer" in word.lower():
        _check_cone(fields)
    else:
        sizes.pop("flutes", None)  # of a V-bit: the height of the cylinder above its cone


def _fit_tapered_ball(fields: Fields, kind: str, notes: list[str]) -> None:
    """A ball at the tip; ``TaperAngle`` is between both sides, of a plain ball from the axis."""
    sizes = fields.sizes
    angle = fields.angle("taper", "TaperAngle")
    if angle is not None and kind == "taper":
        sizes["taper"] = Size(0.5 * angle.value, f"half of {angle.text}")
    elif angle is not None:
        notes.append(f"ball with {angle.text} taken as a tapered ball with this half angle")
    fields.length("top", "TaperDiameter")
    if "diameter" in sizes:
        sizes["corner"] = Size(0.5 * sizes["diameter"].value, f"half of {sizes['diameter'].text}")


def _check_cone(fields: Fields) -> None:
    """Leave the angle of a cone out where it contradicts both diameters and the height of the edge."""
    tip, top, taper, edge = (fields.sizes.get(name) for name in ("tip", "top", "taper", "flutes"))
    if tip is None or top is None or taper is None or edge is None or not 0.0 < taper.value < 90.0:
        return
    height = 0.5 * (top.value - tip.value) / math.tan(math.radians(taper.value))
    if height > edge.value * 1.02:
        fields.warnings.append(
            f"{taper.text}: a cone from {tip.text} to {top.text} is {height:.4g} mm high; expected at most {edge.text}"
        )
        del fields.sizes["taper"]


def _holder(fields: Fields, path: Path) -> tuple[tuple[Frustum, ...], str]:
    """Outline and name of the holder that a bit names."""
    name = fields.text("ToolHolder")
    if not name:
        return (), ""
    file = _next_to(path, name, _HOLDER_FOLDERS, ".fcholder")
    if file is None:
        fields.warnings.append(f"ToolHolder = {name}: expected the file {Path(name).stem}.fcholder in ../ToolHolder")
        return (), name
    data = json_of(read_bytes(file), file)
    if not isinstance(data, Mapping):
        raise ToolLibraryError(f"{file}: is not a holder of FreeCAD; expected an object with a profile")
    return tuple(_outline(data, fields)), _name(data, file)


def _outline(data: Mapping[str, Any], fields: Fields) -> Iterator[Frustum]:
    """The pieces of a holder between the points of its outline, upwards; points are radius and height."""
    points: list[tuple[float, float]] = []
    profile = data.get("profile")
    for index, point in enumerate(profile if isinstance(profile, list) else []):
        values = dict(enumerate(point)) if isinstance(point, list) else {}
        here = Fields({"r": values.get(0), "z": values.get(1)}, "inch" if data.get("units") == "in" else "mm")
        radius, height = here.length("r", "r"), here.length("z", "z")
        if radius is None or height is None:
            fields.warnings.append(f"profile[{index}]: expected radius and height")
        else:
            points.append((radius.value, height.value))
    for (r0, z0), (r1, z1) in itertools.pairwise(points):
        if z1 > z0:
            yield Frustum(lower_mm=2.0 * r0, upper_mm=2.0 * r1, length_mm=z1 - z0)


def _next_to(path: Path, name: str, folders: tuple[str, ...], suffix: str) -> Path | None:
    """The file of a name in one of the folders near a file; only the last part of the name counts."""
    last = name.replace("\\", "/").rpartition("/")[2]
    for folder in folders:
        for candidate in (last, f"{last}{suffix}"):
            file = path.parent / folder / candidate
            try:
                if file.is_file():
                    return file
            except (OSError, ValueError):
                return None
    return None
