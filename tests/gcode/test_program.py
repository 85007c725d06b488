"""Tools, spindle, coolant, dwell, stops, percent signs, files; and `check`, which goes on after a refusal."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcode.dialects import dialect_named
from gcode.errors import GcodeError
from gcode.events import (
    Block,
    CoolantChange,
    Dwell,
    LinearMotion,
    Notice,
    ProgramStop,
    SpindleChange,
    ToolChange,
)
from gcode.flow.interpreter import check, interpret, interpret_file
from gcode.language.block_parser import MAX_LINE
from gcode.language.program import read_program
from gcode.settings import Limits, MachineSettings


def of(events: list, *kinds: type) -> list:
    return [event for event in events if isinstance(event, kinds)]


def test_a_tool_change_takes_the_selected_tool_and_stops_the_spindle(run) -> None:
    events = of(run("T2 M6 S1500 M3\nT5\nG0 X1\nM6\nT0 M6"), ToolChange, SpindleChange)
    told = [e.tool if isinstance(e, ToolChange) else (e.spindle_rpm, e.spindle_direction) for e in events]
    assert told == [2, (1500, 1), (1500, 0), 5, 0]


def test_a_tool_change_without_a_tool(refusal) -> None:
    assert str(refusal("G0 X1 M6")) == (
        "t.nc:1:7: M6 with no tool selected; expected a T word in this block or before it [missing-tool]"
    )


def test_the_tool_of_the_start_is_a_setting(motions) -> None:
    assert [m.state.tool for m in motions("X1\nT4 M6\nX2", tool=9)] == [9, 4]


def test_spindle_words(run) -> None:
    events = of(run("S100\nM3\nS200\nS200\nM4 S300\nM5\nM19"), SpindleChange)
    told = [(e.place.line, e.spindle_rpm, e.spindle_direction) for e in events]
    assert told == [(1, 100, 0), (2, 100, 1), (3, 200, 1), (5, 300, -1), (6, 300, 0), (7, 300, 0)]


def test_fanuc_starts_before_the_motion_and_stops_after_it(run, motions) -> None:
    kinds = [type(e) for e in run("M3 S1 M8 G0 X1\nX2 M5 M9\nX3 M0") if not isinstance(e, Block | Notice)]
    assert kinds == [
        *(SpindleChange, CoolantChange, LinearMotion),
        *(LinearMotion, SpindleChange, CoolantChange),
        *(LinearMotion, ProgramStop),
    ]
    assert [m.state.spindle_direction for m in motions("M3 S1\nX1 M5\nX2")] == [1, 0]
    assert [m.state.spindle_direction for m in motions("M3 S1\nG0 X1 M5\nX2", "linuxcnc")] == [0, 0]


def test_coolant(run) -> None:
    events = of(run("M8\nM7\nM9"), CoolantChange)
    assert [(e.mist, e.flood) for e in events] == [(False, True), (True, True), (False, False)]


def test_stops(run) -> None:
    events = of(run("M0\nM1\nM30\nM0"), ProgramStop)
    assert [(e.optional, e.end) for e in events] == [(False, False), (True, False), (False, True)]


@pytest.mark.parametrize("text", ["M2", "M30", "G0 X1 M30"])
def test_the_program_ends_at_its_end(text: str, run) -> None:
    events = run(text + "\nthis is never read")
    assert isinstance(events[-1], ProgramStop)
    assert events[-1].end


def test_a_text_that_just_stops_says_so(run) -> None:
    last = run("G0 X1\nX2")[-1]
    assert (last.code, last.text) == ("no-program-end", "the program ends without M2, M30 or %")
    assert last.place.line == 2
    assert len(run("")) == 1


@pytest.mark.parametrize(
    ("dialect", "text", "seconds"),
    [
        ("fanuc", "G4 P500", 0.5),
        ("fanuc", "G04 X1.5", 1.5),
        ("fanuc", "G20 G4 X2", 2.0),
        ("linuxcnc", "G4 P.25", 0.25),
        ("linuxcnc", "G4 P3", 3.0),
    ],
)
def test_dwell(dialect: str, text: str, seconds: float, run) -> None:
    (event,) = of(run(text, dialect), Dwell, LinearMotion)
    assert event.seconds == pytest.approx(seconds)


@pytest.mark.parametrize(
    ("dialect", "text", "message"),
    [
        ("fanuc", "G4", "t.nc:1:1: G4 without a time; expected P or X and a time [bad-dwell]"),
        ("fanuc", "G4 P1 X1", "t.nc:1:1: G4 with two times; expected P or X and a time [bad-dwell]"),
        ("fanuc", "G4 P1.5", "t.nc:1:4: P1.5 has a decimal point, but counts steps of 0.001 s; expected P without a "
         "point, or X and seconds [bad-dwell]"),
        ("fanuc", "G4 X-1", "t.nc:1:4: X-1 is negative; expected X of 0 or more [bad-value]"),
        ("linuxcnc", "G4", "t.nc:1:1: G4 without a time; expected P and a time [bad-dwell]"),
    ],
)  # fmt: skip
def test_dwell_refusals(dialect: str, text: str, message: str, refusal) -> None:
    assert str(refusal(text, dialect)) == message


def test_linuxcnc_dwells_and_moves_in_one_block(run) -> None:
    assert [type(e) for e in of(run("G0 X1 G4 P1", "linuxcnc"), Dwell, LinearMotion)] == [Dwell, LinearMotion]


def test_percent_signs_enclose_the_program(run) -> None:
    events = run("\n%\nG0 X1\n%\nG0 X2")
    assert len(of(events, LinearMotion)) == 1
    assert events[-1] == ProgramStop(place=events[-1].place, optional=False, end=True)
    assert len(of(run("G0 X1\n%\n"), LinearMotion)) == 1


def test_a_leader_before_the_first_percent_is_skipped_with_a_notice(run, refusal) -> None:
    text = "PART 1234 FOR MACHINE 5\n\n%\nO1\nG0 X1\nM30\n%"
    events = run(text)
    assert isinstance(events[0], Notice)
    assert (events[0].code, events[0].text) == ("leader", "lines 1 to 2, before the first %, are not executed")
    assert len(of(events, LinearMotion)) == 1
    assert refusal(text, "linuxcnc").place.line == 1


@pytest.mark.parametrize(
    "content",
    [
        b"%\n\r\rO1\n\r\rG0 X1\n\r\rM30\n\r\r%\n\r\r",
        b"\x02\x12%\r\nO1\r\nG0 X1\r\nM30\r\n%\x14\x03",
        b"%\n\x12O1\n\x13\x11G0 X1\nM30\n%",
        b"\x12\r\n\r\n%\r\nO1\r\n\r\nG0 X1\r\nM30\r\n%\x00\x00",
    ],
    ids=["line-ends-as-punched", "start-and-end-of-text", "line-stopped-and-started", "blank-lines"],
)
def test_what_a_serial_line_adds_to_a_program_is_skipped(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.nc").write_bytes(content)
    assert check(read_program(tmp_path / "a.nc")) == []
    blocks = of(interpret_file(tmp_path / "a.nc"), Block)
    assert [block.place.text for block in blocks if block.place.text] == ["O1", "G0 X1", "M30"]


def test_text_before_a_closing_percent_is_no_leader(run, refusal) -> None:
    assert len(of(run("G0 X1\nX2\n%\nrest"), LinearMotion)) == 2
    assert refusal("FOO BAR\nX2\n%\n").code == "missing-number"
    assert refusal("FOO BAR\n%\n\n").code == "missing-number"


def test_block_delete_switch(run) -> None:
    text = "G0 X1\n/X2\n/2 N3 X3"
    assert len(of(run(text), LinearMotion)) == 3
    events = run(text, block_delete=True)
    assert len(of(events, LinearMotion)) == 1
    assert [(n.place.line, n.code) for n in of(events, Notice)][:2] == [(2, "block-deleted"), (3, "block-deleted")]


def test_neutral_codes_change_nothing_and_say_nothing(run) -> None:
    events = run("G17 G21 G40 G49 G80 G90 G94 G50 G69 G15 G98 G97\nG40.\nM30")
    assert [type(e) for e in events] == [Block, Block, Block, ProgramStop]


def test_codes_without_motion_take_their_words(run) -> None:
    assert [n.place.column for n in of(run("G61\nG0 G5.1 Q1\nG64 M48\nM30"), Notice)] == [1, 4, 1, 5]
    assert len(of(run("G64 P0.1 Q.05\nM2", "linuxcnc"), Notice)) == 1


def test_events_come_as_blocks_are_run() -> None:
    stream = interpret("G91 G1 F1\nX1\nM99", settings=MachineSettings(limits=Limits(blocks=50)))
    assert isinstance(next(stream), Block)
    endless = interpret("N1 G91 G1 F1\nX1\nGOTO 1", settings=MachineSettings(limits=Limits(blocks=3000)))
    for _ in range(2000):
        next(endless)
    with pytest.raises(GcodeError, match="more than 3000 blocks were executed"):
        list(endless)


@pytest.mark.parametrize("loop", ["N1 GOTO 1", "WHILE[1EQ1]DO1\nG91 G0 X1\nEND1"])
def test_a_loop_without_an_end_is_found_by_its_jumps(loop: str) -> None:
    settings = MachineSettings(limits=Limits(jumps=100))
    with pytest.raises(GcodeError, match="more than 100 jumps back were made; expected a program that ends") as caught:
        list(interpret(loop, settings=settings))
    assert caught.value.code == "runaway"
    assert [error.code for error in check(loop, settings=settings)] == ["runaway"]


def test_check_tells_every_mistake_once() -> None:
    text = "G1 X1\nX2\nG0 X5\nG3 F1 X20 I1\nX7 Y8 (\nG2 X30 I5 J0\nM6\nA1 G777 X2\nM30\nG999"
    told = [(e.place.line, e.place.column, e.code) for e in check(text)]
    assert told == [
        (1, 1, "missing-feed"),
        (4, 11, "arc-radius"),
        (5, 7, "unclosed-comment"),
        (7, 1, "missing-tool"),
        (8, 4, "unknown-code"),
    ]
    assert check("G0 X1\nM30") == []


def test_a_file_is_read_line_by_line(tmp_path: Path) -> None:
    path = tmp_path / "a.nc"
    path.write_bytes(b"\xef\xbb\xbf%\r\nG0 X1 (Fr\xe4ser)\r\r\nX2 (Fr\xc3\xa4ser)\nM30")
    events = list(interpret_file(path))
    assert [e.place.text for e in of(events, Block)] == ["G0 X1 (Fräser)", "X2 (Fräser)", "M30"]
    assert events[0].place.file == str(path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"G0 X1\nG0 \x00X1", ":2:4: NUL (0x00) in the line; expected printable text [control-character]"),
        (b"G0\rX1", ":1:3: carriage return (0x0d) in the line; expected printable text [control-character]"),
        (b"G0 \xff", ":1:4: unexpected 'ÿ'; expected a letter and its number, or a comment [unexpected-character]"),
        (b"X" * 50_000, f":1:1: the line is too long; expected at most {MAX_LINE} characters [line-too-long]"),
    ],
)
def test_bytes_that_are_no_program(content: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.nc"
    path.write_bytes(content + b"\nG0 Q5\n")
    errors = check(read_program(path), file=str(path))
    assert str(errors[0]) == str(path) + message
    assert errors[1].place.line == content.count(b"\n") + 2


def test_a_long_line_is_never_held(tmp_path: Path) -> None:
    path = tmp_path / "long.nc"
    path.write_bytes(b"(" + b"x" * 3_000_000 + b")\nM2\n")
    lines = list(read_program(path))
    assert len(lines) == 2
    assert len(lines[0]) < 5 * MAX_LINE


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    path = tmp_path / "none.nc"
    with pytest.raises(GcodeError) as caught:
        list(interpret_file(path))
    assert str(caught.value) == (
        f"{path}: cannot be read: no such file or directory; expected an NC program [unreadable-file]"
    )


def test_a_dialect_by_name() -> None:
    assert dialect_named("fanuc").name == "fanuc"
    with pytest.raises(ValueError, match=r"unknown dialect 'heller'; expected one of fanuc, haas, linuxcnc, grbl"):
        dialect_named("heller")
