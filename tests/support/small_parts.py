"""Small solids as triangles: prisms along y from a profile, boxes, and their STL files."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import mapbox_earcut
import numpy as np

from twin.arrays import FloatArray
from twin.workpiece.solids.from_mesh import Solid, solid, stl_bytes

Profile = Sequence[tuple[float, float]]


def prism_corners(profile: Profile, low_y: float, high_y: float) -> FloatArray:
    """Triangles of a simple polygon (x, z), counter-clockwise seen from -y, drawn along y; shape (m, 3, 3)."""
    points = np.array(profile, dtype=np.float64)
    caps = mapbox_earcut.triangulate_float64(points, np.array([len(points)], dtype=np.uint32)).reshape(-1, 3)
    front = np.column_stack((points[:, 0], np.full(len(points), low_y), points[:, 1]))
    back = front + np.array([0.0, high_y - low_y, 0.0])
    after = np.roll(np.arange(len(points)), -1)
    one = np.stack((front, back[after], front[after]), axis=1)
    two = np.stack((front, back, back[after]), axis=1)
    cap = front[caps]
    turned = np.cross(cap[:, 1] - cap[:, 0], cap[:, 2] - cap[:, 0])[:, 1] > 0.0
    cap[turned] = cap[turned][:, ::-1]
    far = cap[:, ::-1] + np.array([0.0, high_y - low_y, 0.0])
    return np.concatenate((one, two, cap, far))


def prism(profile: Profile, low_y: float, high_y: float, name: str = "prism") -> Solid:
    """The same as a checked solid."""
    return solid(prism_corners(profile, low_y, high_y), name)


def box(low: Sequence[float], high: Sequence[float]) -> Solid:
    """A box."""
    profile = [(low[0], low[2]), (high[0], low[2]), (high[0], high[2]), (low[0], high[2])]
    return prism(profile, low[1], high[1], "box")


def pocket(half: float, inner: float, floor: float, bottom: float) -> Solid:
    """A square block, its top at 0, with a square pocket in its middle; half sides, heights below 0."""
    corners = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])

    def ring(size: float, z: float) -> FloatArray:
        return np.column_stack((size * corners, np.full(4, z)))

    def between(a: FloatArray, b: FloatArray) -> list[FloatArray]:
        after = [1, 2, 3, 0]
        return [np.stack((a, a[after], b[after]), axis=1), np.stack((a, b[after], b), axis=1)]

    def cap(a: FloatArray) -> FloatArray:
        return np.array([[a[0], a[1], a[2]], [a[0], a[2], a[3]]])

    low, top, mouth, deep = ring(half, bottom), ring(half, 0.0), ring(inner, 0.0), ring(inner, floor)
    faces = [*between(low, top), *between(top, mouth), *between(mouth, deep), cap(deep), cap(low)[:, ::-1]]
    return solid(np.concatenate(faces), "pocket")


def write_stl(path: Path, part: Solid) -> Path:
    """A solid as a binary STL file."""
    path.write_bytes(stl_bytes(part.vertices_mm, part.triangles))
    return path


def torus_module() -> Any:
    """The generator of the torus example."""
    file = Path(__file__).parents[2] / "examples" / "torus" / "make_torus.py"
    spec = importlib.util.spec_from_file_location("make_torus", file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    import sys

    sys.modules["make_torus"] = module
    spec.loader.exec_module(module)
    return module


def small_torus() -> Solid:
    """A torus on a plate of 22 x 22 mm: tube 2 mm, outer fillet 1.5 mm, inner fillet 1 mm."""
    make = torus_module()
    profile = make.Profile(ring_mm=6.0, tube_mm=2.0, outer_mm=1.5, inner_mm=1.0, half_mm=11.0, thick_mm=2.0)
    return solid(make.torus(128, 48, profile), "small torus")
