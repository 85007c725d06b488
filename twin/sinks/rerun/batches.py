"""Steps gathered into columns, so that a batch is sent to the viewer in a few calls."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.record import Step
from twin.sinks.rerun import layout
from twin.sinks.rerun.shapes import force_class

#: A batch is complete at this many steps or samples.
BATCH_STEPS = 256
BATCH_SAMPLES = 1 << 16
#: Time between positions of the drawn tool in a long step, and the largest number of them.
_POSE_S = 0.04
_POSES = 250
#: Most steps of a run that the tool is drawn at.
_MOST_POSES = 200_000
#: Rows of the path in a run: with more the viewer is slow, with fewer the path lags behind the tool.
_PATH_ROWS = 1500
_REVOLUTION = 2.0 * np.pi
#: Steps that turn aside by less than this are drawn as one line.
_STRAIGHT_MM = 1e-4

Point: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Moments:
    """Times of rows on every timeline: seconds, step indices, NC lines, each of shape (n,)."""

    t_s: FloatArray
    step: NDArray[np.int64]
    nc_line: NDArray[np.int64]

    @classmethod
    def of(cls, rows: Sequence[tuple[float, int, int]]) -> Moments:
        """From rows (t_s, step, nc_line)."""
        t_s, step, line = zip(*rows, strict=True)
        return cls(np.array(t_s), np.array(step, np.int64), np.array(line, np.int64))

    def columns(self) -> list[rr.TimeColumn]:
        """Columns for the viewer; time is rounded to whole nanoseconds."""
        return [
            rr.TimeColumn(layout.TIME, duration=np.rint(self.t_s * 1e9).astype("timedelta64[ns]")),
            rr.TimeColumn(layout.STEP, sequence=self.step),
            rr.TimeColumn(layout.NC_LINE, sequence=self.nc_line),
        ]


@dataclass(slots=True)
class StepBatch:
    """Steps until the next send."""

    steps: list[Step] = field(default_factory=list)
    samples: int = 0

    def add(self, step: Step) -> bool:
        """Add a step; True when the batch is complete."""
        self.steps.append(step)
        self.samples += len(step.samples.t_s)
        return len(self.steps) >= BATCH_STEPS or self.samples >= BATCH_SAMPLES

    def take(self) -> list[Step]:
        """The steps of the batch; a new one begins."""
        steps, self.steps, self.samples = self.steps, [], 0
        return steps


class PoseBatch:
    """Positions of the tool tip: at the start of steps, and within long ones.

    Args:
        planned_time_s: duration of the whole run; of very short steps, some are passed over.
    """

    def __init__(self, planned_time_s: float) -> None:
        self._least_s = planned_time_s / _MOST_POSES
        self._last_s = -math.inf

    def columns(self, steps: Sequence[Step]) -> tuple[Moments, FloatArray] | None:
        """Times, and positions of shape (n, 3)."""
        rows: list[tuple[float, int, int]] = []
        tips: list[FloatArray] = []
        for step in steps:
            if step.t_s - self._last_s < self._least_s and step.duration_s < self._least_s:
                continue
            self._last_s = step.t_s
            tips.append(_poses(step, rows))
        return (Moments.of(rows), np.concatenate(tips)) if rows else None


def _poses(step: Step, rows: list[tuple[float, int, int]]) -> FloatArray:
    """Positions within one step, shape (n, 3); their times are added to ``rows``."""
    count = int(np.clip(step.duration_s / _POSE_S, 1, _POSES))
    part = np.arange(count) / count
    rows += [(step.t_s + p * step.duration_s, step.index, step.nc_line) for p in part.tolist()]
    start, end = np.array(step.start_mm), np.array(step.end_mm)
    return np.asarray(start + part[:, None] * (end - start))


class RevolutionPeak:
    """Highest resultant force within the last revolution, so that a step shorter than one has a steady colour."""

    def __init__(self) -> None:
        self._recent: deque[tuple[float, float]] = deque()

    def of(self, step: Step) -> float:
        """Peak in N over a step and the revolution before its end."""
        samples = step.samples
        if not len(samples.t_s) or not step.engagement.cutting:
            self._recent.clear()
            return 0.0
        peak = float(np.sqrt(np.max(np.sum(samples.force_n**2, axis=1))))
        angle = float(samples.spindle_angle_rad[-1])
        while self._recent and abs(angle - self._recent[0][0]) > _REVOLUTION:
            self._recent.popleft()
        before = max((p for _, p in self._recent), default=0.0)
        self._recent.append((angle, peak))
        return max(peak, before)


@dataclass(slots=True)
class PathRow:
    """Strips that appear together: points and class of each."""

    moment: tuple[float, int, int]
    strips: list[list[Point]]
    classes: list[int]


class PathBatch:
    """The path in rows of about equal duration, neighbours of one colour joined.

    Args:
        planned_time_s: duration of the whole run.
    """

    def __init__(self, planned_time_s: float) -> None:
        self._row_s = planned_time_s / _PATH_ROWS
        self._peak = RevolutionPeak()
        self._rows: dict[str, list[PathRow]] = {layout.CUT_PATH: [], layout.RAPID_PATH: []}
        self._open: dict[str, PathRow | None] = dict.fromkeys(self._rows)
        self._since = 0.0
        self.highest_n = 0.0

    def add(self, step: Step) -> None:
        """Add a step; it is shown from its end on."""
        force = self._peak.of(step)
        self.highest_n = max(self.highest_n, force)
        end_s = step.t_s + step.duration_s
        if step.start_mm != step.end_mm:
            entity = layout.RAPID_PATH if step.rapid else layout.CUT_PATH
            self._extend(entity, step, (end_s, step.index + 1, step.nc_line), force_class(force))
        if end_s - self._since >= self._row_s:
            self._close_rows()
            self._since = end_s

    def take(self) -> Iterator[tuple[str, list[PathRow]]]:
        """The rows since the last call, by entity."""
        self._close_rows()
        for entity, rows in self._rows.items():
            if rows:
                self._rows[entity] = []
                yield entity, rows

    def _extend(self, entity: str, step: Step, moment: tuple[float, int, int], number: int) -> None:
        row = self._open[entity]
        if row is None:
            self._open[entity] = row = PathRow(moment, [], [])
        row.moment = moment
        if row.strips and row.classes[-1] == number and row.strips[-1][-1] == step.start_mm:
            strip = row.strips[-1]
            if len(strip) > 1 and _goes_on(strip[-2], step.start_mm, step.end_mm):
                strip[-1] = step.end_mm
            else:
                strip.append(step.end_mm)
        else:
            row.strips.append([step.start_mm, step.end_mm])
            row.classes.append(number)

    def _close_rows(self) -> None:
        for entity, row in self._open.items():
            if row is not None:
                self._rows[entity].append(row)
                self._open[entity] = None


def _goes_on(before: Point, at: Point, end: Point) -> bool:
    """Whether a line from ``before`` to ``at`` goes straight on to ``end``."""
    ax, ay, az = at[0] - before[0], at[1] - before[1], at[2] - before[2]
    bx, by, bz = end[0] - at[0], end[1] - at[1], end[2] - at[2]
    aside = (ay * bz - az * by) ** 2 + (az * bx - ax * bz) ** 2 + (ax * by - ay * bx) ** 2
    return ax * bx + ay * by + az * bz > 0.0 and aside <= _STRAIGHT_MM**2 * (ax * ax + ay * ay + az * az)


def path_columns(rows: Sequence[PathRow]) -> tuple[Moments, Any]:
    """Rows of the path as columns: times, and strips with their classes."""
    strips = [np.array(strip, np.float32) for row in rows for strip in row.strips]
    classes = np.array([c for row in rows for c in row.classes], np.uint16)
    columns = rr.LineStrips3D.columns(strips=strips, class_ids=classes)
    return Moments.of([row.moment for row in rows]), columns.partition([len(row.strips) for row in rows])
