"""A small mold: a block with a round-cornered pocket, an island in it and a side step, 40 x 30 x 12 mm."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from twin.arrays import FloatArray
from twin.moldmaking import MoldPlan, mold_from_dict
from twin.workpiece.solids.from_mesh import Solid, solid, stl_bytes

SIZE = (40.0, 30.0, 12.0)


def height(x: FloatArray, y: FloatArray) -> FloatArray:
    """Height of the mold's surface: a pocket with drafted walls and fillets, and a dome on its floor."""
    out = np.maximum(np.abs(x - 20.0) - 15.0, np.abs(y - 15.0) - 10.0)
    wall = np.clip(-8.0 - 8.0 * np.tanh(-2.0 * (out + 1.0) - 2.0), -8.0, 0.0)
    dome = -8.0 + 5.0 * np.exp(-((x - 22.0) ** 2 + (y - 15.0) ** 2) / 12.0)
    return np.where(out > 0.0, 0.0, np.maximum(wall, dome))


def height_solid(step: float = 0.5) -> Solid:
    """The closed solid under the surface."""
    x, y = np.arange(0.0, SIZE[0] + 1e-9, step), np.arange(0.0, SIZE[1] + 1e-9, step)
    gx, gy = np.meshgrid(x, y, indexing="ij")
    top = np.column_stack((gx.ravel(), gy.ravel(), height(gx, gy).ravel()))
    low = top * (1.0, 1.0, 0.0) - (0.0, 0.0, SIZE[2])
    nx, ny = len(x), len(y)
    index = np.arange(nx * ny).reshape(nx, ny)
    a, b, c, d = index[:-1, :-1].ravel(), index[1:, :-1].ravel(), index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    up = np.concatenate((np.column_stack((a, b, c)), np.column_stack((a, c, d))))
    rim = np.concatenate((index[:, 0], index[-1, 1:], index[-2::-1, -1], index[0, -2:0:-1]))
    after = np.roll(rim, -1)
    n = nx * ny
    sides = np.concatenate((np.column_stack((rim + n, after + n, after)), np.column_stack((rim + n, after, rim))))
    faces = np.concatenate((up, up[:, ::-1] + n, sides))
    return solid(np.vstack((top, low))[faces], "small mold")


@pytest.fixture(scope="session")
def small_mold() -> Solid:
    return height_solid()


@pytest.fixture(scope="session")
def mold_folder(tmp_path_factory: pytest.TempPathFactory, small_mold: Solid) -> Path:
    folder = tmp_path_factory.mktemp("mold")
    (folder / "part.stl").write_bytes(stl_bytes(small_mold.vertices_mm, small_mold.triangles))
    return folder


def tables() -> dict[str, Any]:
    """The job of the small mold."""
    common = {"spindle_rpm": 8000, "plunge_mm_min": 500, "link_mm_min": 3000}
    return {
        "part": {"stl": "part.stl"},
        "machine": {"clearance_mm": 0.3},
        "tools": [
            {"number": 1, "kind": "bull", "diameter_mm": 8.0, "corner_radius_mm": 1.0, "teeth": 3, "length_mm": 90.0}
            | {"flute_length_mm": 20.0},
            {"number": 2, "kind": "ball", "diameter_mm": 5.0, "teeth": 2, "flute_length_mm": 15.0, "length_mm": 95.0},
            {"number": 3, "kind": "ball", "diameter_mm": 4.0, "teeth": 2, "flute_length_mm": 15.0, "length_mm": 80.0},
        ],
        "rough": common
        | {"tool": 1, "feed_mm_min": 2000, "axial_depth_mm": 1.5, "radial_depth_mm": 3.5, "allowance_mm": 0.3},
        "semi": common
        | {"tool": 2, "feed_mm_min": 2000, "axial_depth_mm": 1.0, "radial_depth_mm": 1.8, "allowance_mm": 0.15},
        "finish": common | {"tool": 3, "feed_mm_min": 2500, "stepover_mm": 0.5, "steep_deg": 55.0},
        "output": {"dexel_mm": 0.2, "name": "small"},
    }


@pytest.fixture
def job_tables() -> dict[str, Any]:
    return tables()


@pytest.fixture(scope="session")
def plan(mold_folder: Path) -> MoldPlan:
    made = MoldPlan(mold_from_dict(tables(), mold_folder))
    _ = made.finish, made.raster_baseline
    return made


__all__ = ["SIZE", "height_solid", "tables"]
