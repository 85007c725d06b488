"""Check of a finished path on the part's triangles: where it cuts deeper than the allowance permits, and how deep."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cam.path.toolpath import ToolPath
from twin.cam.stock.rest import grown
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import Surface
from twin.tools.shape import ToolShape

#: Part of the tolerance that a gouge between two points may be deeper than at them.
_MISSED = 0.1
#: Chord error of arcs, as a part of the tolerance.
_CHORD = 0.05
#: The depth is found to this part of it.
_DEPTH = 0.02
#: Most points that are dropped at once.
_TOGETHER = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Gouge:
    """The deepest gouge of a path that is deeper than its tolerance.

    Attributes:
        depth_mm: normal to the surface, allowance included: how far the tool is closer to the part than the allowance.
        point_mm: the tool tip there, shape (3,).
    """

    depth_mm: float
    point_mm: FloatArray


def deepest_gouge(path: ToolPath, surface: Surface, allowance_mm: float, tolerance_mm: float) -> Gouge | None:
    """The deepest gouge of a path; None where none is deeper than the tolerance.

    The tool offset inwards by a depth touches the part where the gouge is at least as deep. All points are checked with
    the tolerance as the depth; those that touch, with larger depths.

    Args:
        path: rapid moves are not checked.
        surface: the part.
        allowance_mm: to be left on it.
        tolerance_mm: permitted depth.
    """
    tool = path.tool
    bend = tool.corner_radius_mm or tool.nominal_radius_mm
    step = math.sqrt(8.0 * bend * _MISSED * tolerance_mm)
    found = [
        points[_below(points, surface, tool, allowance_mm - tolerance_mm)]
        for points in _points(path, step, _CHORD * tolerance_mm)
    ]
    points = np.concatenate([np.empty((0, 3)), *found])
    return _deepest(points, surface, tool, allowance_mm, tolerance_mm) if len(points) else None


def _deepest(points: FloatArray, surface: Surface, tool: ToolShape, allowance_mm: float, tolerance_mm: float) -> Gouge:
    """The deepest of gouges deeper than a tolerance, by doubling the depth and then by bisection."""
    least, most = tolerance_mm, 2.0 * tolerance_mm
    while (deeper := _below(points, surface, tool, allowance_mm - most)).any() and most < tool.nominal_radius_mm:
        least, most, points = most, 2.0 * most, points[deeper]
    while most - least > _DEPTH * least:
        middle = 0.5 * (least + most)
        deeper = _below(points, surface, tool, allowance_mm - middle)
        if deeper.any():
            least, points = middle, points[deeper]
        else:
            most = middle
    return Gouge(depth_mm=least, point_mm=points[0])


def _below(points: FloatArray, surface: Surface, tool: ToolShape, left_mm: float) -> NDArray[np.bool_]:
    """Which tips, shape (n, 3), leave less than this on the part."""
    cutter = DropCutter(surface, grown(tool, left_mm), floor_mm=-math.inf)
    heights = cutter.drop(np.ascontiguousarray(points[:, :2])) + left_mm
    return np.asarray(points[:, 2] < heights)


def _points(path: ToolPath, step_mm: float, chord_mm: float) -> Iterator[FloatArray]:
    """Tips along the moves at feed, no farther apart than a step, many at once; shape (n, 3) each."""
    chords = [m.chords_mm(chord_mm) for m in path.moves if not m.rapid]
    if not chords:
        return
    starts, ends = (np.concatenate([c[part] for c in chords]) for part in (slice(None, -1), slice(1, None)))
    counts = np.ceil(np.linalg.norm(ends - starts, axis=1) / step_mm).astype(np.int64)
    bounds = np.unique(np.searchsorted(np.cumsum(counts), np.arange(0, int(counts.sum()), _TOGETHER)))
    for first, last in pairwise([*bounds.tolist(), len(counts)]):
        own = counts[first:last]
        piece = np.repeat(np.arange(first, last), own)
        number = np.arange(len(piece)) - np.repeat(np.cumsum(own) - own, own) + 1
        share = (number / counts[piece])[:, None]
        yield starts[piece] * (1.0 - share) + ends[piece] * share
