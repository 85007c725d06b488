"""A known delay is found within a tenth of a sample, whatever the rate, the overlap, the noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.compared import log_of, run

from twin.arrays import frozen
from twin.comparison.comparison import compare
from twin.comparison.delay import better_axes, find_delay
from twin.comparison.phase import best_shift
from twin.errors import CompareError
from twin.measured.log import gaps_of
from twin.measured.settings import CompareSettings

#: Noise of a tenth of the signal: 20 dB.
SNR_20_DB = 0.1
RUN = run()


@pytest.mark.parametrize("rate_hz", [1200.0, 2048.0, 5000.0, 10000.0])
@pytest.mark.parametrize("lag_s", [0.0, 0.01234567, -0.3210987, 1.7654321])
def test_a_delay_is_found_within_a_tenth_of_a_sample(rate_hz: float, lag_s: float) -> None:
    log = log_of(RUN, lag_s=lag_s, noise=SNR_20_DB, rate_hz=rate_hz, span_s=(0.0, 7.6))
    found = find_delay(RUN, log)
    assert abs(found.lag_s - lag_s) * rate_hz < 0.1
    assert found.score == pytest.approx(1.0 / np.sqrt(1.0 + SNR_20_DB**2), abs=3e-3)


def test_the_largest_error_over_many_draws_stays_below_a_tenth() -> None:
    rng = np.random.default_rng(11)
    errors = []
    for seed in range(12):
        lag_s = float(rng.uniform(-1.0, 1.0))
        log = log_of(RUN, lag_s=lag_s, noise=SNR_20_DB, rate_hz=2500.0, seed=seed)
        errors.append(abs(find_delay(RUN, log).lag_s - lag_s) * 2500.0)
    assert max(errors) < 0.1


def test_a_log_longer_than_the_run_and_a_short_part_of_it() -> None:
    longer = log_of(RUN, lag_s=4.5, noise=SNR_20_DB, span_s=(0.0, 20.0), rate_hz=2500.0)
    assert find_delay(RUN, longer).lag_s == pytest.approx(4.5, abs=0.1 / 2500.0)
    entry = log_of(RUN, lag_s=2.0, noise=SNR_20_DB, span_s=(2.4, 3.6))
    assert find_delay(RUN, entry).lag_s == pytest.approx(2.0, abs=0.1 / 5000.0)


def test_offset_and_scale_do_not_move_the_delay() -> None:
    log = log_of(RUN, lag_s=0.25, add_n=(40.0, -20.0, 9.0))
    assert find_delay(RUN, log).lag_s == pytest.approx(0.25, abs=1e-6)


def test_a_steady_part_has_rivals() -> None:
    found = find_delay(RUN, log_of(RUN, span_s=(3.0, 3.1)))
    assert len(found.rivals_s) > 10
    within = find_delay(RUN, log_of(RUN, span_s=(3.0, 3.1)), within_s=0.004)
    assert within.lag_s == pytest.approx(0.0, abs=1e-5)


def test_of_equal_delays_the_one_is_taken_that_covers_the_windows_and_is_nearest_to_0() -> None:
    log = log_of(RUN, span_s=(4.0, 4.1), noise=0.02)
    assert find_delay(RUN, log).lag_s == pytest.approx(0.0, abs=2e-5)
    again = log_of(RUN, lag_s=-4.0, span_s=(0.0, 0.1), noise=0.02)
    found = find_delay(RUN, again, windows=((4.03, 4.08),))
    assert found.lag_s == pytest.approx(-4.0, abs=0.02 + 1e-4)
    assert abs(found.lag_s * 120.0 - round(found.lag_s * 120.0)) < 0.01


def test_no_overlap_within_reach() -> None:
    with pytest.raises(CompareError, match=r"no delay within 0.5 s at which the log follows the run; give it by --lag"):
        find_delay(RUN, log_of(RUN, lag_s=100.0, span_s=(100.0, 107.6)), within_s=0.5)


@pytest.mark.parametrize("order", [("x", "y", "z"), ("-y", "-x", "z"), ("z", "-x", "-y"), ("-x", "-y", "-z")])
def test_turned_axes_are_seen(order: tuple[str, str, str]) -> None:
    from dataclasses import replace

    from twin.arrays import frozen

    log = log_of(RUN, lag_s=0.3, noise=0.05, rate_hz=2500.0)
    columns = []
    for axis in "xyz":
        at = [o.lstrip("-") for o in order].index(axis)
        columns.append((-1.0 if order[at].startswith("-") else 1.0) * log.force_n[:, at])
    turned = replace(log, force_n=frozen(np.column_stack(columns), "force_n", (None, 3)))
    found, score = better_axes(RUN, turned)
    assert tuple(found[a] for a in "xyz") == order
    assert score > 0.97


def test_the_phase_of_a_window_is_found() -> None:
    t_s = 3.0 + np.arange(200) / 5000.0
    for shift in (-0.0071, 0.0, 0.0033):
        found, moved = best_shift(RUN.at, t_s, RUN.at(t_s + shift), 60.0 / 3600.0)
        assert np.mod(found - shift + 0.004, 60.0 / 3600.0 / 2) == pytest.approx(0.004, abs=2e-5)
        np.testing.assert_allclose(moved, RUN.at(t_s + shift), atol=1.0)


def test_parts_of_a_log_with_a_long_gap_between_them_are_compared() -> None:
    """Entry and exit of the cut, recorded apart: only together they show the delay of what lies between."""
    full = log_of(RUN, lag_s=-0.21, noise=0.02, rate_hz=2500.0, span_s=(0.3, 7.2))
    kept = (full.t_s < 1.0) | (full.t_s > 6.4)
    t_s = full.t_s[kept]
    log = replace(
        full,
        t_s=frozen(t_s, "t_s", (None,)),
        force_n=frozen(full.force_n[kept], "force_n", (None, 3)),
        gaps=gaps_of(t_s, 2500.0),
    )
    found = compare(RUN, log, CompareSettings())
    assert found.lag_s == pytest.approx(-0.21, abs=0.1 / 2500.0)
    assert len(found.t_s) == kept.sum()
    assert found.score > 0.99
    with pytest.raises(CompareError, match=r"the run, 0.0000 to 7.6000 s, lies in a gap of the log"):
        far = replace(log, t_s=frozen(np.where(t_s > 5.0, t_s + 20.0, t_s), "t_s", (None,)))
        compare(RUN, replace(far, gaps=gaps_of(far.t_s, 2500.0)), CompareSettings(lag_s=10.0))
