"""Tools as words on a command line: ``ball 8``, ``flat 10``, ``bull 12 r2``."""

from __future__ import annotations

import re

from twin.errors import ToolError
from twin.tools.shape import ToolKind, ToolShape, tool_shape

_EXPECTED = 'expected "ball D", "flat D", "bull D rC" or "taper D aDEG [rC]", lengths in mm, as in "bull 12 r2"'
_KINDS: dict[str, ToolKind] = {"ball": "ball", "flat": "flat", "bull": "bull", "taper": "taper"}
_NEEDS: dict[str, tuple[set[str], set[str]]] = {
    "ball": (set(), {"l"}),
    "flat": (set(), {"l"}),
    "bull": ({"r"}, {"l"}),
    "taper": ({"a"}, {"r", "l"}),
}
_NUMBER = r"(?:\d+\.?\d*|\.\d+)"
_TEXT = re.compile(rf"([a-z]+)\s+d?({_NUMBER})((?:\s+(?:rc|[a-z]){_NUMBER}|\s+{_NUMBER}deg)*)", re.IGNORECASE)
#: Length of the flutes in diameters, where not given.
_FLUTES = 3.0


def parse_tool(text: str, flute_length_mm: float | None = None) -> ToolShape:
    """The tool that a text describes.

    Kind, diameter, then letters with values: ``r`` or ``rc`` corner radius, ``a`` half angle of a taper in degrees
    (or ``5deg``), ``l`` length of the flutes.

    Args:
        flute_length_mm: length of the flutes where the text does not state it; three diameters if not given.

    Raises:
        ToolError: other words, a letter that the kind does not have or lacks, or an impossible shape.
    """
    match = _TEXT.fullmatch(text.strip())
    kind = match[1].lower() if match else ""
    if match is None or kind not in _KINDS:
        raise ToolError(f'tool "{text}"; {_EXPECTED}')
    words = [_word(w.lower()) for w in match[3].split()]
    values = dict(words)
    needed, allowed = _NEEDS[kind]
    if len(values) != len(words) or not needed <= set(values) <= needed | allowed:
        raise ToolError(f'tool "{text}"; {_EXPECTED}')
    diameter = float(match[2])
    flutes = values.get("l", _FLUTES * diameter if flute_length_mm is None else flute_length_mm)
    try:
        return tool_shape(_KINDS[kind], diameter, flutes, values.get("r", 0.0), values.get("a", 0.0))
    except ToolError as error:
        raise ToolError(f'tool "{text}": {error}') from error


def _word(word: str) -> tuple[str, float]:
    """A letter and its value: ``r2``, ``rc2``, ``a5``, ``5deg``."""
    if word.endswith("deg"):
        return "a", float(word[:-3])
    return word[0], float(word.removeprefix("rc") if word.startswith("rc") else word[1:])


def tool_text(shape: ToolShape) -> str:
    """A tool in the words that `parse_tool` reads, without the length of its flutes."""
    diameter = f"{2.0 * shape.nominal_radius_mm:g}"
    if shape.taper_rad > 0.0:
        from math import degrees

        corner = f" r{shape.corner_radius_mm:g}" if shape.corner_radius_mm else ""
        return f"taper {diameter} a{degrees(shape.taper_rad):g}{corner}"
    if shape.corner_radius_mm == 0.0:
        return f"flat {diameter}"
    return f"ball {diameter}" if shape.disc_mm == 0.0 else f"bull {diameter} r{shape.corner_radius_mm:g}"
