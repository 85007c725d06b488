"""Spindle and coolant of plain lines: the speed and sense at each motion, and the changes that are reported."""

from __future__ import annotations

from typing import Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from gcode.bulk.plain_rules import PlainRules, PlainStart

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
#: Senses of the spindle as values of `MotionState`.
DIRECTIONS: dict[int, Literal[-1, 0, 1]] = {1: 1, -1: -1, 0: 0}


class Changes(NamedTuple):
    """Changes of spindle (M3, M4, M5, another S) and coolant (M7, M8, M9), in their order. All arrays are (m,).

    Attributes:
        line: line of each.
        after: True where it comes after the motion of its block.
        coolant: True for a change of coolant, False for one of the spindle.
        rpm: commanded speed from there on.
        direction: sense of the spindle from there on.
        mist: True where mist is on from there on.
        flood: True where flood is on from there on.
    """

    line: Ints
    after: NDArray[np.bool_]
    coolant: NDArray[np.bool_]
    rpm: Floats
    direction: Ints
    mist: NDArray[np.bool_]
    flood: NDArray[np.bool_]


class Functions(NamedTuple):
    """Spindle and coolant of n lines.

    Attributes:
        rpm: (n,) speed from each line on, its motion included.
        direction_at_motion: (n,) sense of the spindle during the motion of each line.
        direction_after: sense after the last line.
        mist_after: whether mist is on after the last line.
        flood_after: whether flood is on after the last line.
        changes: with lines as numbers in the program.
    """

    rpm: Floats
    direction_at_motion: Ints
    direction_after: Literal[-1, 0, 1]
    mist_after: bool
    flood_after: bool
    changes: Changes


class MCodes(Protocol):
    """The M words of plain lines, at most one in a line."""

    @property
    def line(self) -> Ints:
        """Line of each, counted from 0, rising."""

    @property
    def value(self) -> Floats:
        """Number of each."""


_NONE = Changes(*(np.empty(0, kind) for kind in (np.int64, bool, bool, np.float64, np.int64, bool, bool)))


def plain_functions(
    speeds: tuple[Ints, Floats], codes: MCodes, start: PlainStart, rules: PlainRules, count: int
) -> Functions:
    """Spindle and coolant of `count` lines.

    Args:
        speeds: lines with an S word, and the speed that holds in each of the `count` lines.
        codes: M words.
        start: the control before the first line.
        rules: the control's rules.
        count: number of lines.
    """
    speed_line, rpm = speeds
    if not speed_line.size and not codes.line.size:
        direction = np.full(count, start.spindle_direction, dtype=np.int64)
        return Functions(rpm, direction, start.spindle_direction, start.mist, start.flood, _NONE)
    code = np.zeros(count, dtype=np.int64)
    code[codes.line] = codes.value
    direction = _held(code, {3: 1, 4: -1, 5: 0}, start.spindle_direction)
    before = np.append(start.spindle_direction, direction[:-1])
    mist, flood = _held(code, {7: 1, 9: 0}, start.mist), _held(code, {8: 1, 9: 0}, start.flood)
    late = np.isin(code, list(rules.after_motion))
    changed = speed_line[rpm[speed_line] != np.append(start.spindle_rpm, rpm[:-1])[speed_line]]
    changed = changed[~np.isin(code[changed], (3, 4))]  # these report the speed themselves
    line = np.concatenate([changed, codes.line])
    order = np.argsort(line, kind="stable")
    line, by_speed = line[order], (np.arange(line.size) < changed.size)[order]
    changes = Changes(
        line=line + start.line,
        after=late[line] & ~by_speed,
        coolant=(code[line] >= 7) & ~by_speed,
        rpm=rpm[line],
        direction=np.where(by_speed, before[line], direction[line]),
        mist=mist[line] != 0,
        flood=flood[line] != 0,
    )
    at_motion = np.where(late, before, direction)
    last = DIRECTIONS[int(direction[-1])]
    return Functions(rpm, at_motion, last, bool(mist[-1]), bool(flood[-1]), changes)


def _held(code: Ints, values: dict[int, int], first: int) -> Ints:
    """Modal value in each line: `first`, and from each of the codes on its value."""
    latest = np.where(np.isin(code, list(values)), np.arange(1, code.size + 1), 0)
    table = np.zeros(10, dtype=np.int64)
    for number, value in values.items():
        table[number] = value
    return np.append(int(first), table[code])[np.maximum.accumulate(latest)]
