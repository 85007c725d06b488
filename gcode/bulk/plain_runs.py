"""Runs of plain lines executed at once: the bulk of surface programs, by the hundred thousand lines.

`plain_run` does what `step` does, for many lines of the words of `plain_words`, with the same numbers to the last bit.
It raises no errors: it stops before a line that is not plain or that must be refused, and leaves that line to `step`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from gcode.bulk.plain_arcs import ArcWords, arc_centres, path_feeds
from gcode.bulk.plain_functions import Changes, Functions, plain_functions
from gcode.bulk.plain_rules import PlainRules, PlainStart
from gcode.bulk.plain_words import WordArrays, plain_end, read_words

_T = TypeVar("_T", bound=np.generic)
#: Most lines of one run: enough that what a run costs besides its lines is nothing.
MAX_LINES = 16_384
#: Fewer lines are run faster one by one.
LEAST_LINES = 5


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PlainRun:
    """Consecutive plain lines and their motions. Arrays are read-only; n is the number of motions.

    Attributes:
        begin: byte offset of the first line.
        offset: byte offset after the last line.
        lines: how many lines there are; those without an axis word make no motion.
        block: numbers of the lines that have a word.
        line: (n,) number of each motion's line.
        end_mm: (n, 3) controlled points at the motions' ends, machine coordinates; each starts where the last ended.
        code: (n,) motion codes: 0 for G0, 1 for G1, 2 for G2, 3 for G3.
        feed_mm_min: (n,) feeds along the path, 0 for positioning motions.
        centre_mm: (n, 3) centres of arcs, nan for straight motions.
        spindle_rpm: (n,) commanded speeds.
        spindle_direction: (n,) +1, -1 or 0.
        changes: of spindle and coolant.
        after: the control after the last line, with the number of the next one.
        label_after: number of the last N word of these lines, None without one.
    """

    begin: int
    offset: int
    lines: int
    block: NDArray[np.int64]
    line: NDArray[np.int64]
    end_mm: NDArray[np.float64]
    code: NDArray[np.int64]
    feed_mm_min: NDArray[np.float64]
    centre_mm: NDArray[np.float64]
    spindle_rpm: NDArray[np.float64]
    spindle_direction: NDArray[np.int64]
    changes: Changes
    after: PlainStart
    label_after: int | None


def plain_run(
    buffer: bytes,
    offset: int,
    start: PlainStart,
    rules: PlainRules,
    *,
    max_lines: int = MAX_LINES,
    least_lines: int = LEAST_LINES,
) -> tuple[PlainRun | None, int]:
    """Runs the plain lines that begin at `offset`.

    Args:
        buffer: the program's text.
        offset: where a line begins.
        start: the control before that line.
        rules: the control's rules.
        max_lines: how many lines to take at most.
        least_lines: how many there must be.

    Returns:
        The lines up to the first one that is not plain or must be refused (no feed, a word given twice, an arc without
        a centre), None where they are too few; and how many lines were read in vain after them. The last line of a
        text without a line end is never plain.
    """
    end = plain_end(buffer, offset, max_lines, semicolon_ends_block=rules.semicolon_ends_block)
    count = buffer.count(b"\n", offset, end)
    if count < max(least_lines, 1):
        return None, 0
    words = read_words(buffer, offset, end)
    ends = np.flatnonzero(np.frombuffer(buffer, np.uint8, end - offset, offset) == ord("\n"))
    whole = Lines(start, rules, count, {letter: _column(words, letter) for letter in _LETTERS})
    too_long = np.flatnonzero(np.diff(ends, prepend=-1) > rules.most_characters + 1)
    lines = whole.before(min([whole.first_unread(), *too_long[:1].tolist()]))
    lines = lines.before(lines.first_without_feed())
    lines = lines.before(lines.first_arc_left())
    if lines.count < max(least_lines, 1):
        return None, count
    return lines.run(offset, offset + int(ends[lines.count - 1]) + 1), count - lines.count


_LETTERS = b"NGXYZIJKRFSM"
_N, _G, _X, _Y, _Z, _I, _J, _K, _R, _F, _S, _M = _LETTERS
_AXES = (_X, _Y, _Z)
_CENTRE = (_I, _J, _K, _R)


class Column(NamedTuple):
    """The words of one letter: the line of each, rising, its value, and whether it has a decimal point."""

    line: NDArray[np.int64]
    value: NDArray[np.float64]
    pointed: NDArray[np.bool_]

    def before(self, line: int) -> Column:
        """The words that stand before a line."""
        stop = int(np.searchsorted(self.line, line))
        return Column(self.line[:stop], self.value[:stop], self.pointed[:stop])

    def held(self, first: float, count: int, values: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
        """Modal value in each of `count` lines: `first`, and from each word on its entry of `values` or its value."""
        values = self.value if values is None else values
        if self.line.size == count:
            return values
        if not self.line.size:
            return np.full(count, first)
        latest = np.zeros(count, dtype=np.int64)
        latest[self.line] = np.arange(1, self.line.size + 1)
        return np.append(first, values)[np.maximum.accumulate(latest)]

    def spread(self, count: int) -> NDArray[np.float64]:
        """Value in each of `count` lines, nan where there is no word."""
        values = np.full(count, np.nan)
        values[self.line] = self.value
        return values


def _column(words: WordArrays, letter: int) -> Column:
    at = np.flatnonzero(words.letter == letter)
    return Column(words.line[at], words.value[at], words.pointed[at])


@dataclass(frozen=True, eq=False)
class Lines:
    """Plain lines, taken apart; no letter occurs twice in one once `first_unread` was cut off."""

    start: PlainStart
    rules: PlainRules
    count: int
    columns: Mapping[int, Column]

    def before(self, line: int) -> Lines:
        """The lines before one of them."""
        if line >= self.count:
            return self
        columns = {letter: column.before(line) for letter, column in self.columns.items()}
        return Lines(self.start, self.rules, line, columns)

    def first_unread(self) -> int:
        """The first line that is left to `step`; else their number.

        It has a letter twice, a word of an arc in a straight motion, a coordinate that counts increments, a number
        that is too large, or an M code that is not plain.
        """
        found: list[int] = [self.count]
        for column in self.columns.values():
            found.extend(column.line[1:][column.line[1:] == column.line[:-1]][:1].tolist())
        for letter in _CENTRE:
            line = self.columns[letter].line
            found.extend(line[self._code[line] < 2][:1].tolist())
        for letter in (*_AXES, *_CENTRE) if self.rules.increment else ():
            found.extend(self.columns[letter].line[~self.columns[letter].pointed][:1].tolist())
        numbers, functions = self.columns[_N], self.columns[_M]
        found.extend(numbers.line[numbers.value > self.rules.largest_block_number][:1].tolist())
        if functions.line.size:
            found.extend(functions.line[~np.isin(functions.value, list(self.rules.m_codes))][:1].tolist())
        return min(found)

    def first_without_feed(self) -> int:
        """The first line that moves at a feed that was not given; else their number."""
        refused = np.flatnonzero(self._moved & (self._code > 0) & (self._feed <= 0.0))
        return int(refused[0]) if refused.size else self.count

    def first_arc_left(self) -> int:
        """The first line with an arc that must be refused, or perhaps must be; else their number."""
        if not self._arc_lines.size:
            return self.count
        refused = self._arc_lines[~self._centres[1]]
        return int(refused[0]) if refused.size else self.count

    def run(self, offset: int, end: int) -> PlainRun:
        """The run that the lines make; there is at least one, and none is to be refused."""
        moved = np.flatnonzero(self._moved)
        code = self._code[moved]
        feed = np.where(code == 0, 0.0, self._feed[moved])
        centre = np.full((moved.size, 3), np.nan)
        if self._arc_lines.size:
            arcs = np.flatnonzero(code >= 2)
            centre[arcs] = self._centres[0]
            if self.rules.feed_along_arc:
                feed[arcs] = path_feeds(self._arc_words, self._centres[0], self.start.plane)
        functions = self._functions()
        labels = self.columns[_N].value
        return PlainRun(
            begin=offset,
            offset=end,
            lines=self.count,
            block=_kept(self._worded() + self.start.line),
            line=_kept(moved + self.start.line),
            end_mm=_kept(self._position[moved]),
            code=_kept(code),
            feed_mm_min=_kept(feed),
            centre_mm=_kept(centre),
            spindle_rpm=_kept(functions.rpm[moved]),
            spindle_direction=_kept(functions.direction_at_motion[moved]),
            changes=functions.changes,
            after=self._after(functions),
            label_after=int(labels[-1]) if labels.size else None,
        )

    @cached_property
    def _code(self) -> NDArray[np.int64]:
        return self.columns[_G].held(self.start.code, self.count).astype(np.int64)

    @cached_property
    def _feed(self) -> NDArray[np.float64]:
        column = self.columns[_F]
        return column.held(self.start.feed_mm_min, self.count, column.value * self.start.unit_mm)

    @cached_property
    def _moved(self) -> NDArray[np.bool_]:
        moved = np.zeros(self.count, dtype=np.bool_)
        for letter in (*_AXES, *_CENTRE):
            moved[self.columns[letter].line] = True
        if self.rules.explicit_code_moves:
            moved[self.columns[_G].line] = True
        return moved

    @cached_property
    def _position(self) -> NDArray[np.float64]:
        """(count, 3) controlled points at the end of each line."""
        return np.column_stack([self._coordinate(index) for index in range(3)])

    def _coordinate(self, index: int) -> NDArray[np.float64]:
        """One coordinate at the end of each line; sums are made in the order of the lines."""
        start, column = self.start, self.columns[_AXES[index]]
        first, length = start.position_mm[index], column.value * start.unit_mm
        if start.absolute:
            return column.held(first, self.count, start.zero_mm[index] + length)
        return column.held(first, self.count, np.append(first, length + 0.0).cumsum()[1:])

    @cached_property
    def _arc_lines(self) -> NDArray[np.int64]:
        return np.flatnonzero(self._moved & (self._code >= 2))

    @cached_property
    def _arc_words(self) -> ArcWords:
        at, columns = self._arc_lines, self.columns
        begin = np.concatenate([[self.start.position_mm], self._position[:-1]])
        named = np.zeros((self.count, 3), dtype=np.bool_)
        for index, letter in enumerate(_AXES):
            named[columns[letter].line, index] = True
        return ArcWords(
            start_mm=begin[at],
            end_mm=self._position[at],
            named=named[at],
            offset=np.column_stack([columns[letter].spread(self.count)[at] for letter in (_I, _J, _K)]),
            radius=columns[_R].spread(self.count)[at],
            turns=2 * self._code[at] - 5,
            feed_mm_min=self._feed[at],
        )

    @cached_property
    def _centres(self) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        return arc_centres(self._arc_words, self.start, self.rules)

    def _worded(self) -> NDArray[np.int64]:
        """The lines that have a word."""
        worded = np.zeros(self.count, dtype=np.bool_)
        for column in self.columns.values():
            worded[column.line] = True
        return np.flatnonzero(worded)

    def _functions(self) -> Functions:
        speeds, codes = self.columns[_S], self.columns[_M]
        rpm = speeds.held(self.start.spindle_rpm, self.count)
        return plain_functions((speeds.line, rpm), codes, self.start, self.rules, self.count)

    def _after(self, functions: Functions) -> PlainStart:
        x, y, z = self._position[-1].tolist()
        return replace(
            self.start,
            position_mm=(x, y, z),
            code=int(self._code[-1]),
            feed_mm_min=float(self._feed[-1]),
            line=self.start.line + self.count,
            spindle_rpm=float(functions.rpm[-1]),
            spindle_direction=functions.direction_after,
            mist=functions.mist_after,
            flood=functions.flood_after,
        )


def _kept(array: NDArray[_T]) -> NDArray[_T]:
    array.setflags(write=False)
    return array
