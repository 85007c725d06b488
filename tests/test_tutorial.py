"""The tutorial's commands and scripts run as they are written, in their order."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import matplotlib as mpl
import pytest

from twin.cli import run

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"^```(sh|python)\n(.*?)^```", flags=re.MULTILINE | re.DOTALL)


def test_the_tutorial_runs_as_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = (ROOT / "docs" / "tutorial.md").read_text()
    shutil.copytree(ROOT / "examples" / "ball_slot", tmp_path / "examples" / "ball_slot")
    monkeypatch.chdir(tmp_path)
    mpl.use("Agg")
    printed = ""
    for kind, text in BLOCK.findall(page):
        if kind == "python":
            exec(compile(text, "tutorial.md", "exec"), {})
        elif text.startswith("twin "):
            arguments = shlex.split(text)[1:]
            if arguments[0] == "view":  # the recording in place of a window
                arguments += ["--rrd", "tutorial/slot.rrd"]
            assert run(arguments) == 0, text
            printed += capsys.readouterr().out
        else:
            assert text == "python -m pip install .\n"
    for shown in re.findall(r"^```\n(.*?)^```", BLOCK.sub("", page), flags=re.MULTILINE | re.DOTALL):
        lines = {line.strip() for line in printed.splitlines()}
        assert {line.strip() for line in shown.splitlines()} <= lines
    made = {p.name for p in (tmp_path / "tutorial").iterdir()}
    assert {"slot.mcap", "slot.rrd", "forces.csv", "forces.png", "synthetic.csv", "report"} <= made
