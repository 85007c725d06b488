"""System variables of FANUC's custom macro B: modal information, positions, offsets, alarms and stops."""

from __future__ import annotations

import pytest

from gcode.events import Notice, ProgramStop
from gcode.settings import ToolOffset

TOOLS = {2: ToolOffset(length_mm=100.0, length_wear_mm=0.5, radius_mm=6.0, radius_wear_mm=-0.1)}


@pytest.mark.parametrize(
    ("before", "group", "code"),
    [
        ("G1 F5 X1.", 1, 1.0),
        ("G2 X2. R1. F5", 1, 2.0),
        ("G18", 2, 18.0),
        ("G91", 3, 91.0),
        ("G95", 5, 95.0),
        ("G20", 6, 20.0),
        ("G21", 6, 21.0),
        ("G43 H2", 8, 43.0),
        ("G44 H2", 8, 44.0),
        ("G81 Z-1. R1. F5", 9, 81.0),
        ("G80", 9, 80.0),
        ("G99", 10, 99.0),
        ("G51 P2000", 11, 51.0),
        ("G96 S100", 13, 96.0),
        ("G57", 14, 57.0),
        ("G68 X0 Y0 R30.", 16, 68.0),
        ("G16", 17, 16.0),
        ("G51.1 X0", 22, 51.1),
    ],
)
def test_modal_information_of_the_groups(before: str, group: int, code: float, value) -> None:
    """FANUC 30i user's manual, "System variables", modal information: #4001... hold the code of groups 01..."""
    assert value(f"G0 X1.\n{before}\n#100=#{4000 + group}", tools=TOOLS) == code


def test_modal_information_is_that_of_the_block_before(ends, value) -> None:
    """FANUC 30i user's manual: #4001 to #4130 read the modal information specified up to the preceding block."""
    assert value("G0 X1.\nG1 F5 #100=#4001") == 0.0
    assert value("G0 X1.\nG1 F5\n#100=#4001") == 1.0


@pytest.mark.parametrize(
    ("before", "index", "number"),
    [
        ("D7", 107, 7.0),
        ("F250", 109, 250.0),
        ("G20 F12.5", 109, 12.5),
        ("H3", 111, 3.0),
        ("N40 G0 X1.", 114, 40.0),
        ("S800", 119, 800.0),
        ("T5", 120, 5.0),
        ("G54.1 P7", 130, 7.0),
    ],
)
def test_modal_information_of_the_letters(before: str, index: int, number: float, value) -> None:
    """The same table: #4107 D, #4109 F, #4111 H, #4114 sequence number, #4119 S, #4120 T, #4130 P of G54.1."""
    assert value(f"G0 X0\n{before}\n#100=#{4000 + index}") == number


def test_the_program_number_is_4115(value) -> None:
    assert value("O1234\n#100=#4115\nM30") == 1234.0


POSITIONS = {"offsets": {"G54": (10.0, 20.0, 30.0)}, "tools": TOOLS, "start_mm": (0.0, 0.0, 500.0)}


@pytest.mark.parametrize(
    ("index", "position"),
    [
        (5001, 1.0),
        (5002, 2.0),
        (5003, 3.0),
        (5021, 11.0),
        (5022, 22.0),
        (5023, 133.5),
        (5041, 1.0),
        (5043, 103.5),
        (5083, 100.5),
    ],
)
def test_positions(index: int, position: float, value) -> None:
    """FANUC 30i user's manual, position information: #5001... is the block's end in workpiece coordinates without
    the tool offset, #5021... the machine position and #5041... the workpiece position with it, #5081... the offset."""
    assert value(f"G43 H2 G0 X1. Y2. Z3.\n#100=#{index}", **POSITIONS) == pytest.approx(position)


def test_positions_count_in_the_programs_unit(value) -> None:
    assert value("G20 G0 X2.5\n#100=#5001") == pytest.approx(2.5)
    assert value("G20 G0 X2.5\n#100=#5021") == pytest.approx(2.5)


OFFSETS = {
    "offsets": {"G54": (1.0, 2.0, 3.0), "G59": (4.0, 5.0, 6.0), "G54.1 P1": (7.0, 8.0, 9.0), "G54.1 P2": (70.0, 0, 0)},
    "external_offset_mm": (0.25, 0.0, 0.0),
}


@pytest.mark.parametrize(
    ("index", "number"),
    [(5201, 0.25), (5221, 1.0), (5223, 3.0), (5322, 5.0), (7001, 7.0), (7003, 9.0), (7021, 70.0), (14001, 7.0)],
)
def test_workpiece_offsets_are_read(index: int, number: float, value) -> None:
    """FANUC 30i user's manual, "System variables": #5201 external, #5221 G54 ... #5321 G59, #7001 G54.1 P1, #7021
    G54.1 P2, #14001 G54.1 P1."""
    assert value(f"#100=#{index}", **OFFSETS) == number


def test_workpiece_offsets_are_written(ends) -> None:
    """The same: they can be written, and hold for the next absolute motion; the external one acts on all."""
    text = "#5221=50.\nG54 G0 X1.\n#5201=0.5\nX1.\n#7001=80.\nG54.1 P1 X1."
    assert ends(text) == [(51, 0, 0), (51.5, 0, 0), (81.5, 0, 0)]


@pytest.mark.parametrize(
    ("index", "number"),
    [(2002, 0.5), (2202, 100.0), (10002, 0.5), (11002, 100.0), (12002, -0.1), (13002, 6.0)],
)
def test_tool_offsets_are_read(index: int, number: float, value) -> None:
    """FANUC 30i user's manual, tool compensation memory C: H wear #10001 (#2001), H geometry #11001 (#2201), D wear
    #12001, D geometry #13001."""
    assert value(f"#100=#{index}", tools=TOOLS) == number


def test_tool_offsets_are_written_in_the_programs_unit(ends) -> None:
    moved = ends("G20\n#11002=2.\n#10002=0.\nG21 G43 H2 G0 Z0\nG53 Z0", tools=TOOLS)
    assert moved[-1] == pytest.approx((0, 0, -50.8))


def test_3000_stops_the_program_with_an_alarm(refusal) -> None:
    """FANUC 30i user's manual, "System variables", #3000=1(TOOL NOT FOUND): alarm 3001 with the text is shown."""
    error = refusal("G0 X1.\n#3000=1(TOOL NOT FOUND)\nX2.")
    assert (error.code, error.place.line) == ("alarm", 2)
    assert error.problem == "the program raises alarm 3001: TOOL NOT FOUND"


def test_3000_in_an_if_then_stops_only_where_the_condition_holds(refusal, ends) -> None:
    assert ends("#1=1\nIF[#1 EQ 2]THEN #3000=5(BAD)\nG0 X1.") == [(1, 0, 0)]
    assert refusal("#1=2\nIF[#1 EQ 2]THEN #3000=5(BAD)\nG0 X1.").problem == "the program raises alarm 3005: BAD"


def test_3006_stops_with_a_message_and_goes_on(run) -> None:
    """FANUC 30i user's manual, #3006=1(MESSAGE): the program stops after the block before and shows the message."""
    stops = [e for e in run("G0 X1.\n#3006=1(TURN THE PART)\nX2.\nM30") if isinstance(e, ProgramStop)]
    assert [(s.message, s.end, s.optional) for s in stops] == [("TURN THE PART", False, False), ("", True, False)]


@pytest.mark.parametrize("index", [3003, 3004])
def test_block_and_feed_control_is_noticed(index: int, run) -> None:
    """#3003 (single block) and #3004 (feed hold, override, exact stop) act on the operator's panel alone."""
    notices = [e for e in run(f"#{index}=1\nM30") if isinstance(e, Notice)]
    assert [n.code for n in notices] == ["no-motion"]


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("#4001=1", "read-only-variable"),
        ("#5001=1.", "read-only-variable"),
        ("#0=1", "read-only-variable"),
        ("#100=#3011", "unknown-variable"),
        ("#100=#5061", "unknown-variable"),
        ("#100=#34", "unknown-variable"),
        ("#200=1", "read-only-variable"),
    ],
)
def test_variables_that_are_not_there_or_cannot_be_set(text: str, code: str, refusal) -> None:
    """FANUC alarms PS0114 (illegal variable number) and PS0116 (variable protected)."""
    assert refusal(text).code == code
