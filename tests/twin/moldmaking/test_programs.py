"""Programs of the stages: checked by the interpreter, run by rs274, replayed without a collision; the command."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from tests.support.recording import Recording
from twin.cli import run
from twin.errors import ToolPathError
from twin.job import load_job
from twin.moldmaking import STAGES, MoldPlan
from twin.moldmaking.pictures import draw
from twin.moldmaking.programs import write_programs
from twin.settings.toml_text import toml_text
from twin.verification.deviation import Limits, deviation
from twin.verification.machining import machined


@pytest.fixture(scope="module")
def programs(plan: MoldPlan) -> dict[str, Path]:
    return write_programs(plan, STAGES, force=True)


def test_there_is_a_program_a_stage_one_of_all_and_a_job(programs: dict[str, Path]) -> None:
    assert set(programs) == {"rough", "semi", "finish", "all", "job"}
    assert all(p.stat().st_size > 100 for p in programs.values())
    assert not list(programs["all"].parent.glob("*.partial"))


def test_the_interpreter_finds_no_mistakes(programs: dict[str, Path]) -> None:
    from gcode.cli import run as gcode

    for name in (*STAGES, "all"):
        assert gcode(["check", str(programs[name])]) == 0


@pytest.mark.skipif(shutil.which("rs274") is None, reason="rs274 is not installed")
@pytest.mark.parametrize("stage", STAGES)
def test_rs274_runs_them(programs: dict[str, Path], stage: str, tmp_path: Path) -> None:
    # O1001 alone and percent signs are FANUC's; all that moves is common
    lines = [ln for ln in programs[stage].read_text().splitlines() if not ln.startswith(("%", "O"))]
    file = tmp_path / "program.ngc"
    file.write_text("\n".join(lines) + "\n")
    table = tmp_path / "tools.tbl"
    table.write_text("".join(f"T{n} P{n} Z{z:g} D8\n" for n, z in ((1, 90.0), (2, 95.0), (3, 80.0))))
    done = subprocess.run(
        ["rs274", "-t", str(table), "-g", str(file)], capture_output=True, text=True, check=False, timeout=60
    )
    assert done.returncode == 0, done.stdout[-300:] + done.stderr[-300:]
    assert done.stdout.count("FEED") > 100


def test_a_replay_of_all_stages_hits_nothing_and_gives_the_part(programs: dict[str, Path], plan: MoldPlan) -> None:
    job = load_job(programs["job"]).with_simulation(slice_pitch_mm=0.8)
    store, collisions = machined(job)
    assert collisions == ()
    # chords 5 um, and what slices of 0.8 mm can tell
    found = deviation(store, plan.part, tolerance_mm=0.02, excess_mm=0.1, limits=Limits.of(plan.part, None))
    assert found.gouge_ok


def test_files_that_are_there_are_not_replaced(programs: dict[str, Path], plan: MoldPlan) -> None:
    before = programs["rough"].read_bytes()
    with pytest.raises(ToolPathError, match="already exists"):
        write_programs(plan, STAGES)
    assert programs["rough"].read_bytes() == before


def test_pictures(plan: MoldPlan, tmp_path: Path) -> None:
    files = draw(plan, STAGES, tmp_path)
    assert [f.name for f in files] == ["small_rough.png", "small_semi.png", "small_finish.png"]
    assert all(f.stat().st_size > 10_000 for f in files)


def test_the_command_writes_one_stage_and_prints_json(
    job_tables: dict[str, Any], mold_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    job_tables["output"] = {"dexel_mm": 0.3, "name": "one", "folder": "one"}
    file = mold_folder / "one.toml"
    file.write_text(toml_text(job_tables))
    assert run(["mold", str(file), "--stage", "rough", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert list(printed["stages"]) == ["rough"]
    assert Path(printed["files"]["rough"]).exists()
    assert not (mold_folder / "one" / "one_semi.nc").exists()
    assert run(["mold", str(file), "--stage", "rough"]) == 1
    assert "already exists" in capsys.readouterr().err


def test_the_command_prints_the_table(
    job_tables: dict[str, Any], mold_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    job_tables["output"] = {"dexel_mm": 0.3, "name": "all", "folder": "all"}
    file = mold_folder / "all.toml"
    file.write_text(toml_text(job_tables))
    assert run(["mold", str(file), "--plot", str(mold_folder / "pictures"), "--rrd", str(mold_folder / "x.rrd")]) == 0
    scene = Recording(mold_folder / "x.rrd").tables
    assert {"part", "report", *(f"{stage}/cut" for stage in STAGES)} <= set(scene)
    out = capsys.readouterr().out
    assert "Machining time, min" in out
    assert "less than the raster baseline" in out
    for name in ("greedy", "2-opt", "ils", "raster baseline"):
        assert f"\n{name}" in out
    assert (mold_folder / "pictures" / "all_semi.png").exists()


def test_a_mistake_ends_with_a_message(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "job.toml").write_text("[part]\nstl = 3\n")
    assert run(["mold", str(tmp_path / "job.toml")]) == 1
    assert "part.stl" in capsys.readouterr().err
