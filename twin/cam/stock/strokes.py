"""Motions of one tool as arrays: straight ones, and level arcs that kernels take as they are."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from twin.arrays import FloatArray, frozen
from twin.cam.path.toolpath import Move as PathMove
from twin.cam.path.toolpath import ToolPath
from twin.motion.path import Arc, Move

#: Arcs that are not level become chords that lie off them by at most this.
CHORD_MM = 1e-4
#: Largest difference of an arc's two radii that still counts as one circle, mm.
_EVEN_MM = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Strokes:
    """Motions of one tool's tip; the result does not depend on their order.

    Attributes:
        starts_mm, ends_mm: shape (k, 3), straight motions.
        arcs: shape (a, 8), level arcs: centre x, y, tip z, radius, start angle, signed sweep, end x, y.
    """

    starts_mm: FloatArray
    ends_mm: FloatArray
    arcs: FloatArray

    @classmethod
    def through(cls, points_mm: ArrayLike) -> Strokes:
        """Straight motions through points, shape (n, 3); a single point is a motion without length."""
        points = frozen(points_mm, "points_mm", (None, 3))
        if len(points) == 1:
            return cls(points, points, np.empty((0, 8)))
        return cls(points[:-1], points[1:], np.empty((0, 8)))

    @classmethod
    def of_moves(cls, moves: Iterable[Move], chord_mm: float = CHORD_MM) -> Strokes:
        """The motions of a program's moves, whatever their tool; a dwell is a point."""
        return cls._of((m.start_mm, m.end_mm, m.arc, partial(m.corners_mm, math.inf, chord_mm)) for m in moves)

    @classmethod
    def of_path(cls, path: ToolPath, chord_mm: float = CHORD_MM) -> Strokes:
        """The motions of a tool path, rapid ones too."""
        return cls.of_tip(path.moves, chord_mm)

    @classmethod
    def of_tip(cls, moves: Iterable[PathMove], chord_mm: float = CHORD_MM) -> Strokes:
        """The motions of moves of a tool path, rapid ones too."""
        return cls._of((m.start_mm, m.end_mm, m.arc, partial(m.chords_mm, chord_mm)) for m in moves)

    @classmethod
    def _of(cls, motions: Iterable[tuple[FloatArray, FloatArray, Arc | None, Callable[[], FloatArray]]]) -> Strokes:
        lines: list[tuple[FloatArray, FloatArray]] = []
        arcs: list[tuple[float, ...]] = []
        for start, end, arc, corners in motions:
            level = None if arc is None else _level_arc(start, end, arc)
            if level is None:
                points = corners()
                lines.append((points[:-1], points[1:]))
            else:
                arcs.append(level)
        none = np.empty((0, 3))
        return cls(
            np.concatenate([none, *(a for a, _ in lines)]),
            np.concatenate([none, *(b for _, b in lines)]),
            np.array(arcs, dtype=np.float64).reshape(-1, 8),
        )

    def from_lowest(self) -> Strokes:
        """The same motions, each array in the order of its motions' lowest tips."""
        lines = np.argsort(np.minimum(self.starts_mm[:, 2], self.ends_mm[:, 2]), kind="stable")
        return Strokes(
            self.starts_mm[lines], self.ends_mm[lines], self.arcs[np.argsort(self.arcs[:, 2], kind="stable")]
        )


def _level_arc(start: FloatArray, end: FloatArray, arc: Arc) -> tuple[float, ...] | None:
    """A level arc of even radius as kernels take it; None for helices, upright arcs and spirals."""
    if arc.plane != 17 or start[2] != end[2]:
        return None
    (x, y, _), (start_x, start_y, z), (end_x, end_y, _) = arc.centre_mm.tolist(), start.tolist(), end.tolist()
    radius = float(np.hypot(start_x - x, start_y - y))
    if abs(float(np.hypot(end_x - x, end_y - y)) - radius) > _EVEN_MM * max(1.0, radius):
        return None
    begin = math.atan2(start_y - y, start_x - x)
    return x, y, z, radius, begin, arc.sweep_rad, end_x, end_y
