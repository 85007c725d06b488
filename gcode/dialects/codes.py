"""The tables of G and M codes: the modal group, the treatment and the words of each.

A rule is data. The interpreter looks codes up and has no if-chain over them, so a dialect consists of these
tables with its own rows in place of some (see `dialects`), and a code that is in no table is refused as unknown.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias

from gcode.cycles import CycleRules


class Status(Enum):
    """Treatment of a code."""

    EXECUTED = "executed"
    NEUTRAL = "cancels or sets what always holds here, so it changes nothing"
    NOTICE = "has no motion here; a notice says so"
    REFUSED = "refused by name"


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeRule:
    """One G or M code of a dialect.

    Attributes:
        code: canonical name, e.g. ``G1``, ``G54.1``.
        groups: modal groups; two codes that share one are not allowed in one block.
        status: its treatment.
        phase: step in the order of execution of a block (`Dialect.order`); empty where nothing is to be done.
        letters: letters of the words that it takes; ``*`` for every letter that nothing else takes.
        needs: letters of the words that must be in the same block.
        takes_axes: True where its axis words are its own, so that the block has no motion besides.
        meaning: its meaning in words, for messages and reference tables.
        option: the option with which the control must have been built to have it, empty where all have it.
    """

    code: str
    groups: tuple[str, ...]
    status: Status
    phase: str
    letters: str
    takes_axes: bool
    meaning: str
    needs: str = ""
    option: str = ""


Table: TypeAlias = Mapping[str, CodeRule]


def rules(
    groups: str,
    status: Status,
    meanings: Mapping[str, str],
    *,
    phase: str = "",
    letters: str = "",
    takes_axes: bool = False,
    needs: str = "",
    option: str = "",
) -> dict[str, CodeRule]:
    """Rows of a table that share everything but code and meaning; `groups` are names with blanks between."""
    return {
        code: CodeRule(
            code=code,
            groups=tuple(groups.split()),
            status=status,
            phase=phase,
            letters=letters,
            takes_axes=takes_axes,
            meaning=meaning,
            needs=needs,
            option=option,
        )
        for code, meaning in meanings.items()
    }


def executed(
    groups: str, phase: str, meanings: Mapping[str, str], letters: str = "", option: str = ""
) -> dict[str, CodeRule]:
    """Rows of codes that `phase` executes."""
    return rules(groups, Status.EXECUTED, meanings, phase=phase, letters=letters, option=option)


def owning(groups: str, phase: str, meanings: Mapping[str, str], letters: str) -> dict[str, CodeRule]:
    """Rows of codes that `phase` executes and whose axis words are their own."""
    return rules(groups, Status.EXECUTED, meanings, phase=phase, letters=letters, takes_axes=True)


def neutral(groups: str, meanings: Mapping[str, str], letters: str = "") -> dict[str, CodeRule]:
    """Rows of codes that request a mode that always holds here."""
    return rules(groups, Status.NEUTRAL, meanings, letters=letters)


def noticed(
    groups: str, meanings: Mapping[str, str], letters: str = "", needs: str = "", option: str = ""
) -> dict[str, CodeRule]:
    """Rows of codes that have no motion."""
    return rules(groups, Status.NOTICE, meanings, phase="notice", letters=letters, needs=needs, option=option)


def refused(groups: str, meanings: Mapping[str, str]) -> dict[str, CodeRule]:
    """Rows of codes that are known and not supported."""
    return rules(groups, Status.REFUSED, meanings)


#: Codes that all dialects share.
COMMON: Table = {
    **executed("motion", "modes", {"G0": "rapid positioning", "G1": "straight feed"}, "XYZ"),
    **executed("motion", "modes", {"G2": "clockwise arc", "G3": "counter-clockwise arc"}, "XYZIJKR"),
    **executed("plane", "modes", {"G17": "XY plane", "G18": "ZX plane", "G19": "YZ plane"}),
    **executed("units", "modes", {"G20": "inch", "G21": "millimetre"}),
    **executed("distance", "modes", {"G90": "absolute", "G91": "incremental"}),
    **executed("arc-centre", "modes", {"G90.1": "absolute arc centres", "G91.1": "incremental arc centres"}),
    **owning("one-shot", "reference", {"G28": "return to the reference point"}, "XYZ"),
    **owning("one-shot", "reference", {"G30": "return to a further reference point"}, "XYZP"),
    **owning("one-shot", "data", {"G10": "set offsets"}, "LPRXYZ"),
    **executed("one-shot", "", {"G53": "machine coordinates for one block"}),
    **owning("one-shot", "shift", {"G92": "coordinate system setting"}, "XYZ"),
    **executed("length", "length", {"G43": "tool length offset"}, "H"),
    **executed("length", "length", {"G49": "tool length offset cancel"}),
    **executed("compensation", "radius", {"G40": "cutter compensation cancel"}),
    **executed("work-offset", "work_offset", {f"G{n}": f"work offset {n - 53}" for n in range(54, 60)}),
    **executed("stop", "stop", {"M0": "program stop", "M1": "optional stop"}),
    **executed("stop", "stop", {"M2": "program end", "M30": "program end"}),
    **executed("spindle", "spindle_on", {"M3": "spindle clockwise", "M4": "spindle counter-clockwise"}),
    **executed("spindle", "spindle_off", {"M5": "spindle stop"}),
    **executed("mist", "coolant_on", {"M7": "mist coolant"}),
    **executed("flood", "coolant_on", {"M8": "flood coolant"}),
    **executed("mist flood", "coolant_off", {"M9": "coolant off"}),
    **executed("feed-mode", "feed_mode", {"G93": "inverse time feed", "G94": "feed per minute"}),
}

#: Codes that FANUC, Haas and LinuxCNC share, and GRBL does not have.
FULL: Table = {
    **COMMON,
    **executed("tool-change", "tool_change", {"M6": "tool change"}),
    **executed("compensation", "radius", {"G41": "cutter compensation left", "G42": "cutter compensation right"}, "D"),
    **executed("feed-mode", "feed_mode", {"G95": "feed per revolution"}),
    **executed("speed-mode", "speed_mode", {"G96": "constant surface speed"}, "D"),
    **executed("speed-mode", "speed_mode", {"G97": "constant spindle speed"}),
    **executed("return-level", "modes", {"G98": "return to the initial level", "G99": "return to the R level"}),
    **owning("one-shot", "shift", {"G52": "local coordinate system"}, "XYZ"),
    **executed("call", "call", {"M98": "subprogram call"}, "PLQK"),
    **executed("call", "call", {"M99": "subprogram end"}, "P"),
    **noticed("override", {"M48": "feed and speed overrides enabled", "M49": "feed and speed overrides disabled"}),
}

#: Words of every canned cycle of FANUC and Haas: hole, levels, peck, dwell or shift, repeats.
CYCLE_LETTERS = "XYZRQPIJKL"


def cycle_meanings(rules: CycleRules) -> dict[str, str]:
    """The canned cycles of a control, each with its meaning."""
    return {code: cycle.meaning for code, cycle in rules.cycles.items()}
