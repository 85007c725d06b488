"""What tools cannot reach, against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from support import solids
from support.facets import ring_in_facets

from twin.arrays import FloatArray
from twin.cam.reach.largest_ball import largest_ball_mm
from twin.cam.reach.tool_reach import thin_bound_mm, tool_reach
from twin.cam.reach.uncut_mesh import uncut_mesh
from twin.cam.slices.sections import SlicedPart, slice_part
from twin.cam.slices.structuring_element import StructuringElement
from twin.errors import ToolError
from twin.tools.text import parse_tool
from twin.workpiece.solids.from_mesh import solid

#: Segments about the axis: a polygon's area is less than its circle's by this factor.
AROUND = 112
ROUND = math.sin(2.0 * math.pi / AROUND) / (2.0 * math.pi / AROUND)


def part_of(triangles: FloatArray, pitch_mm: float) -> SlicedPart:
    return slice_part(solid(triangles, "test"), pitch_mm)


def tool(text: str) -> StructuringElement:
    return StructuringElement.tool(parse_tool(text))


def profile() -> Any:
    """The example's part with a smaller ring on a thin plate: the same fillets, fewer slices."""
    return solids.torus_example().Profile(ring_mm=12.0, half_mm=24.0, thick_mm=1.0)


def round_ring_mm3(p: Any) -> float:
    """What a ball of 4 mm leaves in a fillet of 3 mm of the round part, in closed form."""
    return volume_under_ball(4.0, p) - volume_under_ball(3.0, p)


def volume_under_ball(radius: float, p: Any) -> float:
    """Between plate, the tube's inner side and a ball of this radius that touches both, turned about the axis.

    At a height z the ring reaches from the ball's surface, c + sqrt(r^2 - (z - r)^2), to the tube's,
    R - sqrt(t^2 - z^2), up to where both touch, z = t r / (t + r).
    """
    centre, _ = p.fillet(radius, -1)

    def ring(z: float) -> float:
        outer = p.ring_mm - math.sqrt(p.tube_mm**2 - z * z)
        inner = centre + math.sqrt(max(0.0, radius**2 - (z - radius) ** 2))
        return math.pi * (outer**2 - inner**2)

    return float(quad(ring, 0.0, p.tube_mm * radius / (p.tube_mm + radius), epsabs=1e-10)[0])


@pytest.fixture(scope="module")
def torus_part() -> SlicedPart:
    return part_of(solids.torus_example().torus(AROUND, 160, profile()), 0.05)


def test_a_ball_of_4_mm_leaves_the_closed_forms_ring_in_the_inner_fillet_and_nothing_in_the_outer(
    torus_part: SlicedPart,
) -> None:
    reach = tool_reach(torus_part, StructuringElement.ball(4.0))
    (ring,) = reach.uncut_regions
    p = profile()
    assert ring.volume_mm3 == pytest.approx(round_ring_mm3(p) * ROUND, rel=0.006)
    foot, own = (p.fillet(r, -1)[0] for r in (4.0, 3.0))
    # thickest on the line through both balls' centres
    assert ring.thickness_mm == pytest.approx(math.hypot(own - foot, 1.0) - 1.0, abs=0.002)
    # up to where the larger ball touches the tube; its thin ends fade below what slices can tell
    touch = p.ring_mm - (p.ring_mm - foot) * p.tube_mm / (p.tube_mm + 4.0)
    assert ring.high_mm[0] == pytest.approx(touch, abs=0.06)
    assert ring.high_mm[2] == pytest.approx(p.tube_mm * 4.0 / (p.tube_mm + 4.0), abs=0.15)
    assert ring.low_mm[2] == pytest.approx(0.0, abs=0.002)
    np.testing.assert_allclose(ring.centroid_mm[:2], 0.0, atol=1e-3)
    # no polygon reaches into the disc that the larger ball touches
    innermost = min(np.hypot(*np.array(h.coords).T).min() for piece in ring.pieces for h in piece.interiors)
    assert innermost > foot - 0.06


def test_the_ring_on_the_examples_own_stl_is_what_its_facets_leave() -> None:
    exact = ring_in_facets(4.0, 512, 160)
    part = slice_part(solids.torus(), 0.05)
    (ring,) = tool_reach(part, StructuringElement.ball(4.0)).uncut_regions
    assert ring.volume_mm3 == pytest.approx(exact.volume_mm3, rel=0.001)
    assert ring.volume_mm3 == pytest.approx(round_ring_mm3(solids.torus_example().PROFILE), rel=0.005)
    assert ring.thickness_mm == pytest.approx(exact.thickness_mm, abs=0.0005)
    np.testing.assert_allclose(ring.high_mm[:2], exact.touch_mm[0], atol=0.06)
    assert ring.high_mm[2] == pytest.approx(exact.touch_mm[1], abs=0.1)
    assert ring.low_mm[2] == pytest.approx(0.0, abs=1e-9)
    innermost = min(np.hypot(*np.array(h.coords).T).min() for piece in ring.pieces for h in piece.interiors)
    lowest = float(ring.planes_mm.min())
    assert innermost == pytest.approx(math.sqrt(16.0 - (4.0 - lowest) ** 2) + exact.foot_mm, abs=0.001)


def test_the_facets_of_the_examples_stl_leave_less_than_the_round_part_and_finer_ones_the_same() -> None:
    exact = round_ring_mm3(solids.torus_example().PROFILE)
    assert exact == pytest.approx(40.13, abs=0.005)
    assert ring_in_facets(4.0, 512, 96).volume_mm3 == pytest.approx(0.9886 * exact, rel=1e-4)
    assert ring_in_facets(4.0, 512, 160).volume_mm3 == pytest.approx(0.9960 * exact, rel=1e-4)
    assert ring_in_facets(4.0, 4096, 4096).volume_mm3 == pytest.approx(exact, rel=1e-4)


def half_size() -> Any:
    return solids.torus_example().Profile(
        ring_mm=9.0, tube_mm=3.0, outer_mm=2.0, inner_mm=1.5, half_mm=15.0, thick_mm=1.0
    )


@pytest.mark.parametrize("pitch", [0.08, 0.07, 0.06])
def test_faces_may_lie_anywhere_between_slices(pitch: float) -> None:
    part = part_of(solids.torus_example().torus(128, 96, half_size()), pitch)
    (ring,) = tool_reach(part, StructuringElement.ball(2.0)).uncut_regions
    assert ring.volume_mm3 == pytest.approx(ring_in_facets(2.0, 128, 96, half_size()).volume_mm3, rel=0.01)
    assert ring.low_mm[2] == pytest.approx(0.0, abs=1e-9)


def test_slices_that_run_along_the_ring_find_it_too() -> None:
    part = part_of(solids.torus_example().torus(64, 48, half_size()), 0.2)
    (ring,) = tool_reach(part, StructuringElement.ball(2.0), axis=0, thin_mm=0.05).uncut_regions
    exact = ring_in_facets(2.0, 64, 48, half_size())
    assert ring.volume_mm3 == pytest.approx(exact.volume_mm3, rel=0.02)
    assert ring.thickness_mm == pytest.approx(exact.thickness_mm, abs=0.01)


def test_a_ball_of_the_inner_fillet_finishes_the_part() -> None:
    part = slice_part(solids.torus(48, 96), 0.1)
    reach = tool_reach(part, StructuringElement.ball(3.0))
    assert reach.uncut_regions == () and reach.volume_mm3 == 0.0 and reach.thickness_mm == 0.0


@pytest.mark.parametrize("text", ["flat 4", "ball 4", "bull 4 r1"])
def test_corners_of_a_pocket(text: str) -> None:
    side, deep = 10.0, 6.0
    part = part_of(solids.pocket(side, deep), 0.1)
    reach = tool_reach(part, tool(text))
    shape = parse_tool(text)
    z = np.arange(0.0005, deep, 0.001)
    radius = shape.radius_mm(z)
    # at a height the tool clears its square of centres, grown by its radius there
    centres = side - 2.0 * shape.nominal_radius_mm
    cleared = centres**2 + 4.0 * centres * radius + math.pi * radius**2
    exact = float(np.sum(side**2 - cleared) * 0.001)
    assert reach.volume_mm3 == pytest.approx(exact, rel=0.01)
    if text == "flat 4":
        assert len(reach.uncut_regions) == 4
        assert reach.thickness_mm == pytest.approx(2.0 - math.sqrt(2.0), rel=0.02)
    assert reach.uncut_regions[0].high_mm[2] == pytest.approx(0.0, abs=0.1)


def test_a_tool_larger_than_the_pocket_leaves_it_full() -> None:
    part = part_of(solids.pocket(10.0, 6.0), 0.25)
    (whole,) = tool_reach(part, tool("flat 16")).uncut_regions
    assert whole.volume_mm3 == pytest.approx(600.0, rel=0.005)
    np.testing.assert_allclose(whole.low_mm, (-5.0, -5.0, -6.0), atol=1e-3)
    np.testing.assert_allclose(whole.high_mm, (5.0, 5.0, 0.0), atol=1e-3)
    assert whole.thickness_mm == pytest.approx(5.0, abs=0.1)
    np.testing.assert_allclose(whole.deepest_mm[:2], 0.0, atol=0.1)
    np.testing.assert_allclose(whole.centroid_mm, (0.0, 0.0, -3.0), atol=1e-3)


def test_what_lies_below_an_overhang_is_reached_from_a_side_but_not_from_above() -> None:
    outline = np.array(
        [(-8.0, 0.0), (8.0, 0.0), (8.0, 8.0), (-8.0, 8.0), (-8.0, 6.0), (2.0, 6.0), (2.0, 2.0), (-8.0, 2.0)]
    )
    part = part_of(solids.extruded(outline), 0.25)
    above = tool_reach(part, tool("ball 2"))
    assert above.volume_mm3 == pytest.approx(10.0 * 4.0 * 12.0, rel=0.01)
    around = tool_reach(part, StructuringElement.ball(1.0))
    # two sharp inner edges, 12 mm long
    assert around.volume_mm3 == pytest.approx(2.0 * 12.0 * (1.0 - 0.25 * math.pi), rel=0.1)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_direction_of_slices_does_not_matter(axis: int) -> None:
    outline = np.array([(-6.0, 0.0), (6.0, 0.0), (6.0, 3.0), (1.0, 3.0), (1.0, 7.0), (-6.0, 7.0)])
    part = part_of(solids.extruded(outline), 0.1)
    found = tool_reach(part, StructuringElement.ball(2.0), axis=axis)
    # the ball rolls along the edge, and beyond its ends
    exact = 12.0 * (4.0 - math.pi)
    assert found.volume_mm3 == pytest.approx(exact, rel=0.03)
    assert found.thickness_mm == pytest.approx(2.0 - math.sqrt(2.0), rel=0.08)


def test_leftovers_as_triangles_are_a_solid_of_the_same_volume() -> None:
    part = part_of(solids.pocket(10.0, 6.0), 0.5)
    for found, axis in (
        (tool_reach(part, tool("flat 4")), 2),
        (tool_reach(part, StructuringElement.ball(2.0), axis=1), 1),
    ):
        assert found.axis == axis
        mesh = uncut_mesh(found.uncut_regions)
        made = solid(mesh.vertices_mm[mesh.triangles], "leftovers")
        assert made.volume_mm3 == pytest.approx(found.volume_mm3, rel=1e-3)


def test_the_largest_ball() -> None:
    part = slice_part(solids.torus(32, 48), 0.4)
    tried: list[float] = []
    radius = largest_ball_mm(part, report=lambda r, _: tried.append(r))
    # noise of the slices hides what a slightly larger ball leaves
    assert radius is not None and 2.9 < radius < 4.5
    assert len(tried) < 12
    assert largest_ball_mm(part_of(solids.pocket(), 0.25)) is None
    with pytest.raises(ToolError, match=r"slice pitch 2 mm; expected below 0\.5 for a search"):
        largest_ball_mm(part_of(solids.box((0, 0, 0), (20, 20, 5)), 2.0))


def test_the_bound_grows_with_the_pitch_and_tools_from_above_need_slices_across_z() -> None:
    ball = StructuringElement.ball(4.0)
    assert thin_bound_mm(ball, 0.05) < thin_bound_mm(ball, 0.1) <= 0.1
    with pytest.raises(ValueError, match="tools from above need slices across z, got axis 0"):
        tool_reach(part_of(solids.box((0, 0, 0), (5, 5, 5)), 1.0), tool("flat 4"), axis=0)
