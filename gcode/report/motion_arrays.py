"""Motions of a program as arrays: equal to the motion events, without an object for each."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcode.bulk.plain_batch import PlainBatch
from gcode.dialects import FANUC, Dialect
from gcode.errors import GcodeError
from gcode.events import NO_EXTRA, ArcMotion, Dwell, Event, Extra, LinearMotion, MotionState, Point
from gcode.flow.interpreter import ProgramSource, run
from gcode.settings import MachineSettings

#: Default of the motions in one `MotionArrays`.
ROWS = 65_536
_NO_CENTRE: Point = (np.nan, np.nan, np.nan)


class MotionKind(IntEnum):
    """Kind of a motion, as the arrays hold it."""

    RAPID = 0
    FEED = 1
    ARC = 2
    TAP = 3
    DWELL = 4


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MotionArrays:
    """n motions and dwells in the order of execution. All arrays are read-only.

    Points are the controlled point in machine coordinates, mm.

    Attributes:
        kind: (n,) members of `MotionKind`.
        line: (n,) line of the block that moves, counted from 1.
        start_mm: (n, 3) where each begins.
        end_mm: (n, 3) where each ends. A dwell is where the last motion ended.
        centre_mm: (n, 3) centre of arcs, nan for others.
        plane: (n,) 17, 18 or 19 for arcs, 0 for others.
        turns: (n,) signed turns of arcs as in `ArcMotion`, 0 for others.
        feed_mm_min: (n,) speed along the path, 0 for rapids and dwells.
        seconds: (n,) length of dwells, 0 for others.
        extra: (n, 6) where the axes A, B, C (degrees), U, V, W (mm) at the end.
        state: (n,) index of each motion's modal values in `states`.
        file: (n,) index of each motion's file in `files`.
        states: modal values, each combination once.
        files: names of the program files, each once.
    """

    kind: NDArray[np.uint8]
    line: NDArray[np.int64]
    start_mm: NDArray[np.float64]
    end_mm: NDArray[np.float64]
    centre_mm: NDArray[np.float64]
    plane: NDArray[np.uint8]
    turns: NDArray[np.int32]
    feed_mm_min: NDArray[np.float64]
    seconds: NDArray[np.float64]
    extra: NDArray[np.float64]
    state: NDArray[np.int32]
    file: NDArray[np.int32]
    states: tuple[MotionState, ...]
    files: tuple[str, ...]

    def __post_init__(self) -> None:
        for name in _COLUMNS:
            column = getattr(self, name)
            if len(column) != len(self.kind):
                raise ValueError(f"{name} has {len(column)} rows, kind has {len(self.kind)}")
            column.setflags(write=False)

    def __len__(self) -> int:
        return len(self.kind)

    def __getitem__(self, rows: slice) -> MotionArrays:
        """Some of the motions."""
        columns = {name: getattr(self, name)[rows] for name in _COLUMNS}
        return MotionArrays(**columns, states=self.states, files=self.files)

    @property
    def tool(self) -> NDArray[np.int32]:
        """(n,) number of the tool in the spindle."""
        return np.array([state.tool for state in self.states], dtype=np.int32)[self.state]

    @property
    def spindle_rpm(self) -> NDArray[np.float64]:
        """(n,) commanded speed; the spindle turns only where `spindle_direction` is not 0."""
        return np.array([state.spindle_rpm for state in self.states], dtype=np.float64)[self.state]

    @property
    def spindle_direction(self) -> NDArray[np.int8]:
        """(n,) +1 for M3 (clockwise seen from above the tool), -1 for M4, 0 stopped."""
        return np.array([state.spindle_direction for state in self.states], dtype=np.int8)[self.state]


#: Columns: type and, for those that have it, width.
_COLUMNS: dict[str, tuple[type[np.generic], tuple[int, ...]]] = {
    "kind": (np.uint8, ()),
    "line": (np.int64, ()),
    "start_mm": (np.float64, (3,)),
    "end_mm": (np.float64, (3,)),
    "centre_mm": (np.float64, (3,)),
    "plane": (np.uint8, ()),
    "turns": (np.int32, ()),
    "feed_mm_min": (np.float64, ()),
    "seconds": (np.float64, ()),
    "extra": (np.float64, (6,)),
    "state": (np.int32, ()),
    "file": (np.int32, ()),
}


def motion_arrays(
    source: ProgramSource,
    *,
    file: str = "<program>",
    dialect: Dialect | str = FANUC,
    settings: MachineSettings | None = None,
    rows: int = ROWS,
) -> Iterator[MotionArrays]:
    """Runs a program into arrays. Memory does not grow with the program's length.

    Args:
        source: the program's text, its lines, the path of its file (a `Path`), or the result of `read_program`.
        file: name of a text in errors; a file is named by its path.
        dialect: the control whose language the program is in, or its name: ``"haas"``.
        settings: the machine at the program's start; default `MachineSettings()`.
        rows: motions in each of the arrays but the last, at least 1.

    Yields:
        The motions and dwells in the order of execution.

    Raises:
        GcodeError: at the first block that is refused; the motions before it have been yielded.
        ValueError: for `rows` below 1, and for an unknown name of a dialect.
    """
    if rows < 1:
        raise ValueError(f"rows must be 1 or more, got {rows}")
    settings = settings or MachineSettings()
    collector = _Collector(rows, settings.start_mm)
    try:
        for event in run(source, file=file, dialect=dialect, settings=settings):
            collector.take(event)
            yield from collector.full()
    except GcodeError:
        yield from collector.rest()
        raise
    yield from collector.rest()


def concatenate(parts: Iterable[MotionArrays]) -> MotionArrays:
    """One `MotionArrays` of several, in their order; of none, one without motions."""
    parts = list(parts)
    columns: dict[str, Any] = {
        name: np.concatenate([np.empty((0, *shape), kind), *(getattr(part, name) for part in parts)])
        for name, (kind, shape) in _COLUMNS.items()
        if name not in ("state", "file")
    }
    state, states = _joined([(part.state, part.states) for part in parts])
    file, files = _joined([(part.file, part.files) for part in parts])
    return MotionArrays(**columns, state=state, states=states, file=file, files=files)


def _joined(parts: Sequence[tuple[NDArray[np.int32], tuple[Any, ...]]]) -> tuple[NDArray[np.int32], tuple[Any, ...]]:
    """Indices into several tables as indices into one, in which each value in use is listed once."""
    table: dict[Any, int] = {}
    columns = [np.empty(0, np.int32)]
    for index, values in parts:
        places = np.zeros(len(values), dtype=np.int32)
        for used in np.flatnonzero(np.bincount(index, minlength=len(values))).tolist():
            places[used] = table.setdefault(values[used], len(table))
        columns.append(places[index])
    return np.concatenate(columns), tuple(table)


class _Row(NamedTuple):
    """One motion, in the order of `_COLUMNS`."""

    kind: MotionKind
    line: int
    start_mm: Point
    end_mm: Point
    centre_mm: Point
    plane: int
    turns: int
    feed_mm_min: float
    seconds: float
    extra: Extra
    state: int
    file: int


class _Collector:
    """Gathers motions until there are enough of them for arrays of `rows` motions."""

    def __init__(self, rows: int, start_mm: Point) -> None:
        self._wanted = rows
        self._parts: list[MotionArrays] = []
        self._count = 0
        self._rows: list[_Row] = []
        self._states: dict[MotionState, int] = {}
        self._files: dict[str, int] = {}
        self._at = start_mm
        self._extra: Extra = NO_EXTRA

    def take(self, event: Event | PlainBatch) -> None:
        """Adds an event's motions, if it has any."""
        if isinstance(event, PlainBatch):
            self._close_rows()
            if len(event.run.line):
                self._add(_of_batch(event))
                self._at, self._extra = event.run.after.position_mm, event.extra
        elif isinstance(event, LinearMotion | ArcMotion | Dwell):
            self._rows.append(self._row(event))
            if len(self._rows) >= self._wanted:
                self._close_rows()

    def full(self) -> Iterator[MotionArrays]:
        """The arrays that are complete."""
        if self._count < self._wanted:
            return
        whole = concatenate(self._parts)
        stop = len(whole) - len(whole) % self._wanted
        for begin in range(0, stop, self._wanted):
            yield whole[begin : begin + self._wanted]
        self._parts = [concatenate([whole[stop:]])]
        self._count = len(whole) - stop

    def rest(self) -> Iterator[MotionArrays]:
        """The remaining motions at the end."""
        self._close_rows()
        yield from self.full()
        if self._count:
            yield concatenate(self._parts)

    def _add(self, part: MotionArrays) -> None:
        self._parts.append(part)
        self._count += len(part)

    def _row(self, event: LinearMotion | ArcMotion | Dwell) -> _Row:
        start, arc, feed, seconds = self._at, (_NO_CENTRE, 0, 0), 0.0, 0.0
        if isinstance(event, Dwell):
            kind, seconds = MotionKind.DWELL, event.seconds
        else:
            start, self._at, self._extra, feed = event.start_mm, event.end_mm, event.extra, event.feed_mm_min
            kind = MotionKind.ARC
            if isinstance(event, ArcMotion):
                arc = (event.centre_mm, event.plane, event.turns)
            else:
                kind = MotionKind.RAPID if event.rapid else MotionKind.TAP if event.tapping else MotionKind.FEED
        state = self._states.setdefault(event.state, len(self._states))
        file = self._files.setdefault(event.place.file, len(self._files))
        return _Row(kind, event.place.line, start, self._at, *arc, feed, seconds, self._extra, state, file)

    def _close_rows(self) -> None:
        if not self._rows:
            return
        columns: dict[str, Any] = {
            name: np.array(column, dtype=_COLUMNS[name][0])
            for name, column in zip(_Row._fields, zip(*self._rows, strict=True), strict=True)
        }
        self._add(MotionArrays(**columns, states=tuple(self._states), files=tuple(self._files)))
        self._rows, self._states, self._files = [], {}, {}


def _of_batch(batch: PlainBatch) -> MotionArrays:
    run = batch.run
    count = len(run.line)
    states, state = batch.states()
    arc = run.code >= 2
    return MotionArrays(
        kind=_KIND_OF_CODE[run.code],
        line=run.line,
        start_mm=np.concatenate([[batch.start.position_mm], run.end_mm[:-1]]),
        end_mm=run.end_mm,
        centre_mm=run.centre_mm,
        plane=np.where(arc, batch.start.plane, 0).astype(np.uint8),
        turns=np.where(arc, 2 * run.code - 5, 0).astype(np.int32),
        feed_mm_min=run.feed_mm_min,
        seconds=np.zeros(count),
        extra=np.tile(np.array(batch.extra), (count, 1)),
        state=state,
        file=np.zeros(count, dtype=np.int32),
        states=states,
        files=(batch.file,),
    )


#: Kinds of motion of G0, G1, G2, G3.
_KIND_OF_CODE = np.array([MotionKind.RAPID, MotionKind.FEED, MotionKind.ARC, MotionKind.ARC], dtype=np.uint8)
