"""Statistics of a program: lengths, times, travel range, feeds and speeds of each tool."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from gcode.bulk.plain_batch import PlainBatch
from gcode.bulk.plain_runs import PlainRun
from gcode.events import ArcMotion, Block, Dwell, Event, LinearMotion, Motion, MotionState, Notice, Point, ToolChange
from gcode.report.batch_paths import BatchPaths
from gcode.report.motion_json import type_of
from gcode.report.path_geometry import extremes_mm, length_mm

#: Default rapid rate, mm/min.
RAPID_MM_MIN = 10_000.0
#: Most different feeds or speeds that are kept one by one; of more, the least and the largest.
MOST_VALUES = 50
#: Kinds of motion, in the order of reports.
TYPES = ("rapid", "feed", "arc", "tap", "dwell")


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """Least and largest coordinates in machine coordinates, mm."""

    low_mm: Point
    high_mm: Point

    @property
    def size_mm(self) -> Point:
        """Extent along x, y and z."""
        x, y, z = (high - low for low, high in zip(self.low_mm, self.high_mm, strict=True))
        return (x, y, z)


@dataclass(frozen=True, slots=True, kw_only=True)
class ValueSet:
    """Different values of a feed or a speed.

    Attributes:
        least: the smallest of them.
        largest: the largest.
        each: all of them in rising order, or None where there are more than `MOST_VALUES`.
    """

    least: float
    largest: float
    each: tuple[float, ...] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionTotals:
    """Lengths in mm and times in s of one tool, or of a whole program.

    Attributes:
        cutting_mm: length of motions at a feed.
        rapid_mm: length of rapids.
        cutting_s: time of motions at a feed.
        rapid_s: time of rapids at the given rate.
        dwell_s: time of dwells.
        motions: how many there are of each type, those of `TYPES` that occur.
        feeds_mm_min: feeds used, None without any.
        speeds_rpm: speeds of the turning spindle in motions at a feed, None without any.
    """

    cutting_mm: float
    rapid_mm: float
    cutting_s: float
    rapid_s: float
    dwell_s: float
    motions: Mapping[str, int]
    feeds_mm_min: ValueSet | None
    speeds_rpm: ValueSet | None

    @property
    def travel_mm(self) -> float:
        """Length of all motions."""
        return self.cutting_mm + self.rapid_mm

    @property
    def time_s(self) -> float:
        """Time of all motions and dwells; accelerations and tool changes are not in it."""
        return self.cutting_s + self.rapid_s + self.dwell_s


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramStats:
    """Statistics of a program.

    Attributes:
        total: the whole program.
        tools: by tool number, in the order of their first motion; 0 is the empty spindle.
        cutting_box: of all motions at a feed, None without any.
        box: of all motions, None without any.
        blocks: blocks executed.
        tool_changes: number of tool changes.
        untimed: motions with a length at a feed of 0; their time is not in the sums.
        notices: words that have no effect on motion.
        rapid_mm_min: rapid rate that the times are for.
    """

    total: MotionTotals
    tools: Mapping[int, MotionTotals]
    cutting_box: Box | None
    box: Box | None
    blocks: int
    tool_changes: int
    untimed: int
    notices: int
    rapid_mm_min: float


def program_stats(events: Iterable[Event | PlainBatch], rapid_mm_min: float = RAPID_MM_MIN) -> ProgramStats:
    """Sums up a program; memory does not grow with its length.

    Args:
        events: of the program, from its start, or runs of plain lines in place of the events that they stand for.
        rapid_mm_min: rapid rate along the path, mm/min.

    Raises:
        ValueError: for a rate that is not positive and finite.
        GcodeError: where the program is refused.
    """
    if not 0.0 < rapid_mm_min < math.inf:
        raise ValueError(f"rapid_mm_min must be positive and finite, got {rapid_mm_min}")
    counting = _Program(rapid_mm_min)
    for event in events:
        counting.add(event)
    return counting.stats()


@dataclass(slots=True)
class _Collected:
    """Different values, as far as they are kept."""

    values: set[float] = field(default_factory=set)
    least: float = math.inf
    largest: float = -math.inf
    many: bool = False

    def add(self, value: float) -> None:
        if value in self.values:
            return
        self.least, self.largest = min(self.least, value), max(self.largest, value)
        if len(self.values) < MOST_VALUES:
            self.values.add(value)
        else:
            self.many = True

    def add_all(self, values: NDArray[np.float64]) -> None:
        """Adds values in any order."""
        if not values.size:
            return
        different = np.unique(values)
        for value in (*different[: MOST_VALUES + 1].tolist(), float(different[-1])):
            self.add(value)

    def done(self) -> ValueSet | None:
        if not self.values:
            return None
        each = None if self.many else tuple(sorted(self.values))
        return ValueSet(least=self.least, largest=self.largest, each=each)


@dataclass(slots=True)
class _Extent:
    low: Point = (math.inf, math.inf, math.inf)
    high: Point = (-math.inf, -math.inf, -math.inf)

    def add(self, low: Point, high: Point) -> None:
        a, b = self.low, self.high
        self.low = (min(a[0], low[0]), min(a[1], low[1]), min(a[2], low[2]))
        self.high = (max(b[0], high[0]), max(b[1], high[1]), max(b[2], high[2]))

    def done(self) -> Box | None:
        return Box(low_mm=self.low, high_mm=self.high) if self.low[0] <= self.high[0] else None


@dataclass(slots=True)
class _Sums:
    """`MotionTotals` while they grow."""

    cutting_mm: float = 0.0
    rapid_mm: float = 0.0
    cutting_s: float = 0.0
    rapid_s: float = 0.0
    dwell_s: float = 0.0
    motions: Counter[str] = field(default_factory=Counter)
    feeds: _Collected = field(default_factory=_Collected)
    speeds: _Collected = field(default_factory=_Collected)

    def add_rapid(self, length: float, seconds: float) -> None:
        self.rapid_mm += length
        self.rapid_s += seconds

    def add_cut(self, length: float, seconds: float, feed: float, state: MotionState) -> None:
        self.cutting_mm += length
        self.cutting_s += seconds
        if feed > 0.0:
            self.feeds.add(feed)
        if state.spindle_direction:
            self.speeds.add(state.spindle_rpm)

    def add_batch(self, run: PlainRun, length_mm: NDArray[np.float64], seconds: NDArray[np.float64]) -> None:
        """Adds the motions of a run of plain lines."""
        cuts = run.code != 0
        self.rapid_mm = _summed(self.rapid_mm, length_mm[~cuts])
        self.rapid_s = _summed(self.rapid_s, seconds[~cuts])
        self.cutting_mm = _summed(self.cutting_mm, length_mm[cuts])
        self.cutting_s = _summed(self.cutting_s, seconds[cuts])
        rapids, feeds, clockwise, counter = np.bincount(run.code, minlength=4).tolist()
        self.motions.update({"rapid": rapids, "feed": feeds, "arc": clockwise + counter})
        self.feeds.add_all(run.feed_mm_min[cuts & (run.feed_mm_min > 0.0)])
        self.speeds.add_all(run.spindle_rpm[cuts & (run.spindle_direction != 0)])

    def done(self) -> MotionTotals:
        return MotionTotals(
            cutting_mm=self.cutting_mm,
            rapid_mm=self.rapid_mm,
            cutting_s=self.cutting_s,
            rapid_s=self.rapid_s,
            dwell_s=self.dwell_s,
            motions={name: self.motions[name] for name in TYPES if self.motions[name]},
            feeds_mm_min=self.feeds.done(),
            speeds_rpm=self.speeds.done(),
        )


def _summed(first: float, values: NDArray[np.float64]) -> float:
    """`first` and the values, added one after another."""
    return float(np.add.accumulate(np.append(first, values))[-1])


class _Program:
    """`ProgramStats` while they grow."""

    def __init__(self, rapid_mm_min: float) -> None:
        self._rapid_mm_min = rapid_mm_min
        self._total = _Sums()
        self._tools: dict[int, _Sums] = {}
        self._cutting, self._all = _Extent(), _Extent()
        self._blocks = self._tool_changes = self._untimed = self._notices = 0

    def add(self, event: Event | PlainBatch) -> None:
        """Adds one event, or a run of plain lines, to the totals."""
        if isinstance(event, PlainBatch):
            self._blocks += event.run.block.size
            if event.run.line.size:
                self._batch(event)
        elif isinstance(event, LinearMotion | ArcMotion):
            self._motion(event)
        elif isinstance(event, Dwell):
            for sums in self._sums_of(event.state):
                sums.motions["dwell"] += 1
                sums.dwell_s += event.seconds
        elif isinstance(event, Block):
            self._blocks += 1
        elif isinstance(event, ToolChange):
            self._tool_changes += 1
        elif isinstance(event, Notice):
            self._notices += 1

    def _sums_of(self, state: MotionState) -> tuple[_Sums, _Sums]:
        return self._total, self._tools.setdefault(state.tool, _Sums())

    def _motion(self, event: Motion) -> None:
        length, box, kind = length_mm(event), extremes_mm(event), type_of(event)
        self._all.add(*box)
        rate = self._rapid_mm_min if kind == "rapid" else event.feed_mm_min
        seconds = 60.0 * length / rate if rate > 0.0 else 0.0
        self._untimed += length > 0.0 >= rate
        if kind != "rapid":
            self._cutting.add(*box)
        for sums in self._sums_of(event.state):
            sums.motions[kind] += 1
            if kind == "rapid":
                sums.add_rapid(length, seconds)
            else:
                sums.add_cut(length, seconds, event.feed_mm_min, event.state)

    def _batch(self, batch: PlainBatch) -> None:
        """Adds the motions of a run, with the same sums as one by one."""
        run, paths = batch.run, BatchPaths(batch)
        cuts = run.code != 0
        rate = np.where(cuts, run.feed_mm_min, self._rapid_mm_min)
        seconds = np.divide(60.0 * paths.length_mm, rate, out=np.zeros(rate.size), where=rate > 0.0)
        self._untimed += int(np.count_nonzero((paths.length_mm > 0.0) & (rate <= 0.0)))
        for box in paths.boxes(np.ones(cuts.size, dtype=np.bool_)):
            self._all.add(*box)
        for box in paths.boxes(cuts) if cuts.any() else ():
            self._cutting.add(*box)
        for sums in self._sums_of(batch.state):
            sums.add_batch(run, paths.length_mm, seconds)

    def stats(self) -> ProgramStats:
        """The totals so far."""
        return ProgramStats(
            total=self._total.done(),
            tools={number: sums.done() for number, sums in self._tools.items()},
            cutting_box=self._cutting.done(),
            box=self._all.done(),
            blocks=self._blocks,
            tool_changes=self._tool_changes,
            untimed=self._untimed,
            notices=self._notices,
            rapid_mm_min=self._rapid_mm_min,
        )
