"""Straight passes as linear functions of the coefficients, against two other programs and closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.edge_integral import SOME, Pass
from support.straight_pass import golden_case, golden_names

from twin.identification.models.straight import NAMES, StraightPass, mean_matrix, reach_mm, response, strip_of
from twin.tools.shape import tool_shape

#: Level passes into fresh stock; in flat10_zero_helix_slot the reference's samples stand on the border of the cut.
LEVEL = [
    n
    for n in golden_names()
    if not golden_case(n)["ramp_deg"] and golden_case(n)["previous_pass_y_mm"] is None and "zero_helix" not in n
]


def golden_pass(name: str) -> StraightPass:
    case = golden_case(name)
    tool, (low, high) = case["tool"], case["stock_y_from_axis_mm"]
    corner = tool["corner_radius_mm"] if tool["kind"] == "bull" else 0.0
    height = max(case["axial_depth_mm"], 0.5 * tool["diameter_mm"])
    return StraightPass(
        shape=tool_shape(tool["kind"], tool["diameter_mm"], height, corner),
        helix_deg=tool["helix_deg"],
        pitch_rad=np.arange(tool["teeth"]) * 2.0 * math.pi / tool["teeth"],
        runout_mm=tool["runout_mm"],
        runout_rad=math.radians(tool["runout_angle_deg"]),
        axial_depth_mm=case["axial_depth_mm"],
        strip_mm=(-math.inf if low is None else low, math.inf if high is None else high),
        feed_per_rev_mm=case["feed_mm_min"] / case["spindle_rpm"],
    )


def zero_helix_slot(teeth: int) -> StraightPass:
    return StraightPass(
        shape=tool_shape("flat", 10.0, 5.0),
        helix_deg=0.0,
        pitch_rad=np.arange(teeth) * 2.0 * math.pi / teeth,
        axial_depth_mm=2.0,
        strip_mm=strip_of("slot", 5.0, 10.0),
        feed_per_rev_mm=0.1 * teeth,
    )


def coefficients(case: dict[str, dict[str, float]]) -> np.ndarray:
    return np.array([case["coefficients"][name] for name in NAMES])


@pytest.mark.parametrize("name", LEVEL)
def test_means_of_other_programs_are_linear_in_the_coefficients(name: str) -> None:
    case = golden_case(name)
    want = np.array(case["force_on_tool_n"]).mean(axis=0)
    got = mean_matrix(golden_pass(name)) @ coefficients(case)
    assert np.abs(got - want).max() <= 0.001 * np.linalg.norm(want)


@pytest.mark.parametrize("name", LEVEL)
def test_waveforms_of_other_programs(name: str) -> None:
    case = golden_case(name)
    want = np.array(case["force_on_tool_n"])
    quarter = response(golden_pass(name)) @ coefficients(case)
    # the response stands a quarter of a degree beside the whole degrees
    got = 0.5 * (quarter[(2 * np.arange(360) - 1) % 720] + quarter[2 * np.arange(360)])
    rms = np.sqrt(((got - want) ** 2).sum(axis=1).mean())
    assert rms <= 0.006 * np.sqrt((want**2).sum(axis=1)).max()


@pytest.mark.parametrize("name", LEVEL)
def test_the_mean_of_the_waveform_is_the_mean(name: str) -> None:
    given = golden_pass(name)
    want = mean_matrix(given)
    assert np.abs(response(given).mean(axis=0) - want).max() <= 0.001 * np.abs(want).max()


@pytest.mark.parametrize("teeth", [1, 2, 3, 4])
def test_zero_helix_slot_is_the_closed_form(teeth: int) -> None:
    depth, chip = 2.0, 0.1
    ktc, kte, krc, kre, kac, kae = SOME
    want = [
        -(teeth * depth / 4.0 * krc * chip + teeth * depth / math.pi * kre),
        teeth * depth / 4.0 * ktc * chip + teeth * depth / math.pi * kte,
        -(teeth * depth / math.pi * kac * chip + teeth * depth / 2.0 * kae),
    ]
    assert mean_matrix(zero_helix_slot(teeth)) @ SOME == pytest.approx(want, rel=1e-9)
    assert response(zero_helix_slot(teeth)).mean(axis=0) @ SOME == pytest.approx(want, rel=1e-4)


def test_no_force_beside_the_stock() -> None:
    given = golden_pass("bull16_half")
    none = StraightPass(
        shape=given.shape,
        helix_deg=25.0,
        pitch_rad=given.pitch_rad,
        axial_depth_mm=4.0,
        strip_mm=(8.0, math.inf),
        feed_per_rev_mm=0.2,
    )
    assert np.abs(response(none)).max() == 0.0
    assert np.abs(mean_matrix(none)).max() == 0.0


def test_up_and_down_are_mirror_images_in_the_radial_and_axial_terms() -> None:
    """Turned about the feed, radial and axial parts mirror in y; the tangential part turns its sign instead."""

    def side(direction: str) -> np.ndarray:
        return mean_matrix(
            StraightPass(
                shape=tool_shape("ball", 8.0, 8.0),
                helix_deg=30.0,
                pitch_rad=np.array([0.0, math.pi]),
                axial_depth_mm=3.0,
                strip_mm=strip_of(direction, 4.0, 2.0),  # type: ignore[arg-type]
                feed_per_rev_mm=0.1,
            )
        )

    up, down = side("up"), side("down")
    assert up[:, 2:] == pytest.approx(down[:, 2:] * np.array([[1.0], [-1.0], [1.0]]), abs=1e-12)
    assert up[:2, :2] == pytest.approx(down[:2, :2] * np.array([[-1.0], [1.0]]), abs=1e-12)
    # down milling presses the part down in y and pulls the tool along, up milling pushes it back
    assert down[0, 0] > 0.0 > up[0, 0]


@pytest.mark.parametrize(
    ("wall", "reach"), [((-math.inf, math.inf), 8.0), ((-math.inf, -4.0), math.sqrt(48.0)), ((-2.0, math.inf), 8.0)]
)
def test_reach_before_the_axis(wall: tuple[float, float], reach: float) -> None:
    given = golden_pass("bull16_slot_ap5")
    assert reach_mm(
        StraightPass(
            shape=given.shape,
            helix_deg=0.0,
            pitch_rad=given.pitch_rad,
            axial_depth_mm=5.0,
            strip_mm=wall,
            feed_per_rev_mm=0.1,
        )
    ) == pytest.approx(reach)


def test_the_integral_of_the_tests_agrees_with_the_golden_ones() -> None:
    case = golden_case("bull16_half")
    want = np.array(case["force_on_tool_n"])
    given = Pass(axial=4.0, wall=(0.0, math.inf), points=1500)
    got = given.forces(np.radians(np.arange(360.0)), coefficients(case))
    assert np.sqrt(((got - want) ** 2).sum(axis=1).mean()) <= 0.003 * np.sqrt((want**2).sum(axis=1)).max()
