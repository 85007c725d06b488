"""Tool tables, parameter files, settings: what they say, and the place of every mistake in them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gcode.errors import GcodeError
from gcode.settings import ALL_OFFSETS, NUMBERED_OFFSETS, Limits, MachineSettings, ToolOffset
from gcode.tables import read_parameters, read_settings, read_tool_table
from gcode.tables.settings_file import _FIELDS, _TOOL_FIELDS

Write = Callable[[str, str | bytes], Path]
MILLS = """\
T1 P2 Z0.511 D0.125 ;1/8 end mill

; only a comment
  d.0625 z+.1 p7 t2
\tT16\tP3 I95 J155 Q1;
T99999P123Z-1.5e1
"""


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def written(name: str, content: str | bytes) -> Path:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return written


def refused(read: Callable[[], object]) -> GcodeError:
    with pytest.raises(GcodeError) as caught:
        read()
    return caught.value


def test_a_table_in_mm(write: Write) -> None:
    assert read_tool_table(write("t.tbl", MILLS)) == {
        1: ToolOffset(length_mm=0.511, radius_mm=0.0625, pocket=2, comment="1/8 end mill"),
        2: ToolOffset(length_mm=0.1, radius_mm=0.03125, pocket=7),
        16: ToolOffset(pocket=3, orientation=1),
        99999: ToolOffset(length_mm=-15.0, pocket=123),
    }


def test_a_table_of_an_inch_machine_has_all_its_lengths_converted(write: Write) -> None:
    row = read_tool_table(write("t.tbl", "T5 X1 Y-2 Z3 D4\n"), "inch")[5]
    expected = (25.4, -50.8, 76.2, 50.8)
    assert (row.x_mm, row.y_mm, row.length_mm, row.radius_mm) == pytest.approx(expected, abs=1e-12)
    assert row.pocket is None


@pytest.mark.parametrize("content", ["", "\n\n", ";T1 Z1\n", "\ufeff", " \r\n"])
def test_tables_without_rows(write: Write, content: str) -> None:
    assert read_tool_table(write("t.tbl", content)) == {}


def test_text_that_is_no_utf8_is_latin_1(write: Write) -> None:
    assert read_tool_table(write("T.TBL", b"T1 P1 ;Fr\xe4ser\r\n"))[1].comment == "Fräser"


@pytest.mark.parametrize(
    ("content", "code", "line", "column"),
    [
        ("T1 P1\nT1 P2\n", "tool-table-duplicate", 2, 1),
        ("T1 Z1 Z2\n", "tool-table-duplicate", 1, 7),
        ("\n  P1 Z1\n", "tool-table-row", 2, 3),
        ("T1 K5\n", "tool-table-word", 1, 4),
        ("T1 Z\n", "tool-table-word", 1, 5),
        ("T1 Znan\n", "tool-table-word", 1, 5),
        ("T1 Z1e999\n", "tool-table-word", 1, 5),
        ("T1 Z1.2.3\n", "tool-table-word", 1, 8),
        ("T1 Zinf\n", "tool-table-word", 1, 5),
        ("T-1 Z1\n", "tool-table-number", 1, 1),
        ("T1.5 Z1\n", "tool-table-number", 1, 1),
        ("T1 P0.5\n", "tool-table-number", 1, 4),
        ("T1 P1 W0.5\n", "tool-table-axis", 1, 7),
        ("POC FMS LEN DIAM COMMENT\n1 1 0.5 0.1\n", "tool-table-format", 1, 1),
        ("\nTOOLNO POCKET LENGTH DIAMETER COMMENT\n", "tool-table-format", 2, 1),
        ("POCKET FMS ZOFFSET XOFFSET DIAMETER FRONTANGLE # LATHE\n", "tool-table-format", 1, 1),
        ("  1      1    +0.511    0.125  1/8 end mill\n", "tool-table-format", 1, 1),
        ("\0", "tool-table-word", 1, 1),
    ],
)
def test_mistakes_of_tool_tables(write: Write, content: str, code: str, line: int, column: int) -> None:
    path = write("t.tbl", content)
    error = refused(lambda: read_tool_table(path))
    assert (error.code, error.place.file, error.place.line, error.place.column) == (code, str(path), line, column)
    assert error.expected


def test_offsets_of_0_along_further_axes_are_none(write: Write) -> None:
    assert read_tool_table(write("t.tbl", "T1 P1 A0 B0.0 C0 U0 V0 W0\n")) == {1: ToolOffset(pocket=1)}


@pytest.mark.parametrize(
    ("name", "code"), [("t.txt", "file-kind"), ("t", "file-kind"), ("none.tbl", "unreadable-file")]
)
def test_files_that_are_no_tool_table(tmp_path: Path, name: str, code: str) -> None:
    assert refused(lambda: read_tool_table(tmp_path / name)).code == code


def test_a_folder_is_no_table(tmp_path: Path) -> None:
    (tmp_path / "t.tbl").mkdir()
    assert refused(lambda: read_tool_table(tmp_path / "t.tbl")).code == "unreadable-file"


lengths = st.floats(-1e3, 1e3).map(lambda x: round(x, 6))


@given(st.dictionaries(st.integers(0, 99_999), st.tuples(lengths, lengths, st.none() | st.integers(0, 500))), st.data())
def test_tables_read_back(
    tmp_path_factory: pytest.TempPathFactory,
    rows: dict[int, tuple[float, float, int | None]],
    data: st.DataObject,
) -> None:
    path = tmp_path_factory.mktemp("t") / "t.tbl"
    lines = []
    for number, (length, diameter, pocket) in rows.items():
        words = [f"T{number}", f"Z{length}", f"D{diameter}", *([] if pocket is None else [f"P{pocket}"])]
        lines.append(" ".join(data.draw(st.permutations(words))))
    path.write_text("\n".join(lines))
    assert read_tool_table(path) == {
        number: ToolOffset(length_mm=length, radius_mm=diameter / 2.0, pocket=pocket)
        for number, (length, diameter, pocket) in rows.items()
    }


@given(st.binary(max_size=60) | st.text("TPZDX0123456789.- ;\n[]=\"'{}", max_size=60).map(str.encode))
def test_any_bytes_are_read_or_refused(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    folder = tmp_path_factory.mktemp("t")
    for name, read in (("t.tbl", read_tool_table), ("t.toml", read_tool_table), ("p.var", read_parameters)):
        path = folder / name
        path.write_bytes(content)
        try:
            read(path)
        except GcodeError as error:
            lines = content.decode("utf-8-sig", "replace").count("\n") + 1
            assert 1 <= error.place.line <= lines
            assert error.expected


VAR = """\
5161\t1.0
5162\t2
5163\t-3e0
5183\t4.5

# a comment
5210 1
5211 0.25 ; another
5220\t2.000000
5221\t10.0
5223\t-20.0
5230\t30.0
5381 7
31 1.5
"""


def test_parameters_of_an_inch_machine(write: Write) -> None:
    found = read_parameters(write("p.var", VAR), "inch")
    assert found.home_mm == pytest.approx((25.4, 50.8, -76.2), abs=1e-12)
    assert found.reference_points_mm == {2: pytest.approx((0.0, 0.0, 4.5 * 25.4), abs=1e-12)}
    assert tuple(found.offsets) == NUMBERED_OFFSETS
    assert found.offsets["G54"] == pytest.approx((254.0, 0.0, -508.0), abs=1e-12)
    assert found.offsets["G59.3"] == pytest.approx((7 * 25.4, 0.0, 0.0), abs=1e-12)
    assert found.rotations_deg["G54"] == 30.0
    assert found.rotations_deg["G55"] == 0.0
    assert (found.wcs, found.g92_holds) == ("G55", True)
    assert found.g92_mm == pytest.approx((0.25 * 25.4, 0.0, 0.0), abs=1e-12)
    assert found.variables[5223] == -20.0
    assert found.variables[31] == 1.5


def test_an_empty_parameter_file_is_a_machine_at_zero(write: Write) -> None:
    found = read_parameters(write("p.var", ""))
    assert set(found.offsets.values()) == {(0.0, 0.0, 0.0)}
    assert (found.home_mm, found.wcs, found.g92_holds) == ((0.0, 0.0, 0.0), "G54", False)


def test_parameters_take_the_place_of_settings(write: Write) -> None:
    before = MachineSettings(variables={31: 0.0, 100: 5.0}, reference_points_mm={3: (1.0, 1.0, 1.0)}, tool=4)
    after = read_parameters(write("p.var", VAR)).applied_to(before)
    assert after.offsets["G54"] == (10.0, 0.0, -20.0)
    assert after.home_mm == (1.0, 2.0, -3.0)
    assert set(after.reference_points_mm) == {2, 3}
    assert (after.variables[31], after.variables[100], after.tool) == (1.5, 5.0, 4)


@pytest.mark.parametrize(
    ("content", "code", "line", "column"),
    [
        ("5161 1\n5161 2\n", "parameter-duplicate", 2, 1),
        ("5161\n", "parameter-line", 1, 5),
        ("  X1 2\n", "parameter-line", 1, 3),
        ("5161.5 2\n", "parameter-line", 1, 1),
        ("5161 nan\n", "parameter-line", 1, 6),
        ("5161 1e400\n", "parameter-line", 1, 6),
        ("5161 1 2\n", "parameter-line", 1, 8),
        ("\n0 1\n", "parameter-number", 2, 1),
        ("5602 1\n", "parameter-number", 1, 1),
        ("-1 1\n", "parameter-number", 1, 1),
        ("99999999999999999999 1\n", "parameter-number", 1, 1),
        ("31 1\n5220 0\n", "parameter-system", 2, 1),
        ("5220 1.5\n", "parameter-system", 1, 1),
    ],
)
def test_mistakes_of_parameter_files(write: Write, content: str, code: str, line: int, column: int) -> None:
    error = refused(lambda: read_parameters(write("p.var", content)))
    assert (error.code, error.place.line, error.place.column) == (code, line, column)


SETTINGS = """\
decimal_point = "increment"
home_mm = [0, 0, 250.5]
search_path = ["subs", "/nc"]
units = "inch"

[offsets]
G54 = [100, 50, -200]
"g54.1p7" = [1, 2, 3]
"G59.1" = [0, 0, 0]

[reference_points_mm]
2 = [1, 1, 1]

[tools.1]
length_mm = 120.5
diameter_mm = 10
radius_wear_mm = -0.01
pocket = 3
comment = "end mill"

[tools.20]
radius_mm = 2

[variables]
500 = 1.5

[limits]
blocks = 1000
"""


def test_settings(write: Write) -> None:
    path = write("m.toml", SETTINGS)
    assert read_settings(path) == MachineSettings(
        decimal_point="increment",
        home_mm=(0.0, 0.0, 250.5),
        search_path=(path.parent / "subs", Path("/nc")),
        units="inch",
        offsets={"G54": (100.0, 50.0, -200.0), "G54.1 P7": (1.0, 2.0, 3.0), "G59.1": (0.0, 0.0, 0.0)},
        reference_points_mm={2: (1.0, 1.0, 1.0)},
        tools={
            1: ToolOffset(length_mm=120.5, radius_mm=5.0, radius_wear_mm=-0.01, pocket=3, comment="end mill"),
            20: ToolOffset(radius_mm=2.0),
        },
        variables={500: 1.5},
        limits=Limits(blocks=1000),
    )


def test_empty_settings_are_the_default_ones(write: Write) -> None:
    assert read_settings(write("m.toml", "")) == MachineSettings()


def test_settings_can_give_every_field() -> None:
    assert set(_FIELDS) == {field.name for field in dataclasses.fields(MachineSettings)}
    assert set(_TOOL_FIELDS) == {field.name for field in dataclasses.fields(ToolOffset)}


def test_every_work_offset_can_be_given(write: Write) -> None:
    content = "".join(f'"{name}" = [0, 0, 0]\n' for name in ALL_OFFSETS)
    assert tuple(read_settings(write("m.toml", f"[offsets]\n{content}")).offsets) == ALL_OFFSETS


def test_a_table_of_tools_as_toml_is_in_mm_on_every_machine(write: Write) -> None:
    path = write("t.toml", "[tools.3]\nlength_mm = 10\n")
    assert read_tool_table(path, "inch") == read_tool_table(path) == {3: ToolOffset(length_mm=10.0)}


@pytest.mark.parametrize(
    ("content", "code", "line", "column"),
    [
        ("tool = 1\nhome = [0, 0, 0]\n", "settings-key", 2, 1),
        ("[offsets]\nG53 = [0, 0, 0]\n", "settings-key", 2, 1),
        ('[offsets]\n"G54.1 P301" = [0, 0, 0]\n', "settings-key", 2, 1),
        ('[offsets]\nG54 = [0, 0, 0]\n"g54" = [0, 0, 0]\n', "settings-key", 3, 1),
        ("[offsets]\nG54 = [0, 0]\n", "settings-value", 2, 7),
        ("[offsets]\nG54 = [0, 0, nan]\n", "settings-value", 2, 7),
        ("offsets = 5\n", "settings-value", 1, 11),
        ("tool = true\n", "settings-value", 1, 8),
        ("tool = -1\n", "settings-value", 1, 8),
        ("arc_tolerance_mm = -0.1\n", "settings-value", 1, 20),
        ("arc_tolerance_mm = inf\n", "settings-value", 1, 20),
        (f"arc_tolerance_mm = 1{'0' * 400}\n", "settings-value", 1, 20),
        (f"tool = {'9' * 5000}\n", "settings-syntax", 2, 1),
        ('units = "cm"\n', "settings-value", 1, 9),
        ("block_delete = 1\n", "settings-value", 1, 16),
        ('search_path = "subs"\n', "settings-value", 1, 15),
        ("[reference_points_mm]\n1 = [0, 0, 0]\n", "settings-key", 2, 1),
        ("[variables]\nx = 1\n", "settings-key", 2, 1),
        ("[limits]\nnesting = 0\n", "settings-value", 2, 11),
        ("[tools.1]\nlenght_mm = 5\n", "settings-key", 2, 1),
        ("[tools.1]\nradius_mm = 5\ndiameter_mm = 10\n", "settings-key", 3, 1),
        ("[tools.x]\n", "settings-key", 1, 2),
        ("[tools]\n1 = {length_mm = '5'}\n", "settings-value", 2, 1),
        ("tool = \n", "settings-syntax", 1, 8),
        ("tool = 1\ntool = 2\n", "settings-syntax", 2, 9),
        ("\n\n[offsets", "settings-syntax", 3, 1),
    ],
)
def test_mistakes_of_settings(write: Write, content: str, code: str, line: int, column: int) -> None:
    error = refused(lambda: read_settings(write("m.toml", content)))
    assert (error.code, error.place.line, error.place.column) == (code, line, column)
    assert error.expected


def test_a_misspelt_key_is_told_the_nearest_one(write: Write) -> None:
    assert refused(lambda: read_settings(write("m.toml", "[tools.1]\nlenght_mm = 5\n"))).expected == "perhaps length_mm"


def test_a_table_of_tools_holds_nothing_else(write: Write) -> None:
    assert refused(lambda: read_tool_table(write("t.toml", "tool = 1\n"))).code == "settings-key"
