"""Columns of a tool list as CSV: their names here, in Fusion 360's own export, and in lists typed by hand."""

from __future__ import annotations

import re
import unicodedata
from typing import NamedTuple

from twin.tool_library.quantities import LibraryUnit

#: Columns of the CSV files that ``twin tools`` writes, in order.
COLUMNS = (
    *("number", "name", "kind", "diameter_mm", "corner_radius_mm", "taper_deg", "teeth", "helix_deg"),
    *("flute_length_mm", "gauge_length_mm", "shank", "holder", "holder_name", "notes"),
)
#: Other names of columns, without unit: `assemble`'s names of sizes, and the columns that are not sizes.
_NAMES = {
    "number": ("number", "t", "tool", "no", "nr", "tool_number", "number_t", "nummer", "numero", "#"),
    "name": ("name", "description", "tool_description", "tool_name", "comment", "bezeichnung", "nom"),
    "kind": ("kind", "type", "shape", "tool_type", "typ"),
    "teeth": (
        *("teeth", "flutes", "z", "nof", "flute_count", "number_of_flutes", "tool_numberofflutes"),
        *("zahne", "zaehne", "dents"),
    ),
    "diameter": ("diameter", "d", "dia", "dc", "tool_diameter", "durchmesser", "diametre"),
    "corner": ("corner_radius", "corner", "radius", "r", "re", "cr", "tool_cornerradius", "eckenradius", "rayon"),
    "taper": ("taper", "taper_angle", "half_angle", "ta", "tool_taperangle"),
    "helix": ("helix", "helix_angle"),
    "flutes": ("flute_length", "cutting_length", "lcf", "loc", "length_of_cut", "tool_flutelength", "schneidenlange"),
    "shoulder": ("shoulder_length", "tool_shoulderlength"),
    "neck": ("neck_diameter", "shoulder_diameter", "tool_shoulderdiameter"),
    "stickout": ("stickout", "body_length", "lb", "tool_bodylength"),
    "overall": ("overall_length", "oal", "length", "tool_overalllength"),
    "shank_diameter": ("shank_diameter", "shaft_diameter", "sfdm", "tool_shaftdiameter"),
    "gauge": ("gauge_length", "tool_assemblygaugelength"),
    "tip": ("tip_diameter", "tool_tipdiameter"),
    "unit": ("unit", "units", "tool_unit"),
    "shank": ("shank",),
    "holder": ("holder",),
    "holder_name": ("holder_name", "holder_description"),
    "notes": ("notes",),
    "holder_segments": ("holder_segments",),
    "shaft_segments": ("shaft_segments",),
    "index": ("tool_index",),
}
_CANONICAL = {other: name for name, others in _NAMES.items() for other in others}
#: Names of sizes that are lengths, and of those that are angles.
LENGTHS = ("diameter", "corner", "flutes", "shoulder", "neck", "stickout", "overall", "shank_diameter", "gauge", "tip")
ANGLES = ("taper", "helix")
_UNITS: tuple[tuple[str, LibraryUnit], ...] = (("_mm", "mm"), ("_inch", "inch"), ("_in", "inch"))


class Column(NamedTuple):
    """A column that means something.

    Attributes:
        name: a size's or column's name.
        unit: unit in the column's heading, None for the row's.
        heading: its heading in the file.
    """

    name: str
    unit: LibraryUnit | None
    heading: str


def _unaccented(text: str) -> str:
    """A text with plain letters in place of those with accents."""
    return "".join(c for c in unicodedata.normalize("NFKD", text) if not unicodedata.combining(c))


def column_of(heading: str) -> Column | None:
    """The column that a heading means: ``diameter_mm``, ``Diameter [in]``, ``Diameter (tool_diameter)``."""
    text = _unaccented(heading.strip().lower())
    if found := re.search(r"\((\w*_\w+)\)$", text):
        name = _CANONICAL.get(found[1])
        return None if name is None else Column(name, None, heading.strip())
    text = re.sub(r"[^a-z0-9#]+", "_", text).strip("_")
    unit: LibraryUnit | None = None
    for end, meant in _UNITS:
        if text.endswith(end):
            text, unit = text.removesuffix(end), meant
            break
    name = _CANONICAL.get(text.removesuffix("_deg"))
    return None if name is None else Column(name, unit, heading.strip())
