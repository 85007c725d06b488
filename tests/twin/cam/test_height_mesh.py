"""Tiles of a height map: as near to the map as asked, closed, few triangles, and only those that changed are drawn."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from tests.support.drawn_part import Plan, raise_to
from twin.cam.stock.height_mesh import HeightTiles
from twin.cam.stock.height_mesh_kernels import CELLS, HeightMap

LIMIT = 0.02


def terrain(seed: int, tiles: int = 1) -> HeightMap:
    """A block with round and flat pockets and a slope; nodes are 1 mm apart."""
    random = np.random.default_rng(seed)
    x = np.arange(tiles * CELLS + 1.0)
    tops = np.full((len(x), len(x)), 10.0)
    for _ in range(6):
        cx, cy, radius, depth = random.uniform((0, 0, 3, 1), (x[-1], x[-1], 9, 8))
        far = np.hypot(x[:, None] - cx, x - cy)
        ball = 10.0 - depth + radius - np.sqrt(np.maximum(radius**2 - far**2, 0.0))
        below = np.where(far < radius, 10.0 - depth if random.random() < 0.5 else ball, 10.0)
        tops = np.minimum(tops, below)
    tops[:5] -= 0.3 * x
    return HeightMap(np.maximum(tops, 0.5), np.zeros_like(tops), x, x.copy())


def firsts(tiles: int) -> NDArray[np.int64]:
    """First nodes of all tiles."""
    return np.array([(CELLS * i, CELLS * j) for i in range(tiles) for j in range(tiles)])


@pytest.mark.parametrize("seed", range(4))
def test_the_surface_lies_as_near_to_the_map_as_asked(seed: int) -> None:
    heights = terrain(seed)
    plan = Plan((-0.5, -0.5), (CELLS + 0.5, CELLS + 0.5), 1.0)
    for limit in (0.0, LIMIT, 0.5):
        (mesh,) = HeightTiles(heights, firsts(1), limit).draw(np.array([0]))
        drawn = np.full_like(heights.tops, -np.inf)
        for corners in mesh.vertices_mm[mesh.triangles].astype(float):
            raise_to(drawn, plan, corners)
        assert np.abs(drawn - heights.tops).max() <= limit + 1e-5
        assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1.0, abs=1e-5)


def assert_closed(solid: trimesh.Trimesh) -> None:
    """Area vectors of a closed surface add up to nothing. (Long edges below meet several short ones of the walls.)"""
    assert (solid.face_normals * solid.area_faces[:, None]).sum(axis=0) == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("seed", range(4))
def test_one_tile_is_a_closed_solid(seed: int) -> None:
    heights = terrain(seed)
    (mesh,) = HeightTiles(heights, firsts(1), 0.0).draw(np.array([0]))
    solid = trimesh.Trimesh(mesh.vertices_mm, mesh.triangles)
    assert_closed(solid)
    corners = heights.tops
    cells = (corners[1:, 1:] + corners[1:, :-1] + corners[:-1, 1:] + corners[:-1, :-1]) / 4.0
    # each cell is two triangles: their mean height differs from that of its corners by its twist only
    twist = np.abs(corners[1:, 1:] + corners[:-1, :-1] - corners[1:, :-1] - corners[:-1, 1:]) / 12.0
    assert solid.volume == pytest.approx(cells.sum(), abs=twist.sum() + 1e-3)


def test_a_flat_tile_has_no_more_triangles_than_a_box() -> None:
    x = np.arange(CELLS + 1.0)
    flat = HeightMap(np.full((len(x), len(x)), 3.0), np.zeros((len(x), len(x))), x, x)
    (mesh,) = HeightTiles(flat, firsts(1), LIMIT).draw(np.array([0]))
    assert len(mesh.triangles) == 12
    assert trimesh.Trimesh(mesh.vertices_mm, mesh.triangles).volume == pytest.approx(3.0 * CELLS**2)


def test_where_there_is_no_material_there_is_no_surface() -> None:
    heights = terrain(1)
    heights.tops[:10] = heights.bottoms[:10] = 2.0
    (mesh,) = HeightTiles(heights, firsts(1), LIMIT).draw(np.array([0]))
    assert mesh.vertices_mm[:, 0].min() >= 9.0
    heights.tops[:] = heights.bottoms[:] = 2.0
    (mesh,) = HeightTiles(heights, firsts(1), LIMIT).draw(np.array([0]))
    assert len(mesh.vertices_mm) == len(mesh.triangles) == 0


def test_only_tiles_that_changed_visibly_are_drawn_again() -> None:
    heights = terrain(2, tiles=3)
    tiles = HeightTiles(heights, firsts(3), LIMIT)
    low, high = np.zeros(2), np.full(2, 3.0 * CELLS)
    assert len(tiles.changed(low, high)) == 0
    heights.tops[CELLS + 5, 5] -= 0.1  # in the tile of column 1, row 0
    heights.tops[2 * CELLS + 9, 2 * CELLS + 9] -= 0.1 * LIMIT  # too little to be seen
    assert tiles.changed(low, high).tolist() == [3]
    assert len(tiles.changed(np.full(2, 2.5 * CELLS), high)) == 0
    list(tiles.draw(np.array([3])))
    assert len(tiles.changed(low, high)) == 0
    heights.tops[CELLS, CELLS] -= 0.1  # a corner of four tiles
    assert tiles.changed(low, high).tolist() == [0, 1, 3, 4]


def test_tiles_may_reach_over_the_border() -> None:
    heights = terrain(3)
    where = np.array(
        [(-CELLS // 2, -CELLS // 2), (-CELLS // 2, CELLS // 2), (CELLS // 2, -CELLS // 2), (CELLS // 2,) * 2]
    )
    meshes = list(HeightTiles(heights, where, 0.0).draw(np.arange(4)))
    count = np.cumsum([0, *(len(m.vertices_mm) for m in meshes)])
    triangles = np.concatenate([m.triangles + first for m, first in zip(meshes, count, strict=False)])
    solid = trimesh.Trimesh(np.concatenate([m.vertices_mm for m in meshes]), triangles)
    (whole,) = HeightTiles(heights, firsts(1), 0.0).draw(np.array([0]))
    assert_closed(solid)
    assert solid.volume == pytest.approx(trimesh.Trimesh(whole.vertices_mm, whole.triangles).volume, rel=1e-6)
