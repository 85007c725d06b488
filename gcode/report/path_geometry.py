"""Paths of motions: length, extreme coordinates, and points within a tolerance."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gcode.events import PLANE_AXES, ArcMotion, Motion, Point

#: Most chords of one arc.
MOST_CHORDS = 100_000
#: Steps towards the turning points of a spiral; each divides the error by 5 even where r' is half of r.
_STEPS = 20


@dataclass(frozen=True, slots=True)
class _Spiral:
    """An arc as functions of the angle swept: radius and height go in proportion to it.

    Attributes:
        start_rad: angle of the start about the centre.
        sweep_rad: signed angle swept.
        start_mm: radius at the start.
        end_mm: radius at the end.
        rise_mm: length along the plane's normal.
    """

    start_rad: float
    sweep_rad: float
    start_mm: float
    end_mm: float
    rise_mm: float

    @property
    def growth(self) -> float:
        """Change of the radius with the angle, mm/rad."""
        return (self.end_mm - self.start_mm) / self.sweep_rad

    def radius_mm(self, swept_rad: float) -> float:
        """Radius where an angle has been swept."""
        return self.start_mm + self.growth * swept_rad


def _spiral(arc: ArcMotion) -> _Spiral:
    i, j, k = PLANE_AXES[arc.plane]
    start = (arc.start_mm[i] - arc.centre_mm[i], arc.start_mm[j] - arc.centre_mm[j])
    end = (arc.end_mm[i] - arc.centre_mm[i], arc.end_mm[j] - arc.centre_mm[j])
    return _Spiral(
        start_rad=math.atan2(start[1], start[0]),
        sweep_rad=arc.sweep_rad,
        start_mm=math.hypot(*start),
        end_mm=math.hypot(*end),
        rise_mm=arc.end_mm[k] - arc.start_mm[k],
    )


def length_mm(motion: Motion) -> float:
    """Length of a motion's path, helices and arcs of changing radius included."""
    if not isinstance(motion, ArcMotion):
        return math.dist(motion.start_mm, motion.end_mm)
    spiral = _spiral(motion)
    along = math.hypot(spiral.growth, spiral.rise_mm / spiral.sweep_rad)
    radii = (spiral.start_mm, (spiral.start_mm + spiral.end_mm) / 2.0, spiral.end_mm)
    first, middle, last = (math.hypot(radius, along) for radius in radii)
    return abs(spiral.sweep_rad) * (first + 4.0 * middle + last) / 6.0


def extremes_mm(motion: Motion) -> tuple[Point, Point]:
    """Least and largest coordinates of a motion; for an arc those of its path, not of its ends."""
    low = [min(a, b) for a, b in zip(motion.start_mm, motion.end_mm, strict=True)]
    high = [max(a, b) for a, b in zip(motion.start_mm, motion.end_mm, strict=True)]
    if isinstance(motion, ArcMotion):
        spiral = _spiral(motion)
        for axis, phase in zip(PLANE_AXES[motion.plane][:2], (0.0, math.pi / 2.0), strict=True):
            for value in _turning_points(spiral, phase):
                low[axis] = min(low[axis], motion.centre_mm[axis] + value)
                high[axis] = max(high[axis], motion.centre_mm[axis] + value)
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _turning_points(spiral: _Spiral, phase_rad: float) -> Iterator[float]:
    """Coordinates of the turning points along one direction; of those of many turns, the outermost of each side."""
    least, most = sorted((0.0, spiral.sweep_rad))
    first = math.ceil((spiral.start_rad + least - phase_rad) / math.pi)
    last = math.floor((spiral.start_rad + most - phase_rad) / math.pi)
    for half_turn in {*range(first - 1, first + 2), *range(last - 1, last + 2)}:
        swept = _turned_back(spiral, half_turn * math.pi + phase_rad - spiral.start_rad)
        if least <= swept <= most:
            yield spiral.radius_mm(swept) * math.cos(spiral.start_rad + swept - phase_rad)


def _turned_back(spiral: _Spiral, circular_rad: float) -> float:
    """Angle swept where a coordinate turns back, near that of a circle: there tan(angle from the axis) = r'/r."""
    swept, growth = circular_rad, spiral.growth
    for _ in range(_STEPS if growth else 0):
        swept = circular_rad + math.atan2(growth, max(spiral.radius_mm(swept), 1e-12))
    return swept


def points_mm(motion: Motion, tolerance_mm: float) -> NDArray[np.float64]:
    """Points along a motion, both ends included.

    Args:
        motion: a straight motion or an arc.
        tolerance_mm: largest distance of the chords from an arc, > 0.

    Returns:
        One row of x, y, z per point; the first and last are the motion's ends to the last digit.
    """
    if not isinstance(motion, ArcMotion):
        return np.array((motion.start_mm, motion.end_mm))
    spiral = _spiral(motion)
    largest = max(spiral.start_mm, spiral.end_mm, 1e-9)
    step = 2.0 * math.acos(max(1.0 - tolerance_mm / largest, math.cos(math.pi / 4.0)))
    count = min(max(math.ceil(abs(spiral.sweep_rad) / step), 1), MOST_CHORDS)
    parts = np.linspace(0.0, 1.0, count + 1)
    angles = spiral.start_rad + spiral.sweep_rad * parts
    radii = spiral.start_mm + (spiral.end_mm - spiral.start_mm) * parts
    i, j, k = PLANE_AXES[motion.plane]
    made = np.empty((count + 1, 3))
    made[:, i] = motion.centre_mm[i] + radii * np.cos(angles)
    made[:, j] = motion.centre_mm[j] + radii * np.sin(angles)
    made[:, k] = motion.start_mm[k] + spiral.rise_mm * parts
    made[0], made[-1] = motion.start_mm, motion.end_mm
    return made
