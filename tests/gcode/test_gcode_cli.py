"""The command line: what it prints, where, and its exit codes."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from rich.cells import cell_len

from gcode.cli.app import app
from gcode.cli.machine_options import DialectName, ProgramDialect
from gcode.dialects import AUTO, DIALECTS

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "gcode-command-line.md"
PROGRAM = """\
O1
G21 G90 G54
T3 M6
S1000 M3
G0 X10 Y0 Z5
G1 Z-1 F100
G3 X-10 Y0 I-10 J0 F200
G4 P500
G9
G0 Z5
M30
"""
Cli = Any


@pytest.fixture
def nc(tmp_path: Path) -> Path:
    path = tmp_path / "part.nc"
    path.write_text(PROGRAM)
    return path


def test_motions_are_one_object_a_line(cli: Cli, nc: Path) -> None:
    code, out, err = cli("motions", nc)
    made = [json.loads(line) for line in out.splitlines()]
    assert (code, err) == (0, "")
    assert [m["type"] for m in made] == ["rapid", "feed", "arc", "dwell", "rapid"]
    assert [m["line"] for m in made] == [5, 6, 7, 8, 10]
    assert {m["tool"] for m in made} == {3}
    assert {(m["spindle_rpm"], m["spindle_dir"]) for m in made} == {(1000.0, 1)}
    assert [m["feed_mm_min"] for m in made] == [0.0, 100.0, 200.0, 0.0, 0.0]
    arc = made[2]
    assert (arc["plane"], arc["turns"], arc["centre"], arc["end"]) == (17, 1, [0.0, 0.0, -1.0], [-10.0, 0.0, -1.0])
    assert (made[3]["seconds"], made[3]["end"]) == (0.5, [-10.0, 0.0, -1.0])


def test_motions_before_an_error_are_printed(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "bad.nc"
    path.write_text("G21 G90 G54\nG0 X1\nG1 X2\nG0 X3\nM30\n")
    code, out, err = cli("motions", path)
    assert code == 1
    assert [json.loads(line)["end"][0] for line in out.splitlines()] == [1.0]
    assert "bad.nc:3:1:" in err
    assert "missing-feed" in err
    assert err.splitlines()[-2:] == ["    G1 X2", "    ^"]


def test_tables_settings_and_options_meet_in_the_motions(cli: Cli, tmp_path: Path) -> None:
    files = {
        "p.ngc": "T1 M6\nG43 H1\nG55 G0 X1 Z2\n/G0 X5\nM2\n",
        "t.tbl": "T1 P1 Z0.5\n",
        "p.var": "5241 10\n5243 -1\n",
        "s.toml": 'units = "inch"\nmachine_units = "inch"\nblock_delete = false\n',
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    tables = ("--tool-table", tmp_path / "t.tbl", "--parameters", tmp_path / "p.var", "--settings", tmp_path / "s.toml")
    options = ("--dialect", "linuxcnc", "--block-delete")
    code, out, _ = cli("motions", tmp_path / "p.ngc", *tables, *options)
    made = [json.loads(line) for line in out.splitlines()]
    assert code == 0
    assert [m["end"] for m in made] == [[pytest.approx(11 * 25.4), 0.0, pytest.approx(25.4)]]
    assert (made[0]["wcs"], made[0]["h"]) == ("G55", 1)


def test_the_machines_unit_is_that_of_the_tables_and_not_of_the_program(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "p.ngc").write_text("T1 M6\nG43 H1\nG0 Z2\nM2\n")
    (tmp_path / "t.tbl").write_text("T1 P1 Z0.5\n")
    options = ("--dialect", "linuxcnc", "--tool-table", tmp_path / "t.tbl", "--machine-units", "inch")
    _, out, _ = cli("motions", tmp_path / "p.ngc", *options)
    (made,) = (json.loads(line) for line in out.splitlines())
    assert made["end"] == [0.0, 0.0, 2.0]
    (tmp_path / "p.ngc").write_text("T1 M6\nG43 H1\nG53 G0 Z20\nM2\n")
    _, out, _ = cli("motions", tmp_path / "p.ngc", *options)
    assert json.loads(out)["end"] == [0.0, 0.0, pytest.approx(20.0 - 12.7)]


def test_a_clean_program_passes_the_check(cli: Cli, nc: Path) -> None:
    code, out, err = cli("check", nc)
    assert (code, err) == (0, "")
    assert out == f"{nc}: no errors, 1 notice\n"


def test_notices_are_listed_once_with_their_lines(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "n.nc"
    path.write_text("G21 G90 G54\n" + "G9 G0 X1\n" * 12 + "M30\n")
    _, out, _ = cli("check", path, "--notices")
    listed, summary = out.splitlines()
    assert listed.endswith("lines 2, 3, 4, 5, 6, 7, 8, 9 and 4 more")
    assert summary == f"{path}: no errors, 12 notices"


def test_errors_of_several_files(cli: Cli, nc: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.nc"
    bad.write_text("G21 G90 G54\nG1 X2\nG0 X3 !\nM30\n")
    code, out, _ = cli("check", nc, bad)
    assert code == 1
    assert re.findall(r"\[([\w-]+)\]", out) == ["missing-feed", "unexpected-character"]
    assert f"{bad}:3:7:" in out
    assert out.splitlines()[-1] == f"{bad}: 2 errors"


def test_errors_as_json(cli: Cli, tmp_path: Path) -> None:
    bad = tmp_path / "bad.nc"
    bad.write_text("G21 G90 G54\nG1 X2\nM30\n")
    code, out, _ = cli("check", bad, "--json")
    (made,) = (json.loads(line) for line in out.splitlines())
    assert code == 1
    assert made["problem"]
    assert made["expected"]
    del made["problem"], made["expected"]
    place = {"file": str(bad), "line": 2, "column": 1, "text": "G1 X2", "calls": []}
    assert made == {"severity": "error", "code": "missing-feed", **place}


def test_notices_as_json(cli: Cli, nc: Path) -> None:
    assert cli("check", nc, "--json")[1] == ""
    (made,) = (json.loads(line) for line in cli("check", nc, "--json", "--notices")[1].splitlines())
    assert (made["severity"], made["line"]) == ("notice", 9)


def test_files_that_cannot_be_read(cli: Cli, nc: Path, tmp_path: Path) -> None:
    code, out, err = cli("check", tmp_path / "none.nc", nc, tmp_path)
    assert code == 1
    assert out == f"{nc}: no errors, 1 notice\n"
    rest = "; expected an NC program [unreadable-file]"
    assert err.splitlines() == [
        f"error: {tmp_path / 'none.nc'}: cannot be read: no such file or directory{rest}",
        f"error: {tmp_path}: cannot be read: is a directory{rest}",
    ]


def test_a_program_is_written_again_for_another_control(cli: Cli, nc: Path, tmp_path: Path) -> None:
    out = tmp_path / "new.ngc"
    assert cli("rewrite", nc, "-o", out, "--to", "linuxcnc", "--units", "inch", "--decimals", 6) == (0, "", "")
    assert out.read_text().startswith("G20 ")
    old, new = cli("motions", nc)[1].splitlines(), cli("motions", out, "--dialect", "linuxcnc")[1].splitlines()
    for before, after in zip(map(json.loads, old), map(json.loads, new), strict=True):
        assert after["type"] == before["type"]
        assert after["end"] == pytest.approx(before["end"], abs=3e-5)
        assert after["feed_mm_min"] == pytest.approx(before["feed_mm_min"], rel=1e-4)


def test_what_cannot_be_written_leaves_no_file(cli: Cli, nc: Path, tmp_path: Path) -> None:
    code, out, err = cli("rewrite", nc, "-o", tmp_path / "new.nc", "--to", "grbl")
    assert (code, out) == (1, "")
    assert err.startswith(f"error: {nc}:3:1: a change to tool 3, and grbl has no tool change; ")
    assert [path.name for path in tmp_path.iterdir()] == ["part.nc"]


@pytest.mark.parametrize("command", ["motions", "stats", "plot", "check"])
def test_tables_with_errors_are_named(cli: Cli, nc: Path, tmp_path: Path, command: str) -> None:
    table = tmp_path / "t.tbl"
    table.write_text("T1 P1\nT1 Q\n")
    more = ("-o", tmp_path / "p.png") if command == "plot" else ()
    code, out, err = cli(command, nc, "--tool-table", table, *more)
    assert (code, out) == (1, "")
    assert err.startswith(f"error: {table}:2:5: ")
    assert err.splitlines()[1:] == ["    T1 Q", "        ^"]


@pytest.mark.parametrize(
    "arguments",
    [
        ("motions",),
        ("motions", "{nc}", "--dialect", "heidenhain"),
        ("motions", "{nc}", "--machine-units", "cm"),
        ("motions", "{nc}", "--search-path", "none"),
        ("stats", "{nc}", "--rapid-mm-min", "0"),
        ("stats", "{nc}", "--rapid-mm-min", "nan"),
        ("plot", "{nc}"),
        ("plot", "{nc}", "-o", "p.png", "--view", "zz"),
        ("rewrite", "{nc}"),
        ("rewrite", "{nc}", "-o", "p.nc", "--wcs", "G60"),
        ("rewrite", "{nc}", "-o", "p.nc", "--to", "grbl", "--program-number", "5"),
        ("mill", "{nc}"),
        ("check",),
        ("--colour",),
    ],
)
def test_wrong_use_of_the_command_line_is_one_message(cli: Cli, nc: Path, arguments: tuple[str, ...]) -> None:
    code, out, err = cli(*(a.format(nc=nc) for a in arguments))
    command = f"gcode {arguments[0]}" if arguments[0] in ("motions", "stats", "plot", "rewrite", "check") else "gcode"
    assert (code, out) == (2, "")
    assert re.fullmatch(rf"error: .+; see '{command} --help'\n", err)
    assert "Value error" not in err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("motions", "none.nc"),
            "none.nc: cannot be read: no such file or directory; expected an NC program [unreadable-file]",
        ),
        (
            ("motions", "{nc}", "--settings", "none.toml"),
            "none.toml: cannot be read: no such file or directory; expected a text file [unreadable-file]",
        ),
        (
            ("plot", "{nc}", "-o", "p.bmp"),
            "p.bmp: unknown kind of image; expected a file name that ends in .png, .svg, .pdf",
        ),
        (("plot", "{nc}", "-o", "none/p.png"), "none/p.png: cannot be written: the folder none does not exist"),
        (("rewrite", "{nc}", "-o", "none/p.nc"), "none/p.nc: cannot be written: no such file or directory"),
    ],
)
def test_files_that_cannot_be_used_are_one_message(
    cli: Cli, nc: Path, arguments: tuple[str, ...], message: str
) -> None:
    assert cli(*(a.format(nc=nc) for a in arguments)) == (1, "", f"error: {message}\n")


def test_no_arguments_print_the_help(cli: Cli) -> None:
    code, out, err = cli()
    assert (code, err) == (2, "")
    assert "Usage: gcode" in out


@pytest.mark.parametrize("command", [(), ("check",), ("motions",), ("stats",), ("plot",), ("rewrite",)])
def test_the_help_names_no_python_types(cli: Cli, command: tuple[str, ...]) -> None:
    code, out, _ = cli(*command, "--help")
    assert code == 0
    assert not re.search(r"<(bool|str|int|float|path|file|list)\b", out)


def test_the_versions_are_printed(cli: Cli) -> None:
    code, out, _ = cli("--version")
    assert code == 0
    assert [line.split()[0] for line in out.splitlines()] == ["gcode", "python", "numpy"]
    assert all(re.search(r" \d+\.\d+", line) for line in out.splitlines())


def test_a_shell_can_complete_commands() -> None:
    asked = {"_GCODE_COMPLETE": "complete_bash", "COMP_WORDS": "gcode che", "COMP_CWORD": "1"}
    script = "from gcode.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", script],
        cwd=ROOT,
        env={**os.environ, **asked},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == ["check"]


def test_text_of_a_program_does_nothing_to_a_terminal(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "bad.nc"
    path.write_bytes(b"G0 X1 \x1b[31m\x9b\nM30\n")
    _, out, _ = cli("check", path)
    assert "\x1b" not in out
    assert "\x9b" not in out


@pytest.mark.parametrize(
    ("text", "caret"),
    [
        ("G0 X1 !", "          ^"),
        ("G0\tX1 !", "      \t   ^"),
        ("(漢字) G0 !", "              ^"),
        ("(e\u0301) G0 !", "           ^"),
        (f"({'x' * 200}) G0 !", f"    {' ' * 61}^"),
    ],
)
def test_the_caret_stands_under_the_word(cli: Cli, tmp_path: Path, text: str, caret: str) -> None:
    path = tmp_path / "bad.nc"
    path.write_text(f"{text}\nM30\n", encoding="utf-8")
    _, shown, under, *_ = cli("check", path)[1].splitlines()
    assert under == caret
    assert cell_len(shown[: shown.index("!")].expandtabs(8)) == cell_len(caret[:-1].expandtabs(8))


def test_statistics_as_tables_and_as_json(cli: Cli, nc: Path) -> None:
    code, out, _ = cli("stats", nc)
    assert code == 0
    for words in ("part.nc", "T3", "100, 200", "1000", "-10.000 to 10.000", "0.000 to 10.000"):
        assert words in out
    code, out, _ = cli("stats", nc, "--json", "--rapid-mm-min", "5000")
    made = json.loads(out)
    assert (code, made["file"], made["rapid_mm_min"]) == (0, str(nc), 5000.0)
    assert made["cutting_mm"] == pytest.approx(6.0 + 31.41592653589793)
    assert made["motions"] == {"rapid": 2, "feed": 1, "arc": 1, "dwell": 1}
    assert [tool["tool"] for tool in made["tools"]] == [0, 3] or [tool["tool"] for tool in made["tools"]] == [3]


def test_statistics_of_a_refused_program_are_not_given(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "bad.nc"
    path.write_text("G0 X1\nG1 X2\n")
    code, out, err = cli("stats", path)
    assert (code, out) == (1, "")
    assert "missing-feed" in err


@pytest.mark.parametrize("view", ["iso", "xy", "xz", "yz"])
@pytest.mark.parametrize("colour", ["z", "tool"])
def test_pictures(cli: Cli, nc: Path, tmp_path: Path, view: str, colour: str) -> None:
    pytest.importorskip("matplotlib")
    out = tmp_path / "p.png"
    assert cli("plot", nc, "-o", out, "--view", view, "--colour", colour) == (0, "", "")
    assert out.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("view", ["iso", "xz"])
def test_a_picture_has_units_ticks_and_the_path_s_ends(cli: Cli, nc: Path, tmp_path: Path, view: str) -> None:
    pytest.importorskip("matplotlib")
    out = tmp_path / "p.svg"
    assert cli("plot", nc, "-o", out, "--view", view)[0] == 0
    texts = re.findall(r"<!-- (.*?) -->", out.read_text())
    assert {"X, mm", "Z, mm", "start", "end", "rapid"} <= set(texts)
    assert sum(bool(re.fullmatch(r"[−-]?\d+(\.\d+)?", text)) for text in texts) >= 6


def test_a_program_without_motions_has_no_picture(cli: Cli, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    path = tmp_path / "none.nc"
    path.write_text("M30\n")
    code, _, err = cli("plot", path, "-o", tmp_path / "p.png")
    assert (code, err) == (1, "error: none.nc: no motion to draw\n")
    assert not (tmp_path / "p.png").exists()


def test_without_matplotlib_a_picture_is_refused(
    cli: Cli, nc: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    code, _, err = cli("plot", nc, "-o", tmp_path / "p.png")
    assert code == 1
    assert "matplotlib" in err


def test_a_reader_that_goes_ends_the_command_without_a_word(tmp_path: Path) -> None:
    path = tmp_path / "long.nc"
    path.write_text("G21 G90 G54\n" + "".join(f"G0 X{n % 100 + 1}\n" for n in range(20_000)) + "M30\n")
    command = [sys.executable, "-m", "gcode", "motions", str(path)]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert json.loads(process.stdout.readline())["line"] == 2
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 128 + 13


def test_the_help_loads_nothing_heavy() -> None:
    script = (
        "import sys; from gcode.cli import run; code = run(['--help']);"
        "heavy = {'numpy', 'matplotlib', 'gcode.flow.interpreter'} & set(sys.modules); sys.exit(code or bool(heavy))"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, check=False)
    assert done.returncode == 0


def test_every_dialect_can_be_asked_for() -> None:
    assert {name.value for name in DialectName} == set(DIALECTS)
    assert {name.value for name in ProgramDialect} == {*DIALECTS, AUTO}


def test_the_page_has_every_command_and_option() -> None:
    page = PAGE.read_text()
    commands = [c.callback.__name__ for c in app.registered_commands if c.callback is not None]
    assert commands == re.findall(r"^\| `gcode (\w+)", page, flags=re.M)
    sources = "".join(p.read_text() for p in (ROOT / "gcode" / "cli").glob("*.py"))
    options = set(re.findall(r'"(--[a-z-]+)"', sources)) | {"--tool-table", "--parameters", "--settings", "--view"}
    assert {o for o in options if f"`{o}" not in page} == set()
