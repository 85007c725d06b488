"""Logs of cuts: where the cut is, its zero, its speed, its mean with an honest error, its waveform."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.cut_logs import QUARTER_TURN, write_log
from support.edge_integral import SOME, Pass, log_rows

from twin.errors import IdentifyError
from twin.identification.cuts.fit_settings import Fit
from twin.identification.cuts.load import cuts_from_dict
from twin.identification.cuts.measure import harmonic_count
from twin.identification.fit.harmonics import find_speed, of_samples, of_waveform, to_waveform
from twin.identification.identify import Prepared, identify, prepare
from twin.measured.steady import find_cut, steady_part

SIDE = Pass(
    diameter=8.0, corner=4.0, helix_deg=30.0, rpm=3600.0, feed=1200.0, axial=3.0, wall=(-math.inf, 0.0), points=200
)


def one_cut(folder: Path, given: Pass, t: np.ndarray, force: np.ndarray, **keys: Any) -> Prepared:
    write_log(folder / "log.csv", t, force)
    cut = given.cut("a") | {"log": "log.csv"} | keys
    data = {"tool": given.tool(), "defaults": dict(QUARTER_TURN), "cuts": [cut]}
    return prepare(cuts_from_dict(data, folder / "cuts.toml"))[0]


def entering(rate_hz: float, length_mm: float = 12.0) -> tuple[np.ndarray, np.ndarray]:
    """A cut whose force grows while the tool enters and falls while it leaves; zero before and behind."""
    speed, reach = SIDE.feed / 60.0, 4.0
    air_s = 0.4
    t = np.arange(0.0, 2.0 * air_s + (length_mm + 2.0 * reach) / speed, 1.0 / rate_hz)
    way = (t - air_s) * speed - reach
    part = np.clip((way + reach) / reach, 0.0, 1.0) * np.clip((length_mm - way) / reach, 0.0, 1.0)
    return t, SIDE.forces(SIDE.rpm * math.pi / 30.0 * t + 1.0, SOME) * part[:, None]


@pytest.mark.parametrize("noise_n", [0.0, 15.0])
def test_the_steady_cut_lies_between_entry_and_exit(tmp_path: Path, noise_n: float) -> None:
    t, force = entering(6000.0)
    noise = np.random.default_rng(1).normal(0.0, noise_n, force.shape)
    drift = np.array([20.0, -7.0, 3.0]) + np.outer(t, [4.0, -2.0, 9.0])
    found = one_cut(tmp_path, SIDE, t, force + noise + drift).measured
    assert found.window_s is not None
    # 4 mm in at 20 mm/s after 0.4 s of air; the exit begins 8 mm later
    assert 0.6 <= found.window_s[0] < 0.75
    assert 0.85 < found.window_s[1] <= 1.0
    assert found.drift_n_s == pytest.approx([4.0, -2.0, 9.0], abs=0.02 + noise_n)
    want = SIDE.mean(SOME)
    assert found.mean_n == pytest.approx(want, abs=0.002 * float(np.linalg.norm(want)) + 0.1 * noise_n)
    assert found.rpm == pytest.approx(3600.0, abs=1.0 + 0.2 * noise_n)


def test_standard_errors_of_means_are_right(tmp_path: Path) -> None:
    rng, off, told = np.random.default_rng(4), [], []
    t, force = log_rows(SIDE, SOME, rate_hz=2500.0, air_s=0.4, cut_s=0.6, phase_rad=0.3)
    exact = one_cut(tmp_path, SIDE, t, force, window_s=[0.45, 0.95]).measured.mean_n
    for _ in range(25):
        noisy = force + rng.normal(0.0, 40.0, force.shape)
        found = one_cut(tmp_path, SIDE, t, noisy, window_s=[0.45, 0.95]).measured
        off.append(found.mean_n - exact)
        told.append(found.error_n)
    assert np.sqrt(np.mean(np.square(off))) == pytest.approx(float(np.mean(told)), rel=0.25)


@pytest.mark.parametrize("zero", ["auto", "line", "constant", "none"])
def test_zero_is_taken_off_as_asked(tmp_path: Path, zero: str) -> None:
    t, force = log_rows(SIDE, SOME, rate_hz=3170.0, air_s=0.4, cut_s=0.5, phase_rad=0.3)
    found = one_cut(tmp_path, SIDE, t, force + 10.0, window_s=[0.45, 0.85], zero=zero)
    off = found.measured.mean_n - SIDE.mean(SOME)
    assert off == pytest.approx([10.0 if zero == "none" else 0.0] * 3, abs=0.4)
    word = "zero not corrected: as requested" if zero == "none" else "subtracted, by air from"
    assert any(word in note for note in found.measured.notes)


def test_air_may_be_given(tmp_path: Path) -> None:
    t, force = log_rows(SIDE, SOME, rate_hz=3170.0, air_s=0.4, cut_s=0.5, phase_rad=0.3)
    force = np.where(t[:, None] < 0.2, force + 50.0, force)
    found = one_cut(tmp_path, SIDE, t, force, window_s=[0.45, 0.85], air_s=[[0.0, 0.19]])
    assert found.measured.zero_n == pytest.approx([50.0] * 3)


def test_a_log_without_air_is_all_cut_and_says_that_its_zero_is_unknown(tmp_path: Path) -> None:
    t, force = log_rows(SIDE, SOME, rate_hz=3000.0, air_s=0.0, cut_s=0.6, phase_rad=0.3)
    write_log(tmp_path / "log.csv", t, force)
    data = {"tool": SIDE.tool(), "defaults": dict(QUARTER_TURN), "cuts": [SIDE.cut("a") | {"log": "log.csv"}]}
    found = identify(cuts_from_dict(data, tmp_path / "cuts.toml"), "waveform")
    assert found.cuts[0].measured.window_s == pytest.approx((0.0, 0.6), abs=0.02)
    assert any("a: no air in the log, zero not corrected" in w for w in found.warnings)
    data["cuts"][0]["zero"] = "line"
    with pytest.raises(IdentifyError, match='no air found for zero = "line"; give air_s'):
        prepare(cuts_from_dict(data, tmp_path / "cuts.toml"))


def test_windows_outside_the_log_and_too_short_ones_are_refused(tmp_path: Path) -> None:
    t, force = log_rows(SIDE, SOME, rate_hz=3000.0, air_s=0.3, cut_s=0.4, phase_rad=0.3)
    with pytest.raises(
        IdentifyError,
        match=r"cuts.toml: cut a: .*log.csv: window 0.5 to 7 s is not in the log, which has 0.0000 to 0.9997 s",
    ):
        one_cut(tmp_path, SIDE, t, force, window_s=[0.5, 7.0])
    with pytest.raises(
        IdentifyError, match=r"0.51 s has 31 samples, expected a whole revolution: 0.0167 s at 3600 rpm"
    ):
        one_cut(tmp_path, SIDE, t, force, window_s=[0.5, 0.51])
    with pytest.raises(IdentifyError, match=r"too short to have a steady part: the tool enters and leaves for 0.19"):
        one_cut(tmp_path, SIDE, t, force)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"map": "x=Fq,y=Fx,z=Fz"}, "cut a: axis map 'x=Fq,y=Fx,z=Fz': no column 'Fq'; columns are Fx_N, Fy_N, Fz_N"),
        ({"columns": ["t_s", "Fx_N"]}, "cut a: "),
        ({"unit": "mm"}, "expected a unit of force"),
    ],
)
def test_logs_that_do_not_say_what_is_asked(tmp_path: Path, keys: dict[str, Any], message: str) -> None:
    t, force = log_rows(SIDE, SOME, rate_hz=2000.0, air_s=0.1, cut_s=0.2, phase_rad=0.3)
    with pytest.raises(IdentifyError) as caught:
        one_cut(tmp_path, SIDE, t, force, **keys)
    assert message in str(caught.value)


def test_too_few_samples_for_the_teeth(tmp_path: Path) -> None:
    t, force = log_rows(SIDE, SOME, rate_hz=210.0, air_s=0.4, cut_s=2.0, phase_rad=0.3)
    write_log(tmp_path / "log.csv", t, force)
    cut = SIDE.cut("a") | {"log": "log.csv", "window_s": [0.5, 2.3]}
    data = {"tool": SIDE.tool(), "defaults": dict(QUARTER_TURN), "cuts": [cut]}
    found = identify(cuts_from_dict(data, tmp_path / "cuts.toml"), "mean")
    assert any("a: 3.50 samples per revolution, expected more than 4" in w for w in found.warnings)


def test_another_speed_than_given_is_seen(tmp_path: Path) -> None:
    t, force = log_rows(SIDE.but(rpm=3000.0), SOME, rate_hz=3000.0, air_s=0.4, cut_s=1.0, phase_rad=0.3)
    write_log(tmp_path / "log.csv", t, force)
    cut = SIDE.cut("a") | {"log": "log.csv", "window_s": [0.5, 1.3]}
    data = {"tool": SIDE.tool(), "defaults": dict(QUARTER_TURN), "cuts": [cut]}
    found = identify(cuts_from_dict(data, tmp_path / "cuts.toml"), "mean")
    assert any("3000" in w and "3600" in w for w in found.warnings), found.warnings


@pytest.mark.parametrize(("turns", "samples"), [(1, 360), (2, 360), (1, 90)])
def test_a_revolution_is_enough(tmp_path: Path, turns: int, samples: int) -> None:
    """Logs may hold a single revolution: as many samples as fill it, the last one before the first would come again."""
    angle = np.arange(turns * samples) * 2.0 * math.pi / samples
    force = SIDE.but(points=1000).forces(angle + 0.2, SOME)
    found = one_cut(tmp_path, SIDE, angle * 60.0 / SIDE.rpm / (2.0 * math.pi), force).measured
    assert found.mean_n == pytest.approx(force.mean(axis=0), abs=0.02)
    assert found.rpm == 3600.0
    assert found.harmonics is not None
    assert found.harmonics[0].real == pytest.approx(
        force.mean(axis=0), abs=0.02 * float(np.linalg.norm(force.mean(axis=0)))
    )
    assert any("too few revolutions to find it" in note for note in found.notes)


def test_a_log_over_the_spindles_angle(tmp_path: Path) -> None:
    degrees = np.arange(0.0, 1440.0, 2.0)
    force = SIDE.forces(np.radians(degrees), SOME)
    table = np.column_stack((degrees, force))
    np.savetxt(tmp_path / "log.csv", table, delimiter=",", header="angle_deg,Fx_N,Fy_N,Fz_N", comments="", fmt="%.5f")
    data = {"tool": SIDE.tool(), "cuts": [SIDE.cut("a") | {"log": "log.csv"}]}
    found = prepare(cuts_from_dict(data, tmp_path / "cuts.toml"))[0].measured
    assert found.mean_n == pytest.approx(force.mean(axis=0), abs=1e-3 * float(np.abs(force).max()))


def test_find_cut_tells_air_from_cut_by_the_variation_alone() -> None:
    t, force = entering(4000.0)
    found = find_cut(t, force + 1e4, 1.0 / 60.0, 2)
    assert found.begins
    assert found.ends
    assert 0.4 < found.cut_s[0] < 0.5
    assert all(b <= 0.4 or a >= 1.2 for a, b in found.air_s)
    assert steady_part(found, 4.0, 20.0, 1.0 / 60.0) is not None
    assert steady_part(found, 40.0, 20.0, 1.0 / 60.0) is None


@pytest.mark.parametrize(
    ("keys", "samples", "count"),
    [
        ({}, 1000.0, 24),
        ({}, 30.0, 12),
        ({"harmonics": 8}, 1000.0, 8),
        ({"lowpass_hz": 600.0}, 1000.0, 10),
        ({}, 2.0, 0),
    ],
)
def test_how_many_harmonics_are_compared(keys: dict[str, Any], samples: float, count: int) -> None:
    assert harmonic_count(Fit(**keys), 2, 3600.0, samples) == count


@pytest.mark.parametrize("noise", [0.3, 1.0])
def test_a_cut_is_found_in_noise_as_large_as_the_force(noise: float) -> None:
    t, force = entering(4000.0)
    size = float(force[(t > 0.65) & (t < 0.95)].std())
    found = find_cut(t, force + np.random.default_rng(1).normal(0.0, noise * size, force.shape), 1.0 / 60.0, 2)
    assert 0.4 < found.cut_s[0] < 0.6
    assert 1.0 < found.cut_s[1] < 1.2
    assert len(found.air_s) == 2


@pytest.mark.parametrize("noise", [0.0, 0.5])
def test_a_log_of_cut_alone_has_no_air(noise: float) -> None:
    t, force = log_rows(SIDE, SOME, rate_hz=3170.0, air_s=0.0, cut_s=1.0, phase_rad=0.3)
    force = force * (1.0 + 0.2 * np.sin(9.0 * t))[:, None]
    found = find_cut(
        t, force + np.random.default_rng(1).normal(0.0, noise * float(force.std()), force.shape), 1.0 / 60.0, 2
    )
    assert found.air_s == ()
    assert found.cut_s == pytest.approx((0.0, 1.0), abs=0.01)


def test_speed_is_found_to_a_hundredth_of_a_revolution() -> None:
    rng = np.random.default_rng(2)
    for rpm in (3571.3, 3600.0, 3628.9):
        t = np.arange(0.0, 1.5, 1.0 / 2000.0)
        force = SIDE.forces(rpm * math.pi / 30.0 * t, SOME)
        force += rng.normal(0.0, 0.1 * float(force.std()), force.shape)
        assert find_speed(t, force, 3600.0, 2) == pytest.approx(rpm, abs=0.5)


def test_harmonics_of_samples_are_those_of_the_waveform() -> None:
    angle = (np.arange(720) + 0.5) * math.pi / 360.0
    want = of_waveform(SIDE.forces(angle, SOME), 20, float(angle[0]))
    t = np.sort(np.random.default_rng(1).uniform(0.0, 0.73, 6000))
    omega = SIDE.rpm * math.pi / 30.0
    got, left = of_samples(t, to_waveform(want, omega * t), omega, 20)
    assert np.abs(got - want).max() < 1e-8 * np.abs(want).max()
    assert left.max() < 1e-6 * float(np.abs(want).max())
