"""Runs of plain straight motions executed at once: the bulk of surface programs, by the hundred thousand lines.

`plain_run` does what `step` does, for many lines of words N, G0, G1, X, Y, Z, F, with the same numbers to the last bit.
It raises no errors: it stops before a line that is not plain or that must be refused, and leaves that line to `step`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from gcode.bulk.plain_words import WordArrays, plain_end, read_words
from gcode.errors import Call, Place
from gcode.events import NO_EXTRA, Block, Extra, LinearMotion, MotionState, Point
from gcode.language.program import Program

_T = TypeVar("_T", bound=np.generic)
#: Most lines of one run: enough that what a run costs besides its lines is nothing.
MAX_LINES = 16_384
#: Fewer lines are run faster one by one.
LEAST_LINES = 5


@dataclass(frozen=True, slots=True)
class PlainStart:
    """The control before a run of plain lines. Its frame is a translation, and F is a feed per minute.

    Attributes:
        position_mm: controlled point, machine coordinates.
        zero_mm: program zero in machine coordinates.
        unit_mm: length of the program's unit.
        absolute: True for G90.
        rapid: True where G0 is active, False for G1.
        feed_mm_min: feed of the last F word, 0 before the first.
        line: number of the first line, counted from 1.
    """

    position_mm: Point
    zero_mm: Point
    unit_mm: float
    absolute: bool
    rapid: bool
    feed_mm_min: float
    line: int


@dataclass(frozen=True, slots=True, eq=False)
class PlainRun:
    """Consecutive plain lines and their motions. Arrays are read-only; n is the number of motions.

    Attributes:
        begin: byte offset of the first line.
        offset: byte offset after the last line.
        lines: how many lines there are; those without an axis word make no motion.
        line: number of each motion's line.
        end_mm: (n, 3) controlled points at the motions' ends, machine coordinates; each starts where the last ended.
        rapid: True for positioning motions.
        feed_mm_min: feeds, 0 for positioning motions.
        position_mm: controlled point after the last line.
        rapid_after: True where G0 is active there.
        feed_after: feed of the last F word there, also while G0 is active.
        label_after: number of the last N word of these lines, None without one.
    """

    begin: int
    offset: int
    lines: int
    line: NDArray[np.int64]
    end_mm: NDArray[np.float64]
    rapid: NDArray[np.bool_]
    feed_mm_min: NDArray[np.float64]
    position_mm: Point
    rapid_after: bool
    feed_after: float
    label_after: int | None


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PlainBatch:
    """A run of plain lines among the events of a program; represents the events that `expand` makes of it.

    Attributes:
        start: the control before it.
        run: its lines and motions.
        state: modal values that hold in all of it.
        file: name of the program's file.
        program: the text that the run's offsets count in.
        calls: the calls that led to it.
        extra: where the further axes stand.
    """

    start: PlainStart
    run: PlainRun
    state: MotionState
    file: str
    program: Program
    calls: tuple[Call, ...] = ()
    extra: Extra = NO_EXTRA


def plain_run(
    buffer: bytes,
    offset: int,
    start: PlainStart,
    *,
    max_lines: int = MAX_LINES,
    least_lines: int = LEAST_LINES,
    increment: bool = False,
) -> PlainRun | None:
    """Runs the plain lines that begin at `offset`.

    Args:
        buffer: the program's text.
        offset: where a line begins.
        start: the control before that line.
        max_lines: how many lines to take at most.
        least_lines: how many there must be.
        increment: True where a number without a decimal point counts increments; a line with such a coordinate is
            then not plain.

    Returns:
        The lines up to the first one that is not plain, is a motion code alone, or must be refused (no feed, a word
        given twice); None where they are too few. The last line of a text without a line end is never plain.
    """
    end = plain_end(buffer, offset, max_lines)
    count = buffer.count(b"\n", offset, end)
    if count < least_lines:
        return None
    words = read_words(buffer, offset, end)
    whole = _Lines(start, count, {letter: _column(words, letter) for letter in _LETTERS})
    lines = whole.before(whole.first_unread(increment=increment))
    lines = lines.before(lines.first_without_feed())
    if lines.count < max(least_lines, 1):
        return None
    if lines.count < count:
        text = np.frombuffer(buffer, np.uint8, end - offset, offset)
        end = offset + int(np.flatnonzero(text == ord("\n"))[lines.count - 1]) + 1
    return lines.run(offset, end)


_LETTERS = b"NGXYZF"
_N, _G, _X, _Y, _Z, _F = _LETTERS
_AXES = (_X, _Y, _Z)


class _Column(NamedTuple):
    """The words of one letter: the line of each, rising, its value, and whether it has a decimal point."""

    line: NDArray[np.int64]
    value: NDArray[np.float64]
    pointed: NDArray[np.bool_]

    def before(self, line: int) -> _Column:
        """The words that stand before a line."""
        stop = int(np.searchsorted(self.line, line))
        return _Column(self.line[:stop], self.value[:stop], self.pointed[:stop])

    def held(self, first: float, count: int, values: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
        """Modal value in each of `count` lines: `first`, and from each word on its entry of `values` or its value."""
        values = self.value if values is None else values
        if self.line.size == count:
            return values
        latest = np.zeros(count, dtype=np.int64)
        latest[self.line] = np.arange(1, self.line.size + 1)
        return np.append(first, values)[np.maximum.accumulate(latest)]


def _column(words: WordArrays, letter: int) -> _Column:
    at = np.flatnonzero(words.letter == letter)
    return _Column(words.line[at], words.value[at], words.pointed[at])


@dataclass(frozen=True, slots=True)
class _Lines:
    """Plain lines, taken apart; no letter occurs twice in one once `first_unread` was cut off."""

    start: PlainStart
    count: int
    columns: Mapping[int, _Column]

    def before(self, line: int) -> _Lines:
        """The lines before one of them."""
        if line >= self.count:
            return self
        return _Lines(self.start, line, {letter: column.before(line) for letter, column in self.columns.items()})

    def first_unread(self, *, increment: bool) -> int:
        """The first line that is left to `step`; else their number.

        It has a letter twice, a motion code without an axis word (which some controls take for a motion), or a
        coordinate that counts increments.
        """
        codes = self.columns[_G].line
        found: list[int] = [self.count, *codes[~self._moved()[codes]][:1].tolist()]
        for letter, column in self.columns.items():
            refused = column.line[1:][column.line[1:] == column.line[:-1]]
            found.extend(refused[:1].tolist())
            if increment and letter in _AXES:
                found.extend(column.line[~column.pointed][:1].tolist())
        return min(found)

    def first_without_feed(self) -> int:
        """The first line that moves at a feed that was not given; else their number."""
        refused = np.flatnonzero(self._moved() & ~self._rapid() & (self._feed() <= 0.0))
        return int(refused[0]) if refused.size else self.count

    def run(self, offset: int, end: int) -> PlainRun:
        """The run that the lines make; there is at least one, and none is to be refused."""
        rapid, feed = self._rapid(), self._feed()
        position = np.column_stack([self._coordinate(index) for index in range(3)])
        moved = np.flatnonzero(self._moved())
        x, y, z = position[-1].tolist()
        labels = self.columns[_N].value
        return PlainRun(
            begin=offset,
            offset=end,
            lines=self.count,
            line=_kept(moved + self.start.line),
            end_mm=_kept(position[moved]),
            rapid=_kept(rapid[moved]),
            feed_mm_min=_kept(np.where(rapid, 0.0, feed)[moved]),
            position_mm=(x, y, z),
            rapid_after=bool(rapid[-1]),
            feed_after=float(feed[-1]),
            label_after=int(labels[-1]) if labels.size else None,
        )

    def _rapid(self) -> NDArray[np.bool_]:
        rapid: NDArray[np.bool_] = self.columns[_G].held(0.0 if self.start.rapid else 1.0, self.count) == 0.0
        return rapid

    def _feed(self) -> NDArray[np.float64]:
        column = self.columns[_F]
        return column.held(self.start.feed_mm_min, self.count, column.value * self.start.unit_mm)

    def _moved(self) -> NDArray[np.bool_]:
        moved = np.zeros(self.count, dtype=np.bool_)
        for letter in _AXES:
            moved[self.columns[letter].line] = True
        return moved

    def _coordinate(self, index: int) -> NDArray[np.float64]:
        """One coordinate at the end of each line; sums are made in the order of the lines."""
        start, column = self.start, self.columns[_AXES[index]]
        first, length = start.position_mm[index], column.value * start.unit_mm
        if start.absolute:
            return column.held(first, self.count, start.zero_mm[index] + length)
        return column.held(first, self.count, np.append(first, length + 0.0).cumsum()[1:])


def _kept(array: NDArray[_T]) -> NDArray[_T]:
    array.setflags(write=False)
    return array


def expand(batch: PlainBatch) -> Iterator[Block | LinearMotion]:
    """The events that running the lines one by one gives: a `Block` for each with words, and its motion."""
    run, state, file, calls, extra = batch.run, batch.state, batch.file, batch.calls, batch.extra
    start = batch.start.position_mm
    motions = zip(run.line.tolist(), run.end_mm.tolist(), run.rapid.tolist(), run.feed_mm_min.tolist(), strict=True)
    moving, end, rapid, feed = next(motions, _NO_MOTION)
    text = batch.program.text[run.begin : run.offset].decode("ascii").replace("\r\n", "\n")
    for number, line in enumerate(text.split("\n")[:-1], batch.start.line):
        if not line or line.isspace():
            continue
        place = Place(file=file, line=number, text=line, calls=calls)
        yield Block(place=place)
        if number == moving:
            point = (end[0], end[1], end[2])
            yield LinearMotion(
                place=place, state=state, start_mm=start, end_mm=point, rapid=rapid, feed_mm_min=feed, extra=extra
            )
            start = point
            moving, end, rapid, feed = next(motions, _NO_MOTION)


_NO_MOTION: tuple[int, list[float], bool, float] = (0, [], False, 0.0)
