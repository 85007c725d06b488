"""Text of files reaches a terminal or a report without characters that act on it, whatever file it is from."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from support.compared import log_of, records, run, write_log
from support.job_files import job_folder

import gcode.cli
import twin.cli
from gcode.cli.clean_console import CleanConsole
from gcode.underline import harmless, harmless_json
from twin.comparison.comparison import compare
from twin.comparison.report import html
from twin.measured.forces import force_log
from twin.measured.read import read_log
from twin.measured.settings import CompareSettings
from twin.measured.table import distinct
from twin.settings.toml_text import toml_text
from twin.sinks.mcap_sink import McapSink

#: Colour, end of the title, a C1 introducer, right-to-left override and mark, delete.
EVIL = "a\x1b[31mb\x1b]0;c\x07d\x9be\u202ef\u200fg\x7f"
LIBRARY = "name,diameter\n"
ACTING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")


def log_file(folder: Path, *, names: str = "Fx_N,Fy_N,Fz_N", cell: str = "1", name: str = "log.csv") -> Path:
    rows = "".join(f"{k / 1000},1,{cell},{k}\n" for k in range(4))
    (folder / name).write_text(f"t_s,{names}\n{rows}")
    return folder / name


def nc_file(folder: Path, text: str, name: str = "a.nc") -> Path:
    (folder / name).write_text(text)
    return folder / name


def of_log(folder: Path, log: Path) -> list[str]:
    with McapSink(folder / "run.mcap") as sink:
        for record in records():
            sink.write(record)
    return ["twin", "compare", str(folder / "run.mcap"), str(log)]


def of_toml(folder: Path, text: str) -> list[str]:
    path = job_folder(folder)
    path.write_text(path.read_text() + text)
    return ["twin", "replay", str(path)]


CASES: dict[str, Callable[[Path], list[str]]] = {
    "comment of a program": lambda f: ["gcode", "check", str(nc_file(f, f"({EVIL})\nG1 X1 Q{EVIL}\n"))],
    "notice": lambda f: ["gcode", "check", "--notices", str(nc_file(f, f"N1 ({EVIL}) G4 P1\nM117\n"))],
    "findings as JSON": lambda f: ["gcode", "check", "--json", str(nc_file(f, f"({EVIL}) G1 X1 Q1\n"))],
    "name of a program": lambda f: ["gcode", "check", str(nc_file(f, "G1 X1 Q1\n", f"{EVIL}.nc"))],
    "statistics": lambda f: ["gcode", "stats", str(nc_file(f, "G0 X1\nM30\n", f"{EVIL}[x].nc"))],
    "missing program": lambda f: ["gcode", "stats", str(f / f"{EVIL}.nc")],
    "wrong option": lambda _: ["gcode", "stats", f"--{EVIL}"],
    "column": lambda f: of_log(f, log_file(f, names=f"{EVIL}[/x],b,c")),
    "cell": lambda f: of_log(f, log_file(f, cell=EVIL)),
    "name of a log": lambda f: of_log(f, f / f"{EVIL}[x].csv"),
    "key": lambda f: of_toml(f, f'\n"{json.dumps(EVIL)[1:-1]}" = 1\n'.replace("\x7f", "\\u007f")),
    "value": lambda f: of_toml(f, f"\n[output]\nforce_on = {json.dumps(EVIL)}\n".replace("\x7f", "\\u007f")),
    "mesh": lambda f: ["twin", "reach", str(nc_file(f, f"solid {EVIL}\n", f"{EVIL}.stl")), "--tool", "ball 6"],
    "archive": lambda f: ["twin", "info", str(nc_file(f, EVIL, f"{EVIL}.mcap"))],
    "tool library": lambda f: ["twin", "tools", str(nc_file(f, f"{LIBRARY}{EVIL},{EVIL}\n{LIBRARY}", f"{EVIL}.csv"))],
    "argument": lambda _: ["twin", "export", EVIL],
}


@pytest.mark.parametrize("name", CASES)
def test_messages_are_clean(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, *arguments = CASES[name](tmp_path)
    {"gcode": gcode.cli.run, "twin": twin.cli.run}[program](arguments)
    printed = "".join(capsys.readouterr())
    assert len(printed) > 20
    assert not ACTING.search(printed)


def test_a_batch_is_clean(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Names of rows, of logs and of columns, on both streams, in JSON and in the table that is written."""
    of_log(tmp_path, log_file(tmp_path, names=f"{EVIL},Fx{EVIL},b"))
    folder = tmp_path / EVIL.replace("/", "")
    folder.mkdir()
    table, out = folder / "t.csv", folder / "out.csv"
    table.write_text(f"name,run,measured\n{EVIL},../run.mcap,../log.csv\nlost,../run.mcap,{EVIL}.csv\n")
    for options in (["-o", str(out)], ["--json"]):
        assert twin.cli.run(["compare", "--batch", str(table), *options]) == 1
        printed = "".join(capsys.readouterr())
        assert "columns are a" in printed
        assert not ACTING.search(printed)
    assert "columns are a" in out.read_text() and not ACTING.search(out.read_text())


@pytest.mark.parametrize(
    "command", ["gcode check", "gcode stats", "twin replay", "twin job", "twin info", "twin tools"]
)
def test_names_are_on_one_line(command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, name = command.split()
    nc_file(tmp_path, "G0 X1 Q1\n" if name == "check" else "M30\n", "a\nerror: b\t[c].nc")
    for file in ("a\nerror: b\t[c].nc", "none\nerror: b\t[c].nc"):
        {"gcode": gcode.cli.run, "twin": twin.cli.run}[program]([name, str(tmp_path / file)])
        printed = "".join(capsys.readouterr())
        assert "\u240aerror: b\u2409[c].nc" in printed
        assert "\nerror: b" not in printed


def test_names_of_columns_are_on_one_line() -> None:
    assert distinct(["Fx\r\nerror: b", "Fy [N]", "\n", ""]) == ("Fx error: b", "Fy [N]", " ", "column4")


def test_tables_take_no_text_as_markup(capsys: pytest.CaptureFixture[str]) -> None:
    CleanConsole().print(f"[/x] [red]{EVIL}", style="bold")
    printed = capsys.readouterr().out
    assert printed.startswith("[/x] [red]a\u241b[31mb")
    assert not ACTING.search(printed)


def test_a_report_is_clean(tmp_path: Path) -> None:
    made = run()
    log = force_log(read_log(write_log(tmp_path / f"{EVIL}.csv", log_of(made), f"t_s,Fx {EVIL},Fy,Fz")))
    text = html(compare(made, log, CompareSettings(map="x=#1,y=Fy,z=Fz")), dict.fromkeys(_Pictures(), b""))
    assert "\u241b[31mb" in text
    assert not ACTING.search(text)


class _Pictures(list[str]):
    """Names of all pictures of a report with one window."""

    def __init__(self) -> None:
        super().__init__(["whole", "spectra", "histogram", "window_1", "polar_1"])


def test_json_and_toml_keep_the_text() -> None:
    text = harmless_json(json.dumps(EVIL, ensure_ascii=False))
    assert json.loads(text) == EVIL
    assert not ACTING.search(text + toml_text({"a": {EVIL: EVIL}}))


def test_text_stays_as_long_as_it_was() -> None:
    assert len(harmless(EVIL)) == len(EVIL)
    assert harmless("Kraft [µN] 力\t\n") == "Kraft [µN] 力\t\n"
    assert harmless("\ud800\u2028") == "\ufffd\ufffd"


def test_commands_print_through_one_door() -> None:
    root = Path(__file__).parents[1]
    doors = {"console.py", "clean_console.py", "app.py"}  # app.py prints versions
    direct = re.compile(r"typer\.(?:echo|secho)\(|(?<![\w.])print\(|\bConsole\(\w*\)")
    for folder in ("gcode", "twin"):
        for file in (root / folder).rglob("*.py"):
            if file.name not in doors and "cli" in file.parts:
                assert not direct.search(file.read_text()), f"{file}: use the functions of {folder}.cli.console"
