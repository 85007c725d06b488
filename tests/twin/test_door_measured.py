"""Measured logs through the door: reading, comparing, identifying, and what they write."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from support.cut_logs import mean_tables
from support.edge_integral import BULL_CUTS, SOME
from support.job_files import job_folder

import twin
from twin.settings.toml_text import toml_text

LATE_S = 0.0123
RATE_HZ = 2000.0


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> twin.Run:
    folder = tmp_path_factory.mktemp("measured")
    coarse = {"simulation__angle_step_deg": 10, "simulation__slice_pitch_mm": 1.0, "measured": {"map": "x=A,y=B,z=C"}}
    return twin.replay(job_folder(folder, **coarse), mcap=folder / "slot.mcap")


@pytest.fixture(scope="module")
def log(run: twin.Run) -> Path:
    """The run's own forces as a log that began a little earlier, in columns whose names say nothing."""
    forces = run.forces
    t_s = np.arange(forces["t_s"][0], forces["t_s"][-1], 1.0 / RATE_HZ)
    columns = [np.interp(t_s, forces["t_s"], forces[name]) for name in ("fx_n", "fy_n", "fz_n")]
    path = run.path.with_name("log.csv")
    table = np.column_stack([t_s + LATE_S, *columns])
    np.savetxt(path, table, delimiter=",", header="t_s,A,B,C", comments="", fmt="%.6f")
    return path


def test_a_log_is_forces_on_the_tool(log: Path) -> None:
    found = twin.read_log(log, map="x=A,y=B,z=C", unit="N")
    assert isinstance(found, twin.ForceLog)
    turned = twin.read_log(log, twin.LogReading(map="x=A,y=B,z=C", unit="N"), force_on="workpiece")
    assert np.array_equal(turned.force_n, -found.force_n)
    assert found.rate_hz == pytest.approx(RATE_HZ)
    with pytest.raises(twin.SettingsError, match="mapp"):
        twin.read_log(log, mapp="x=A")


def test_a_comparison_takes_the_settings_of_the_job_then_those_given(run: twin.Run, log: Path) -> None:
    found = twin.compare(run, log, unit="N", windows=["5.0:5.5"])
    assert isinstance(found, twin.Comparison)
    assert found.lag_s == pytest.approx(LATE_S, abs=0.2 / RATE_HZ)
    assert found.windows[0].span_s == (5.0, 5.5)
    assert found.windows[0].of("y").rms_n < 2.0
    settings = twin.CompareSettings(unit="N", windows=("6.0:6.5",), lag_s=LATE_S)
    again = twin.compare(run.path, log, settings, windows=["5.0:5.5"])
    assert again.lag_s == LATE_S
    assert again.windows[0].span_s == (5.0, 5.5)


def test_a_comparison_without_a_log_is_refused(run: twin.Run) -> None:
    with pytest.raises(twin.CompareError, match=r"slot\.mcap: no log given, and its job has no measured\.file"):
        twin.compare(run)


def test_a_comparison_becomes_a_report(run: twin.Run, log: Path, tmp_path: Path) -> None:
    found = twin.compare(run, log, unit="N", windows=["5.0:5.5"])
    page = twin.write_report(found, tmp_path / "report")
    assert page == tmp_path / "report" / "report.html"
    assert "slot.mcap" in page.read_text()


def test_coefficients_are_identified_and_written(tmp_path: Path) -> None:
    cuts = tmp_path / "cuts.toml"
    cuts.write_text(toml_text(mean_tables(BULL_CUTS, SOME)))
    tasks: list[str] = []
    found = twin.identify(cuts, holdout=["0_slot_80"], progress=tasks.append)
    assert isinstance(found, twin.Identified)
    assert list(found.coefficients.values()) == pytest.approx(SOME, rel=0.005)
    assert [c.name for c in found.cuts if c.held_out] == ["0_slot_80"]
    assert tasks[-1] == "fitting 8 cuts (mean)"
    written = twin.write_coefficients(found, tmp_path / "steel.toml")
    assert tomllib.loads(written.read_text())["cutting"]["Ktc"] == pytest.approx(found.coefficients["Ktc"])
    with pytest.raises(twin.ArchiveError):
        twin.write_coefficients(found, written)
    with pytest.raises(twin.CutsError, match="no_such"):
        twin.identify(cuts, holdout=["no_such"])
