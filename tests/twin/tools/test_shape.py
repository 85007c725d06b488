"""Tool shapes and edges against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.errors import ToolError
from twin.tools.edges import cutting_edges, meridian
from twin.tools.shape import ToolShape, tool_shape


@pytest.mark.parametrize(
    ("kind", "extra", "z", "radius", "kappa_deg"),
    [
        ("ball", {}, 4.0, 4.0, 90.0),
        ("ball", {}, 2.0, math.sqrt(12.0), 60.0),
        ("ball", {}, 0.0, 0.0, 0.0),
        ("ball", {}, 15.0, 4.0, 90.0),
        ("flat", {}, 0.0, 4.0, 90.0),
        ("bull", {"corner_radius_mm": 1.0}, 0.5, 3.0 + math.sqrt(0.75), 60.0),
        ("bull", {"corner_radius_mm": 1.0}, 1.0, 4.0, 90.0),
        ("taper", {"taper_deg": 45.0}, 2.0, 6.0, 45.0),
        ("taper", {"taper_deg": 30.0, "corner_radius_mm": 4.0}, 2.0, math.sqrt(12.0), 60.0),
    ],
)
def test_radius_and_normal_angle(kind: str, extra: dict[str, float], z: float, radius: float, kappa_deg: float) -> None:
    shape = tool_shape(kind, 8.0, 20.0, **extra)  # type: ignore[arg-type]
    assert float(shape.radius_mm(z)) == pytest.approx(radius, abs=1e-12)
    assert math.degrees(float(shape.kappa_rad(z))) == pytest.approx(kappa_deg, abs=1e-9)


@given(
    corner=st.floats(0.0, 4.0),
    taper=st.floats(0.0, 40.0),
    step=st.floats(0.05, 2.0),
    length=st.floats(5.0, 30.0),
)
def test_edge_elements_cover_the_meridian_once(corner: float, taper: float, step: float, length: float) -> None:
    shape = tool_shape("taper", 8.0, length, corner_radius_mm=corner, taper_deg=taper)
    edges = cutting_edges(shape, teeth=2, axial_step_mm=step)
    arc = corner * (0.5 * math.pi - math.radians(taper))
    wall = (length - shape.arc_height_mm) / math.cos(math.radians(taper))
    assert edges.element_length_mm.sum() == pytest.approx(4.0 - corner + arc + wall, rel=1e-9)
    assert np.all(edges.element_length_mm > 0.0)
    assert edges.element_length_mm.max() <= 1.2 * step * (1.0 + 1e-9)
    assert np.all(np.diff(edges.z_mm) >= 0.0)
    assert np.all(np.diff(edges.radius_mm) >= 0.0)
    assert edges.bounds_mm[0] == 0.0


def test_depths_that_are_multiples_of_the_step_fall_between_elements() -> None:
    shape = tool_shape("ball", 8.0, 20.0)
    edges = cutting_edges(shape, teeth=2, axial_step_mm=0.1)
    ends = meridian(shape, edges.bounds_mm).height_mm
    for depth in (0.1, 0.5, 2.0, 4.0, 11.3):
        assert np.abs(ends - depth).min() < 1e-9


def test_element_positions_lie_on_the_tool_and_lag_behind_the_tip() -> None:
    shape = tool_shape("flat", 10.0, 12.0)
    edges = cutting_edges(shape, teeth=4, helix_deg=30.0, axial_step_mm=0.5)
    at = edges.positions_mm(1, 0.3)
    wall = edges.z_mm > 0.0
    assert np.hypot(at[:, 0], at[:, 1])[wall] == pytest.approx(np.full(wall.sum(), 5.0))
    theta = edges.theta_rad(1, 0.3)
    # M3 turns towards smaller angles; a lag keeps an element at a larger one
    assert theta == pytest.approx(-0.3 + math.pi / 2.0 + edges.z_mm * math.tan(math.radians(30.0)) / 5.0)
    assert edges.theta_rad(1, -0.3, clockwise=False) == pytest.approx(-theta)
    assert edges.normals(1, 0.3)[wall, :2] * 5.0 == pytest.approx(at[wall, :2])
    assert edges.normals(1, 0.3)[~wall] == pytest.approx(np.tile([0.0, 0.0, -1.0], ((~wall).sum(), 1)))


def test_uneven_teeth_stand_where_their_pitches_say() -> None:
    shape = tool_shape("flat", 10.0, 12.0)
    edges = cutting_edges(shape, teeth=3, axial_step_mm=1.0, pitch_deg=(100.0, 110.0, 150.0))
    assert np.degrees(edges.pitch_rad) == pytest.approx([0.0, 100.0, 210.0])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: tool_shape("bull", 8.0, 20.0, corner_radius_mm=5.0),
            "tool shape: corner_radius_mm = 5.0, expected at most half the diameter, 4.0",
        ),
        (
            lambda: tool_shape("ball", 8.0, 3.0),
            "tool shape: the corner arc ends 4.0 mm above the tip, expected not above the flute length 3.0 mm",
        ),
        (
            lambda: ToolShape(disc_mm=math.nan, corner_radius_mm=1.0, height_mm=3.0),
            "tool shape: disc_mm = nan, expected a finite number not below 0",
        ),
        (
            lambda: cutting_edges(tool_shape("flat", 8.0, 9.0), teeth=2, axial_step_mm=1.0, pitch_deg=(100.0, 200.0)),
            "cutting edges: pitch_deg = [100.0, 200.0], expected 2 angles above 0 summing to 360",
        ),
    ],
)
def test_refusals_say_what_was_expected(make: object, message: str) -> None:
    with pytest.raises(ToolError) as caught:
        make()  # type: ignore[operator]
    assert str(caught.value) == message


def test_the_profile_closes_on_the_shape() -> None:
    profile = tool_shape("bull", 16.0, 20.0, corner_radius_mm=3.0).profile_mm()
    assert profile[0].tolist() == [0.0, 0.0]
    assert profile[-1].tolist() == [8.0, 20.0]
    assert np.all(np.diff(profile[:, 0]) >= 0.0)
    assert np.all(np.diff(profile[:, 1]) >= 0.0)
