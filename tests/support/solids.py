"""Solids for tests, as loose triangles: closed forms are known of all of them."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np
import trimesh

from twin.arrays import FloatArray
from twin.workpiece.solids.from_mesh import Solid, solid


def box(low: Sequence[float], high: Sequence[float]) -> FloatArray:
    """A box's triangles, shape (12, 3, 3)."""
    mesh = trimesh.creation.box(bounds=np.array([low, high], dtype=np.float64))
    return np.asarray(mesh.triangles)


def sphere(radius: float, finer: int = 4) -> FloatArray:
    """A sphere about the origin, 20 * 4^finer triangles with their corners on it."""
    return np.asarray(trimesh.creation.icosphere(subdivisions=finer, radius=radius).triangles)


def pocket(side: float = 10.0, deep: float = 6.0, wall: float = 8.0) -> FloatArray:
    """A square block with a square pocket from above; its top is at z = 0."""
    half, out = 0.5 * side, 0.5 * side + wall
    return prism([(-out, -out), (out, -out), (out, out), (-out, out)], [(-half, -half), (half, half)], deep, deep + 4.0)


def prism(
    outer: Sequence[tuple[float, float]], hole: Sequence[tuple[float, float]], deep: float, high: float
) -> FloatArray:
    """A block between z = -high and 0 with a rectangular pocket (its low and high corner) of some depth."""
    (u0, v0), (u1, v1) = hole
    inner = [(u0, v0), (u1, v0), (u1, v1), (u0, v1)]
    made = []
    for k in range(4):
        a, b, c, d = outer[k], outer[(k + 1) % 4], inner[k], inner[(k + 1) % 4]
        made += _quad((*a, 0.0), (*b, 0.0), (*d, 0.0), (*c, 0.0))
        made += _quad((*b, -high), (*b, 0.0), (*a, 0.0), (*a, -high))
        made += _quad((*c, -deep), (*c, 0.0), (*d, 0.0), (*d, -deep))
    made += _quad(*((*p, -deep) for p in inner))
    made += _quad(*((*p, -high) for p in reversed(outer)))
    return np.array(made)


def _quad(a, b, c, d):  # type: ignore[no-untyped-def]
    return [(a, b, c), (a, c, d)]


def turned(triangles: FloatArray, degrees: float, axis: Sequence[float]) -> FloatArray:
    """Triangles turned about an axis through the origin."""
    matrix = trimesh.transformations.rotation_matrix(np.radians(degrees), axis)[:3, :3]
    return np.asarray(triangles @ matrix.T)


@cache
def torus_example() -> ModuleType:
    """The module that makes the torus example's part."""
    path = Path(__file__).parents[2] / "examples" / "torus" / "make_torus.py"
    spec = importlib.util.spec_from_file_location("make_torus", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    import sys

    sys.modules["make_torus"] = module
    spec.loader.exec_module(module)
    return module


@cache
def torus(around: int = 512, along: int = 160) -> Solid:
    """The torus example's part."""
    return solid(torus_example().torus(around, along), "torus")


def extruded(outline: FloatArray, low: float = -6.0, high: float = 6.0) -> FloatArray:
    """An outline in (x, z), counter-clockwise seen from -y, drawn from y = low to y = high."""
    import shapely

    flat = shapely.get_parts(shapely.constrained_delaunay_triangles(shapely.polygons(outline)))
    caps = shapely.get_coordinates(shapely.orient_polygons(flat)).reshape(-1, 4, 2)[:, :3]

    def at(points: FloatArray, y: float) -> FloatArray:
        return np.stack((points[..., 0], np.full(points.shape[:-1], y), points[..., 1]), axis=-1)

    after = np.roll(outline, -1, axis=0)
    a, b, c, d = at(outline, low), at(after, low), at(after, high), at(outline, high)
    sides = np.concatenate((np.stack((a, c, b), axis=1), np.stack((a, d, c), axis=1)))
    return np.concatenate((at(caps, low), at(caps, high)[:, ::-1], sides))
