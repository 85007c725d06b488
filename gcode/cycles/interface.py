"""Input and output of a canned cycle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from gcode.cycles.steps import Position, Step

_NOTHING: Mapping[str, float] = MappingProxyType({})


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleInput:
    """One block in a cycle mode. Lengths are mm, positions program coordinates of the active plane.

    Attributes:
        code: the cycle, e.g. ``G81``, from this block or from one before it.
        words: this block's words by letter. X, Y, Z, R, I, J, Q, and K that is not a repeat
            count, are lengths in mm; P, L and a repeating K are as written. Other letters (F, S, N...) are ignored.
        sticky: `CycleOutput.sticky` of the last block run in a cycle mode; empty before the first. For controls
            that forget words when the mode is left, `first_of_mode` marks this, so nothing need be cleared.
        position: the controlled point, as the control knows it.
        axes: letters of the plane's first and second axis and of its normal: ``XYZ`` for G17, ``ZXY``, ``YZX``.
        absolute: True for G90.
        return_to_r: True for G99.
        initial_level: coordinate along the normal of the tool when the cycle mode was entered.
        spindle_direction: +1 for M3, -1 for M4, 0 stopped.
        feed_known: a feed was programmed.
        first_of_mode: no cycle was active before this block.
        rigid: rigid tapping is requested (M29); the spindle is then stopped before and after the tap.
        unit_mm: length of the program's unit, 25.4 in inches.
        pointed: letters of this block's words that are written with a decimal point.
    """

    code: str
    words: Mapping[str, float]
    position: Position
    sticky: Mapping[str, float] = field(default_factory=lambda: _NOTHING)
    axes: tuple[str, str, str] = ("X", "Y", "Z")
    absolute: bool = True
    return_to_r: bool = False
    initial_level: float
    spindle_direction: int = 0
    feed_known: bool = True
    first_of_mode: bool = True
    rigid: bool = False
    unit_mm: float = 1.0
    pointed: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleOutput:
    """The steps of a block in a cycle mode.

    Attributes:
        sticky: input of the next block in a cycle mode.
        steps: steps of all repeats, in order; empty where the block drills nothing.
        position: the controlled point afterwards, as the control knows it. It differs from the last
            motion's end only after LinuxCNC's G88, which leaves the retraction to the operator, and after its
            tapping in G18 and G19.
    """

    sticky: Mapping[str, float]
    steps: tuple[Step, ...]
    position: Position
