"""Laws that forces obey whatever the tool: closed forms, periods, mirrors, air."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from support.straight_pass import StraightPass, golden_case

from twin.arrays import FloatArray
from twin.cutting.coefficients import CuttingCoefficients
from twin.cutting.engagement import Engager
from twin.cutting.forces import ForceModel
from twin.motion.sweep import Body, Sweep, SweptVolume
from twin.tolerance import Tolerance
from twin.tools.edges import cutting_edges
from twin.tools.shape import ToolShape, tool_shape
from twin.workpiece.removal import Removal
from twin.workpiece.stock import box_slices
from twin.workpiece.trislice import CellSlices

TOLERANCE = Tolerance.for_pitch(0.2)
COEFFICIENTS = CuttingCoefficients(Ktc=800.0, Kte=20.0, Krc=200.0, Kre=30.0, Kac=150.0, Kae=5.0, source="test")
NOTHING = SweptVolume([])
UNITS = ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae")
REVOLUTION = np.radians(np.arange(360.0))


def block(low: tuple[float, float, float], high: tuple[float, float, float], pitch: float = 0.2) -> CellSlices:
    return CellSlices(box_slices(np.array(low), np.array(high), pitch))


def forces_at(
    shape: ToolShape, stock: CellSlices, tip: FloatArray, feed: FloatArray, *, teeth: int = 2, sense: int = 1
) -> FloatArray:
    edges = cutting_edges(shape, teeth=teeth, helix_deg=30.0, axial_step_mm=0.2)
    engager = Engager(shape, edges, 360, "majority", TOLERANCE)
    found = engager.engage(tip, feed, 10.0, 0.05, stock, NOTHING)
    assert found is not None
    return ForceModel(edges, COEFFICIENTS, 360, TOLERANCE).forces(sense * REVOLUTION, sense, feed, 0.05 * teeth, found)


def test_zero_helix_slot_has_the_closed_form_means() -> None:
    case = golden_case("flat10_zero_helix_slot")
    pass_ = StraightPass(case)
    n, a, chip = case["tool"]["teeth"], case["axial_depth_mm"], case["feed_mm_min"] / case["spindle_rpm"] / 4
    k = case["coefficients"]
    # between whole degrees no tooth stands on the border of the cut; sums over whole degrees are good to 0.1 %
    found = pass_.model.forces(REVOLUTION + math.radians(0.5), 1, pass_.feed, pass_.per_rev_mm, pass_.engage(0.0))
    mean = found[:, :3].mean(axis=0)
    assert mean[0] == pytest.approx(-(n * a / 4 * k["Krc"] * chip + n * a / math.pi * k["Kre"]), rel=2e-3)
    assert mean[1] == pytest.approx(n * a / 4 * k["Ktc"] * chip + n * a / math.pi * k["Kte"], rel=2e-3)
    assert mean[2] == pytest.approx(-(n * a / math.pi * k["Kac"] * chip + n * a / 2 * k["Kae"]), rel=2e-3)


@pytest.mark.parametrize("runout_mm", [0.0, 0.01])
@pytest.mark.parametrize("sense", [1, -1])
def test_forces_per_unit_of_the_coefficients_are_those_of_a_pass_for_each(runout_mm: float, sense: int) -> None:
    shape, feed = tool_shape("bull", 8.0, 4.0, 1.0), np.array([0.6, 0.0, -0.8])
    edges = dataclasses.replace(cutting_edges(shape, teeth=2, helix_deg=30.0, axial_step_mm=0.5), runout_mm=runout_mm)
    tip = np.array([6.0, 0.0, -1.0])
    engaged = Engager(shape, edges, 36, "majority", TOLERANCE).engage(
        tip, feed, 10.0, 0.05, block((0, -5, -4), (12, 5, 0), 0.5), NOTHING
    )
    assert engaged is not None
    spindle = sense * np.radians(np.arange(0.0, 720.0, 10.0))
    units = [CuttingCoefficients(**dict(zip(UNITS, row, strict=True)), source="unit") for row in np.eye(6).tolist()]
    passes = [ForceModel(edges, k, 36, TOLERANCE).forces(spindle, sense, feed, 0.1, engaged) for k in units]
    found = ForceModel(edges, COEFFICIENTS, 36, TOLERANCE).unit_forces(spindle, sense, feed, 0.1, engaged)
    assert np.abs(found).max() > 0.0
    assert np.array_equal(found, np.stack(passes, axis=2)[:, :3])


@pytest.mark.parametrize("teeth", [1, 2, 3, 4])
def test_even_teeth_give_a_period_of_one_pitch(teeth: int) -> None:
    shape = tool_shape("ball", 8.0, 10.0)
    stock = block((0, -8, -6), (30, 8, 0))
    found = forces_at(shape, stock, np.array([12.0, 0.0, -2.0]), np.array([1.0, 0.0, 0.0]), teeth=teeth)
    assert found == pytest.approx(np.roll(found, 360 // teeth, axis=0))


@pytest.mark.parametrize("kind", ["flat", "ball"])
def test_mirrored_path_with_m4_mirrors_the_forces(kind: str) -> None:
    shape = tool_shape(kind, 8.0, 10.0)  # type: ignore[arg-type]
    feed = np.array([math.cos(0.3), math.sin(0.3), -0.1])
    feed /= np.linalg.norm(feed)
    mirror = np.array([1.0, -1.0, 1.0])
    right = forces_at(shape, block((0, 1, -6), (30, 9, 0)), np.array([12.0, 2.0, -2.0]), feed)
    left = forces_at(shape, block((0, -9, -6), (30, -1, 0)), np.array([12.0, -2.0, -2.0]), feed * mirror, sense=-1)
    assert left[:, :3] * mirror == pytest.approx(right[:, :3], abs=0.3)
    assert left[:, 3] == pytest.approx(right[:, 3], abs=0.3)


def test_no_force_in_air() -> None:
    shape = tool_shape("ball", 8.0, 10.0)
    edges = cutting_edges(shape, teeth=2, axial_step_mm=0.2)
    engager = Engager(shape, edges, 360, "majority", TOLERANCE)
    forward = np.array([1.0, 0.0, 0.0])
    stock = block((0, -8, -6), (30, 8, 0))
    assert engager.engage(np.array([10.0, 0.0, 0.5]), forward, 10.0, 0.05, stock, NOTHING) is None
    assert engager.engage(np.array([-9.0, 0.0, -2.0]), forward, 10.0, 0.05, stock, NOTHING) is None


@pytest.mark.compiled
@pytest.mark.parametrize("angle_deg", [0.0, 17.0, 45.0])
@pytest.mark.parametrize("kind", ["flat", "ball"])
def test_an_exact_retrace_cuts_next_to_nothing(kind: str, angle_deg: float) -> None:
    """The wall just made is known to half a pitch: only a narrow band along it, where n.f is small, may show."""
    shape = tool_shape(kind, 8.0, 10.0)  # type: ignore[arg-type]
    angle = math.radians(angle_deg)
    forward = np.array([math.cos(angle), math.sin(angle), 0.0])
    stock = block((-20, -20, -6), (20, 20, 0))
    edges = cutting_edges(shape, teeth=2, axial_step_mm=0.2)
    engager = Engager(shape, edges, 360, "majority", TOLERANCE)
    model = ForceModel(edges, COEFFICIENTS, 360, TOLERANCE)
    depth = np.array([0.0, 0.0, -2.0])
    found = engager.engage(depth, forward, 10.0, 0.05, stock, NOTHING)
    assert found is not None
    fresh, fresh_load = found.summary, model.forces(REVOLUTION, 1, forward, 0.1, found)
    sweep = Sweep(Body.of(shape, chord_mm=TOLERANCE.chord_mm), depth - 40.0 * forward, depth + 40.0 * forward)
    with Removal(stock, TOLERANCE.chord_mm) as removal:
        removal.cut(sweep)
        assert removal.cut(sweep) == pytest.approx(0.0, abs=1e-9)
    for x in (-5.0, 0.03, 4.71):
        for feed in (forward, -forward):
            found = engager.engage(x * forward + depth, feed, 10.0, 0.05, stock, NOTHING)
            if found is not None:
                load = model.forces(REVOLUTION, 1, feed, 0.1, found)
                assert found.summary.removal_rate_mm3_s < 0.006 * fresh.removal_rate_mm3_s
                assert np.linalg.norm(load[:, :3].mean(axis=0)) < 0.05 * np.linalg.norm(fresh_load[:, :3].mean(axis=0))


def test_pending_sweeps_count_as_cut() -> None:
    """A sweep that waits gives the same forces as one that is already out of the slices, to a slice's error."""
    shape = tool_shape("ball", 8.0, 10.0)
    sweep = Sweep(Body.of(shape, chord_mm=TOLERANCE.chord_mm), np.array([-6.0, 3.0, -2.0]), np.array([36.0, 3.0, -2.0]))
    edges = cutting_edges(shape, teeth=2, axial_step_mm=0.2)
    model = ForceModel(edges, COEFFICIENTS, 360, TOLERANCE)
    tip, feed = np.array([12.0, 0.0, -2.0]), np.array([1.0, 0.0, 0.0])
    waiting, cut = block((0, -8, -6), (30, 8, 0)), block((0, -8, -6), (30, 8, 0))
    with Removal(cut, TOLERANCE.chord_mm) as removal:
        removal.cut(sweep)
    engager = Engager(shape, edges, 360, "majority", TOLERANCE)
    loads = []
    for stock, pending in ((waiting, SweptVolume([sweep])), (cut, NOTHING)):
        found = engager.engage(tip, feed, 10.0, 0.05, stock, pending)
        assert found is not None
        loads.append(model.forces(REVOLUTION, 1, feed, 0.1, found))
    assert loads[0].mean(axis=0) == pytest.approx(loads[1].mean(axis=0), rel=0.01, abs=0.1)


def test_uneven_teeth_share_the_feed_by_their_pitch() -> None:
    """Without edge terms the mean force of a tool does not depend on how its teeth are spread."""
    case = golden_case("paper_table4_slot_ap2")
    without_edge_terms = dataclasses.replace(COEFFICIENTS, Kte=0.0, Kre=0.0, Kae=0.0)
    means = []
    for pitch in (None, (160.0, 200.0)):
        pass_ = StraightPass(case, edge_terms=False)
        shape = tool_shape("ball", 8.0, 10.0)
        edges = cutting_edges(shape, teeth=2, helix_deg=30.0, axial_step_mm=0.1, pitch_deg=pitch)
        model = ForceModel(edges, without_edge_terms, 360, pass_.tolerance)
        means.append(model.forces(REVOLUTION, 1, pass_.feed, pass_.per_rev_mm, pass_.engage(0.0)).mean(axis=0))
    assert means[1] == pytest.approx(means[0], rel=1e-3, abs=1e-3)


@pytest.mark.parametrize(("kind", "corner"), [("ball", 0.0), ("flat", 0.0), ("bull", 1.5)])
def test_a_plunge_removes_the_tools_section(kind: str, corner: float) -> None:
    """Straight down, n.f = cos(kappa): what looks down cuts, and its area is that of the tool's section."""
    stock = block((-8, -8, -9), (8, 8, 0))
    shape = tool_shape(kind, 8.0, 10.0, corner)  # type: ignore[arg-type]
    tip, down = np.array([0.0, 0.0, -5.0]), np.array([0.0, 0.0, -1.0])
    edges = cutting_edges(shape, teeth=2, axial_step_mm=0.2)
    found = Engager(shape, edges, 360, "majority", TOLERANCE).engage(tip, down, 10.0, 0.05, stock, NOTHING)
    assert found is not None
    assert found.summary.removal_rate_mm3_s == pytest.approx(16.0 * math.pi * 10.0, rel=2e-3)
    load = forces_at(shape, stock, tip, down)
    assert load[:, :2].mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-6)
    assert np.all(load[:, 2] > 0.0)


def test_end_edges_cut_in_ramps_steeper_than_their_dish_only() -> None:
    stock = block((-30, -8, -9), (30, 8, 0))
    shape = tool_shape("flat", 8.0, 10.0)
    axial = []
    for ramp_deg in (0.0, 1.9, 2.1, 5.0):
        ramp = math.radians(ramp_deg)
        load = forces_at(shape, stock, np.array([0.0, 0.0, -3.0]), np.array([math.cos(ramp), 0.0, -math.sin(ramp)]))
        axial.append(load[:, 2].mean())
    assert axial[1] == pytest.approx(axial[0], rel=0.02)
    # two teeth with end edges of 4 mm each press upwards: at least their edge force
    assert axial[2] > axial[1] + 2 * 4.0 * COEFFICIENTS.Kre
    assert axial[3] > axial[2]


def test_engagement_is_told_in_the_shops_terms() -> None:
    stock = block((0, -8, -6), (30, 8, 0))
    shape = tool_shape("ball", 8.0, 10.0)
    edges = cutting_edges(shape, teeth=2, axial_step_mm=0.2)
    engager = Engager(shape, edges, 360, "majority", TOLERANCE)
    found = engager.engage(np.array([12.0, 0.0, -1.93]), np.array([1.0, 0.0, 0.0]), 10.0, 0.05, stock, NOTHING)
    assert found is not None
    assert found.summary.axial_depth_mm == pytest.approx(1.93, abs=0.01)
    assert found.summary.radial_width_mm == pytest.approx(2.0 * math.sqrt(16.0 - 2.07**2), rel=0.01)
    assert math.degrees(found.summary.arc_rad) == pytest.approx(180.0, abs=1.5)
    assert found.summary.chip_thickness_mm == pytest.approx(0.05 * math.sqrt(16.0 - 2.07**2) / 4.0, rel=0.02)


def test_an_orthonormal_frame_turns_the_forces() -> None:
    """One element alone: the resultant is that of its tangential, radial and axial parts (rotation matrix)."""
    case = golden_case("paper_table4_slot_ap05")
    pass_ = StraightPass(case)
    found = pass_.engage(0.0)
    only = np.zeros_like(found.share)
    only[:, 3] = found.share[:, 3]
    single = type(found)(only, found.turn, found.summary)
    one_tooth = cutting_edges(tool_shape("ball", 8.0, 6.0), teeth=1, helix_deg=30.0, axial_step_mm=0.1)
    model = ForceModel(one_tooth, COEFFICIENTS, 360, pass_.tolerance)
    load = model.forces(REVOLUTION, 1, pass_.feed, 0.1, single)
    theta = one_tooth.theta_rad(0, 0.0)[3] - REVOLUTION
    chip = 0.1 * np.cos(theta) * np.sin(one_tooth.kappa_rad[3])
    db = one_tooth.element_length_mm[3]
    k = COEFFICIENTS
    parts = np.column_stack((k.Ktc * chip + k.Kte, k.Krc * chip + k.Kre, k.Kac * chip + k.Kae)) * db
    clear = np.cos(theta) > 0.05
    assert np.linalg.norm(load[clear, :3], axis=1) == pytest.approx(np.linalg.norm(parts[clear], axis=1))
    assert load[clear, 3] == pytest.approx(parts[clear, 0] * one_tooth.radius_mm[3])
