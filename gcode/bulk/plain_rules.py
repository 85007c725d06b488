"""The rules of a control that decide what is plain in a line, and the control before a run of plain lines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from gcode.dialects import Dialect
from gcode.dialects.codes import Status
from gcode.dialects.dialect import ArcTolerance
from gcode.events import Plane, Point
from gcode.language.block_parser import MAX_LINE
from gcode.settings import MachineSettings

#: Phases of the M codes that plain lines may hold, by the code.
_PHASES = {3: "spindle_on", 4: "spindle_on", 5: "spindle_off", 7: "coolant_on", 8: "coolant_on", 9: "coolant_off"}
NO_TOLERANCE = ArcTolerance(absolute_mm=0.0)
#: More than the digits of a plain N word hold.
_ANY_NUMBER = 10**9


@dataclass(frozen=True, slots=True, kw_only=True)
class PlainRules:
    """The rules of a control for the words of plain lines.

    Attributes:
        m_codes: those of M3 to M5 and M7 to M9 that it executes without a notice.
        after_motion: those of them that take effect after the motion of their block.
        explicit_code_moves: G0 or G1 without an axis word is a motion of length 0; else it only sets the mode.
        needs_axis_words: an arc must name an axis of its plane.
        feed_along_arc: F of a helix is the feed along its arc in the plane.
        radius_tolerance_mm: largest amount by which R may be shorter than half the chord.
        semicolon_ends_block: a semicolon ends a block, else it starts a comment.
        largest_block_number: largest number of an N word.
        most_characters: characters that a block may have.
        increment: a coordinate without a decimal point counts increments; a line that has one is not plain.
    """

    m_codes: frozenset[int] = frozenset()
    after_motion: frozenset[int] = frozenset()
    explicit_code_moves: bool = False
    needs_axis_words: bool = False
    feed_along_arc: bool = False
    radius_tolerance_mm: float = 0.0
    semicolon_ends_block: bool = True
    largest_block_number: int = _ANY_NUMBER
    most_characters: int = MAX_LINE
    increment: bool = False


def plain_rules(dialect: Dialect, settings: MachineSettings) -> PlainRules:
    """The rules of a dialect on a machine; the M codes of the machine builder are not plain."""
    executed = set()
    for number, phase in _PHASES.items():
        rule = dialect.codes.get(f"M{number}")
        if rule is not None and (rule.status, rule.phase, rule.option) == (Status.EXECUTED, phase, ""):
            executed.add(number)
    motion = dialect.order.index("motion")
    return PlainRules(
        m_codes=frozenset(executed.difference(settings.m_codes)),
        after_motion=frozenset(number for number in executed if dialect.order.index(_PHASES[number]) > motion),
        explicit_code_moves=dialect.explicit_code_moves,
        needs_axis_words=dialect.needs_axis_words,
        feed_along_arc=dialect.helix_feed_along_arc,
        radius_tolerance_mm=dialect.radius_tolerance_mm,
        semicolon_ends_block=dialect.semicolon_ends_block,
        largest_block_number=dialect.largest_block_number or _ANY_NUMBER,
        most_characters=dialect.most_characters or MAX_LINE,
        increment=settings.decimal_point == "increment" and bool(dialect.increment_letters),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PlainStart:
    """The control before a run of plain lines. Its frame is a translation, and F is a feed per minute.

    Attributes:
        position_mm: controlled point, machine coordinates.
        zero_mm: program zero in machine coordinates.
        unit_mm: length of the program's unit.
        absolute: True for G90.
        code: the active motion code: 0 for G0, 1 for G1, 2 for G2, 3 for G3.
        feed_mm_min: feed of the last F word, 0 before the first.
        line: number of the first line, counted from 1.
        plane: active plane.
        absolute_centres: True for G90.1.
        arc_tolerance: how far the radii at the ends of an arc may differ.
        spindle_rpm: commanded speed.
        spindle_direction: +1 for M3, -1 for M4, 0 stopped.
        mist: True while M7 is on.
        flood: True while M8 is on.
    """

    position_mm: Point
    zero_mm: Point
    unit_mm: float
    absolute: bool
    code: int
    feed_mm_min: float
    line: int
    plane: Plane = 17
    absolute_centres: bool = False
    arc_tolerance: ArcTolerance = NO_TOLERANCE
    spindle_rpm: float = 0.0
    spindle_direction: Literal[-1, 0, 1] = 0
    mist: bool = False
    flood: bool = False
