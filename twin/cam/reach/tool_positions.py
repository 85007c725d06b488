"""Planes on which a tool is placed to sweep all that it reaches: evenly spaced, and more where its path bends.

The space where the tool may be ends in edges: where a ball touches two faces at once, its centre rolls along such an
edge. On planes across it the edge is a corner, which the sweep passes on from plane to plane. Where an edge lies nearly
along the planes its corner wanders far between two of them, or it ends there, and the tool would be missed at its
deepest; so planes are added until it wanders no more than one pitch. The same where a part or a hole of that space
ends: over crests, and in hollows.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cam.slices.sections import SlicedPart, face_levels
from twin.cam.slices.structuring_element import StructuringElement
from twin.geometry.polygons.convolution import Convolution
from twin.geometry.polygons.corners import Corners
from twin.geometry.polygons.shapes import Shape, Shapes, minus

#: How far above a face a tool that stands on it is taken to be, mm: far above rounding, far below any tolerance.
_ON_MM = 1e-5
#: Corners that wander farther than this many pitches between two planes need a plane between them.
_WANDER_PITCHES = 1.0
#: Most halvings of a pitch.
_HALVINGS = 5
#: Steps of outlines that are smaller than this part of a pitch are noise.
_STEP_PITCHES = 0.02


def even_positions(part: SlicedPart, axis: int, planes_mm: FloatArray, element: StructuringElement) -> FloatArray:
    """Planes for the tool's reference point: evenly spaced, and where it stands on faces across the axis."""
    pitch, radius = float(part.slices.pitch_mm[axis]), element.radius_mm
    more = math.ceil(radius / pitch + 1.0)
    low, high = face_levels(part.mesh, axis)
    first = -more if element.centred or axis != 2 else 0
    even = planes_mm[0] + pitch * np.arange(first, len(planes_mm) + more)
    on = [high + element.drop_mm + _ON_MM]
    if element.centred:
        on.append(low - element.drop_mm - _ON_MM)
    return np.unique(np.concatenate((even, *on)))


def tool_positions(
    inflated: Convolution, outer: Shape, even_mm: FloatArray, pitch_mm: float
) -> tuple[FloatArray, Shapes, Shapes]:
    """Planes, the inflated part on them, and where the tool may be.

    Args:
        inflated: the part's sections, to be inflated.
        outer: rectangle around the part and its surroundings on a plane.
        even_mm: planes to begin with.

    Returns:
        planes, shape (n,), increasing, at most twice as many as before; inflated part and free area on each.
    """
    planes, walls = even_mm, inflated.on(even_mm)
    free = minus(outer, walls)
    corners = _corners(free, pitch_mm)
    for _ in range(_HALVINGS):
        added = _between(planes, corners, pitch_mm)[: 2 * len(even_mm) - len(planes)]
        if len(added) == 0:
            break
        more = inflated.on(added)
        left = minus(outer, more)
        order = np.argsort(np.concatenate((planes, added)))
        planes = np.concatenate((planes, added))[order]
        walls, free = np.concatenate((walls, more))[order], np.concatenate((free, left))[order]
        corners = np.concatenate((corners, _corners(left, pitch_mm)))[order]
    return planes, walls, free


def _between(planes_mm: FloatArray, corners: NDArray[np.object_], pitch_mm: float) -> FloatArray:
    """Middles between planes where corners wander, the farthest first."""
    wander = np.array([one.wander_mm(other) for one, other in pairwise(corners)])
    apart = np.diff(planes_mm) > 1.5 * pitch_mm / 2**_HALVINGS
    wide = np.flatnonzero(apart & (wander > _WANDER_PITCHES * pitch_mm))
    wide = wide[np.argsort(-wander[wide], kind="stable")]
    middles: FloatArray = 0.5 * (planes_mm[wide] + planes_mm[wide + 1])
    return middles


def _corners(free: Shapes, pitch_mm: float) -> NDArray[np.object_]:
    """Corners on each plane."""
    found = np.empty(len(free), dtype=object)
    found[:] = [Corners.of(shape, _STEP_PITCHES * pitch_mm) for shape in free]
    return found
