"""Corrections of logs: what was put in comes out, and each is on record."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.compared import log_of, run

from twin.arrays import FloatArray, frozen
from twin.errors import MeasuredError
from twin.measured.filters import Filter, filtered
from twin.measured.log import ForceLog, gaps_of
from twin.measured.spindle import spindle_speed
from twin.measured.steady import find_cut, steady_part
from twin.measured.uniform import resample, uniform
from twin.measured.zero import offset_of, remove_drift, shift_zero

RATE = 10000.0


def tone(hz: float, rate_hz: float = RATE, seconds: float = 1.0, phase: float = 0.4) -> ForceLog:
    t_s = np.arange(round(seconds * rate_hz)) / rate_hz
    wave = np.sin(2.0 * np.pi * hz * t_s + phase)
    return made(t_s, np.column_stack([wave, 2.0 * wave, -wave]), rate_hz)


def made(t_s: FloatArray, force_n: FloatArray, rate_hz: float = RATE) -> ForceLog:
    return replace(
        log_of(run(), span_s=(0.0, 0.01)),
        t_s=frozen(t_s, "t_s", (None,)),
        force_n=frozen(force_n, "force_n", (None, 3)),
        rate_hz=rate_hz,
        gaps=gaps_of(t_s, rate_hz),
    )


def amplitude(log: ForceLog, hz: float, axis: int = 0) -> complex:
    """Amplitude and phase against sin(2 pi hz t), from the middle half of the log."""
    n = len(log.t_s)
    part = slice(n // 4, n - n // 4)
    turn = 2.0 * np.pi * hz * log.t_s[part]
    cos, sin = np.linalg.lstsq(np.column_stack([np.cos(turn), np.sin(turn)]), log.force_n[part, axis], rcond=None)[0]
    return complex(sin, cos)


@pytest.mark.parametrize("hz", [50.0, 300.0, 500.0])
def test_a_zero_phase_low_pass_keeps_the_phase(hz: float) -> None:
    before, after = tone(hz), filtered(tone(hz), Filter(kind="lowpass", hz=500.0))
    turned = amplitude(after, hz) / amplitude(before, hz)
    assert np.angle(turned) == pytest.approx(0.0, abs=1e-6)
    gain = {50.0: 1.0, 500.0: 10 ** (-3.0103 / 20)}.get(hz)
    if gain is not None:
        assert abs(turned) == pytest.approx(gain, rel=1e-3)
    assert after.corrections[-1].kind == "lowpass" and "no phase shift" in after.corrections[-1].text


def test_a_causal_low_pass_is_late_by_what_it_states() -> None:
    used = Filter(kind="lowpass", hz=500.0, phase="causal")
    turned = amplitude(filtered(tone(20.0), used), 20.0) / amplitude(tone(20.0), 20.0)
    assert -np.angle(turned) / (2.0 * np.pi * 20.0) == pytest.approx(used.delay_s(), rel=0.01)
    assert f"{1e3 * used.delay_s():.3f} ms late" in used.text()


def test_a_low_pass_takes_away_what_lies_above() -> None:
    assert abs(amplitude(filtered(tone(2000.0), Filter(kind="lowpass", hz=500.0)), 2000.0)) < 1e-4


def test_a_notch_takes_its_frequency_only() -> None:
    used = Filter(kind="notch", hz=700.0, quality=20.0)
    assert abs(amplitude(filtered(tone(700.0, seconds=2.0), used), 700.0)) < 1e-3
    near = amplitude(filtered(tone(717.72), used), 717.72) / amplitude(tone(717.72), 717.72)
    assert abs(near) == pytest.approx(10 ** (-3.01 / 20), rel=0.01)
    far = amplitude(filtered(tone(120.0), used), 120.0) / amplitude(tone(120.0), 120.0)
    assert abs(far) == pytest.approx(1.0, abs=2e-3) and np.angle(far) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("kind", ["lowpass", "notch"])
def test_filters_above_half_the_rate_are_refused(kind: str) -> None:
    with pytest.raises(MeasuredError, match=r"at 5000 Hz: expected it below half the sampling rate, 5000 Hz"):
        filtered(tone(50.0), Filter(kind=kind, hz=5000.0))  # type: ignore[arg-type]


@pytest.mark.parametrize("rate_hz", [2000.0, 3333.0, 25600.0, 4096.0])
def test_resampling_keeps_time_and_phase(rate_hz: float) -> None:
    after = resample(tone(120.0), rate_hz)
    assert after.rate_hz == pytest.approx(rate_hz, rel=1e-6)
    turned = amplitude(after, 120.0) / amplitude(tone(120.0), 120.0)
    assert abs(turned) == pytest.approx(1.0, abs=2e-3)
    assert np.angle(turned) == pytest.approx(0.0, abs=1e-3)


def test_resampling_makes_no_aliases() -> None:
    # 1900 Hz would come back as 100 Hz at a rate of 2000 Hz
    assert abs(amplitude(resample(tone(1900.0), 2000.0), 100.0)) < 2e-3
    assert abs(np.interp(0.5, tone(1900.0).t_s[::5], tone(1900.0).force_n[::5, 0])) > 0.1


def test_resampling_to_nothing_is_refused() -> None:
    with pytest.raises(MeasuredError, match="rate -1 Hz, expected a number above 0"):
        resample(tone(50.0), -1.0)
    with pytest.raises(MeasuredError, match="leaves less than 2 of 10000 samples"):
        resample(tone(50.0), 1e-3)


def test_uneven_samples_are_put_on_a_grid() -> None:
    rng = np.random.default_rng(3)
    t_s = (np.arange(5000) + rng.uniform(-0.3, 0.3, 5000)) / RATE
    log = uniform(made(t_s, np.column_stack([np.sin(2 * np.pi * 60.0 * t_s)] * 3)))
    np.testing.assert_allclose(np.diff(log.t_s), 1.0 / RATE, rtol=1e-6)
    np.testing.assert_allclose(log.force_n[:, 0], np.sin(2 * np.pi * 60.0 * log.t_s), atol=2e-3)
    assert "even grid" in log.notes[-1]


def test_gaps_stay_gaps_and_filters_do_not_cross_them() -> None:
    t_s = np.arange(4000) / RATE
    force = np.column_stack([np.where(t_s < 0.15, 5.0, -3.0)] * 3)
    keep = (t_s < 0.1) | (t_s > 0.2)
    log = filtered(made(t_s[keep], force[keep]), Filter(kind="lowpass", hz=100.0))
    inside = (log.t_s < 0.0999) | (log.t_s > 0.2001)
    np.testing.assert_allclose(log.force_n[inside], force[inside], atol=1e-9)
    assert len(log.gaps) == 1 and log.gaps[0] == pytest.approx((0.1, 0.2), abs=1.5e-4)


def test_most_of_a_log_missing_is_refused() -> None:
    t_s = np.concatenate([np.arange(10) / RATE, 100.0 + np.arange(10) / RATE])
    with pytest.raises(MeasuredError, match="most of the log is missing"):
        uniform(made(t_s, np.zeros((20, 3))))


def test_parts_with_a_long_gap_between_them_are_put_on_one_grid() -> None:
    t_s = np.concatenate([np.arange(100) / RATE, 5.0 + np.arange(100) / RATE])
    log = uniform(made(t_s, np.ones((200, 3))))
    assert log.gaps == ((t_s[99], t_s[100]),)
    assert "gaps take no part" in log.notes[-1]
    with pytest.raises(MeasuredError, match=r"a gap of 50000 s, from .* is too long .* split the log there"):
        uniform(made(np.where(t_s < 1.0, t_s, t_s + 49995.0), np.ones((200, 3))))


def test_offset_and_drift_are_found_in_air() -> None:
    log = log_of(run(), add_n=(3.0, -2.0, 1.0), drift_n_s=(0.5, -0.2, 0.1), noise=0.01)
    air = ((0.0, 0.9), (7.1, 7.6))
    flat = remove_drift(log, air)
    np.testing.assert_allclose(flat.corrections[-1].values["drift_n_s"], (0.5, -0.2, 0.1), atol=0.01)
    np.testing.assert_allclose(flat.force_n, log_of(run(), noise=0.01).force_n, atol=0.1)
    zero = offset_of(log, ((0.0, 0.1),))
    np.testing.assert_allclose(zero, (3.025, -2.01, 1.005), atol=0.06)
    shifted = shift_zero(log, (1.0, 2.0, 3.0))
    np.testing.assert_allclose(shifted.force_n, log.force_n - [1.0, 2.0, 3.0])
    assert shifted.corrections[-1].text == "offset x 1 N, y 2 N, z 3 N subtracted, as given"


def test_air_must_be_there_and_at_both_ends_for_a_line() -> None:
    log = log_of(run())
    with pytest.raises(MeasuredError, match=r"no samples in the air segments \(9.0000 to 9.5000 s\), the log covers"):
        offset_of(log, ((9.0, 9.5),))
    with pytest.raises(MeasuredError, match="air at both ends of the log"):
        remove_drift(log, ((0.0, 0.5),))


@pytest.mark.parametrize("rpm", [3600.0, 3547.0, 4211.0])
def test_spindle_speed_from_the_spectrum(rpm: float) -> None:
    turn = 2.0 * np.pi * rpm / 60.0 * np.arange(10000) / RATE
    rng = np.random.default_rng(1)
    wave = np.column_stack([40.0 + 10.0 * np.sin(turn) + 30.0 * np.sin(2 * turn) + 9.0 * np.cos(6 * turn + 1.0)] * 3)
    found = spindle_speed(made(np.arange(10000) / RATE, wave + rng.normal(size=wave.shape)), 2, 3600.0)
    assert found is not None
    assert found.rpm == pytest.approx(rpm, abs=0.5)
    assert found.source == "spectrum"


def test_noise_tells_no_speed() -> None:
    noise = np.random.default_rng(1).normal(size=(20000, 3))
    assert spindle_speed(made(np.arange(20000) / RATE, noise), 2, 3600.0) is None


def test_pulses_tell_the_speed_before_the_spectrum() -> None:
    log = replace(tone(120.0), trigger_s=frozen(np.arange(50) / 59.0, "trigger_s", (None,)))
    found = spindle_speed(log, 2, 3600.0)
    assert found is not None and found.source == "trigger" and found.rpm == pytest.approx(3540.0)


def test_the_steady_cut_is_found_by_the_log_itself() -> None:
    t_s = np.arange(30000) / RATE
    level = np.interp(t_s, [0.0, 0.5, 0.7, 2.2, 2.3, 3.0], [0.0, 0.0, 80.0, 80.0, 0.0, 0.0])
    rng = np.random.default_rng(5)
    wave = level[:, None] * (1.0 + 0.3 * np.sin(2 * np.pi * 100.0 * t_s))[:, None] + rng.normal(size=(30000, 3))
    found = find_cut(t_s, wave, 0.02, 2)
    assert 0.5 < found.cut_s[0] < 0.62 and 2.22 < found.cut_s[1] < 2.31
    (first, touch), (leave, last) = found.air_s
    assert first == t_s[0] and touch < 0.5 and leave > 2.3 and last == t_s[-1]
    steady = steady_part(found, 2.0, 10.0, 0.02)
    assert steady is not None and 0.7 < steady[0] < 0.84 and 2.0 < steady[1] < 2.2
    throughout = find_cut(t_s, tone(100.0, seconds=3.0).force_n, 0.02, 2)
    assert throughout.cut_s == (t_s[0], t_s[-1]) and throughout.air_s == ()
