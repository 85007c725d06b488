"""The check of a path on the triangles: depth and position of gouges of known depth."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from twin.cam.path.toolpath import Move, MoveKind, ToolPath
from twin.cam.surface.surface import Surface, surface_of
from twin.planning.gouges import deepest_gouge
from twin.tools.text import parse_tool


def step() -> Surface:
    """A floor at z = 0 with an upright wall at x = 5, 8 mm high."""
    boxes = [trimesh.creation.box(bounds=b) for b in (((-10, -10, -2), (10, 10, 0)), ((5, -10, 0), (10, 10, 8)))]
    return surface_of(np.concatenate([np.array(b.triangles) for b in boxes]))


def path(tool: str, *points: tuple[float, float, float]) -> ToolPath:
    return ToolPath(
        moves=(Move(kind=MoveKind.CUT, points_mm=np.array(points), feed_mm_min=600.0),), tool=parse_tool(tool)
    )


@pytest.mark.parametrize("allowance", [0.0, 0.3])
@pytest.mark.parametrize("tool", ["ball 4", "flat 4", "bull 4 r0.01"])
@pytest.mark.parametrize(
    ("points", "depth", "at"),
    [
        (((-5, 0, 0), (-5, 3, -0.05), (-5, 6, 0)), 0.05, (-5, 3, -0.05)),
        (((3.0, -3, 2), (3.04, 0, 2), (3.0, 3, 2)), 0.04, (3.04, 0, 2)),
    ],
    ids=["into the floor", "into the wall"],
)
def test_depth_and_position_of_a_gouge(
    tool: str, allowance: float, points: tuple[tuple[float, float, float], ...], depth: float, at: tuple[float, ...]
) -> None:
    """Depths are normal to the surface, and count from the allowance."""
    moved = path(tool, *((x - allowance, y, z + allowance) for x, y, z in points))
    found = deepest_gouge(moved, step(), allowance, 0.01)
    assert found is not None
    assert found.depth_mm == pytest.approx(depth, rel=0.025)
    shift = np.array([-allowance, 0.0, allowance])
    assert found.point_mm == pytest.approx(shift + at, abs=0.15)
    assert deepest_gouge(moved, step(), allowance, depth * 1.001) is None
