"""Rapids and links that touch neither the part nor the stock: each is checked, and raised where it would touch.

Planners find the heights of links from points along them and from the stock's dexels, so anything narrower than the
distance of these points is missed. Here every rapid and every link of a finished path is checked against the exact
heights of the drop-cutter on the part, enlarged by the allowance, and rapids also against the stock as it is at that
moment, with the tool enlarged by half the diagonal of the dexels' grid. A path without a fault is returned as is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cam.path.arc_fit import replace_moves
from twin.cam.path.toolpath import Move, MoveKind, ToolPath, rapids
from twin.cam.stock.dexel import Dexels
from twin.cam.stock.rest import grown, stock_heights
from twin.cam.stock.strokes import Strokes
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import Surface
from twin.tools.shape import ToolShape

#: Distance of the first points along a move, mm. The tool is enlarged by half of it, so nothing between them is missed.
_COARSE_MM = 0.5
#: Distance of the points where the enlarged tool touches, mm: a ball of 1 mm sinks in by 0.05 um between two of them.
_FINE_MM = 0.02
#: A tip this much too low still counts as clear, mm: rounding.
_ROUNDING_MM = 1e-6
#: Rounded coordinates of a program are off by no more than this, mm; a steep wall rises this many times as much.
_PRINTED_MM, _STEEP = 7e-4, 10.0
#: Links that are raised go this much above the height at which the tool touches, mm.
_LIFT_MM = 0.002
#: Chord error of arcs, mm.
_CHORD_MM = 1e-4

#: Heights of the tip at which the tool touches, over plan points of shape (n, 2).
Touch = Callable[[FloatArray], FloatArray]


class Obstacle(NamedTuple):
    """A body that moves must clear.

    Attributes:
        exact: lowest tips.
        wide: the same with the tool enlarged by half of the coarse distance.
        top_mm: height above which a tip is clear anywhere.
    """

    exact: Touch
    wide: Touch
    top_mm: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ClearOptions:
    """How moves that would touch are raised.

    Attributes:
        safe_z_mm: height that rapids need not exceed.
        clearance_mm: distance of raised rapids above part and stock.
        feed_mm_min: feed down from where a rapid ends higher than planned, close to a wall of the stock.
    """

    safe_z_mm: float
    clearance_mm: float
    feed_mm_min: float


def part_obstacle(surface: Surface, tool: ToolShape, allowance_mm: float, exact: DropCutter | None = None) -> Obstacle:
    """The part with an allowance.

    Args:
        allowance_mm: to be left on the part; below 0 for a permitted gouge.
        exact: the tool over the part without allowance, where there is one already.
    """
    own = exact.drop if exact is not None and allowance_mm == 0.0 else _over(surface, tool, allowance_mm)
    return Obstacle(
        own, _over(surface, tool, allowance_mm + 0.5 * _COARSE_MM), float(surface.high_mm[2]) + allowance_mm
    )


def _over(surface: Surface, tool: ToolShape, by_mm: float) -> Touch:
    made: list[DropCutter] = []

    def touch(xy_mm: FloatArray) -> FloatArray:
        if not made:
            made.append(DropCutter(surface, grown(tool, by_mm), floor_mm=-math.inf))
        return made[0].drop(np.ascontiguousarray(xy_mm)) + by_mm

    return touch


def stock_obstacle(stock: Dexels, tool: ToolShape) -> Obstacle:
    """The stock between its dexels as well: the tool is enlarged by half the diagonal of their grid."""
    half = 0.5 * float(np.hypot(*stock.pitch_mm))

    def touch(by_mm: float) -> Touch:
        larger = grown(tool, by_mm)
        return lambda xy_mm: stock_heights(stock, larger, xy_mm, threads=1) + by_mm

    return Obstacle(touch(half), touch(half + 0.5 * _COARSE_MM), float(stock.heights_mm.max()) + half)


def with_clear_moves(
    path: ToolPath, options: ClearOptions, part: Obstacle, stock: Dexels | None = None, links: Obstacle | None = None
) -> ToolPath:
    """The path with every rapid and link that would touch raised.

    A rapid straight up is free wherever the tool is. Links may cut rest material, as they run at feed, but not the
    part.

    Args:
        part: from `part_obstacle`.
        stock: before the path, cut by it afterwards; None where no stock is known.
        links: the part as links must clear it; ``part`` if not given.
    """
    runs = [_Run(kind, tuple(same)) for kind, same in groupby(path.moves, key=lambda m: m.kind)]
    own = {MoveKind.RAPID: part, MoveKind.LINK: links or part}
    lines = {k: run.line for k, run in enumerate(runs) if run.kind in own}
    touching: set[int] = set()
    for kind, body in own.items():
        touching |= _which(lines, [k for k in lines if runs[k].kind is kind], body)
    in_stock = None if stock is None else stock_obstacle(stock, path.tool)
    # the stock only shrinks: rapids that clear it now clear it at their time, and it need not be cut before them
    rapid = [k for k in lines if runs[k].kind is MoveKind.RAPID]
    suspects = set() if in_stock is None else _which(lines, rapid, in_stock)
    low = _low_starts(runs, rapid, own[MoveKind.LINK])
    moves: list[Move] = []
    waiting: list[Move] = []
    changed = False
    for k, run in enumerate(runs):
        bodies, hit = [own.get(run.kind, part)], k in touching
        if stock is not None and in_stock is not None and run.kind is MoveKind.RAPID and (hit or k in suspects):
            bodies.append(in_stock)
            _cut(stock, path.tool, waiting)
            hit = hit or _touches([lines[k]], in_stock)[0]
        made = tuple(_raised(run, lines[k], bodies, options)) if hit else run.moves
        if k in low:
            made = (*_slow_rise(made[0], low[k], options), *made[1:])
        changed |= hit or k in low
        moves += made
        waiting += made
    if stock is not None:
        _cut(stock, path.tool, waiting)
    return replace_moves(path, tuple(moves)) if changed else path


def _low_starts(runs: Sequence[_Run], numbers: Sequence[int], part: Obstacle) -> dict[int, float]:
    """Runs of rapids that rise from below the lowest tip, as cuts may lie in the allowance by their tolerance.

    A rise along a steep wall that the tool touches counts too: the coordinates of the program are rounded.

    Returns:
        Lowest tips by the number of the run.
    """
    rising = [k for k in numbers if _rises(runs[k].moves[0])]
    if not rising:
        return {}
    starts = np.array([runs[k].moves[0].start_mm for k in rising])
    lowest = part.exact(starts[:, :2])
    angles = np.arange(8) * np.pi / 4.0
    around = starts[:, None, :2] + _PRINTED_MM * np.column_stack((np.cos(angles), np.sin(angles)))
    walls = part.exact(around.reshape(-1, 2)).reshape(-1, len(angles)).max(axis=1)
    lowest = np.where(walls > starts[:, 2] + _STEEP * _PRINTED_MM, walls, lowest)
    below = starts[:, 2] < lowest - _ROUNDING_MM
    return {k: float(z) for k, z, low in zip(rising, lowest, below, strict=True) if low}


def _rises(move: Move) -> bool:
    return bool(np.all(move.start_mm[:2] == move.end_mm[:2]) and move.end_mm[2] > move.start_mm[2])


def _slow_rise(rise: Move, lowest_mm: float, options: ClearOptions) -> Iterator[Move]:
    """A rise at feed to the lowest tip, and from there at the rapid rate."""
    middle = rise.start_mm.copy()
    middle[2] = min(lowest_mm, rise.end_mm[2])
    line = np.array([rise.start_mm, middle])
    yield Move(kind=MoveKind.RETRACT, points_mm=line, feed_mm_min=options.feed_mm_min)
    yield from rapids(np.array([middle, rise.end_mm]))


def _which(lines: Mapping[int, FloatArray], numbers: Sequence[int], body: Obstacle) -> set[int]:
    """The numbers of lines that come too low somewhere."""
    return {k for k, hit in zip(numbers, _touches([lines[k] for k in numbers], body), strict=True) if hit}


def _cut(stock: Dexels, tool: ToolShape, waiting: list[Move]) -> None:
    """Cut the moves that are waiting, and empty their list."""
    if waiting:
        stock.cut(tool, Strokes.of_tip(waiting))
        waiting.clear()


class _Run(NamedTuple):
    """Consecutive moves of one kind."""

    kind: MoveKind
    moves: tuple[Move, ...]

    @property
    def line(self) -> FloatArray:
        """Their points, without a first piece straight up for rapids, shape (n, 3)."""
        points = [m.chords_mm(_CHORD_MM) for m in self.moves]
        line = np.concatenate([points[0], *(p[1:] for p in points[1:])])
        if self.kind is MoveKind.RAPID:
            while len(line) > 1 and np.all(line[0, :2] == line[1, :2]) and line[1, 2] > line[0, 2]:
                line = line[1:]
        return line


def _touches(lines: Sequence[FloatArray], body: Obstacle) -> list[bool]:
    """Which polylines, shape (n, 3) each, come too low somewhere."""
    low = [k for k, line in enumerate(lines) if line[:, 2].min() < body.top_mm - _ROUNDING_MM]
    found = [False] * len(lines)
    if not low:
        return found
    lengths = [_lengths(lines[k]) for k in low]
    coarse = [_spread(lines[k], n, _COARSE_MM) for k, n in zip(low, lengths, strict=True)]
    near = _below([_at(lines[k], n, c) for k, n, c in zip(low, lengths, coarse, strict=True)], body.wide)
    close = [
        (k, _at(lines[k], n, _around(c[b], float(n[-1]))))
        for k, n, c, b in zip(low, lengths, coarse, near, strict=True)
        if b.any()
    ]
    for (k, _), below in zip(close, _below([fine for _, fine in close], body.exact), strict=True):
        found[k] = bool(below.any())
    return found


def _below(lines: Sequence[FloatArray], touch: Touch) -> Iterator[NDArray[np.bool_]]:
    """Which points of each line are lower than the tool may be; all are dropped at once."""
    if not lines:
        return iter(())
    points = np.concatenate(lines)
    below = points[:, 2] < touch(points[:, :2]) - _ROUNDING_MM
    return iter(np.split(below, np.cumsum([len(line) for line in lines[:-1]])))


def _lengths(line: FloatArray) -> FloatArray:
    return np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))))


def _spread(line: FloatArray, lengths: FloatArray, step_mm: float) -> FloatArray:
    """Lengths along a polyline, its corners included, no farther apart than a step; of upright pieces only the ends."""
    upright = np.all(line[1:, :2] == line[:-1, :2], axis=1)
    counts = np.where(upright, 1, np.ceil(np.diff(lengths) / step_mm)).astype(np.int64)
    pieces = [
        np.linspace(a, b, n + 1)[1:] for (a, b), n in zip(pairwise(lengths.tolist()), counts.tolist(), strict=True)
    ]
    return np.concatenate([lengths[:1], *pieces])


def _around(at: FloatArray, length_mm: float) -> FloatArray:
    """Finely spaced lengths around some."""
    count = math.ceil(0.5 * _COARSE_MM / _FINE_MM)
    fine = at[:, None] + 0.5 * _COARSE_MM * np.arange(-count, count + 1) / count
    return np.unique(np.clip(fine.ravel(), 0.0, length_mm))


def _at(line: FloatArray, lengths: FloatArray, at: FloatArray) -> FloatArray:
    return np.column_stack([np.interp(at, lengths, line[:, axis]) for axis in range(3)])


def _raised(run: _Run, line: FloatArray, bodies: Sequence[Obstacle], options: ClearOptions) -> Iterator[Move]:
    """The moves of a run that touches, higher."""
    if run.kind is MoveKind.LINK:
        points, needed = line.copy(), _highest(line, [body.exact for body in bodies], _FINE_MM)
        points[:, 2] = np.maximum(line[:, 2], min(needed + _LIFT_MM, options.safe_z_mm))
        whole = np.vstack((line[:1], points, line[-1:]))
        keep = np.concatenate(([True], np.any(np.diff(whole, axis=0) != 0.0, axis=1)))
        yield Move(kind=run.kind, points_mm=whole[keep], feed_mm_min=run.moves[0].feed_mm_min)
        return
    start, end = run.moves[0].start_mm, line[-1]
    begin_z = max(float(end[2]), min(_highest(line[-1:], [body.exact for body in bodies], 1.0), options.safe_z_mm))
    z = max(float(line[:, 2].max()), begin_z)
    level = line.copy()
    level[:, 2] = z
    if any(_touches([level], body)[0] for body in bodies):
        needed = _highest(line, [body.wide for body in bodies], _COARSE_MM)
        z = max(z, min(needed + options.clearance_mm, options.safe_z_mm))
    level[:, 2] = z
    begin = np.array([end[0], end[1], begin_z])
    yield from rapids(np.vstack((start, level, begin)))
    if begin_z > end[2]:
        yield Move(kind=MoveKind.PLUNGE, points_mm=np.array([begin, end]), feed_mm_min=options.feed_mm_min)


def _highest(line: FloatArray, touches: Sequence[Touch], step_mm: float) -> float:
    """Lowest tip that touches nothing anywhere on a polyline."""
    lengths = _lengths(line)
    xy = np.ascontiguousarray(_at(line, lengths, _spread(line, lengths, step_mm))[:, :2])
    return max(float(touch(xy).max()) for touch in touches)
