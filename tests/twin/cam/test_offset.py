"""Offsets of slices against closed forms, whatever the direction of the slices."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from support import solids

from twin.cam.slices.offset import bound_mm, inflate, inflate_individually, shrink
from twin.cam.slices.sections import SlicedPart, slice_part
from twin.cam.slices.structuring_element import StructuringElement
from twin.errors import ToolError
from twin.geometry.polygons import convolution
from twin.geometry.polygons.region import Region
from twin.geometry.polygons.shapes import to_shape, to_shapes
from twin.tools.text import parse_tool
from twin.workpiece.solids.from_mesh import solid
from twin.workpiece.stock import SliceSet

RADIUS = 3.0
BALL = StructuringElement.ball(RADIUS)


def part_of(triangles: np.ndarray, pitch_mm: float) -> SlicedPart:
    return slice_part(solid(triangles, "test"), pitch_mm)


def volumes(slices: SliceSet) -> list[float]:
    return [
        sum(r.area_mm2 for r in family) * float(pitch)
        for family, pitch in zip(slices.regions, slices.pitch_mm, strict=True)
    ]


def areas(slices: SliceSet, axis: int) -> np.ndarray:
    return np.array([r.area_mm2 for r in slices.regions[axis]])


def test_an_inflated_box_has_steiners_volume_in_every_direction() -> None:
    a, b, c = 10.0, 8.0, 6.0
    part = part_of(solids.box((0, 0, 0), (a, b, c)), 0.2)
    exact = a * b * c + 2.0 * RADIUS * (a * b + b * c + c * a) + math.pi * RADIUS**2 * (a + b + c)
    exact += 4.0 / 3.0 * math.pi * RADIUS**3
    surface = 2.0 * (a * b + b * c + c * a) + 2.0 * math.pi * RADIUS * (a + b + c) + 4.0 * math.pi * RADIUS**2
    for volume in volumes(inflate(part, BALL)):
        assert abs(volume - exact) <= surface * bound_mm(BALL, 0.2) + 0.001 * exact
        assert abs(volume / exact - 1.0) < 1.5e-3


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_sections_of_an_inflated_sphere_are_discs_inside_of_the_true_ones_by_no_more_than_the_bound(axis: int) -> None:
    radius, pitch = 5.0, 0.2
    part = part_of(solids.sphere(radius, 5), pitch)
    grown = inflate(part, BALL, axes=(axis,))
    at = grown.positions_mm(axis)
    facets = 0.006
    for k in np.flatnonzero(np.abs(at) < 0.9 * (radius + RADIUS)):
        exact = math.sqrt((radius + RADIUS) ** 2 - at[k] ** 2)
        slope = math.acos(abs(at[k]) / (radius + RADIUS))
        found = math.sqrt(grown.regions[axis][k].area_mm2 / math.pi)
        assert found <= exact + 1e-5
        # the bound is one of the normal distance; along the plane it is larger
        assert exact - found <= (bound_mm(BALL, pitch, slope) + facets) / math.sin(slope)


def test_faces_across_the_slices_are_exact() -> None:
    part = part_of(solids.box((0, 0, 0), (10, 10, 5)), 0.3)
    grown = inflate(part, BALL, axes=(2,))
    at, area = grown.positions_mm(2), areas(grown, 2)
    middle = (at > -RADIUS) & (at < 5.0 + RADIUS)
    assert (area[middle] > 100.0).all() and (area[~middle] == 0.0).all()
    bare = inflate(part.slices, BALL, axes=(2,))
    short = math.sqrt(RADIUS**2 - (RADIUS - 0.15 + 0.05) ** 2)
    assert areas(bare, 2).sum() < area.sum() - short


def test_shrinking_an_inflated_convex_part_gives_the_part_back() -> None:
    part = part_of(solids.turned(solids.box((-5, -4, -3), (5, 4, 3)), 30.0, (1, 2, 3)), 0.25)
    back = shrink(inflate(part, BALL), BALL)
    own = part.slices
    for axis in range(3):
        shift = round(float((own.low_mm - back.low_mm)[axis] / own.pitch_mm[axis]))
        for k, region in enumerate(own.regions[axis]):
            one, other = to_shape(region), to_shape(back.regions[axis][k + shift])
            # nothing of the part is lost but what the inflated part lacks, and nothing is added beyond half a pitch
            assert shapely.difference(one, shapely.buffer(other, 0.02)).area < 1e-9
            assert shapely.difference(other, shapely.buffer(one, 0.25)).area < 1e-9
        assert areas(back, axis).sum() == pytest.approx(areas(own, axis).sum(), rel=0.012)


def test_what_an_inflated_part_lacks_falls_with_the_square_of_the_pitch() -> None:
    triangles = solids.turned(solids.sphere(5.0, 4), 20.0, (1, 1, 0))
    fine = volumes(inflate(part_of(triangles, 0.1), BALL))
    lacks = [np.mean(fine) - np.mean(volumes(inflate(part_of(triangles, p), BALL))) for p in (0.8, 0.4)]
    assert 2.5 < lacks[0] / lacks[1] < 7.0


@pytest.mark.parametrize("degrees", [0.0, 35.0])
def test_the_result_does_not_depend_on_the_direction_of_slices(degrees: float) -> None:
    pitch = 0.2
    part = part_of(solids.turned(solids.torus_example().torus(48, 40)[:, :, :] / 3.0, degrees, (1, 0.5, 0.2)), pitch)
    grown = inflate(part, StructuringElement.ball(1.5))
    found = volumes(grown)
    assert max(found) - min(found) < 2e-3 * max(found)
    alone = volumes(inflate_individually(part.slices, 1.5))
    assert max(alone) - min(alone) > 0.05 * max(found)
    assert all(a < v for a, v in zip(alone, found, strict=True))


@pytest.mark.parametrize("seed", range(8))
def test_sections_left_out_change_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    # rings that shrink, grow, shift and jump from section to section, some of them twice
    middle, outer, inner = np.zeros(2), 6.0, 3.0
    regions: list[Region] = []
    angle = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    circle = np.column_stack((np.cos(angle), np.sin(angle)))
    for k in range(40):
        middle = middle + rng.normal(0.0, 0.02 if seed % 2 else 0.0, 2)
        outer += rng.choice([-0.3, -0.05, 0.0, 0.05, 0.2])
        inner = min(max(0.3, inner + rng.normal(0.0, 0.1)), 0.9 * outer)
        if k == 20:
            outer = 0.5 * outer + 2.0
        regions.append(Region.of(middle + outer * circle, (middle + min(inner, 0.8 * outer) * circle)[::-1]))
    regions[30] = regions[31]
    at = 0.1 * np.arange(40)
    shapes, segments = to_shapes(regions), 32
    chord = RADIUS * (1.0 - math.cos(0.25 * math.pi / segments))
    planes = np.array([-1.0, 1.02, 2.0, 4.5])
    left_out = 0
    up, down = convolution.margins(shapes, shapely.boundary(shapes), 2)
    united = convolution.Convolution(shapes, at, BALL.ball_radii_mm, RADIUS, (1.0 + 1e-9) * chord, threads=2)
    for plane, got in zip(planes, united.on(planes), strict=True):
        radii = BALL.ball_radii_mm(at - plane)
        grown = [s.buffer(r, quad_segs=segments) for s, r in zip(shapes, radii, strict=True) if r >= 0.0]
        wanted = shapely.union_all(grown)
        assert shapely.difference(wanted, got.buffer(1.01 * chord)).area == 0.0
        assert shapely.difference(got, wanted.buffer(1e-9)).area == 0.0
        left_out += len(grown) - int(convolution.needed(radii, up, down).sum())
    assert left_out > 20


@pytest.mark.parametrize("text", ["ball 4", "flat 4", "bull 4 r0.5"])
def test_tools_keep_their_tip_off_a_block(text: str) -> None:
    tool = StructuringElement.tool(parse_tool(text))
    part = part_of(solids.box((0, 0, 0), (10, 10, 5)), 0.2)
    grown = inflate(part, tool)
    shape = parse_tool(text)
    for z, region in zip(grown.positions_mm(2), grown.regions[2], strict=True):
        if 0.0 < z < 5.0:
            reach = float(shape.radius_mm(5.0 - z))
            exact = 100.0 + 40.0 * reach + math.pi * reach**2
            assert region.area_mm2 == pytest.approx(exact, rel=2e-3)
        elif z > 5.0:
            assert region.empty
    heights = np.arange(0.0005, 5.0, 0.001)
    reach = shape.radius_mm(5.0 - heights)
    exact = float(np.sum(100.0 + 40.0 * reach + math.pi * reach**2) * 0.001)
    for axis in (0, 1):
        assert areas(grown, axis).sum() * grown.pitch_mm[axis] == pytest.approx(exact, rel=4e-3)


def test_an_allowance_inflates_the_tool() -> None:
    tool = StructuringElement.tool(parse_tool("flat 4")).with_allowance(0.5)
    radii = tool.z_radii_mm(np.array([-0.51, -0.5, -0.2, 0.0, 3.0]))
    assert np.isnan(radii[0])
    np.testing.assert_allclose(radii[1:], [2.0, 2.0 + math.sqrt(0.25 - 0.04), 2.5, 2.5])


def test_mistakes() -> None:
    with pytest.raises(ToolError, match=r"allowance -1 mm; expected not below 0, the tool's corner radius"):
        StructuringElement.tool(parse_tool("flat 4")).with_allowance(-1.0)
    with pytest.raises(ToolError, match="offsets with taper tools: not possible"):
        StructuringElement.tool(parse_tool("taper 4 a5"))
    with pytest.raises(ToolError, match="radius 0 mm, expected a number above 0"):
        StructuringElement.ball(0.0)


def test_results_do_not_depend_on_threads() -> None:
    part = part_of(solids.sphere(4.0, 3), 0.5)
    one, two = inflate(part, BALL, threads=1), inflate(part, BALL, threads=3)
    for axis in range(3):
        for a, b in zip(one.regions[axis], two.regions[axis], strict=True):
            assert all(np.array_equal(x, y) for x, y in zip(a.rings, b.rings, strict=True))
