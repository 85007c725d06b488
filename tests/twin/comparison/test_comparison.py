"""A run compared with itself, shifted, mirrored, noisy, drifting: what was put in comes back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.compared import log_of, run, write_log

from twin.arrays import FloatArray, frozen
from twin.comparison.checks import check_units
from twin.comparison.comparison import Comparison, compare
from twin.comparison.harmonics import lines
from twin.comparison.metrics import axis_errors
from twin.comparison.run_forces import run_forces
from twin.errors import CompareError
from twin.measured.forces import read_forces
from twin.measured.log import AXES, ForceLog
from twin.measured.settings import CompareSettings

RUN = run()
WINDOWS = ((3.0, 3.02), (5.0, 5.02))


def mapped(log: ForceLog, matrix: FloatArray) -> ForceLog:
    return replace(log, force_n=frozen(log.force_n @ matrix.T, "force_n", (None, 3)))


def kinds(found: Comparison) -> list[str]:
    return [c.kind for c in found.corrections]


def test_a_run_is_its_own_equal() -> None:
    found = compare(RUN, log_of(RUN), CompareSettings(windows=WINDOWS, lag_s=0.0))
    for window in found.windows:
        assert [e.axis for e in window.errors] == ["x", "y", "z", "resultant"]
        for errors in window.errors:
            assert errors.mean_abs_n < 1e-9 and errors.max_n < 1e-9
            assert errors.ratio_of_means == pytest.approx(1.0) and errors.correlation == pytest.approx(1.0)
        assert all(line.measured_n == pytest.approx(line.simulated_n, abs=1e-9) for line in window.lines)
    assert kinds(found) == ["lag"] and found.warnings == ()


def test_an_error_that_was_put_in_comes_out() -> None:
    log = log_of(RUN, lag_s=0.2468, add_n=(5.0, -4.0, 3.0))
    found = compare(RUN, log, CompareSettings(windows=WINDOWS))
    assert found.lag_s == pytest.approx(0.2468, abs=1e-6)
    for window in found.windows:
        for axis, put in (("x", 5.0), ("y", 4.0), ("z", 3.0)):
            assert window.of(axis).mean_abs_n == pytest.approx(put, abs=0.05)
            assert window.of(axis).max_n == pytest.approx(put, abs=0.3)
        assert window.of("x").bias_n == pytest.approx(-5.0, abs=0.05)


def test_noise_that_was_put_in_comes_out() -> None:
    found = compare(RUN, log_of(RUN, lag_s=-0.1, noise=0.1), CompareSettings())
    assert found.windows[0].whole
    put = 0.1 * RUN.at(np.arange(0.0, 7.6, 2e-4)).std(axis=0)
    for axis, sigma in zip("xyz", put, strict=True):
        assert found.windows[0].of(axis).rms_n == pytest.approx(sigma, rel=0.05)
        assert found.windows[0].of(axis).mean_abs_n == pytest.approx(sigma * np.sqrt(2.0 / np.pi), rel=0.05)
    assert found.score == pytest.approx(0.995, abs=2e-3)


def test_offset_and_drift_are_taken_away_and_told() -> None:
    log = log_of(RUN, lag_s=0.3, add_n=(5.0, -4.0, 3.0), drift_n_s=(0.8, 0.4, -0.3), span_s=(0.0, 7.9))
    found = compare(RUN, log, CompareSettings(windows=WINDOWS, drift=True))
    assert kinds(found) == ["drift", "lag"]
    assert all(e.max_n < 0.1 for w in found.windows for e in w.errors)
    plain = log_of(RUN, lag_s=0.3, add_n=(5.0, -4.0, 3.0))
    found = compare(RUN, plain, CompareSettings(windows=WINDOWS, offset="air"))
    assert kinds(found) == ["offset", "lag"]
    np.testing.assert_allclose(found.corrections[0].values["offset_n"], (5.0, -4.0, 3.0), atol=1e-6)
    found = compare(RUN, plain, CompareSettings(windows=WINDOWS, offset=(5.0, -4.0, 3.0)))
    assert all(e.max_n < 0.01 for w in found.windows for e in w.errors)
    found = compare(RUN, plain, CompareSettings(windows=WINDOWS, offset=(0.1, 0.4)))
    assert all(e.max_n < 0.01 for w in found.windows for e in w.errors)


def test_mirrored_axes_get_the_map_that_turns_them_back() -> None:
    turned = mapped(log_of(RUN, noise=0.02), np.array([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
    found = compare(RUN, turned, CompareSettings())
    assert any('try --map "x=-Fy,y=-Fx,z=Fz"' in w for w in found.warnings)
    found = compare(RUN, mapped(log_of(RUN), -np.eye(3)), CompareSettings())
    assert any("try --force-on workpiece" in w for w in found.warnings)


def test_a_wrong_lag_is_told() -> None:
    found = compare(RUN, log_of(RUN, lag_s=0.5), CompareSettings(lag_s=0.497))
    assert any("0.500000 s: try --lag auto" in w for w in found.warnings)


def test_filters_are_put_on_both_or_on_the_log_alone() -> None:
    both = compare(RUN, log_of(RUN), CompareSettings(windows=WINDOWS, lag_s=0.0, lowpass_hz=200.0))
    alone = compare(RUN, log_of(RUN), CompareSettings(windows=WINDOWS, lag_s=0.0, lowpass_hz=200.0, filter_both=False))
    assert both.windows[0].of("y").max_n < 1e-3
    assert alone.windows[0].of("y").max_n > 3.0


def test_resampling_is_told_and_keeps_the_delay() -> None:
    found = compare(RUN, log_of(RUN, lag_s=0.123, rate_hz=20000.0), CompareSettings(resample_hz=4000.0))
    assert kinds(found) == ["resample", "lag"] and found.log.rate_hz == 4000.0
    assert found.lag_s == pytest.approx(0.123, abs=1e-5)


def test_a_spindle_that_runs_slower_is_told_and_each_window_finds_its_phase() -> None:
    log = log_of(RUN)
    slow = replace(log, t_s=frozen(log.t_s * 1.03, "t_s", (None,)), rate_hz=log.rate_hz / 1.03)
    found = compare(RUN, slow, CompareSettings(windows=WINDOWS, lag_s=0.0, phase=True))
    assert any("spindle at 3495 rpm, from its spectrum, expected the run's 3600 rpm" in w for w in found.warnings)
    without = compare(RUN, slow, CompareSettings(windows=WINDOWS, lag_s=0.0))
    assert found.windows[0].of("x").rms_n < 0.4 * without.windows[0].of("x").rms_n
    assert kinds(found) == ["lag", "phase", "phase"]


def test_gaps_are_left_out() -> None:
    log = log_of(RUN)
    hole = (log.t_s > 3.005) & (log.t_s < 3.012)
    holed = replace(
        log, t_s=frozen(log.t_s[~hole], "t_s", (None,)), force_n=frozen(log.force_n[~hole], "f", (None, 3)),
        gaps=((3.005, 3.012),),
    )  # fmt: skip
    found = compare(RUN, holed, CompareSettings(windows=WINDOWS, lag_s=0.0))
    assert not ((found.windows[0].t_s > 3.0051) & (found.windows[0].t_s < 3.0119)).any()
    assert found.windows[0].of("x").max_n < 1e-9


def test_two_axes_are_compared_alone() -> None:
    log = log_of(RUN)
    flat = log.force_n.copy()
    flat[:, 2] = 0.0
    two = replace(log, force_n=frozen(flat, "force_n", (None, 3)), axes=("x", "y"), channels=("Fx", "Fy", ""))
    found = compare(RUN, two, CompareSettings(windows=WINDOWS, lag_s=0.0))
    assert [e.axis for e in found.windows[0].errors] == ["x", "y", "resultant"]
    assert found.windows[0].of("resultant").max_n < 1e-9


@pytest.mark.parametrize("power", [-9, -6, -5, -4, 4, 5, 6, 9])
def test_a_scale_wrong_by_a_power_of_ten_is_refused_with_both_levels(power: int) -> None:
    log = log_of(RUN, lag_s=0.0)
    log = replace(log, force_n=frozen(log.force_n * 10.0**power, "force_n", (None, 3)))
    how = "smaller" if power < 0 else "larger"
    with pytest.raises(CompareError, match=rf"times {how} than the run's \(level .* N, expected about .* N\): counts"):
        compare(RUN, log, CompareSettings())
    found = compare(RUN, log, CompareSettings(unit="N"))
    assert any(f"times {how} than the run's" in w for w in found.warnings)


@pytest.mark.parametrize("factor", [0.01, 0.1, 10.0, 100.0])
def test_a_scale_wrong_by_ten_or_a_hundred_is_a_warning(factor: float) -> None:
    log = log_of(RUN, lag_s=0.0)
    log = replace(log, force_n=frozen(log.force_n * factor, "force_n", (None, 3)))
    found = compare(RUN, log, CompareSettings())
    assert any("is the unit or the sensitivity right" in w for w in found.warnings)


@pytest.mark.parametrize(("factor", "how", "unit"), [(1e-3, "smaller", "kN"), (1e3, "larger", "mN")])
def test_a_unit_wrong_by_a_thousand_is_refused(factor: float, how: str, unit: str) -> None:
    log = mapped(log_of(RUN), factor * np.eye(3))
    with pytest.raises(
        CompareError, match=rf"about (9\d\d|10\d\d) times {how} than the run's .* in {unit}\? .*--unit {unit}"
    ):
        compare(RUN, log, CompareSettings())
    found = compare(RUN, log, CompareSettings(unit="N"))
    assert any(f"times {how} than the run's" in w for w in found.warnings)


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("power", [-6, -3, 3, 6])
def test_one_channel_of_another_scale_is_refused(axis: str, power: int) -> None:
    log = mapped(log_of(RUN), np.diag(np.where(np.array(AXES) == axis, 10.0**power, 1.0)))
    how = "smaller" if power < 0 else "larger"
    with pytest.raises(CompareError, match=rf"F{axis} \(F{axis}\) is .*times {how} than .*expected about") as error:
        list(check_units(RUN, log, CompareSettings()))
    assert f"e.g. {axis}={10.0**-power:g}*F{axis};" in str(error.value)
    (warning,) = check_units(RUN, log, CompareSettings(unit="N"))
    assert warning == str(error.value)


def test_a_channel_without_a_signal_is_a_warning() -> None:
    (warning,) = check_units(RUN, mapped(log_of(RUN), np.diag([1.0, 1.0, 0.0])), CompareSettings())
    assert "Fz (Fz) is constant, expected about" in warning
    assert not list(check_units(RUN, mapped(log_of(RUN), np.diag([3.0, 0.3, -5.0])), CompareSettings()))


def test_newtons_called_kilonewtons_are_told(tmp_path: Path) -> None:
    path = write_log(tmp_path / "a.csv", log_of(RUN, rate_hz=1000.0), "t_s,Fx_kN,Fy_kN,Fz_kN")
    log = read_forces(path)
    with pytest.raises(CompareError, match=r"times larger than the run's .* in N\? Give the unit by --unit N;"):
        compare(RUN, log, CompareSettings())


def test_too_few_samples_a_tooth_are_told() -> None:
    found = compare(RUN, log_of(RUN, rate_hz=200.0), CompareSettings(lag_s=0.0))
    assert any("sampled at 200 Hz, below twice the tooth-passing frequency (120 Hz)" in w for w in found.warnings)
    found = compare(RUN, log_of(RUN, rate_hz=600.0), CompareSettings(lag_s=0.0))
    assert any("5.0 samples per tooth period" in w for w in found.warnings)


def test_no_overlap_names_both_spans() -> None:
    with pytest.raises(
        CompareError, match=r"no overlap in time: the log covers 0.0000 to 7.5998 s, with a lag of 50.0"
    ):
        compare(RUN, log_of(RUN), CompareSettings(lag_s=50.0))


def test_windows_outside_are_refused() -> None:
    with pytest.raises(CompareError, match=r"window 9:9.1: 0 samples .* the overlap is 0.0000 to 7.5998 s of the run"):
        compare(RUN, log_of(RUN), CompareSettings(windows=((9.0, 9.1),), lag_s=0.0))


def test_a_run_without_forces_is_refused() -> None:
    with pytest.raises(CompareError, match="a run without forces; replay its job with cutting coefficients"):
        run_forces(Path("run.mcap"), [])


def test_errors_by_hand() -> None:
    errors = axis_errors("x", np.array([1.0, -4.0, 3.0]), np.array([2.0, -2.0, 3.0]))
    assert (errors.mean_abs_n, errors.max_n, errors.bias_n) == (1.0, 2.0, 1.0)
    assert errors.rms_n == pytest.approx(np.sqrt(5.0 / 3.0))
    assert errors.ratio_of_peaks == pytest.approx(0.75)
    assert errors.ratio_of_means is None
    assert errors.rms_by_rms == pytest.approx(np.sqrt(5.0 / 26.0))
    constant = axis_errors("x", np.ones(5), np.arange(5.0))
    assert constant.correlation is None


def test_harmonics_by_hand() -> None:
    t_s = np.arange(170) / 5000.0  # 2.04 revolutions: no whole number
    turn = 2.0 * np.pi * 60.0 * t_s
    measured = 7.0 + 3.0 * np.cos(turn) + 10.0 * np.cos(2 * turn + 0.2) + 4.0 * np.sin(6 * turn)
    simulated = 6.0 + 9.0 * np.cos(2 * turn + 0.5) + 4.0 * np.sin(6 * turn)
    found = {e.order: e for e in lines(("x",), t_s, measured[:, None], simulated[:, None], -3600.0, 2)}
    assert found[1].tooth_order is None and found[1].measured_n == pytest.approx(3.0)
    assert found[2].tooth_order == 1 and found[2].hz == pytest.approx(120.0)
    assert (found[2].measured_n, found[2].simulated_n) == pytest.approx((10.0, 9.0))
    assert found[2].phase_rad == pytest.approx(0.3)
    assert found[6].tooth_order == 3 and found[6].measured_n == pytest.approx(4.0)
    assert lines(("x",), t_s[:20], measured[:20, None], simulated[:20, None], 3600.0, 2) == []
