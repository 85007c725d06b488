"""Short straight feed motions in runs: the steps of all of them are solved together, then they are cut in order.

A step is tested against the material before its own motion. Motions of the run before it have not been subtracted then:
their sweeps are excluded exactly, like those that wait.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gcode.events import Block, Event
from twin.arrays import FloatArray
from twin.cutting.engagement import Positions
from twin.motion.path import Move
from twin.motion.sweep import Sweep
from twin.record import Record
from twin.simulation.clock import Turned
from twin.simulation.contacts import Contacts
from twin.simulation.level_runs import LevelRun
from twin.simulation.setup import Setup
from twin.simulation.short_motions import Joined
from twin.simulation.solve import IN_AIR, Solved
from twin.simulation.sparse import solved_where_it_changes
from twin.simulation.steps import SAMPLES_TOGETHER
from twin.simulation.tools import ToolSetup

#: Longest motion that is gathered, and most of a run, in steps.
_LONGEST, _MOST = 16, 64
Item: TypeAlias = Move | Event | Joined | LevelRun


@dataclass(frozen=True, slots=True, eq=False)
class FeedRun:
    """Consecutive straight feed motions of one tool at one spindle speed.

    Attributes:
        items: the motions, and the blocks that begin between them, in order.
        lines: the motions, those that are joined as one.
    """

    items: tuple[Move | Joined | Event, ...]
    lines: tuple[Move, ...]


class _Steps(NamedTuple):
    """Steps of the lines of a run.

    Attributes:
        line: shape (n,), number of each step's line.
        starts_mm, ends_mm: shape (n, 3).
        step_s: shape (lines,), duration of the steps of each line.
        counts: shape (lines,), their number.
    """

    line: NDArray[np.int64]
    starts_mm: FloatArray
    ends_mm: FloatArray
    step_s: FloatArray
    counts: NDArray[np.int64]


def feed_runs(items: Iterable[Item], tools: Mapping[int, ToolSetup], step_mm: float) -> Iterator[Item | FeedRun]:
    """Gather short straight feed motions in runs; everything else is passed on."""
    held: list[Move | Joined | Event] = []
    lines: list[Move] = []
    steps = 0.0
    for item in items:
        line = _line(item, tools, _LONGEST * step_mm)
        goes_on = lines and line is not None and steps < _MOST and _goes_on(lines[-1], line)
        if lines and not isinstance(item, LevelRun) and (goes_on or isinstance(item, Block)):
            held.append(item)
        else:
            yield from _released(held, lines)
            held, lines, steps = [], [], 0.0
            if line is None or not isinstance(item, Move | Joined):
                yield item
                continue
            held.append(item)
        if line is not None:
            lines.append(line)
            steps += max(1.0, line.length_mm / step_mm)
    yield from _released(held, lines)


def _line(item: Item, tools: Mapping[int, ToolSetup], longest_mm: float) -> Move | None:
    """The motion of an item that may be gathered."""
    move = item.whole if isinstance(item, Joined) else item
    if not isinstance(move, Move) or move.arc is not None or move.rapid or move.spindle_rpm == 0.0:
        return None
    if move.feed_mm_min == 0.0 or move.tool not in tools:
        return None
    return move if 0.0 < move.length_mm <= longest_mm else None


def _goes_on(last: Move, move: Move) -> bool:
    """Whether a motion continues a run."""
    alike = move.tool == last.tool and move.spindle_rpm == last.spindle_rpm
    return alike and np.array_equal(move.start_mm, last.end_mm)


def _released(held: list[Move | Joined | Event], lines: list[Move]) -> Iterator[Item | FeedRun]:
    """The items that are held, as a run where that is worth it; the blocks after the last motion on their own."""
    if len(lines) < 2:
        yield from held
        return
    end = 1 + max(i for i, item in enumerate(held) if isinstance(item, Move | Joined))
    yield FeedRun(tuple(held[:end]), tuple(lines))
    yield from held[end:]


def cut_feed_run(
    run: FeedRun, setup: Setup, one_by_one: Callable[[Move | Joined | Event], Iterator[Record]]
) -> Iterator[Record]:
    """The records of a run; its material is removed, now or a little later.

    Args:
        one_by_one: the records of one item, for runs that do not come near the stock.
    """
    material, first = setup.material, run.lines[0]
    tool = setup.tools[first.tool]
    corners = np.array([first.start_mm, *(line.end_mm for line in run.lines)])
    near = material.near_each(tool, corners)
    samples = setup.recorder.samples_in(sum(line.duration_s for line in run.lines), first.spindle_rpm)
    if not near.any() or samples > SAMPLES_TOGETHER:
        for item in run.items:
            yield from one_by_one(item)
        return
    setup.starts.check(tool, run.lines[int(np.argmax(near))], material)
    steps = _steps(run, corners, near, setup.step_mm)
    turned = _turned(run, near, steps, setup)
    sweeps = [
        Sweep(tool.cutter, line.start_mm, line.end_mm) for line, cuts in zip(run.lines, near, strict=True) if cuts
    ]
    solved = iter(_solved(run, steps, near, turned, sweeps, tool, setup))
    rigid_near = material.rigid_near(tool, corners)
    yield from _records(run, near, steps, turned, iter(sweeps), solved, tool, setup, rigid_near=rigid_near)


def _steps(run: FeedRun, corners: FloatArray, near: NDArray[np.bool_], step_mm: float) -> _Steps:
    """Steps of the lines that come near the stock."""
    along = np.diff(corners, axis=0)
    lengths = np.sqrt(np.einsum("ij,ij->i", along, along))
    counts = np.maximum(1, np.ceil(lengths / step_mm * (1.0 - 1e-9))).astype(np.int64)
    joined = [isinstance(item, Joined) for item in run.items if isinstance(item, Move | Joined)]
    counts[joined] = 1
    step_s = np.array([line.duration_s for line in run.lines]) / counts
    numbers = np.flatnonzero(near)
    line = np.repeat(numbers, counts[numbers])
    within = np.concatenate([np.arange(n) for n in counts[numbers]])
    starts = corners[line] + along[line] * (within / counts[line])[:, None]
    ends = corners[line] + along[line] * ((within + 1) / counts[line])[:, None]
    return _Steps(line, starts, ends, step_s, counts)


def _turned(run: FeedRun, near: NDArray[np.bool_], steps: _Steps, setup: Setup) -> list[list[Turned]]:
    """The samples of each step of each line, of the motions that are joined each, of a line in air at its ends."""
    recorder, t_s, turned = setup.recorder, setup.recorder.t_s, []
    lines = iter(zip(run.lines, near.tolist(), steps.step_s.tolist(), steps.counts.tolist(), strict=True))
    for item in run.items:
        if not isinstance(item, Move | Joined):
            continue
        line, cuts, step_s, count = next(lines)
        own = []
        if isinstance(item, Joined):
            for move in item.items:
                if isinstance(move, Move):
                    own.append(recorder.turned(t_s, move.duration_s, move, ends_only=not cuts))
                    t_s += move.duration_s
        elif cuts:
            for _ in range(count):
                own.append(recorder.turned(t_s, step_s, line))
                t_s += step_s
        else:
            own.append(recorder.turned(t_s, line.duration_s, line, ends_only=True))
            t_s += line.duration_s
        turned.append(own)
    return turned


def _solved(
    run: FeedRun,
    steps: _Steps,
    near: NDArray[np.bool_],
    turned: list[list[Turned]],
    sweeps: list[Sweep],
    tool: ToolSetup,
    setup: Setup,
) -> list[Solved]:
    """Engagement and forces of each step."""
    before = np.cumsum(near) - 1
    pending = setup.material.pending_sweeps(tool, sweeps[:-1])
    along = np.array([line.end_mm - line.start_mm for line in run.lines])
    feed = along / np.sqrt(np.einsum("ij,ij->i", along, along))[:, None]
    feed_mm_s = np.array([line.feed_mm_min for line in run.lines]) / 60.0
    rpm, line = run.lines[0].spindle_rpm, steps.line
    at = Positions(
        0.5 * (steps.starts_mm + steps.ends_mm),
        feed[line],
        feed_mm_s[line],
        feed_mm_s[line] * (60.0 / (abs(rpm) * tool.teeth)),
        setup.material.waiting + before[line],
    )
    if tool.forces is None:
        longest = float(np.max(np.abs(steps.ends_mm - steps.starts_mm)) * math.sqrt(3.0))
        return solved_where_it_changes(at, longest, rpm, tool, setup, pending)
    angles = []
    for item, own, cuts in zip((i for i in run.items if isinstance(i, Move | Joined)), turned, near, strict=True):
        if cuts and isinstance(item, Joined):
            angles.append(np.concatenate([angle for _, angle in own]))
        elif cuts:
            angles.extend(angle for _, angle in own)
    return setup.solver.solve(tool, at, angles, np.full(len(at), rpm), pending)()


def _records(
    run: FeedRun,
    near: NDArray[np.bool_],
    steps: _Steps,
    turned: list[list[Turned]],
    sweeps: Iterator[Sweep],
    solved: Iterator[Solved],
    tool: ToolSetup,
    setup: Setup,
    *,
    rigid_near: bool,
) -> Iterator[Record]:
    """The records of a run, its lines cut one after the other."""
    material, recorder = setup.material, setup.recorder
    bounds = zip(steps.starts_mm, steps.ends_mm, strict=True)
    lines = iter(zip(run.lines, near.tolist(), steps.step_s.tolist(), turned, strict=True))
    for item in run.items:
        if not isinstance(item, Move | Joined):
            yield recorder.event(item)
            continue
        line, cuts, step_s, own = next(lines)
        begun_s = recorder.t_s
        if isinstance(item, Joined):
            if cuts:
                next(bounds)
            yield from _joined_records(item, own, next(solved) if cuts else None, setup)
        elif cuts:
            for samples in own:
                start, end = next(bounds)
                yield recorder.step(line, start, end, step_s, samples, next(solved))
        else:
            yield recorder.step(line, line.start_mm, line.end_mm, line.duration_s, own[0], IN_AIR)
        if cuts:
            material.add(tool, next(sweeps))
            if rigid_near:
                contacts = Contacts()
                contacts.add(material.touches(tool, line.start_mm, line.end_mm), begun_s, line.start_mm)
                yield from recorder.collisions(contacts.found(material.contact_mm3), line)


def _joined_records(item: Joined, turned: list[Turned], solved: Solved | None, setup: Setup) -> Iterator[Record]:
    """The records of joined motions, which share an engagement, and of the blocks between them."""
    recorder, samples = setup.recorder, iter(turned)
    first = 0
    for move in item.items:
        if not isinstance(move, Move):
            yield recorder.event(move)
            continue
        own = next(samples)
        last = first + len(own[0])
        loads = None if solved is None or solved.loads is None else solved.loads[first:last]
        shared = IN_AIR if solved is None else Solved(solved.engagement, loads)
        yield recorder.step(move, move.start_mm, move.end_mm, move.duration_s, own, shared)
        first = last
