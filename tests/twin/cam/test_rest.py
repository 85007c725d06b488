"""Rest material: no air, no gouge, nothing reachable left out."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.golden_section import underside
from support.terrain import block, terrain, waves

from twin.cam.stock.dexel import Dexels
from twin.cam.stock.rest import (
    LEAST_MM,
    RestMaterial,
    allowed_heights,
    grown,
    remaining,
    spacing_for_cusp,
    stock_heights,
)
from twin.cam.stock.strokes import Strokes
from twin.cam.surface.surface import Surface, surface_of
from twin.errors import ToolError
from twin.tools.text import parse_tool

BALL = parse_tool("ball 1.5")


@pytest.fixture(scope="module")
def part() -> Surface:
    return surface_of(terrain(block, 24))


@pytest.fixture(scope="module")
def roughed(part: Surface) -> Dexels:
    """A block that a flat tool went over at two levels."""
    stock = Dexels((0.0, 0.0), (6.0, 6.0), 0.1, 4.0, -1.0)
    tool = parse_tool("flat 2.4")
    tips = allowed_heights(part, tool, stock.points_mm, 0.1)
    for z in (2.5, 0.5):
        at = stock.points_mm[tips <= z]
        places = np.column_stack((at, np.full(len(at), z)))
        stock.cut(tool, Strokes(places, places, np.empty((0, 8))))
    return stock


def test_heights_over_the_stock_are_by_definition() -> None:
    stock = Dexels((0.0, 0.0), (6.0, 6.0), 0.2, 0.0)
    stock = Dexels((0.0, 0.0), (6.0, 6.0), 0.2, waves(*np.meshgrid(stock.x_mm, stock.y_mm, indexing="ij")))
    rng = np.random.default_rng(1)
    points = rng.uniform(-2.0, 8.0, (200, 2))
    for text in ("ball 3", "flat 2", "bull 3 r0.5", "taper 1 r0.2 a20"):
        tool = parse_tool(text)
        away = np.hypot(*(points[:, None] - stock.points_mm).transpose(2, 0, 1))
        inside = away <= tool.max_radius_mm
        tips = np.where(inside, stock.heights_mm.ravel() - underside(tool, away), -math.inf).max(axis=1)
        assert stock_heights(stock, tool, points) == pytest.approx(tips, abs=1e-12)
        assert (tips == -math.inf).any()


def test_an_allowance_is_kept_along_the_normals() -> None:
    slope = 0.75
    plane = surface_of(terrain(lambda x, y: slope * x + 0.0 * y, 2, 60.0))
    at = np.array([[30.0, 30.0]])
    for text in ("ball 3", "flat 2", "bull 3 r0.5"):
        tool = parse_tool(text)
        lifted = allowed_heights(plane, tool, at, 0.4) - allowed_heights(plane, tool, at)
        assert lifted[0] == pytest.approx(0.4 * math.hypot(1.0, slope), abs=1e-12)
    assert grown(BALL, 0.0) is BALL
    with pytest.raises(ToolError, match="allowance_mm = -1; expected a number not below 0"):
        allowed_heights(plane, BALL, at, -1.0)


def test_places_of_a_level_cut_and_do_not_gouge(part: Surface, roughed: Dexels) -> None:
    rest = RestMaterial(roughed, part, BALL, allowance_mm=0.05)
    tips = allowed_heights(part, BALL, roughed.points_mm, 0.05).reshape(roughed.heights_mm.shape)
    levels = rest.levels([3.0, 2.0, 1.0, 0.6, 0.3])
    assert len(levels) >= 4
    for level in levels:
        places = level.regions > 0
        assert (tips[places] <= level.z_mm).all()
        for point in level.points_mm[::5]:
            alone = roughed.copy()
            alone.cut(BALL, Strokes.through([point]))
            assert alone.volume_above_mm3(-1.0) < roughed.volume_above_mm3(-1.0)
        # every other place either gouges or cuts nothing thicker than the least
        after = roughed.copy()
        at = np.column_stack((roughed.points_mm, np.full(tips.size, level.z_mm)))
        others = at[(~places & (tips <= level.z_mm)).ravel()]
        after.cut(BALL, Strokes(others, others, np.empty((0, 8))))
        assert (roughed.heights_mm - after.heights_mm).max() <= LEAST_MM + 1e-12


def test_points_cover_their_regions_and_keep_their_distance(part: Surface, roughed: Dexels) -> None:
    spacing = 0.4
    for level in RestMaterial(roughed, part, BALL).levels([2.0, 1.0], spacing):
        places = roughed.points_mm[(level.regions > 0).ravel()]
        away = np.hypot(*(places[:, None] - level.points_mm[:, :2]).transpose(2, 0, 1))
        assert away.min(axis=1).max() < spacing
        apart = np.hypot(*(level.points_mm[:, None, :2] - level.points_mm[:, :2]).transpose(2, 0, 1))
        assert (apart + 9.0 * np.eye(len(apart))).min() >= spacing - 1e-12
        assert set(level.point_regions) == set(range(1, level.region_count + 1))


def test_nothing_is_left_after_going_everywhere(part: Surface, roughed: Dexels) -> None:
    stock = roughed.copy()
    z = 1.2
    level = RestMaterial(stock, part, BALL).level(z)
    at = stock.points_mm[(level.regions > 0).ravel()]
    places = np.column_stack((at, np.full(len(at), z)))
    stock.cut(BALL, Strokes(places, places, np.empty((0, 8))))
    assert len(RestMaterial(stock, part, BALL).level(z).points_mm) == 0
    assert RestMaterial(stock, part, BALL).levels([z]) == []


def test_one_level_with_known_heights(part: Surface, roughed: Dexels) -> None:
    rest = RestMaterial(roughed, part, BALL, allowance_mm=0.1)
    own, known = rest.level(1.0), remaining(roughed, rest.part_tip_mm, 1.0, BALL)
    assert np.array_equal(own.points_mm, known.points_mm)
    assert np.array_equal(own.regions, known.regions)
    assert rest.depth_mm.max() > 0.5
    assert (rest.depth_mm[own.regions > 0] > 0.0).all()


def test_separate_places_are_separate_regions() -> None:
    flat = surface_of(terrain(lambda x, y: 0.0 * x, 2))
    top = np.zeros((60, 60))
    top[5:15, 5:15] = top[40:50, 40:50] = 1.0
    stock = Dexels((0.0, 0.0), (6.0, 6.0), 0.1, top, -1.0)
    level = RestMaterial(stock, flat, parse_tool("flat 0.4")).level(0.5)
    assert level.region_count == 2
    for number in (1, 2):
        middle = level.points_mm[level.point_regions == number].mean(axis=0)
        assert middle == pytest.approx((1.0, 1.0, 0.5) if number == 1 else (4.5, 4.5, 0.5), abs=0.1)


def test_a_cusp_gives_the_spacing() -> None:
    assert spacing_for_cusp(parse_tool("ball 8"), 0.1) == pytest.approx(math.sqrt(16.0 - 3.9**2))
    assert spacing_for_cusp(parse_tool("flat 8"), 0.1) == 4.0
    assert spacing_for_cusp(parse_tool("bull 8 r1"), 0.1) == pytest.approx(3.0 + math.sqrt(1.0 - 0.81))
    with pytest.raises(ToolError, match="cusp_mm = 0; expected a number above 0"):
        spacing_for_cusp(BALL, 0.0)


def test_a_spacing_must_be_above_nothing(part: Surface, roughed: Dexels) -> None:
    with pytest.raises(ToolError, match="spacing_mm = 0; expected a number above 0"):
        RestMaterial(roughed, part, BALL).level(1.0, 0.0)
