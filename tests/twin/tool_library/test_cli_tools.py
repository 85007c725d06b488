"""``twin tools``: lists, checks, converts; exit codes and messages."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest
from support.job_files import PROGRAM, job_data
from support.tool_libraries import LINUXCNC, fusion_library, fusion_tool, zipped

from twin.cli import run
from twin.job import job_from_dict
from twin.tool_library import read_tool_library


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    drill = fusion_tool(type="drill", description="6 mm drill \x1b[31m\n", **{"post-process": {"number": 4}})
    Path("shop.tools").write_bytes(zipped(fusion_library(fusion_tool(), drill)))
    Path("bad.json").write_bytes(fusion_library(fusion_tool(SFDM=25374.6), fusion_tool(description="spare")))
    Path("tool.tbl").write_text(LINUXCNC)
    return tmp_path


def test_tools_are_listed_with_reasons_and_assumptions(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["tools", "shop.tools", "tool.tbl"]) == 0
    out, err = capsys.readouterr()
    assert err == "" and "\x1b[31m" not in out
    words = " ".join(out.split())
    assert "shop.tools: 2 tools, Fusion 360; mm, deg" in words
    assert "3 6 mm ball ball 6 3 2 18 5.8 x 4 32 x 47" in words
    assert 'T4 "6 mm drill ␛[31m" cannot be simulated: its point is not modelled' in words
    assert "all 2 tools: helix angle: not stored in this format" in words


def test_values_that_cannot_be_right_are_an_error_after_the_list(
    shop: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["tools", "bad.json"]) == 1
    out, err = capsys.readouterr()
    assert "number 3: 2 tools have it; a job names one by its name" in out
    assert err.splitlines() == [
        'warning: bad.json: T3 "6 mm ball": SFDM = 25374.6 mm: expected 0.001 to 500 mm',
        "error: values that cannot be right in 1 of 2 tools; see the warnings",
    ]


def test_json_has_the_sizes_of_the_chosen_tools(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["tools", "shop.tools", "tool.tbl", "--name", "BALL", "--json"]) == 0
    first, second = json.loads(capsys.readouterr().out)["tools"]
    asked = ("number", "name", "kind", "diameter_mm", "corner_radius_mm", "teeth", "flute_length_mm")
    assert [first[key] for key in asked] == [3, "6 mm ball", "ball", 6.0, 3.0, 2, 18.0]
    assert first["holder"][0] == {"diameter_mm": 6.0, "length_mm": 13.0}
    assert (second["number"], second["missing"], second["file"]) == (1, ["teeth", "flute_length_mm"], "tool.tbl")


def test_tools_written_as_toml_are_tables_of_a_job(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["tools", "shop.tools", "tool.tbl", "-o", "tools.toml"]) == 0
    written = "5 tools written to tools.toml, 2 of them as comments: they cannot be simulated\n"
    assert capsys.readouterr().out == written
    text = Path("tools.toml").read_text(encoding="utf-8")
    tables = tomllib.loads(text)["tools"]
    assert [(table["number"], table["kind"]) for table in tables] == [(3, "ball"), (1, "ball"), (2, "flat")]
    assert "# teeth =    # not in the library; required" in text
    assert '# T7 "8.5 drill" cannot be simulated' in text
    Path("slot.nc").write_text(PROGRAM)
    assert job_from_dict(job_data(tools=tables[:1]), shop).tools[0].diameter_mm == 6.0
    again = read_tool_library("tools.toml")
    assert [tool.as_job_table() for tool in again.tools] == tables


def test_tools_written_as_csv_are_the_same_tools(shop: Path) -> None:
    assert run(["tools", "shop.tools", "-o", "tools.csv"]) == 0
    assert read_tool_library("tools.csv").tools == read_tool_library("shop.tools").tools


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none.json"], "none.json: cannot be read: no such file or directory; expected a tool library"),
        (["shop.tools", "--number", "9"], "shop.tools: no tool has the number 9; list all with: twin tools"),
        (["shop.tools", "-o", "x.json"], "x.json: expected a file name that ends in .toml or .csv"),
        (["shop.tools", "-o", "bad.csv"], "bad.csv: already exists; replace it with --force"),
        (["slot.nc"], "slot.nc: is not a tool library but an NC program"),
        (["folder"], "folder: cannot be read: is a directory; expected a tool library"),
    ],
)
def test_mistakes_on_the_command_line(
    shop: Path, arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("bad.csv").touch()
    Path("slot.nc").write_text(PROGRAM)
    Path("folder").mkdir()
    assert run(["tools", *arguments]) == 1
    assert capsys.readouterr().err.startswith(f"error: {message}")
