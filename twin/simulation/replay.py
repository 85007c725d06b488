"""Flow A on one page: NC program -> motion -> engagement -> forces -> removal -> records.

with Replay(load_job("job.toml")) as replay:
    for record in replay:
        sink.write(record)
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator
from itertools import pairwise
from types import TracebackType
from typing import Self

import numpy as np

from gcode.events import Event
from twin.job import Job
from twin.motion.path import Move
from twin.record import Record, RunSummary
from twin.simulation.chords import chord_groups, chord_steps, chords_are_steps, cut_in_chains
from twin.simulation.clock import Turned
from twin.simulation.contacts import Contacts, box_of, forbidden
from twin.simulation.feed_runs import FeedRun, cut_feed_run, feed_runs
from twin.simulation.level_runs import LevelRun, cut_level_run, level_runs
from twin.simulation.setup import Setup, prepare
from twin.simulation.short_motions import Joined, joined
from twin.simulation.solve import Solved
from twin.simulation.steps import Piece, piece_steps, positions
from twin.simulation.tools import ToolSetup
from twin.workpiece.to_mesh import SurfaceMesh, surface_mesh
from twin.workpiece.trislice import TriSlices


def replayed(setup: Setup) -> Iterator[Record]:
    """The records of a job's replay, in order."""
    preview, material = setup.preview, setup.material
    yield setup.header
    if preview is not None:
        yield from preview.start()
    yield from preview.along(_cut_all(setup)) if preview is not None else _cut_all(setup)
    material.flush()
    if preview is not None:
        yield from preview.end(setup.recorder.t_s)
    yield setup.recorder.summary(material, complete=True)


def _cut_all(setup: Setup) -> Iterator[Record]:
    """The records of a program's motions and events."""
    short = joined(setup.moves, setup.step_mm, setup.tolerance.join_mm)
    level = level_runs(short, setup.tools, setup.step_mm)
    for item in feed_runs(level, setup.tools, setup.step_mm):
        yield from _one(item, setup)


def _one(item: Move | Event | Joined | LevelRun | FeedRun, setup: Setup) -> Iterator[Record]:
    """The records of motions or of an event."""
    match item:
        case Move():
            yield from cut(item, setup)
        case Joined():
            yield from cut_joined(item, setup)
        case LevelRun():
            yield from _cut_run(item, setup)
        case FeedRun():
            yield from cut_feed_run(item, setup, lambda one: _one(one, setup))
        case _:
            yield setup.recorder.event(item)


def _cut_run(run: LevelRun, setup: Setup) -> Iterator[Record]:
    """Short level motions in one chain where they are near the stock, else one by one."""
    tool = setup.tools[run.first.tool]
    ends = np.array([run.first.start_mm, *(end for _, end, _ in run.chords)])
    if setup.material.near(tool, ends.min(axis=0), ends.max(axis=0)):
        yield from cut_level_run(run, tool, setup)
        return
    for item in run.items:
        yield from _one(item, setup)


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
    yield from recorder.collisions(contacts.found(material.contact_mm3), whole)


def _joined_records(short: Joined, tool: ToolSetup, setup: Setup) -> Iterator[Record]:
    """The records of short motions and of the blocks between them."""
    whole, recorder = short.whole, setup.recorder
    turned, t_s = deque[Turned](), recorder.t_s
    for item in short.items:
        if isinstance(item, Move):
            turned.append(recorder.turned(t_s, item.duration_s, item))
            t_s += item.duration_s
    ends = np.array([whole.start_mm, whole.end_mm])
    feed = (whole.end_mm - whole.start_mm) / whole.length_mm
    pending = setup.material.pending(tool.number, whole.start_mm, feed)
    at = positions(whole, tool, ends, feed, pending)
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


def cut(move: Move, setup: Setup) -> Iterator[Record]:
    """Step a motion: engagement and forces at each step, then its material removed, then its collisions."""
    tool, material, recorder = setup.tools.get(move.tool), setup.material, setup.recorder
    if tool is None or not material.near(tool, *box_of(move)):
        for start, end, duration_s in _straight(move, math.inf, setup.air_chord_mm):
            yield recorder.air_step(move, start, end, duration_s)
        return
    setup.starts.check(tool, move, material)
    contacts = Contacts()
    pieces = _straight(move, setup.step_mm, setup.tolerance.chord_mm)
    if move.arc is not None and forbidden(move) is None and chords_are_steps(move, setup):
        yield from _cut_chords(move, pieces, tool, setup, contacts)
    else:
        yield from _cut_pieces(move, pieces, tool, setup, contacts)
    yield from recorder.collisions(contacts.found(material.contact_mm3), move)


def _cut_pieces(
    move: Move, pieces: Iterator[Piece], tool: ToolSetup, setup: Setup, contacts: Contacts
) -> Iterator[Record]:
    """Straight pieces of a motion, each with its own steps."""
    material, recorder = setup.material, setup.recorder
    for start, end, duration_s in pieces:
        begun_s = recorder.t_s
        yield from piece_steps(move, (start, end, duration_s), tool, setup)
        contacts.add(material.cut(tool, start, end, forbidden(move)), begun_s, start)
        contacts.add(material.touches(tool, start, end), begun_s, start)


def _cut_chords(
    move: Move, pieces: Iterator[Piece], tool: ToolSetup, setup: Setup, contacts: Contacts
) -> Iterator[Record]:
    """Chords of an arc, each a step; steps are solved together until slices change."""
    material = setup.material
    for chords in chord_groups(move, pieces, tool, setup):
        steps = chord_steps(move, chords, tool, setup)
        rigid_near = material.rigid_near(tool, np.array([chords[0][0], *(end for _, end, _ in chords)]))
        for (start, end, _), step in zip(chords, steps, strict=True):
            yield step
            if cut_in_chains(move, tool):
                material.add_chord(tool, start, end)
            else:
                contacts.add(material.cut(tool, start, end, None), step.t_s, start)
            if rigid_near:
                contacts.add(material.touches(tool, start, end), step.t_s, start)


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
        preview: whether patches of the workpiece's surface are among the records; the others do not depend on it.
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
