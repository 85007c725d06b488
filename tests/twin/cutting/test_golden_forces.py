"""Forces of straight passes against waveforms made by two other programs (tests/golden/README.md)."""

from __future__ import annotations

import numpy as np
import pytest
from support.straight_pass import StraightPass, golden_case, golden_names

from twin.cutting.engagement import EngagementRule

pytestmark = pytest.mark.compiled

#: Steps are at 0.1 mm; these positions lie at every part of a slice's pitch.
FORWARD_MM = (0.0, 0.137, 0.274, 0.411)
#: Where a straight edge lies exactly on the boundary of the cut its force is undefined: the reference has the edge
#: force of one of the two teeth there by rounding, this program of neither (h = 0 is no chip).
ON_THE_BORDER = {"flat10_zero_helix_slot": (0, 90, 180, 270)}


@pytest.mark.parametrize("name", golden_names())
def test_mean_within_1_percent_and_waveform_within_its_limit(name: str) -> None:
    case = golden_case(name)
    found = [StraightPass(case).errors(f, ON_THE_BORDER.get(name, ())) for f in FORWARD_MM]
    if case["rms_pct_of_peak_at_0_1_mm"] is None:
        assert max(e.mean_pct for e in found) <= 1.0
        assert max(e.rms_pct for e in found) <= 2.0
    else:
        assert max(e.rms_pct for e in found) <= 1.5 * case["rms_pct_of_peak_at_0_1_mm"] + 1.0


def test_an_edge_on_the_border_of_the_cut_lies_between_the_values_next_to_it() -> None:
    pass_ = StraightPass(golden_case("flat10_zero_helix_slot"))
    spindle = np.radians([-0.01, 0.0, 0.01])
    beside = pass_.model.forces(spindle, 1, pass_.feed, pass_.per_rev_mm, pass_.engage(0.0))
    low, high = beside[[0, 2]].min(axis=0), beside[[0, 2]].max(axis=0)
    # one tooth leaves and one enters: both neighbours carry one edge force more than the border itself
    edge_n = 2.0 * np.hypot(27.7, 30.8)
    assert np.all(beside[1, :3] >= low[:3] - edge_n)
    assert np.all(beside[1, :3] <= high[:3] + edge_n)


@pytest.mark.parametrize("name", ["paper_B_f100", "t4_finish_down_ap0.1_ae0.25_prev"])
def test_error_falls_with_the_pitch(name: str) -> None:
    case = golden_case(name)
    errors = [
        np.mean([StraightPass(case, pitch_mm=pitch).errors(f).rms_pct for f in FORWARD_MM]) for pitch in (0.4, 0.2, 0.1)
    ]
    slope = np.polyfit(np.log([0.4, 0.2, 0.1]), np.log(errors), 1)[0]
    assert slope > 0.4, errors


@pytest.mark.parametrize("rule", ["any", "majority"])
def test_the_papers_rule_is_an_option_and_close_in_mean(rule: EngagementRule) -> None:
    error = StraightPass(golden_case("paper_table4_slot_ap2"), rule=rule).errors(0.0)
    assert error.mean_pct <= (4.0 if rule == "any" else 0.2)


@pytest.mark.parametrize("name", ["paper_table4_slot_ap2", "bull16_half", "flat16_helix40_half", "t4_ramp5_slot_ap2"])
def test_tangential_power_is_ktc_times_removal_rate_without_edge_terms(name: str) -> None:
    case = golden_case(name)
    pass_ = StraightPass(case, edge_terms=False)
    torque_nmm = pass_.waveform(0.137)[:, 3].mean()
    power_w = torque_nmm * 1e-3 * 2.0 * np.pi * case["spindle_rpm"] / 60.0
    per_map = pass_.engage(0.137).summary.removal_rate_mm3_s
    removed = np.mean([pass_.cut(pass_.feed * (19.0 + i), 1.0) for i in range(3)]) * case["feed_mm_min"] / 60.0
    ktc = case["coefficients"]["Ktc"]
    assert power_w == pytest.approx(ktc * per_map * 1e-3, rel=0.002)
    if not case["ramp_deg"]:
        assert power_w == pytest.approx(ktc * removed * 1e-3, rel=0.01)
