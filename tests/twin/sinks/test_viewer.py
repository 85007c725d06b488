"""The viewer listens on this computer only, and where there is no screen that is stated at once."""

from __future__ import annotations

import socket
import subprocess
from pathlib import Path
from typing import Any

import pytest

from tests.support.ports import free_port
from twin.cli import run
from twin.errors import TwinError
from twin.sinks.rerun import viewer
from twin.sinks.rerun.sink import RerunSink

ARCHIVE = Path(__file__).parents[2] / "golden" / "archive" / "slot_0_1_0.mcap"
ADVICE = (
    "show an archive in a browser with 'twin view RUN.mcap --web', or write a recording with --rrd FILE, and open it "
    "with 'rerun FILE' on a computer with a screen"
)


@pytest.fixture(autouse=True)
def no_viewer(monkeypatch: pytest.MonkeyPatch) -> None:
    """No viewer is running, and there is no screen."""
    monkeypatch.setattr(viewer.sys, "platform", "linux")
    monkeypatch.setattr(viewer, "_PORT", free_port())
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"):
        monkeypatch.delenv(name, raising=False)


@pytest.mark.parametrize(
    ("name", "value", "problem"),
    [
        ("HOME", "/", "there is no screen for the viewer (DISPLAY and WAYLAND_DISPLAY are not set)"),
        ("DISPLAY", ":4711", "the display :4711 for the viewer cannot be reached"),
        ("DISPLAY", "127.0.0.1:4711.0", "the display 127.0.0.1:4711.0 for the viewer cannot be reached"),
        ("WAYLAND_DISPLAY", "wayland-4711", "the display wayland-4711 for the viewer cannot be reached"),
    ],
)
def test_without_a_screen(name: str, value: str, problem: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(name, value)
    with pytest.raises(TwinError) as error:
        RerunSink(spawn=True)
    assert str(error.value) == f"{problem}; {ADVICE}"


@pytest.mark.parametrize(
    "arguments", [["view", str(ARCHIVE)], ["compare", str(ARCHIVE), "none.csv", "--view"], ["replay", "JOB", "--view"]]
)
def test_every_command_states_it_before_its_work(
    arguments: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from support.job_files import job_folder

    def never(*_: Any) -> None:
        raise AssertionError("the replay was prepared")

    monkeypatch.setattr("twin.cli.commands.runs.replay_work.open_replay", never)
    job = job_folder(tmp_path)
    assert run([str(job) if a == "JOB" else a for a in arguments]) == 1
    assert capsys.readouterr().err.startswith("error: there is no screen for the viewer")
    assert not list(tmp_path.rglob("*.mcap"))


def test_a_viewer_that_is_running_is_used(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also one behind the port that ssh forwards to a computer with a screen."""
    with socket.create_server(("127.0.0.1", viewer._PORT)):
        assert viewer.viewer_sink() is not None


def test_a_display_that_answers_is_enough(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.setenv("WAYLAND_DISPLAY", "w")
    with socket.socket(socket.AF_UNIX) as compositor:
        compositor.bind(str(tmp_path / "w"))
        compositor.listen()
        viewer.require_viewer()


class Viewer:
    """Stands in for the viewer's process: listens after a moment, or ends."""

    def __init__(self, command: list[str], code: int | None) -> None:
        self.command, self._code = command, code
        self._server: socket.socket | None = None

    def poll(self) -> int | None:
        if self._code is None and self._server is None:
            host, port = (self.command[self.command.index(o) + 1] for o in ("--bind", "--port"))
            self._server = socket.create_server((host, int(port)))
        return self._code

    def close(self) -> None:
        if self._server is not None:
            self._server.close()


@pytest.mark.parametrize("code", [None, 1])
def test_a_started_viewer_listens_on_this_computer_only(code: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[Viewer] = []

    def start(command: list[str], **_: Any) -> Viewer:
        started.append(Viewer(command, code))
        return started[-1]

    monkeypatch.setattr(viewer, "require_viewer", lambda: None)
    monkeypatch.setattr(subprocess, "Popen", start)
    if code is None:
        viewer.viewer_sink()
    else:
        with pytest.raises(TwinError) as error:
            viewer.viewer_sink()
        assert str(error.value) == f"the rerun viewer cannot be started: it ended with code 1; {ADVICE}"
    assert started[0].command[3:5] == ["--bind", "127.0.0.1"]
    started[0].close()
