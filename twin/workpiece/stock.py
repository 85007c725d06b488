"""The stock as slices in three directions."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from twin.arrays import FloatArray, frozen
from twin.errors import StockError
from twin.geometry.polygons.clip import DECIMALS
from twin.geometry.polygons.region import Region
from twin.workpiece.slice_limit import least_pitch_mm
from twin.workpiece.store import PLANE_AXES

AXIS_NAMES = "xyz"
#: How far the polygon of a cylinder's section may deviate from the circle, where not given.
CHORD_MM = 0.001
#: Part of a pitch by which an extent may exceed a whole number of pitches without one more plane.
PITCH_SLACK = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SliceSet:
    """Material on three families of planes, see `twin.workpiece.store`.

    Attributes:
        low_mm, high_mm: corners of the stock's box, shape (3,).
        pitch_mm: distance of the planes along x, y, z, shape (3,).
        regions: one tuple an axis, one region a plane.
        notes: what was assumed or mended in the file of the stock.
    """

    low_mm: FloatArray
    high_mm: FloatArray
    pitch_mm: FloatArray
    regions: tuple[tuple[Region, ...], ...]
    notes: tuple[str, ...] = ()

    def positions_mm(self, axis: int) -> FloatArray:
        """Positions of a family's planes along its axis, increasing."""
        return plane_positions(self.low_mm, self.pitch_mm, axis, len(self.regions[axis]))


def plane_positions(low_mm: FloatArray, pitch_mm: FloatArray, axis: int, count: int) -> FloatArray:
    """Positions low + (k + 1/2) pitch of a family's planes along its axis."""
    positions: FloatArray = low_mm[axis] + (np.arange(count) + 0.5) * pitch_mm[axis]
    return positions


def plane_counts(low_mm: FloatArray, high_mm: FloatArray, pitch_mm: float) -> tuple[int, int, int]:
    """How many planes each family has: the pitch is made a little smaller, never larger, to fit the box evenly.

    Raises:
        StockError: a pitch that is not above 0, a box without extent, or far too many planes.
    """
    if not (pitch_mm > 0.0 and math.isfinite(pitch_mm)):
        raise StockError(f"slice pitch {pitch_mm:g} mm; expected a number above 0")
    for name, low, high in zip(AXIS_NAMES, low_mm, high_mm, strict=True):
        if not high > low:
            raise StockError(f"the stock reaches from {low:g} to {high:g} mm along {name}; expected an extent above 0")
    least = least_pitch_mm((high_mm - low_mm).tolist())
    if pitch_mm < (1.0 - 1e-9) * least:
        raise StockError(
            f"slice pitch {pitch_mm:g} mm; expected at least {least:.2g} mm, finer slices of a stock of "
            f"{' x '.join(f'{e:g}' for e in high_mm - low_mm)} mm do not fit in memory"
        )
    x, y, z = (max(1, math.ceil(float(e) / pitch_mm - PITCH_SLACK)) for e in high_mm - low_mm)
    return x, y, z


def even_pitch(low_mm: FloatArray, high_mm: FloatArray, pitch_mm: float) -> FloatArray:
    """The pitch along x, y and z that fits the box evenly, shape (3,), none above ``pitch_mm``.

    Raises:
        StockError: see `plane_counts`.
    """
    return frozen((high_mm - low_mm) / np.array(plane_counts(low_mm, high_mm, pitch_mm)), "pitch_mm", (3,))


def box_slices(low_mm: ArrayLike, high_mm: ArrayLike, pitch_mm: float) -> SliceSet:
    """A box as slices.

    Args:
        low_mm, high_mm: lower and upper corner, shape (3,), high above low on every axis; rounded to 1e-5 mm.
        pitch_mm: largest distance of the planes.

    Raises:
        StockError: a box or pitch that cannot be.
    """
    low, high = _corner(low_mm, "low_mm"), _corner(high_mm, "high_mm")
    pitch = even_pitch(low, high, pitch_mm)
    families = []
    for axis, (u, v) in enumerate(PLANE_AXES):
        rectangle = Region.of([(low[u], low[v]), (high[u], low[v]), (high[u], high[v]), (low[u], high[v])])
        families.append((rectangle,) * plane_counts(low, high, pitch_mm)[axis])
    return SliceSet(low_mm=low, high_mm=high, pitch_mm=pitch, regions=tuple(families))


def cylinder_slices(
    *,
    centre_mm: ArrayLike,
    diameter_mm: float,
    axis: str,
    low_mm: float,
    high_mm: float,
    pitch_mm: float,
    chord_mm: float = CHORD_MM,
) -> SliceSet:
    """A cylinder along x, y or z as slices.

    Sections across the axis are polygons of the circle's area, at most one third of ``chord_mm`` inside and two thirds
    outside of it; they never leave the cylinder's box. Sections along the axis are the exact rectangles of the circular
    cylinder on each plane, so their midpoint volume is off by terms of order (pitch / radius)^1.5.

    Args:
        centre_mm: shape (2,), the axis in the plane across it: (y, z) for x, (x, z) for y, (x, y) for z.
        axis: ``"x"``, ``"y"`` or ``"z"``.
        low_mm, high_mm: ends along the axis.
        pitch_mm: largest distance of the planes.
        chord_mm: distance of the polygon's chords from their arcs.

    Raises:
        StockError: an axis, a cylinder or a pitch that cannot be.
    """
    if axis not in ("x", "y", "z"):
        raise StockError(f'cylinder axis "{axis}"; expected "x", "y" or "z"')
    if not (diameter_mm > 0.0 and math.isfinite(diameter_mm)):
        raise StockError(f"cylinder diameter {diameter_mm:g} mm; expected a number above 0")
    w = AXIS_NAMES.index(axis)
    centre, radius = frozen(centre_mm, "centre_mm", (2,)), 0.5 * diameter_mm
    low, high = (_box_corner(w, e, centre, s * radius) for e, s in ((low_mm, -1.0), (high_mm, 1.0)))
    pitch = even_pitch(low, high, pitch_mm)
    counts = plane_counts(low, high, pitch_mm)
    families = []
    for family in range(3):
        if family == w:
            across = _rounded(circle_polygon(radius, chord_mm) + centre)
            families.append((across,) * counts[w])
        else:
            positions = plane_positions(low, pitch, family, counts[family])
            offsets = positions - centre[PLANE_AXES[w].index(family)]
            families.append(tuple(_side_section(family, w, low, high, centre, radius, d) for d in offsets))
    return SliceSet(low_mm=low, high_mm=high, pitch_mm=pitch, regions=tuple(families))


def circle_polygon(radius_mm: float, chord_mm: float) -> FloatArray:
    """A regular polygon of a circle's area about the origin, its sides square to the axes u and v.

    Args:
        chord_mm: largest distance of a side from its arc.

    Returns:
        shape (4 n, 2), counter-clockwise.
    """
    half = math.acos(max(0.5, 1.0 - chord_mm / radius_mm))
    sides = 4 * max(2, math.ceil(math.pi / half / 4.0))
    angles = (np.arange(sides) + 0.5) * (2.0 * math.pi / sides)
    reach = radius_mm * math.sqrt(2.0 * math.pi / sides / math.sin(2.0 * math.pi / sides))
    return reach * np.column_stack((np.cos(angles), np.sin(angles)))


def _side_section(
    family: int, w: int, low: FloatArray, high: FloatArray, centre: FloatArray, radius: float, offset: float
) -> Region:
    """The rectangle in which a plane along the axis, ``offset`` from it, meets the cylinder."""
    half = math.sqrt(max(0.0, radius * radius - offset * offset))
    if half <= 10.0**-DECIMALS:
        return Region()
    spans = []
    for a in PLANE_AXES[family]:
        middle = 0.0 if a == w else float(centre[PLANE_AXES[w].index(a)])
        spans.append((float(low[a]), float(high[a])) if a == w else (middle - half, middle + half))
    (u0, u1), (v0, v1) = spans
    return _rounded(np.array([(u0, v0), (u1, v0), (u1, v1), (u0, v1)]))


def _box_corner(w: int, end: float, centre: FloatArray, reach: float) -> FloatArray:
    """A corner of a cylinder's box."""
    corner = np.insert(centre + reach, w, end)
    return _corner(corner, "cylinder")


def _corner(values: ArrayLike, name: str) -> FloatArray:
    """A checked corner, rounded as all vertices are."""
    return frozen(np.round(frozen(values, name, (3,)), DECIMALS) + 0.0, name, (3,))


def _rounded(points: FloatArray) -> Region:
    return Region.of(np.round(points, DECIMALS) + 0.0)
