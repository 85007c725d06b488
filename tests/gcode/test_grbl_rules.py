"""GRBL's own rules, each with the line of gcode.c or protocol.c that makes it."""

from __future__ import annotations

import pytest

from gcode.events import CoolantChange, Notice, ToolChange
from gcode.flow.interpreter import check


def codes(text: str, dialect: str = "grbl") -> list[str]:
    return [error.code for error in check(text, dialect=dialect)]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        # centre format: error 33 where delta_r > 0.005 and (delta_r > 0.5 or delta_r > 0.001 r of the start)
        ("G2 X10.004 I5 F100", []),
        ("G2 X10.006 I5 F100", ["arc-radius"]),
        ("G2 X5 Y5.004 I5 F100", []),
        ("G2 X5 Y5.006 I5 F100", ["arc-radius"]),
        ("G2 X300 Y300.29 I300 F100", []),
        ("G2 X300 Y300.31 I300 F100", ["arc-radius"]),
        ("G2 X900 Y900.49 I900 F100", []),
        ("G2 X900 Y900.51 I900 F100", ["arc-radius"]),
        ("G20 G2 X1 Y1.0001 I1 F10", []),
        ("G20 G2 X1 Y1.0011 I1 F10", ["arc-radius"]),
        # radius format: error 34 where 4 r^2 < chord^2
        ("G2 X10 R5 F100", []),
        ("G2 X10 R4.9999 F100", ["arc-radius-too-small"]),
        ("G0 X0.1\nG2 X10.1 R5 F100", []),
        # the third centre word is cleared unread; without one of the plane it is error 35
        ("G0 X10\nG3 X0 Y10 I-10 J0 K0 F100", []),
        ("G2 X10 K5 F100", ["arc-plane"]),
        # error 26 and 27: no axis words, none in the plane
        ("G2 I5 F100", ["missing-axis"]),
        ("G2 X0 I5 F100", []),
        ("G2 Z1 I5 F100", ["missing-axis"]),
        # axis words after G80 are error 31; G49 is an axis command, so G0 in its block is error 24
        ("G1 X1 F100\nG80\nX2", ["axis-without-motion"]),
        ("G49 G0 X1", ["axis-conflict"]),
        ("G17 G21 G40 G49 G80 G90", []),
        ("G43.1 Z1 G92 X0", ["axis-conflict"]),
        # M7, M8 and M9 are one modal group
        ("M7 M8", ["group-conflict"]),
        ("T256", ["bad-value"]),
        ("N10000001 G0 X1", ["bad-value"]),
        ("G10 L2 P1", ["missing-axis"]),
        ("G92", ["missing-axis"]),
        # 79 characters without blanks and comments
        (f"G1 X{'1' * 70} F1".replace("1" * 70, "1." + "0" * 68), []),
        ("G1 X1." + "0" * 75 + " F1", ["line-too-long"]),
        ("G1 X1. F1 (" + "a" * 80 + ")", []),
        ("G1 " + " " * 80 + "X1. F1 ; " + "b" * 80, []),
    ],
)
def test_what_stops_the_controller(text: str, found: list[str]) -> None:
    assert codes(f"{text}\nM2") == found


def test_the_message_states_the_rule() -> None:
    (error,) = check("G2 X5 Y5.006 I5 F100\nM2", dialect="grbl")
    assert error.expected == "radii within 0.005 mm, or 0.1 % of the radius at the start up to 0.5 mm, of each other"
    (error,) = check("G2 X5 Y5.06 I5 F100\nM2", dialect="linuxcnc")
    assert error.expected == "radii within 0.0282843 mm, or 0.1 % of the radius up to 2.82843 mm, of each other"


def test_feeds_are_in_the_units_of_their_block(motions) -> None:
    assert [m.feed_mm_min for m in motions("G20 G1 X1 F10\nM2", "grbl")] == [254.0]
    assert [m.feed_mm_min for m in motions("G20 G1 X1 F10\nM2", "linuxcnc")] == [10.0]


def test_machine_coordinates_whatever_the_distance_mode(motions) -> None:
    moved = motions("G0 X10 Y10 Z-5\nG91\nG53 G0 Z-1\nX1\nM2", "grbl")
    assert [m.end_mm for m in moved[1:]] == [(10.0, 10.0, -1.0), (11.0, 10.0, -1.0)]


def test_a_tool_word_puts_the_tool_in(run) -> None:
    events = run("T1\nG0 X1\nT1\nT2\nG0 X2\nM2", "grbl")
    assert [event.tool for event in events if isinstance(event, ToolChange)] == [1, 2]
    assert codes("T1 M6") == ["unsupported-code"]
    assert [e.tool for e in run("T3 M6\nM2", "grbl", m_codes={6: "none"}) if isinstance(e, ToolChange)] == [3]


@pytest.mark.parametrize(
    ("text", "code"),
    [("O1\nG0 X1\nM2", "control-text"), ("%\nG0 X1\nM2", "control-text"), ("M7\nM2", "build-option")],
)
def test_what_only_some_controllers_or_senders_take_is_a_warning(text: str, code: str, run) -> None:
    notices = [event for event in run(text, "grbl") if isinstance(event, Notice)]
    assert [(notice.code, notice.is_warning) for notice in notices] == [(code, True)]


def test_coolant(run) -> None:
    events = [event for event in run("M7\nM8\nM9\nM2", "grbl") if isinstance(event, CoolantChange)]
    assert [(event.mist, event.flood) for event in events] == [(True, False), (True, True), (False, False)]
