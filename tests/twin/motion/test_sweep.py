"""Sections of swept tools against the tool itself, placed at many positions along its way."""

from __future__ import annotations

import os
from itertools import pairwise

import numpy as np
import pytest
import shapely

from twin.arrays import FloatArray
from twin.geometry.column_cells.strips import Tops
from twin.motion.sweep import Body, Sweep, SweptVolume
from twin.motion.swept_kernels import Fronts
from twin.tools.shape import ToolKind, ToolShape, tool_shape

SHAPES = {
    "ball": tool_shape("ball", 8.0, 6.0),
    "flat": tool_shape("flat", 6.0, 5.0),
    "bull": tool_shape("bull", 8.0, 6.0, corner_radius_mm=1.5),
    "taper": tool_shape("taper", 3.0, 8.0, corner_radius_mm=1.0, taper_deg=8.0),
    "cone": tool_shape("taper", 3.0, 8.0, taper_deg=8.0),
}
MOVES = [(0, 0, 0), (3, 0, 0), (2, 1.3, 0), (0, 0, -2.5), (2, 1, -0.7), (0.05, 0.08, 0.01), (-1, 2, 2)]
CHORD_MM = 0.001
POSITIONS = 41 if os.environ.get("NUMBA_DISABLE_JIT") == "1" else 401
SAMPLES = 800


def in_tool(shape: ToolShape, tips: FloatArray, points: FloatArray, margin: float) -> np.ndarray:
    """Membership straight from the meridian, ``margin`` larger all around, shape (points, tips)."""
    x, y, height = np.moveaxis(points[:, None] - tips, 2, 0)
    radius = shape.radius_mm(np.clip(height + margin, 0.0, shape.height_mm)) + margin
    return (height >= -margin) & (height <= shape.height_mm + margin) & (np.hypot(x, y) <= radius)


def in_sweep(shape: ToolShape, start: FloatArray, end: FloatArray, points: FloatArray, margin: float) -> np.ndarray:
    """Membership in the tool at any of many positions; points out of the way of all of them are passed over."""
    tips = np.unique(start + np.linspace(0.0, 1.0, POSITIONS)[:, None] * (end - start), axis=0)
    reach = np.array([shape.max_radius_mm, shape.max_radius_mm, 0.0]) + margin
    low, high = tips.min(axis=0) - reach, tips.max(axis=0) + reach + (0.0, 0.0, shape.height_mm)
    found = np.all((points >= low) & (points <= high), axis=1)
    found[found] = in_tool(shape, tips, points[found], margin).any(axis=1)
    return found


def test_a_steep_sharp_cone_is_cut_to_both_ends_of_its_level_sections() -> None:
    body = Body.of(tool_shape("taper", 6.0, 12.0, taper_deg=20.0), chord_mm=CHORD_MM)
    start = np.array([-2.671039634602913, -1.644539032517425, 1.9505112425555309])
    end = start + np.array([-5.407184761472628, -0.447330104604893, -47.604539067334755])
    sweep = Sweep(body, start, end)
    strips = sweep.strips(2, -28.0, 0.1, 12, CHORD_MM)
    widths = [float(np.ptp(strips.nodes[a:b, 0])) for a, b in pairwise(strips.offsets.tolist())]
    assert np.ptp(widths) < 1e-6  # all of them hold the largest section of the cone


@pytest.mark.parametrize("move", MOVES)
@pytest.mark.parametrize("kind", SHAPES)
def test_sections_hold_the_swept_tool_and_little_more(kind: str, move: tuple[float, float, float]) -> None:
    shape = SHAPES[kind]
    rng = np.random.default_rng(5)
    start = rng.uniform(-1.0, 1.0, 3)
    end = start + np.array(move)
    sweep = Sweep(Body.of(shape, chord_mm=CHORD_MM), start, end)
    between = np.linalg.norm(move) / (POSITIONS - 1)
    for axis in range(3):
        strips = sweep.strips(axis, -12.03, 1.97, 14, CHORD_MM)
        u_axis, v_axis = [a for a in range(3) if a != axis]
        for i in range(len(strips.at)):
            points = rng.uniform(-8.0, 10.0, (SAMPLES, 3))
            points[:, axis] = -12.03 + (strips.at[i] + 0.5) * 1.97
            outline = strips.outline(i)
            inside = np.zeros(SAMPLES, dtype=bool)
            if outline is not None:
                inside = shapely.contains_xy(shapely.Polygon(outline), points[:, u_axis], points[:, v_axis])
            assert not np.any(in_sweep(shape, start, end, points[~inside], 0.0))
            assert np.all(in_sweep(shape, start, end, points[inside], 2.5 * CHORD_MM + between))


@pytest.mark.parametrize("move", MOVES)
@pytest.mark.parametrize("kind", SHAPES)
def test_points_in_the_sweep_are_cleared_and_others_are_not(kind: str, move: tuple[float, float, float]) -> None:
    shape = SHAPES[kind]
    rng = np.random.default_rng(6)
    start = rng.uniform(-1.0, 1.0, 3)
    end = start + np.array(move)
    between = np.linalg.norm(move) / (POSITIONS - 1)
    points = rng.uniform((-6.0, -6.0, -4.0), (8.0, 8.0, 9.0), (SAMPLES, 3))
    left = np.ones(SAMPLES, dtype=bool)
    SweptVolume([Sweep(Body.of(shape), start, end)]).clear(points, left, 0.0)
    assert not np.any(in_sweep(shape, start, end, points[left], -1e-9))
    assert np.all(in_sweep(shape, start, end, points[~left], 1e-9 + between))


def test_volume_of_a_ball_sweep_is_the_closed_form() -> None:
    """Ball R4 swept 10 mm sideways, up to the height of its centre: half a cylinder and two quarter spheres."""
    shape = tool_shape("ball", 8.0, 4.0)
    sweep = Sweep(Body.of(shape, chord_mm=1e-4), np.zeros(3), np.array([6.0, 8.0, 0.0]))
    exact = np.pi / 2.0 * 16.0 * 10.0 + 2.0 / 3.0 * np.pi * 64.0
    for axis in range(3):
        strips = sweep.strips(axis, -10.0, 0.05, 600, 1e-4)
        outlines = [strips.outline(i) for i in range(len(strips.at))]
        area = sum(shapely.Polygon(o).area for o in outlines if o is not None)
        assert area * 0.05 == pytest.approx(exact, rel=3e-4)


def test_a_tool_exactly_on_a_plane_is_cut_by_it() -> None:
    """The tip's plane and the top's plane are planes of the slices: the sections are there or empty, never wrong."""
    sweep = Sweep(Body.of(SHAPES["flat"], chord_mm=CHORD_MM), np.zeros(3), np.array([1.0, 0.0, 0.0]))
    strips = sweep.strips(2, -0.5, 1.0, 12, CHORD_MM)
    areas = [0.0 if (o := strips.outline(i)) is None else shapely.Polygon(o).area for i in range(len(strips.at))]
    assert strips.at[0] == 0
    assert areas == pytest.approx([9.0 * np.pi + 6.0] * 6, rel=1e-3)


def test_a_body_standing_over_the_tip_is_moved_up() -> None:
    shank = ToolShape(disc_mm=2.0, corner_radius_mm=0.0, height_mm=5.0)
    sweep = Sweep(Body.of(shank, above_tip_mm=10.0), np.zeros(3), np.zeros(3))
    low, high = sweep.bounds_mm
    assert low.tolist() == [-2.0, -2.0, 10.0]
    assert high.tolist() == [2.0, 2.0, 15.0]
    left = np.ones(3, dtype=bool)
    SweptVolume([sweep]).clear(np.array([(0.0, 0.0, 9.0), (0.0, 1.0, 12.0), (0.0, 0.0, 16.0)]), left, 0.0)
    assert left.tolist() == [True, False, True]


def test_the_part_that_a_motion_adds_next_to_the_flat_bottom_of_its_start_is_cut() -> None:
    body = Body.of(tool_shape("taper", 10.0, 22.0, taper_deg=15.0), chord_mm=0.002)
    sweep = Sweep(body, np.array([4.902, 9.094, 0.0]), np.array([-0.453, 0.0, 0.0]))
    one_plane = (0, -0.2, 0.4, 1, 0.002)
    whole, added = sweep.strips(*one_plane), sweep.strips(*one_plane, start_is_cut=True)
    u = np.linspace(9.7, 12.0, 24)
    lo, lo_added = (np.interp(u, s.nodes[:, 0], s.nodes[:, 1]) for s in (whole, added))
    start = Sweep(body, sweep.start_mm, sweep.start_mm).strips(*one_plane)
    lo_start = np.interp(u, start.nodes[:, 0], start.nodes[:, 1])
    assert np.max(lo_start - lo) > 0.4  # the motion adds this much below the section at its start
    assert np.max(np.minimum(lo_start, lo_added) - lo) < 0.01


def test_sections_are_refined_only_where_there_is_material_in_the_way() -> None:
    sweep = Sweep(Body.of(tool_shape("ball", 3.0, 8.0)), np.array([0.0, 0.0, 0.0]), np.array([0.05, 0.02, -0.01]))
    planes = (-5.0, 0.5, 20, 0.001)
    plain = sweep.strips(0, *planes)
    _, count = sweep.planes_met(0, *planes[:3])
    for height, nodes in ((10.0, len(plain.nodes)), (-1.0, 0)):
        tops = Tops(np.full((count, 8), height), -4.0, 1.0)
        assert len(sweep.strips(0, *planes, tops=tops).nodes) == nodes
    heights = np.full((count, 8), -1.0)
    heights[:, 5] = 10.0
    found = sweep.strips(0, *planes, tops=Tops(heights, -4.0, 1.0))
    assert 0 < len(found.nodes) < len(plain.nodes)
    # over the material the strips are as without that knowledge
    kept = {tuple(node) for node in found.nodes.tolist()}
    assert {tuple(node) for node in plain.nodes.tolist() if 1.0 <= node[0] <= 2.0} <= kept


@pytest.mark.parametrize("kind", ["flat", "ball", "bull", "taper"])
def test_sweeps_behind_the_tangent_plane_of_a_point_are_not_looked_at_and_do_not_hold_it(kind: ToolKind) -> None:
    shape = tool_shape(kind, 4.0, 8.0, 1.0, 8.0)
    body, tip = Body.of(shape, chord_mm=0.001), np.array((3.0, 2.0, -1.0))
    angle, z = (a.ravel() for a in np.meshgrid(np.arange(0.0, 6.0, 0.7), np.arange(0.1, 6.0, 1.4)))
    radius = shape.radius_mm(z)
    points = tip + np.column_stack((radius * np.cos(angle), radius * np.sin(angle), z))
    before = [Sweep(body, tip - (1.0, 0.3 - 0.2 * i, 0.02), tip - (0.1, 0.1, 0.01)) for i in range(3)]
    fronts = Fronts(shape.meridian, tip[None, :], np.zeros(len(points), dtype=np.int32))
    left = [np.ones(len(points), dtype=np.bool_) for _ in range(2)]
    SweptVolume(before, [0.0011] * 3).clear(points, left[0], 0.0, None, fronts)
    SweptVolume(before).clear(points, left[1], 0.0)
    assert np.array_equal(left[0], left[1])
    assert left[0].any()
    assert not left[0].all()
    assert not np.any(left[0][np.cos(angle) < -0.9])
