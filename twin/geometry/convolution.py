"""Sections inflated by a radius that depends on their distance, and united: the tri-slice paper, eq. 1."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import TypeAlias

import numpy as np
import shapely
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.shapes import Shape, Shapes

#: From heights above a plane to radii, NaN out of reach.
Radii: TypeAlias = Callable[[FloatArray], FloatArray]


def arc_segments(radius_mm: float, chord_mm: float) -> int:
    """Segments that a quarter circle needs for no chord to stand further inside of it than ``chord_mm``."""
    half = math.acos(max(0.0, 1.0 - chord_mm / radius_mm))
    return max(2, math.ceil(0.25 * math.pi / half))


def convolved(
    shapes: Shapes, positions_mm: FloatArray, planes_mm: FloatArray, radii: Radii, segments: int, threads: int | None
) -> Shapes:
    """Union, on every plane, of all sections inflated by the radius that belongs to their distance (eq. 1).

    A section that lies inside of the next one, which is inflated by as much or more, is left out: that changes nothing.

    Args:
        shapes: sections at ``positions_mm``, which increase.
        radii: from heights above a plane to radii, NaN out of reach.
        segments: segments a quarter circle.
    """
    inside_next, inside_last = _nested(shapes)

    def plane(at_mm: float) -> Shape:
        radius = radii(positions_mm - at_mm)
        wanted = _undominated(radius, inside_next, inside_last) & ~shapely.is_empty(shapes)
        grown = shapely.buffer(shapes[wanted], radius[wanted], quad_segs=segments)
        return shapely.union_all(grown)

    made = np.empty(len(planes_mm), dtype=object)
    count = threads or os.cpu_count() or 1
    if count == 1:
        made[:] = [plane(float(p)) for p in planes_mm]
    else:
        with ThreadPoolExecutor(max_workers=count) as pool:
            made[:] = list(pool.map(plane, planes_mm.tolist()))
    return made


def _nested(shapes: Shapes) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether each section lies inside of the next, and inside of the last one before it."""
    shapely.prepare(shapes)
    inside_next, inside_last = np.zeros(len(shapes), dtype=bool), np.zeros(len(shapes), dtype=bool)
    same = np.array([a is b for a, b in pairwise(shapes)], dtype=bool)
    inside_next[:-1] = same | shapely.covers(shapes[1:], shapes[:-1])
    inside_last[1:] = same | shapely.covers(shapes[:-1], shapes[1:])
    return inside_next, inside_last


def _undominated(
    radius: FloatArray, inside_next: NDArray[np.bool_], inside_last: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Sections within reach that no neighbour makes needless."""
    keep = ~np.isnan(radius)
    keep[:-1] &= ~(inside_next[:-1] & (radius[1:] > radius[:-1]))
    keep[1:] &= ~(inside_last[1:] & (radius[:-1] >= radius[1:]))
    return keep
