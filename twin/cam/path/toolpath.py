"""Tool paths: motion of the tool's tip, move by move, in part coordinates.

A `Move` is a run of straight pieces or one arc, of one kind and one feed. A `ToolPath` is a chain of moves, each of
which begins where the last one ends. Points are the tool's TIP: a ball's centre is its radius higher.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from gcode.events import PLANE_AXES
from twin.arrays import FloatArray, frozen
from twin.motion.path import Arc, path_length_mm
from twin.motion.path import Move as ToolMotion
from twin.tools.shape import ToolShape

#: How far apart the end of a move and the start of the next may be, mm.
GAP_MM = 1e-7


class MoveKind(StrEnum):
    """Purpose of a move; it determines feed and colour."""

    RAPID = "rapid"
    LINK = "link"
    LEAD = "lead"
    PLUNGE = "plunge"
    RAMP = "ramp"
    HELIX = "helix"
    CUT = "cut"
    RETRACT = "retract"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Move:
    """A run of straight pieces, or one arc.

    Attributes:
        kind: what it is for.
        points_mm: tool tip, shape (n >= 2, 3), start and end included. With an arc exactly start and end.
        feed_mm_min: speed along the path; 0 for a rapid.
        arc: centre, plane and signed sweep where the move is an arc or helix.

    Raises:
        ValueError: wrong shape, values that are not finite, a feed that does not fit the kind, an arc of more than two
            points.
    """

    kind: MoveKind
    points_mm: FloatArray
    feed_mm_min: float = 0.0
    arc: Arc | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "kind", MoveKind(self.kind))
        object.__setattr__(self, "points_mm", frozen(self.points_mm, "points_mm", (None, 3)))
        if len(self.points_mm) < 2 or (self.arc is not None and len(self.points_mm) != 2):
            raise ValueError(
                f"points_mm must have shape (2, 3) for an arc and (n >= 2, 3) else: {self.points_mm.shape}"
            )
        if self.rapid != (self.feed_mm_min == 0.0) or not (math.isfinite(self.feed_mm_min) and self.feed_mm_min >= 0.0):
            raise ValueError(
                f"feed_mm_min must be 0 for a rapid and above 0 else, got {self.feed_mm_min} ({self.kind})"
            )

    @property
    def rapid(self) -> bool:
        """Whether it goes at the machine's rapid rate."""
        return self.kind is MoveKind.RAPID

    @property
    def start_mm(self) -> FloatArray:
        """First point, shape (3,)."""
        start: FloatArray = self.points_mm[0]
        return start

    @property
    def end_mm(self) -> FloatArray:
        """Last point, shape (3,)."""
        end: FloatArray = self.points_mm[-1]
        return end

    @property
    def length_mm(self) -> float:
        """Length along the path."""
        if self.arc is not None:
            return path_length_mm(self.start_mm, self.end_mm, self.arc)
        return float(np.linalg.norm(np.diff(self.points_mm, axis=0), axis=1).sum())

    def chords_mm(self, chord_mm: float = 0.01) -> FloatArray:
        """The move as a polyline whose chords lie off an arc by at most this much, shape (n, 3)."""
        if self.arc is None:
            return self.points_mm
        motion = ToolMotion(
            start_mm=self.start_mm,
            end_mm=self.end_mm,
            arc=self.arc,
            duration_s=0.0,
            feed_mm_min=0.0,
            spindle_rpm=0.0,
            tool=0,
            rapid=False,
            nc_line=0,
        )
        return motion.corners_mm(math.inf, chord_mm)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ToolPath:
    """One operation's moves from its first point to its last.

    Attributes:
        moves: each begins where the last one ends.
        tool: shape of the cutting part.
        name: human-readable, for comments.
        notes: further lines for the program's header, e.g. the parameters it was made with.

    Raises:
        ValueError: a gap between two moves.
    """

    moves: tuple[Move, ...]
    tool: ToolShape
    name: str = ""
    notes: tuple[str, ...] = ()
    _ends: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "moves", tuple(self.moves))
        ends = np.array([(m.points_mm[0], m.points_mm[-1]) for m in self.moves]).reshape(-1, 2, 3)
        gaps = np.abs(ends[1:, 0] - ends[:-1, 1]).max(axis=1, initial=0.0)
        if len(gaps) and gaps.max() > GAP_MM:
            k = int(np.argmax(gaps))
            raise ValueError(f"moves[{k + 1}] begins {gaps[k]:.3g} mm from where moves[{k}] ends, at {ends[k, 1]}")
        object.__setattr__(self, "_ends", ends)

    @property
    def empty(self) -> bool:
        """Whether nothing is cut."""
        return not any(m.kind is MoveKind.CUT for m in self.moves)

    @property
    def points(self) -> int:
        """Number of points of all moves, ends of neighbouring moves counted once."""
        return sum(len(m.points_mm) - 1 for m in self.moves) + bool(self.moves)

    def of_kind(self, *kinds: MoveKind) -> Iterator[Move]:
        """The moves of some kinds."""
        return (m for m in self.moves if m.kind in kinds)

    def lengths_mm(self) -> Mapping[MoveKind, float]:
        """Length of the moves of each kind that there is."""
        lengths: dict[MoveKind, float] = {}
        for move in self.moves:
            lengths[move.kind] = lengths.get(move.kind, 0.0) + move.length_mm
        return lengths

    def duration_s(self, rapid_mm_min: float) -> float:
        """Time at the programmed feeds, without acceleration."""
        return math.fsum(m.length_mm / (rapid_mm_min if m.rapid else m.feed_mm_min) * 60.0 for m in self.moves)

    def box_mm(self, *kinds: MoveKind) -> tuple[FloatArray, FloatArray]:
        """Lower and upper corner of the moves of some kinds, of all if none is named, arcs included.

        Raises:
            ValueError: there are none.
        """
        points = [m.chords_mm() for m in self.moves if not kinds or m.kind in kinds]
        if not points:
            raise ValueError("no moves of these kinds; expected one at least")
        return np.min([p.min(axis=0) for p in points], axis=0), np.max([p.max(axis=0) for p in points], axis=0)

    def then(self, other: ToolPath, safe_z_mm: float) -> ToolPath:
        """This path and another of the same tool, joined by rapids at a safe height."""
        if not self.moves or not other.moves:
            return self if self.moves else other
        joint = rapid_over(self.moves[-1].end_mm, other.moves[0].start_mm, safe_z_mm)
        name = " + ".join(n for n in (self.name, other.name) if n)
        return ToolPath(
            moves=(*self.moves, *joint, *other.moves), tool=self.tool, name=name, notes=self.notes + other.notes
        )

    @classmethod
    def joined(cls, paths: Iterable[Self | ToolPath], safe_z_mm: float) -> ToolPath:
        """Several paths of one tool, one after the other.

        Raises:
            ValueError: there are none.
        """
        first, *rest = paths
        whole: ToolPath = first
        for path in rest:
            whole = whole.then(path, safe_z_mm)
        return whole


def rapid_over(start_mm: ArrayLike, end_mm: ArrayLike, safe_z_mm: float) -> tuple[Move, ...]:
    """Up, across and down at the rapid rate; pieces of no length are omitted."""
    start, end = np.asarray(start_mm, dtype=np.float64), np.asarray(end_mm, dtype=np.float64)
    corners = [start, np.array([*start[:2], safe_z_mm]), np.array([*end[:2], safe_z_mm]), end]
    return rapids(np.array(corners))


def rapids(points_mm: FloatArray) -> tuple[Move, ...]:
    """A rapid move for each straight piece that has a length, so that each becomes a block of its own."""
    return tuple(
        Move(kind=MoveKind.RAPID, points_mm=points_mm[i : i + 2])
        for i in range(len(points_mm) - 1)
        if np.any(points_mm[i] != points_mm[i + 1])
    )


def arc_sweep_rad(start_mm: FloatArray, end_mm: FloatArray, centre_mm: FloatArray, plane: int, turns: int) -> float:
    """Signed sweep of an arc given by its count of turns (`gcode.events.ArcMotion`)."""
    i, j, _ = PLANE_AXES[plane]
    a = math.atan2(start_mm[j] - centre_mm[j], start_mm[i] - centre_mm[i])
    b = math.atan2(end_mm[j] - centre_mm[j], end_mm[i] - centre_mm[i])
    sign = 1.0 if turns > 0 else -1.0
    one = (sign * (b - a)) % math.tau or math.tau
    return sign * (one + math.tau * (abs(turns) - 1))
