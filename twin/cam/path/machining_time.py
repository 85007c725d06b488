"""Machining time of a tool path: feeds, rapids, limited acceleration, corner speeds with look-ahead.

Every straight piece or arc is a block with a trapezoid of speed. Between two blocks the speed is what a corner rounded
within ``corner_tolerance_mm`` allows; rapids begin and end at rest, as controls check their position there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gcode.events import PLANE_AXES
from twin.arrays import FloatArray
from twin.cam.path import machining_time_kernels as kernels
from twin.cam.path.toolpath import Move, MoveKind, ToolPath
from twin.motion.path import Arc


@dataclass(frozen=True, slots=True, kw_only=True)
class Dynamics:
    """Limits of the machine's axes.

    Attributes:
        rapid_mm_min: speed of rapids along the path.
        acceleration_mm_s2: along the path, of cuts and links; also towards the centre of arcs.
        rapid_mm_s2: of rapids.
        corner_tolerance_mm: how far the path may be rounded off at a corner.

    Raises:
        ValueError: a value that is not above 0.
    """

    rapid_mm_min: float = 30_000.0
    acceleration_mm_s2: float = 3_000.0
    rapid_mm_s2: float = 5_000.0
    corner_tolerance_mm: float = 0.01

    def __post_init__(self) -> None:
        for name in ("rapid_mm_min", "acceleration_mm_s2", "rapid_mm_s2", "corner_tolerance_mm"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} must be above 0, got {getattr(self, name)}")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathTime:
    """Time of a tool path.

    Attributes:
        move_s: of each move, shape (n,).
        kind_s: of all moves of a kind.
    """

    move_s: FloatArray
    kind_s: Mapping[MoveKind, float]

    @property
    def total_s(self) -> float:
        """Of all moves."""
        return math.fsum(self.move_s.tolist())

    @property
    def cutting_s(self) -> float:
        """Of cuts alone."""
        return self.kind_s.get(MoveKind.CUT, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Blocks:
    """Straight pieces and arcs of a chain.

    Attributes:
        length_mm, radius_mm, speed_mm_s: shape (n,); radius inf for straight pieces, speed inf for rapids.
        into, out: unit directions at start and end, shape (n, 3).
        move: number of the move that each block belongs to, shape (n,).
    """

    length_mm: FloatArray
    radius_mm: FloatArray
    speed_mm_s: FloatArray
    into: FloatArray
    out: FloatArray
    move: NDArray[np.int64]


def machining_time(path: ToolPath, dynamics: Dynamics) -> PathTime:
    """Time of every move of a path that begins and ends at rest."""
    if not path.moves:
        return PathTime(move_s=np.empty(0), kind_s={})
    blocks = path_blocks(path.moves)
    times = block_times_s(blocks, dynamics)
    per_move = np.bincount(blocks.move, weights=times, minlength=len(path.moves)).astype(np.float64)
    kinds: dict[MoveKind, float] = {}
    for move, t in zip(path.moves, per_move.tolist(), strict=True):
        kinds[move.kind] = kinds.get(move.kind, 0.0) + t
    return PathTime(move_s=per_move, kind_s=kinds)


def block_times_s(blocks: Blocks, dynamics: Dynamics) -> FloatArray:
    """Time of each block of a chain that begins and ends at rest, shape (n,)."""
    rapid = np.isinf(blocks.speed_mm_s)
    acceleration = np.where(rapid, dynamics.rapid_mm_s2, dynamics.acceleration_mm_s2)
    # an arc's speed is bounded by the acceleration towards its centre
    speed = np.where(rapid, dynamics.rapid_mm_min / 60.0, blocks.speed_mm_s)
    speed = np.minimum(speed, np.sqrt(acceleration * blocks.radius_mm))
    corner, times = np.empty(len(speed) + 1), np.empty(len(speed))
    chain = kernels.Chain(blocks.length_mm, blocks.into, blocks.out, blocks.radius_mm, speed, acceleration, rapid)
    kernels.corner_speeds(chain, float(dynamics.corner_tolerance_mm), corner)
    kernels.block_times(chain, corner, times)
    return times


def path_blocks(moves: tuple[Move, ...]) -> Blocks:
    """The blocks of moves; pieces without length are omitted."""
    parts = list(_parts(moves))
    length = np.concatenate([p[0] for p in parts])
    keep = length > 0.0
    columns = [np.concatenate([p[i] for p in parts])[keep] for i in range(1, 6)]
    return Blocks(
        length_mm=length[keep],
        radius_mm=columns[0],
        speed_mm_s=columns[1],
        into=np.ascontiguousarray(columns[2]),
        out=np.ascontiguousarray(columns[3]),
        move=columns[4].astype(np.int64),
    )


def _parts(moves: tuple[Move, ...]) -> Iterator[tuple[FloatArray, ...]]:
    """Lengths, radii, speeds, directions in and out, and move numbers, a move at a time."""
    for number, move in enumerate(moves):
        n = 1 if move.arc is not None else len(move.points_mm) - 1
        speed = np.full(n, math.inf if move.rapid else move.feed_mm_min / 60.0)
        which = np.full(n, float(number))
        if move.arc is not None:
            radius, into, out = _arc_ends(move, move.arc)
            yield np.array([move.length_mm]), np.array([radius]), speed, into[None, :], out[None, :], which
            continue
        length, direction = np.empty(n), np.empty((n, 3))
        kernels.directions(move.points_mm, length, direction)
        yield length, np.full(n, math.inf), speed, direction, direction, which


def _arc_ends(move: Move, arc: Arc) -> tuple[float, FloatArray, FloatArray]:
    """Radius of curvature of an arc or helix, and its unit tangents at start and end."""
    i, j, k = PLANE_AXES[arc.plane]
    radius = math.hypot(move.start_mm[i] - arc.centre_mm[i], move.start_mm[j] - arc.centre_mm[j])
    rise = float(move.end_mm[k] - move.start_mm[k]) / max(abs(arc.sweep_rad), 1e-300)
    sign = math.copysign(1.0, arc.sweep_rad)
    tangents = []
    for point in (move.start_mm, move.end_mm):
        x, y = point[i] - arc.centre_mm[i], point[j] - arc.centre_mm[j]
        tangent = np.zeros(3)
        tangent[i], tangent[j], tangent[k] = -sign * y, sign * x, rise
        tangents.append(tangent / max(float(np.linalg.norm(tangent)), 1e-300))
    # a helix r, rise c per rad has curvature r / (r^2 + c^2)
    return (radius**2 + rise**2) / max(radius, 1e-300), tangents[0], tangents[1]
