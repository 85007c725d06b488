"""Runs of plain lines: the same to the last bit as the lines run one by one, and nothing taken that is not plain."""

from __future__ import annotations

import struct
from functools import partial
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from support.nc_lines import ARC_WORDS, plain_lines

from gcode.bulk.plain_batch import PlainBatch, expand
from gcode.bulk.plain_rules import PlainRules, PlainStart
from gcode.bulk.plain_runs import LEAST_LINES, PlainRun, plain_run
from gcode.bulk.plain_words import plain_end
from gcode.dialects import dialect_named
from gcode.dialects.dialect import ArcTolerance
from gcode.errors import Call, GcodeError
from gcode.events import ArcMotion, Block, Event, LinearMotion, MotionState, ProgramStop
from gcode.flow.interpreter import interpret, run
from gcode.flow.runner import Runner
from gcode.language.program import program_of
from gcode.settings import Limits, MachineSettings


def start_at(**changes: Any) -> PlainStart:
    values: dict[str, Any] = {
        "position_mm": (1.0, 2.0, 3.0),
        "zero_mm": (0.0, 0.0, 0.0),
        "unit_mm": 1.0,
        "absolute": True,
        "code": 1,
        "feed_mm_min": 100.0,
        "line": 7,
        "arc_tolerance": ArcTolerance(absolute_mm=0.01),
    }
    return PlainStart(**(values | changes))


#: Rules that most of these tests are for.
RULES: dict[str, Any] = {"m_codes": frozenset({3, 4, 5, 7, 8, 9}), "after_motion": frozenset({5, 9})}


def taken(text: str, **options: Any) -> PlainRun | None:
    start, rules = start_at(**options.pop("start", {})), PlainRules(**(RULES | options.pop("rules", {})))
    return plain_run(text.encode(), 0, start, rules, **({"least_lines": 1} | options))[0]


def one_by_one(text: str, dialect: str, given_settings: MachineSettings) -> tuple[list[Event], str]:
    """Events of a program run line by line, and what it was refused for."""

    def refuse(error: GcodeError) -> None:
        raise error

    events: list[Event] = []
    try:
        for event in Runner(program_of(text, "t.nc"), dialect_named(dialect), given_settings, refuse, bulk=False).run():
            assert not isinstance(event, PlainBatch)
            events.append(event)
    except GcodeError as error:
        return events, str(error)
    return events, ""


def in_runs(text: str, dialect: str, given_settings: MachineSettings) -> tuple[list[Event], str]:
    """The same with plain lines taken at once, however few they are."""
    events: list[Event] = []
    with patch("gcode.flow.runner.plain_run", partial(plain_run, least_lines=1)):
        try:
            for event in interpret(text, file="t.nc", dialect=dialect_named(dialect), settings=given_settings):
                events.append(event)  # noqa: PERF402 the events before a refusal count
        except GcodeError as error:
            return events, str(error)
    return events, ""


def bits(events: list[Event]) -> bytes:
    """Coordinates and feeds of motions, where 0 and -0 differ."""
    motions = [event for event in events if isinstance(event, LinearMotion | ArcMotion)]
    centres = [event.centre_mm for event in motions if isinstance(event, ArcMotion)]
    straight = [struct.pack("7d", *m.start_mm, *m.end_mm, m.feed_mm_min) for m in motions]
    return b"".join([*straight, *(struct.pack("3d", *centre) for centre in centres)])


OTHER_LINES = st.sampled_from(
    """G90 | G91 | G20 | G21 | G2 X1 Y1 R5 | (X1) | G4 P100 | G55 | G53 G0 X1 | X1;Y2 | M29 S100 | G43 H1 | G43 H1 Z5
    | (abort,x) | (a)(b) | X1(\u00e9) | (c | X1)( | X5 ; Y2 | X1 ; | ;abort, | ;a(b | M6 | M3 M8 | S1000 M5 X3
    | G1 | G1 F9 | M3 S5 G1 X2 M9 | N99999999 X1 | S5.5 | M30X1
    | G68 X0 Y0 R30 | G69 | G92 X3 | G81 Z-1 R1 F100 | G80 | G93 | G94 | G95 | S100 M3 | G41 D1 | G40 | T2 M6 | /X5
    | M99 | X1,R2 | G10 L3 P1 | G10 L50 | G11 | G7 | G16 | G96 S50 | A5 | G5 X1 Y1 I1 J1 P1 Q1 | G84 Z-1 R1 F1
    """.replace("\n", "").split("|")
).map(lambda line: line.strip() + "\n")


LIMITS = Limits(blocks=50)


@settings(max_examples=150, deadline=None)
@given(
    st.lists(st.one_of(*[plain_lines()] * 9, OTHER_LINES), max_size=60),
    st.sampled_from(["fanuc", "haas", "linuxcnc", "grbl"]),
    st.booleans(),
)
@example(["G1 X1 F0\n"] + ["Y2\n"] * 6, "fanuc", True)
@example(["G91\n", "G1 F1 X-0. Z-0\n"] + ["X0Z-0\n"] * 6, "linuxcnc", False)
def test_runs_are_the_lines_one_by_one(lines: list[str], dialect: str, moved: bool) -> None:
    given_settings = MachineSettings(start_mm=(1.1, -2.2, 3.3), limits=LIMITS)
    if moved:
        given_settings = MachineSettings(
            offsets={"G54": (0.1, -0.7, 12.3), "G55": (5.0, 0.3, -1.1)}, start_mm=(0.3, 0.0, -0.0), limits=LIMITS
        )
    text = "".join([*lines, "M30\n"])
    slow, fast = one_by_one(text, dialect, given_settings), in_runs(text, dialect, given_settings)
    assert fast == slow
    assert bits(fast[0]) == bits(slow[0])


@settings(max_examples=150, deadline=None)
@given(
    st.lists(st.one_of(*[ARC_WORDS] * 5, plain_lines()), max_size=50),
    st.sampled_from(["fanuc", "haas", "linuxcnc", "grbl"]),
    st.sampled_from([{}, {"arc_tolerance_mm": 0.0}, {"arc_centres": "absolute"}, {"decimal_point": "increment"}]),
)
def test_arcs_in_runs_are_the_arcs_one_by_one(lines: list[str], dialect: str, changes: dict[str, Any]) -> None:
    given_settings = MachineSettings(start_mm=(0.1, -0.2, 3.3), limits=LIMITS, **changes)
    text = "".join(["G91 G1 F90\n", *lines, "M30\n"])
    slow, fast = one_by_one(text, dialect, given_settings), in_runs(text, dialect, given_settings)
    assert fast == slow
    assert bits(fast[0]) == bits(slow[0])


@settings(max_examples=60, deadline=None)
@given(st.lists(plain_lines(), min_size=1, max_size=40), st.integers(1, 9), st.booleans(), st.sampled_from([1.0, 25.4]))
def test_a_run_does_not_depend_on_how_it_is_cut(lines: list[str], most: int, absolute: bool, unit: float) -> None:
    text = "".join(lines).encode()
    first = start_at(absolute=absolute, unit_mm=unit, zero_mm=(0.1, 0.2, 0.3))
    rules = PlainRules(**RULES)
    whole, _ = plain_run(text, 0, first, rules, least_lines=1)
    parts: list[PlainRun] = []
    start, offset = first, 0
    while (part := plain_run(text, offset, start, rules, max_lines=most, least_lines=1)[0]) is not None:
        assert part.begin == offset
        assert 1 <= part.lines <= most
        parts.append(part)
        offset = part.offset
        start = part.after
    if whole is None:
        assert not parts
        return
    assert (offset, start) == (whole.offset, whole.after)
    for name in ("block", "line", "end_mm", "code", "feed_mm_min", "centre_mm", "spindle_rpm", "spindle_direction"):
        joined = np.concatenate([getattr(part, name) for part in parts])
        assert joined.tobytes() == getattr(whole, name).tobytes()


@pytest.mark.parametrize(
    "line",
    [
        *("X", "X.", "X-", "X1.2.3", "X1 2", "X--1", "X1e3", "X1\0", "X1\r\r", "X\r1", "X\u0661", "\u00e9"),
        *("G4", "G10", "G1.1", "G1 0", "G1.", "G001", "G00.", "F-1", "S-1", "X1N2", "N1N2", "N1.", "N-1", "A1", "M30"),
        *("M6", "M0", "M003", "M3.", "P1", "O1", "%", "(abort,x)", "X1( ABORT,)", "X1(", "X1)", "(a(b))", "(\u00e9)"),
        *("/X1", "X1;X2", "X#1", "X[1]", "X1,R2", "X1234567890", "N1234567890", "X1" + " " * 10, f"({201 * 'c'})"),
        "X1." + "0" * 31,
    ],
)
def test_lines_that_are_not_plain(line: str) -> None:
    text = f"X1\n{line}\nX2\n".encode()
    assert plain_end(text, 0, 9) == 3
    assert plain_run(text, 3, start_at(), PlainRules(), least_lines=1) == (None, 0)


def test_words_take_effect_in_their_block_and_hold_on() -> None:
    run = taken("X5\nG0Y6\n\nN1\nF50\nG1Z7\nN30\n")
    assert run is not None
    assert run.line.tolist() == [7, 8, 12]
    assert run.end_mm.tolist() == [[5, 2, 3], [5, 6, 3], [5, 6, 7]]
    assert run.code.tolist() == [1, 0, 1]
    assert run.feed_mm_min.tolist() == [100, 0, 50]
    after = run.after
    assert (after.position_mm, after.code, after.feed_mm_min, after.line, run.label_after) == ((5, 6, 7), 1, 50, 14, 30)
    assert run.block.tolist() == [7, 8, 10, 11, 12, 13]
    assert (run.begin, run.offset, run.lines) == (0, 25, 7)


def test_absolute_coordinates_are_the_zero_and_the_words() -> None:
    run = taken("X1Y-2\nZ.5F2\n", start={"zero_mm": (10.0, 20.0, 30.0), "unit_mm": 25.4})
    assert run is not None
    assert run.end_mm.tolist() == [[10 + 25.4, 20 - 2 * 25.4, 3], [10 + 25.4, 20 - 2 * 25.4, 30 + 0.5 * 25.4]]
    assert run.feed_mm_min.tolist() == [100, 2 * 25.4]


def test_increments_add_up_from_where_the_tool_is() -> None:
    run = taken("X1\nX1Y-2\nZ.5\nX-3\n", start={"absolute": False, "zero_mm": (10.0, 20.0, 30.0)})
    assert run is not None
    assert run.end_mm.tolist() == [[2, 2, 3], [3, 0, 3], [3, 0, 3.5], [0, 0, 3.5]]


def test_a_motion_of_no_length_is_a_motion() -> None:
    run = taken("X1\nX1\nX1\n")
    assert run is not None
    assert run.line.tolist() == [7, 8, 9]


@pytest.mark.parametrize(
    ("text", "options", "lines"),
    [
        ("X1\nX2X3\nX4\n", {}, 1),
        ("X1\nG1X3G1\n", {}, 1),
        ("G0X1\nX2\nG1X3\n", {"start": {"feed_mm_min": 0.0}}, 2),
        ("G0X1\nF5\nG1X3\n", {"start": {"feed_mm_min": 0.0}}, 3),
        ("X1\nG1F50\nX3\n", {}, 3),
        ("X1\nF0X3\n", {}, 1),
        ("X1.\nX3\n", {"rules": {"increment": True}}, 1),
        ("X1.F3\nN5G0Y3.\n", {"rules": {"increment": True}}, 2),
        ("X1\nX2\nX3\n", {"max_lines": 2}, 2),
        ("X1\nX2", {}, 1),
    ],
)
def test_where_a_run_stops(text: str, options: dict[str, Any], lines: int) -> None:
    run = taken(text, **options)
    assert run is not None
    assert run.lines == lines
    assert text[: run.offset].count("\n") == lines
    assert text[run.offset - 1] == "\n"


@pytest.mark.parametrize("text", ["", "X1", "M6\nX1\n", "X1Y2X3\n", "(c\n"])
def test_no_run(text: str) -> None:
    assert taken(text) is None


def test_a_first_line_that_must_be_refused_is_left() -> None:
    assert taken("X1\n", start={"feed_mm_min": 0.0}) is None


def test_comments_alone_are_no_blocks() -> None:
    run = taken("(c)\n\n")
    assert run is not None
    assert run.block.size == 0


def test_lines_without_words_do_not_start_a_program() -> None:
    text = "(c)\n" * LEAST_LINES + "%\nO1 X1\nM30\n"
    assert next(event for event in run(text) if isinstance(event, ProgramStop)).place.line == LEAST_LINES + 3


def test_too_few_lines_are_left() -> None:
    assert taken("X1\n" * (LEAST_LINES - 1), least_lines=LEAST_LINES) is None
    assert taken("X1\n" * LEAST_LINES, least_lines=LEAST_LINES) is not None


@pytest.mark.parametrize(
    "text", [b" " * 3_000_000, b"X1" * 1_000_000, b"1" * 3_000_000, b"X" + b"." * 3_000_000, b"\r" * 1_000_000]
)
def test_long_lines_come_to_an_end(text: bytes) -> None:
    assert plain_run(text + b"\n", 0, start_at(), PlainRules(), least_lines=1)[0] is None
    assert plain_run(b"X1\n" + text, 0, start_at(), PlainRules(), least_lines=1)[0] is not None


def test_arcs_have_centres_and_turns() -> None:
    run = taken("G2X3I1\nG3X5Y4R2\nG1X6\n")
    assert run is not None
    assert run.code.tolist() == [2, 3, 1]
    assert run.centre_mm[:2].tolist() == [[2, 2, 3], [3, 4, 3]]
    assert np.isnan(run.centre_mm[2]).all()


@pytest.mark.parametrize(
    "arc",
    ["G2X2", "G2X2I1R1", "G2X2K1", "G2X2I.4", "G2I0", "G2R1", "G2X9R1", "G2X1.0000001I1", "G1X2I1", "G2X1I1R2F0", "G2"],
)
def test_arcs_that_are_left(arc: str) -> None:
    rules = PlainRules(explicit_code_moves=True)
    run, vain = plain_run(f"X1\n{arc}\nX3\n".encode(), 0, start_at(), rules, least_lines=1)
    assert run is not None
    assert (run.lines, vain) == (1, 2)


def test_spindle_and_coolant_change_before_or_after_the_motion() -> None:
    run = taken("S5X1M3\nS6X2\nS6M8\nX3M5\nX4M9\n")
    assert run is not None
    assert (run.spindle_rpm.tolist(), run.spindle_direction.tolist()) == ([5, 6, 6, 6], [1, 1, 1, 0])
    lines = zip(*(column.tolist() for column in run.changes), strict=True)
    assert list(lines) == [
        (7, False, False, 5, 1, False, False),
        (8, False, False, 6, 1, False, False),
        (9, False, True, 6, 1, False, True),
        (10, True, False, 6, 0, False, True),
        (11, True, True, 6, 0, False, False),
    ]
    after = run.after
    assert (after.spindle_rpm, after.spindle_direction, after.mist, after.flood) == (6, 0, False, False)


def test_m_codes_that_a_control_does_not_execute_are_left() -> None:
    run = taken("X1\nM7\nX3\n", rules={"m_codes": frozenset({3})})
    assert run is not None
    assert run.lines == 1


def test_arrays_are_read_only() -> None:
    run = taken("X1\n")
    assert run is not None
    for name in ("block", "line", "end_mm", "code", "feed_mm_min", "centre_mm", "spindle_rpm", "spindle_direction"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(run, name)[0] = 0


def test_expanded_events() -> None:
    program = program_of("M3\nG1 X1\r\n \r\nF5\r\nx2 \r\n", "t.nc")
    start = start_at(line=2)
    run, _ = plain_run(program.text, 3, start, PlainRules(), least_lines=1)
    assert run is not None
    state, calls = MotionState(tool=3), (Call(program="O1", file="m.nc", line=9),)
    extra = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    batch = PlainBatch(start=start, run=run, state=state, file="t.nc", program=program, calls=calls, extra=extra)
    events = list(expand(batch))
    assert [type(event) for event in events] == [Block, LinearMotion, Block, Block, LinearMotion]
    assert [(e.place.line, e.place.column, e.place.text) for e in events if isinstance(e, Block)] == [
        (2, 1, "G1 X1"),
        (4, 1, "F5"),
        (5, 1, "x2 "),
    ]
    first, last = (event for event in events if isinstance(event, LinearMotion))
    assert (first.start_mm, first.end_mm, first.feed_mm_min) == ((1, 2, 3), (1, 2, 3), 100)
    assert (last.start_mm, last.end_mm, last.feed_mm_min) == ((1, 2, 3), (2, 2, 3), 5)
    assert all((e.state, e.place.calls, e.extra) == (state, calls, extra) for e in (first, last))


def test_a_surface_program_is_taken_in_runs() -> None:
    lines = "".join(f"X{i * 0.1:.3f}Z{-i * 0.01:.4f}\n" for i in range(1000))
    text = f"%\nO1\nG21 G90\nG1 Z0 F500.\n{lines}M30\n%\n"
    batches = [event for event in run(text) if isinstance(event, PlainBatch)]
    assert sum(batch.run.lines for batch in batches) >= 1000
    assert len(batches) <= 2
