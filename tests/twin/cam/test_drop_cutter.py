"""The drop-cutter against closed forms, and its laws."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.terrain import block, rough, terrain, waves

from twin.arrays import FloatArray
from twin.cam.surface import drop_cutter
from twin.cam.surface.drop_cutter import EDGE, FACE, FLOOR, VERTEX, DropCutter
from twin.cam.surface.surface import surface_of, surface_of_mesh
from twin.errors import MeshError, ToolError
from twin.geometry.threads import FEW, in_parts
from twin.tools.shape import ToolShape
from twin.tools.text import parse_tool

TOOLS = ("ball 8", "ball 0.4", "flat 6", "bull 8 r1", "bull 6 r2.5", "taper 2 r0.5 a15", "taper 3 a30")
HERE = np.array([[0.0, 0.0]])


def square(height: float = 0.0, size: float = 100.0, slope_x: float = 0.0, slope_y: float = 0.0) -> FloatArray:
    corners = [(x, y, height + slope_x * x + slope_y * y) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    a, b, c, d = np.array(corners) * (size, size, 1.0) + np.array([(0, 0, 0)] * 4)
    for p in (a, b, c, d):
        p[2] = height + slope_x * p[0] + slope_y * p[1]
    return np.array([(a, b, c), (a, c, d)])


def segment(a: tuple[float, float, float], b: tuple[float, float, float]) -> FloatArray:
    """A triangle without area: an edge alone."""
    return np.array([[a, b, b]])


@pytest.mark.parametrize("text", TOOLS)
def test_on_level_ground_every_tool_stands_at_its_height(text: str) -> None:
    points = np.random.default_rng(0).uniform(-50.0, 50.0, (200, 2))
    assert DropCutter(square(1.25), text).drop(points) == pytest.approx(1.25, abs=1e-14)


@pytest.mark.parametrize("text", TOOLS)
@pytest.mark.parametrize("slope", [0.01, 0.5, 1.7, 3.0, 8.0])
def test_on_a_slope(text: str, slope: float) -> None:
    # it is touched where the meridian has its angle: disc tan + corner / cos - corner, or at the top rim of a cone
    tool = parse_tool(text)
    cos = 1.0 / math.hypot(1.0, slope)
    rise = tool.disc_mm * slope + tool.corner_radius_mm * (1.0 / cos - 1.0)
    if slope * math.tan(tool.taper_rad) > 1.0:
        rise = tool.max_radius_mm * slope - tool.height_mm
    found = DropCutter(square(2.0, slope_x=slope * 0.6, slope_y=slope * 0.8), text).contacts(HERE)
    assert found.z_mm[0] == pytest.approx(2.0 + rise, abs=1e-12)
    assert found.kind[0] == FACE
    assert found.normals[0] == pytest.approx([-0.6 * slope * cos, -0.8 * slope * cos, cos], abs=1e-12)


@pytest.mark.parametrize("q", [0.0, 0.5, 2.2, 3.9])
@pytest.mark.parametrize("slope", [0.0, 0.3, 2.0])
def test_a_ball_on_an_edge_alone(q: float, slope: float) -> None:
    # the centre lies on a circle of radius R about the edge: half an ellipse over the plan
    found = DropCutter(segment((-50.0, q, -50.0 * slope), (50.0, q, 50.0 * slope)), "ball 8", floor_mm=-99.0).contacts(
        HERE
    )
    expected = math.sqrt(16.0 - q * q) * math.hypot(1.0, slope) - 4.0
    assert found.z_mm[0] == pytest.approx(expected, abs=1e-12)
    assert found.kind[0] == EDGE


def test_a_flat_tool_on_an_edge_alone_touches_at_its_rim() -> None:
    z = DropCutter(segment((-50.0, 1.8, -25.0), (50.0, 1.8, 25.0)), "flat 6").drop(HERE)
    assert z[0] == pytest.approx(0.5 * math.sqrt(9.0 - 1.8**2), abs=1e-13)


def test_a_bull_tool_on_an_edge_satisfies_its_equations() -> None:
    # at the contact the edge is tangent to the torus: tan(kappa) s / rho = slope, with rho = d + r sin(kappa)
    slope, q = 0.7, 2.5
    found = DropCutter(segment((-50.0, q, -50.0 * slope), (50.0, q, 50.0 * slope)), "bull 8 r1").contacts(HERE)
    s = found.points_mm[0, 0]
    rho = math.hypot(s, q)
    sine = (rho - 3.0) / 1.0
    assert math.tan(math.asin(sine)) * s / rho == pytest.approx(slope, abs=1e-9)
    assert found.z_mm[0] == pytest.approx(slope * s - 1.0 + math.sqrt(1.0 - sine * sine), abs=1e-12)


@pytest.mark.parametrize("text", TOOLS)
def test_on_a_vertex_alone_the_meridian_is_seen(text: str) -> None:
    tool = parse_tool(text)
    top = tool.height_mm if tool.taper_rad > 0.0 else tool.corner_radius_mm
    heights = np.linspace(0.0, top, 40)[1:-1]
    rho = np.concatenate((np.linspace(0.0, tool.disc_mm, 5), tool.radius_mm(heights) if top > 0.0 else []))
    expected = -np.concatenate((np.zeros(5), heights if top > 0.0 else []))
    found = DropCutter(np.zeros((1, 3, 3)), text, floor_mm=-99.0).contacts(np.column_stack((rho, 0.0 * rho)))
    assert found.z_mm == pytest.approx(expected, abs=1e-9)
    assert (found.kind == VERTEX).all()


def test_on_a_ball_of_triangles_the_tip_keeps_its_distance() -> None:
    # centres lie between those of the balls inside and outside of the triangles
    u, v = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 181), np.linspace(0.0, 0.5 * np.pi, 46), indexing="ij")
    net = 10.0 * np.stack((np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)), axis=-1)
    a, b, c, d = net[:-1, :-1], net[:-1, 1:], net[1:, 1:], net[1:, :-1]
    triangles = np.concatenate([np.stack(t, axis=-2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))])
    points = np.random.default_rng(1).uniform(-9.0, 9.0, (400, 2))
    rho2 = (points**2).sum(axis=1)
    points, rho2 = points[rho2 < 81.0], rho2[rho2 < 81.0]
    z = DropCutter(triangles, "ball 8").drop(points)
    inner = 10.0 * math.cos(math.radians(1.0)) ** 2
    assert (z <= np.sqrt(14.0**2 - rho2) - 4.0 + 1e-12).all()
    assert (z >= np.sqrt((inner + 4.0) ** 2 - rho2) - 4.0 - 1e-12).all()


def test_beside_a_vertical_wall_a_tool_rises_at_its_radius() -> None:
    wall = np.array(
        [
            [(0.0, -50.0, 0.0), (0.0, 50.0, 0.0), (0.0, 50.0, 10.0)],
            [(0.0, -50.0, 0.0), (0.0, 50.0, 10.0), (0.0, -50.0, 10.0)],
        ]
    )
    points = np.array([[-4.001, 0.0], [-3.999, 0.0], [-2.0, 0.0], [0.0, 3.0], [4.001, 1.0]])
    z = DropCutter(np.concatenate((wall, square(0.0))), "ball 8").drop(points)
    expected = [0.0, 6.0 + math.sqrt(16.0 - 3.999**2), 6.0 + math.sqrt(12.0), 10.0, 0.0]
    assert z == pytest.approx(expected, abs=1e-12)


def test_outside_is_the_floor() -> None:
    cutter = DropCutter(square(3.0, size=5.0), "ball 8", floor_mm=-7.5)
    found = cutter.contacts(np.array([[10.0, 0.0], [1e6, -1e6], [np.nan, 0.0], [8.9, 0.0]]))
    assert found.z_mm[:3] == pytest.approx(-7.5)
    assert (found.kind == [FLOOR, FLOOR, FLOOR, EDGE]).all()
    assert np.isnan(found.points_mm[:3]).all()
    assert DropCutter(square(3.0), "ball 8").floor_mm == 3.0


def test_a_floor_is_the_least_height() -> None:
    assert DropCutter(square(3.0), "ball 8", floor_mm=4.0).drop(HERE)[0] == 4.0


@pytest.mark.parametrize("text", TOOLS)
@pytest.mark.parametrize("shape", [waves, rough, block])
def test_contacts_lie_on_tool_and_surface(text: str, shape: object) -> None:
    triangles = terrain(shape, 12)  # type: ignore[arg-type]
    tool = parse_tool(text)
    points = np.random.default_rng(2).uniform(-3.0, 9.0, (500, 2))
    found = DropCutter(triangles, text, floor_mm=-50.0).contacts(points)
    hit = found.kind != FLOOR
    at, tip = found.points_mm[hit], np.column_stack((points, found.z_mm))[hit]
    rho = np.hypot(*(at - tip)[:, :2].T)
    assert (tool.radius_mm((at - tip)[:, 2]) - rho >= -1e-6).all()
    assert (
        DropCutter(triangles, None, floor_mm=-50.0).drop(at[:, :2]) == pytest.approx(at[:, 2], abs=1e-6)
        or shape is block
    )
    assert np.linalg.norm(found.normals[hit], axis=1) == pytest.approx(1.0)
    assert (found.normals[hit, 2] >= -1e-12).all()


@settings(max_examples=25, deadline=None)
@given(
    shift=st.tuples(*(st.floats(-500.0, 500.0),) * 3),
    text=st.sampled_from(TOOLS),
    turn=st.sampled_from([(0, 1, 2), (2, 1, 0), (1, 2, 0)]),
)
def test_moving_and_turning_triangles_changes_nothing(
    shift: tuple[float, float, float], text: str, turn: tuple[int, int, int]
) -> None:
    triangles = terrain(rough, 6)
    points = np.random.default_rng(3).uniform(-2.0, 8.0, (60, 2))
    here = DropCutter(triangles, text, floor_mm=-20.0).drop(points)
    order = np.random.default_rng(4).permutation(len(triangles))
    moved = DropCutter(triangles[order][:, list(turn)] + shift, text, floor_mm=-20.0 + shift[2]).drop(
        points + shift[:2]
    )
    # at the rim of a cylindrical wall a height may jump by what rounding moves the plan
    assert np.sort(np.abs(moved - shift[2] - here))[:-3].max() < 1e-6


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), text=st.sampled_from(TOOLS))
def test_more_triangles_never_lower_the_tool(seed: int, text: str) -> None:
    rng = np.random.default_rng(seed)
    triangles = rng.uniform(-5.0, 5.0, (12, 3, 3))
    points = rng.uniform(-7.0, 7.0, (50, 2))
    few = DropCutter(triangles[:7], text, floor_mm=-30.0).drop(points)
    many = DropCutter(triangles, text, floor_mm=-30.0).drop(points)
    rest = DropCutter(triangles[7:], text, floor_mm=-30.0).drop(points)
    assert (many >= few - 1e-12).all()
    assert many == pytest.approx(np.maximum(few, rest), abs=1e-9)


def test_larger_tools_never_stand_lower() -> None:
    triangles = terrain(rough, 10)
    points = np.random.default_rng(5).uniform(-1.0, 7.0, (300, 2))
    for family in (("ball 1", "ball 2", "ball 6"), ("flat 1", "flat 2", "flat 6"), ("ball 6", "bull 6 r1", "flat 6")):
        heights = [DropCutter(triangles, text, floor_mm=-9.0).drop(points) for text in family]
        assert (np.diff(heights, axis=0) >= -1e-12).all()


def test_threads_do_not_change_a_bit() -> None:
    triangles = terrain(rough, 30)
    points = np.random.default_rng(6).uniform(-2.0, 8.0, (9000, 2))
    one, two = (DropCutter(triangles, "bull 3 r1", threads=n) for n in (1, 2))
    assert np.array_equal(one.drop(points), two.drop(points))
    assert np.array_equal(one.drop(points, threads=2), two.drop(points, threads=1))
    assert np.array_equal(one.contacts(points).kind, two.contacts(points).kind)


def test_lists_that_grow_too_long_get_larger_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    triangles = terrain(rough, 12)
    points = np.random.default_rng(14).uniform(-2.0, 8.0, (300, 2))
    fine = DropCutter(triangles, "flat 6").drop(points)
    monkeypatch.setattr(drop_cutter, "_MOST_ENTRIES", 2_000)
    assert np.array_equal(DropCutter(triangles, "flat 6").drop(points), fine)


def test_an_error_in_a_thread_is_told() -> None:
    def work(first: int, last: int) -> None:
        if first > 0:
            raise ValueError(f"part from {first}")

    with pytest.raises(ValueError, match="part from"):
        in_parts(work, 2 * FEW, threads=2)


def test_triangles_without_area_do_no_harm() -> None:
    triangles = terrain(waves, 8)
    spoiled = np.concatenate((triangles, triangles[:20][:, [0, 1, 1]], triangles[:20][:, [2, 2, 2]]))
    slivers = triangles[:20].copy()
    slivers[:, 2] = 0.25 * slivers[:, 0] + 0.75 * slivers[:, 1]
    points = np.random.default_rng(8).uniform(-1.0, 7.0, (300, 2))
    for text in TOOLS:
        plain = DropCutter(triangles, text, floor_mm=-9.0).drop(points)
        other = DropCutter(np.concatenate((spoiled, slivers)), text, floor_mm=-9.0).drop(points)
        assert other == pytest.approx(plain, abs=1e-9)


def test_a_needle_sees_the_surface() -> None:
    points = np.random.default_rng(9).uniform(0.0, 6.0, (500, 2))
    z = DropCutter(square(1.0, slope_x=0.3, slope_y=-2.0), None).drop(points)
    assert z == pytest.approx(1.0 + points @ (0.3, -2.0), abs=1e-12)


def test_a_surface_is_made_once_for_many_tools() -> None:
    surface = surface_of(terrain(waves, 8))
    again = surface_of_mesh(surface.vertices_mm, surface.triangles)
    points = np.random.default_rng(10).uniform(0.0, 6.0, (50, 2))
    for text in TOOLS:
        assert np.array_equal(DropCutter(surface, text).drop(points), DropCutter(again, text).drop(points))
    assert len(surface.vertices_mm) == 81
    assert len(surface.ends) == 3 * 64 + 2 * 8


def test_on_a_convex_body_most_edges_of_a_flat_side_are_left_out() -> None:
    surface = surface_of(terrain(lambda x, y: 0.0 * x, 8))
    inner = surface.edge_cones_rad[:, 0] > surface.edge_cones_rad[:, 1]
    assert int((~inner).sum()) == 4 * 8
    kept = surface.vertex_cones[:, 0] <= surface.vertex_cones[:, 1]
    assert int(kept.sum()) == 4


@pytest.mark.parametrize(
    ("triangles", "message"),
    [
        (np.empty((0, 3, 3)), "surface: triangles of shape (0, 3, 3); expected (m, 3, 3) with m above 0"),
        (np.zeros((4, 3)), "surface: triangles of shape (4, 3); expected (m, 3, 3) with m above 0"),
        (np.full((2, 3, 3), np.nan), "surface: triangle 1 of 2 has a corner that is not finite"),
    ],
)
def test_triangles_that_are_none_are_refused(triangles: FloatArray, message: str) -> None:
    with pytest.raises(MeshError) as error:
        DropCutter(triangles, "ball 8")
    assert str(error.value) == message


def test_a_floor_that_is_no_number_is_refused() -> None:
    with pytest.raises(ToolError, match="floor_mm is not a number"):
        DropCutter(square(), ToolShape(disc_mm=1.0, corner_radius_mm=0.0, height_mm=3.0), floor_mm=math.nan)


def test_points_need_two_columns() -> None:
    with pytest.raises(ValueError, match=r"points_mm must have shape \(m, 2\), got \(4, 3\)"):
        DropCutter(square(), "ball 8").drop(np.zeros((4, 3)))
