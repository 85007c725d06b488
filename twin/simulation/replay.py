"""Flow A on one page: NC program -> motion -> engagement -> forces -> removal -> records.

run = Replay(load_job("job.toml"))
for record in run:
    sink.write(record)
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from itertools import pairwise
from types import TracebackType
from typing import Self

import numpy as np

from gcode.events import Block, Event, ToolChange
from twin.arrays import FloatArray
from twin.cutting.engagement import Positions
from twin.errors import CollisionError, ReplayError
from twin.job import Job
from twin.motion.path import Move
from twin.record import Collision, CollisionKind, ForceSamples, Record, RunSummary, Step
from twin.simulation.clock import SpindleClock, Turned
from twin.simulation.contacts import Contact, Contacts, box_of, collision_record, forbidden, point
from twin.simulation.header import run_header
from twin.simulation.material import Material
from twin.simulation.nc_events import nc_event
from twin.simulation.preview import FRAMES, Preview
from twin.simulation.program import checked_time_s, program_moves
from twin.simulation.setup import ToolSetup, machine_settings, stock_slices, tool_setup, workpiece
from twin.simulation.solve import IN_AIR, Solved, StepSolver, one_ahead
from twin.simulation.totals import Totals
from twin.tolerance import Tolerance
from twin.workpiece.to_mesh import SurfaceMesh, surface_mesh

#: Threads that work on slices and steps.
THREADS = min(8, os.cpu_count() or 1)
#: Steps of a motion that are solved together, whatever the number of threads.
_STEPS_TOGETHER = 64


class Replay:
    """One replay of a job; iterate over it once for its records, in order, with flat memory.

    Making it reads the whole program and refuses what cannot be replayed before anything is cut.

    Args:
        strict: end at the first collision with a `CollisionError` instead of reporting it and going on.
        threads: how many work on slices and steps, None for all cores; results do not depend on it.
        preview: whether patches of the workpiece's surface are among the records, at key frames, where motions are
            divided.

    Raises:
        TwinError, gcode.errors.GcodeError: a job, tool, stock or program that cannot be replayed.
    """

    def __init__(self, job: Job, *, strict: bool = False, threads: int | None = None, preview: bool = True) -> None:
        self.job = job
        threads = THREADS if threads is None else threads
        self._strict = strict
        self._tolerance = Tolerance.for_pitch(job.simulation.slice_pitch_mm)
        slices = stock_slices(job)
        self._settings = machine_settings(job, slices)
        self._tools = {t.number: tool_setup(job, t, self._tolerance) for t in job.tools}
        self.planned_time_s = checked_time_s(job, self._settings, self._tools)
        self.workpiece = workpiece(job, slices)
        self._material = Material(self.workpiece, self._tolerance, threads)
        self._solver = StepSolver(self.workpiece, threads)
        self._rows = round(360.0 / job.simulation.angle_step_deg)
        self._clock = SpindleClock(self._rows)
        self._descriptions = {n: t.description for n, t in self._tools.items()}
        self._totals = Totals(self._descriptions)
        self._frame_s = self.planned_time_s / FRAMES or math.inf
        self._frame_s = self._frame_s if preview else math.inf
        self._preview = Preview(self.workpiece, job.simulation.preview_pitch_mm, self._frame_s) if preview else None
        self._t_s = 0.0
        self._steps = 0
        self._checked_tool = 0

    def __iter__(self) -> Iterator[Record]:
        yield run_header(self.job, self.workpiece, [t.record for t in self._tools.values()], self.planned_time_s)
        if self._preview is not None:
            yield from self._preview.all_patches(0.0)
        for item in program_moves(self.job, self._settings):
            yield from self._move(item) if isinstance(item, Move) else self._event(item)
        self._material.flush()
        yield from self._changed_patches()
        yield self.summary(complete=True)

    def _event(self, event: Event) -> Iterator[Record]:
        if isinstance(event, Block):
            self._totals.set_block(event.place.text)
        if isinstance(event, ToolChange):
            self._t_s += self.job.machine.tool_change_s
            self._totals.add_time(self._t_s)
        yield nc_event(event, self._t_s, self._descriptions)

    def _move(self, move: Move) -> Iterator[Record]:
        """Step a motion: engagement and forces at each step, then its material removed."""
        tool = self._tools.get(move.tool)
        if tool is None or not self._material.near(tool, *box_of(move)):
            for start, end, duration_s in _pieces(move, math.inf, 0.5 * self.job.simulation.slice_pitch_mm):
                turned = self._clock.advance(self._t_s, duration_s, move.spindle_rpm)
                yield self._step(move, start, end, duration_s, turned)
            return
        self._refuse_start_inside(tool, move)
        contacts = Contacts()
        for start, end, duration_s in _pieces(move, self.job.simulation.step_mm, self._tolerance.chord_mm):
            begun_s = self._t_s
            for a, b, part_s in _frames(start, end, duration_s, self._frame_s):
                yield from self._piece(move, tool, a, b, part_s)
                contacts.add(self._material.cut(tool, a, b, forbidden(move)), begun_s, start)
                if self._preview is not None and self._preview.due(self._t_s):
                    yield from self._changed_patches()
            contacts.add(self._material.touches(tool, start, end), begun_s, start)
        for kind, contact in contacts.found.items():
            yield self._collision(move, kind, contact)

    def _piece(
        self, move: Move, tool: ToolSetup, start: FloatArray, end: FloatArray, duration_s: float
    ) -> Iterator[Record]:
        """The steps of one straight piece of a motion."""
        if forbidden(move) is None and np.any(end != start):
            yield from self._cut(move, tool, start, end, duration_s)
        else:
            yield self._step(move, start, end, duration_s, self._clock.advance(self._t_s, duration_s, move.spindle_rpm))

    def _cut(
        self, move: Move, tool: ToolSetup, start: FloatArray, end: FloatArray, duration_s: float
    ) -> Iterator[Record]:
        """The steps of a feed motion, each asked for its engagement at its middle, many of them together."""
        along = end - start
        length = float(np.linalg.norm(along))
        feed = along / length
        count = max(1, math.ceil(length / self.job.simulation.step_mm * (1.0 - 1e-9)))
        ends = start + along * (np.arange(count + 1) / count)[:, None]
        for first, turns, answer in one_ahead(self._begun(move, tool, ends, feed, duration_s / count)):
            for i, (turned, solved) in enumerate(zip(turns, answer(), strict=True), start=first):
                yield self._step(move, ends[i], ends[i + 1], duration_s / count, turned, solved)

    def _begun(
        self, move: Move, tool: ToolSetup, ends: FloatArray, feed: FloatArray, step_s: float
    ) -> Iterator[tuple[int, list[Turned], Callable[[], list[Solved]]]]:
        """Steps whose solution has begun, many together: the first one's number, their samples, and the answer."""
        pending = self._material.pending(tool.number, ends[0], feed)
        count, t_s = len(ends) - 1, self._t_s
        for first in range(0, count, _STEPS_TOGETHER):
            n = min(_STEPS_TOGETHER, count - first)
            turns = []
            for _ in range(n):
                turns.append(self._clock.advance(t_s, step_s, move.spindle_rpm))
                t_s += step_s
            at = Positions(
                0.5 * (ends[first : first + n] + ends[first + 1 : first + n + 1]),
                np.repeat(feed[None, :], n, axis=0),
                np.full(n, move.feed_mm_min / 60.0),
                np.full(n, move.feed_mm_min / (abs(move.spindle_rpm) * tool.teeth)),
                np.full(n, len(pending), dtype=np.int64),
            )
            rpm = np.full(n, move.spindle_rpm)
            yield first, turns, self._solver.solve(tool, at, [angles for _, angles in turns], rpm, pending)

    def _step(
        self,
        move: Move,
        start: FloatArray,
        end: FloatArray,
        duration_s: float,
        turned: Turned,
        solved: Solved = IN_AIR,
    ) -> Step:
        """The record of one step; moves time on.

        Args:
            turned: times and spindle angles of its samples.
        """
        times, angles = turned
        tool = self._tools.get(move.tool)
        loads = solved.loads
        if loads is None:
            keep = [0, -1] if len(times) > 2 else slice(None)
            times, angles = times[keep], angles[keep]
            loads = np.zeros((len(times), 4))
        if tool is not None and tool.forces is None:
            times, angles, loads = times[:0], angles[:0], loads[:0]
        torque_nm = loads[:, 3] * 1e-3
        step = Step(
            index=self._steps,
            t_s=self._t_s,
            duration_s=duration_s,
            start_mm=point(start),
            end_mm=point(end),
            nc_line=move.nc_line,
            tool=move.tool,
            rapid=move.rapid,
            feed_mm_min=move.feed_mm_min,
            spindle_rpm=move.spindle_rpm,
            engagement=solved.engagement,
            samples=ForceSamples(
                t_s=times,
                spindle_angle_rad=angles,
                force_n=loads[:, :3],
                torque_nm=torque_nm,
                power_w=torque_nm * abs(move.spindle_rpm) * (2.0 * math.pi / 60.0),
            ),
        )
        self._steps += 1
        self._t_s += duration_s
        self._totals.add_step(step, 60.0 / (abs(move.spindle_rpm) * self._rows) if move.spindle_rpm else 0.0)
        return step

    def _refuse_start_inside(self, tool: ToolSetup, move: Move) -> None:
        """The first motion near the stock after a tool change must not begin inside the material."""
        if tool.number == self._checked_tool:
            return
        self._checked_tool = tool.number
        volume = self._material.volume_inside(tool, move.start_mm)
        if self._material.significant(volume):
            x, y, z = move.start_mm
            raise ReplayError(
                f"{self.job.program.file}:{move.nc_line}: tool T{tool.number} ({tool.description}) begins inside the "
                f"stock at X{x:g} Y{y:g} Z{z:g}; expected a start outside it (machine.start_mm, or the program's "
                "tool change position)"
            )

    def _collision(self, move: Move, kind: CollisionKind, contact: Contact) -> Collision:
        self._totals.collisions += 1
        collision = collision_record(kind, contact, move, str(self.job.program.file))
        if self._strict:
            raise CollisionError(collision.message)
        return collision

    def _changed_patches(self) -> Iterator[Record]:
        changed, self._material.changed = self._material.changed, []
        return self._preview.changed_patches(self._t_s, changed) if self._preview is not None else iter(())

    def summary(self, *, complete: bool = False) -> RunSummary:
        """Sums, peaks and digest of what was replayed so far."""
        areas = tuple(self.workpiece.areas_mm2(axis) for axis in range(3))
        return self._totals.summary(complete=complete, areas_mm2=areas, removed_mm3=self._material.removed_mm3)

    def mesh(self) -> SurfaceMesh:
        """The surface of the workpiece as it is now."""
        self._material.flush()
        return surface_mesh(self.workpiece, self.job.simulation.preview_pitch_mm)

    def close(self) -> None:
        """Let worker threads go."""
        self._material.close()
        self._solver.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _pieces(move: Move, step_mm: float, chord_mm: float) -> Iterator[tuple[FloatArray, FloatArray, float]]:
    """A motion in straight pieces: start, end, duration."""
    corners = move.corners_mm(step_mm, chord_mm)
    lengths = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    total = float(lengths.sum())
    for (start, end), length in zip(pairwise(corners), lengths, strict=True):
        yield start, end, move.duration_s * (float(length) / total if total > 0.0 else 1.0)


def _frames(
    start: FloatArray, end: FloatArray, duration_s: float, longest_s: float
) -> Iterator[tuple[FloatArray, FloatArray, float]]:
    """A straight piece in parts that take no longer than the time between key frames."""
    count = max(1, math.ceil(duration_s / longest_s)) if np.any(end != start) else 1
    ends = [start + (end - start) * (i / count) for i in range(count)] + [end]
    for a, b in pairwise(ends):
        yield a, b, duration_s / count
