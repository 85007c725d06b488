"""Unions of sweeps: cutting them at once leaves what cutting the sweeps one after the other does."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely

from twin.arrays import FloatArray
from twin.geometry.polygons.region import Region
from twin.motion.sweep import Body, Sweep
from twin.motion.union import SweepUnion
from twin.tools.shape import tool_shape
from twin.workpiece.removal import Removal
from twin.workpiece.stock import box_slices
from twin.workpiece.trislice import CellSlices, PolygonSlices, TriSlices

PITCH_MM, CHORD_MM = 0.4, 0.002
SHAPES = {
    "flat": tool_shape("flat", 6.0, 12.0),
    "ball": tool_shape("ball", 6.0, 12.0),
    "bull": tool_shape("bull", 6.0, 12.0, 1.0),
    "taper": tool_shape("taper", 4.0, 12.0, 0.5, 8.0),
}
T = np.linspace(0.0, 1.0, 41)
PATHS = {
    "waves": np.column_stack((6 + 12 * T, 10 + 2 * np.sin(5 * T), -2.5 + 1.5 * np.sin(9 * T))),
    "zigzag": np.column_stack((10 + 3 * np.sin(9 * T), 7 + 6 * T, -2 + 0.4 * np.cos(7 * T))),
    "lakes along y": np.column_stack((10 + 0 * T, 5 + 12 * T, -1 + 1.2 * np.cos(40 * T))),
    "lakes along x": np.column_stack((5 + 12 * T, 10 + 0 * T, -1 + 1.2 * np.cos(40 * T))),
    "level spiral": np.column_stack(
        (12 + (1 + 4 * T) * np.cos(20 * T), 10 + (1 + 4 * T) * np.sin(20 * T), -1.5 + 0 * T)
    ),
    "anywhere": 6 + 8 * np.random.default_rng(3).random((15, 3)) * [1, 1, 0.4] - [0, 0, 9.5],
    "up and down": np.column_stack((10 + 0 * T, 10 + 0 * T, -2 + 1.5 * np.cos(6 * T))),
}


def sweeps(kind: str, corners: FloatArray) -> list[Sweep]:
    body = Body.of(SHAPES[kind], chord_mm=CHORD_MM)
    return [Sweep(body, a, b) for a, b in pairwise(corners)]


def polygon(region: Region) -> shapely.Geometry:
    rings = [shapely.Polygon(ring).buffer(0) for ring in region.rings]
    found: shapely.Geometry = shapely.Polygon()
    for ring in rings:
        found = found.symmetric_difference(ring)
    return found


def cut(groups: list[list[Sweep]], store: type[TriSlices], pitch_mm: float = PITCH_MM) -> tuple[TriSlices, float]:
    """What is left of a block, and the volume that was taken."""
    workpiece = store(box_slices((0, 0, -6), (24, 20, 0), pitch_mm))
    with Removal(workpiece, CHORD_MM, 1) as removal:
        volumes = [removal.cut_all(removal.united(group)).sum() for group in groups if group]
    return workpiece, float(sum(volumes))


@pytest.mark.compiled
@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("path", PATHS)
def test_a_union_leaves_what_its_sweeps_leave(kind: str, path: str) -> None:
    each = sweeps(kind, PATHS[path])
    united, volume = cut([each[:15], each[15:16], each[16:]], CellSlices)
    alone, expected = cut([[sweep] for sweep in each], CellSlices)
    assert volume == pytest.approx(expected, rel=3e-4)
    for axis in range(3):
        for k in range(1, united.count(axis), 3):
            differs = polygon(united.region(axis, k)).symmetric_difference(polygon(alone.region(axis, k)))
            assert differs.buffer(-3.0 * CHORD_MM).area < 2.0 * PITCH_MM * CHORD_MM, (axis, k)
            assert differs.area < CHORD_MM * 200.0, (axis, k)


@pytest.mark.parametrize("kind", ["ball", "flat"])
def test_both_stores_cut_a_union_alike(kind: str) -> None:
    corners = PATHS["lakes along y"][:8]
    union = sweeps(kind, corners)
    cells, volume = cut([union], CellSlices, 1.5)
    polygons, expected = cut([union], PolygonSlices, 1.5)
    assert volume == pytest.approx(expected, rel=1e-4)
    for axis in range(3):
        assert cells.areas_mm2(axis) == pytest.approx(polygons.areas_mm2(axis), abs=0.02)


def test_a_level_straight_pass_in_many_pieces_has_the_exact_section() -> None:
    """A ball of radius R at depth h <= R: the section across the pass is a segment of a circle."""
    radius, depth = 3.0, 2.0
    corners = np.column_stack((np.linspace(2.0, 22.0, 41), np.full(41, 10.0), np.full(41, -depth)))
    workpiece, _ = cut([sweeps("ball", corners)], CellSlices)
    angle = math.acos(1.0 - depth / radius)
    segment = radius**2 * (angle - math.sin(angle) * math.cos(angle))
    k = workpiece.count(0) // 2
    assert 20.0 * 6.0 - workpiece.area_mm2(0, k) == pytest.approx(segment, rel=2e-3)


def test_the_start_of_a_union_that_has_been_cut_is_not_cut_again() -> None:
    each = sweeps("ball", PATHS["waves"][:10])
    workpiece = CellSlices(box_slices((0, 0, -6), (24, 20, 0), PITCH_MM))
    with Removal(workpiece, CHORD_MM, 1) as removal:
        removal.cut_all(removal.united(each[:5]))
        edges = sum(len(r.rings) for r in (workpiece.region(0, k) for k in range(workpiece.count(0))))
        removal.cut_all(removal.united(each[5:]))
        again = removal.cut_all(removal.united(each)).sum()
    assert edges > 0
    assert again == pytest.approx(0.0, abs=0.02)


def test_sweeps_far_from_each_other_and_long_ones_are_not_united() -> None:
    near = np.column_stack((np.linspace(2.0, 4.0, 5), np.full(5, 5.0), np.full(5, -1.0)))
    first, then = sweeps("ball", near), sweeps("ball", near + np.array((60.0, 0.0, 0.0)))
    long = sweeps("ball", np.array([near[-1], near[-1] + np.array((40.0, 0.0, 0.0))]))
    with Removal(CellSlices(box_slices((0, 0, -6), (80, 10, 0), 2.0)), CHORD_MM, 1) as removal:
        apart = removal.united([*first, *then])
        assert [len(u.starts_mm) for u in apart if isinstance(u, SweepUnion)] == [4, 4]
        assert removal.united([*first, *long])[1:] == long


def test_short_flutes_are_cut_one_by_one() -> None:
    body = Body.of(tool_shape("flat", 6.0, 1.0), chord_mm=CHORD_MM)
    corners = np.column_stack((np.linspace(6.0, 9.0, 5), np.full(5, 10.0), np.full(5, -3.0)))
    each = [Sweep(body, a, b) for a, b in pairwise(corners)]
    with Removal(CellSlices(box_slices((0, 0, -6), (24, 20, 0), 1.0)), CHORD_MM, 1) as removal:
        assert removal.united(each) == each
    assert not SweepUnion.of(each).reaches_above(0.0)
