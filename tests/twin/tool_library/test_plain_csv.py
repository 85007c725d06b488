"""Tool lists as CSV: written and read back, typed by hand, and exported by Fusion 360."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.tool_libraries import FUSION_CSV

from twin.errors import ToolLibraryError
from twin.tool_library import LibraryTool, ToolCylinder, read_tool_library
from twin.tool_library.assemble import assemble
from twin.tool_library.formats.job_tables import table_tools
from twin.tool_library.formats.plain_csv import csv_text, csv_tools
from twin.tool_library.raw_tool import Frustum, RawTool, Size
from twin.tool_library.write import job_text

PATH = Path("tools.csv")


def read(text: str) -> list[LibraryTool]:
    return [*csv_tools(text, PATH, "mm")]


_LETTERS = "aZ09 ,;|\"'\n\t\x1b\u202e\ud800ßø=+#"
_LENGTH = st.floats(-1.0, 1100.0)
_FRUSTA = st.lists(st.builds(Frustum, lower_mm=_LENGTH, upper_mm=_LENGTH, length_mm=_LENGTH), max_size=3).map(tuple)
_KINDS = (
    *("flat", "ball", "bull", "taper", "face mill", "slot mill", "chamfer mill", "drill", "centre drill", "holder"),
    *("jet cutter", "circle segment mill", "turning tool", "radius mill", "slitting saw", "form mill", "tap", None),
)
RAW = st.builds(
    RawTool,
    source=st.just("x"),
    number=st.none() | st.integers(-3, 10**9),
    name=st.text(_LETTERS, max_size=12),
    kind=st.sampled_from(_KINDS),
    word=st.sampled_from(["Quux", "a, b; c"]),
    sizes=st.dictionaries(
        st.sampled_from(
            ["diameter", "corner", "flutes", "taper", "shank", "stickout", "shoulder", "tip", "helix", "top"]
        ),
        _LENGTH.map(lambda value: Size(value, "size")),
    ),
    teeth=st.none() | st.integers(0, 120),
    shaft=_FRUSTA,
    holder=_FRUSTA,
    holder_name=st.text(_LETTERS, max_size=5),
    notes=st.lists(st.text("ab ,;\"'", max_size=8), max_size=2).map(tuple),
)


@settings(max_examples=60)
@given(st.lists(RAW, min_size=1, max_size=3))
def test_tools_written_as_csv_are_read_back_equal(raw: list[RawTool]) -> None:
    tools = [assemble(tool) for tool in raw]
    assert read(csv_text(tools)) == tools


def test_a_list_typed_by_hand_with_semicolons_and_decimal_commas() -> None:
    (tool,) = read("T;Beschreibung;Type;Diameter;Corner radius;Z;Flute length;Shank\n4;x;Bull nose;12,5;1,5;4;26;12x50")
    assert (tool.number, tool.kind, tool.diameter_mm, tool.corner_radius_mm) == (4, "bull", 12.5, 1.5)
    assert (tool.teeth, tool.flute_length_mm, tool.shank) == (4, 26.0, ToolCylinder(diameter_mm=12.0, length_mm=50.0))


def test_units_of_a_heading_of_a_row_and_of_a_value() -> None:
    rows = "number\tdiameter_in\tflute length\tunit\n1\t0.25\t20\tmm\n2\t1/8\t0.5\tinch\n3\t3 mm\t20\t\n"
    tools = read(rows)
    assert [tool.diameter_mm for tool in tools] == [pytest.approx(6.35), pytest.approx(3.175), 3.0]
    assert [tool.flute_length_mm for tool in tools] == [20.0, pytest.approx(12.7), 20.0]
    assert [tool.notes for tool in tools] == [("kind: not in the list, taken as flat",)] * 3


def test_a_list_exported_by_fusion_has_each_tool_once_for_all_its_presets() -> None:
    (tool,) = read(FUSION_CSV)
    assert (tool.number, tool.name, tool.kind, tool.diameter_mm, tool.teeth) == (7, "2 mm ball", "ball", 2.0, 2)
    assert tool.shank == ToolCylinder(diameter_mm=4.0, length_mm=14.0)
    assert tool.holder == (ToolCylinder(diameter_mm=9.0, length_mm=5.0),)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a,b,c\n1,2,3\n", "tools.csv: is not a tool library: no row of headings with a diameter"),
        ("number,name\n1,x\n", "no row of headings with a diameter"),
        ("number,diameter\n1,2,3\n", "tools.csv:2: 3 cells in a table of 2 columns; expected quotes around text"),
        ('number,diameter\n1,"' + "9" * 200_000, "tools.csv:2: not CSV: field larger than field limit"),
    ],
)
def test_a_file_that_is_not_a_list_of_tools_is_refused(text: str, message: str) -> None:
    with pytest.raises(ToolLibraryError) as caught:
        read(text)
    assert message in str(caught.value)


def test_wrong_cells_are_named() -> None:
    (tool,) = read("number,diameter_mm,teeth,shank,holder_segments\n1,ten,x,12x,H1 U2\n")
    assert tool.obstacle == "the library has no usable diameter"
    assert sorted(tool.warnings) == [
        'diameter_mm = "ten": expected a length, e.g. 6.35 mm',
        'segment "H1 U2": expected H, U and L, e.g. H4 U6 L3',
        'shank = "12x": expected diameter x length, e.g. 20 x 30',
        'teeth = "x": expected a whole number',
    ]


def test_a_file_in_windows_encoding_is_read(tmp_path: Path) -> None:
    path = tmp_path / "werkzeuge.csv"
    path.write_bytes("number,name,diameter_mm\n1,Fräser,8\n".encode("cp1252"))
    assert read_tool_library(path).tools[0].name == "Fräser"


@settings(max_examples=30)
@given(st.lists(RAW, min_size=1, max_size=3))
def test_tables_written_for_a_job_are_read_back_equal(raw: list[RawTool]) -> None:
    tools = [assemble(tool) for tool in raw]
    again = [*table_tools(job_text(tools, "tools"), PATH)]
    assert [tool.as_job_table() for tool in again] == [tool.as_job_table() for tool in tools if tool.simulated]
