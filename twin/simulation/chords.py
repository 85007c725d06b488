"""Feed along an arc: chords, each a step, solved together and cut together.

With forces, the steps of chords are solved together as long as the slices stay as they are; chords are cut one after
the other, so that results are those of straight motions along them.

Without forces, chords are cut in chains of up to a quarter turn. Engagement is found at some of them, and at those
between only where it changes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cutting.engagement import Positions
from twin.motion.path import Move
from twin.record import Step
from twin.simulation.material import Material
from twin.simulation.setup import Setup
from twin.simulation.solve import Solved
from twin.simulation.sparse import solved_where_it_changes
from twin.simulation.steps import SAMPLES_TOGETHER, STEPS_TOGETHER, Piece, refuse_endless
from twin.simulation.tools import ToolSetup

#: Chords that turn by no more than this do not reach the front of the tool at those after them.
_TURN_RAD = 0.5 * math.pi * (1.0 + 1e-9)


def chords_are_steps(move: Move, setup: Setup) -> bool:
    """Whether each chord of an arc is one step."""
    corners = move.corners_mm(setup.step_mm, setup.tolerance.chord_mm)
    lengths = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    return bool(lengths.min() > 0.0 and lengths.max() <= setup.step_mm)


def chains(move: Move) -> bool:
    """Whether the chords of a motion may be cut in chains: those of arcs about the tool axis.

    Chords of vertical arcs that climb steeply may be cut some hundredths of a millimetre too deep in chains.
    """
    return move.arc is not None and move.arc.plane == 17


def cut_in_chains(move: Move, tool: ToolSetup) -> bool:
    """Whether the chords of a motion are cut in chains in a replay: where no forces are computed."""
    return tool.forces is None and chains(move)


def chord_groups(move: Move, pieces: Iterator[Piece], tool: ToolSetup, setup: Setup) -> Iterator[list[Piece]]:
    """The chords of an arc in groups for `chord_steps`; each must be cut before the next is taken."""
    if cut_in_chains(move, tool):
        yield from chain_groups(pieces, tool, setup.material)
        return
    held = list(islice(pieces, STEPS_TOGETHER))
    while held:
        samples = max(setup.recorder.samples_in(duration_s, move.spindle_rpm) for _, _, duration_s in held)
        refuse_endless(move, len(held), samples, setup)
        most = max(1, int(SAMPLES_TOGETHER / max(1.0, samples)))
        count = setup.material.until_subtracted(_along(held[:most])[1].tolist())
        yield held[:count]
        held = [*held[count:], *islice(pieces, count)]


def chain_groups(pieces: Iterator[Piece], tool: ToolSetup, material: Material) -> Iterator[list[Piece]]:
    """Chords in groups that become chains; each must be added to the material before the next is taken."""
    held = list(islice(pieces, STEPS_TOGETHER))
    while held:
        material.settle(tool, *held[0][:2])
        count = in_one_direction(held)
        yield held[:count]
        held = [*held[count:], *islice(pieces, count)]


def in_one_direction(chords: Sequence[Piece]) -> int:
    """How many of the first chords go on in one direction along each axis and turn by no more than `_TURN_RAD`."""
    along, lengths = _along(chords)
    back = (np.minimum.accumulate(along, axis=0) < 0.0) & (np.maximum.accumulate(along, axis=0) > 0.0)
    turned = along @ along[0] < math.cos(_TURN_RAD) * lengths * lengths[0]
    other = np.flatnonzero(back.any(axis=1) | turned)
    return int(other[0]) if len(other) else len(chords)


def _along(chords: Sequence[Piece]) -> tuple[FloatArray, FloatArray]:
    """From the start to the end of each chord, shape (n, 3), and the lengths, shape (n,)."""
    along = np.array([end for _, end, _ in chords]) - np.array([start for start, _, _ in chords])
    return along, np.linalg.norm(along, axis=1)


def chord_steps(move: Move, chords: Sequence[Piece], tool: ToolSetup, setup: Setup) -> Iterator[Step]:
    """The steps of consecutive chords of a feed motion, one for each.

    The slices must stay as they are until the last step has been passed on.
    """
    recorder = setup.recorder
    turned, t_s = [], recorder.t_s
    for _, _, duration_s in chords:
        turned.append(recorder.turned(t_s, duration_s, move))
        t_s += duration_s
    if cut_in_chains(move, tool):
        solved = chords_where_it_changes(move, chords, tool, setup)
    else:
        ends = np.array([chords[0][0], *(end for _, end, _ in chords)])
        at = _middles(move, chords, tool, np.arange(len(chords)) + setup.material.waiting)
        pending = setup.material.pending_chords(tool, ends)
        if tool.forces is None:
            longest = float(_along(chords)[1].max())
            solved = solved_where_it_changes(at, longest, move.spindle_rpm, tool, setup, pending)
        else:
            angles, rpm = [angle for _, angle in turned], np.full(len(chords), move.spindle_rpm)
            solved = setup.solver.solve(tool, at, angles, rpm, pending)()
    for (start, end, duration_s), samples, own in zip(chords, turned, solved, strict=True):
        yield recorder.step(move, start, end, duration_s, samples, own)


def _middles(move: Move, chords: Sequence[Piece], tool: ToolSetup, waiting: NDArray[np.int64]) -> Positions:
    """The middles of chords; ``waiting`` is how many pending sweeps count for each."""
    starts = np.array([start for start, _, _ in chords])
    along, lengths = _along(chords)
    n = len(chords)
    return Positions(
        0.5 * (starts + (starts + along)),
        along / lengths[:, None],
        np.full(n, move.feed_mm_min / 60.0),
        np.full(n, move.feed_mm_min / (abs(move.spindle_rpm) * tool.teeth)),
        waiting,
    )


def chords_where_it_changes(move: Move, chords: Sequence[Piece], tool: ToolSetup, setup: Setup) -> list[Solved]:
    """The engagement of each chord, without forces; see `solved_where_it_changes`.

    The sweeps of the chords themselves are not excluded: none reaches the front of the tool at a later one.
    """
    pending = setup.material.pending_chords(tool, np.empty((0, 3)))
    at = _middles(move, chords, tool, np.full(len(chords), len(pending), dtype=np.int64))
    return solved_where_it_changes(at, float(_along(chords)[1].max()), move.spindle_rpm, tool, setup, pending)
