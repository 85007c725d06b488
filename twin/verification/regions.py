"""Regions out of tolerance: connected gouges and excess, each with its box, worst point and volume."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from twin.arrays import FloatArray

Kind: TypeAlias = Literal["gouge", "excess"]
#: Points belong to one region when they lie in neighbouring cells of this many pitches.
_CELL_PITCHES = 3.0
#: A region with less area than this, in squares of the pitch, is seen by rays along the surface only: it has no extent.
_LEAST_AREA = 1e-6
#: Largest number of cells of the grid that regions are found on.
_MOST_CELLS = 30_000_000


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DeviationRegion:
    """A connected part of the machined surface that is out of tolerance.

    Attributes:
        kind: ``gouge`` or ``excess``.
        worst_mm: largest depth or height.
        point_mm: its position, shape (3,).
        low_mm, high_mm: corners of the region's box, shape (3,).
        area_mm2: the region's area.
        volume_mm3: volume between the region and the design, as depth times area.
    """

    kind: Kind
    worst_mm: float
    point_mm: FloatArray
    low_mm: FloatArray
    high_mm: FloatArray
    area_mm2: float
    volume_mm3: float


def regions_out_of_tolerance(
    points_mm: FloatArray,
    deviation_mm: FloatArray,
    area_mm2: FloatArray,
    gouge_mm: float,
    excess_mm: float,
    pitch_mm: float,
) -> tuple[DeviationRegion, ...]:
    """All regions out of tolerance, gouges first, each kind by its worst point.

    Args:
        points_mm: points of the machined surface, shape (n, 3).
        deviation_mm, area_mm2: deviation and area of each point, shape (n,).
        gouge_mm, excess_mm: tolerances of the two kinds.
        pitch_mm: distance of the points.
    """
    found: list[DeviationRegion] = []
    kinds: tuple[tuple[Kind, FloatArray, float], ...] = (
        ("gouge", -deviation_mm, gouge_mm),
        ("excess", deviation_mm, excess_mm),
    )
    for kind, depth, most in kinds:
        out = depth > most
        groups = _groups(points_mm[out], _CELL_PITCHES * pitch_mm)
        here = [
            _region(kind, points_mm[out][groups == g], depth[out][groups == g], area_mm2[out][groups == g])
            for g in range(int(groups.max(initial=-1)) + 1)
        ]
        here = [region for region in here if region.area_mm2 > _LEAST_AREA * pitch_mm**2]
        found += sorted(here, key=lambda region: -region.worst_mm)
    return tuple(found)


def _region(kind: Kind, points: FloatArray, depth: FloatArray, area: FloatArray) -> DeviationRegion:
    worst = int(np.argmax(depth))
    return DeviationRegion(
        kind=kind,
        worst_mm=float(depth[worst]),
        point_mm=points[worst],
        low_mm=points.min(axis=0),
        high_mm=points.max(axis=0),
        area_mm2=float(area.sum()),
        volume_mm3=float((area * depth).sum()),
    )


def _groups(points: FloatArray, cell_mm: float) -> NDArray[np.int64]:
    """Number of the region that each point belongs to, from 0."""
    if len(points) == 0:
        return np.empty(0, dtype=np.int64)
    low, extent = points.min(axis=0), np.ptp(points, axis=0)
    cell_mm = max(cell_mm, float(np.prod(extent + cell_mm) / _MOST_CELLS) ** (1.0 / 3.0))
    cells = np.floor((points - low) / cell_mm).astype(np.int64)
    taken = np.zeros(cells.max(axis=0) + 1, dtype=bool)
    taken[tuple(cells.T)] = True
    labels, _ = ndimage.label(taken, structure=np.ones((3, 3, 3)))
    groups: NDArray[np.int64] = labels[tuple(cells.T)].astype(np.int64) - 1
    return groups
