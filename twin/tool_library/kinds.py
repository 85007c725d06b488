"""Types of tools: their words in libraries, and which of them can be simulated."""

from __future__ import annotations

import re

#: Kinds of the job file.
SIMULATED = ("flat", "ball", "bull", "taper")

_POINT = "its point is not modelled; only flat, ball, bull-nose and taper tools are simulated"
_NOT_CONVEX = "the tool is narrower above its cutting part's widest section, which the simulation does not model"
_NOT_MILLING = "it is not a milling tool"
_OBSTACLES = {
    **dict.fromkeys(
        ("drill", "spot drill", "centre drill", "countersink", "reamer", "counterbore", "boring bar"), _POINT
    ),
    **dict.fromkeys(("tap", "thread mill"), "threads are not modelled"),
    **dict.fromkeys(("lollipop mill", "dovetail mill", "slitting saw"), _NOT_CONVEX),
    "radius mill": "its profile is concave; only convex tools are simulated",
    "circle segment mill": "its curved flank is not modelled",
    "form mill": "its profile is not in the library",
    "missing bit": "the file of the bit is not next to the library",
    "chamfer mill": "a taper tool needs an angle and a flat tip, and the library gives no usable ones",
    **dict.fromkeys(("probe", "turning tool", "laser", "jet cutter", "holder"), _NOT_MILLING),
}
_UNKNOWN = "the type is not known; expected a flat, ball, bull-nose or taper tool"

#: Words of a type, in the order in which they are looked for, and the kind.
_WORDS: tuple[tuple[str, str], ...] = (
    (r"turning|\blathe", "turning tool"),
    (r"laser", "laser"),
    (r"\bjet\b|water ?jet|plasma|deposit", "jet cutter"),
    (r"probe|\btouch", "probe"),
    (r"holder", "holder"),
    (r"thread ?mill|thread ?cutter", "thread mill"),
    (r"\btap\b|thread (?:form|cut)", "tap"),
    (r"circle ?segment|barrel|\blens\b|\boval\b|spheroid", "circle segment mill"),
    (r"lollipop|undercut", "lollipop mill"),
    (r"dovetail", "dovetail mill"),
    (r"radius ?mill|corner ?round|fillet|^radius$", "radius mill"),
    (r"\bsaw|slitting", "slitting saw"),
    (r"\bform\b", "form mill"),
    (r"slot ?drill", "flat"),
    (r"cent(?:er|re) ?drill", "centre drill"),
    (r"\bspot", "spot drill"),
    (r"counter ?sink", "countersink"),
    (r"counter ?bore", "counterbore"),
    (r"\bream", "reamer"),
    (r"\bbor(?:e|ing)\b", "boring bar"),
    (r"drill", "drill"),
    (r"conical ?ball", "taper"),
    (r"chamfer|\bv ?bit|engrav|conical|snub|\bv ?carv", "chamfer mill"),
    (r"taper", "taper"),
    (r"ball|spherical", "ball"),
    (r"bull|torus|toroid|corner ?rad|radiused", "bull"),
    (r"face ?mill|facing|surfac", "face mill"),
    (r"slot ?mill|\bt ?slot|woodruff", "slot mill"),
    (r"flat|end ?mill|square|cylindric|straight|rough|up ?cut|down ?cut|compression", "flat"),
)


def kind_of_word(word: str) -> str | None:
    """The kind that a type's name or a description means; None where it has no word of a tool.

    The result is one of `SIMULATED`, ``face mill``, ``slot mill``, or a kind that cannot be simulated.
    """
    text = re.sub(r"[\s_-]+", " ", word.strip().lower())
    return next((kind for pattern, kind in _WORDS if re.search(pattern, text)), None)


def obstacle_of_kind(kind: str) -> str:
    """Reason why tools of a kind cannot be simulated."""
    return _OBSTACLES.get(kind, _UNKNOWN)
