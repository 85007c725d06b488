"""What a ball leaves in the inner fillet of the torus part as its STL has it, with chords."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from support import solids
from twin.arrays import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Ring:
    """The ring between plate, tube and ball.

    Attributes:
        volume_mm3: of the ring.
        thickness_mm: largest distance of the ball's surface from the part.
        foot_mm: distance from the axis at which the ball touches the plate.
        touch_mm: distance from the axis, and height, at which it touches the tube.
    """

    volume_mm3: float
    thickness_mm: float
    foot_mm: float
    touch_mm: FloatArray


def ring_in_facets(ball_mm: float, around: int, along: int, profile: object = None) -> Ring:
    """The ring that a ball leaves, exact but for quadrature.

    In the middle between two meridians the part's section is the meridian's polygon, drawn together by cos(pi / n). The
    ball rolls there on the plate and along the tube's edges, its centre on a polygon of n sides about the axis. At a
    height the ring lies between the tube's polygon and the centres' polygon inflated by the ball's radius there.
    """
    example = solids.torus_example()
    curve = example.meridian(along, profile or example.PROFILE) * np.array([math.cos(math.pi / around), 1.0])
    foot = _foot(curve, ball_mm)
    touch = min(_nearest(curve, np.array([foot, ball_mm])), key=lambda p: math.dist(p, (foot, ball_mm)))
    z = (np.arange(200_000) + 0.5) / 200_000 * touch[1]
    rising = curve[: int(np.argmax(curve[:, 1])) + 1]
    wall, reach = np.interp(z, rising[:, 1], rising[:, 0]), np.sqrt(ball_mm**2 - (z - ball_mm) ** 2)
    sides = around * math.tan(math.pi / around)
    areas = sides * (wall**2 - foot**2 - 2.0 * foot * reach) - math.pi * reach**2
    angles = np.linspace(-0.5 * math.pi, math.atan2(touch[1] - ball_mm, touch[0] - foot), 2001)
    ball = np.array([foot, ball_mm]) + ball_mm * np.column_stack((np.cos(angles), np.sin(angles)))
    floor = np.vstack(([0.0, 0.0], curve))
    thick = max(float(np.linalg.norm(_nearest(floor, p) - p, axis=1).min()) for p in ball)
    return Ring(volume_mm3=float(areas.mean()) * touch[1], thickness_mm=thick, foot_mm=foot, touch_mm=touch)


def _nearest(curve: FloatArray, point: FloatArray) -> FloatArray:
    """Nearest place on each edge of a polygon."""
    begin, along = curve[:-1], np.diff(curve, axis=0)
    share = np.clip(np.sum((point - begin) * along, axis=1) / np.sum(along**2, axis=1), 0.0, 1.0)
    return begin + share[:, None] * along


def _foot(curve: FloatArray, ball_mm: float) -> float:
    """Where the ball that stands on the plate touches the tube too: the farthest it gets from the axis."""
    low, high = 0.0, float(curve[int(np.argmax(curve[:, 1])), 0])
    for _ in range(60):
        middle = 0.5 * (low + high)
        centre = np.array([middle, ball_mm])
        free = np.linalg.norm(_nearest(curve, centre) - centre, axis=1).min() >= ball_mm
        low, high = (middle, high) if free else (low, middle)
    return low
