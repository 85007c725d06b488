"""Options of the command line for the machine and the dialect, and what it prints about them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

Cli = Any


def test_the_unit_of_tables_is_the_machines(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "p.ngc").write_text("G21 T1 M6\nG43 H1\nG53 G0 Z20\nM2\n")
    (tmp_path / "t.tbl").write_text("T1 P1 Z0.5\n")
    options = ("--dialect", "linuxcnc", "--tool-table", tmp_path / "t.tbl", "--settings", tmp_path / "s.toml")
    for units, length in (("inch", 12.7), ("mm", 0.5)):
        (tmp_path / "s.toml").write_text(f'machine_units = "{units}"\nunits = "inch"\n')
        _, out, _ = cli("motions", tmp_path / "p.ngc", *options)
        (made,) = (json.loads(line) for line in out.splitlines())
        assert made["end"][2] == pytest.approx(20.0 - length)


def test_codes_of_the_machine_builder_and_the_first_tool_are_options(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "b.nc"
    path.write_text("G21 G90 G54\nM72\nM117\nG0 X1\nM30\n")
    code, out, _ = cli("check", path)
    assert (code, out.count("--m-code")) == (1, 2)
    code, out, _ = cli("check", path, "--m-code", "72", "--m-code", "117")
    assert (code, out) == (0, f"{path}: no errors, 2 notices\n")
    _, out, _ = cli("motions", path, "--m-code", "72", "--m-code", "117", "--tool", "7")
    assert json.loads(out)["tool"] == 7


def test_warnings_are_printed_without_being_asked_for(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "w.nc"
    path.write_text("G21 G90 G54\nG91 G28 Z0 G90\nG41\nG0 X1\nG40 X2\nM30\n")
    code, out, _ = cli("check", path)
    *warnings, summary = out.splitlines()
    assert [line.split("[")[1].split("]")[0] for line in warnings] == ["last-of-group", "radius-zero"]
    assert (code, summary) == (0, f"{path}: no errors, 2 warnings")
    _, out, _ = cli("check", path, "--json")
    assert [json.loads(line)["severity"] for line in out.splitlines()] == ["warning", "warning"]


def test_the_likeliest_dialect_is_taken_and_named(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "a.nc"
    path.write_text("G21 G90\n#<depth> = 3\nG0 Z#<depth>\nM2\n")
    why = "the dialect is taken as linuxcnc: fanuc does not have '#<depth> = 3' in line 2"
    code, out, _ = cli("check", path, "--dialect", "auto")
    assert (code, out) == (
        0,
        f"{path}: warning: {why} [auto-dialect], line 1\n{path}: no errors, 1 warning\n",
    )
    code, out, err = cli("motions", path, "-d", "auto")
    assert (code, err) == (0, f"{path}: {why}\n")
    assert json.loads(out)["end"] == [0.0, 0.0, 3.0]
    code, _, err = cli("motions", path)
    assert code == 1
    assert err.splitlines()[-1].startswith("the program looks like one for linuxcnc (")
