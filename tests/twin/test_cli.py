"""The command line as a whole: help, versions, exit codes, messages."""

from __future__ import annotations

import json
import os
import platform
import re
import subprocess
import sys
from pathlib import Path

import numba
import pytest

from gcode.cli import exit_codes as gcode_codes
from gcode.errors import GcodeError, Place
from twin import __version__
from twin.cli import exit_codes as twin_codes
from twin.cli import run
from twin.cli.entry import message_of
from twin.errors import JobError, MeshError
from twin.job import job_schema

ROOT = Path(__file__).parents[2]
REFERENCE = ROOT / "recordings" / "reference" / "slot.mcap"
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
    lines = dict(line.split() for line in capsys.readouterr().out.splitlines())
    assert list(lines) == ["twin", "python", "numba", "numpy", "rerun-sdk"]
    assert lines["twin"] == __version__
    assert lines["python"] == platform.python_version()
    assert lines["numba"] == numba.__version__


def test_without_arguments_there_is_the_help_and_the_code_of_a_wrong_use(capsys: pytest.CaptureFixture[str]) -> None:
    assert run([]) == 2
    assert "Usage: twin" in capsys.readouterr().out


def test_completion_can_be_installed(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["--help"]) == 0
    shown = capsys.readouterr().out
    assert "--install-completion" in shown
    assert "--show-completion" in shown


def in_a_process(*arguments: str | Path, **more: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "twin", *map(str, arguments)]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=ROOT, env={**os.environ, **more}
    )


def test_commands_are_completed() -> None:
    asked = {"_TWIN_COMPLETE": "complete_bash", "COMP_WORDS": "twin re", "COMP_CWORD": "1"}
    assert in_a_process(**asked).communicate()[0].decode().split() == ["replay", "report", "reach"]


@pytest.mark.parametrize(
    "arguments", [["export", REFERENCE, "-"], ["info", REFERENCE], ["schema"]], ids=lambda a: str(a[0])
)
def test_a_reader_that_closes_its_pipe_ends_the_command_without_a_message(arguments: list[str | Path]) -> None:
    process = in_a_process(*arguments)
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()
    assert process.stderr.read() == b""
    assert process.wait() == 141
    process.stderr.close()


def test_gcode_and_twin_have_the_same_exit_codes() -> None:
    shared = {name: value for name, value in vars(gcode_codes).items() if name.isupper()}
    assert shared == {"OK": 0, "ERROR": 1, "USAGE": 2, "SIGNAL": 128}
    assert {name: getattr(twin_codes, name) for name in shared} == shared
    assert {twin_codes.COLLISION, twin_codes.OUT_OF_TOLERANCE} & set(shared.values()) == set()


@pytest.mark.parametrize(
    "arguments",
    [["bogus"], ["replay"], ["replay", "job.toml", "--bogus"], ["export", "a.mcap", "b.csv", "--on", "air"]],
)
def test_wrong_arguments_are_usage_errors(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert re.fullmatch(r"error: .+; see 'twin.* --help'\n", captured.err)


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
    assert capsys.readouterr().err == "error: not enough memory\n"
