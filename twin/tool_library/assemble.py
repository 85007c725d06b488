"""Tools from the entries of a library: sizes checked against each other, types mapped, shank and holder built.

Sizes by name, all in mm but for the angles: ``diameter``, ``corner``, ``taper`` (half angle, deg), ``tip`` (diameter of
a cone's flat tip), ``top`` (diameter where a cone ends), ``flutes`` (length), ``shoulder`` (length), ``neck`` (diameter
below the shoulder), ``stickout`` (tip to holder), ``overall`` (length), ``shank`` (diameter), ``gauge`` (length), and
``helix`` (deg). A value that cannot be right is named in the tool's warnings and left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from gcode.underline import harmless
from twin.tool_library.kinds import SIMULATED
from twin.tool_library.library_tool import LibraryTool
from twin.tool_library.pieces import above_flutes
from twin.tool_library.raw_tool import RawTool, Size

#: Largest sizes of tools, mm: diameters, and lengths along the axis.
_LARGEST_DIAMETER_MM = 500.0
_LONGEST_MM = 1000.0
#: A shank wider than this and than twice the cutting part is a wrong value, mm.
_WIDEST_SHANK_MM = 100.0
#: Smallest size that is not 0, mm.
_SMALLEST_MM = 1e-3
#: Smallest angle of a cone that is not 0, deg.
_SMALLEST_DEG = 1e-3
_MOST_TEETH = 100
#: Lengths from the tip, each at most the next.
_LENGTHS = ("flutes", "shoulder", "stickout", "overall")
_DIAMETERS = ("diameter", "top", "neck", "shank")
_MOST_NAME = 300
#: Relative difference of two sizes that are equal but for rounding.
_ROUNDING = 1e-3
_MAY_BE_ZERO = ("corner", "taper", "tip", "helix")


@dataclass(slots=True)
class _Checked:
    """The sizes that can be right, and what was found."""

    sizes: dict[str, Size]
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def get(self, name: str) -> float | None:
        """A size, None where there is none."""
        size = self.sizes.get(name)
        return None if size is None else size.value

    def refuse(self, name: str, expected: str) -> None:
        """Leave a size out, with a warning."""
        self.warnings.append(f"{self.sizes.pop(name).text}: expected {expected}")


def assemble(raw: RawTool) -> LibraryTool:
    """The tool of an entry, with the values that can be right."""
    found = _Checked({**raw.sizes}, [*raw.notes], [*raw.warnings])
    _check_ranges(found)
    _check_lengths(found)
    kind = _kind(raw, found)
    teeth = _teeth(raw.teeth, found)
    diameter, corner, taper = found.get("diameter"), found.get("corner"), found.get("taper")
    if kind in SIMULATED:
        kind, diameter, corner, taper = _shape(kind, found)
    shank, holder = above_flutes(raw, found.sizes, found.warnings)
    return LibraryTool(
        number=_number(raw.number, found),
        name=cleaned(raw.name),
        kind=kind,
        diameter_mm=diameter,
        corner_radius_mm=corner or None,
        taper_deg=taper or None,
        teeth=teeth,
        helix_deg=found.get("helix"),
        flute_length_mm=found.get("flutes"),
        gauge_length_mm=found.get("gauge"),
        shank=shank,
        holder=holder,
        holder_name=cleaned(raw.holder_name),
        source=raw.source,
        notes=tuple(map(cleaned, found.notes)),
        warnings=tuple(map(cleaned, found.warnings)),
    )


def cleaned(text: object) -> str:
    """A text of a library on one line, without control characters."""
    line = harmless(" ".join(str(text).split())) if isinstance(text, str) else ""
    return line if len(line) <= _MOST_NAME else f"{line[: _MOST_NAME - 1]}…"


def _check_ranges(found: _Checked) -> None:
    """Drop sizes that no tool has."""
    for name in [*found.sizes]:
        size = found.sizes[name]
        if name in ("taper", "helix"):
            least = _SMALLEST_DEG if name == "taper" and size.value else -90.0
            if not least <= size.value < 90.0:
                found.refuse(name, "an angle above 0 and below 90 degrees" if name == "taper" else "below 90 degrees")
            continue
        most = _LARGEST_DIAMETER_MM if name in _DIAMETERS or name in ("corner", "tip") else _LONGEST_MM
        if size.value < 0.0 or (size.value == 0.0 and name == "diameter"):
            found.refuse(name, "above 0")
        elif not (size.value == 0.0 or _SMALLEST_MM <= size.value <= most):
            found.refuse(name, f"{_SMALLEST_MM:g} to {most:g} mm")
        elif size.value == 0.0 and name not in _MAY_BE_ZERO:
            del found.sizes[name]
    diameter, shank = found.get("diameter"), found.get("shank")
    if shank is not None and shank > max(_WIDEST_SHANK_MM, 2.0 * (diameter or 0.0)):
        found.refuse("shank", f"a shank diameter up to {_WIDEST_SHANK_MM:g} mm")


def _check_lengths(found: _Checked) -> None:
    """Flute length <= shoulder length <= length below the holder <= overall length; the longer one is not used."""
    for index, name in enumerate(_LENGTHS):
        for longer in _LENGTHS[index + 1 :]:
            low, high = found.sizes.get(name), found.sizes.get(longer)
            if low is None or high is None or low.value <= high.value * (1.0 + _ROUNDING):
                continue
            if name == "flutes" and longer == "overall":
                found.refuse(name, f"at most {high.text}")
            else:
                found.refuse(longer, f"at least {low.text}")


def _kind(raw: RawTool, found: _Checked) -> str:
    """The kind, with those types replaced that are flat, bull-nose or taper tools."""
    kind, corner, taper = raw.kind, found.get("corner") or 0.0, found.get("taper") or 0.0
    if kind is None:
        return cleaned(raw.word).lower() or "unknown"
    if kind == "face mill":
        kind = "taper" if taper else "bull" if corner else "flat"
        found.notes.append(f"face mill taken as a {kind} tool that cuts on its whole bottom")
    elif kind == "slot mill":
        kind = "bull" if corner else "flat"
    elif kind == "chamfer mill" and taper and (found.get("tip") or corner):
        kind = "taper"
    if kind == "flat" and corner:
        kind = "bull"
        found.notes.append(f"flat tool with {found.sizes['corner'].text} taken as bull-nose")
    if kind == "taper" and not taper:
        return _untapered(corner, found)
    return kind


def _untapered(corner: float, found: _Checked) -> str:
    """The kind of a taper tool without an angle."""
    if "taper" not in found.sizes:
        return "taper"
    diameter = found.get("diameter")
    kind = "flat" if not corner else "ball" if diameter and corner >= 0.5 * diameter * (1 - _ROUNDING) else "bull"
    found.notes.append(f"taper angle 0, taken as a {kind} tool")
    return kind


def _teeth(teeth: int | None, found: _Checked) -> int | None:
    if teeth is None or teeth == 0:
        return None
    if not 1 <= teeth <= _MOST_TEETH:
        found.warnings.append(f"{teeth} teeth: expected 1 to {_MOST_TEETH}")
        return None
    return teeth


def _number(number: int | None, found: _Checked) -> int | None:
    """The tool number; 0 stands for none."""
    if number is None or number == 0:
        return None
    if number < 0:
        found.warnings.append(f"tool number {number}: expected above 0")
        return None
    return number


def _shape(kind: str, found: _Checked) -> tuple[str, float | None, float | None, float | None]:
    """Kind, diameter, corner radius and taper of a tool that can be simulated."""
    diameter, corner = found.get("diameter"), found.get("corner")
    if kind == "taper":
        return _cone(found)
    if diameter is not None and corner is not None and corner > 0.5 * diameter * (1.0 + _ROUNDING):
        found.refuse("corner", f"at most half of {found.sizes['diameter'].text}")
        corner = None
    if kind == "ball":
        if diameter and corner and abs(corner - 0.5 * diameter) > 0.01 * diameter:
            found.refuse("corner", f"half of {found.sizes['diameter'].text}, the radius of a ball")
        return kind, diameter, None if diameter is None else 0.5 * diameter, None
    if kind == "bull" and corner == 0.0:
        found.notes.append("bull-nose tool with corner radius 0 taken as flat")
        kind = "flat"
    if kind == "flat":
        return kind, diameter, None, None
    return kind, diameter, corner if corner is None or diameter is None else min(corner, 0.5 * diameter), None


def _cone(found: _Checked) -> tuple[str, float | None, float | None, float | None]:
    """A cone from a flat or round tip; where it ends below the flutes' end, only the cone cuts."""
    tip, corner, taper = found.get("tip"), found.get("corner") or 0.0, found.get("taper")
    diameter = found.get("diameter")
    wide = found.sizes.get("top")
    if tip is not None:
        diameter = tip
    if diameter is not None and corner > 0.5 * diameter * (1.0 + _ROUNDING):
        found.refuse("corner", f"at most half of the diameter at the tip, {diameter:g} mm")
        corner = 0.0
    if diameter is not None:
        corner = min(corner, 0.5 * diameter)
    if wide is not None and diameter and taper:
        _end_cone(found, wide, diameter, corner, taper)
    flutes = found.get("flutes")
    if "top" not in found.sizes and diameter and taper and flutes is not None:
        widest = diameter + 2.0 * flutes * math.tan(math.radians(taper))
        found.sizes["top"] = Size(widest, f"largest diameter = {widest:.4g} mm")
    return "taper", diameter or None, corner, taper


def _end_cone(found: _Checked, wide: Size, diameter: float, corner: float, taper: float) -> None:
    """Set the flute length to the height where the cone has its largest diameter."""
    beta = math.radians(taper)
    arc_radius = 0.5 * diameter - corner + corner * math.cos(beta)
    height = corner * (1.0 - math.sin(beta)) + (0.5 * wide.value - arc_radius) / math.tan(beta)
    flutes = found.sizes.get("flutes")
    if height <= 0.0:
        found.refuse("top", f"above the diameter at the tip, {diameter:g} mm")
    elif height > _LONGEST_MM:
        found.refuse("top", f"a diameter that the cone reaches within {_LONGEST_MM:g} mm")
    elif flutes is None or height < flutes.value * (1.0 - _ROUNDING):
        found.sizes["flutes"] = Size(height, f"height of the cone = {height:g} mm")
        found.notes.append(f"the cone of {taper:g} deg ends at {wide.text}, {height:.4g} mm above the tip")
