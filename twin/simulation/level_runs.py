"""Level feed motions in short lines, without forces: gathered, and cut in chains as the chords of an arc are."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from gcode.events import Block, Event
from twin.motion.path import Move
from twin.record import Record
from twin.simulation.chords import chords_where_it_changes, in_one_direction
from twin.simulation.clock import UNSAMPLED
from twin.simulation.contacts import Contacts
from twin.simulation.setup import Setup
from twin.simulation.short_motions import Joined
from twin.simulation.solve import Solved
from twin.simulation.steps import STEPS_TOGETHER, Piece
from twin.simulation.tools import ToolSetup

#: Fewer motions than this are not worth a chain.
_LEAST = 4


@dataclass(frozen=True, slots=True, eq=False)
class LevelRun:
    """Consecutive level feed motions, no longer than a step, of a tool without forces.

    Attributes:
        items: the motions, and the blocks that begin between them, in order.
        chords: start, end and duration of each motion.
        first: the first motion.
    """

    items: tuple[Move | Joined | Event, ...]
    chords: tuple[Piece, ...]
    first: Move


def level_runs(
    items: Iterable[Move | Joined | Event], tools: Mapping[int, ToolSetup], step_mm: float
) -> Iterator[Move | Joined | Event | LevelRun]:
    """Gather level motions of tools without forces in runs; everything else is passed on.

    Args:
        step_mm: longest motion that is gathered.
    """
    held: list[Move | Joined | Event] = []
    moves: list[Move] = []
    for item in items:
        move = _level(item, tools, step_mm)
        if moves and (isinstance(item, Block) or (move is not None and _goes_on(moves, move))):
            held.append(item)
            moves.extend([move] if move is not None else ())
            continue
        yield from _released(held, moves)
        held, moves = ([item], [move]) if move is not None else ([], [])
        if move is None:
            yield item
    yield from _released(held, moves)


def _level(item: Move | Joined | Event, tools: Mapping[int, ToolSetup], step_mm: float) -> Move | None:
    """The motion of an item that may be gathered."""
    move = item.whole if isinstance(item, Joined) else item
    if not isinstance(move, Move) or move.arc is not None or move.rapid or move.spindle_rpm == 0.0:
        return None
    tool = tools.get(move.tool)
    if tool is None or tool.forces is not None or move.start_mm[2] != move.end_mm[2]:
        return None
    return move if 0.0 < move.length_mm <= step_mm else None


def _goes_on(moves: list[Move], move: Move) -> bool:
    """Whether a motion continues a run."""
    first, last = moves[0], moves[-1]
    alike = (move.tool, move.feed_mm_min, move.spindle_rpm) == (first.tool, first.feed_mm_min, first.spindle_rpm)
    return alike and len(moves) < STEPS_TOGETHER and np.array_equal(move.start_mm, last.end_mm)


def _released(held: list[Move | Joined | Event], moves: list[Move]) -> Iterator[Move | Joined | Event | LevelRun]:
    """The items that are held: runs that go on in one direction, and the others on their own."""
    while moves:
        chords = [(move.start_mm, move.end_mm, move.duration_s) for move in moves]
        count = in_one_direction(chords)
        end, seen = 0, 0
        while seen < count:
            seen += isinstance(held[end], Move | Joined)
            end += 1
        if count < _LEAST:
            yield from held[:end]
        else:
            yield LevelRun(tuple(held[:end]), tuple(chords[:count]), moves[0])
        held, moves = held[end:], moves[count:]
    yield from held


def cut_level_run(run: LevelRun, tool: ToolSetup, setup: Setup) -> Iterator[Record]:
    """The records of a run near the stock; its material is removed, now or a little later."""
    material, recorder, first = setup.material, setup.recorder, run.first
    setup.starts.check(tool, first, material)
    material.settle(tool, first.start_mm, run.chords[0][1])
    rigid_near = material.rigid_near(tool, np.array([first.start_mm, *(end for _, end, _ in run.chords)]))
    solved = iter(zip(run.chords, chords_where_it_changes(first, run.chords, tool, setup), strict=True))
    for item in run.items:
        if not isinstance(item, Move | Joined):
            yield recorder.event(item)
            continue
        (start, end, _), own = next(solved)
        begun_s = recorder.t_s
        yield from _records(item, own, setup)
        material.add_chord(tool, start, end)
        if rigid_near:
            contacts = Contacts()
            contacts.add(material.touches(tool, start, end), begun_s, start)
            whole = item.whole if isinstance(item, Joined) else item
            yield from recorder.collisions(contacts.found(material.contact_mm3), whole)


def _records(item: Move | Joined, own: Solved, setup: Setup) -> Iterator[Record]:
    """The steps of one motion, or of those that are joined, and the blocks between them."""
    recorder = setup.recorder
    for inner in item.items if isinstance(item, Joined) else (item,):
        if isinstance(inner, Move):
            recorder.clock.turn(inner.duration_s, inner.spindle_rpm)
            yield recorder.step(inner, inner.start_mm, inner.end_mm, inner.duration_s, UNSAMPLED, own)
        else:
            yield recorder.event(inner)
