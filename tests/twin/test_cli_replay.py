"""``twin replay``: what it prints, what it leaves, and how it ends."""

from __future__ import annotations

import json
import os
import signal
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from support.fake_replay import FakeReplay
from support.job_files import NOTHING, job_folder

from gcode.errors import GcodeError, Place
from twin.archive import read_run, run_info
from twin.cli import run
from twin.cli.stop import StopRequest
from twin.errors import ArchiveError, ReplayError
from twin.record import Collision, Record, RunSummary, Step
from twin.sinks.rerun.sink import RerunSink

Use = Callable[..., FakeReplay]


@pytest.fixture
def use(monkeypatch: pytest.MonkeyPatch) -> Use:
    """Make the command replay a `FakeReplay`."""

    def install(**options: object) -> FakeReplay:
        fake = FakeReplay(**options)  # type: ignore[arg-type]
        monkeypatch.setattr("twin.cli.commands.runs.replay_work.open_replay", fake.open)
        return fake

    return install


@pytest.fixture
def job(tmp_path: Path) -> Path:
    return job_folder(tmp_path)


def records(path: Path) -> list[Record]:
    return list(read_run(path))


def ctrl_c_at(step: int, times: int = 1, number: signal.Signals = signal.SIGINT) -> Callable[[int], None]:
    def press(index: int) -> None:
        for _ in range(times if index == step else 0):
            os.kill(os.getpid(), number)

    return press


def test_a_run_prints_its_summary_and_leaves_its_archive(
    use: Use, job: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fake = use(collision=False)
    assert run(["replay", str(job)]) == 0
    archive = job.parent / "recordings" / "slot.mcap"
    captured = capsys.readouterr()
    assert "T1 ball D8 z2" in captured.out
    assert f"Archive    {archive}\n" in captured.out
    assert captured.err == "warning: line 6: M98 has no effect here\n"
    assert records(archive)[-1] == fake.summary(complete=True)
    assert fake.closed


def test_json_is_one_object_with_the_documented_keys(use: Use, job: Path, capsys: pytest.CaptureFixture[str]) -> None:
    use()
    assert run(["replay", str(job), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["program"] == "slot.nc"
    assert result["complete"] is True
    assert (result["machine_time_s"], result["cutting_time_s"]) == (7.6, 6.0)
    assert result["removed_volume_mm3"] == 590.0
    assert result["peak_force_n"] == {"x": 40.0, "y": 100.0, "z": 25.0, "resultant": 110.5}
    assert result["mean_force_n"] == {"x": 25.0, "y": 50.0, "z": 16.0, "resultant": 58.1}
    assert result["wall_time_s"] > 0.0 and result["setup_time_s"] >= 0.0
    assert result["real_time_factor"] == pytest.approx(7.6 / result["wall_time_s"])
    assert result["mcap"] == str(job.parent / "recordings" / "slot.mcap")
    assert result["rrd"] is None
    assert result["digest"] == "0" * 16
    assert result["collisions"] == 1
    (collision,) = result["collision_list"]
    assert (collision["nc_line"], collision["tool"], collision["kind"]) == (5, 1, "rapid")
    assert collision["point_mm"] == [60.0, 15.0, -2.0]
    assert [tool["number"] for tool in result["tools"]] == [1]
    assert result["tools"][0]["removal_rate_mm3_min"] == pytest.approx(590.0 / 6.0 * 60.0)
    assert result["top_lines"] == [{"nc_line": 4, "text": "N40 G1 X66 F600", "force_n": 110.5}]
    assert [w.split(" ")[0] for w in result["warnings"]] == ["1", "line"]


def test_mean_forces_turn_round_on_the_workpiece(use: Use, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    use()
    job = job_folder(tmp_path, output={"force_on": "workpiece"})
    assert run(["replay", str(job), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["force_on"] == "workpiece"
    assert result["mean_force_n"] == {"x": -25.0, "y": -50.0, "z": -16.0, "resultant": 58.1}
    assert result["peak_force_n"]["x"] == 40.0


def test_forces_that_were_not_computed_are_null(use: Use, job: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fake = use(samples=0)
    assert run(["replay", str(job), "--json", "--no-forces"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["peak_force_n"] is None
    assert result["tools"][0]["mean_torque_nm"] is None
    assert fake.job is not None and not fake.job.forces


def test_quiet_prints_warnings_alone(use: Use, job: Path, capsys: pytest.CaptureFixture[str]) -> None:
    use()
    assert run(["replay", str(job), "-q"]) == 0
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.splitlines() == [
        "warning: 1 collision, the first: slot.nc:5: T1: rapid motion through the stock, from X60 Y15 Z-2, 12.5 mm3",
        "warning: line 6: M98 has no effect here",
    ]


def test_strict_ends_at_the_first_collision_and_keeps_it(
    use: Use, job: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    use()
    assert run(["replay", str(job), "--strict", "--quiet"]) == 3
    assert capsys.readouterr().err == (
        "error: stopped at a collision (--strict): "
        "slot.nc:5: T1: rapid motion through the stock, from X60 Y15 Z-2, 12.5 mm3\n"
    )
    *_, collision, summary = records(job.parent / "recordings" / "slot.mcap")
    assert isinstance(collision, Collision)
    assert isinstance(summary, RunSummary) and not summary.complete


def test_strict_without_collision_is_as_without(use: Use, job: Path) -> None:
    use(collision=False)
    assert run(["replay", str(job), "--strict", "--quiet"]) == 0


@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=lambda x: getattr(x, "name", "")
)
def test_a_wish_to_stop_ends_the_run_in_order(
    number: signal.Signals, code: int, use: Use, job: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    use(at_step=ctrl_c_at(9, number=number))
    assert run(["replay", str(job)]) == code
    captured = capsys.readouterr()
    assert "ended early, at 0:07.6 of 0:07.6" in captured.out
    assert captured.err == ("warning: stopped at 7.6 s of machine time; outputs have the run up to there\n")
    info = run_info(job.parent / "recordings" / "slot.mcap")
    assert info.intact and not info.complete
    assert info.counts["/engagement"] == 10


def test_a_second_ctrl_c_gives_the_outputs_up(use: Use, job: Path) -> None:
    fake = use(at_step=ctrl_c_at(9, times=2))
    assert run(["replay", str(job)]) == 130
    assert list((job.parent / "recordings").iterdir()) == []
    assert fake.closed


def test_handlers_of_signals_are_put_back(use: Use, job: Path) -> None:
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    use(at_step=ctrl_c_at(3))
    assert run(["replay", str(job), "-q"]) == 130
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == before


def test_a_file_that_is_there_is_refused_before_anything_is_replayed(
    use: Use, job: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fake = use()
    archive = job.parent / "recordings" / "slot.mcap"
    archive.parent.mkdir()
    archive.write_text("mine")
    assert run(["replay", str(job)]) == 1
    assert capsys.readouterr().err == f"error: {archive}: already exists; replace it with --force\n"
    assert archive.read_text() == "mine"
    assert fake.job is None
    assert run(["replay", str(job), "--force", "-q"]) == 0
    assert isinstance(records(archive)[-1], RunSummary)


def test_outputs_of_the_command_line_take_the_place_of_the_job_s(
    use: Use, job: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    use()
    monkeypatch.chdir(job.parent)
    assert run(["replay", "job.toml", "-q", "--mcap", "here/run.mcap"]) == 0
    assert (job.parent / "here" / "run.mcap").is_file()
    assert not (job.parent / "recordings").exists()


def test_a_recording_is_written_beside_the_archive(use: Use, job: Path) -> None:
    use()
    assert run(["replay", str(job), "-q", "--rrd", str(job.parent / "run.rrd")]) == 0
    assert (job.parent / "run.rrd").stat().st_size > 0
    assert (job.parent / "recordings" / "slot.mcap").is_file()


def test_a_job_without_outputs_is_replayed_for_its_summary(
    use: Use, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    use()
    assert run(["replay", str(job_folder(tmp_path, output=NOTHING))]) == 0
    assert "Archive" not in capsys.readouterr().out
    assert sorted(p.name for p in tmp_path.iterdir()) == ["job.toml", "slot.nc"]


@pytest.mark.parametrize(("option", "suffix"), [("--mcap", ".mcap"), ("--rrd", ".rrd")])
def test_an_output_has_the_suffix_that_viewers_go_by(
    option: str, suffix: str, use: Use, job: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    use()
    assert run(["replay", str(job), option, "run.bag"]) == 1
    assert capsys.readouterr().err == f"error: run.bag: expected a file name that ends in {suffix}\n"


@pytest.mark.parametrize(
    "error",
    [ReplayError("slot.nc:4: begins inside"), GcodeError(Place(file="slot.nc", line=4), "x", "wrong")],
    ids=type,
)
@pytest.mark.parametrize("step", [0, 9])
def test_a_run_that_ends_by_an_error_leaves_nothing(
    step: int, error: Exception, use: Use, job: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def refuse(index: int) -> None:
        if index == step:
            raise error

    fake = use(at_step=refuse)
    assert run(["replay", str(job), "--rrd", str(job.parent / "recordings" / "a.rrd")]) == 1
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == f"error: {error}\n"
    assert list((job.parent / "recordings").iterdir()) == []
    assert fake.closed


def test_an_output_that_cannot_be_written_ends_the_run_and_takes_the_other_with_it(
    use: Use, job: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(sink: RerunSink, record: Record) -> None:
        if isinstance(record, Step):
            raise ArchiveError("a.rrd: cannot be written: no space left on device")

    use()
    monkeypatch.setattr(RerunSink, "write", full)
    assert run(["replay", str(job), "--rrd", str(job.parent / "recordings" / "a.rrd")]) == 1
    assert capsys.readouterr().err == "error: a.rrd: cannot be written: no space left on device\n"
    assert list((job.parent / "recordings").iterdir()) == []


def test_signals_are_left_alone_outside_the_main_thread() -> None:
    seen: list[object] = []

    def inside() -> None:
        with StopRequest() as stop:
            seen.extend([signal.getsignal(signal.SIGINT), stop.signal_number])

    thread = threading.Thread(target=inside)
    thread.start()
    thread.join()
    assert seen == [signal.getsignal(signal.SIGINT), None]


def test_an_error_keeps_the_run_that_was_there(use: Use, job: Path) -> None:
    archive = job.parent / "recordings" / "slot.mcap"
    use()
    assert run(["replay", str(job), "-q"]) == 0
    before = archive.read_bytes()

    def refuse(index: int) -> None:
        raise ReplayError("no")

    use(at_step=refuse)
    assert run(["replay", str(job), "--force"]) == 1
    assert archive.read_bytes() == before
    assert [p.name for p in archive.parent.iterdir()] == ["slot.mcap"]


def test_a_job_with_mistakes_is_refused_with_all_of_them(
    use: Use, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fake = use()
    job = job_folder(tmp_path, tools__0__teeth=0, simulation__slice_pich_mm=1)
    assert run(["replay", str(job)]) == 1
    assert capsys.readouterr().err.splitlines() == [
        f"error: {job}: 2 mistakes",
        "  tools[0].teeth (tool 1) = 0: expected a whole number at least 1 and at most 100 (number of flutes)",
        "  simulation.slice_pich_mm: unknown key; did you mean slice_pitch_mm?",
    ]
    assert fake.job is None


def test_a_path_that_misses_the_stock_is_a_warning(use: Use, job: Path, capsys: pytest.CaptureFixture[str]) -> None:
    use(collision=False, removed_volume_mm3=0.0)
    assert run(["replay", str(job), "-q"]) == 0
    assert capsys.readouterr().err.splitlines()[0] == (
        "warning: no material was cut: the feed motions are at X -6..66 Y 15..15 Z -2..-2, "
        "the stock is at X 0..60 Y 0..30 Z -20..0; check stock, machine.offsets and the tools' length_mm in the job"
    )
    assert run(["replay", str(job), "-q", "--strict", "--force"]) == 1
    assert capsys.readouterr().err.startswith("error: no material was cut: ")


def test_the_program_itself_replays_a_coarse_slot(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = job_folder(tmp_path, simulation__angle_step_deg=10)
    assert run(["replay", str(job), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["collisions"] == 0
    segment_mm2 = 16.0 * 1.0471975512 - 0.5 * 16.0 * 0.8660254038
    assert result["removed_volume_mm3"] == pytest.approx(60.0 * segment_mm2, rel=0.03)
    assert result["peak_force_n"]["resultant"] > 10.0
    assert run(["info", result["mcap"]]) == 0
    assert run(["export", result["mcap"], str(tmp_path / "forces.csv")]) == 0
    assert run(["mesh", result["mcap"], str(tmp_path / "part.stl")]) == 0
    assert run(["mesh", str(job), str(tmp_path / "part.3mf")]) == 0


def test_options_replace_the_jobs_program_table(use: Use, job: Path) -> None:
    fake = use(collision=False)
    options = ["--dialect", "auto", "--tool", "7", "--m-code", "72", "--m-code", "117"]
    assert run(["replay", str(job), "--quiet", *options]) == 0
    assert fake.job is not None
    program = fake.job.program
    assert (program.dialect, program.tool, program.m_codes) == ("auto", 7, {72: "none", 117: "none"})
