"""Full and closed outputs, and signals at any time: at most one line, the documented exit code, nothing left."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from support.fake_replay import FakeReplay
from support.job_files import job_folder

import gcode.cli
import twin.cli
from gcode.cli.entry import console_script
from gcode.cli.signals import end_at_once, end_in_order

ARCHIVE = Path(__file__).parent / "golden" / "archive" / "slot_0_1_0.mcap"
PROGRAM = "G21 G90 G94\nG0 X0 Y0 Z5\nG1 X10 F100\nM30\n"
FULL = "error: standard output: cannot be written: no space left on device\n"

pytestmark = pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device there")


@pytest.fixture(autouse=True)
def signals() -> Iterator[None]:
    usual = {n: signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    yield
    for number, handler in usual.items():
        signal.signal(number, handler)


def commands(folder: Path) -> dict[str, tuple[Callable[[list[str]], int], list[str]]]:
    (program := folder / "p.nc").write_text(PROGRAM)
    (library := folder / "tools.csv").write_text("number,diameter_mm\n1,6\n")
    archive, nc = str(ARCHIVE), str(program)
    return {
        "info": (twin.cli.run, ["info", archive]),
        "info --json": (twin.cli.run, ["info", archive, "--json"]),
        "export": (twin.cli.run, ["export", archive, str(folder / "f.csv")]),
        "mesh": (twin.cli.run, ["mesh", archive, str(folder / "o.stl")]),
        "tools": (twin.cli.run, ["tools", str(library), "-o", str(folder / "t.toml")]),
        "tools --json": (twin.cli.run, ["tools", str(library), "--json"]),
        "schema": (twin.cli.run, ["schema"]),
        "--help": (twin.cli.run, ["--help"]),
        "--version": (twin.cli.run, ["--version"]),
        "check": (gcode.cli.run, ["check", nc]),
        "motions": (gcode.cli.run, ["motions", nc]),
        "stats": (gcode.cli.run, ["stats", nc]),
        "gcode --help": (gcode.cli.run, ["--help"]),
    }


NAMES = sorted(commands(Path("/tmp")))


@pytest.mark.parametrize("name", NAMES)
def test_a_full_standard_output(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run, arguments = commands(tmp_path)[name]
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        monkeypatch.setattr(sys, "stdout", full)
        assert run(arguments) == 1
        assert capsys.readouterr().err == FULL
    assert not list(tmp_path.glob("*partial*"))


@pytest.mark.parametrize("name", NAMES)
def test_a_pipe_without_a_reader(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run, arguments = commands(tmp_path)[name]
    read, write = os.pipe()
    os.close(read)
    with os.fdopen(write, "w", encoding="utf-8") as pipe:
        monkeypatch.setattr(sys, "stdout", pipe)
        assert run(arguments) == 141
        assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("redirection", "code", "message"),
    [
        (">&-", 1, "error: standard output: cannot be written: bad file descriptor\n"),
        (">/dev/full 2>/dev/full", 1, ""),
    ],
)
def test_closed_streams_of_the_program_itself(redirection: str, code: int, message: str, tmp_path: Path) -> None:
    """Only the whole process shows that nothing is printed while Python ends, and that its code stays."""
    (tmp_path / "p.nc").write_text(PROGRAM)
    command = f"{sys.executable} -m gcode motions p.nc {redirection}"
    done = subprocess.run(["/bin/sh", "-c", command], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (code, "", message)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP], ids=lambda n: n.name)
def test_a_signal_during_set_up_leaves_nothing(
    number: signal.Signals, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    job = job_folder(tmp_path)

    def preparing(*_: Any) -> FakeReplay:
        assert [p.name for p in (tmp_path / "recordings").iterdir()] == ["slot.partial.mcap"]
        signal.raise_signal(number)
        return FakeReplay()

    monkeypatch.setattr("twin.cli.commands.runs.replay_work.open_replay", preparing)
    monkeypatch.setattr(sys, "argv", ["twin", "replay", str(job)])
    for which in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(which, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    end_at_once()
    with pytest.raises(SystemExit) as ending:
        console_script(twin.cli.run)
    assert ending.value.code == 128 + number
    assert capfd.readouterr().err.strip() == ("stopped by Ctrl-C" if number == signal.SIGINT else "")
    assert list((tmp_path / "recordings").iterdir()) == []


def test_a_signal_that_is_ignored_stays_ignored() -> None:
    """As by nohup."""
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    end_at_once()
    end_in_order()
    assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
