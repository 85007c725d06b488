"""Coefficients found again, by every method, from forces that another model made."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.cut_logs import cuts_in, logged, mean_tables
from support.edge_integral import BALL_CUTS, BULL_CUTS, SOME, Pass

from twin.errors import IdentifyError
from twin.identification.cuts.load import cuts_from_dict
from twin.identification.cuts.measure import Measured
from twin.identification.fit.harmonics import of_waveform
from twin.identification.identify import Prepared, identify, identify_prepared, prepare

FLAT_CUTS = tuple(
    Pass(corner=0.0, teeth=3, helix_deg=40.0, axial=axial, feed=feed, wall=wall)
    for axial, wall in ((2.0, (-math.inf, math.inf)), (4.0, (-math.inf, -4.0)))
    for feed in (90.0, 240.0)
)
METHODS = ("mean", "iterative", "waveform")


@pytest.mark.parametrize("passes", [BULL_CUTS, BALL_CUTS, FLAT_CUTS], ids=["bull", "ball", "flat"])
@pytest.mark.parametrize("method", ["mean", "iterative"])
def test_found_within_half_a_percent_from_means(passes: tuple[Pass, ...], method: Any) -> None:
    found = identify(cuts_from_dict(mean_tables(passes, SOME), "cuts.toml"), method)
    assert found.estimate.values == pytest.approx(SOME, rel=0.005)
    assert found.warnings == ()
    assert found.r_squared[0] > 0.99999


@pytest.fixture(scope="module")
def bull_logs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    folder = tmp_path_factory.mktemp("bull")
    return folder, logged(folder, BULL_CUTS[::2], SOME)


@pytest.mark.parametrize("method", METHODS)
def test_found_within_1_percent_from_logs_without_noise(bull_logs: tuple[Path, dict[str, Any]], method: Any) -> None:
    """Other axes, force on the part, offset, drift, phase and speed unknown."""
    found = identify(cuts_in(*bull_logs), method)
    assert found.estimate.values == pytest.approx(SOME, rel=0.01)
    assert found.r_squared[0] > 0.9999
    assert found.method == method


def test_one_cut_is_enough_for_a_waveform_but_not_for_means(bull_logs: tuple[Path, dict[str, Any]]) -> None:
    folder, data = bull_logs
    # a side cut: in a slot of two teeth the waveform hardly tells edge from chip
    alone = data | {"cuts": data["cuts"][2:3]}
    assert identify(cuts_in(folder, alone), "waveform").estimate.values == pytest.approx(SOME, rel=0.05)
    by_means = identify(cuts_in(folder, alone), "mean")
    assert not by_means.estimate.determined.any()
    assert any("not determined by these cuts (3 independent equations for 6" in w for w in by_means.warnings)


def synthetic(
    passes: tuple[Pass, ...], rng: np.random.Generator, noise_n: float, data: dict[str, Any]
) -> list[Prepared]:
    """Cuts whose waveforms have noise of their own at every angle, without files."""
    cuts = cuts_from_dict(data, "cuts.toml")
    made = []
    for given, p in zip(passes, prepare(cuts), strict=True):
        angle = (np.arange(180) + 0.5) * math.pi / 90.0
        force = given.forces(angle + rng.uniform(0.0, 2.0 * math.pi), SOME) + rng.normal(0.0, noise_n, (180, 3))
        c = of_waveform(force, 24, math.pi / 180.0)
        measured = Measured(mean_n=c[0].real, error_n=np.full(3, math.nan), harmonics=c, rpm=given.rpm)
        made.append(Prepared(p.cut, p.held_out, p.model, measured))
    return made


def test_intervals_of_waveforms_hold_the_truth() -> None:
    passes = tuple(p.but(points=1000) for p in (BULL_CUTS[0], BULL_CUTS[4], BULL_CUTS[8]))
    data = mean_tables(passes, SOME)
    cuts, rng, held = cuts_from_dict(data, "cuts.toml"), np.random.default_rng(5), np.zeros(6)
    for _ in range(30):
        found = identify_prepared(cuts, synthetic(passes, rng, 60.0, data), "waveform")
        held += np.abs(found.estimate.values - SOME) <= found.estimate.half_widths
    assert held.sum() >= 0.9 * 180, held
    assert held.sum() < 180


@pytest.mark.parametrize(("teeth", "degrees"), [(2, 130.0), (2, 310.0), (4, 50.0)])
def test_runout_and_phases_are_found_beside_the_coefficients(teeth: int, degrees: float) -> None:
    passes = tuple(
        p.but(teeth=teeth, runout=0.012, runout_deg=degrees, points=800)
        for p in (BULL_CUTS[0], BULL_CUTS[4], BULL_CUTS[8])
    )
    data = mean_tables(passes, SOME)
    cuts = cuts_from_dict(data | {"fit": {"runout": True}}, "cuts.toml")
    prepared = synthetic(passes, np.random.default_rng(2), 0.01, data)
    found = identify_prepared(cuts, prepared, "waveform")
    assert found.estimate.values == pytest.approx(SOME, rel=0.01)
    assert found.runout is not None
    assert found.runout.size_mm == pytest.approx(0.012, rel=0.01)
    # any of even teeth may be called the first
    assert math.degrees(found.runout.angle_rad) == pytest.approx(degrees % (360.0 / teeth), abs=1.0)
    for cut in found.cuts:
        assert (error := cut.waveform_error_n()) is not None
        assert error < 0.01 * np.linalg.norm(cut.measured.mean_n)
    without = identify_prepared(cuts_from_dict(data, "cuts.toml"), prepared, "waveform")
    assert any("does not repeat with each tooth: runout" in w for w in without.warnings)
    assert np.abs(without.estimate.values / SOME - 1.0).max() > 0.02


def test_a_given_phase_is_kept(tmp_path: Path) -> None:
    given = Pass(axial=4.0, wall=(0.0, math.inf))
    data = mean_tables((given,), SOME)
    data["cuts"][0] |= {"log": "x.csv", "spindle_angle_deg": 77.0}
    del data["cuts"][0]["mean_force_n"]
    (tmp_path / "x.csv").write_text("")
    cuts = cuts_from_dict(data, tmp_path / "cuts.toml")
    c = of_waveform(given.forces((np.arange(360) + 0.5) * math.pi / 180.0, SOME), 24, math.pi / 360.0)
    turned = c * np.exp(1j * math.radians(77.0) * np.arange(25))[:, None]
    measured = Measured(mean_n=c[0].real, error_n=np.full(3, math.nan), harmonics=turned, rpm=800.0)
    from twin.identification.models.model import pass_model

    assert cuts.tool is not None
    prepared = [Prepared(cuts.cuts[0], False, pass_model(cuts.tool, cuts.cuts[0], ""), measured)]
    found = identify_prepared(cuts, prepared, "waveform")
    assert found.cuts[0].phase_rad == pytest.approx(math.radians(77.0), abs=1e-12)
    assert found.estimate.values == pytest.approx(SOME, rel=0.02)


@pytest.mark.parametrize("method", METHODS)
def test_cuts_held_out_are_reported_and_never_fitted(bull_logs: tuple[Path, dict[str, Any]], method: Any) -> None:
    folder, data = bull_logs
    names = [c["name"] for c in data["cuts"]]
    without = identify(cuts_in(folder, data | {"cuts": data["cuts"][:-1]}), method)
    with_it = identify(cuts_in(folder, data, holdout=[names[-1]]), method)
    assert with_it.estimate.values.tolist() == without.estimate.values.tolist()
    assert with_it.estimate.errors.tolist() == without.estimate.errors.tolist()
    assert with_it.r_squared == without.r_squared
    assert [c.held_out for c in with_it.cuts] == [False] * (len(names) - 1) + [True]
    # and they are predicted
    last = with_it.cuts[-1]
    assert np.linalg.norm(last.residual_n) < 0.01 * np.linalg.norm(last.measured.mean_n)
    if method == "waveform":
        assert last.waveform_error_n() == pytest.approx(
            0.0, abs=0.01 * float(np.linalg.norm(last.measured.mean_n)) + 3.0
        )


def test_a_cut_held_out_may_be_nonsense() -> None:
    data = mean_tables(BULL_CUTS, SOME)
    data["cuts"][3] |= {"mean_force_n": [1e4, -1e4, 1e4], "holdout": True}
    assert identify(cuts_from_dict(data, "c.toml")).estimate.values == pytest.approx(SOME, rel=0.005)


def test_the_search_keeps_its_bounds_and_says_so() -> None:
    data = mean_tables(BULL_CUTS, SOME)
    fit = {"upper": {"Ktc": 1500.0}, "start": {"Ktc": 1000.0}}
    found = identify(cuts_from_dict(data | {"fit": fit}, "c.toml"), "iterative")
    assert found.estimate.values[0] == pytest.approx(1500.0)
    assert found.at_bounds == ("Ktc",)
    assert any("Ktc: at a bound of the search" in w for w in found.warnings)
    assert found.evaluations > 10


@pytest.mark.parametrize("method", ["iterative", "waveform"])
def test_equal_files_give_equal_results(bull_logs: tuple[Path, dict[str, Any]], method: Any) -> None:
    runs = [identify(cuts_in(*bull_logs), method).estimate.values.tolist() for _ in range(2)]
    assert runs[0] == runs[1]


def test_the_search_goes_to_the_same_place_from_elsewhere() -> None:
    data = mean_tables(BULL_CUTS, SOME)
    far = {"Ktc": 20000.0, "Kte": 500.0, "Krc": -3000.0, "Kre": 0.0, "Kac": 9000.0, "Kae": -200.0}
    found = identify(cuts_from_dict(data | {"fit": {"start": far}}, "c.toml"), "iterative")
    assert found.estimate.values == pytest.approx(SOME, rel=0.005)


def test_waveforms_are_refused_where_there_are_none() -> None:
    cuts = cuts_from_dict(mean_tables(BULL_CUTS, SOME), "cuts.toml")
    with pytest.raises(
        IdentifyError, match=r"cut 0_slot_80 has no waveform: it has a mean force only; use --method mean"
    ):
        identify(cuts, "waveform")


@pytest.mark.parametrize(
    ("changed", "warning"),
    [
        ({"force_on": "workpiece"}, "expected above 0: check map (signs, swapped axes), force_on, direction"),
        ({"unit": "kN"}, "check the unit of the forces (N, kN)"),
    ],
)
def test_wrong_signs_and_units_are_seen(changed: dict[str, str], warning: str) -> None:
    data = mean_tables(BULL_CUTS, SOME if "unit" not in changed else SOME * 1e-3)
    changed = {k: v for k, v in changed.items() if k != "unit"}
    found = identify(cuts_from_dict(data | {"defaults": changed}, "c.toml"))
    assert any(warning in w for w in found.warnings), found.warnings


@pytest.mark.parametrize(
    ("given", "hint"),
    [("x=Fy,y=Fx,z=Fz", "x = y, y = x, z = z"), ("x=-Fx,y=-Fy,z=-Fz", "x = -x, y = -y, z = -z")],
)
def test_axes_under_which_the_forces_would_fit_are_named(given: str, hint: str) -> None:
    data = mean_tables(BULL_CUTS, SOME)
    found = identify(cuts_from_dict(data | {"defaults": {"map": given}}, "c.toml"))
    assert found.warnings[-1] == f"mean forces would follow the model with {hint} of what the map gives"


def test_an_axis_that_was_not_measured_is_left_out() -> None:
    data = mean_tables(BULL_CUTS, SOME)
    found = identify(cuts_from_dict(data | {"defaults": {"map": "x=Fx,y=Fy"}}, "c.toml"))
    assert found.estimate.values == pytest.approx(SOME, rel=0.01)
    assert np.isnan(found.cuts[0].measured.mean_n[2])
    assert found.estimate.dof == 12
