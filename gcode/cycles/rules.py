"""Canned cycles of a control as data: the steps in the hole, the words each takes, and how they are read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum, auto
from types import MappingProxyType
from typing import Literal


class Act(Enum):
    """One step of a cycle with the tool over the hole; ``clear`` is the level it returns to."""

    FEED_BOTTOM = auto()
    FEED_R = auto()
    FEED_CLEAR = auto()
    FEED_TOP = auto()
    RAPID_R = auto()
    RAPID_BOTTOM = auto()
    RAPID_CLEAR = auto()
    #: Pecks to the bottom, each with a retraction out of the hole.
    PECK = auto()
    #: Pecks to the bottom, each with a small retraction that breaks the chip.
    CHIP_BREAK = auto()
    #: Off the hole's axis, at the level where the tool is, and back.
    SHIFT = auto()
    UNSHIFT = auto()
    DWELL = auto()
    STOP = auto()
    RESTART = auto()
    ORIENT = auto()
    OPERATOR = auto()
    #: The spindle turns the tap in (rigid tapping starts it), then out, then as it did before the cycle.
    TAP_START = auto()
    TAP_REVERSE = auto()
    TAP_END = auto()
    TAP_BOTTOM = auto()
    TAP_R = auto()
    TAP_CLEAR = auto()


@dataclass(frozen=True, slots=True, kw_only=True)
class Cycle:
    """One canned cycle of a control.

    Attributes:
        code: canonical name, e.g. ``G83``.
        meaning: its meaning in words, for messages and reference tables.
        acts: its steps in the hole, in order.
        takes: letters of words of its own, besides the axes, R and the repeat.
        needs: those of them that must be given, now or by an earlier block.
        inherits: those that are taken from any cycle before, also from one of another code or mode.
        shift: it moves off the hole's axis, by Q or by I, J, K.
        approach: the tool is brought to R before the acts.
        returns_to_initial: it always returns to the initial level, whatever G98 and G99 state.
        repeats: it takes the repeat word.
        forward: direction in which the spindle turns a tap in, 0 where it is not a tapping cycle.
        spindle: directions in which the spindle may turn when it starts.
        unsupported: words that are refused by name, with their meaning.
    """

    code: str
    meaning: str
    acts: tuple[Act, ...]
    takes: str = ""
    needs: str = ""
    inherits: str = ""
    shift: bool = False
    approach: bool = True
    returns_to_initial: bool = False
    repeats: bool = True
    forward: int = 0
    spindle: tuple[int, ...] = (-1, 0, 1)
    unsupported: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def pecks(self) -> bool:
        """True where it goes down in pecks."""
        return Act.PECK in self.acts or Act.CHIP_BREAK in self.acts


@dataclass(frozen=True, slots=True, kw_only=True)
class DwellUnit:
    """How P is read.

    Attributes:
        seconds: length of one unit of P.
        whole: P must be a whole number.
        pointed_seconds: length of one unit of a P that is written with a decimal point; None where that is the same.
    """

    seconds: float
    whole: bool = False
    pointed_seconds: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleRules:
    """Canned cycles of a control. Lengths are mm.

    Attributes:
        name: the control, for messages.
        cycles: its cycles by code.
        absent: codes from G73 to G89 that are not hole-making cycles on this control, with their meaning.
        repeat_letters: letters of the repeat count.
        stores_zero_repeats: a repeat count of 0 stores the words and drills nothing; else it is refused.
        memory: how long words are kept: ``mode`` for all cycles until cycle mode ends (G80 or a motion code),
            ``code`` only for blocks with the same cycle code.
        levels_keep_mode: R and the bottom stay absolute or incremental as programmed; else the distance mode (G90, G91)
            of the present block decides how a stored number is read.
        sticky_in_program_unit: stored words are kept as numbers in the program's unit, so G20 or G21 changes
            their length.
        needs_r: R must be programmed; else the initial level is used as R if none is programmed.
        needs_axis: a cycle block without axis words is refused; else a block without axis words and R drills
            nothing and stores nothing.
        refuses_r_below_bottom: R must not be below the bottom of the hole; else such a hole is drilled upwards.
        ignores_sign_of_q: a negative Q is used as its absolute value; else it is refused.
        stored: letters that a cycle does not use but keeps for other cycles; all other unused letters are refused.
        lift_first: a tool below R retracts to R before it moves in the plane. From the second hole of a block on, the
            tool is assumed to be at the return level, and the control continues from there whatever was moved.
        empty_moves: motions of length 0 are commanded as well.
        dwell: unit of P.
        retract_mm: retraction after each chip-breaking peck (G73).
        reentry_mm: distance above the last depth at which the rapid back into the hole ends (G83).
        reentry_within_r: neither of these two goes above R.
        above_r_mm: how far above R a peck is cleared.
        peck_tolerance_mm: a last peck this short is merged into the one before it.
        shift_direction: direction of the shift by Q (G76, G87) along the plane's first and second axis.
        always_rigid: tapping is rigid without M29.
        restart: direction in which the spindle restarts after a cycle stopped it: 1 for M3; None for the previous one.
        tap_follows_spindle: the feed of a tap is synchronised with the spindle; else it is a plain feed.
        tap_order: by the letter of the plane's normal, which of (first, second, normal) the control puts into each of
            the three in the strokes of a tap; planes that are not named keep the order.
    """

    name: str
    cycles: Mapping[str, Cycle]
    absent: Mapping[str, str]
    repeat_letters: str
    stores_zero_repeats: bool
    memory: Literal["mode", "code"]
    levels_keep_mode: bool
    sticky_in_program_unit: bool
    needs_r: bool
    needs_axis: bool
    refuses_r_below_bottom: bool
    ignores_sign_of_q: bool
    stored: str
    lift_first: bool
    empty_moves: bool
    dwell: DwellUnit
    retract_mm: float
    reentry_mm: float
    reentry_within_r: bool
    above_r_mm: float = 0.0
    peck_tolerance_mm: float = 0.0
    shift_direction: tuple[float, float] = (1.0, 0.0)
    always_rigid: bool = False
    restart: int | None = None
    tap_follows_spindle: bool = True
    tap_order: Mapping[str, tuple[int, int, int]] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        for name in ("cycles", "absent", "tap_order"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
