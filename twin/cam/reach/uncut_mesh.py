"""Uncut material as triangles: every piece of a slice as a prism over the slab that it represents."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from twin.arrays import FloatArray
from twin.cam.reach.uncut_regions import UncutRegion
from twin.geometry.polygons.pieces import prism_parts
from twin.geometry.polygons.shapes import Shape
from twin.workpiece.store import PLANE_AXES
from twin.workpiece.to_mesh import SurfaceMesh


def uncut_mesh(regions: Iterable[UncutRegion]) -> SurfaceMesh:
    """Regions as closed prisms that touch each other along the slices' borders; for viewers and other programs."""
    corners = [
        _prism(piece, float(low), float(high), region.axis)
        for region in regions
        for piece, (low, high) in zip(region.pieces, region.slabs_mm, strict=True)
    ]
    triangles = np.concatenate(corners) if corners else np.empty((0, 3, 3))
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    size = np.linalg.norm(cross, axis=1, keepdims=True)
    normals = np.repeat(cross / np.where(size > 0.0, size, 1.0), 3, axis=0)
    return SurfaceMesh(triangles.reshape(-1, 3), normals, np.arange(3 * len(triangles)).reshape(-1, 3))


def _prism(piece: Shape, low: float, high: float, axis: int) -> FloatArray:
    """Triangles of one piece between two planes, counter-clockwise seen from outside, shape (n, 3, 3)."""
    caps, edges = prism_parts(piece)
    a, b = edges[:, 0], edges[:, 1]
    below, above = _at(a, low, axis), _at(a, high, axis)
    next_below, next_above = _at(b, low, axis), _at(b, high, axis)
    sides = np.concatenate(
        (np.stack((below, next_below, next_above), axis=1), np.stack((below, next_above, above), axis=1))
    )
    found = np.concatenate((_at(caps, high, axis), _at(caps, low, axis)[:, ::-1], sides))
    # (u, v, normal) is left-handed for planes across y
    return found[:, ::-1] if (PLANE_AXES[axis][0] + 1) % 3 != PLANE_AXES[axis][1] else found


def _at(points: FloatArray, plane: float, axis: int) -> FloatArray:
    """Points of a plane in (x, y, z)."""
    space = np.full((*points.shape[:-1], 3), plane)
    space[..., list(PLANE_AXES[axis])] = points
    return space
