"""Shapes for the viewer: the tool as a mesh, the stock as a wire box, the colours of forces."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.record import RunHeader
from twin.sinks.rerun.layout import AIR_COLOR, Rgb

#: Sides of the tool's mesh.
SIDES = 48
#: Profile corners flatter than this are shaded as one smooth surface.
_SMOOTH_COS = math.cos(math.radians(35.0))

#: Force of class 1 and the ratio from class to class: 0.1 N to 100 kN in steps too small to see.
_FORCE_1_N = 0.1
_RATIO = 1.05
CLASSES = 1 + math.ceil(math.log(1e5 / _FORCE_1_N) / math.log(_RATIO))
#: Colours from no force to the end of the scale.
_MAP: NDArray[np.float64] = np.array(
    [(70, 96, 222), (40, 176, 236), (44, 226, 160), (164, 240, 68), (240, 208, 58), (252, 128, 36), (222, 40, 30)],
    np.float64,
)
#: Half side of the view in plan, at least, as a part of the stock's diagonal.
_LEAST_VIEW = 0.15
_NICE = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)


@dataclass(frozen=True, slots=True)
class Mesh:
    """A triangle mesh; vertices and normals (n, 3), triangles (m, 3)."""

    vertices: NDArray[np.float32]
    normals: NDArray[np.float32]
    triangles: NDArray[np.uint32]


def tool_mesh(profile_mm: FloatArray) -> Mesh:
    """The surface of revolution of a profile about z, closed at its top.

    Args:
        profile_mm: shape (n, 2), radius and height above the tip, upwards.
    """
    points = np.vstack([profile_mm, (0.0, profile_mm[-1, 1])])
    points = points[np.r_[True, np.any(np.diff(points, axis=0) != 0.0, axis=1)]]
    normals = _profile_normals(points)
    ends = np.stack([points[:-1], points[1:]], axis=1).reshape(-1, 2)
    angle = np.linspace(0.0, 2.0 * math.pi, SIDES + 1)
    cos, sin = np.cos(angle), np.sin(angle)
    vertices = np.stack([np.outer(ends[:, 0], cos), np.outer(ends[:, 0], sin), _across(ends[:, 1])], axis=-1)
    turned = np.stack([np.outer(normals[:, 0], cos), np.outer(normals[:, 0], sin), _across(normals[:, 1])], axis=-1)
    return Mesh(_rows(vertices), _rows(turned), _strip_triangles(len(points) - 1))


def view_box(header: RunHeader) -> FloatArray:
    """The part of the stock that is cut, shape (2, 3), up to the stock's upper face.

    Without feed motions, and in runs of earlier versions, it is the whole stock; it is never much smaller.
    """
    low, high = header.stock_bounds_mm
    if header.work_bounds_mm is None:
        return header.stock_bounds_mm
    reach = max((float(t.profile_mm[:2, 0].max()) for t in header.tools), default=0.0)
    inside = np.clip(header.work_bounds_mm + np.array([[-reach], [reach]]), low, high)
    centre, half = inside.mean(axis=0), 0.5 * np.ptp(inside, axis=0)
    half = np.maximum(half, _LEAST_VIEW * float(np.linalg.norm(high[:2] - low[:2])))
    box = np.clip([centre - half, centre + half], low, high)
    box[:, 2] = min(inside[0, 2], high[2] - _LEAST_VIEW * float(high[2] - low[2])), high[2]
    return np.asarray(box)


def box_edges(bounds_mm: FloatArray) -> list[FloatArray]:
    """The twelve edges of a box given by its lower and upper corner, shape (2, 3), as six line strips."""
    (x0, y0, z0), (x1, y1, z1) = bounds_mm
    ring = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
    rings = [np.array([(x, y, z) for x, y in ring]) for z in (z0, z1)]
    return [*rings, *(np.array([(x, y, z0), (x, y, z1)]) for x, y in ring[:4])]


def force_class(force_n: float) -> int:
    """Class of a resultant force: 0 for none, then steps of 5 %."""
    if force_n < _FORCE_1_N:
        return 0
    return min(CLASSES, 1 + int(math.log(force_n / _FORCE_1_N) / math.log(_RATIO)))


def class_force_n(number: int) -> float:
    """Force in the middle of a class."""
    return _FORCE_1_N * _RATIO ** (number - 0.5) if number else 0.0


def scale_end_n(force_n: float) -> float:
    """The round number at or above a force, for the end of the colour scale."""
    if force_n <= 0.0:
        return 1.0
    decade = 10.0 ** math.floor(math.log10(force_n))
    return next((n * decade for n in _NICE if n * decade >= force_n), 10.0 * decade)


def label_step_n(end_n: float) -> float:
    """The largest 1, 2 or 5 times a power of ten that goes at least three times into a scale."""
    decade = 10.0 ** math.floor(math.log10(end_n))
    return next(step * decade for step in (2.0, 1.0, 0.5, 0.2) if 3.0 * step * decade <= end_n)


def class_colors(end_n: float) -> list[Rgb]:
    """Colour of every class, class 0 first, on a scale from 0 to ``end_n``, linear in the force."""
    at = np.clip([class_force_n(k) / end_n for k in range(CLASSES + 1)], 0.0, 1.0) * (len(_MAP) - 1)
    channels = np.stack([np.interp(at, np.arange(len(_MAP)), _MAP[:, c]) for c in range(3)], axis=1)
    return [AIR_COLOR, *((int(r), int(g), int(b)) for r, g, b in channels[1:])]


def _profile_normals(points: FloatArray) -> FloatArray:
    """Outward normals (radial, axial) at both ends of every piece of a profile, shape (2 (n - 1), 2)."""
    along = np.diff(points, axis=0)
    own = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    smooth = np.sum(own[:-1] * own[1:], axis=1) > _SMOOTH_COS
    shared = own[:-1] + own[1:]
    shared /= np.maximum(np.linalg.norm(shared, axis=1), 1e-9)[:, None]
    normals = np.stack([own, own], axis=1)
    normals[1:, 0][smooth] = shared[smooth]
    normals[:-1, 1][smooth] = shared[smooth]
    return normals.reshape(-1, 2)


def _strip_triangles(pieces: int) -> NDArray[np.uint32]:
    """Two triangles for each piece of the profile and side; rows of vertices are ``SIDES + 1`` long."""
    row = SIDES + 1
    low = (2 * row * np.arange(pieces)[:, None] + np.arange(SIDES)).ravel()
    high = low + row
    quads = [(low, low + 1, high + 1), (low, high + 1, high)]
    return np.concatenate([np.stack(q, axis=1) for q in quads]).astype(np.uint32)


def _across(values: FloatArray) -> FloatArray:
    return np.repeat(values[:, None], SIDES + 1, axis=1)


def _rows(grid: FloatArray) -> NDArray[np.float32]:
    return np.ascontiguousarray(grid.reshape(-1, 3), dtype=np.float32)
