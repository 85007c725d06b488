"""Comments about tools: one row for each form in which posts write them, the surest form first.

A row's example is written in the style of the post's output; the tests read each one, and the page lists them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from twin.drafting.comments.program_text import Comment, Unit
from twin.drafting.comments.tool_words import ToolStatement, described, kind_in, length_mm, rounded

_TOOL_WORDS = "TOOL|WERKZEUG|WKZ|OUTIL|HERRAMIENTA|UTENSILE|NARZEDZIE"
_N = r"-?(?:\d+[ -]\d+/\d+|\d+/\d+|\d+\.?\d*|\.\d+)"


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolPost:
    """A form of comment about a tool.

    Attributes:
        post: programs that write it.
        pattern: its text, upper case, with named groups: ``number``, ``text`` (a description), ``d`` (diameter), ``cr``
            (corner radius), ``r`` (corner radius, 0 for a flat tool), ``z`` (teeth), ``len`` (flute length), ``angle``,
            ``zmin``, ``wear`` (the radius offset holds the wear only), ``unit``.
        example: a comment of this form, in a program in ``unit``.
        states: values of the example, as in `ToolStatement`.
    """

    post: str
    pattern: str
    example: str
    states: Mapping[str, Any]
    unit: Unit = "mm"
    _compiled: re.Pattern[str] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_compiled", re.compile(self.pattern, re.IGNORECASE))

    def read(self, text: str, unit: Unit) -> ToolStatement | None:
        """The values in a comment, None for a comment of another form."""
        match = self._compiled.search(text)
        if match is None:
            return None
        try:
            return _statement(match.groupdict(), unit, text)
        except ValueError:
            return None


_UNIT_WORDS: Mapping[str, Unit] = {"metric": "mm", "imperial": "inch"}


def _statement(groups: Mapping[str, str | None], unit: Unit, text: str) -> ToolStatement:
    """The values of a match; what its groups do not hold is taken from its description."""
    given = {name: value for name, value in groups.items() if value is not None}
    unit = _UNIT_WORDS.get(given.get("unit", "").lower(), unit)

    def length(name: str) -> float | None:
        return length_mm(given[name], given.get("mark"), unit) if name in given else None

    words = described(given.get("text", ""), unit, bare_end="number" in given)
    diameter = length("d") or words.diameter_mm
    corner = length("cr") if "cr" in given else length("r")
    return ToolStatement(
        number=int(given["number"]) if "number" in given else None,
        name=words.name or " ".join(text.split()),
        kind=_kind(words.kind, corner, diameter),
        diameter_mm=diameter,
        corner_radius_mm=corner if corner is not None else words.corner_radius_mm,
        teeth=int(given["z"]) if "z" in given else words.teeth,
        helix_deg=words.helix_deg,
        flute_length_mm=length("len") or words.flute_length_mm,
        angle_deg=float(given["angle"]) or None if "angle" in given else words.angle_deg,
        z_min_mm=length("zmin"),
        wear=True if "wear" in given else None,
    )


def _kind(named: str | None, corner_mm: float | None, diameter_mm: float | None) -> str | None:
    """Kind as named; of an end mill, as its corner radius makes it."""
    if corner_mm is None or named not in (None, "flat"):
        return named
    return rounded(corner_mm, diameter_mm) if corner_mm and diameter_mm else "flat"


TOOL_POSTS: tuple[ToolPost, ...] = (
    ToolPost(
        post="Fusion 360, HSMWorks, Inventor CAM",
        pattern=rf"^T(?P<number>\d+)\s+(?:(?P<name>.*?)\s+)?D=(?P<d>{_N})(?:\s+CR=(?P<cr>{_N}))?"
        rf"(?:\s+TAPER=(?P<angle>{_N})\s*DEG)?(?:\s*-\s*ZMIN=(?P<zmin>{_N}))?(?:\s*-\s*(?P<text>.*))?$",
        example="T3 D=0.125 CR=0.0625 - ZMIN=-0.54 - BALL END MILL",
        states={
            "number": 3,
            "kind": "ball",
            "diameter_mm": 3.175,
            "corner_radius_mm": 1.5875,
            "z_min_mm": -13.716,
            "name": "BALL END MILL",
        },
        unit="inch",
    ),
    ToolPost(
        post="Fusion 360 (OpenBuilds)",
        pattern=rf"^TOOL\s+(?P<number>\d+)\s*:\s*(?P<text>.*?),\s*DIAM\s*=\s*(?P<d>{_N})\s*(?P<mark>MM|IN)?"
        rf"(?:,\s*LEN\s*=\s*(?P<len>{_N}))?",
        example="Tool 4: Flat End Mill 3 Flutes, Diam = 3mm, Len = 15.00mm",
        states={
            "number": 4,
            "kind": "flat",
            "diameter_mm": 3.0,
            "teeth": 3,
            "flute_length_mm": 15.0,
            "name": "Flat End Mill 3 Flutes",
        },
    ),
    ToolPost(
        post="Mastercam",
        pattern=rf"^T\s*(?P<number>\d+)\s*\|\s*(?P<text>[^|]*?)\s*\|"
        r"(?:.*?(?P<wear>\bWEAR\s+COMP))?"
        rf"(?:.*?\b(?:TOOL\s+)?DIA\.?\s*-\s*(?P<d>{_N}))?"
        rf"(?:.*?\bC(?:R|ORNER\s+RAD(?:IUS)?)\.?\s*-\s*(?P<cr>{_N}))?",
        example="T15 | 1/2 BULL ENDMILL .06 RAD | H15 | D15 | TOOL DIA. - .5",
        states={
            "number": 15,
            "kind": "bull",
            "diameter_mm": 12.7,
            "corner_radius_mm": 1.524,
            "name": "1/2 BULL ENDMILL .06 RAD",
        },
        unit="inch",
    ),
    ToolPost(
        post="Mastercam (older posts), SURFCAM",
        pattern=rf"^(?P<text>.*?)\s*TOOL\s*-\s*(?P<number>\d+)\s+DIA\.?\s*OFF\.?\s*-\s*\d+\s+LEN\.?\s*-\s*\d+\s+"
        rf"(?:TOOL\s+)?DIA\.?\s*-\s*(?P<d>{_N})",
        example="1/16 FLAT ENDMILL TOOL - 1 DIA. OFF. - 1 LEN. - 1 DIA. - .0625",
        states={"number": 1, "kind": "flat", "diameter_mm": 1.5875, "name": "1/16 FLAT ENDMILL"},
        unit="inch",
    ),
    ToolPost(
        post="Carbide Create, APT",
        pattern=rf"^TOOL/MILL\s*,\s*(?P<d>{_N})\s*,\s*(?P<cr>{_N})\s*,\s*(?P<len>{_N})\s*(?:,\s*(?P<angle>{_N}))?",
        example="TOOL/MILL,6.35, 3.17, 19.05, 0.00",
        states={
            "kind": "ball",
            "diameter_mm": 6.35,
            "corner_radius_mm": 3.17,
            "flute_length_mm": 19.05,
            "name": "TOOL/MILL,6.35, 3.17, 19.05, 0.00",
        },
    ),
    ToolPost(
        post="Kiri:Moto",
        pattern=rf"^TOOL#\s*=\s*(?P<number>\d+)\s+FLUTE\s*=\s*(?P<d>{_N})(?:\s+LEN\s*=\s*(?P<len>{_N}))?"
        r"(?:.*?\bUNIT\s*=\s*(?P<unit>METRIC|IMPERIAL))?",
        example="tool#=2 flute=0.25 len=1 unit=imperial",
        states={
            "number": 2,
            "diameter_mm": 6.35,
            "flute_length_mm": 25.4,
            "name": "tool#=2 flute=0.25 len=1 unit=imperial",
        },
    ),
    ToolPost(
        post="FreeCAD (tool controller)",
        pattern=r"^(?:BEGIN\s+OPERATION\s*:\s*|PATH\s*:\s*)?TC\s*\d*\s*:\s*(?P<text>.*)$",
        example='TC: 1/4" endmill 2 flute',
        states={"kind": "flat", "diameter_mm": 6.35, "teeth": 2, "name": '1/4" endmill 2 flute'},
    ),
    ToolPost(
        post="FreeCAD (profile, pocket)",
        pattern=rf"^COMPENSATED\s+TOOL\s+PATH\.\s*DIAMETER\s*:\s*(?P<d>{_N})",
        example="Compensated Tool Path. Diameter: 6.35",
        states={"diameter_mm": 6.35, "name": "Compensated Tool Path. Diameter: 6.35"},
    ),
    ToolPost(
        post="PathPilot (conversational)",
        pattern=r"^TOOL\s+DESCRIPTION\s*=\s*(?P<text>.*)$",
        example="Tool Description = endmill [3/8] 3FL R:0.0 loc:25.4 carbide dia:9.525",
        states={
            "kind": "flat",
            "diameter_mm": 9.525,
            "corner_radius_mm": 0.0,
            "teeth": 3,
            "flute_length_mm": 25.4,
            "name": "endmill [3/8] 3FL R:0.0 loc:25.4 carbide dia:9.525",
        },
    ),
    ToolPost(
        post="NX (diameter and corner radius)",
        pattern=rf"^DIAM(?:ETER)?\s*[:=]\s*(?P<d>{_N})\s*(?:,\s*)?(?:CORNER\s+)?RAD(?:IUS)?\s*[:=]\s*(?P<r>{_N})"
        r"(?:\s*,?\s*(?:FLUTES|TEETH)\s*[:=]\s*(?P<z>\d+))?",
        example="DIAMETER: 12.00 CORNER RADIUS: 1.50 FLUTES: 3",
        states={
            "kind": "bull",
            "diameter_mm": 12.0,
            "corner_radius_mm": 1.5,
            "teeth": 3,
            "name": "DIAMETER: 12.00 CORNER RADIUS: 1.50 FLUTES: 3",
        },
    ),
    ToolPost(
        post="NX, CATIA (tool list)",
        pattern=rf"TOOL\s+NUMBER\s*=\s*(?P<number>\d+)\s+CUTTER\s+DIAMETER\s*=\s*(?P<d>{_N})",
        example="SEQ= 3 TOOL NUMBER = 2 CUTTER DIAMETER = 12.00",
        states={
            "number": 2,
            "diameter_mm": 12.0,
            "name": "SEQ= 3 TOOL NUMBER = 2 CUTTER DIAMETER = 12.00",
        },
    ),
    ToolPost(
        post="PathPilot, pcb2gcode, FlatCAM",
        pattern=rf"\b(?:TOOL|CUTTER)\s+DIAMETER\s*[:=]?\s*(?P<d>{_N})\s*(?P<mark>MM|IN(?:CH)?\b|\")?",
        example="Tool Diameter = 9.525 mm",
        states={"diameter_mm": 9.525, "name": "Tool Diameter = 9.525 mm"},
        unit="inch",
    ),
    ToolPost(
        post="Vectric (tool list)",
        pattern=r"^T?(?P<number>\d+)\s*=\s*(?P<text>[A-Z].*(?:\{.*\}|\bDIAM?).*)$",
        example="5 = End Mill {0.2500 inch} UpDown",
        states={"number": 5, "kind": "flat", "diameter_mm": 6.35, "name": "End Mill {0.2500 inch} UpDown"},
    ),
    ToolPost(
        post="Haas, SolidCAM, GibbsCAM, BobCAD, hand-written lists",
        pattern=rf"^(?:{_TOOL_WORDS})\s*(?:NO\.?|NR\.?|NUMBER|#)?\s*[-:=]?\s*T?(?P<number>\d+)\s*[-:=|,\s]\s*"
        r"(?P<text>.*[A-Z].*)$",
        example="TOOL 17 - 3/8 EM - DESC: 0.3771 DIA, 2 FLUTE, CARBIDE MAT",
        states={
            "number": 17,
            "kind": "flat",
            "diameter_mm": 9.57834,
            "teeth": 2,
            "name": "3/8 EM - DESC: 0.3771 DIA, 2 FLUTE, CARBIDE MAT",
        },
        unit="inch",
    ),
    ToolPost(
        post="GibbsCAM (list of operations)",
        pattern=r"^OP\s*\d+\s*:.*?\bTOOL\s+(?P<number>\d+)\s*:\s*(?P<text>.*[A-Z].*)$",
        example="OP 2: DRILL, TOOL 3: .5 ROUGH ENDMILL",
        states={"number": 3, "kind": "flat", "diameter_mm": 12.7, "name": ".5 ROUGH ENDMILL"},
        unit="inch",
    ),
    ToolPost(
        post="NX, PowerMill, Cimatron (name of the tool)",
        pattern=rf"^(?:D|B|EM)(?P<d>{_N})R(?P<r>{_N})(?![\w.])",
        example="D16R0.8",
        states={"kind": "bull", "diameter_mm": 16.0, "corner_radius_mm": 0.8, "name": "D16R0.8"},
    ),
    ToolPost(
        post="SolidCAM, CamBam, hand-written lists",
        pattern=r"^T\s*(?P<number>\d+)\s*[-:=|,.\s]\s*(?P<text>.*[A-Z].*)$",
        example="T4 - BULL NOSE MILL D10 R0.5 Z4",
        states={
            "number": 4,
            "kind": "bull",
            "diameter_mm": 10.0,
            "corner_radius_mm": 0.5,
            "teeth": 4,
            "name": "BULL NOSE MILL D10 R0.5 Z4",
        },
    ),
    ToolPost(
        post="CamBam",
        pattern=rf"^T\s*(?P<number>\d+)\s*:\s*(?P<d>{_N})\s*$",
        example="T1 : 6.0",
        states={"number": 1, "diameter_mm": 6.0, "name": "T1 : 6.0"},
    ),
    ToolPost(
        post="Vectric, ESPRIT, hand-written (at the tool change)",
        pattern=r"^(?:TOOL\s*:|CHANGE\s+TO\s+TOOL|CHANGE\s+TOOL\s*:|LOAD)\s*(?P<text>.*)$",
        example="Tool: Ball Nose {6 mm}",
        states={"kind": "ball", "diameter_mm": 6.0, "name": "Ball Nose {6 mm}"},
    ),
    ToolPost(
        post="any (kind and size in words)",
        pattern=r"^(?P<text>.*)$",
        example="10. END_MILL_SPHER DIA. 10.",
        states={"kind": "ball", "diameter_mm": 10.0, "name": "10. END_MILL_SPHER DIA. 10."},
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolComment:
    """A comment about a tool, and the form in which it is written."""

    comment: Comment
    post: ToolPost
    states: ToolStatement


def tool_comments(comments: tuple[Comment, ...], unit: Unit) -> Iterator[ToolComment]:
    """The comments that state something about a tool.

    Args:
        unit: of the program, in which posts write lengths.
    """
    known: dict[str, tuple[ToolPost, ToolStatement] | None] = {}
    for comment in comments:
        if comment.text not in known:
            known[comment.text] = _read(comment.text, unit)
        found = known[comment.text]
        if found is not None:
            yield ToolComment(comment=comment, post=found[0], states=found[1])


def _read(text: str, unit: Unit) -> tuple[ToolPost, ToolStatement] | None:
    """The first form that a comment is written in, with its values."""
    for post in TOOL_POSTS:
        if post is TOOL_POSTS[-1] and kind_in(text) is None:
            return None
        states = post.read(text, unit)
        if states is not None and _is_enough(states, post):
            return post, states
    return None


def _is_enough(states: ToolStatement, post: ToolPost) -> bool:
    """Free text is about a tool only where it states a kind and a size; other forms need one of them."""
    if post is TOOL_POSTS[-1]:
        return states.kind is not None and states.diameter_mm is not None
    return states.kind is not None or states.diameter_mm is not None
