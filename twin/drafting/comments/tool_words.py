"""A tool described in words: ``1/2 FLAT ENDMILL``, ``10. END_MILL_SPHER DIA. 10.``, ``BULL 12 R2 4FL``.

Words of the trade in several languages decide the kind; a size counts only with a mark that makes it one.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from twin.drafting.comments.program_text import Unit

_INCH_MM = 25.4
#: ``Fräser`` as posts write it, with any two characters in place of a letter that was lost.
_FRAESER = r"FR(?:AE|Ä|A|\W{1,2})SER"
#: Kinds by the words that name them; the first that is found counts, so special tools come before general ones.
_KINDS: tuple[tuple[str, str], ...] = (
    ("probe", r"PROBE|TASTER|EDGE ?FINDER"),
    ("spot drill", r"SPOT(?:TING|DRILL\w*)?|CENT(?:ER|RE)[ -]?DRILL\w*|(?:NC[ -]?)?ANBOHRER|ZENTRIERBOHRER|POINTER"),
    ("flat", r"SLOT[ -]?DRILL"),
    ("drill", r"\w*DRILL|\w*(?<!GEWINDE)BOHRER|FORET|BROCA|WIERTLO|PUNTA"),
    ("tap", r"TAP|TAPPING|GEWINDEBOHRER|TARAUD|MASCHIO|MACHO"),
    ("thread mill", rf"THREAD[ -]?MILL(?:ING)?|GEWINDE{_FRAESER}"),
    ("reamer", r"REAM(?:ER|ING)?|REIBAHLE|ALESOIR|ALESATORE|ESCARIADOR"),
    ("boring bar", r"BORING(?:[ -](?:BAR|HEAD))?|BORE[ -]?BAR"),
    ("dovetail mill", r"DOVE[ -]?TAIL"),
    ("slot mill", r"T[ -]?SLOT|SLOT[ -]?MILL|WOODRUFF|KEY[ -]?(?:SEAT|CUTTER)|SLITTING"),
    ("lollipop mill", r"LOLLI[ -]?POP|UNDERCUT"),
    ("counterbore", r"COUNTER[ -]?BORE|C[ -]?BORE"),
    (
        "chamfer mill",
        r"CHAM(?:FER)?|V[ -]?(?:BIT|GROOVE)|ENGRAV\w*|C(?:OUNTER)?[ -]?SINK"
        r"|FASENFR\w*|GRAVIER\w*|GRAVUR\w*|CHANFREIN\w*|SMUSS\w*|AVELLANADOR",
    ),
    ("taper", r"TAPER(?:ED)?|CONICAL|KONISCH"),
    (
        "ball",
        r"BALL(?:[ -]?(?:NOSED?|END|MILL|ENDMILL))?|(?:H[EÉ]MI)?SPH[EÉ]R\w*|KUGEL\w*|BOULE|E?SF[EÉ]RIC\w*|BOLA|KULOWY"
        r"|VOLLRADIUS\w*|BOUT ROND",
    ),
    ("bull", r"BULL(?:[ -]?(?:NOSED?|END|MILL|ENDMILL))?|TOR(?:US|IC|IQUE|OID\w*)|TORUSFR\w*|ECKRADIUS\w*"),
    (
        "face mill",
        r"FACE[ -]?MILL(?:ING)?|SHELL[ -]?MILL|FLY[ -]?CUTTER|PLANFR\w*|FACING|MESSERKOPF|[AÀ] SURFACER"
        r"|PLANEAR|SPIANARE",
    ),
    ("flat", r"END[ -]?MILL\d*|E/?M|FLAT|SQUARE|ROUTER|(?:UP|DOWN)[ -]?CUT|COMPRESSION|\w+[ -]?FLUTE|MILL|CUTTER"),
    ("flat", rf"SCHAFTFR\w*|\w*{_FRAESER}\w*|FREZA|FREZ|FRAISE|FRESA|CYLIND\w*"),
)
_KIND = tuple((kind, re.compile(rf"(?<![A-Z])(?:{words})(?![A-Z])")) for kind, words in _KINDS)

_ANY_KIND = re.compile("|".join(words for _, words in _KINDS))

_NUMBER = r"(?:\d+[ -]\d+/\d+|\d+/\d+|\d+,\d+|\d*\.\d+|\d+\.?)"
_UNIT = r"(?:MM|MILLIMET\w*|INCH\w*|IN\b|''|\"|”|″)"
#: A diameter, the surest mark first.
_DIAMETERS = tuple(
    re.compile(pattern)
    for pattern in (
        rf"\b(?:DIA(?:M(?:ETER)?|MET\w*)?|DM|DURCHM\w*)\b\.?\s*[-:=]?\s*(?P<n>{_NUMBER})\s*(?P<u>{_UNIT})?",
        rf"(?P<n>{_NUMBER})\s*(?P<u>{_UNIT})?\s*-?\s*DIA(?:M(?:ETER)?)?\b",
        rf"[Ø⌀]\s*(?P<n>{_NUMBER})\s*(?P<u>{_UNIT})?",
        rf"(?<![A-Z0-9])D\s*[:=]?\s*(?P<n>{_NUMBER})(?![\d/])\s*(?P<u>{_UNIT})?",
        rf"\{{\s*(?P<n>{_NUMBER})\s*(?P<u>{_UNIT}|INCHES)\s*\}}",
        rf"(?<![A-Z0-9.])(?P<n>{_NUMBER})\s*-?(?P<u>{_UNIT})",
        r"(?<![A-Z0-9.])(?P<n>\d+[ -]\d+/\d+|\d+/\d+)(?P<u>)(?!\d)",
    )
)
#: A bare number right before a word of the tool's kind.
_BARE = re.compile(rf"(?<![A-Z0-9.#-])(?P<n>{_NUMBER})\s+(?=[A-Z])(?P<rest>.*)")
#: The number at the end of a description.
_BARE_END = re.compile(rf"(?<=[A-Z.])\s+(?P<n>{_NUMBER})\s*$")
#: Number of a drill's size, which is not its diameter: ``NO. 7``, ``#7``.
_GAUGE = re.compile(r"(?:(?<![A-Z])NO\b\.?|#)\s*\d+(?![\d.,/])")
_CORNER = re.compile(
    rf"(?:\b(?:CORNER|TIP|ECK\w*)[ _-]?RAD(?:IUS)?\b\.?|\bCRN?\b\.?|\bRAD(?:IUS)?\b\.?|(?<![A-Z0-9])R)\s*[:=-]?"
    rf"\s*(?P<n>{_NUMBER})\s*(?P<u>{_UNIT})?|(?P<n2>{_NUMBER})\s*(?P<u2>{_UNIT})?\s*(?:CR|RAD|CORNER)\b"
)
#: Flutes; ``Z4`` before ``4Z``: the number before the blank in ``D16 Z4`` is the diameter.
_TEETH = tuple(
    re.compile(pattern)
    for pattern in (
        r"(?<![A-Z0-9])Z\s*=?\s*(\d{1,2})(?![\d.,])",
        r"(?:FLUTES|TEETH)\s*[:=]\s*(\d{1,2})",
        r"(?<![\d.])(\d{1,2})\s*[-_]?\s*(?:FLUTES?|FLT?S?|TEETH|TOOTH|DENTS|ZAHN\w*|SCHN(?:EIDEN)?)(?![A-Z])",
        r"(?<![\d.])(\d{1,2})Z(?![A-Z\d])",
    )
)
#: Corner radius from which an end mill is a ball-nose one, in diameters.
_BALL_PART = 0.495
#: A thread's diameter: ``M10``, ``M8X1.25``.
_METRIC_THREAD = re.compile(r"(?<![A-Z0-9])M\s*(\d+(?:[.,]\d+)?)")
_FLUTE_WORDS = {"SLOT DRILL": 2, "SINGLE FLUTE": 1, "O FLUTE": 1, "SINGLE-FLUTE": 1, "O-FLUTE": 1}
_FLUTE_LENGTH = re.compile(rf"\b(?:LOC|LCF|FLUTE[ _-]?LEN(?:GTH)?)\b\.?\s*[:=-]?\s*(?P<n>{_NUMBER})\s*(?P<u>{_UNIT})?")
_HELIX = re.compile(r"\bHELIX\b\s*[:=-]?\s*(\d+(?:\.\d+)?)|(\d+(?:\.\d+)?)\s*(?:DEG(?:REES?)?)?\s*HELIX\b")
_ANGLE = re.compile(r"(?<![\d.])(\d+(?:\.\d+)?)\s*(?:DEG(?:REES?)?\b|°)|\bANGLE\b\s*[:=]?\s*(\d+(?:\.\d+)?)")


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolStatement:
    """Values that a text states about a tool, None for those that it does not state. Lengths in mm.

    Attributes:
        number: tool number.
        name: the text, human-readable.
        kind: ``flat``, ``ball``, ``bull``, ``taper``, or a kind that is not simulated, as ``drill``.
        angle_deg: half angle of a chamfer mill or a taper, full angle of the point of a drill.
        z_min_mm: lowest Z that the post states for the tool.
        wear: whether the program is posted for the wear only in the tool's radius offset.
    """

    number: int | None = None
    name: str = ""
    kind: str | None = None
    diameter_mm: float | None = None
    corner_radius_mm: float | None = None
    teeth: int | None = None
    helix_deg: float | None = None
    flute_length_mm: float | None = None
    angle_deg: float | None = None
    z_min_mm: float | None = None
    wear: bool | None = None

    def __str__(self) -> str:
        size = f"D{self.diameter_mm:g}" if self.diameter_mm else ""
        corner = f"R{self.corner_radius_mm:g}" if self.corner_radius_mm and self.kind != "ball" else ""
        return " ".join(filter(None, (self.kind, size, corner, f"z{self.teeth}" if self.teeth else "")))

    def over(self, other: ToolStatement) -> ToolStatement:
        """These values, and those of another statement where there are none."""
        names = [f for f in self.__dataclass_fields__ if getattr(self, f) in (None, "")]
        return replace(self, **{name: getattr(other, name) for name in names})


def number_of(text: str) -> float:
    """A number as tools are labelled: ``.25``, ``10.``, ``3/8``, ``1 1/4``, ``1-1/4``; a decimal comma too.

    Raises:
        ValueError: not a number.
    """
    whole, _, part = re.sub(r"(?<=\d)-(?=\d)", " ", text.strip().replace(",", ".")).rpartition(" ")
    if "/" in part:
        above, _, below = part.partition("/")
        if float(below) == 0.0:
            raise ValueError(f"{text!r} is not a number")
        return (float(whole) if whole else 0.0) + float(above) / float(below)
    return float(part)


def length_mm(number: str, mark: str | None, unit: Unit) -> float:
    """A length in mm: in the unit of its mark, else in the program's; a fraction without a mark is in inches."""
    mark = (mark or "").strip().upper()
    inch = not mark.startswith("M") if mark else unit == "inch" or "/" in number
    return round(number_of(number) * (_INCH_MM if inch else 1.0), 6)


def kind_in(text: str) -> str | None:
    """The kind of tool that a text names, None for none."""
    upper = text.upper().replace("_", " ")
    if not _ANY_KIND.search(upper):
        return None
    return next((kind for kind, words in _KIND if words.search(upper)), None)


def rounded(corner_radius_mm: float, diameter_mm: float) -> str:
    """Kind of an end mill with a corner radius; posts round both to two or three decimals."""
    return "ball" if corner_radius_mm >= _BALL_PART * diameter_mm else "bull"


def described(text: str, unit: Unit, *, bare_end: bool = False) -> ToolStatement:
    """Values in a description of a tool.

    Args:
        text: the description.
        unit: of lengths without a mark.
        bare_end: a number without a mark at its end is the diameter too: ``DRILL 6.8``.
    """
    upper = text.upper().replace("_", " ")
    kind = kind_in(text)
    corner = _length(_CORNER.search(upper), unit)
    diameter = _diameter(upper, kind, unit)
    if diameter is None and bare_end and kind is not None and (end := _BARE_END.search(_GAUGE.sub(" ", upper))):
        diameter = length_mm(end["n"], None, unit) or None
    if kind in (None, "flat") and corner and diameter:
        kind = rounded(corner, diameter)
    helix, angle = _HELIX.search(upper), _ANGLE.search(_HELIX.sub(" ", upper))
    return ToolStatement(
        name=" ".join(text.split()),
        kind=kind,
        diameter_mm=diameter,
        corner_radius_mm=corner,
        teeth=_teeth(upper),
        helix_deg=float(helix[1] or helix[2]) if helix else None,
        flute_length_mm=_length(_FLUTE_LENGTH.search(upper), unit),
        angle_deg=_half_angle(float(angle[1] or angle[2]), kind) if angle else None,
    )


def _half_angle(angle_deg: float, kind: str | None) -> float:
    """Chamfer and engraving tools are described by the full angle of their point, tapers by the half angle."""
    return 0.5 * angle_deg if kind == "chamfer mill" else angle_deg


def _diameter(upper: str, kind: str | None, unit: Unit) -> float | None:
    if kind in ("tap", "thread mill") and (thread := _METRIC_THREAD.search(upper)) is not None:
        return length_mm(thread[1], "MM", unit)
    for pattern in _TEETH:
        upper = pattern.sub(" ", upper)
    upper = _GAUGE.sub(" ", upper)
    upper = _CORNER.sub(lambda m: " " if m["n"] or m["n2"] else m[0], _FLUTE_LENGTH.sub(" ", upper))
    for pattern in _DIAMETERS:
        for match in pattern.finditer(upper):
            if (value := length_mm(match["n"], match["u"], unit)) > 0.0:
                return value
    bare = _BARE.search(upper)
    if bare is not None and kind_in(" ".join(bare["rest"].split()[:3])) is not None:
        return length_mm(bare["n"], None, unit) or None
    return None


def _length(match: re.Match[str] | None, unit: Unit) -> float | None:
    if match is None:
        return None
    groups = match.groupdict()
    number, mark = groups["n"], groups["u"]
    if number is None:
        number, mark = groups["n2"], groups["u2"]
    return length_mm(number, mark, unit)


def _teeth(upper: str) -> int | None:
    for pattern in _TEETH:
        match = pattern.search(upper)
        if match is not None and int(match[1]):
            return int(match[1])
    return next((count for words, count in _FLUTE_WORDS.items() if words in upper), None)
