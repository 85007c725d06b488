"""Events of an interpreted NC program: frozen, typed values in the order of execution.

Lengths are mm, feeds mm/min, spindle speeds rpm, whatever units the program was written in. Points are the
controlled point (the tool tip as the control knows it) in machine coordinates: the gauge point less the
active tool length offset. Arcs stay arcs; the consumer chooses the chords.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

from gcode.errors import Place

Point: TypeAlias = tuple[float, float, float]
Plane: TypeAlias = Literal[17, 18, 19]
FeedMode: TypeAlias = Literal["per-minute", "inverse-time", "per-revolution"]
Side: TypeAlias = Literal["off", "left", "right"]
#: Positions of the axes A, B, C (degrees) and U, V, W (mm) in machine coordinates.
Extra: TypeAlias = tuple[float, float, float, float, float, float]

NO_EXTRA: Extra = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

#: Coordinate indices (first, second, normal) of each plane; the order makes a right-handed frame.
PLANE_AXES: dict[int, tuple[int, int, int]] = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionState:
    """The modal values that hold during a motion.

    Attributes:
        tool: number of the tool in the spindle (M6 done), 0 for none.
        spindle_rpm: commanded speed, >= 0; it turns only where ``spindle_direction`` is not 0.
        spindle_direction: +1 for M3 (clockwise seen from above the tool), -1 for M4, 0 stopped.
        length_offset_mm: active tool length offset along z (G43/G44, signed), 0 with G49.
        tool_offset_xy_mm: the active tool's offset in x and y, which only some controls have.
        wcs: name of the active work offset, e.g. ``G54``.
        plane: active plane, 17, 18 or 19.
        feed_mode: meaning of F: ``per-minute`` (G94), ``inverse-time`` (G93) or ``per-revolution`` (G95).
        length_number: number of the active length offset (H), None without one.
        radius_number: number of the active cutter compensation (D), None without one.
        compensation: ``off`` (G40), ``left`` (G41) or ``right`` (G42).
    """

    tool: int = 0
    spindle_rpm: float = 0.0
    spindle_direction: Literal[-1, 0, 1] = 0
    length_offset_mm: float = 0.0
    tool_offset_xy_mm: tuple[float, float] = (0.0, 0.0)
    wcs: str = "G54"
    plane: Plane = 17
    feed_mode: FeedMode = "per-minute"
    length_number: int | None = None
    radius_number: int | None = None
    compensation: Side = "off"


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearMotion:
    """A straight motion (G0, G1, a leg of G28/G53, a stroke of a canned cycle). Its length may be 0.

    Attributes:
        rapid: True for a positioning motion at the machine's rapid rate; then ``feed_mm_min`` is 0.
        feed_mm_min: speed of the controlled point along the path; with G95 that at the commanded spindle speed.
        tapping: True where the feed follows the spindle's angle (tapping in or out of a thread).
        extra: positions of the further axes at the motion's end.
    """

    place: Place
    state: MotionState
    start_mm: Point
    end_mm: Point
    rapid: bool
    feed_mm_min: float
    tapping: bool = False
    extra: Extra = NO_EXTRA


@dataclass(frozen=True, slots=True, kw_only=True)
class ArcMotion:
    """A circular or helical motion (G2/G3), never pre-chorded.

    Attributes:
        centre_mm: centre as programmed; its coordinate along the plane's normal equals the start's. The distances of
            start and end from it may differ by what the control tolerates (`Dialect.arc_tolerance`): then the radius
            goes from one to the other in proportion to the angle, so that both ends are met.
        turns: signed count of turns, never 0: +1 is counter-clockwise about the plane's positive normal with more
            than 0 and at most one full turn, -1 clockwise, +2 one full turn more, and so on. Start and end at the
            same place in the plane make a full circle.
        feed_mm_min: feed along the (helical) path.
        extra: positions of the further axes at the motion's end.
    """

    place: Place
    state: MotionState
    start_mm: Point
    end_mm: Point
    centre_mm: Point
    plane: Plane
    turns: int
    feed_mm_min: float
    extra: Extra = NO_EXTRA

    @property
    def sweep_rad(self) -> float:
        """Signed angle swept in the plane, counter-clockwise about its positive normal positive."""
        i, j, _ = PLANE_AXES[self.plane]
        start = math.atan2(self.start_mm[j] - self.centre_mm[j], self.start_mm[i] - self.centre_mm[i])
        end = math.atan2(self.end_mm[j] - self.centre_mm[j], self.end_mm[i] - self.centre_mm[i])
        sign = 1.0 if self.turns > 0 else -1.0
        one = (sign * (end - start)) % (2.0 * math.pi)
        if (self.start_mm[i], self.start_mm[j]) == (self.end_mm[i], self.end_mm[j]) or one == 0.0:
            one = 2.0 * math.pi
        return sign * (one + 2.0 * math.pi * (abs(self.turns) - 1))


@dataclass(frozen=True, slots=True, kw_only=True)
class Dwell:
    """G4: the axes wait; the spindle keeps its state."""

    place: Place
    state: MotionState
    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolChange:
    """M6: ``tool`` is now in the spindle."""

    place: Place
    tool: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleChange:
    """M3, M4, M5 or a new S; see `MotionState` for the meaning of the fields."""

    place: Place
    spindle_rpm: float
    spindle_direction: Literal[-1, 0, 1]


@dataclass(frozen=True, slots=True, kw_only=True)
class CoolantChange:
    """Coolant: which of mist (M7) and flood (M8) are on; M9 turns both off."""

    place: Place
    mist: bool
    flood: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramStop:
    """M0, M1 (``optional``), or the end by M2/M30/% (``end``). Execution continues after a stop.

    Attributes:
        message: text that the program shows with the stop.
    """

    place: Place
    optional: bool
    end: bool
    message: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """One block begins to execute. Comes before the block's other events."""

    place: Place


#: Codes of notices that are warnings: the control may do something else than the programmer meant.
WARNINGS = frozenset(
    {"auto-dialect", "build-option", "control-text", "g53-incremental", "last-of-group", "other-dialect", "radius-zero"}
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Notice:
    """A word that is understood and has no effect on motion here, reported so that nothing is skipped silently."""

    place: Place
    code: str
    text: str

    @property
    def is_warning(self) -> bool:
        """True where the control may do something else than the programmer meant."""
        return self.code in WARNINGS


Motion: TypeAlias = LinearMotion | ArcMotion
Event: TypeAlias = (
    Block | LinearMotion | ArcMotion | Dwell | ToolChange | SpindleChange | CoolantChange | ProgramStop | Notice
)
