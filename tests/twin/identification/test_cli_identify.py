"""``twin identify`` as a user meets it."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path
from typing import Any

import pytest
from support.cut_logs import logged, mean_tables
from support.edge_integral import BALL_CUTS, BULL_CUTS, SOME, Pass
from support.job_files import job_folder

from twin.cli import run
from twin.errors import IdentifyError
from twin.identification.coefficients_toml import coefficients_toml
from twin.identification.cuts.load import cuts_from_dict
from twin.identification.identify import identify
from twin.identification.models.straight import NAMES
from twin.job import load_job
from twin.settings.toml_text import toml_text

PNG = b"\x89PNG\r\n"


@pytest.fixture
def cuts_file(tmp_path: Path) -> Path:
    path = tmp_path / "cuts.toml"
    path.write_text(toml_text(mean_tables(BULL_CUTS, SOME)))
    return path


def as_json(capsys: pytest.CaptureFixture[str], *arguments: object) -> dict[str, Any]:
    assert run(["identify", *map(str, arguments), "--json"]) == 0
    # every number finite or null
    found: dict[str, Any] = json.loads(capsys.readouterr().out, parse_constant=lambda c: pytest.fail(c))
    return found


@pytest.mark.parametrize("method", ["mean", "iterative"])
def test_json(cuts_file: Path, capsys: pytest.CaptureFixture[str], method: str) -> None:
    found = as_json(capsys, cuts_file, "--method", method, "--holdout", "0_slot_80", "--holdout", "4_up_160")
    assert found["method"] == method
    assert list(found["coefficients"].values()) == pytest.approx(SOME, rel=0.005)
    assert list(found["standard_errors"]) == list(NAMES)
    low, high = found["interval_95"]["Ktc"]
    assert low < found["coefficients"]["Ktc"] < high
    assert [row[i] for i, row in enumerate(found["correlation"])] == [1.0] * 6
    assert found["r_squared"]["all"] > 0.9999
    assert [c["name"] for c in found["cuts"] if c["held_out"]] == ["0_slot_80", "4_up_160"]
    assert found["degrees_of_freedom"] == 15
    cut = found["cuts"][0]
    off = [m - f for m, f in zip(cut["measured_mean_n"], cut["fitted_mean_n"], strict=True)]
    assert cut["residual_n"] == pytest.approx(off)


def test_tables(cuts_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["identify", str(cuts_file), "--holdout", "8_down_320"]) == 0
    said = capsys.readouterr()
    for word in ("Ktc", "N/mm²", "95 % interval", "condition number", "8_down_320 (held out)", "Correlation"):
        assert word in said.out
    assert "8 of 9 cuts fitted" in said.out
    assert said.err == ""


def test_the_coefficients_can_stand_in_a_job_file(cuts_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = cuts_file.parent
    assert run(["identify", str(cuts_file), "-o", str(folder / "steel.toml"), "--holdout", "0_slot_80"]) == 0
    assert "steel.toml" in capsys.readouterr().out
    assert (folder / "steel.png").read_bytes().startswith(PNG)
    text = (folder / "steel.toml").read_text()
    cutting = tomllib.loads(text)["cutting"]
    assert [cutting[name] for name in NAMES] == pytest.approx(SOME, rel=0.005)
    assert cutting["source"] == "twin identify, method mean, 8 cuts of cuts.toml"
    assert len(cutting["standard_errors"]) == 6
    assert "# held out: 0_slot_80" in text
    job = job_folder(folder)
    without = job.read_text().replace("[cutting]", "[NOT]").split("[NOT]")
    job.write_text(without[0] + "[simulation]" + without[1].split("[simulation]")[1] + "\n" + text)
    loaded = load_job(job).cutting
    assert loaded is not None
    assert loaded.Ktc == pytest.approx(1900.0, rel=0.005)
    assert loaded.correlation is not None


def test_files_that_are_there_are_not_replaced(cuts_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = cuts_file.parent / "steel.toml"
    out.write_text("mine")
    assert run(["identify", str(cuts_file), "-o", str(out)]) == 1
    assert "already exists; replace it with --force" in capsys.readouterr().err
    assert out.read_text() == "mine"
    assert sorted(p.name for p in out.parent.iterdir()) == ["cuts.toml", "steel.toml"]
    assert run(["identify", str(cuts_file), "-o", str(out), "--force"]) == 0
    assert "[cutting]" in out.read_text()


@pytest.mark.parametrize(("option", "name"), [("-o", "steel.txt"), ("--plot", "steel.jpg")])
def test_wrong_suffixes(cuts_file: Path, option: str, name: str) -> None:
    assert run(["identify", str(cuts_file), option, str(cuts_file.parent / name)]) == 2


def test_undetermined_coefficients_are_warned_of_and_not_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "cuts.toml"
    path.write_text(toml_text(mean_tables((Pass(corner=0.0), Pass(corner=0.0, axial=5.0)), SOME)))
    assert run(["identify", str(path)]) == 0
    said = capsys.readouterr()
    assert "not determined" in said.out
    assert "all have the same feed per tooth, and c and e need two" in said.err.replace("\n", " ")
    found = as_json(capsys, path, "--plot", tmp_path / "plot.png")
    assert found["coefficients"]["Ktc"] is None
    (tmp_path / "plot.png").unlink()
    capsys.readouterr()
    assert run(["identify", str(path), "-o", str(tmp_path / "steel.toml")]) == 1
    assert "no coefficient set written: Ktc, Kte" in capsys.readouterr().err
    assert sorted(p.name for p in tmp_path.iterdir()) == ["cuts.toml"]


def test_mistakes_end_with_one_message(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "cuts.toml"
    path.write_text('[tool]\nkind = "flat"\n')
    assert run(["identify", str(path)]) == 1
    said = capsys.readouterr()
    assert "mistakes" in said.err
    assert "tool.diameter_mm: missing" in said.err
    assert said.out == ""


def test_waveforms_with_plot(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = logged(
        tmp_path, [p.but(runout=0.004, runout_deg=40.0) for p in BALL_CUTS[::4]], SOME, rate_hz=4130.0, noise_n=5.0
    )
    path = tmp_path / "cuts.toml"
    path.write_text(toml_text(data))
    plot = tmp_path / "plot.png"
    found = as_json(capsys, path, "--method", "waveform", "--runout", "--plot", plot)
    assert plot.read_bytes().startswith(PNG)
    assert list(found["coefficients"].values()) == pytest.approx(SOME, rel=0.03)
    assert found["runout"]["runout_mm"] == pytest.approx(0.004, rel=0.03)
    assert found["evaluations"] > 10
    assert all(c["waveform_rms_error_n"] < 10.0 for c in found["cuts"])
    assert run(["identify", str(path), "--method", "waveform", "-v"]) == 0
    said = capsys.readouterr().out
    assert "spindle speed" in said
    assert "waveform RMS" in said
    assert "drift" in said


def test_a_negative_ktc_is_no_set_for_a_job() -> None:
    data = mean_tables(BULL_CUTS, SOME) | {"defaults": {"force_on": "workpiece"}}
    found = identify(cuts_from_dict(data, "cuts.toml"))
    with pytest.raises(IdentifyError, match=r"Ktc = -1\d+ N/mm2, expected at least 0: check map, force_on"):
        coefficients_toml(found)


def test_given_coefficients_are_told_as_given(cuts_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cuts_file.write_text(cuts_file.read_text() + "\n[fit.fixed]\nKac = 400.0\nKae = 12.0\n")
    found = as_json(capsys, cuts_file)
    assert found["fixed"] == ["Kac", "Kae"]
    assert found["correlation"][4][0] is None
    text = coefficients_toml(identify(cuts_from_dict(tomllib.loads(cuts_file.read_text()), cuts_file)))
    assert "Kac = 400 N/mm2 given, not fitted" in text
    assert math.isclose(tomllib.loads(text)["cutting"]["Kac"], 400.0)
