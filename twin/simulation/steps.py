"""Steps of motions: their positions, and engagement and forces of many together."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import islice
from typing import TypeAlias

import numpy as np

from twin.arrays import FloatArray
from twin.cutting.engagement import Positions
from twin.errors import ReplayError
from twin.motion.path import Move
from twin.motion.sweep import SweptVolume
from twin.record import Step
from twin.simulation.clock import Turned
from twin.simulation.contacts import forbidden
from twin.simulation.setup import Setup
from twin.simulation.solve import Solved, StepSolver, one_ahead
from twin.simulation.sparse import solved_where_it_changes
from twin.simulation.tools import ToolSetup

#: A straight motion of the tool tip: start and end, shape (3,), mm, and its duration, s.
Piece: TypeAlias = tuple[FloatArray, FloatArray, float]
#: Steps of a motion that are solved together, whatever the number of threads.
STEPS_TOGETHER = 64
#: The same for a tool without forces.
SPARSE_TOGETHER = 512
#: Most steps of one motion, and most force samples of one step and of steps that are solved together.
_MOST_STEPS, _MOST_SAMPLES, SAMPLES_TOGETHER = 10_000_000, 5_000_000, 1_000_000


def positions(move: Move, tool: ToolSetup, ends: FloatArray, feed: FloatArray, pending: SweptVolume) -> Positions:
    """The middles of steps whose ends are given, shape (n + 1, 3)."""
    n = len(ends) - 1
    return Positions(
        0.5 * (ends[:-1] + ends[1:]),
        np.repeat(feed[None, :], n, axis=0),
        np.full(n, move.feed_mm_min / 60.0),
        np.full(n, move.feed_mm_min / (abs(move.spindle_rpm) * tool.teeth)),
        np.full(n, len(pending), dtype=np.int64),
    )


def piece_steps(move: Move, piece: Piece, tool: ToolSetup, setup: Setup) -> Iterator[Step]:
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
    refuse_endless(move, count, per_step, setup)
    together = max(1, min(STEPS_TOGETHER, int(SAMPLES_TOGETHER / max(1.0, per_step))))
    ends = start + along * (np.arange(count + 1) / count)[:, None]
    pending = setup.material.pending(tool.number, start, along / length)
    turns = setup.recorder.turns(setup.recorder.t_s, step_s, move)
    if tool.forces is None:
        yield from _without_forces(move, tool, ends, step_s, pending, turns, setup)
        return
    begun = _begun(move, tool, ends, along / length, pending, turns, setup.solver, together)
    for first, turned, answer in one_ahead(begun):
        for i, (samples, solved) in enumerate(zip(turned, answer(), strict=True), start=first):
            yield setup.recorder.step(move, ends[i], ends[i + 1], step_s, samples, solved)


def _without_forces(
    move: Move,
    tool: ToolSetup,
    ends: FloatArray,
    step_s: float,
    pending: SweptVolume,
    turns: Iterator[Turned],
    setup: Setup,
) -> Iterator[Step]:
    """The steps of a line for a tool without forces; see `_begun`."""
    along = ends[-1] - ends[0]
    length = float(np.linalg.norm(along))
    for first in range(0, len(ends) - 1, SPARSE_TOGETHER):
        at = positions(move, tool, ends[first : first + SPARSE_TOGETHER + 1], along / length, pending)
        step_mm = length / (len(ends) - 1)
        solved = solved_where_it_changes(at, step_mm, move.spindle_rpm, tool, setup, pending)
        for i, own in enumerate(solved, start=first):
            yield setup.recorder.step(move, ends[i], ends[i + 1], step_s, next(turns), own)


def refuse_endless(move: Move, steps: int, samples: float, setup: Setup) -> None:
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
        at = positions(move, tool, part, feed, pending)
        rpm = np.full(n, move.spindle_rpm)
        yield first, turned, solver.solve(tool, at, [angles for _, angles in turned], rpm, pending)
