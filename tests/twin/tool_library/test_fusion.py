"""Libraries of Fusion 360: units, expressions, cones, shafts and holders, values that cannot be right."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from support.tool_libraries import fusion_library, fusion_tool, zipped

from twin.tool_library import LibraryTool, ToolCylinder, read_tool_library


def read(tmp_path: Path, *tools: dict[str, Any]) -> tuple[LibraryTool, ...]:
    path = tmp_path / "library.json"
    path.write_bytes(fusion_library(*tools))
    return read_tool_library(path).tools


def test_a_tool_with_neck_shank_and_holder_becomes_a_table_of_the_job(tmp_path: Path) -> None:
    (tool,) = read(tmp_path, fusion_tool())
    assert tool.as_job_table() == {
        "number": 3,
        "name": "6 mm ball",
        "kind": "ball",
        "diameter_mm": 6.0,
        "teeth": 2,
        "flute_length_mm": 18.0,
        "shank": {"diameter_mm": 5.8, "length_mm": 4.0},
        "holder": [
            {"diameter_mm": 6.0, "length_mm": 13.0},  # the shaft from the shoulder to the holder
            {"diameter_mm": 20.0, "length_mm": 4.0},
            {"diameter_mm": 32.0, "length_mm": 30.0},
        ],
    }
    assert (tool.helix_deg, tool.gauge_length_mm, tool.holder_name) == (None, 95.0, "collet chuck")
    assert tool.warnings == () and tool.notes == ("helix angle: not stored in this format",)


def test_a_left_hand_tool_is_noted(tmp_path: Path) -> None:
    (tool,) = read(tmp_path, fusion_tool(HAND=False))
    assert "left-hand tool: it cuts under M4" in tool.notes


def test_the_packed_library_has_the_same_tools(tmp_path: Path) -> None:
    path = tmp_path / "library.tools"
    path.write_bytes(zipped(fusion_library(fusion_tool())))
    assert read_tool_library(path).tools == read(tmp_path, fusion_tool())


def test_each_tool_has_its_unit_and_a_holder_its_own(tmp_path: Path) -> None:
    inch = fusion_tool(type="flat end mill", unit="inches", DC=0.25, RE=0, LCF=0.75, LB=1.5, OAL=2.5, SFDM=0.25)
    inch["geometry"] |= {"shoulder-length": 0.75}
    inch["holder"] = {"unit": "millimeters", "segments": [{"height": 10, "lower-diameter": 20, "upper-diameter": 20}]}
    inches, mm = read(tmp_path, inch, fusion_tool())
    assert (inches.diameter_mm, inches.flute_length_mm) == (pytest.approx(6.35), pytest.approx(19.05))
    assert inches.shank == ToolCylinder(diameter_mm=6.35, length_mm=19.05)
    assert inches.holder == (ToolCylinder(diameter_mm=20.0, length_mm=10.0),)
    assert mm.diameter_mm == 6.0


def test_a_plain_expression_replaces_the_stored_value_and_a_formula_does_not(tmp_path: Path) -> None:
    typed = {"tool_diameter": "1/4 in", "tool_number": "12", "tool_bodyLength": "tool_fluteLength + 17 mm"}
    (tool,) = read(tmp_path, fusion_tool(type="flat end mill", RE=0, SFDM=6.35, expressions=typed))
    assert (tool.number, tool.diameter_mm) == (12, pytest.approx(6.35))
    assert "DC = 6 mm: the expression tool_diameter = 1/4 in is used instead" in tool.notes
    assert sum(piece.length_mm for piece in (tool.shank, *tool.holder) if piece) == pytest.approx(35 - 18 + 34)


@pytest.mark.parametrize(("angle", "degrees"), [(5.0, 5.0), (0.0872665, 5.0), (1.0, 1.0)])
def test_radians_are_told_from_degrees_by_the_shaft(tmp_path: Path, angle: float, degrees: float) -> None:
    top = 1.0 + 2 * 15 * {5.0: 0.0875, 1.0: 0.01746}[degrees]
    cone = fusion_tool(type="tapered mill", DC=1.0, RE=0.5, TA=angle, LCF=15.0, shoulder_length=15.0)
    cone["geometry"] |= {"shoulder-diameter": top}
    (tool,) = read(tmp_path, cone)
    assert (tool.kind, tool.diameter_mm, tool.corner_radius_mm) == ("taper", 1.0, 0.5)
    assert tool.taper_deg == pytest.approx(degrees, rel=1e-3)
    assert any("radians" in note for note in tool.notes) == (angle != degrees)


def test_a_tapered_ball_stored_by_its_upper_diameter(tmp_path: Path) -> None:
    cone = fusion_tool(type="tapered mill", DC=6.0, RE=0.4, TA=10, LCF=18.0, **{"tapered-type": "tapered_ball"})
    (tool,) = read(tmp_path, cone)
    assert (tool.kind, tool.diameter_mm, tool.corner_radius_mm, tool.taper_deg) == ("taper", 0.8, 0.4, 10.0)
    # ball 0.4, then a cone of 10 deg up to radius 3
    assert tool.flute_length_mm == pytest.approx(0.4 * (1 - 0.173648) + (3 - 0.4 * 0.984808) / 0.176327, rel=1e-5)


@pytest.mark.parametrize(
    ("kind", "changes", "expected"),
    [
        ("flat end mill", {"RE": 0}, "flat"),
        ("flat end mill", {"RE": 0.5}, "bull"),
        ("bull nose end mill", {"RE": 1.0}, "bull"),
        ("face mill", {"RE": 0}, "flat"),
        ("face mill", {"RE": 0.8}, "bull"),
        ("face mill", {"RE": 0, "TA": 45.0}, "taper"),
        ("slot mill", {"RE": 0}, "flat"),
        ("tapered mill", {"RE": 0, "TA": 0}, "flat"),
    ],
)
def test_kinds_that_can_be_simulated(tmp_path: Path, kind: str, changes: dict[str, float], expected: str) -> None:
    (tool,) = read(tmp_path, fusion_tool(type=kind, **changes))
    assert (tool.kind, tool.obstacle) == (expected, "")


@pytest.mark.parametrize(
    "kind",
    [
        *("drill", "spot drill", "center drill", "tap right hand", "thread mill", "reamer", "counter sink", "probe"),
        *("lollipop mill", "dovetail mill", "radius mill", "form mill", "circle segment barrel", "turning general"),
        *("boring bar", "counter bore", "laser cutter", "waterjet", "chamfer mill", "holder", "something new"),
    ],
)
def test_kinds_that_cannot_are_listed_with_the_reason(tmp_path: Path, kind: str) -> None:
    (tool,) = read(tmp_path, fusion_tool(type=kind, RE=0))
    assert not tool.simulated and tool.obstacle


def test_a_chamfer_mill_with_a_flat_tip_is_a_cone(tmp_path: Path) -> None:
    chamfer = fusion_tool(type="chamfer mill", DC=10.0, TA=45.0, LCF=18.0, SFDM=10.0)
    chamfer["geometry"]["tip-diameter"] = 2.0
    (tool,) = read(tmp_path, chamfer)
    assert (tool.kind, tool.diameter_mm, tool.taper_deg) == ("taper", 2.0, 45.0)
    assert tool.flute_length_mm == pytest.approx(4.0)


@pytest.mark.parametrize(
    ("changes", "warning"),
    [
        ({"SFDM": 25374.6}, "SFDM = 25374.6 mm: expected 0.001 to 500 mm"),
        ({"SFDM": 140.0}, "SFDM = 140 mm: expected a shank diameter up to 100 mm"),
        ({"LCF": 60.0, "shoulder_length": 60.0, "LB": 61.0}, "LCF = 60 mm: expected at most OAL = 57 mm"),
        ({"LB": 10.0}, "LB = 10 mm: expected at least LCF = 18 mm"),
        ({"shoulder_length": 5.0}, "shoulder-length = 5 mm: expected at least LCF = 18 mm"),
        ({"DC": -6.0}, "DC = -6 mm: expected above 0"),
        ({"DC": 0}, "DC = 0 mm: expected above 0"),
        ({"DC": 1e-9}, "DC = 1e-09 mm: expected 0.001 to 500 mm"),
        ({"DC": "six"}, 'DC = "six": expected a length, e.g. 6.35 mm'),
        ({"DC": True}, "DC = true: expected a length, e.g. 6.35 mm"),
        ({"RE": 9.0}, "RE = 9 mm: expected at most half of DC = 6 mm"),
        ({"RE": 2.0}, "RE = 2 mm: expected half of DC = 6 mm, the radius of a ball"),
        ({"NOF": 2.5}, "NOF = 2.5: expected a whole number"),
        ({"NOF": 4000}, "4000 teeth: expected 1 to 100"),
        ({"TA": 120.0}, "TA = 120 deg: expected an angle above 0 and below 90 degrees"),
    ],
)
def test_a_value_that_cannot_be_right_is_named_and_left_out(
    tmp_path: Path, changes: dict[str, Any], warning: str
) -> None:
    (tool,) = read(tmp_path, fusion_tool(**changes))
    assert warning in tool.warnings


def test_a_holder_without_a_length_below_it_is_left_out(tmp_path: Path) -> None:
    (tool,) = read(tmp_path, fusion_tool(LB=1.0))
    assert tool.holder == (ToolCylinder(diameter_mm=6.0, length_mm=35.0),)  # the shaft, up to the tool's end
    assert "holder: the length below the holder is not known; expected it" in tool.warnings
