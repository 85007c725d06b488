"""The stock as slices in three directions."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from twin.arrays import FloatArray, frozen
from twin.geometry.region import Region
from twin.workpiece.store import PLANE_AXES


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SliceSet:
    """Material on three families of planes, see `twin.workpiece.store`.

    Attributes:
        low_mm, high_mm: corners of the stock's box, shape (3,).
        pitch_mm: distance of the planes along x, y, z, shape (3,).
        regions: one tuple an axis, one region a plane.
    """

    low_mm: FloatArray
    high_mm: FloatArray
    pitch_mm: FloatArray
    regions: tuple[tuple[Region, ...], ...]


def plane_counts(low_mm: FloatArray, high_mm: FloatArray, pitch_mm: float) -> tuple[int, int, int]:
    """How many planes each family has: the pitch is made a little smaller, never larger, to fit the box evenly."""
    x, y, z = (max(1, math.ceil(float(e) / pitch_mm * (1.0 - 1e-9))) for e in high_mm - low_mm)
    return x, y, z


def box_slices(low_mm: FloatArray, high_mm: FloatArray, pitch_mm: float) -> SliceSet:
    """A box as slices.

    Args:
        low_mm, high_mm: lower and upper corner, shape (3,), high above low on every axis.
        pitch_mm: largest distance of the planes.
    """
    low, high = frozen(low_mm, "low_mm", (3,)), frozen(high_mm, "high_mm", (3,))
    counts = plane_counts(low, high, pitch_mm)
    families = []
    for axis, (u, v) in enumerate(PLANE_AXES):
        rectangle = Region.of([(low[u], low[v]), (high[u], low[v]), (high[u], high[v]), (low[u], high[v])])
        families.append((rectangle,) * counts[axis])
    pitch = frozen((high - low) / np.array(counts), "pitch_mm", (3,))
    return SliceSet(low_mm=low, high_mm=high, pitch_mm=pitch, regions=tuple(families))
