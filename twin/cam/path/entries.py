"""How a pass is entered and left: straight down, ramps, helices, leads."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from twin.arrays import FloatArray
from twin.cam.path.toolpath import Move, MoveKind
from twin.motion.path import Arc

#: Whether the tool may stand at all of some tips, shape (n, 3).
Free: TypeAlias = Callable[[FloatArray], bool]
#: Angle between the points of leads and helices, rad.
_STEP = math.radians(6.0)
#: A helix that is not free is tried with half the radius, at most this many times.
_HALVINGS = 3
#: Ramps zigzag over this length of a pass, in multiples of the helix radius.
_RAMP_REACH = 4.0


@dataclass(frozen=True, slots=True, kw_only=True)
class EntryOptions:
    """See `twin.cam.path.linking.LinkOptions`."""

    entry: Literal["plunge", "ramp", "helix"]
    ramp_deg: float
    helix_mm: float
    lead_mm: float
    plunge_mm_min: float
    lead_mm_min: float


def entry_moves(
    points_mm: FloatArray, begin_z_mm: float, top_mm: float | None, options: EntryOptions, free: Free | None
) -> tuple[list[Move], FloatArray]:
    """Entry into a pass.

    Args:
        points_mm: the pass.
        begin_z_mm: height where rapids end.
        top_mm: height of the material there, None where there is none: then straight down.

    Returns:
        Moves from ``begin_z_mm`` to the pass, and the pass's points, which begin elsewhere on a closed pass where the
        ramp ends elsewhere.
    """
    start = points_mm[0]
    if begin_z_mm <= start[2]:
        return [], points_mm
    if top_mm is None or top_mm <= start[2] or options.entry == "plunge":
        return [_plunge(start, begin_z_mm, float(start[2]), options)], points_mm
    top = min(top_mm, begin_z_mm)
    helix = _helix(start, points_mm[1] - start, top, options, free) if options.entry == "helix" else None
    moves, points = ([helix], points_mm) if helix is not None else _ramp(points_mm, top, options)
    if begin_z_mm > top:
        moves.insert(0, _plunge(moves[0].start_mm, begin_z_mm, top, options))
    return moves, points


def _plunge(over: FloatArray, begin_z_mm: float, end_z_mm: float, options: EntryOptions) -> Move:
    line = np.array([[over[0], over[1], begin_z_mm], [over[0], over[1], end_z_mm]])
    return _moving(MoveKind.PLUNGE, line, options)


def _ramp(points: FloatArray, begin_z_mm: float, options: EntryOptions) -> tuple[list[Move], FloatArray]:
    """Down along the pass: round and round a closed one, in zigzag over the beginning of an open one."""
    depth = begin_z_mm - float(points[0, 2])
    lengths = _lengths(points)
    length = depth / math.tan(math.radians(options.ramp_deg))
    if len(points) > 2 and np.all(points[0] == points[-1]):
        at = np.unique(
            np.concatenate(
                ([0.0, length], *(lengths + k * lengths[-1] for k in range(math.ceil(length / lengths[-1]))))
            )
        )
        at = at[at <= length]
        line = _at(points, lengths, at % lengths[-1])
        line[:, 2] += depth * (1.0 - at / length)
        return [_moving(MoveKind.RAMP, line, options)], _from(points, lengths, length % lengths[-1])
    reach = min(float(lengths[-1]), _RAMP_REACH * options.helix_mm)
    legs = 2 * max(1, math.ceil(0.5 * length / reach))
    reach = min(reach, length / legs)
    there = np.unique(np.concatenate(([0.0, reach], lengths[lengths < reach])))
    line = np.concatenate([_at(points, lengths, there if k % 2 == 0 else there[::-1])[k > 0 :] for k in range(legs)])
    gone = np.concatenate([(there if k % 2 == 0 else reach - there[::-1])[k > 0 :] + k * reach for k in range(legs)])
    line[:, 2] += depth * (1.0 - gone / gone[-1])
    line[-1] = points[0]
    return [_moving(MoveKind.RAMP, line, options)], points


def _moving(kind: MoveKind, line: FloatArray, options: EntryOptions) -> Move:
    return Move(kind=kind, points_mm=line, feed_mm_min=options.plunge_mm_min)


def _helix(
    start: FloatArray, along: FloatArray, begin_z_mm: float, options: EntryOptions, free: Free | None
) -> Move | None:
    """A helix that ends at the pass's start along its direction, on the side that is free; None where neither is."""
    length = math.hypot(along[0], along[1])
    if length == 0.0:
        return None
    depth = begin_z_mm - float(start[2])
    ux, uy = float(along[0]) / length, float(along[1]) / length
    for halving in range(_HALVINGS + 1):
        radius = options.helix_mm * 0.5**halving
        for side in (1.0, -1.0):
            centre = start[:2] + side * radius * np.array([-uy, ux])
            turn = depth / (radius * math.tan(math.radians(options.ramp_deg)))
            angle = math.atan2(start[1] - centre[1], start[0] - centre[0]) - side * turn
            begin = np.array([*(centre + radius * np.array([math.cos(angle), math.sin(angle)])), begin_z_mm])
            # what is free at the bottom is free above it
            if free is None or free(_circle(centre, radius, float(start[2]))):
                return Move(
                    kind=MoveKind.HELIX,
                    points_mm=np.array([begin, start]),
                    feed_mm_min=options.plunge_mm_min,
                    arc=Arc(centre_mm=np.array([*centre, begin_z_mm]), plane=17, sweep_rad=side * turn),
                )
    return None


def _circle(centre: FloatArray, radius: float, z: float) -> FloatArray:
    """Points of a level circle, shape (n, 3)."""
    angle = np.arange(0.0, math.tau, _STEP)
    xy = centre + radius * np.column_stack((np.cos(angle), np.sin(angle)))
    return np.column_stack((xy, np.full(len(angle), z)))


def lead_in(points_mm: FloatArray, options: EntryOptions, free: Free | None) -> Move | None:
    """A quarter circle onto a pass's start, tangent to it, in the first position of these that is free.

    Level passes: to the left, to the right; all: from above, in the vertical plane of the pass's first piece.
    """
    line = _lead(points_mm, options, free)
    return None if line is None else Move(kind=MoveKind.LEAD, points_mm=line, feed_mm_min=options.lead_mm_min)


def lead_out(points_mm: FloatArray, options: EntryOptions, free: Free | None) -> Move | None:
    """The same as `lead_in` off a pass's end."""
    line = _lead(points_mm[::-1], options, free)
    return None if line is None else Move(kind=MoveKind.LEAD, points_mm=line[::-1], feed_mm_min=options.lead_mm_min)


def _lead(points: FloatArray, options: EntryOptions, free: Free | None) -> FloatArray | None:
    along = points[1] - points[0]
    flat = math.hypot(along[0], along[1])
    if options.lead_mm <= 0.0 or flat == 0.0:
        return None
    u = along / np.linalg.norm(along)
    level = math.hypot(u[0], u[1])
    up = np.array([-u[0] * u[2] / level, -u[1] * u[2] / level, level])
    across = np.array([-u[1], u[0], 0.0]) / level
    sides = [across, -across, up] if along[2] == 0.0 and np.all(points[:, 2] == points[0, 2]) else [up]
    angle = np.linspace(0.5 * math.pi, 0.0, max(4, math.ceil(0.5 * math.pi / _STEP)) + 1)[:, None]
    for n in sides:
        line: FloatArray = points[0] + options.lead_mm * (n * (1.0 - np.cos(angle)) - u * np.sin(angle))
        line[-1] = points[0]
        if free is None or free(line):
            return line
    return None


def _lengths(points: FloatArray) -> FloatArray:
    """Length along a polyline to each point, shape (n,)."""
    return np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))


def _at(points: FloatArray, lengths: FloatArray, at: FloatArray) -> FloatArray:
    """Points at lengths along a polyline, shape (n, 3)."""
    return np.column_stack([np.interp(at, lengths, points[:, a]) for a in range(3)])


def _from(points: FloatArray, lengths: FloatArray, at: float) -> FloatArray:
    """A closed polyline that begins, and ends, elsewhere on it."""
    k = int(np.searchsorted(lengths, at, side="right"))
    begin = _at(points, lengths, np.array([at]))
    line = np.concatenate((begin, points[k:], points[1:k], begin))
    keep = np.concatenate(([True], np.any(np.diff(line, axis=0) != 0.0, axis=1)))
    return line[keep]
