"""Tool motion in the workpiece frame: lines and arcs with feed, spindle and the NC line they come from."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gcode.events import PLANE_AXES
from twin.arrays import FloatArray

#: More turns than this are several; and rounding in the number of an arc's corners.
_ONE_TURN, _ROUNDING = 1.0 + 1e-9, 1e-9


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Arc:
    """The curved part of a motion.

    Attributes:
        centre_mm: centre, shape (3,).
        plane: 17, 18 or 19.
        sweep_rad: signed angle, counter-clockwise about the plane's positive normal positive.
    """

    centre_mm: FloatArray
    plane: int
    sweep_rad: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Move:
    """One motion of the tool tip at constant speed, or a dwell.

    Attributes:
        start_mm, end_mm: tool tip in the workpiece frame, shape (3,).
        arc: None for a straight motion.
        duration_s: how long it takes.
        feed_mm_min: speed along the path, 0 in a dwell.
        spindle_rpm: signed, positive for M3.
        tool: tool number, 0 for none.
        rapid: True for positioning.
        nc_line: line of the NC program.
    """

    start_mm: FloatArray
    end_mm: FloatArray
    arc: Arc | None = None
    duration_s: float
    feed_mm_min: float
    spindle_rpm: float
    tool: int
    rapid: bool
    nc_line: int

    @property
    def length_mm(self) -> float:
        """Length along the path."""
        return path_length_mm(self.start_mm, self.end_mm, self.arc)

    def corners_mm(self, step_mm: float, chord_mm: float) -> FloatArray:
        """Points that divide the motion into straight pieces, start and end included, shape (n + 1, 3).

        A straight motion is one piece. An arc's chords are no longer than ``step_mm`` and deviate from it by at
        most ``chord_mm``. An arc of several turns has the same corners in each.
        """
        if self.arc is None:
            return np.array([self.start_mm, self.end_mm])
        i, j, k = PLANE_AXES[self.arc.plane]
        from_centre = self.start_mm - self.arc.centre_mm
        radius = math.hypot(from_centre[i], from_centre[j])
        per_chord = 2.0 * math.acos(max(0.0, 1.0 - chord_mm / max(radius, chord_mm)))
        by_length = 0 if step_mm == math.inf else math.ceil(self.length_mm / step_mm)
        n = max(2, by_length, math.ceil(abs(self.arc.sweep_rad) / per_chord))
        turns = abs(self.arc.sweep_rad) / (2.0 * math.pi)
        per_corner = 1.0 / n
        if turns > _ONE_TURN:
            per_corner = 1.0 / (turns * math.ceil(n / turns))
            n = math.ceil(1.0 / per_corner * (1.0 - _ROUNDING))
        # as np.linspace has them, in a third of its time
        part = np.arange(n + 1) * per_corner
        part[-1] = 1.0
        angle = math.atan2(from_centre[j], from_centre[i]) + part * self.arc.sweep_rad
        end_radius = math.hypot(self.end_mm[i] - self.arc.centre_mm[i], self.end_mm[j] - self.arc.centre_mm[j])
        r = radius + part * (end_radius - radius)
        points = np.empty((n + 1, 3))
        points[:, i] = self.arc.centre_mm[i] + r * np.cos(angle)
        points[:, j] = self.arc.centre_mm[j] + r * np.sin(angle)
        points[:, k] = self.start_mm[k] + part * (self.end_mm[k] - self.start_mm[k])
        points[0], points[-1] = self.start_mm, self.end_mm
        return points


def path_length_mm(start_mm: FloatArray, end_mm: FloatArray, arc: Arc | None) -> float:
    """Length of a line, an arc or a helix."""
    if arc is None:
        along = end_mm - start_mm
        return math.sqrt(along.dot(along))
    i, j, k = PLANE_AXES[arc.plane]
    r0 = math.hypot(start_mm[i] - arc.centre_mm[i], start_mm[j] - arc.centre_mm[j])
    r1 = math.hypot(end_mm[i] - arc.centre_mm[i], end_mm[j] - arc.centre_mm[j])
    return math.hypot(0.5 * (r0 + r1) * arc.sweep_rad, float(end_mm[k] - start_mm[k]))
