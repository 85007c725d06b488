"""The command line as a whole: help, versions, exit codes, messages."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from gcode.errors import GcodeError, Place
from twin import __version__
from twin.cli import run
from twin.cli.run import message_of
from twin.errors import JobError, MeshError
from twin.job import job_schema

COMMANDS = ("replay", "view", "info", "export", "mesh", "schema")


def test_help_names_every_command_and_exit_code(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["--help"]) == 0
    shown = capsys.readouterr().out
    for word in (*COMMANDS, "Exit codes", "130"):
        assert word in shown


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run([command, "--help"]) == 0
    assert f"twin {command}" in capsys.readouterr().out


def test_help_needs_nothing_heavy() -> None:
    script = (
        "import sys; from twin.cli import run; assert run(['replay', '--help']) == 0;"
        "sys.exit(' '.join({'numba', 'numpy', 'pyarrow', 'rerun', 'scipy', 'trimesh'} & set(sys.modules)) or 0)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["--version"]) == 0
    assert capsys.readouterr().out == f"{__version__}\n"


@pytest.mark.parametrize(
    "arguments",
    [["bogus"], ["replay"], ["replay", "job.toml", "--bogus"], ["export", "a.mcap", "b.csv", "--on", "air"]],
)
def test_wrong_arguments_are_usage_errors(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "Usage: twin" in captured.err


def test_schema_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["schema"]) == 0
    assert json.loads(capsys.readouterr().out) == job_schema()


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (MeshError("part.stl: is open"), "part.stl: is open"),
        (JobError("job.toml", ["a: missing"]), "job.toml: a: missing"),
        (JobError("job.toml", ["a: missing", "b = 3: no"]), "job.toml: 2 mistakes\n  a: missing\n  b = 3: no"),
        (
            GcodeError(Place(file="a.nc", line=3, column=4, text="G1 X1"), "missing-feed", "no feed", "an F word"),
            "a.nc:3:4: no feed; expected an F word [missing-feed]\n    G1 X1\n       ^",
        ),
    ],
    ids=["plain", "one mistake", "two mistakes", "block"],
)
def test_errors_in_words(error: JobError | GcodeError, message: str) -> None:
    assert message_of(error) == message


def test_no_memory_is_said(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def exhausted() -> None:
        raise MemoryError

    monkeypatch.setattr("twin.job.job_schema", exhausted)
    assert run(["schema"]) == 1
    assert capsys.readouterr().err == "error: not enough memory; a larger simulation.slice_pitch_mm needs less\n"
