"""A run of plain lines among the events of a program, and the events that it stands for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gcode.bulk.plain_functions import DIRECTIONS
from gcode.bulk.plain_rules import PlainStart
from gcode.bulk.plain_runs import PlainRun
from gcode.errors import Call, Place
from gcode.events import (
    NO_EXTRA,
    ArcMotion,
    Block,
    CoolantChange,
    Event,
    Extra,
    LinearMotion,
    MotionState,
    SpindleChange,
)
from gcode.language.program import Program


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PlainBatch:
    """A run of plain lines among the events of a program; represents the events that `expand` makes of it.

    Attributes:
        start: the control before it.
        run: its lines and motions.
        state: modal values before it, which hold in all of it but for the spindle's.
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

    @property
    def place(self) -> Place:
        """Location of its last line."""
        return Place(file=self.file, line=self.run.after.line - 1, calls=self.calls)

    def states(self) -> tuple[tuple[MotionState, ...], NDArray[np.int32]]:
        """The modal values that hold in its motions, each combination once, and the index of each motion's."""
        keys = self.run.spindle_rpm + 1j * self.run.spindle_direction
        if not keys.size or (keys == keys[0]).all():
            return self._states(keys[:1]), np.zeros(keys.size, dtype=np.int32)
        values, first, index = np.unique(keys, return_index=True, return_inverse=True)
        order = np.argsort(first)
        rank = np.empty(order.size, dtype=np.int32)
        rank[order] = np.arange(order.size)
        return self._states(values[order]), rank[index]

    def _states(self, keys: NDArray[np.complex128]) -> tuple[MotionState, ...]:
        return tuple(
            replace(self.state, spindle_rpm=key.real, spindle_direction=DIRECTIONS[int(key.imag)])
            for key in keys.tolist()
        )


_Row: TypeAlias = tuple[Any, ...]


def expand(batch: PlainBatch) -> Iterator[Event]:
    """The events that running the lines one by one gives: a `Block` for each with words, its changes and motion."""
    run = batch.run
    lines = batch.program.text[run.begin : run.offset].decode("ascii").replace("\r\n", "\n").split("\n")
    changes, motions = _change_rows(batch), _motions(batch)
    change, motion = next(changes, _NO_ROW), next(motions, _NO_ROW)
    for number in run.block.tolist():
        text = lines[number - batch.start.line]
        place = Place(file=batch.file, line=number, text=text, calls=batch.calls)
        yield Block(place=place)
        while change[0] == number and not change[1]:
            yield _change(place, change)
            change = next(changes, _NO_ROW)
        if motion[0] == number:
            yield _motion(place, motion, batch)
            motion = next(motions, _NO_ROW)
        while change[0] == number:
            yield _change(place, change)
            change = next(changes, _NO_ROW)


#: A row of no line.
_NO_ROW: _Row = (0,)


def _change_rows(batch: PlainBatch) -> Iterator[_Row]:
    return zip(*(column.tolist() for column in batch.run.changes), strict=True)


def _change(place: Place, row: _Row) -> Event:
    _, _, coolant, rpm, direction, mist, flood = row
    if coolant:
        return CoolantChange(place=place, mist=mist, flood=flood)
    return SpindleChange(place=place, spindle_rpm=rpm, spindle_direction=direction)


def _motions(batch: PlainBatch) -> Iterator[_Row]:
    """Line, code, start, end, centre, feed and state of each motion."""
    run, (states, state) = batch.run, batch.states()
    ends = [(x, y, z) for x, y, z in run.end_mm.tolist()]
    starts = [batch.start.position_mm, *ends[:-1]]
    columns = run.line.tolist(), run.code.tolist(), starts, ends, run.centre_mm.tolist(), run.feed_mm_min.tolist()
    return zip(*columns, map(states.__getitem__, state.tolist()), strict=True) if ends else iter(())


def _motion(place: Place, row: _Row, batch: PlainBatch) -> LinearMotion | ArcMotion:
    _, code, start, end, centre, feed, state = row
    common = {"place": place, "state": state, "start_mm": start, "end_mm": end, "extra": batch.extra}
    if code < 2:
        return LinearMotion(**common, rapid=code == 0, feed_mm_min=feed)
    x, y, z = centre
    plane = batch.start.plane
    return ArcMotion(**common, centre_mm=(x, y, z), plane=plane, turns=2 * code - 5, feed_mm_min=feed)


def motion_at(batch: PlainBatch, index: int) -> LinearMotion | ArcMotion:
    """One motion of a run, with the modal values before the run."""
    run = batch.run
    start = batch.start.position_mm if index == 0 else tuple(run.end_mm[index - 1].tolist())
    end, centre = tuple(run.end_mm[index].tolist()), run.centre_mm[index].tolist()
    line, code, feed = int(run.line[index]), int(run.code[index]), float(run.feed_mm_min[index])
    row = (line, code, start, end, centre, feed, batch.state)
    return _motion(Place(file=batch.file, line=line, calls=batch.calls), row, batch)
