"""Feed motions far shorter than a step, joined: they share one step's engagement and one sweep.

Programs of surfaces consist of motions of a few hundredths of a millimetre. An engagement for each would cost as much
as that of a whole step, although it is nearly the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from gcode.events import Block, Event
from twin.motion.path import Move

#: Most motions that are joined.
_MOST = 64
#: Least part of the motions' length that the line from the first start to the last end has.
_FORWARD = 0.95


@dataclass(frozen=True, slots=True, eq=False)
class Joined:
    """Consecutive feed motions that lie close to one line no longer than a step.

    Attributes:
        items: the motions, and the blocks that begin between them, in order.
        whole: the straight motion from the first start to the last end.
    """

    items: tuple[Move | Event, ...]
    whole: Move


def joined(items: Iterable[Move | Event], step_mm: float, off_mm: float) -> Iterator[Move | Event | Joined]:
    """Join short feed motions; everything else is passed on.

    Args:
        step_mm: longest length of motions that are joined.
        off_mm: how far their ends may be off the line that replaces them.
    """
    held: list[Move | Event] = []
    moves: list[Move] = []
    for item in items:
        if moves and (isinstance(item, Block) or (isinstance(item, Move) and _goes_on(moves, item, step_mm, off_mm))):
            held.append(item)
            moves.extend([item] if isinstance(item, Move) else ())
            continue
        yield from _released(held, moves)
        held, moves = [], []
        if isinstance(item, Move) and _is_short(item, step_mm):
            held, moves = [item], [item]
        else:
            yield item
    yield from _released(held, moves)


def _released(held: list[Move | Event], moves: list[Move]) -> Iterator[Move | Event | Joined]:
    """The items that are held: several motions as one, the blocks after them on their own."""
    if len(moves) < 2:
        yield from held
        return
    end = 1 + max(i for i, item in enumerate(held) if isinstance(item, Move))
    duration_s = sum(move.duration_s for move in moves)
    yield Joined(tuple(held[:end]), replace(moves[0], end_mm=moves[-1].end_mm, duration_s=duration_s))
    yield from held[end:]


def _is_short(move: Move, step_mm: float) -> bool:
    feeds = move.arc is None and not move.rapid and move.feed_mm_min > 0.0 and move.spindle_rpm != 0.0
    return feeds and move.length_mm <= 0.5 * step_mm


def _goes_on(moves: list[Move], move: Move, step_mm: float, off_mm: float) -> bool:
    """Whether a motion continues others so that all are close to one line."""
    first, last = moves[0], moves[-1]
    if len(moves) >= _MOST or not _is_short(move, step_mm) or not np.array_equal(move.start_mm, last.end_mm):
        return False
    if (move.tool, move.feed_mm_min, move.spindle_rpm) != (first.tool, first.feed_mm_min, first.spindle_rpm):
        return False
    total = sum(m.length_mm for m in moves) + move.length_mm
    line = move.end_mm - first.start_mm
    length = float(np.linalg.norm(line))
    if total > step_mm or length < _FORWARD * total:
        return False
    ends = np.array([m.end_mm for m in moves]) - first.start_mm
    off = ends - (ends @ line / length**2)[:, None] * line
    return bool(np.max(np.abs(off)) <= off_mm)
