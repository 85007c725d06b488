"""Runs as results: replayed and opened ones are the same, and interrupted ones open as well."""

from __future__ import annotations

import base64
import gc
import io
import os
import re
import signal
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from support.job_files import job_folder
from support.slot_run import SlotRun

import twin
from twin.archive import export_forces
from twin.cli import run as command
from twin.run.notebook import COLUMNS, envelope
from twin.simulation.replay import Replay
from twin.sinks.mcap_sink import McapSink

COARSE = {"simulation__angle_step_deg": 10, "simulation__slice_pitch_mm": 1.0}
NAMES = ["t_s", "spindle_angle_rad", "fx_n", "fy_n", "fz_n", "torque_nm", "power_w", "nc_line", "tool"]


@pytest.fixture(scope="module")
def job(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return job_folder(tmp_path_factory.mktemp("job"), **COARSE)


@pytest.fixture(scope="module")
def replayed(job: Path, tmp_path_factory: pytest.TempPathFactory) -> twin.Run:
    return twin.replay(job, mcap=tmp_path_factory.mktemp("replayed") / "run.mcap")


@pytest.fixture
def killed(tmp_path: Path) -> Path:
    """The archive of a run whose computer went off: cut in the middle of its chunks."""
    whole = tmp_path / "whole.mcap"
    with McapSink(whole) as sink:
        for record in SlotRun(step_mm=0.5, per_turn=360).records():
            sink.write(record)
    cut = tmp_path / "cut.mcap"
    data = whole.read_bytes()
    cut.write_bytes(data[: len(data) * 3 // 5])
    return cut


def test_settings_name_files_relative_to_the_job(replayed: twin.Run, job: Path) -> None:
    parameters = replayed.header.parameters
    assert (job.parent / parameters["program.file"]).is_file() and not Path(parameters["program.file"]).is_absolute()
    assert not [key for key, text in parameters.items() if str(job.parent) in text]


def assert_same(one: twin.Run, other: twin.Run) -> None:
    assert one.summary == other.summary
    assert one.events == other.events
    assert (one.complete, one.intact, repr(one)) == (other.complete, other.intact, repr(other))
    assert list(one.forces) == list(other.forces) == NAMES
    assert all(np.array_equal(one.forces[name], other.forces[name]) for name in NAMES)
    for a, b in zip(one.mesh(), other.mesh(), strict=True):
        assert np.array_equal(a, b)


def test_a_replayed_and_an_opened_run_are_the_same(replayed: twin.Run, tmp_path: Path) -> None:
    opened = twin.open_run(replayed.save(tmp_path / "new" / "slot.mcap"))
    assert type(opened) is type(replayed) is twin.Run
    assert_same(replayed, opened)
    assert opened.complete and opened.intact
    copy = opened.save(tmp_path / "copy.mcap")
    assert copy.read_bytes() == replayed.path.read_bytes()


def test_the_archive_is_what_the_command_writes(replayed: twin.Run, job: Path, tmp_path: Path) -> None:
    written = tmp_path / "command.mcap"
    assert command(["replay", str(job), "-q", "--mcap", str(written)]) == 0
    assert_same(replayed, twin.open_run(written))


def test_forces_are_read_only_arrays_by_the_names_of_the_export(replayed: twin.Run, tmp_path: Path) -> None:
    forces = replayed.forces
    assert {forces[n].shape for n in NAMES} == {(replayed.summary.samples,)}
    assert forces is replayed.forces
    with pytest.raises(ValueError, match="read-only"):
        forces["fx_n"][0] = 1.0
    highest = [np.abs(forces[n]).max() for n in ("fx_n", "fy_n", "fz_n")]
    assert replayed.summary.peak_force_n[:3] == pytest.approx(highest, abs=1e-6 * max(highest))
    table = tmp_path / "forces.csv"
    export_forces(replayed.path, table)
    assert table.read_text().splitlines()[0].split(",") == NAMES
    arrow = replayed.to_arrow()
    assert arrow.column_names == NAMES
    assert np.array_equal(arrow["fy_n"], forces["fy_n"])
    assert np.array_equal(replayed.to_arrow("workpiece")["fy_n"], -forces["fy_n"])


def test_events_are_those_of_the_program(replayed: twin.Run) -> None:
    texts = [event.text for event in replayed.events if isinstance(event, twin.NcEvent)]
    assert "T1 ball D8 z2" in texts and "G1 Z-2 F600" in texts
    assert replayed.collisions == ()


def test_the_part_has_the_slot(replayed: twin.Run, tmp_path: Path) -> None:
    mesh = replayed.mesh()
    twin.write_mesh(tmp_path / "part.stl", mesh)
    a, b, c = (mesh.vertices_mm[mesh.triangles[:, i]] for i in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0
    assert volume == pytest.approx(60.0 * 30.0 * 20.0 - replayed.summary.removed_volume_mm3, rel=1e-3)


def test_records_one_by_one_are_those_of_the_run(replayed: twin.Run, job: Path) -> None:
    computed = list(twin.records(twin.load_job(job), threads=1))
    kept = list(replayed.records())
    assert [type(record) for record in computed] == [type(record) for record in kept]
    assert isinstance(computed[0], twin.RunHeader)
    assert computed[-1] == kept[-1] == replayed.summary


def test_a_run_that_is_not_to_be_kept_leaves_nothing(job: Path) -> None:
    run = twin.replay(job)
    folder = run.path.parent
    kept = run.records()
    assert run.path.exists()
    assert isinstance(next(kept), twin.RunHeader)
    del run
    gc.collect()
    assert folder.exists(), "its records are still being read"
    del kept
    gc.collect()
    assert not folder.exists()


def test_files_that_were_asked_for_and_no_other(job: Path, tmp_path: Path) -> None:
    run = twin.replay(job, mcap=tmp_path / "a.mcap", rrd=tmp_path / "a.rrd")
    assert run.path == tmp_path / "a.mcap"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.mcap", "a.rrd"]
    assert not (job.parent / "recordings").exists()
    with pytest.raises(twin.ArchiveError, match=r"a\.mcap"):
        twin.replay(job, mcap=tmp_path / "a.mcap")
    twin.replay(job, mcap=tmp_path / "a.mcap", force=True)
    run.view(rrd=tmp_path / "b.rrd")
    assert (tmp_path / "b.rrd").stat().st_size > 0
    with pytest.raises(twin.ArchiveError, match=r"ends in \.mcap"):
        run.save(tmp_path / "run.csv")


def test_strict_ends_at_the_first_collision_and_keeps_the_file(tmp_path: Path) -> None:
    job = job_folder(tmp_path, **COARSE)
    (tmp_path / "slot.nc").write_text("T1 M6\nS3600 M3\nG0 X-6 Y15\nZ-2\nX66\nZ5\nX-6\nM30\n")
    assert twin.replay(job).summary.collisions == 1
    file = tmp_path / "strict.mcap"
    with pytest.raises(twin.CollisionError, match=r"slot\.nc:5: T1: rapid motion through the stock"):
        twin.replay(job, strict=True, mcap=file)
    run = twin.open_run(file)
    assert run.intact and not run.complete
    assert [c.nc_line for c in run.collisions] == [5]
    assert "ended early at" in repr(run)


def test_ctrl_c_ends_in_order_and_keeps_the_file(job: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    records = Replay.__iter__

    def pressed(replay: Replay) -> Iterator[twin.Record]:
        for record in records(replay):
            if isinstance(record, twin.Step) and record.index == 9:
                os.kill(os.getpid(), signal.SIGINT)
            yield record

    monkeypatch.setattr(Replay, "__iter__", pressed)
    file = tmp_path / "run.mcap"
    with pytest.raises(KeyboardInterrupt):
        twin.replay(job, mcap=file)
    run = twin.open_run(file)
    assert run.intact and not run.complete
    assert run.summary.steps == 10


def test_what_a_killed_replay_left_opens_and_says_so(killed: Path) -> None:
    run = twin.open_run(killed)
    assert not run.complete and not run.intact
    assert repr(run).startswith("<Run of slot.nc: cut off at ")
    summary, forces = run.summary, run.forces
    assert not summary.complete
    assert summary.samples == len(forces["t_s"]) > 100
    assert summary.peak_force_n[0] == pytest.approx(np.abs(forces["fx_n"]).max())
    assert np.isnan(summary.removed_volume_mm3) and summary.digest == ""
    assert summary.tools[0].description == "ball D8 z2"
    assert 0.0 < summary.machine_time_s < run.header.planned_time_s
    assert len(run.mesh().triangles) > 0
    assert "cut off" in run._repr_html_()


def test_a_summary_from_records_is_that_of_the_replay(replayed: twin.Run) -> None:
    from twin.run.interrupted import summary_of

    whole, summed = replayed.summary, summary_of(replayed.records())
    resolution_n = 1e-6 * whole.peak_force_n[3]
    for name in ("machine_time_s", "cutting_time_s", "peak_force_n", "mean_force_n", "collisions"):
        assert getattr(summed, name) == pytest.approx(getattr(whole, name), abs=resolution_n), name
    assert [line[:2] for line in summed.top_lines] == [line[:2] for line in whole.top_lines]
    highest = [line[2] for line in whole.top_lines]
    assert [line[2] for line in summed.top_lines] == pytest.approx(highest, abs=resolution_n)


@pytest.mark.parametrize("content", [b"", b"no archive", None])
def test_files_that_are_not_runs_are_refused(content: bytes | None, tmp_path: Path) -> None:
    file = tmp_path / "run.mcap"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(twin.ArchiveError, match=re.escape(str(file))):
        twin.open_run(file)


def test_a_notebook_shows_a_small_picture(replayed: twin.Run) -> None:
    html = replayed._repr_html_()
    assert "slot.nc" in html and "T1 ball D8 z2" in html
    png = re.search(r"data:image/png;base64,([^\"]+)", html)
    assert png is not None
    assert base64.b64decode(png[1]).startswith(b"\x89PNG")
    assert len(html) < 100_000


@pytest.mark.parametrize("parts", [1, 7])
@pytest.mark.parametrize("count", [0, 1, 7, 800, 1_000_000])
def test_an_envelope_has_every_peak_and_few_points(count: int, parts: int) -> None:
    random = np.random.default_rng(0)
    t_s = np.sort(random.uniform(0.0, 10.0, count))
    forces = {"t_s": t_s, **{name: random.normal(size=count) for name in ("fx_n", "fy_n", "fz_n")}}
    ends = np.linspace(0, count, parts + 1).astype(int)
    batches = [{name: values[a:b] for name, values in forces.items()} for a, b in pairwise(ends)]
    low, high = envelope(batches, 10.0)
    assert low.shape == high.shape == (COLUMNS, 3)
    for axis, name in enumerate(("fx_n", "fy_n", "fz_n")):
        if count:
            assert np.nanmin(low[:, axis]) == forces[name].min()
            assert np.nanmax(high[:, axis]) == forces[name].max()
        for column in (0, 123, COLUMNS - 1):
            inside = forces[name][(t_s * COLUMNS / 10.0).astype(int) == column]
            want = (inside.min(), inside.max()) if len(inside) else (np.nan, np.nan)
            assert np.array_equal((low[column, axis], high[column, axis]), want, equal_nan=True)


def test_a_notebook_plot_does_not_keep_all_samples(replayed: twin.Run, tmp_path: Path) -> None:
    opened = twin.open_run(replayed.save(tmp_path / "slot.mcap"))
    fresh = opened._repr_html_()
    assert "forces" not in vars(opened)
    assert len(opened.forces["t_s"]) == opened.summary.samples
    assert opened._repr_html_() == fresh


def test_a_very_long_run_is_shown_without_a_plot(replayed: twin.Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("twin.run.notebook.MOST_SAMPLES", 10)
    assert "no plot" in replayed._repr_html_()


def test_progress_is_drawn_on_request(job: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    console = Console(file=io.StringIO(), force_terminal=True, width=120)
    monkeypatch.setattr("twin.cli.show.progress.errors", lambda: console)
    twin.replay(job)
    assert isinstance(console.file, io.StringIO) and console.file.getvalue() == ""
    twin.replay(job, progress=True)
    assert "replaying" in console.file.getvalue()
