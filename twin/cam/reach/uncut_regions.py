"""Uncut material on a part, as connected regions over slices: volume, thickness, position."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from twin.arrays import FloatArray
from twin.geometry.mesh.closest import ClosestPoints
from twin.geometry.polygons.pieces import Pieces
from twin.geometry.polygons.shapes import Shapes
from twin.workpiece.store import PLANE_AXES

#: Numbers of pieces that are neighbours.
Pairs: TypeAlias = tuple[NDArray[np.int64], NDArray[np.int64]]
#: A piece on a plane counts when its mean width is above this part of the pitch.
_WIDTH_PITCHES = 0.01
#: A piece is wide when its area is above this part of its outline's length squared (1/16 for a square).
_WIDE = 0.005
#: Pieces on neighbouring planes that are this many pitches apart belong together: thin regions may lie aslant.
_NEAR_PITCHES = 3.0
#: Pieces that are nowhere thicker than this share of the least thickness are omitted.
_TIES = 0.125
#: Pieces next to a region that get thinner from plane to plane belong to it down to this share of the least thickness.
_FADES = 1.0 / 32.0
#: Points on the outline of a piece where its thickness is measured, at most.
_MEASURED = 128


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UncutRegion:
    """One connected region of uncut material.

    Attributes:
        volume_mm3: of its slices, each with its area times the height that it represents.
        thickness_mm: largest distance from the part.
        deepest_mm: where that is, shape (3,).
        low_mm, high_mm: corners of its box, shape (3,).
        centroid_mm: shape (3,).
        axis: normal of its slices.
        planes_mm: position of each of its pieces.
        slabs_mm: shape (n, 2), the range of positions that each piece represents.
        pieces: polygons, one or more a plane.
    """

    volume_mm3: float
    thickness_mm: float
    deepest_mm: FloatArray
    low_mm: FloatArray
    high_mm: FloatArray
    centroid_mm: FloatArray
    axis: int
    planes_mm: FloatArray
    slabs_mm: FloatArray
    pieces: Shapes


def uncut_regions(
    left: Shapes,
    planes_mm: FloatArray,
    slabs_mm: FloatArray,
    axis: int,
    surface: ClosestPoints,
    thin_mm: float,
    threads: int | None = None,
) -> tuple[UncutRegion, ...]:
    """Connect uncut material on planes to regions.

    Args:
        left: uncut material on each plane.
        planes_mm: their positions along ``axis``, evenly spaced.
        slabs_mm: shape (n, 2), the range of positions that each plane represents, without gaps.
        axis: normal of the planes.
        surface: the part's.
        thin_mm: regions nowhere thicker than this are omitted.
        threads: threads to measure with, all cores if not given.

    Returns:
        The regions, the largest first.
    """
    pitch_mm = float(slabs_mm[-1, 1] - slabs_mm[0, 0]) / len(slabs_mm)
    pieces = Pieces.of(left, _WIDTH_PITCHES * pitch_mm)
    if len(pieces.shapes) == 0:
        return ()
    flat, of = _measured(pieces)
    points = _in_space(flat, planes_mm[pieces.planes[of]], axis)
    distance = np.abs(surface.ask(points, threads).distance_mm)
    thick = np.zeros(len(pieces.shapes))
    np.maximum.at(thick, of, distance)
    # what is thinner everywhere would only tie regions together
    kept = np.flatnonzero(thick > _TIES * thin_mm)
    if len(kept) == 0:
        return ()
    pairs = pieces.near_pairs(_NEAR_PITCHES * pitch_mm)
    labels = _faded(_connected(pairs, kept, len(thick)), pairs, np.where(thick > _FADES * thin_mm, thick, 0.0))
    found = []
    for label in range(labels.max() + 1):
        own = np.flatnonzero(labels[of] == label)
        deepest = own[np.argmax(distance[own])]
        if distance[deepest] > thin_mm:
            part = pieces.some(np.flatnonzero(labels == label))
            thickest = float(distance[deepest]), points[deepest]
            found.append(_uncut_region(part, planes_mm[part.planes], slabs_mm[part.planes], axis, *thickest))
    return tuple(sorted(found, key=lambda r: -r.volume_mm3))


def _measured(pieces: Pieces) -> tuple[FloatArray, NDArray[np.int64]]:
    """Points where thickness is measured, and the piece of each: on outlines, and in the middle of wide pieces."""
    (points, of), (middles, fat) = pieces.outline_points(_MEASURED), pieces.middles(_WIDE)
    return np.concatenate((points, middles)), np.concatenate((of, fat))


def _uncut_region(
    pieces: Pieces, planes_mm: FloatArray, slabs_mm: FloatArray, axis: int, thickness_mm: float, deepest_mm: FloatArray
) -> UncutRegion:
    volumes, bounds = pieces.areas_mm2 * (slabs_mm[:, 1] - slabs_mm[:, 0]), pieces.bounds_mm
    share = volumes / volumes.sum()
    return UncutRegion(
        volume_mm3=float(volumes.sum()),
        thickness_mm=thickness_mm,
        deepest_mm=deepest_mm,
        low_mm=_in_space(bounds[:, :2].min(axis=0), float(slabs_mm.min()), axis),
        high_mm=_in_space(bounds[:, 2:].max(axis=0), float(slabs_mm.max()), axis),
        centroid_mm=_in_space(share @ pieces.centroids_mm, float(share @ slabs_mm.mean(axis=1)), axis),
        axis=axis,
        planes_mm=planes_mm,
        slabs_mm=slabs_mm,
        pieces=pieces.shapes,
    )


def _in_space(points: FloatArray, planes: FloatArray | float, axis: int) -> FloatArray:
    """Points of planes, shape (..., 2), in (x, y, z)."""
    space = np.empty((*points.shape[:-1], 3))
    space[..., list(PLANE_AXES[axis])] = points
    space[..., axis] = planes
    return space


def _connected(pairs: Pairs, kept: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Number of the region of each kept piece, -1 for others: pieces on neighbouring planes that overlap, or nearly so.

    Args:
        pairs: neighbours among all pieces.
        count: number of all pieces.
    """
    number = np.full(count, -1, dtype=np.int64)
    number[kept] = np.arange(len(kept))
    one, other = number[pairs[0]], number[pairs[1]]
    both = (one >= 0) & (other >= 0)
    graph = coo_array((np.ones(int(both.sum()), dtype=np.int8), (one[both], other[both])), shape=(len(kept),) * 2)
    labels = np.full(count, -1, dtype=np.int64)
    labels[kept] = connected_components(graph, directed=False)[1]
    return labels


def _faded(labels: NDArray[np.int64], pairs: Pairs, thick_mm: FloatArray) -> NDArray[np.int64]:
    """Regions with their thin ends: from plane to plane, as long as there is a thinner piece next to the last one.

    A piece next to two regions belongs to the one whose piece is thicker.
    """
    labels = labels.copy()
    one, other = np.concatenate((pairs[0], pairs[1])), np.concatenate((pairs[1], pairs[0]))
    thinner = (thick_mm[other] > 0.0) & (thick_mm[other] < thick_mm[one])
    one, other = one[thinner], other[thinner]
    while True:
        ends = np.flatnonzero((labels[one] >= 0) & (labels[other] < 0))
        if len(ends) == 0:
            return labels
        ends = ends[np.argsort(thick_mm[one[ends]], kind="stable")]
        labels[other[ends]] = labels[one[ends]]
