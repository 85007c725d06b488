"""Commands that read an archive: ``info``, ``export``, ``view``, ``mesh``; and ``mesh`` from a job."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pyarrow import csv
from support.fake_replay import PART, FakeReplay
from support.job_files import job_folder
from support.slot_run import SlotRun

from twin.cli import run
from twin.record import RunHeader, WorkpiecePatch
from twin.run.patches import joined
from twin.sinks.mcap_sink import McapSink
from twin.workpiece.solids.from_mesh import load_mesh


def write_run(path: Path, **parameters: str) -> Path:
    with McapSink(path) as sink:
        for record in SlotRun(step_mm=2.0, per_turn=8).records():
            if isinstance(record, RunHeader):
                record = replace(record, parameters=parameters)
            sink.write(record)
    return path


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    return write_run(tmp_path / "run.mcap")


def test_info_prints_the_contents_of_the_file(archive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["info", str(archive)]) == 0
    lines = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    for line in (
        "slot.nc",
        "machine time 0:07.6 removed 590.0 mm³",
        "program slot.nc",
        "covers 0:07.6 of 0:07.6",
        "stock, mm X 0 to 60, Y 0 to 30, Z -20 to 0; slice pitch 0.1 x 0.1 x 0.1",
        "tools T1 ball D8 z2",
        "messages /engagement 38",
    ):
        assert line in lines
    assert sum(line.startswith("messages /workpiece/") for line in lines) == 1


def test_info_as_json(archive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["info", str(archive), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["complete"] is True and result["intact"] is True
    assert result["stock_bounds_mm"] == [[0.0, 0.0, -20.0], [60.0, 30.0, 0.0]]
    assert result["tools"] == [{"number": 1, "description": "ball D8 z2"}]
    assert result["messages"]["/engagement"] == 38
    assert result["summary"]["machine_time_s"] == pytest.approx(7.6)
    assert result["size_bytes"] == archive.stat().st_size


def test_info_of_a_run_that_was_cut_off(archive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    archive.write_bytes(archive.read_bytes()[: archive.stat().st_size * 2 // 3])
    assert run(["info", str(archive)]) == 0
    assert "incomplete: readable up to its last complete record" in capsys.readouterr().out
    assert run(["info", str(archive), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["intact"] is False and result["summary"] is None


@pytest.mark.parametrize(
    ("parameters", "options", "sign"),
    [
        ({}, [], 1.0),
        ({"output.force_on": "workpiece"}, [], -1.0),
        ({"output.force_on": "workpiece"}, ["--on", "tool"], 1.0),
        ({}, ["--on", "workpiece"], -1.0),
    ],
    ids=["default", "job", "option over job", "option"],
)
def test_export_turns_forces_as_asked(
    parameters: dict[str, str], options: list[str], sign: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    archive, out = write_run(tmp_path / "run.mcap", **parameters), tmp_path / "forces.csv"
    assert run(["export", str(archive), str(out), *options]) == 0
    table = csv.read_csv(out)
    assert capsys.readouterr().out == f"{table.num_rows} samples written to {out}\n"
    assert table.column_names == [
        *("t_s", "spindle_angle_rad", "fx_n", "fy_n", "fz_n"),
        *("torque_nm", "power_w", "nc_line", "tool"),
    ]
    fy = table["fy_n"].to_numpy()
    assert np.abs(fy).max() > 50.0
    assert np.all(sign * fy >= 0.0)


def test_export_refuses_an_existing_file(archive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = archive.with_name("forces.parquet")
    assert run(["export", str(archive), str(out)]) == 0
    assert run(["export", str(archive), str(out)]) == 1
    assert f"error: {out}: already exists" in capsys.readouterr().err
    assert run(["export", str(archive), str(out), "--force"]) == 0


def test_view_writes_a_recording(archive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = archive.with_name("run.rrd")
    assert run(["view", str(archive), "--rrd", str(out)]) == 0
    assert capsys.readouterr().out == f"Recording  {out}\n"
    assert out.stat().st_size > 0
    assert run(["view", str(archive), "--rrd", str(out)]) == 1
    assert capsys.readouterr().err == f"error: {out}: already exists; replace it with --force\n"


@pytest.mark.parametrize("command", [["info"], ["view"], ["export"], ["mesh"]], ids=str)
def test_what_is_no_archive_is_refused(command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = tmp_path / "run.mcap"
    source.write_text("nothing of the kind")
    out = {"export": ["a.csv"], "mesh": ["a.stl"], "view": ["--rrd", "a.rrd"]}.get(command[0], [])
    rest = [str(tmp_path / name) if "." in name else name for name in out]
    assert run([*command, str(source), *rest]) == 1
    captured = capsys.readouterr()
    assert captured.err.startswith(f"error: {source}: ")
    assert captured.out == ""
    assert sorted(p.name for p in tmp_path.iterdir()) == ["run.mcap"]


def test_mesh_of_a_run_is_the_part_as_last_drawn(archive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = archive.with_name("part.stl")
    assert run(["mesh", str(archive), str(out)]) == 0
    count = int(capsys.readouterr().out.split(" ")[0])
    assert out.stat().st_size == 84 + 50 * count


def test_mesh_of_a_job_is_made_after_its_replay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fake = FakeReplay()
    monkeypatch.setattr("twin.cli.commands.runs.replay_work.open_replay", fake.open)
    out = tmp_path / "part.stl"
    assert run(["mesh", str(job_folder(tmp_path)), str(out)]) == 0
    assert capsys.readouterr().out == f"4 triangles written to {out}\n"
    assert load_mesh(out).volume_mm3 == pytest.approx(1.0 / 6.0)
    assert fake.closed
    assert fake.job is not None and not fake.job.forces


def test_mesh_refuses_before_the_replay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fake = FakeReplay()
    monkeypatch.setattr("twin.cli.commands.runs.replay_work.open_replay", fake.open)
    job, out = job_folder(tmp_path), tmp_path / "part.stl"
    out.write_text("mine")
    assert run(["mesh", str(job), str(out)]) == 1
    assert run(["mesh", str(job), str(tmp_path / "part.obj")]) == 1
    assert capsys.readouterr().err.count("error: ") == 2
    assert out.read_text() == "mine"
    assert fake.job is None


def patch(name: str, vertices: np.ndarray, triangles: np.ndarray) -> WorkpiecePatch:
    return WorkpiecePatch(
        t_s=0.0,
        patch=name,
        vertices_mm=vertices.astype(np.float32),
        normals=np.zeros_like(vertices, np.float32),
        triangles=triangles.astype(np.uint32),
    )


def test_patches_are_joined_at_the_places_they_share() -> None:
    vertices, triangles = PART.vertices_mm, PART.triangles
    empty = patch("c", np.zeros((0, 3)), np.zeros((0, 3)))
    mesh = joined([patch("a", vertices, triangles[:2]), empty, patch("b", vertices[::-1], 3 - triangles[2:])])
    assert mesh.vertices_mm.shape == (4, 3)
    want = {tuple(map(tuple, t)) for t in vertices[triangles].tolist()}
    assert {tuple(map(tuple, t)) for t in mesh.vertices_mm[mesh.triangles].tolist()} == want


def test_joined_patches_lose_triangles_without_extent() -> None:
    vertices = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
    mesh = joined([patch("a", vertices, np.array([[0, 1, 2], [0, 1, 3]]))])
    assert len(mesh.triangles) == 1


def test_nothing_left_is_an_empty_mesh() -> None:
    mesh = joined([patch("a", np.zeros((0, 3)), np.zeros((0, 3)))])
    assert (mesh.vertices_mm.shape, mesh.triangles.shape) == ((0, 3), (0, 3))
