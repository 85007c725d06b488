"""Fewer points, and arcs for what is round: G2 and G3 in the planes G17, G18, G19, within a tolerance.

The pieces run through points of the path, so nothing adds up. With ``gouge_mm`` smaller than ``tolerance_mm`` the
result lies nearer to the path on the side of the material, where it would cut too deep, than on the other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np

from gcode.events import PLANE_AXES
from twin.arrays import FloatArray
from twin.cam.path import arc_fit_kernels as kernels
from twin.cam.path.toolpath import Move, MoveKind, ToolPath
from twin.motion.path import Arc

Side: TypeAlias = Literal["below", "left", "right", "both"]

#: Kinds of moves that are fitted; others are straight, or arcs already.
FITTED = frozenset((MoveKind.CUT, MoveKind.LINK, MoveKind.LEAD, MoveKind.RAMP))


@dataclass(frozen=True, slots=True, kw_only=True)
class FitOptions:
    """How points are thinned and arcs fitted.

    Attributes:
        tolerance_mm: how far the result may lie from the path.
        gouge_mm: how far it may lie from it towards the material, None for ``tolerance_mm``.
        material: where that is: ``below`` in planes along z, ``left`` or ``right`` of level paths, ``both`` anywhere.
        arcs: whether arcs are fitted, or points thinned only.
        least_radius_mm, most_radius_mm: radii that arcs may have.
    """

    tolerance_mm: float
    gouge_mm: float | None = None
    material: Side = "both"
    arcs: bool = True
    least_radius_mm: float = 0.01
    most_radius_mm: float = 10_000.0

    def __post_init__(self) -> None:
        if not self.tolerance_mm > 0.0:
            raise ValueError(f"tolerance_mm must be above 0, got {self.tolerance_mm}")
        if self.gouge_mm is not None and not 0.0 <= self.gouge_mm <= self.tolerance_mm:
            raise ValueError(f"gouge_mm must be from 0 to tolerance_mm = {self.tolerance_mm}, got {self.gouge_mm}")


def fit_path(path: ToolPath, options: FitOptions) -> ToolPath:
    """The path with its cuts, links, leads and ramps as few lines and arcs as the tolerance allows."""
    moves = (m for move in path.moves for m in fit_move(move, options))
    return replace_moves(path, tuple(moves))


def replace_moves(path: ToolPath, moves: tuple[Move, ...]) -> ToolPath:
    """The same operation with other moves."""
    return ToolPath(moves=moves, tool=path.tool, name=path.name, notes=path.notes)


def fit_move(move: Move, options: FitOptions) -> Iterator[Move]:
    """One move as lines and arcs, of the same kind and feed.

    A move in a plane of two axes gets arcs and the one-sided bound; any other only loses points, within the smaller of
    both tolerances.
    """
    if move.arc is not None or move.kind not in FITTED or len(move.points_mm) < 3:
        yield move
        return
    points = _distinct(move.points_mm)
    plane = _plane(points)
    if plane is None or len(points) < 3:
        yield replace_points(move, _thinned(points, options))
        return
    yield from _planar(move, points, plane, options)


def replace_points(move: Move, points_mm: FloatArray, arc: Arc | None = None) -> Move:
    """A move of the same kind and feed through other points."""
    return replace(move, points_mm=points_mm, arc=arc)


def _planar(move: Move, points: FloatArray, plane: int, options: FitOptions) -> Iterator[Move]:
    i, j, k = PLANE_AXES[plane]
    flat = np.ascontiguousarray(points[:, (i, j)])
    left, right = _bounds(points, plane, options)
    ends, fitted = np.empty(len(flat) - 1, dtype=np.int64), np.zeros((len(flat) - 1, 4))
    limits = kernels.Limits(left, right, float(options.least_radius_mm), float(options.most_radius_mm))
    count = kernels.fit_plane(flat, limits, options.arcs, ends, fitted)
    first, run = 0, [0]
    for end, (x, y, radius, sweep) in zip(ends[:count].tolist(), fitted[:count].tolist(), strict=True):
        if radius == 0.0:
            run.append(end)
        else:
            if len(run) > 1:
                yield replace_points(move, points[run])
            centre = np.empty(3)
            centre[i], centre[j], centre[k] = x, y, points[first, k]
            yield replace_points(move, points[[first, end]], Arc(centre_mm=centre, plane=plane, sweep_rad=sweep))
            run = [end]
        first = end
    if len(run) > 1:
        yield replace_points(move, points[run])


def _thinned(points: FloatArray, options: FitOptions) -> FloatArray:
    if len(points) < 3:
        return points
    ends = np.empty(len(points) - 1, dtype=np.int64)
    most = options.tolerance_mm if options.gouge_mm is None else options.gouge_mm
    count = kernels.thin_space(np.ascontiguousarray(points), most, ends)
    kept: FloatArray = points[np.concatenate(([0], ends[:count]))]
    return kept


def _distinct(points: FloatArray) -> FloatArray:
    """Points without repetitions; two at least."""
    keep = np.concatenate(([True], np.any(np.diff(points, axis=0) != 0.0, axis=1)))
    kept: FloatArray = points[keep] if keep.sum() > 1 else points[[0, -1]]
    return kept


def _plane(points: FloatArray) -> int | None:
    """The plane that points lie in: the one they are level in first; None where they need all three axes."""
    for plane in (17, 18, 19):
        axis = PLANE_AXES[plane][2]
        if np.all(points[:, axis] == points[0, axis]):
            return plane
    return None


def _bounds(points: FloatArray, plane: int, options: FitOptions) -> tuple[float, float]:
    """How far pieces may lie to the left and to the right of the path, seen in the plane's axes."""
    most = float(options.tolerance_mm)
    least = most if options.gouge_mm is None else float(options.gouge_mm)
    side = options.material
    if side == "below" and plane != 17:
        # axes are (z, x) and (y, z): below is to the left of a path towards +x, to the right of one towards +y
        axis = 0 if plane == 18 else 1
        forward = points[-1, axis] >= points[0, axis]
        side = "left" if forward == (plane == 18) else "right"
    return {"left": (least, most), "right": (most, least)}.get(side, (least, least))
