"""Lines of the tip over slices, against the exact drop-cutter on the same triangles."""

from __future__ import annotations

import numpy as np
import pytest
from support import solids

from twin.arrays import FloatArray
from twin.cam.slices.cl_lines import Profiles, cl_heights, cl_lines
from twin.cam.slices.polylines import Samples
from twin.cam.slices.sections import Sections, SlicedPart, slice_part
from twin.cam.slices.structuring_element import StructuringElement
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import surface_of_mesh
from twin.tools.text import parse_tool
from twin.workpiece.solids.from_mesh import Solid, solid


def exact(mesh: Solid, text: str, points: FloatArray, floor: float) -> FloatArray:
    return DropCutter(surface_of_mesh(mesh.vertices_mm, mesh.triangles), text, floor_mm=floor).drop(points)


def errors_um(part: SlicedPart, text: str, axis: int, planes: FloatArray, *, smooth: bool = True) -> FloatArray:
    profiles = Profiles.of(part.sections(axis))
    places = Samples.between(-29.9, 29.9, 0.07)
    tool = StructuringElement.tool(parse_tool(text))
    heights = cl_heights(profiles, tool, planes, places, smooth=smooth)
    across, along = np.meshgrid(planes, places.at_mm, indexing="ij")
    points = np.column_stack((along.ravel(), across.ravel())[:: 1 if axis == 1 else -1])
    return 1000.0 * (heights.ravel() - exact(part.mesh, text, points, -20.0))


@pytest.fixture(scope="module")
def torus_part() -> SlicedPart:
    return slice_part(solids.torus(), 0.05)


#: Rows between the slices, on them, and where the part is steepest across them.
ROWS = np.concatenate((np.arange(-29.75, 30.0, 2.5), [-26.55, -12.0, 12.0125, 12.3, 26.5]))


@pytest.mark.compiled
@pytest.mark.parametrize("axis", [0, 1])
def test_a_ball_at_50_um_is_within_5_um_and_nearly_always_within_1(torus_part: SlicedPart, axis: int) -> None:
    assert np.abs(errors_um(torus_part, "ball 8", axis, ROWS)).max() <= 5.0
    off = np.abs(errors_um(torus_part, "ball 8", axis, np.arange(-29.75, 30.0, 1.25)))
    assert np.mean(off <= 1.0) >= 0.999


@pytest.mark.compiled
@pytest.mark.parametrize(
    ("text", "most_um", "share"),
    [("flat 8", 4.0, 0.99), ("flat 3", 4.0, 0.99), ("bull 8 r1", 4.0, 0.99), ("bull 8 r0.3", 12.0, 0.98)],
)
def test_other_tools(torus_part: SlicedPart, text: str, most_um: float, share: float) -> None:
    off = np.abs(errors_um(torus_part, text, 1, ROWS))
    assert off.max() <= most_um
    assert np.mean(off <= 1.0) >= share


@pytest.mark.compiled
@pytest.mark.parametrize("text", ["ball 8", "flat 8", "bull 8 r1"])
def test_without_interpolation_heights_are_never_too_large(torus_part: SlicedPart, text: str) -> None:
    off = errors_um(torus_part, text, 1, ROWS[::3], smooth=False)
    assert off.max() < 0.03


def test_a_flat_tool_narrower_than_the_pitch_stays_within_a_pitch_of_the_surface() -> None:
    part = slice_part(solids.torus(64, 24), 1.0)
    rows, places = np.arange(-28.0, 28.0, 0.3), Samples.between(-28.0, 28.0, 0.3)
    heights = cl_heights(Profiles.of(part.sections(1)), StructuringElement.tool(parse_tool("flat 1")), rows, places)
    across, along = np.meshgrid(rows, places.at_mm, indexing="ij")
    points = np.column_stack((along.ravel(), across.ravel()))
    shifts = np.array([(0.0, d) for d in np.linspace(-1.0, 1.0, 9)])
    near = np.array([exact(part.mesh, "flat 1", points + shift, -20.0) for shift in shifts])
    found = np.isfinite(heights.ravel())
    assert found.mean() > 0.5
    assert np.all((heights.ravel() >= near.min(axis=0) - 0.05)[found])
    assert np.all((heights.ravel() <= near.max(axis=0) + 0.05)[found])


def test_a_coarser_pitch_is_worse_by_its_square() -> None:
    worst = []
    for pitch in (0.4, 0.2):
        part = slice_part(solids.torus(), pitch)
        worst.append(np.percentile(np.abs(errors_um(part, "ball 8", 1, ROWS, smooth=False)), 90.0))
    assert 2.8 < worst[0] / worst[1] < 5.5


def test_lines_leave_walls_and_meet_in_inner_corners() -> None:
    mesh = solid(solids.pocket(), "pocket")
    profiles = Profiles.of(slice_part(mesh, 0.2).sections(1))
    tool = StructuringElement.tool(parse_tool("ball 4"))
    (line,) = cl_lines(profiles, tool, np.array([0.1]), Samples.between(-13.0, 13.0, 0.1), -20.0)
    assert (np.diff(line[:, 0]) >= 0.0).all()
    middle = np.linspace(0.01, 0.99, 7)[:, None, None]
    between = (line[:-1] + middle * np.diff(line, axis=0)).reshape(-1, 2)
    # no gouge: 2 um to a side, where arcs are steep, or 2 um higher the tool is free
    wanted = np.min(
        [
            exact(mesh, "ball 4", np.column_stack((between[:, 0] + aside, np.full(len(between), 0.1))), -20.0)
            for aside in (-0.002, 0.0, 0.002)
        ],
        axis=0,
    )
    assert (between[:, 1] - wanted).min() > -0.002
    # 2 mm from the walls the ball stands on the floor, beside them it rolls over the edge
    assert line[np.abs(line[:, 0]) < 2.99, 1].max() == pytest.approx(-6.0, abs=2e-5)
    wall = line[np.abs(line[:, 0] - 3.0) < 0.01]
    assert np.ptp(wall[:, 1]) > 4.0


def test_an_inner_corner_between_places_is_found() -> None:
    # a valley of 90 degrees along y, its bottom at x = 0.03
    valley = np.array([(-8.0, -8.0), (8.0, -8.0), (8.0, 7.97), (0.03, 0.0), (-7.97, 8.0), (-8.0, 8.0)])
    profiles = Profiles.of(slice_part(solid(solids.extruded(valley), "valley"), 0.1).sections(1))
    tool = StructuringElement.tool(parse_tool("ball 2"))
    (line,) = cl_lines(profiles, tool, np.array([0.1]), Samples.between(-2.0, 2.0, 0.1), -9.0)
    lowest = line[np.argmin(line[:, 1])]
    np.testing.assert_allclose(lowest, (0.03, np.sqrt(2.0) - 1.0), atol=1e-4)


def test_a_flat_tool_on_planes_is_exact() -> None:
    """Its rim rests on them between the slices, at the ends of the bottom."""
    ridge = np.array([(-4.0, -4.0), (4.0, -4.0), (4.0, -2.0), (0.1, 1.9), (-3.8, -2.0), (-4.0, -2.0)])
    roof = solids.extruded(ridge)[:, :, [1, 0, 2]][:, ::-1]
    part = slice_part(solid(roof, "roof"), 0.5)
    tool = StructuringElement.tool(parse_tool("flat 2"))
    rows, places = np.array([-2.3, 2.0]), Samples.between(-1.0, 1.0, 1.0)
    heights = cl_heights(Profiles.of(part.sections(1)), tool, rows, places)
    wanted = exact(part.mesh, "flat 2", np.column_stack((np.zeros(2), rows)), -20.0)
    np.testing.assert_allclose(heights, np.repeat(wanted[:, None], places.count, axis=1), atol=1e-4)


def test_a_ridge_between_slices_is_met() -> None:
    # a roof whose ridge runs along the rows, at a place that no even slice has
    ridge = np.array([(-8.0, -8.0), (8.0, -8.0), (8.0, -4.0), (0.13, 3.87), (-7.74, -4.0), (-8.0, -4.0)])
    roof = solids.extruded(ridge)[:, :, [1, 0, 2]][:, ::-1]
    part = slice_part(solid(roof, "roof"), 0.4)
    assert np.abs(part.slices.positions_mm(1) - 0.13).min() > 0.05
    tool = StructuringElement.tool(parse_tool("ball 4"))
    rows, places = np.array([-0.5, 0.13, 1.0]), Samples.between(-3.0, 3.0, 0.5)
    heights = cl_heights(Profiles.of(part.sections(1)), tool, rows, places)
    wanted = exact(part.mesh, "ball 4", np.column_stack((np.zeros(3), rows)), -20.0)
    assert wanted[1] == pytest.approx(3.87, abs=1e-4)
    np.testing.assert_allclose(heights, np.repeat(wanted[:, None], places.count, axis=1), atol=0.006)
    even = cl_heights(Profiles.of(Sections.of(part.slices, 1)), tool, rows, places)
    assert even[1, 0] < 3.87 - 0.05


@pytest.mark.compiled
def test_an_allowance_lifts_as_a_larger_ball_does(torus_part: SlicedPart) -> None:
    profiles, places = Profiles.of(torus_part.sections(1)), Samples.between(-20.0, 20.0, 0.5)
    rows = np.array([0.1, 11.3])
    left = cl_heights(profiles, StructuringElement.tool(parse_tool("ball 8")), rows, places, allowance_mm=0.5)
    centre = cl_heights(profiles, StructuringElement.ball(4.5), rows, places)
    np.testing.assert_allclose(left, centre - 4.0, atol=1e-12)


@pytest.mark.compiled
def test_threads_change_nothing_and_no_part_is_no_height(torus_part: SlicedPart) -> None:
    profiles, places = Profiles.of(torus_part.sections(1)), Samples.between(-40.0, 40.0, 0.3)
    tool = StructuringElement.tool(parse_tool("ball 8"))
    rows = np.array([-50.0, -3.0, 0.0, 7.1])
    one, three = (cl_lines(profiles, tool, rows, places, -11.0, threads=n) for n in (1, 3))
    for a, b in zip(one, three, strict=True):
        np.testing.assert_array_equal(a, b)
    assert (one[0][:, 1] == -11.0).all()
    assert np.isneginf(cl_heights(profiles, tool, rows[:1], places)).all()


@pytest.mark.compiled
def test_sections_across_z_have_no_profiles(torus_part: SlicedPart) -> None:
    with pytest.raises(ValueError, match="profiles need sections across x or y, got axis 2"):
        Profiles.of(torus_part.sections(2))
