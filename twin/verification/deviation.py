"""Deviation of the machined surface from the design: gouges, excess, and the share of the surface within tolerance.

Signs: positive where material was left, negative where material of the design was removed. Distances are normal to the
design, from points of the machined surface to the design's triangles. A thin rib that is missing altogether cannot be
detected by a distance to the nearest surface; rays detect it, as they measure how much of the design is missing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from twin.arrays import FloatArray, frozen
from twin.geometry.mesh.closest import ClosestPoints
from twin.tolerance import Tolerance
from twin.verification.rays import Rays, beyond, cast
from twin.verification.regions import DeviationRegion, regions_out_of_tolerance
from twin.workpiece.solids.from_mesh import Solid
from twin.workpiece.trislice import TriSlices

#: Shares of the surface's area that percentiles are reported for.
SHARES = (0.001, 0.01, 0.05, 0.5, 0.95, 0.99, 0.999)
#: Smallest component of a design's normal along a ray for which the length on the ray is used as a distance.
_FACING = 0.577
#: A point of the design counts as lost when no machined surface is within the tolerance plus this many pitches.
_LOST_PITCHES = 1.0
#: Deviation caused by rounding of vertices, mm.
_ROUNDING_MM = 1e-5
#: Points within this distance of the stock's box, mm, were not machined if they are flush with the design as well.
_FLUSH_MM = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Limits:
    """The box of the part that is verified.

    Attributes:
        low_mm, high_mm: corners, shape (3,); infinite without a limit.
    """

    low_mm: FloatArray
    high_mm: FloatArray

    @classmethod
    def of(cls, design: Solid, region_mm: ArrayLike | None = None) -> Limits:
        """The design's box in x and y, or a region (x0, y0, x1, y1), from the design's lowest point upwards."""
        low, high = design.vertices_mm.min(axis=0), design.vertices_mm.max(axis=0)
        if region_mm is not None:
            region = frozen(region_mm, "region_mm", (4,))
            low = np.array([*region[:2], low[2]])
            high = np.array([*region[2:], high[2]])
        return cls(low_mm=low, high_mm=np.array([high[0], high[1], math.inf]))

    def hold(self, points_mm: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie inside or on the box, shape (n,)."""
        over = (points_mm >= self.low_mm - _FLUSH_MM) & (points_mm <= self.high_mm + _FLUSH_MM)
        return np.asarray(np.all(over, axis=1))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Deviation:
    """Deviation of the machined surface from the design.

    Attributes:
        points_mm: points of the machined surface, shape (n, 3).
        deviation_mm: their deviation, shape (n,).
        area_mm2: surface area that each point represents, shape (n,).
        design_points_mm, design_deviation_mm: points of the design and the deviation of the machined surface there,
            shape (m, 3) and (m,).
        tolerance_mm: permitted gouge.
        excess_mm: permitted excess.
        gouged_mm3: volume of the design that was removed from the stock.
        left_mm3: volume of material left on the design: stock less removed less design, inside the limits.
        lost_mm: largest distance from a missing point of the design to the machined surface, 0 for none.
        resolution_mm: accuracy of the deviations.
        pitch_mm: largest distance between rays; smaller details may lie undetected between them.
        regions: gouges and excess beyond tolerance, the worst first.
    """

    points_mm: FloatArray
    deviation_mm: FloatArray
    area_mm2: FloatArray
    design_points_mm: FloatArray
    design_deviation_mm: FloatArray
    tolerance_mm: float
    excess_mm: float
    gouged_mm3: float
    left_mm3: float
    lost_mm: float
    resolution_mm: float
    pitch_mm: float
    regions: tuple[DeviationRegion, ...]

    @property
    def worst_gouge_mm(self) -> float:
        """Depth of the deepest gouge, 0 or more."""
        return max(0.0, -float(self.deviation_mm.min(initial=0.0)), self.lost_mm)

    @property
    def worst_excess_mm(self) -> float:
        """Height of the largest excess, 0 or more."""
        return max(0.0, float(self.deviation_mm.max(initial=0.0)))

    @property
    def gouge_ok(self) -> bool:
        """Whether no gouge is deeper than tolerance and resolution together."""
        return self.worst_gouge_mm <= self.tolerance_mm + self.resolution_mm

    @property
    def excess_ok(self) -> bool:
        """Whether no excess is higher than its tolerance and the resolution together."""
        return self.worst_excess_mm <= self.excess_mm + self.resolution_mm

    @property
    def within(self) -> float:
        """Share of the machined area within both tolerances."""
        ok = (self.deviation_mm >= -self.tolerance_mm) & (self.deviation_mm <= self.excess_mm)
        total = float(self.area_mm2.sum())
        return float(self.area_mm2[ok].sum()) / total if total else 1.0

    def quantiles_mm(self, shares: ArrayLike = SHARES) -> FloatArray:
        """Deviations that the given shares of the machined area do not exceed, shape as ``shares``."""
        if len(self.deviation_mm) == 0:
            return np.zeros(np.shape(shares))
        order = np.argsort(self.deviation_mm, kind="stable")
        grown = np.cumsum(self.area_mm2[order])
        index = np.searchsorted(grown, np.asarray(shares) * grown[-1])
        return np.asarray(self.deviation_mm[order][np.minimum(index, len(order) - 1)])


def deviation(
    store: TriSlices,
    design: Solid,
    *,
    tolerance_mm: float,
    excess_mm: float | None = None,
    limits: Limits | None = None,
    threads: int | None = None,
) -> Deviation:
    """Compare a machined workpiece with a design in the same coordinates.

    Args:
        store: the machined workpiece.
        design: the design.
        tolerance_mm: permitted depth of gouges.
        excess_mm: permitted excess, e.g. allowance and scallops; the tolerance if not given.
        limits: box that is verified; the design's box if not given.
        threads: number of threads, None for all cores.

    Raises:
        ValueError: a tolerance is not above 0.
    """
    excess = tolerance_mm if excess_mm is None else excess_mm
    if not (tolerance_mm > 0.0 and excess > 0.0):
        raise ValueError(f"tolerance_mm and excess_mm must be above 0, got {tolerance_mm} and {excess}")
    limits = limits or Limits.of(design)
    tree = ClosestPoints(design.vertices_mm, design.triangles, design.edges)
    found = [
        _one_direction(rays, tree, store, limits, min(tolerance_mm, excess), threads) for rays in cast(store, design)
    ]
    points, away, area, touched, wanted, over = (np.concatenate([f[i] for f in found]) for i in range(6))
    left, gone = np.mean([f.volumes_mm3 for f in found], axis=0)
    pitch = float(store.pitch_mm.max())
    lost = _lost(points, wanted, over, tolerance_mm + _LOST_PITCHES * pitch)
    points, away, area = points[touched], away[touched], area[touched]
    return Deviation(
        points_mm=points,
        deviation_mm=away,
        area_mm2=area,
        design_points_mm=wanted,
        design_deviation_mm=over,
        tolerance_mm=tolerance_mm,
        excess_mm=excess,
        gouged_mm3=float(gone),
        left_mm3=float(left),
        lost_mm=lost,
        resolution_mm=Tolerance.for_pitch(pitch).chord_mm + _ROUNDING_MM,
        pitch_mm=pitch,
        regions=regions_out_of_tolerance(points, away, area, tolerance_mm, excess, pitch),
    )


class _Direction(NamedTuple):
    """Measurements of rays along one axis: points of the machined surface and of the design, volumes between them."""

    points: FloatArray
    away: FloatArray
    area: FloatArray
    touched: NDArray[np.bool_]
    wanted: FloatArray
    over: FloatArray
    volumes_mm3: tuple[float, float]


def _one_direction(
    rays: Rays, tree: ClosestPoints, store: TriSlices, limits: Limits, near_mm: float, threads: int | None
) -> _Direction:
    points, _, _ = rays.points(rays.machined)
    held = limits.hold(points)
    points = points[held]
    near = tree.ask(points, threads)
    apart = points - near.places_mm
    distance = np.abs(near.distance_mm)
    far = distance > _ROUNDING_MM
    normals = np.where(far[:, None], apart / np.where(far, near.distance_mm, 1.0)[:, None], near.normals)
    facing = np.abs(normals[:, rays.axis])
    # within tolerance the design's normal is that of the machined surface as well; elsewhere the slices have it
    if (away := distance > near_mm).any():
        facing[away] = rays.facing(store)[held][away]
    touched = ~(_flush(points, store) & (distance <= 2.0 * _ROUNDING_MM))
    wanted, over = _design_side(rays, tree, limits, threads)
    volumes = rays.volumes_mm3(store, limits.low_mm, limits.high_mm)
    return _Direction(points, near.distance_mm, facing * rays.area_mm2, touched, wanted, over, volumes)


def _design_side(rays: Rays, tree: ClosestPoints, limits: Limits, threads: int | None) -> tuple[FloatArray, FloatArray]:
    """Points of the design that rays meet steeply enough, and the excess at each of them."""
    wanted, _, _ = rays.points(rays.design)
    over = beyond(rays) if len(wanted) else np.empty(0)
    inside = limits.hold(wanted)
    wanted, over = wanted[inside], over[inside]
    facing = np.abs(tree.ask(wanted, threads).normals[:, rays.axis])
    seen = facing >= _FACING
    return wanted[seen], (over * facing)[seen]


def _flush(points: FloatArray, store: TriSlices) -> NDArray[np.bool_]:
    """Whether points lie on the faces of the stock's box."""
    low = np.abs(points - store.low_mm) <= _FLUSH_MM
    high = np.abs(points - store.high_mm) <= _FLUSH_MM
    return np.asarray(np.any(low | high, axis=1))


def _lost(points: FloatArray, wanted: FloatArray, over: FloatArray, least_mm: float) -> float:
    """Largest distance from a missing point of the design to the machined surface; see `Deviation.lost_mm`."""
    gone = wanted[over < -least_mm]
    if len(gone) == 0:
        return 0.0
    if len(points) == 0:
        return math.inf
    distance, _ = cKDTree(points).query(gone)
    worst = float(np.max(distance))
    return worst if worst > least_mm else 0.0
