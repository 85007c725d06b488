"""``twin job``, and ``twin replay`` of an NC program without a job file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from support.fake_replay import FakeReplay
from support.nc_programs import SLOT, changed, written

import twin
from twin.cli import run
from twin.errors import SettingsError
from twin.job import load_job
from twin.settings.file_kinds import is_nc_program

Capture = pytest.CaptureFixture[str]


@pytest.fixture
def program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The slot as a file in the current folder."""
    monkeypatch.chdir(tmp_path)
    return written(tmp_path, SLOT)


@pytest.fixture
def replayed(monkeypatch: pytest.MonkeyPatch) -> FakeReplay:
    """The replay that the command makes."""
    fake = FakeReplay(collision=False)
    monkeypatch.setattr("twin.cli.commands.runs.replay_work.open_replay", fake.open)
    return fake


def test_a_job_is_printed_or_written(program: Path, capsys: Capture) -> None:
    assert run(["job", "part.nc"]) == 0
    out, err = capsys.readouterr()
    assert "assumed: 4 flutes, helix 30 deg, flute length 20 mm (T3: the program does not state them)\n" in err
    assert "warning: the program does not state cutting coefficients" in err
    assert "estimate: " in err
    assert run(["job", "part.nc", "-o", "job.toml", "--quiet"]) == 0
    assert Path("job.toml").read_text() == out
    assert "assumed" not in capsys.readouterr().err
    assert run(["job", "part.nc", "-o", "job.toml", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["job"], found["added"], found["kept"]) == ("job.toml", [], [])
    assert found["tables"][3]["diameter_mm"] == 8.0


def test_values_of_the_file_are_kept(program: Path, capsys: Capture) -> None:
    run(["job", "part.nc", "-o", "job.toml"])
    text = Path("job.toml").read_text().replace("teeth = 4", "teeth = 3")
    Path("job.toml").write_text(text)
    capsys.readouterr()
    assert run(["job", "part.nc", "-o", "job.toml"]) == 0
    out, err = capsys.readouterr()
    assert out == "Job file   job.toml: unchanged, it has all tables and tools\n"
    assert "warning: job.toml keeps T3: teeth = 3 (drafted: 4)\n" in err
    assert Path("job.toml").read_text() == text


def test_a_program_is_replayed_without_a_job_file(program: Path, replayed: FakeReplay, capsys: Capture) -> None:
    assert run(["replay", "part.nc", "--material", "al7075-t6", "--stock", "box 60 20 9"]) == 0
    out, err = capsys.readouterr()
    assert replayed.job is not None and replayed.job.forces
    assert replayed.job.stock.box_mm is not None and replayed.job.stock.box_mm.min == (-10.0, -10.0, -9.0)
    assert err.count("assumed: ") == 6 and "warning" not in err.replace("warning: line 6", "")
    assert "Archive    part.mcap\n" in out
    assert sorted(path.name for path in program.parent.iterdir()) == ["part.mcap", "part.nc"]


def test_json_has_the_assumptions(program: Path, replayed: FakeReplay, capsys: Capture) -> None:
    assert run(["replay", "part.nc", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["job"] == "part.nc"
    assert {"subject": "T3", "value": "4 flutes", "reason": "the program does not state it"} in found["assumptions"]
    assert len(found["open"]) == 1 and found["doubts"] == [] and found["stated"] == ["T3 flat D8 (line 3)"]


def test_the_job_of_a_replay_can_be_saved_and_its_changes_count(program: Path, replayed: FakeReplay) -> None:
    arguments = ["replay", "part.nc", "--save-job", "job.toml", "--quiet"]
    assert run(arguments) == 0
    Path("job.toml").write_text(Path("job.toml").read_text().replace("teeth = 4", "teeth = 3"))
    assert run([*arguments, "--mcap", "other.mcap", "--force"]) == 0
    assert load_job("job.toml").tools[0].teeth == 3
    assert replayed.job is not None and replayed.job.tools[0].teeth == 3


def test_a_job_file_next_to_the_program_is_named(program: Path, replayed: FakeReplay, capsys: Capture) -> None:
    run(["job", "part.nc", "-o", "part.toml", "--quiet"])
    assert run(["replay", "part.nc", "--quiet"]) == 0
    assert "part.toml exists and is not used; replay it with: twin replay part.toml" in capsys.readouterr().err


def test_options_of_a_draft_are_refused_for_a_job_file(program: Path, capsys: Capture) -> None:
    run(["job", "part.nc", "-o", "job.toml", "--quiet"])
    capsys.readouterr()
    assert run(["replay", "job.toml", "--stock", "box 1 2 3", "--save-job", "x.toml"]) == 1
    expected = "error: twin replay: --stock and --save-job: expected only with an NC program; job.toml is a job file\n"
    assert capsys.readouterr().err == expected


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--material", "Al7075-T7"], "Al7075-T6"),
        (["--stock", "sphere 3"], "--stock 'sphere 3': expected 'box X Y Z'"),
        (["--stock", "missing.stl"], "missing.stl"),
        (["--tools", "missing.json"], "missing.json"),
        (["--margin", "-1"], "--margin = -1"),
    ],
)
def test_wrong_options_are_one_message(program: Path, arguments: list[str], message: str, capsys: Capture) -> None:
    assert run(["job", "part.nc", *arguments]) == 1
    err = capsys.readouterr().err
    assert err.startswith("error: ") and message in err and err.count("\n") == 1


def test_a_file_is_a_program_by_its_suffix_or_its_text(tmp_path: Path) -> None:
    for name, text, expected in (
        *(("a.nc", "", True), ("a.toml", "G21\n", False), ("a.stl", "solid", False), ("missing.tap", "", True)),
        *(("O1001", "%\nO1001\n", True), ("job", '[program]\nfile = "a.nc"\n', False), ("a.txt", "G21\nG0 X1\n", True)),
    ):
        if not name.startswith("missing"):
            (tmp_path / name).write_text(text)
        assert is_nc_program(tmp_path / name) is expected, name


def test_the_door_replays_a_program(program: Path) -> None:
    values = {"pitch_mm": 1.0, "angle_step_deg": 30.0, "material": "Al7075-T6"}
    run_of_slot = twin.replay(written(program.parent, changed(("X40.", "X4.")), "short.nc"), **values)
    assert np.abs(run_of_slot.forces["fx_n"]).max() > 0.0
    with pytest.raises(SettingsError, match="material: expected only with an NC program"):
        twin.replay("job.toml", material="Al7075-T6")
