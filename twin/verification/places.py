"""Where gouges and excess are: connected places, each with its extent, worst point and volume."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from twin.arrays import FloatArray

Kind: TypeAlias = Literal["gouge", "excess"]
#: Points belong together when they lie in neighbouring cells of so many pitches.
_CELL_PITCHES = 3.0
#: Most cells of the grid that places are found in.
_MOST_CELLS = 30_000_000


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Place:
    """A connected part of the machined surface that is out of tolerance.

    Attributes:
        kind: ``gouge`` or ``excess``.
        worst_mm: largest depth or height.
        point_mm: where that is, shape (3,).
        low_mm, high_mm: the place's box, shape (3,).
        area_mm2: its area.
        volume_mm3: between it and the design, as depth times area.
    """

    kind: Kind
    worst_mm: float
    point_mm: FloatArray
    low_mm: FloatArray
    high_mm: FloatArray
    area_mm2: float
    volume_mm3: float


def places_of(
    points_mm: FloatArray,
    deviation_mm: FloatArray,
    area_mm2: FloatArray,
    gouge_mm: float,
    excess_mm: float,
    pitch_mm: float,
) -> tuple[Place, ...]:
    """All places out of tolerance: gouges first, then by their worst point.

    Args:
        points_mm: shape (n, 3).
        deviation_mm, area_mm2: shape (n,).
        gouge_mm, excess_mm: what is allowed.
        pitch_mm: distance of the points.
    """
    found: list[Place] = []
    kinds: tuple[tuple[Kind, FloatArray, float], ...] = (
        ("gouge", -deviation_mm, gouge_mm),
        ("excess", deviation_mm, excess_mm),
    )
    for kind, depth, most in kinds:
        out = depth > most
        groups = _groups(points_mm[out], _CELL_PITCHES * pitch_mm)
        here = [
            _place(kind, points_mm[out][groups == g], depth[out][groups == g], area_mm2[out][groups == g])
            for g in range(int(groups.max(initial=-1)) + 1)
        ]
        found += sorted(here, key=lambda place: -place.worst_mm)
    return tuple(found)


def _place(kind: Kind, points: FloatArray, depth: FloatArray, area: FloatArray) -> Place:
    worst = int(np.argmax(depth))
    return Place(
        kind=kind,
        worst_mm=float(depth[worst]),
        point_mm=points[worst],
        low_mm=points.min(axis=0),
        high_mm=points.max(axis=0),
        area_mm2=float(area.sum()),
        volume_mm3=float((area * depth).sum()),
    )


def _groups(points: FloatArray, cell_mm: float) -> NDArray[np.int64]:
    """The number of the place that each point belongs to, from 0."""
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
