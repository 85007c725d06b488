"""The example's mold: closed, without undercuts, of the size and number of triangles that were asked for."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from twin.workpiece.solids.from_mesh import load_mesh

SCRIPT = Path(__file__).parents[3] / "examples" / "mold" / "make_mold.py"


@pytest.fixture(scope="module")
def maker() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_mold", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("count", [5_000, 40_000])
def test_the_mold_is_a_solid_without_undercuts(maker: ModuleType, tmp_path: Path, count: int) -> None:
    triangles = maker.mold_triangles(count)
    assert len(triangles) == pytest.approx(count, rel=0.15)
    maker.write_stl(tmp_path / "mold.stl", triangles)
    solid = load_mesh(tmp_path / "mold.stl")
    assert solid.vertices_mm.min(axis=0) == pytest.approx((0.0, 0.0, -35.0))
    assert solid.vertices_mm.max(axis=0) == pytest.approx((100.0, 80.0, 0.0), abs=1e-4)
    assert solid.volume_mm3 == pytest.approx(168_600.0, rel=2e-3)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    down = triangles[normal[:, 2] < 0.0]
    assert (down[:, :, 2] == -35.0).all()


def test_walls_have_draft_and_fillets(maker: ModuleType) -> None:
    out = np.linspace(-10.0, 10.0, 4001)
    wall = maker.wall(out, 8.0, 2.0, 1.0)
    assert wall[0] == 8.0
    assert wall[-1] == 0.0
    slope = np.diff(wall) / np.diff(out)
    assert slope.min() == pytest.approx(-1.0 / np.tan(np.radians(5.0)), rel=1e-6)
    assert (slope <= 1e-12).all()
