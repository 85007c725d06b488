"""Linear estimates: what they find, how sure they say they are, and what they say they cannot tell."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.edge_integral import BALL_CUTS, SOME, Pass

from twin.identification.cuts.load import cuts_from_dict
from twin.identification.fit.least_squares import fit_linear, fixed_values
from twin.identification.models.model import pass_model
from twin.identification.models.straight import NAMES

PAPER = np.array([935.62, 2.0218, 416.73, 1.8238, 2.72e-05, 3.32e-06])
FREE = fixed_values({})


def design_of(passes: tuple[Pass, ...]) -> np.ndarray:
    data = {
        "tool": passes[0].tool(),
        "cuts": [p.cut(f"c{i}") | {"mean_force_n": [0, 0, 0]} for i, p in enumerate(passes)],
    }
    cuts = cuts_from_dict(data, "cuts.toml")
    assert cuts.tool is not None
    return np.concatenate([pass_model(cuts.tool, cut, "").means() for cut in cuts.cuts])


@pytest.fixture(scope="module")
def nine() -> np.ndarray:
    return design_of(BALL_CUTS)


def test_nine_cuts_of_table_5_have_the_condition_and_errors_that_were_derived_for_them(nine: np.ndarray) -> None:
    found = fit_linear(nine, nine @ PAPER, np.ones(27), FREE)
    assert found.values == pytest.approx(PAPER, rel=1e-6)
    assert found.condition == pytest.approx(5.7, abs=0.05)
    assert found.errors == pytest.approx([30.0, 0.37, 29.0, 0.31, 30.0, 0.37], rel=0.02)
    assert found.correlation[0, 1] == pytest.approx(-0.91, abs=0.005)
    assert (found.dof, found.rank) == (21, 6)


@pytest.mark.parametrize("known", [True, False])
def test_intervals_hold_the_truth_in_at_least_90_percent_of_200_noisy_draws(nine: np.ndarray, known: bool) -> None:
    rng = np.random.default_rng(7)
    noise_n = rng.uniform(0.2, 2.0, 27) if known else np.full(27, 0.7)
    held = np.zeros(6)
    for _ in range(200):
        found = fit_linear(nine, nine @ SOME + noise_n * rng.normal(size=27), noise_n if known else None, FREE)
        held += np.abs(found.values - SOME) <= found.half_widths
    assert held.min() >= 180, held
    # and they are not merely wide: 95 % intervals miss now and then
    assert held.sum() < 1200


def test_spread_between_cuts_is_found_beside_the_errors_of_the_means(nine: np.ndarray) -> None:
    rng = np.random.default_rng(3)
    spreads, held = [], np.zeros(6)
    for _ in range(200):
        values = nine @ SOME + rng.normal(0.0, 2.0, 27) + rng.normal(0.0, 0.1, 27)
        found = fit_linear(nine, values, np.full(27, 0.1), FREE)
        spreads.append(found.spread_n)
        held += np.abs(found.values - SOME) <= found.half_widths
    assert np.mean(spreads) == pytest.approx(2.0, rel=0.05)
    assert held.min() >= 180, held


def test_weights_follow_the_errors(nine: np.ndarray) -> None:
    errors = np.where(np.arange(27) < 9, 100.0, 0.01)
    values = nine @ SOME + np.where(np.arange(27) < 9, 30.0, 0.0)
    found = fit_linear(nine, values, errors, FREE)
    assert found.values == pytest.approx(SOME, rel=0.02)
    assert np.abs(fit_linear(nine, values, None, FREE).values / SOME - 1.0).max() > 0.1


def test_feed_regression_of_slots_is_a_special_case() -> None:
    """Ktc and Kte from the slope and intercept of mean Fy over the feed per tooth, as textbooks do it."""
    slots = tuple(Pass(corner=0.0, axial=3.0, feed=f) for f in (60.0, 100.0, 140.0, 200.0))
    rng = np.random.default_rng(1)
    design = design_of(slots)
    values = design @ SOME + rng.normal(size=12)
    found = fit_linear(design, values, None, FREE)
    chip = [p.feed / p.rpm / p.teeth for p in slots]
    slope, intercept = np.polyfit(chip, values[1::3], 1)
    assert found.values[0] == pytest.approx(slope * 4.0 / (2 * 3.0), rel=1e-9)
    assert found.values[1] == pytest.approx(intercept * math.pi / (2 * 3.0), rel=1e-9)
    slope, intercept = np.polyfit(chip, values[2::3], 1)
    assert found.values[4] == pytest.approx(-slope * math.pi / (2 * 3.0), rel=1e-9)
    assert found.values[5] == pytest.approx(-intercept * 2.0 / (2 * 3.0), rel=1e-9)


def test_one_cut_determines_nothing_and_one_feed_of_slots_not_either() -> None:
    one = design_of((Pass(),))
    found = fit_linear(one, one @ SOME, None, FREE)
    assert not found.determined.any()
    assert found.rank == 3
    assert math.isinf(found.condition)
    alike = design_of((Pass(corner=0.0), Pass(corner=0.0, axial=4.0)))
    assert not fit_linear(alike, alike @ SOME, None, FREE).determined.any()


def test_only_what_is_lost_is_called_undetermined() -> None:
    """Without Fz of flat tools nothing is known of the axial coefficients, all of the others."""
    design = design_of(tuple(Pass(corner=0.0, feed=f) for f in (60.0, 120.0, 240.0)))
    plane = np.delete(design, [2, 5, 8], axis=0)
    found = fit_linear(plane, plane @ SOME, None, FREE)
    assert found.determined.tolist() == [True] * 4 + [False] * 2
    assert found.values[:4] == pytest.approx(SOME[:4], rel=1e-9)
    assert np.isnan(found.errors[4:]).all()


def test_given_coefficients_are_not_touched(nine: np.ndarray) -> None:
    fixed = fixed_values({"Kac": 400.0, "Kae": 12.0})
    found = fit_linear(nine, nine @ SOME, None, fixed)
    assert found.values == pytest.approx(SOME, rel=1e-9)
    assert found.fixed.tolist() == [False] * 4 + [True] * 2
    assert found.errors[4:].tolist() == [0.0, 0.0]
    assert np.isnan(found.correlation[4, 0])
    everything = fit_linear(nine, nine @ SOME, None, fixed_values(dict(zip(NAMES, SOME.tolist(), strict=True))))  # type: ignore[arg-type]
    assert everything.rank == 0


def test_as_many_equations_as_coefficients_leave_the_errors_unknown_or_to_those_stated() -> None:
    two = design_of((Pass(), Pass(feed=320.0, axial=5.0, wall=(0.0, math.inf))))
    found = fit_linear(two, two @ SOME, None, FREE)
    assert found.values == pytest.approx(SOME, rel=1e-6)
    assert np.isnan(found.errors).all()
    assert np.isfinite(fit_linear(two, two @ SOME, np.ones(6), FREE).errors).all()
