"""``twin materials``, and ``twin replay --material``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.fake_replay import FakeReplay
from support.job_files import job_folder

from twin.cli import run


def test_the_list_has_published_tests_and_groups(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["materials"]) == 0
    out = capsys.readouterr().out
    assert "Al7075-T6 " in out and "VDI 3323 group 14" in out and "Order of magnitude only" in out


def test_a_text_filters_and_a_name_prints_the_row(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["materials", "cast iron", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [row["name"] for row in found] == [f"VDI 3323 group {n}" for n in range(15, 21)]
    assert {"name", "law", "source", "chip_range_mm", "speed_range_m_min"} <= set(found[0])
    assert run(["materials", "titanium", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)[0]["name"] == "Ti6Al4V"
    assert run(["materials", "s", "--json"]) == 0
    assert {row["iso_group"] for row in json.loads(capsys.readouterr().out)} == {"S"}
    assert run(["materials", "ti-6al-4v"]) == 0
    out = capsys.readouterr().out
    assert "10.1017/CBO9780511843723" in out and "caution" in out
    assert run(["materials", "Al7050"]) == 0
    assert "\u2026" not in capsys.readouterr().out, "a long address is cut off"
    assert run(["materials", "ti-6al-4v", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["orthogonal"]["shear_stress_mpa"] == 613.0


def test_an_unknown_material_names_the_nearest(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert run(["materials", "Al7057-T6"]) == 1
    assert "did you mean Al7075-T6" in capsys.readouterr().err
    assert run(["replay", str(job_folder(tmp_path)), "--material", "C54"]) == 1
    assert "C45" in capsys.readouterr().err


def test_material_of_the_command_line_replaces_the_job_s(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake = FakeReplay(collision=False)
    monkeypatch.setattr("twin.cli.commands.runs.replay_work.open_replay", fake.open)
    assert run(["replay", str(job_folder(tmp_path)), "--material", "7075"]) == 0
    assert fake.job is not None and fake.job.cutting is not None and fake.job.cutting.material == "Al7075-T6"
    assert "note: --material: the coefficients of Al7075-T6 replace those of the job" in capsys.readouterr().err
