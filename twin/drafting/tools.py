"""The tools of a program: from its comments and a library, with defaults of the trade for the rest."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from twin.drafting.comments.program_text import ProgramText, Unit
from twin.drafting.comments.tool_posts import ToolComment, tool_comments
from twin.drafting.comments.tool_words import ToolStatement, rounded
from twin.drafting.cuts import Feed
from twin.drafting.notes import Notes
from twin.drafting.tables import DraftTable

#: Kinds that a replay cuts with, by the kind of the job file that represents them.
MILLS = {"flat": "flat", "ball": "ball", "bull": "bull", "taper": "taper", "face mill": "flat", "chamfer mill": "taper"}
_NOT_STATED = "the program does not state it"
#: Diameter to draw a tool of unknown size with, mm.
_UNKNOWN_MM: Mapping[Unit, float] = {"mm": 6.0, "inch": 6.35}
_HELIX_DEG = 30.0
#: Face mills: flutes by diameter, mm.
_FACE_TEETH = ((40.0, 4), (63.0, 5), (80.0, 6), (125.0, 7))
_TIP_MM = 0.3
_TAPER_HALF_DEG, _CHAMFER_HALF_DEG = 3.0, 45.0
_CORNER_PART = 0.1
#: Length of the flutes of a usual end mill, in diameters, and the least that they extend above the material, mm.
_FACE_FLUTES_MM = 10.0
_FLUTE_DIAMETERS, _FLUTE_MORE_MM, _FLUTE_STEP_MM = 2.5, 1.0, 0.5
_SAME = 0.005


@dataclass(frozen=True, slots=True, kw_only=True)
class DraftTool:
    """A tool of a draft.

    Attributes:
        number: tool number.
        states: all that is known of it; its kind and diameter are given, assumed if need be.
        known: the diameter is stated; without it, forces are not computed.
        library: keys of the job file from a tool library, None without one.
        where: where its values are from, in words.
    """

    number: int
    states: ToolStatement
    known: bool
    library: Mapping[str, Any] | None = None
    where: str = ""

    @property
    def kind(self) -> str:
        """Kind, that of the trade."""
        return self.states.kind or "flat"

    @property
    def diameter_mm(self) -> float:
        """Diameter."""
        assert self.states.diameter_mm is not None
        return self.states.diameter_mm

    @property
    def tip_mm(self) -> float:
        """Diameter at the tip: chamfer and engraving tools are named by their largest diameter."""
        return min(_TIP_MM, 0.5 * self.diameter_mm) if self.kind == "chamfer mill" else self.diameter_mm

    @property
    def cuts(self) -> bool:
        """Whether forces are computed: an end mill of known diameter."""
        return self.kind in MILLS and self.known


def stated_tools(text: ProgramText, used: Sequence[int], notes: Notes) -> dict[int, ToolStatement]:
    """Values that the comments state about each tool; contradictions are noted.

    Args:
        used: numbers of the tools that cut, in order.
    """
    by_tool: dict[int, list[ToolComment]] = {}
    for found in tool_comments(text.comments, text.unit):
        number = _number(found, text, used)
        if number is not None:
            by_tool.setdefault(number, []).append(found)
    merged = {number: _merged(number, found, notes) for number, found in by_tool.items()}
    for number in used:
        if number in merged:
            notes.stated.append(f"T{number} {merged[number]} (line {by_tool[number][0].comment.line})")
    return merged


def _number(found: ToolComment, text: ProgramText, used: Sequence[int]) -> int | None:
    if found.states.number is not None:
        return found.states.number
    if len(used) == 1:
        return used[0]
    word = text.tool_at(found.comment.line)
    return None if word is None else word.number


def _merged(number: int, found: Sequence[ToolComment], notes: Notes) -> ToolStatement:
    """The values of several comments about one tool: the first one counts, in the order of the program."""
    first = found[0]
    merged = first.states
    for other in found[1:]:
        a, b = merged.diameter_mm, other.states.diameter_mm
        if a is not None and b is not None and abs(a - b) > _SAME * max(a, b):
            notes.warnings.append(
                f"T{number}: line {first.comment.line} states D{a:g} mm ({first.comment.text}), line "
                f"{other.comment.line} D{b:g} mm ({other.comment.text}); the first is taken"
            )
            continue
        merged = merged.over(other.states)
    return merged


def completed(
    number: int, states: ToolStatement | None, unit: Unit, notes: Notes, drills: str | None = None
) -> DraftTool:
    """A tool with kind and diameter, assumed where nothing states them.

    Args:
        drills: kind of a tool whose motions are those of a drill or a tap, None for another one.
    """
    known = states is not None and states.diameter_mm is not None
    states = states or ToolStatement(number=number)
    subject = f"T{number}"
    if not known:
        size = _UNKNOWN_MM[unit]
        states = states.over(ToolStatement(diameter_mm=size))
        notes.open.append(
            f"T{number}: the program does not state its diameter; drawn with D{size:g} mm, and no forces are computed "
            f"for it; give --tools LIBRARY, or diameter_mm in the job file (twin job)"
        )
    if states.kind is None and drills is not None:
        states = states.over(ToolStatement(kind=drills))
        notes.assume(subject, f"a {drills}", "it only moves along Z" if drills == "drill" else "it only taps")
    if states.kind in (None, "flat") and states.corner_radius_mm and states.diameter_mm:
        states = replace(states, kind=rounded(states.corner_radius_mm, states.diameter_mm))
    if states.kind is None:
        states = states.over(ToolStatement(kind="flat"))
        notes.assume(subject, "a flat end mill", _NOT_STATED)
    elif states.kind not in MILLS and known:
        notes.assume(
            subject, f"a cylinder of D{states.diameter_mm:g} mm without forces", f"a {states.kind} is not simulated"
        )
    return DraftTool(number=number, states=states, known=known)


def drilling_kind(feed: Feed) -> str | None:
    """Kind of a tool by its motions: ``tap`` or ``drill`` where it only moves along Z, None for another one."""
    if not len(feed.tool) or feed.sideways.any():
        return None
    return "tap" if feed.tapping.any() else "drill"


def tool_table(tool: DraftTool, depth_mm: float, cutting: Mapping[str, Any] | None, notes: Notes) -> DraftTable:
    """The ``[[tools]]`` table of a tool.

    Args:
        depth_mm: how deep it goes below the top of the stock.
        cutting: its own coefficients, None for those of all.
    """
    table = DraftTable(name="tools", listed=True)
    table.add("number", tool.number)
    if tool.library is not None:
        _from_library(table, tool, depth_mm, notes)
    else:
        _from_comments(table, tool, depth_mm, notes)
    if cutting is not None:
        table.add("cutting", dict(cutting))
    return table


def _from_comments(table: DraftTable, tool: DraftTool, depth_mm: float, notes: Notes) -> None:
    s, kind = tool.states, MILLS.get(tool.kind, "flat")
    if tool.kind == "face mill" and s.corner_radius_mm:
        kind = "bull"
    if s.name:
        table.add("name", s.name)
    assumed = _Assumed(table, tool, notes)
    table.add("kind", kind, "" if kind == tool.kind else f"a {tool.kind}, represented as {kind}")
    if tool.known:
        diameter = tool.tip_mm
        tip = tool.kind == "chamfer mill"
        table.add("diameter_mm", diameter, "assumed: the program does not state the diameter of the tip" if tip else "")
        if tip:
            notes.assume(f"T{tool.number}", f"D{diameter:g} mm at the tip", _NOT_STATED)
    else:
        table.add("diameter_mm", tool.diameter_mm, "CHECK: the program does not state it; no forces for this tool")
    if kind == "bull":
        corner = s.corner_radius_mm
        assumed.add(
            "corner_radius_mm", corner, max(0.1, round(_CORNER_PART * tool.diameter_mm, 1)), "corner radius {:g} mm"
        )
    half = None
    if kind == "taper":
        default = _CHAMFER_HALF_DEG if tool.kind == "chamfer mill" else _TAPER_HALF_DEG
        half = s.angle_deg if s.angle_deg and s.angle_deg < 90.0 else None
        half = assumed.add("taper_deg", half, default, "half angle {:g} deg")
    assumed.add("teeth", s.teeth, _teeth(tool), "{} flutes")
    assumed.add("helix_deg", s.helix_deg, _helix(tool), "helix {:g} deg")
    _flutes(assumed, tool, depth_mm, half)


class _Assumed:
    """Adds keys with the program's value, or a default that is noted."""

    def __init__(self, table: DraftTable, tool: DraftTool, notes: Notes) -> None:
        self._table, self._subject, self._notes = table, f"T{tool.number}", notes
        self._noted = tool.kind in MILLS

    def warn(self, text: str) -> None:
        """Note a contradiction."""
        self._notes.warnings.append(f"{self._subject}: {text}")

    def add(self, key: str, stated: Any, default: Any, words: str, reason: str = _NOT_STATED) -> Any:
        """Add a key; returns its value."""
        if stated is not None:
            self._table.add(key, stated)
            return stated
        self._table.add(key, default, f"assumed: {reason}")
        if self._noted:
            self._notes.assume(self._subject, words.format(default), reason)
        return default


def _teeth(tool: DraftTool) -> int:
    """Flutes of usual tools: two on ball-nose and small end mills, four on end mills from 6 mm, more on face mills."""
    if tool.kind == "face mill":
        return next((teeth for size, teeth in _FACE_TEETH if tool.diameter_mm <= size), 8)
    return 4 if tool.kind in ("flat", "bull") and tool.diameter_mm >= 6.0 else 2


def _helix(tool: DraftTool) -> float:
    return 0.0 if tool.kind in ("face mill", "chamfer mill") or tool.kind not in MILLS else _HELIX_DEG


def _flutes(assumed: _Assumed, tool: DraftTool, depth_mm: float, half_deg: float | None) -> None:
    size = tool.diameter_mm
    if tool.kind == "chamfer mill" and half_deg is not None and tool.states.flute_length_mm is None:
        length = 0.5 * (size - tool.tip_mm) / math.tan(math.radians(half_deg))
        assumed.add("flute_length_mm", None, round(max(length, 0.1), 3), "flute length {:g} mm", "up to its diameter")
        return
    usual = _FLUTE_DIAMETERS * size if tool.kind != "face mill" else _FACE_FLUTES_MM
    rounded_mm = 0.5 * size if tool.kind == "ball" else tool.states.corner_radius_mm or 0.0
    stated = tool.states.flute_length_mm
    if stated is not None and stated < rounded_mm:
        assumed.warn(f"its comment states a flute length of {stated:g} mm, less than its corner radius; it is not used")
        stated = None
    needed = max(usual, depth_mm + _FLUTE_MORE_MM)
    length = min(math.ceil(needed / _FLUTE_STEP_MM) * _FLUTE_STEP_MM, 1000.0)
    reason = _NOT_STATED
    if length > usual + _FLUTE_STEP_MM:
        reason = f"the program goes {depth_mm:.4g} mm deep, {depth_mm / size:.2g} diameters"
    assumed.add("flute_length_mm", stated, length, "flute length {:g} mm", reason)


def _from_library(table: DraftTable, tool: DraftTool, depth_mm: float, notes: Notes) -> None:
    values = {key: value for key, value in (tool.library or {}).items() if key != "number"}
    for key, value in values.items():
        table.add(key, value)
    assumed = _Assumed(table, tool, notes)
    reason = "the library does not state it"
    if "teeth" not in values:
        assumed.add("teeth", None, _teeth(tool), "{} flutes", reason)
    if "helix_deg" not in values:
        assumed.add("helix_deg", None, _helix(tool), "helix {:g} deg", reason)
    if "flute_length_mm" not in values:
        _flutes(assumed, tool, depth_mm, values.get("taper_deg"))
