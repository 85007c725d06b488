"""The only door to pyclipper: Boolean operations on integer coordinates, rounded in and out here and nowhere else."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeAlias

import numpy as np
import pyclipper
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.geometry.polygons.region import Region

Paths: TypeAlias = list[list[list[int]]]

#: Integer units per mm: 1e-7 mm a unit keeps coordinates up to 4e11 mm inside pyclipper's range of +-4e18.
UNITS_PER_MM = 1e7
#: Vertices of resulting regions are rounded to this many decimals of a mm (the tri-slice paper, section 2.1).
DECIMALS = 5
#: Rings below this area result from rounding.
LEAST_AREA_MM2 = 1e-9


def to_paths(rings: Iterable[FloatArray]) -> Paths:
    """Rings in mm to pyclipper's integer paths, rounded (pyclipper itself would truncate)."""
    return [np.rint(np.asarray(r) * UNITS_PER_MM).astype(np.int64).tolist() for r in rings]


def to_region(paths: Paths) -> Region:
    """Integer paths, outer ones counter-clockwise, to a region with vertices rounded to 1e-5 mm."""
    rings = []
    for path in paths:
        points = np.round(np.array(path, dtype=np.float64) / UNITS_PER_MM, DECIMALS)
        points = points[np.any(points != np.roll(points, 1, axis=0), axis=1)]
        if len(points) >= 3 and abs(pyclipper.Area(path)) > LEAST_AREA_MM2 * UNITS_PER_MM**2:
            rings.append(points)
    return Region.of(*rings)


def difference(subject: Paths, clips: Paths) -> Paths:
    """A set of paths without others (even-odd subject, non-zero clips)."""
    if not subject:
        return []
    clipper = pyclipper.Pyclipper()
    if not _add(clipper, subject, pyclipper.PT_SUBJECT):
        return []
    _add(clipper, clips, pyclipper.PT_CLIP)
    return _run(clipper, pyclipper.CT_DIFFERENCE, pyclipper.PFT_EVENODD)


def union_nonzero(rings: Sequence[FloatArray]) -> Region:
    """Union of closed polylines by non-zero winding: solids that overlap count once, inside-out rings cancel."""
    clipper = pyclipper.Pyclipper()
    if not _add(clipper, to_paths(rings), pyclipper.PT_SUBJECT):
        return Region()
    return to_region(_run(clipper, pyclipper.CT_UNION, pyclipper.PFT_NONZERO))


def union_convex(quads: FloatArray) -> Region:
    """Union of many quadrilaterals that touch along their sides.

    Args:
        quads: shape (n, 4, 2), counter-clockwise.
    """
    clipper = pyclipper.Pyclipper()
    whole: NDArray[np.int64] = np.rint(quads * UNITS_PER_MM).astype(np.int64)
    if not _add(clipper, whole.tolist(), pyclipper.PT_SUBJECT):
        return Region()
    return to_region(_run(clipper, pyclipper.CT_UNION, pyclipper.PFT_NONZERO))


def area_mm2(paths: Paths) -> float:
    """Area of paths, holes (clockwise) negative."""
    return float(sum(pyclipper.Area(p) for p in paths)) / UNITS_PER_MM**2


def inside(paths: Paths, u_mm: float, v_mm: float) -> bool:
    """Whether a point lies in the material of even-odd paths; points on a ring count as inside."""
    point = (round(u_mm * UNITS_PER_MM), round(v_mm * UNITS_PER_MM))
    hits = [pyclipper.PointInPolygon(point, p) for p in paths]
    return any(h == -1 for h in hits) or sum(h == 1 for h in hits) % 2 == 1


def _add(clipper: pyclipper.Pyclipper, paths: Paths, kind: int) -> bool:
    """Add paths one by one: pyclipper refuses a whole list when one of its paths has no area."""
    added = False
    for path in paths:
        if len(path) >= 3 and pyclipper.Area(path) != 0:
            clipper.AddPath(path, kind, True)
            added = True
    return added


def _run(clipper: pyclipper.Pyclipper, operation: int, filling: int) -> Paths:
    result: Paths = clipper.Execute(operation, filling, pyclipper.PFT_NONZERO)
    return result
