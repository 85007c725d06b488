"""Tool shapes from short text: ``ball D8``, ``flat D10``, ``bull D10 rc1``, ``taper D6 rc1 5deg``."""

from __future__ import annotations

import re

from twin.errors import ToolError
from twin.tools.shape import ToolKind, ToolShape, tool_shape

_NUMBER = r"(\d+(?:\.\d*)?|\.\d+)"
_TEXT = re.compile(rf"(flat|ball|bull|taper)\s+D{_NUMBER}(?:\s+rc{_NUMBER})?(?:\s+{_NUMBER}deg)?", re.IGNORECASE)
_KINDS: dict[str, ToolKind] = {"flat": "flat", "ball": "ball", "bull": "bull", "taper": "taper"}


def shape_from_text(text: str, flute_length_mm: float | None = None) -> ToolShape:
    """The shape that a short text names: kind, diameter, corner radius, taper half angle; mm and degrees.

    Args:
        flute_length_mm: height of the cutting part, three diameters where it is not given.

    Raises:
        ToolError: text of another form, or a shape that cannot be.
    """
    found = _TEXT.fullmatch(text.strip())
    if found is None:
        raise ToolError(
            f'tool "{text}": expected kind, diameter, corner radius and taper, as "ball D8", "flat D10", '
            '"bull D10 rc1" or "taper D6 rc1 5deg"'
        )
    kind = _KINDS[found[1].lower()]
    corner, taper = found[3], found[4]
    if (kind in ("flat", "ball") and corner) or (kind == "bull" and not corner) or ((kind == "taper") != bool(taper)):
        raise ToolError(f'tool "{text}": bull needs a corner radius, taper a half angle; flat and ball take neither')
    diameter = float(found[2])
    flute = 3.0 * diameter if flute_length_mm is None else flute_length_mm
    return tool_shape(kind, diameter, flute, float(corner or 0.0), float(taper or 0.0))
