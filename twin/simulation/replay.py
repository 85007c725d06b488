"""Flow A on one page: NC program -> motion -> engagement -> forces -> removal -> records.

with Replay(load_job("job.toml")) as replay:
    for record in replay:
        sink.write(record)
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator
from itertools import islice, pairwise
from types import TracebackType
from typing import Self

import numpy as np

from gcode.events import Event
from twin.arrays import FloatArray
from twin.cutting.engagement import Positions
from twin.errors import ReplayError
from twin.job import Job
from twin.motion.path import Move
from twin.motion.sweep import SweptVolume
from twin.record import Record, RunSummary, Step
from twin.simulation.clock import Turned
from twin.simulation.contacts import Contacts, box_of, forbidden
from twin.simulation.preview import Piece
from twin.simulation.setup import Setup, prepare
from twin.simulation.short_motions import Joined, joined
from twin.simulation.solve import Solved, StepSolver, one_ahead
from twin.simulation.tools import ToolSetup
from twin.workpiece.to_mesh import SurfaceMesh, surface_mesh
from twin.workpiece.trislice import TriSlices

#: Steps of a motion that are solved together, whatever the number of threads.
_STEPS_TOGETHER = 64
#: Most steps of one motion, and most force samples of one step and of steps that are solved together.
_MOST_STEPS, _MOST_SAMPLES, _SAMPLES_TOGETHER = 10_000_000, 5_000_000, 1_000_000


def replayed(setup: Setup) -> Iterator[Record]:
    """The records of a job's replay, in order."""
    yield setup.header
    yield from setup.preview.whole(setup.material.workpiece)
    for item in joined(setup.moves, setup.step_mm, setup.tolerance.join_mm):
        if isinstance(item, Joined):
            yield from cut_joined(item, setup)
        else:
            yield from _one(item, setup)
    setup.material.flush()
    yield from setup.preview.changes(setup.material, setup.recorder.t_s)
    yield setup.recorder.summary(setup.material, complete=True)


def _one(item: Move | Event, setup: Setup) -> Iterator[Record]:
    """The records of one motion or event."""
    if isinstance(item, Move):
        yield from cut(item, setup)
    else:
        yield setup.recorder.event(item)


def cut_joined(short: Joined, setup: Setup) -> Iterator[Record]:
    """Replay short feed motions with one engagement, one sweep, and the force samples of each."""
    whole, material, recorder = short.whole, setup.material, setup.recorder
    tool = setup.tools.get(whole.tool)
    if tool is None or not material.near(tool, whole.start_mm, whole.end_mm):
        for item in short.items:
            yield from _one(item, setup)
        return
    setup.starts.check(tool, whole, material)
    begun_s, contacts = recorder.t_s, Contacts()
    yield from _joined_records(short, tool, setup)
    contacts.add(material.cut(tool, whole.start_mm, whole.end_mm, None), begun_s, whole.start_mm)
    contacts.add(material.touches(tool, whole.start_mm, whole.end_mm), begun_s, whole.start_mm)
    yield from setup.preview.frame(material, recorder.t_s)
    yield from recorder.collisions(contacts.found(material.contact_mm3), whole)


def _joined_records(short: Joined, tool: ToolSetup, setup: Setup) -> Iterator[Record]:
    """The records of short motions and of the blocks between them."""
    whole, recorder = short.whole, setup.recorder
    turned, t_s = deque[Turned](), recorder.t_s
    for item in short.items:
        if isinstance(item, Move):
            turned.append(recorder.clock.advance(t_s, item.duration_s, item.spindle_rpm))
            t_s += item.duration_s
    ends = np.array([whole.start_mm, whole.end_mm])
    feed = (whole.end_mm - whole.start_mm) / whole.length_mm
    pending = setup.material.pending(tool.number, whole.start_mm, feed)
    at = _positions(whole, tool, ends, feed, pending)
    angles = np.concatenate([angle for _, angle in turned])
    (solved,) = setup.solver.solve(tool, at, [angles], np.array([whole.spindle_rpm]), pending)()
    first = 0
    for item in short.items:
        if not isinstance(item, Move):
            yield recorder.event(item)
            continue
        samples = turned.popleft()
        last = first + len(samples[0])
        loads = None if solved.loads is None else solved.loads[first:last]
        own = Solved(solved.engagement, loads)
        yield recorder.step(item, item.start_mm, item.end_mm, item.duration_s, samples, own)
        first = last


def _positions(move: Move, tool: ToolSetup, ends: FloatArray, feed: FloatArray, pending: SweptVolume) -> Positions:
    """The middles of steps whose ends are given, shape (n + 1, 3)."""
    n = len(ends) - 1
    return Positions(
        0.5 * (ends[:-1] + ends[1:]),
        np.repeat(feed[None, :], n, axis=0),
        np.full(n, move.feed_mm_min / 60.0),
        np.full(n, move.feed_mm_min / (abs(move.spindle_rpm) * tool.teeth)),
        np.full(n, len(pending), dtype=np.int64),
    )


def cut(move: Move, setup: Setup) -> Iterator[Record]:
    """Step a motion: engagement and forces at each step, then its material removed, then its collisions."""
    tool, material, recorder = setup.tools.get(move.tool), setup.material, setup.recorder
    if tool is None or not material.near(tool, *box_of(move)):
        for start, end, duration_s in _straight(move, math.inf, setup.air_chord_mm):
            yield recorder.air_step(move, start, end, duration_s)
        return
    setup.starts.check(tool, move, material)
    contacts = Contacts()
    for start, end, duration_s in _straight(move, setup.step_mm, setup.tolerance.chord_mm):
        begun_s = recorder.t_s
        for piece in setup.preview.parts(start, end, duration_s):
            yield from _steps(move, piece, tool, setup)
            contacts.add(material.cut(tool, *piece[:2], forbidden(move)), begun_s, start)
            yield from setup.preview.frame(material, recorder.t_s)
        contacts.add(material.touches(tool, start, end), begun_s, start)
    yield from recorder.collisions(contacts.found(material.contact_mm3), move)


def _steps(move: Move, piece: Piece, tool: ToolSetup, setup: Setup) -> Iterator[Step]:
    """The steps of one straight piece: those of a feed motion are solved at their middles, many together."""
    start, end, duration_s = piece
    if forbidden(move) is not None or not np.any(end != start):
        yield setup.recorder.air_step(move, start, end, duration_s)
        return
    along = end - start
    length = float(np.linalg.norm(along))
    count = max(1, math.ceil(length / setup.step_mm * (1.0 - 1e-9)))
    step_s = duration_s / count
    per_step = setup.recorder.samples_in(step_s, move.spindle_rpm)
    _refuse_endless(move, count, per_step, setup)
    together = max(1, min(_STEPS_TOGETHER, int(_SAMPLES_TOGETHER / max(1.0, per_step))))
    ends = start + along * (np.arange(count + 1) / count)[:, None]
    pending = setup.material.pending(tool.number, start, along / length)
    turns = setup.recorder.clock.turns(setup.recorder.t_s, step_s, move.spindle_rpm)
    begun = _begun(move, tool, ends, along / length, pending, turns, setup.solver, together)
    for first, turned, answer in one_ahead(begun):
        for i, (samples, solved) in enumerate(zip(turned, answer(), strict=True), start=first):
            yield setup.recorder.step(move, ends[i], ends[i + 1], step_s, samples, solved)


def _refuse_endless(move: Move, steps: int, samples: float, setup: Setup) -> None:
    """Refuses a motion with far too many steps, or steps with far too many samples: a number must be wrong."""
    at = f"{setup.program}:{move.nc_line}"
    if steps > _MOST_STEPS:
        raise ReplayError(
            f"{at}: a motion of {steps:.3g} steps; expected at most {_MOST_STEPS:g}, a larger simulation.step_mm"
        )
    if samples > _MOST_SAMPLES:
        raise ReplayError(
            f"{at}: {samples:.3g} force samples in one step at F{move.feed_mm_min:g} S{abs(move.spindle_rpm):g}; "
            f"expected at most {_MOST_SAMPLES:g}, a higher feed or a larger simulation.angle_step_deg"
        )


def _begun(
    move: Move,
    tool: ToolSetup,
    ends: FloatArray,
    feed: FloatArray,
    pending: SweptVolume,
    turns: Iterator[Turned],
    solver: StepSolver,
    together: int,
) -> Iterator[tuple[int, list[Turned], Callable[[], list[Solved]]]]:
    """Begin to solve the steps of a line, many together.

    Args:
        ends: shape (n + 1, 3), the ends of n steps.
        feed: shape (3,), unit vector along them.
        pending: sweeps that are not yet subtracted from the slices.
        turns: times and spindle angles of each step's samples.
        together: how many steps are solved together.

    Yields:
        Number of the first step, the samples of each, and a function that waits for the answer.
    """
    for first in range(0, len(ends) - 1, together):
        part = ends[first : first + together + 1]
        n = len(part) - 1
        turned = list(islice(turns, n))
        at = _positions(move, tool, part, feed, pending)
        rpm = np.full(n, move.spindle_rpm)
        yield first, turned, solver.solve(tool, at, [angles for _, angles in turned], rpm, pending)


def _straight(move: Move, step_mm: float, chord_mm: float) -> Iterator[Piece]:
    """A motion in straight pieces."""
    corners = move.corners_mm(step_mm, chord_mm)
    lengths = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    total = float(lengths.sum())
    for (start, end), length in zip(pairwise(corners), lengths, strict=True):
        yield start, end, move.duration_s * (float(length) / total if total > 0.0 else 1.0)


class Replay:
    """One replay of a job; iterate over it once for its records, in order, with flat memory.

    Making it reads the whole program and refuses what cannot be replayed before anything is cut.

    Args:
        threads: how many work on slices and steps, None for all cores; results do not depend on it.
        preview: whether patches of the workpiece's surface are among the records, at key frames, where motions are
            divided.
        report: called with each task of the preparation as it begins.

    Raises:
        TwinError, gcode.errors.GcodeError: a job, tool, stock or program that cannot be replayed.
    """

    def __init__(
        self,
        job: Job,
        *,
        threads: int | None = None,
        preview: bool = True,
        report: Callable[[str], None] = lambda _task: None,
    ) -> None:
        self._setup = prepare(job, threads=threads, preview=preview, report=report)
        self._mesh_pitch_mm = job.simulation.preview_pitch_mm

    def __iter__(self) -> Iterator[Record]:
        return replayed(self._setup)

    @property
    def planned_time_s(self) -> float:
        """Machine time of the whole program."""
        return self._setup.header.planned_time_s

    @property
    def workpiece(self) -> TriSlices:
        """The slices; until the end of the replay, the newest sweeps are not yet subtracted from them."""
        return self._setup.material.workpiece

    def summary(self, *, complete: bool = False) -> RunSummary:
        """Sums, peaks and digest of what was replayed so far."""
        return self._setup.recorder.summary(self._setup.material, complete=complete)

    def mesh(self) -> SurfaceMesh:
        """The surface of the workpiece as it is now."""
        self._setup.material.flush()
        return surface_mesh(self.workpiece, self._mesh_pitch_mm)

    def close(self) -> None:
        """End the worker threads."""
        self._setup.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
