"""Tool bits and libraries of FreeCAD, tool tables of LinuxCNC and CAMotics."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.tool_libraries import CAMOTICS, FREECAD_HOLDER, LINUXCNC, freecad_bit, freecad_library

from twin.errors import ToolLibraryError
from twin.tool_library import LibraryTool, ToolCylinder, read_tool_library


def only(path: Path, data: bytes) -> LibraryTool:
    path.write_bytes(data)
    (tool,) = read_tool_library(path).tools
    return tool


def test_a_bit_with_sizes_as_text_in_the_users_notation(tmp_path: Path) -> None:
    tool = only(tmp_path / "a.fctb", freecad_bit())
    assert tool.as_job_table() == {
        "name": "6 mm bull",
        "kind": "bull",
        "diameter_mm": 6.0,
        "corner_radius_mm": 0.5,
        "teeth": 3,
        "flute_length_mm": 20.0,
        "shank": {"diameter_mm": 6.0, "length_mm": 40.0},
    }
    assert tool.notes == ("helix angle: not stored in this format",)


@pytest.mark.parametrize(
    ("text", "mm"),
    [
        *(("0.25 in", 6.35), ('1/4"', 6.35), ('1 1/2"', 38.1), ("1-1/8 in", 28.575), ('0.375 "', 9.525), (3.0, 3.0)),
        *(("3,175 mm", 3.175), ("1.234,5 mm", 1234.5), ("1,234.5 mm", 1234.5), ("6,00\u00a0mm", 6.0), ("0.6 cm", 6.0)),
        *(("250 thou", 6.35), (".5", 0.5), ("5e-1 mm", 0.5), ("+3", 3.0)),
    ],
)
def test_lengths_as_libraries_write_them(text: str | float, mm: float) -> None:
    from twin.tool_library.quantities import length_mm

    assert length_mm(text, "mm") == pytest.approx(mm)


@pytest.mark.parametrize("text", ["", "mm", "1/0 in", "6 deg", "0x10", "1..2", "nan", "1e999", "1" * 90, "--1", [], {}])
def test_texts_that_are_not_lengths(text: object) -> None:
    from twin.tool_library.quantities import length_mm

    with pytest.raises(ValueError, match="a length"):
        length_mm(text, "mm")


@pytest.mark.parametrize(
    ("shape", "parameters", "expected"),
    [
        ("endmill.fcstd", {}, ("flat", 6.0, None, None)),
        ("ballend.fcstd", {}, ("ball", 6.0, 3.0, None)),
        ("bullnose.fcstd", {"CornerRadius": None, "FlatRadius": "2.0 mm"}, ("bull", 6.0, 1.0, None)),
        ("torus.fcstd", {"CornerRadius": None, "TorusRadius": "1.0 mm"}, ("bull", 6.0, 1.0, None)),
        ("taperedballnose.fcstd", {"TaperAngle": "10.0 °", "Diameter": "1 mm"}, ("taper", 1.0, 0.5, 5.0)),
        ("ballend.fcstd", {"TaperAngle": "5.0 °", "Diameter": "1 mm"}, ("taper", 1.0, 0.5, 5.0)),
        ("v-bit.fcstd", {"CuttingEdgeAngle": "60 deg", "TipDiameter": "0.2 mm"}, ("taper", 0.2, None, 30.0)),
    ],
)
def test_shapes_of_bits(tmp_path: Path, shape: str, parameters: dict[str, str], expected: tuple[object, ...]) -> None:
    tool = only(tmp_path / "a.fctb", freecad_bit(shape=shape, **parameters))
    assert (tool.kind, tool.diameter_mm, tool.corner_radius_mm, tool.taper_deg) == expected
    assert tool.simulated and not tool.warnings


def test_only_the_cone_of_a_v_bit_cuts(tmp_path: Path) -> None:
    sizes = {"CuttingEdgeAngle": "60 °", "Diameter": "10 mm", "TipDiameter": "0.1 mm", "CuttingEdgeHeight": "1 mm"}
    tool = only(tmp_path / "a.fctb", freecad_bit(shape="v-bit.fcstd", **sizes))
    assert tool.flute_length_mm == pytest.approx(4.95 / 0.57735, rel=1e-5)
    assert tool.shank == ToolCylinder(diameter_mm=6.0, length_mm=pytest.approx(60.0 - 8.5736, rel=1e-4))


def test_a_chamfer_mill_whose_angle_contradicts_its_sizes_is_not_used(tmp_path: Path) -> None:
    sizes = {"CuttingEdgeAngle": "20 °", "TipDiameter": "1 mm", "CuttingEdgeHeight": "6 mm"}
    tool = only(tmp_path / "a.fctb", freecad_bit(shape="chamfer.fcstd", **sizes))
    assert not tool.simulated
    assert "a cone from TipDiameter = 1 mm to Diameter = 6.0000 mm is 14.18 mm high" in tool.warnings[0]


def test_a_library_finds_its_bits_alongside_and_their_holders(tmp_path: Path) -> None:
    for folder in ("Library", "Bit", "ToolHolder"):
        (tmp_path / folder).mkdir()
    held = freecad_bit("held", "endmill.fcstd", ToolHolder="ER20", Stickout="30 mm")
    (tmp_path / "Bit" / "a.fctb").write_bytes(held)
    (tmp_path / "ToolHolder" / "ER20.fcholder").write_bytes(FREECAD_HOLDER)
    library = tmp_path / "Library" / "shop.fctl"
    library.write_bytes(freecad_library("a.fctb", "../../elsewhere/a.fctb", "gone.fctb"))
    first, same, gone = read_tool_library(library).tools
    assert (first.number, first.shank, first.holder_name) == (1, ToolCylinder(diameter_mm=6.0, length_mm=10.0), "nut")
    assert first.holder == (ToolCylinder(diameter_mm=30.0, length_mm=18.0),)
    assert (same.number, same.diameter_mm) == (2, 6.0)  # only the last part of a path counts
    assert (gone.number, gone.obstacle) == (3, "the file of the bit is not next to the library")


def test_a_library_without_any_of_its_bits_is_refused(tmp_path: Path) -> None:
    (tmp_path / "shop.fctl").write_bytes(freecad_library("a.fctb", "b.fctb"))
    with pytest.raises(ToolLibraryError, match=r"shop\.fctl: none of its 2 bits is there; expected them next to it"):
        read_tool_library(tmp_path / "shop.fctl")


def test_a_damaged_bit_is_named(tmp_path: Path) -> None:
    (tmp_path / "a.fctb").write_bytes(freecad_bit()[:60])
    (tmp_path / "shop.fctl").write_bytes(freecad_library("a.fctb"))
    with pytest.raises(ToolLibraryError, match=r"a\.fctb:1:\d+: not valid JSON"):
        read_tool_library(tmp_path / "shop.fctl")


def test_a_holder_on_its_own_is_listed(tmp_path: Path) -> None:
    tool = only(tmp_path / "nut.fcholder", FREECAD_HOLDER)
    assert (tool.kind, tool.name, sum(piece.length_mm for piece in tool.holder)) == ("holder", "nut", 18.0)


def test_a_tool_table_of_linuxcnc(tmp_path: Path) -> None:
    path = tmp_path / "tool.tbl"
    path.write_text(LINUXCNC)
    ball, face, drill = read_tool_library(path).tools
    assert ball.as_job_table() == {"number": 1, "name": "6 mm ball end mill", "kind": "ball", "diameter_mm": 6.0}
    assert ball.missing == ("teeth", "flute_length_mm")
    assert "unit: not stored, taken as mm" in ball.notes
    assert (face.kind, face.gauge_length_mm, ball.gauge_length_mm) == ("flat", 40.5, None)
    assert (drill.number, drill.kind, drill.simulated) == (7, "drill", False)
    assert read_tool_library(path, "inch").tools[0].diameter_mm == pytest.approx(152.4)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("T1 M6\nG0 X1\n", r'tool\.tbl:1: "M6": expected a word of T, P, D, Z'),
        ("T1 D1 D2\n", r"tool\.tbl:1: D is given twice"),
        ("T1 D1\nP2 D1\n", r"tool\.tbl:2: a row without T"),
    ],
)
def test_rows_that_are_not_of_a_tool_table(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "tool.tbl").write_text(text)
    with pytest.raises(ToolLibraryError, match=message):
        read_tool_library(tmp_path / "tool.tbl")


def test_a_table_of_camotics_and_the_same_in_a_project(tmp_path: Path) -> None:
    (tmp_path / "a.ctbl").write_bytes(CAMOTICS)
    (tmp_path / "a.camotics").write_bytes(b'{"units": "metric", "tools": ' + CAMOTICS + b', "files": ["a.nc"]}')
    flat, ball, point, snub = read_tool_library(tmp_path / "a.ctbl").tools
    assert (flat.kind, flat.diameter_mm, flat.flute_length_mm) == ("flat", pytest.approx(6.35), pytest.approx(12.7))
    assert (ball.kind, ball.number, ball.corner_radius_mm) == ("ball", 2, 2.0)
    assert (point.kind, point.simulated) == ("chamfer mill", False)
    assert (snub.kind, snub.diameter_mm, snub.taper_deg, snub.flute_length_mm) == ("taper", 1.0, pytest.approx(45), 5.0)
    assert read_tool_library(tmp_path / "a.camotics").tools == (flat, ball, point, snub)
