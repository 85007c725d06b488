"""Programs for another kind of control, and files that are not programs: recognised by marks, refused by name.

A rule is data: what it is a mark of, and how much it proves. A certain mark is enough by itself; of likely ones two
different ones of the same control are needed. Comments are taken out first, so that a note about another control
proves nothing, unless the rule searches the text as is.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

#: Lines that are searched, and characters of each: the marks are near the beginning.
MOST_LINES = 400
MOST_COLUMNS = 256
#: What the likely marks of one control must add up to; a certain one has it alone.
PROOF = 2
_BEGINS = "how such a file begins"


@dataclass(frozen=True, slots=True)
class Foreign:
    """The kind of control, or of file, that a text was recognised as.

    Attributes:
        line: line of its first mark, counted from 1.
        column: column of that mark, counted from 1.
        marker: the mark as written, at most 40 characters.
        reason: what the mark is.
        control: whose language the text is in, or what kind of file it is.
    """

    line: int
    column: int
    marker: str
    reason: str
    control: str

    @property
    def is_file(self) -> bool:
        """Whether it is a file of another kind, not a program for another control."""
        return self.reason == _BEGINS


class Rule(NamedTuple):
    """One mark.

    Attributes:
        control: what it is a mark of.
        what: the mark in words.
        pattern: how it looks, searched in each line.
        weight: `PROOF` for a certain mark, 1 for a likely one.
        raw: True to search the line with its comments.
        first: True where only the file's first line counts.
    """

    control: str
    what: str
    pattern: re.Pattern[str]
    weight: int
    raw: bool
    first: bool


def _rules(
    control: str, certain: dict[str, str], likely: dict[str, str] | None = None, *, raw: bool = False
) -> Iterator[Rule]:
    for patterns, weight in ((certain, PROOF), (likely or {}, 1)):
        for what, pattern in patterns.items():
            yield Rule(control, what, re.compile(pattern, re.IGNORECASE | re.ASCII), weight, raw, False)


def _files(kinds: dict[str, str]) -> Iterator[Rule]:
    for kind, pattern in kinds.items():
        yield Rule(kind, _BEGINS, re.compile(pattern, re.ASCII), PROOF, True, True)


RULES: tuple[Rule, ...] = (
    *_files(
        {
            "a PDF document": r"%PDF-",
            "a ZIP archive": r"PK[\x03\x05]",
            "a text in UTF-16": r"\xff\xfe|\xfe\xff|[ -~]\x00",
            "a JSON file": r"\s*\{\s*(?:\"|$)",
            "a settings file (TOML)": r"\s*#\s+[A-Za-z]|\s*\[[a-z_.]+\]\s*(?:#|$)|\s*(?!o\d)[a-z_]{2,}\s*=\s*[\"'\[{]",
            "an XML or HTML document": r"\s*(?i:<(?:\?xml|!doctype|html)\b)",
            "an STL file": r"solid(?:\s+(?!\()[\w.\-]+)?\s*$",
            "a STEP file": r"ISO-10303-21;",
            "a DXF drawing": r"\s*0\s*$|AutoCAD Binary DXF",
            "a Gerber drawing": r"%FS[LT]A|G04 [^*]*\*\s*$|%MO(?:MM|IN)\*%",
        }
    ),
    *_rules(
        "SINUMERIK",
        {
            "the head of a SINUMERIK archive": r"^\s*%_N_\w+_(?:MPF|SPF)",
            "a definition of variables": r"^\s*(?:N\d+\s*)?DEF\s+(?:REAL|INT|BOOL|STRING|CHAR|AXIS|FRAME)\b",
            "a SINUMERIK cycle": r"\bCYCLE\d{2,4}\s*\(",
            "a message to the operator": r"\bMSG\s*\(",
            "a blank for the simulation": r"\bWORKPIECE\s*\(",
            "a coordinate in other dimensions": r"\b[A-Z]\s*=\s*(?:IC|AC|DC|ACP|ACN)\s*\(",
            "the radius of an arc": r"\bCR\s*=\s*-?[\d.]",
            "an arc by way of a point": r"\bCIP\b.*\b[IJK]1\s*=",
            "a programmable frame": r"^\s*(?:N\d+\s*)?(?:ATRANS|TRANS|AROT|ROT|ASCALE|AMIRROR)\s+[XYZ(R]",
            "a modal call": r"\bMCALL\b",
            "an assignment to an R parameter": r"^\s*(?:N\d+\s*)?R\d{1,3}\s*=\s*\S",
            "a spindle speed by number": r"(?:^|\s)S\d\s*=\s*\d",
            "a tool by its name": r'(?:^|\s)T\s*=\s*"',
            "a jump": r"\bGOTO[BF]\s+\w",
        },
        {
            "suppression of offsets": r"(?:^|\s)SUPA\b",
            "a cutting edge and tool in one word": r"(?:^|\s)(?:CFTCP|CFC|CFIN|SOFT|BRISK|G642|FFWON|COMPCAD|COMPOF)\b",
            "a rotation for five axes": r"\b(?:TRAORI|TRAFOOF|CYCLE800)\b",
            "a whole turn": r"(?:^|\s)TURN\s*=\s*\d",
            "a call of a subprogram by L": r"^\s*(?:N\d+\s*)?L\d+\s*(?:P\d+\s*)?$",
        },
    ),
    *_rules("SINUMERIK", {"the path of a SINUMERIK program": r"^\s*;\s*\$PATH="}, raw=True),
    *_rules(
        "Heidenhain",
        {
            "the head of a conversational program": r"\bBEGIN\s+PGM\b",
            "the end of a conversational program": r"\bEND\s+PGM\b",
            "a call of a tool": r"\bTOOL\s+CALL\b",
            "a blank": r"\bBLK\s+FORM\b",
            "a definition of a cycle": r"\bCYCL\s+(?:DEF|CALL)\b",
            "a straight line": r"^\s*\d*\s*L[NP]?\s+[XYZIP][AR+\-]*[\dQ.,+\-]+.*\b(?:R0|RL|RR|F\s*MAX|F\s*AUTO)\b",
            "the centre of a circle": r"^\s*\d*\s*CC\s+I?[XYZ][+\-]",
            "a circle by its sense": r"\bDR[+\-](?:\s|$)",
            "a Q parameter function": r"^\s*\d*\s*FN\s*\d+\s*:",
            "a label": r"^\s*\d*\s*(?:LBL\s+(?:\d+|\")|CALL\s+LBL\b)",
        },
        {"an assignment to a Q parameter": r"^\s*\d*\s*Q[LRS]?\d+\s*=\s*\S", "rapid feed": r"\bFMAX\b"},
    ),
    *_rules(
        "Heidenhain (DIN/ISO)",
        {
            "the head of a DIN/ISO program": r"^\s*%\s*\w+\s+G7[01]\s*\*",
            "the end of a DIN/ISO program": r"N99999999\s*%",
        },
        {
            "the end of a block": r"^\s*(?:N\d+\s*)?[GXYZTMFIJRHDL][^*;(]*\d\s*\*\s*$",
            "a blank by G30 and G31": r"^\s*N\d+\s*G30\s*G17\s*X.*\*",
            "Q parameter arithmetic": r"^\s*N\d+\s*D\d\d\s+Q\d+\s+P\d+",
        },
    ),
    *_rules(
        "Okuma OSP",
        {
            "the name of an OSP file": r"^\s*\$\w[\w\-]*\.(?:MIN|SUB|SSB|LIB|MSB)\s*%",
            "an OSP system variable": r"\bVZOF[XYZABC]\b|\bVTOF[HD]\b|\bVRSTT\b|\bVTLC[NM]\b|\bVC\d{1,3}\s*=",
            "an OSP call": r"(?:^|\s)(?:CALL|MODIN)\s+O[A-Z0-9]{1,4}\b(?!\s*(?:SUB|CALL))",
            "an OSP jump": r"^\s*(?:N\w+\s*)?IF\s*\[[^\]]*\]\s*N[A-Z]*\d*\s*$",
            "a branch": r"^\s*(?:N\w+\s*)?GOTO\s+N[A-Z]+\d*\b",
        },
        {
            "a block without a stop": r"(?:^|\s)NOEX\b",
            "a return from a subprogram": r"^\s*(?:N\w+\s*)?RTS\s*$",
            "a work coordinate system by number": r"\bG15\s*H\d+\b",
            "a tool length offset by G56": r"\bG56\s*H[A-C\d]",
        },
    ),
    *_rules(
        "Fagor",
        {
            "the head of a Fagor program": r"^\s*%\s*[\w .\-]+,\s*M?[X\-\s]{1,3},",
            "a Fagor instruction": r"^\s*(?:N\d+\s*)?#(?:CALL|RET|TOOL|CS|ACS|MPOS|HSC|WARNING|PROBE)\b",
        },
        {
            "a call of a subroutine": r"\(\s*(?:PCALL|MCALL|CALL|RPT)\s+[\dN]",
            "a Fagor local variable": r"\(P\d+\s*=",
        },
        raw=True,
    ),
    *_rules("Mazatrol", {"a Mazatrol unit": r"^\s*UNo?\.?\s+(?:UNIT|MAT)\b|MAZATROL\s+PROGRAM"}),
    *_rules(
        "APT cutter location data",
        {
            "an APT statement": r"^\s*(?:GOTO|CUTTER|LOADTL|PARTNO|SPINDL|FEDRAT|FROM|PPRINT|GODLTA|MULTAX|COOLNT)\s*/",
            "the name of a part": r"^\s*PARTNO\b",
            "the end of APT data": r"^\s*FINI\s*$",
        },
        {"rapid": r"^\s*RAPID\s*$"},
    ),
    *_rules(
        "a plotter (HPGL)",
        {"plotter commands": r"^\s*(?:IN|DF|PA|PU|SP\d?)\s*;\s*(?:(?:IN|IP|SP|PU|PD|PA|VS|SC)[-\d,. ]*;)+"},
        raw=True,
    ),
    *_rules(
        "a drilling machine for circuit boards (Excellon)",
        {"a tool with its diameter": r"^\s*T\d{1,3}(?:F\d+S\d+)?C\d*\.\d+(?:F\d+S\d+)?\s*$"},
        {"the format of an Excellon file": r"^\s*(?:METRIC|INCH)\s*(?:,\s*[LT]Z)?\s*$"},
    ),
    *_rules(
        "a 3D printer",
        {
            "an extruder": r"^\s*G[01]\s[^(;]*\bE-?\d*\.\d+",
        },
        {
            "the temperature of a nozzle": r"^\s*(?:N\d+\s*)?M10[49]\s*S\d",
            "the temperature of a bed": r"^\s*(?:N\d+\s*)?M1[49]0\s*S\d",
            "extrusion lengths": r"^\s*M8[23]\b",
            "the extruder at 0": r"^\s*G92\s+E0",
        },
    ),
    *_rules(
        "a 3D printer",
        {"what a slicer wrote": r"^\s*;\s*(?:FLAVOR\s*:|generated by (?:PrusaSlicer|Cura|Slic3r))"},
        raw=True,
    ),
)


def recognise(head: str) -> Foreign | None:
    """Finds what other control, or kind of file, a text is for.

    Args:
        head: the beginning of the text; the first `MOST_COLUMNS` characters of its first `MOST_LINES` lines are
            looked at.

    Returns:
        The first mark of what it was recognised as, None for a text that may be a program of the dialects here.
    """
    found: dict[str, tuple[int, Foreign]] = {}
    seen: set[Rule] = set()
    for number, line in enumerate(head.split("\n")[:MOST_LINES], start=1):
        for rule, match in _marks(line[:MOST_COLUMNS], number):
            if rule in seen:
                continue
            seen.add(rule)
            weight, first = found.get(rule.control, (0, _foreign(rule, number, match)))
            if weight + rule.weight >= PROOF:
                return first
            found[rule.control] = (weight + rule.weight, first)
    return None


def _marks(line: str, number: int) -> Iterator[tuple[Rule, re.Match[str]]]:
    bare = _without_comments(line)
    for rule in RULES:
        if rule.first and number > 1:
            continue
        text = line if rule.raw else bare
        match = rule.pattern.match(text) if rule.first else rule.pattern.search(text)
        if match is not None:
            yield rule, match


def _without_comments(line: str) -> str:
    """The line with blanks inside its brackets and nothing after a semicolon; columns stay."""
    return re.sub(r"\([^)]*", lambda match: "(" + " " * (len(match[0]) - 1), line).partition(";")[0]


def _foreign(rule: Rule, number: int, match: re.Match[str]) -> Foreign:
    lead = len(match[0]) - len(match[0].lstrip())
    return Foreign(
        line=number,
        column=match.start() + lead + 1,
        marker=match[0].strip()[:40],
        reason=rule.what,
        control=rule.control,
    )
