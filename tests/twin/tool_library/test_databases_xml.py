"""Tool databases of Vectric's programs, and tools as XML: DIN 4000, Creo."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from support.tool_libraries import CREO, din_tool, din_tools, vectric_database

from twin.errors import ToolLibraryError
from twin.tool_library import LibraryTool, ToolCylinder, ToolLibrary, read_tool_library


def library(tmp_path: Path, data: bytes) -> ToolLibrary:
    (tmp_path / "library").write_bytes(data)
    return read_tool_library(tmp_path / "library")


def din(tmp_path: Path, **values: str) -> LibraryTool:
    (tool,) = library(tmp_path, din_tools(din_tool(**values))).tools
    return tool


def test_a_database_of_vectric(tmp_path: Path) -> None:
    found = library(tmp_path, vectric_database())
    flat, ball, v_bit, tapered = found.tools
    assert found.format == "Vectric"
    assert (flat.number, flat.name, flat.kind, flat.teeth) == (7, "1/8 end mill", "flat", 2)
    assert (flat.diameter_mm, flat.flute_length_mm) == (3.175, 12.7)
    assert (ball.number, ball.name, ball.kind, ball.diameter_mm) == (None, "4 mm ball", "ball", 4.0)
    assert (v_bit.kind, v_bit.diameter_mm, v_bit.taper_deg) == ("taper", 0.2, 30.0)
    assert (tapered.kind, tapered.obstacle) == ("taper", "the library has no usable taper angle")


def test_other_and_damaged_databases_are_refused(tmp_path: Path) -> None:
    with closing(sqlite3.connect(":memory:")) as base:
        base.execute("CREATE TABLE unrelated (x)")
        other = bytes(base.serialize())
    for data, message in ((other, "no such table: tool_geometry"), (vectric_database()[:3000], "malformed|disk image")):
        with pytest.raises(ToolLibraryError, match=f"the SQLite file cannot be used .*({message})"):
            library(tmp_path, data)


def test_a_view_that_never_ends_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("twin.tool_library.formats.vectric._MOST_STEPS", 1_000_000)
    with closing(sqlite3.connect(":memory:")) as base:
        endless = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT max(i) AS id FROM n"
        base.execute(f"CREATE VIEW tool_geometry AS {endless}")
        data = bytes(base.serialize())
    with pytest.raises(ToolLibraryError, match="interrupted"):
        library(tmp_path, data)


def test_a_milling_cutter_by_din_4000_has_a_helix_angle(tmp_path: Path) -> None:
    tool = din(tmp_path)
    assert (tool.kind, tool.name, tool.diameter_mm, tool.teeth, tool.helix_deg) == (
        "flat",
        "Fräser 12345",
        5.0,
        2,
        40.0,
    )
    assert (tool.flute_length_mm, tool.shank) == (13.0, ToolCylinder(diameter_mm=4.6, length_mm=8.0))
    assert tool.holder == (ToolCylinder(diameter_mm=6.0, length_mm=36.0),)
    assert din(tmp_path, F3="L").helix_deg == -40.0


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        ({"BLD": "1", "G1": "0,5"}, "bull"),
        ({"BLD": "6"}, "ball"),
        ({"BLD": "10"}, "thread mill"),
        ({"BLD": "0", "G5": "140"}, "din4000-82 figure 0"),
        ({"NSM": "DIN4000-81", "BLD": "1"}, "drill"),
        ({"NSM": "DIN4000-80", "BLD": "2"}, "tap"),
    ],
)
def test_figures_of_din_4000(tmp_path: Path, values: dict[str, str], kind: str) -> None:
    assert din(tmp_path, **values).kind == kind


def test_a_library_of_creo(tmp_path: Path) -> None:
    (tool,) = library(tmp_path, CREO).tools
    sizes = (tool.diameter_mm, tool.corner_radius_mm, tool.flute_length_mm)
    assert (tool.number, tool.name, tool.kind, tool.teeth, *sizes) == (2, "T0002", "bull", 3, 12.0, 1.0, 22.0)
    (cone,) = library(tmp_path, CREO.replace(b"<Beta>0.0", b"<Beta>5.0")).tools
    assert not cone.simulated


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"<Tool-Data><Tool>", "not valid XML: no element found"),
        (b"<html></html>", "XML of the kind 'html' is not a tool library; expected Tool-Data"),
        (b"<Tool-Data></Tool-Data>", "the DIN 4000 library has no tools"),
        (b"<!DOCTYPE a [<!ENTITY b 'c'>]><Tool-Data>&d;</Tool-Data>", "not valid XML: undefined entity"),
    ],
)
def test_xml_that_is_not_a_library(tmp_path: Path, data: bytes, message: str) -> None:
    with pytest.raises(ToolLibraryError, match=message):
        library(tmp_path, data)
