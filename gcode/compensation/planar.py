"""Motions projected onto the plane of compensation: a point of the plane is a complex number.

The first axis of the plane (see `gcode.events.PLANE_AXES`) is the real, the second the imaginary one; ``1j * d`` is
then the normal to the left of a direction ``d``. The coordinate along the plane's normal is called height.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from gcode.events import PLANE_AXES, ArcMotion, LinearMotion, Motion, Plane, Point

#: Points nearer to each other than this, mm, are one point: rounding of coordinates alone parts them.
SAME_POINT_MM = 1e-7
#: A full turn's two ends may be this far apart, mm, through the rounding of an offset; they are joined again.
_CLOSES_MM = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class Segment:
    """One motion in the plane.

    Attributes:
        motion: the motion as programmed; place, feed and heights are its own.
        start: where it starts in the plane, mm.
        end: where it ends, mm.
        centre: centre of an arc, None for a straight motion.
        turns: signed turns of an arc as in `ArcMotion`, in the sense of the flat view; 0 for a straight motion.
    """

    motion: Motion
    start: complex
    end: complex
    centre: complex | None = None
    turns: int = 0

    @property
    def moves(self) -> bool:
        """Whether it goes anywhere in the plane."""
        return self.centre is not None or abs(self.end - self.start) > SAME_POINT_MM

    @property
    def direction_in(self) -> complex:
        """Unit tangent at the start; only for a segment that moves."""
        return self.direction_at(self.start)

    @property
    def direction_out(self) -> complex:
        """Unit tangent at the end."""
        return self.direction_at(self.end)

    @property
    def sweep_rad(self) -> float:
        """Signed angle swept by an arc, counter-clockwise positive; 0 for a straight motion."""
        return 0.0 if self.centre is None else swept(self.start, self.end, self.centre, self.turns)

    @property
    def rapid(self) -> bool:
        """Whether it is a positioning motion."""
        return isinstance(self.motion, LinearMotion) and self.motion.rapid

    def direction_at(self, point: complex) -> complex:
        """Unit tangent at a point of it."""
        if self.centre is None:
            return unit(self.end - self.start)
        return unit(point - self.centre) * (1j if self.turns > 0 else -1j)

    def between(self, start: complex, end: complex) -> Segment:
        """This segment with other ends; a full turn that rounding alone leaves open is closed."""
        full = self.centre is not None and abs(self.end - self.start) <= SAME_POINT_MM
        return replace(self, start=start, end=start if full and abs(end - start) <= _CLOSES_MM else end)


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkingPlane:
    """The plane of compensation, and the projection of points and motions onto it.

    Attributes:
        plane: 17, 18 or 19.
        mirrored: True where left and right are swapped, so that a rule for one side is written once.
    """

    plane: Plane
    mirrored: bool = False

    def flat(self, point: Point) -> complex:
        """`point` in the plane."""
        first, second, _ = PLANE_AXES[self.plane]
        return complex(point[first], -point[second] if self.mirrored else point[second])

    def height(self, point: Point) -> float:
        """Coordinate of `point` along the plane's normal, mm."""
        return point[PLANE_AXES[self.plane][2]]

    def space(self, flat: complex, height: float) -> Point:
        """The point over `flat` at `height`."""
        first, second, normal = PLANE_AXES[self.plane]
        point = [0.0, 0.0, 0.0]
        point[first], point[second] = flat.real, -flat.imag if self.mirrored else flat.imag
        point[normal] = height
        return (point[0], point[1], point[2])

    def segment(self, motion: Motion) -> Segment:
        """`motion` as seen in the plane."""
        start, end = self.flat(motion.start_mm), self.flat(motion.end_mm)
        if isinstance(motion, LinearMotion):
            return Segment(motion=motion, start=start, end=end)
        turns = -motion.turns if self.mirrored else motion.turns
        return Segment(motion=motion, start=start, end=end, centre=self.flat(motion.centre_mm), turns=turns)

    def motion(self, segment: Segment) -> Motion:
        """The motion in space of a segment whose ends were moved; all else is as in the block."""
        motion = segment.motion
        low, high = self.height(motion.start_mm), self.height(motion.end_mm)
        start, end = self.space(segment.start, low), self.space(segment.end, high)
        if isinstance(motion, LinearMotion) or segment.centre is None:
            return replace(motion, start_mm=start, end_mm=end)
        return replace(motion, start_mm=start, end_mm=end, centre_mm=self.space(segment.centre, low))

    def line(self, like: Motion, start: complex, end: complex, height: float) -> LinearMotion:
        """A straight motion at `height` with the place and the feed of the motion `like`."""
        return LinearMotion(
            place=like.place,
            state=like.state,
            start_mm=self.space(start, height),
            end_mm=self.space(end, height),
            rapid=isinstance(like, LinearMotion) and like.rapid,
            feed_mm_min=like.feed_mm_min,
            extra=like.extra,
        )

    def arc(self, like: Motion, ends: tuple[complex, complex], centre: complex, turns: int, height: float) -> ArcMotion:
        """An arc at `height` with the place and the feed of the motion `like`."""
        return ArcMotion(
            place=like.place,
            state=like.state,
            start_mm=self.space(ends[0], height),
            end_mm=self.space(ends[1], height),
            centre_mm=self.space(centre, height),
            plane=self.plane,
            turns=-turns if self.mirrored else turns,
            feed_mm_min=like.feed_mm_min,
            extra=like.extra,
        )


def unit(vector: complex) -> complex:
    """`vector` at length 1."""
    return vector / abs(vector)


def dot(a: complex, b: complex) -> float:
    """Scalar product."""
    return a.real * b.real + a.imag * b.imag


def cross(a: complex, b: complex) -> float:
    """Product of the lengths and the sine of the angle from `a` to `b`; positive where `b` is to the left."""
    return a.real * b.imag - a.imag * b.real


def swept(start: complex, end: complex, centre: complex, turns: int) -> float:
    """Signed angle, rad, from `start` to `end` about `centre`; the same place is reached by a full turn."""
    sign = 1.0 if turns > 0 else -1.0
    a, b = start - centre, end - centre
    angle = (sign * math.atan2(cross(a, b), dot(a, b))) % (2.0 * math.pi)
    if angle == 0.0 or abs(end - start) <= SAME_POINT_MM:
        angle = 2.0 * math.pi
    return sign * (angle + 2.0 * math.pi * (abs(turns) - 1))


def line_circle(point: complex, direction: complex, centre: complex, radius: float) -> tuple[complex, ...]:
    """Where the line through `point` along the unit `direction` meets a circle; empty where it misses it."""
    foot = point + direction * dot(centre - point, direction)
    square = radius * radius - abs(centre - foot) ** 2
    if square < -SAME_POINT_MM * max(radius, 1.0):
        return ()
    half = math.sqrt(max(square, 0.0))
    return (foot - half * direction, foot + half * direction)


def circle_circle(a: complex, radius_a: float, b: complex, radius_b: float) -> tuple[complex, ...]:
    """Where two circles meet; empty where they do not, or are one."""
    distance = abs(b - a)
    if distance <= SAME_POINT_MM:
        return ()
    along = (distance * distance + radius_a * radius_a - radius_b * radius_b) / (2.0 * distance)
    square = radius_a * radius_a - along * along
    if square < -SAME_POINT_MM * max(radius_a, 1.0):
        return ()
    towards, half = unit(b - a), math.sqrt(max(square, 0.0))
    foot = a + along * towards
    return (foot - 1j * half * towards, foot + 1j * half * towards)
