"""README.md: every command runs as written in a fresh checkout, and prints what the page shows.

Commands that take longer than a test should are run by ``.ci/run``, word for word.
"""

from __future__ import annotations

import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.readme import Block, blocks, contains

import twin
from gcode.cli import run as run_gcode
from twin.cli import run as run_twin

ROOT = Path(__file__).parents[1]
BLOCKS = blocks()
#: Commands whose first words are these are in ``.ci/run``.
LONG = (
    "python -m pip install",
    "python examples/mold",
    "python examples/test_cuts",
    "python examples/torus",
    "twin identify",
    "twin paths",
    "twin reach",
    "twin verify",
)
COMMANDS = [command for block in BLOCKS for command in block.commands if block.kind == "commands"]
SHORT = [command for command in COMMANDS if not command.startswith(LONG)]


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A fresh checkout's files for users, as the working directory."""
    kept = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "examples", "recordings"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    files = kept.stdout.splitlines() if kept.returncode == 0 else []
    for file in files or ["examples", "recordings/reference"]:
        target = tmp_path / file
        target.parent.mkdir(parents=True, exist_ok=True)
        (shutil.copytree if (ROOT / file).is_dir() else shutil.copyfile)(ROOT / file, target)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def carry_out(command: str) -> None:
    program, *arguments = shlex.split(command)
    assert {"twin": run_twin, "gcode": run_gcode}[program](arguments) == 0


def test_the_page_has_commands_and_samples() -> None:
    assert len(SHORT) >= 10
    assert len(COMMANDS) >= len(SHORT) + 8
    assert [block.kind for block in BLOCKS if block.kind != "commands"] == ["output", "output", "python"]


@pytest.mark.parametrize("command", SHORT)
def test_a_command_runs_as_written(
    command: str, checkout: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("twin.sinks.rerun.viewer._listens", lambda: True)  # no window
    carry_out(command)
    out, err = capfd.readouterr()
    assert "error" not in err
    if command.startswith("twin compare"):
        assert contains(out, BLOCKS[[b.commands[:1] for b in BLOCKS].index((command,)) + 1].text)


def test_commands_that_take_long_are_run_on_every_change() -> None:
    script = (ROOT / ".ci" / "run").read_text()
    assert [command for command in COMMANDS if command not in SHORT and command not in script] == []


def test_the_first_sample_is_checked_on_every_change() -> None:
    script = (ROOT / ".ci" / "run").read_text()
    assert "python tests/support/readme.py" in script


def python_block() -> Block:
    return next(block for block in BLOCKS if block.kind == "python")


def test_two_lines_of_python_lead_to_a_force_array(checkout: Path) -> None:
    lines = [line for line in python_block().text.splitlines() if line.strip()]
    assert len(lines) == 2
    code = f"{python_block().text}\nprint(fx_n.max())"
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code], cwd=checkout, capture_output=True, text=True, check=True
    )
    peak = twin.open_run(checkout / "recordings" / "reference" / "slot.mcap").forces["fx_n"].max()
    assert done.stdout == f"{peak}\n"


def test_samples_are_compared_line_by_line() -> None:
    assert contains("a\nb  \nc\n", "b\nc")
    assert not contains("a\nb\nd\nc\n", "b\nc")
    assert contains("x computed in 0:03.8  (2.00x real time)\n", "x computed in 0:09.1  (5x real time)")
