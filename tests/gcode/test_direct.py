"""Simple command lines end as the command-line library ends them."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcode.cli.app import app
from gcode.cli.direct import SimpleCommand, simple_command
from gcode.cli.entry import carry_out, run

PROGRAM = "G21 G90\nM3 S500\nG0 X1 Y2\nG1 Z-1 F100\nG2 X3 I1\n(c)\nG1 X4\nX5 M8\nG64\nM30\n"


@pytest.mark.parametrize(
    "words",
    ["check", "check --json", "check --notices", "check --notices --json -d haas", "stats", "stats --json", "motions"],
)
@pytest.mark.parametrize("text", [PROGRAM, PROGRAM.replace("G64", "G999 (x)")])
def test_the_same_output_and_code(
    words: str, text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("t.nc").write_text(text)
    arguments = [*words.split(), "t.nc"]
    assert simple_command(arguments) is not None
    directly = (run(arguments), capsys.readouterr())
    monkeypatch.setattr("gcode.cli.direct.simple_command", lambda _: None)
    assert (run(arguments), capsys.readouterr()) == directly
    assert directly[0] == (0 if "G999" not in text else 1)


def test_a_missing_file_is_the_same_error(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["check", "no.nc"]) == carry_out(app, ["check", "no.nc"], "gcode") == 1
    first, second = capsys.readouterr().err.splitlines()
    assert first == second


def test_a_simple_command() -> None:
    found = simple_command(["check", "a.nc", "--json", "-d", "grbl", "b.nc"])
    assert found == SimpleCommand(
        name="check", files=(Path("a.nc"), Path("b.nc")), flags=frozenset({"--json"}), dialect="grbl"
    )


@pytest.mark.parametrize(
    "words",
    [
        *("", "check", "plot a.nc", "stats a.nc b.nc", "motions a.nc --json", "stats a.nc --help", "--version"),
        *("stats a.nc -d auto", "stats a.nc -d", "stats a.nc --dialect=haas", "stats --rapid-mm-min 5 a.nc", "check -"),
    ],
)
def test_other_command_lines_are_left(words: str) -> None:
    assert simple_command(words.split()) is None


def test_completion_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("_GCODE_COMPLETE", "complete_bash")
    assert simple_command(["check", "a.nc"]) is None
