"""Canned cycles of FANUC mills in whole programs: strokes, levels, repeats and what the spindle does.

The rules are those of FANUC 30i user's manual, "Canned cycle for drilling". The retraction of G73 and the clearance
of G83 (parameters 5114 and 5115) are 1 mm.
"""

from __future__ import annotations

import pytest

from gcode.events import Dwell, LinearMotion, ProgramStop, SpindleChange
from gcode.settings import ToolOffset

STROKES = {
    "G81": ["R 5 0 2", "F 5 0 -8"],
    "G82 P250": ["R 5 0 2", "F 5 0 -8"],
    "G73 Q4.": ["R 5 0 2", "F 5 0 -2", "R 5 0 -1", "F 5 0 -6", "R 5 0 -5", "F 5 0 -8"],
    "G83 Q4.": ["R 5 0 2", "F 5 0 -2", "R 5 0 2", "R 5 0 -1", "F 5 0 -6", "R 5 0 2", "R 5 0 -5", "F 5 0 -8"],
    "G84": ["R 5 0 2", "F 5 0 -8", "F 5 0 2"],
    "G74": ["R 5 0 2", "F 5 0 -8", "F 5 0 2"],
    "G85": ["R 5 0 2", "F 5 0 -8", "F 5 0 2"],
    "G86": ["R 5 0 2", "F 5 0 -8"],
    "G88": ["R 5 0 2", "F 5 0 -8", "R 5 0 2"],
    "G89 P250": ["R 5 0 2", "F 5 0 -8", "F 5 0 2"],
}


@pytest.mark.parametrize(("code", "strokes_told"), STROKES.items())
@pytest.mark.parametrize(("level", "height"), [("G98", 20), ("G99", 2)])
def test_strokes_of_each_cycle(code: str, strokes_told: list[str], level: str, height: int, strokes) -> None:
    """The figure of each cycle: positioning, rapid to R, the cutting strokes, and back to the initial level (G98) or
    to R (G99), where the tool already is if the last stroke led there."""
    told = strokes(f"S500 M3\nG0 Z20.\n{level} {code} X5. Z-8. R2. F100")
    back = [] if strokes_told[-1].endswith(f" {height}") else [f"R 5 0 {height}"]
    assert told == ["R 0 0 20", "R 5 0 20", *strokes_told, *back]


def test_fine_boring_shifts_off_the_wall(strokes) -> None:
    """G76: at the bottom the spindle is oriented and the tool moves off by Q before it is retracted, and back."""
    told = strokes("S500 M3\nG0 Z20.\nG98 G76 X5. Z-8. R2. Q0.5 P100 F100")[2:]
    assert told == ["R 5 0 2", "F 5 0 -8", "R 5.5 0 -8", "R 5.5 0 20", "R 5 0 20"]


def test_back_boring(strokes) -> None:
    """G87: oriented and shifted the tool goes down at rapid to R, back on the axis, and feeds up to Z."""
    told = strokes("S500 M3\nG0 Z20.\nG98 G87 X5. Z-8. R-20. Q3. F100")[2:]
    assert told == ["R 8 0 20", "R 8 0 -20", "R 5 0 -20", "F 5 0 -8", "R 8 0 -8", "R 8 0 20", "R 5 0 20"]


SPINDLE = {
    "G81": [1],
    "G76 Q1.": [1, 0, 1],
    "G84": [1, -1, 1],
    "G86": [1, 0, 1],
    "G87 Q1.": [1, 0, 1, 0, 1],
    "G88": [1, 0, 1],
}


@pytest.mark.parametrize(("code", "turns"), SPINDLE.items())
def test_what_the_spindle_does(code: str, turns: list[int], run) -> None:
    """G84 turns it round at the bottom and again at R; G76 and G87 orient it; G86 and G88 stop it at the bottom; all
    let it turn clockwise at the end."""
    events = run(f"S500 M3\nG0 Z20.\n{code} X5. Z-8. R2. F100\nM30")
    assert [e.spindle_direction for e in events if isinstance(e, SpindleChange)] == turns


def test_left_hand_tapping_turns_the_other_way(run) -> None:
    """G74: the tap goes in counter-clockwise (M4 before it) and comes out clockwise."""
    events = run("S500 M4\nG0 Z20.\nG74 X5. Z-8. R2. F100\nM30")
    taps = [e for e in events if isinstance(e, LinearMotion) and e.tapping]
    assert [(e.end_mm[2], e.state.spindle_direction) for e in taps] == [(-8, -1), (2, 1)]
    assert [e.spindle_direction for e in events if isinstance(e, SpindleChange)] == [-1, 1, -1]


def test_rigid_tapping_by_m29(run) -> None:
    """ "Rigid tapping": M29 S before the cycle; the spindle stands before and behind it; F / S is the thread's lead."""
    events = run("M29 S500\nG0 Z20.\nG84 X5. Z-8. R2. F750\nX9.\nG80\nM30")
    taps = [e for e in events if isinstance(e, LinearMotion) and e.tapping]
    assert [(e.end_mm[0], e.state.spindle_direction) for e in taps] == [(5, 1), (5, -1), (9, 1), (9, -1)]
    assert {e.feed_mm_min / e.state.spindle_rpm for e in taps} == {1.5}
    assert [e.spindle_direction for e in events if isinstance(e, SpindleChange)][1:] == [1, -1, 0, 1, -1, 0]


def test_g88_leaves_the_retraction_to_the_operator(run) -> None:
    stops = [e for e in run("S500 M3\nG88 X5. Z-8. R-2. F100\nM30") if isinstance(e, ProgramStop)]
    assert [(e.place.line, e.end) for e in stops] == [(2, False), (3, True)]


@pytest.mark.parametrize("code", ["G82", "G84", "G88", "G89"])
def test_p_is_a_dwell_in_milliseconds(code: str, run) -> None:
    waits = [e.seconds for e in run(f"S500 M3\n{code} X5. Z-8. R-2. P1500 F100\nM30") if isinstance(e, Dwell)]
    assert waits == [1.5] * (2 if code == "G84" else 1)


def test_data_of_the_manual_with_k_and_g91(strokes) -> None:
    """Number of repeats K: with G91 holes of equal pitch are drilled K times from the first block's position on."""
    told = strokes("G0 X10. Z10.\nG91 G99 G81 X20. Z-12. R-8. K3 F100")
    assert told == [
        "R 10 0 10",
        *("R 30 0 10", "R 30 0 2", "F 30 0 -10", "R 30 0 2"),
        *("R 50 0 2", "F 50 0 -10", "R 50 0 2"),
        *("R 70 0 2", "F 70 0 -10", "R 70 0 2"),
    ]


def test_r_and_z_of_g90_and_of_g91(strokes) -> None:
    """Absolute R and Z are coordinates; with G91 R is the distance from the initial level, and Z that from R."""
    absolute = strokes("G0 Z10.\nG90 G81 X5. Z-8. R2. F100")
    assert absolute == strokes("G0 Z10.\nG91 G81 X5. Z-10. R-8. F100")


def test_drilling_data_are_modal_and_every_position_is_drilled(strokes) -> None:
    told = strokes("G0 Z10.\nG99 G81 X5. Z-8. R2. F100\nY7.\nX9. Z-3.\nG80\nX0")
    assert told[5:] == ["R 5 7 2", "F 5 7 -8", "R 5 7 2", "R 9 7 2", "F 9 7 -3", "R 9 7 2", "R 0 7 2"]


def test_another_cycle_takes_the_data_that_it_does_not_name(strokes) -> None:
    """Drilling data, once given, hold for a change of the cycle until G80 or a group 01 code."""
    told = strokes("S500 M3\nG0 Z10.\nG99 G81 X5. Z-8. R2. F100\nG85 X9.")
    assert told[-3:] == ["R 9 0 2", "F 9 0 -8", "F 9 0 2"]


def test_the_initial_level_is_that_where_the_cycle_mode_began(strokes) -> None:
    """G98: the initial level is the absolute Z from which the mode was entered; G80 and a new Z make a new one."""
    told = strokes("G0 Z10.\nG99 G81 X5. Z-8. R2. F100\nG98 X6.\nG80 Z30.\nG98 G81 X7. Z-8. R2.")
    assert told[5:8] == ["R 6 0 2", "F 6 0 -8", "R 6 0 10"]
    assert told[-2:] == ["F 7 0 -8", "R 7 0 30"]


def test_k0_stores_data_for_positions_of_a_subprogram(strokes) -> None:
    """K0: drilling data are stored and nothing is drilled, a usual preparation for a pattern in a subprogram."""
    told = strokes("O1\nG0 Z10.\nG99 G81 Z-8. R2. K0 F100\nM98 P2\nG80\nM30\nO2\nX5.\nX6.\nM99")
    assert told == [
        *("R 0 0 10", "R 5 0 10", "R 5 0 2", "F 5 0 -8", "R 5 0 2"),
        *("R 6 0 2", "F 6 0 -8", "R 6 0 2"),
    ]


@pytest.mark.parametrize(
    ("plane", "words", "told"),
    [
        ("G18", "Z5. X6. Y-8.", ["R 6 10 5", "R 6 2 5", "F 6 -8 5", "R 6 10 5"]),
        ("G19", "Y5. Z6. X-8.", ["R 10 5 6", "R 2 5 6", "F -8 5 6", "R 10 5 6"]),
    ],
)
def test_the_drilling_axis_is_normal_to_the_plane(plane: str, words: str, told: list[str], strokes) -> None:
    """Positioning plane G17: X Y, drilling axis Z; G18: Z X and Y; G19: Y Z and X."""
    axis = "Y" if plane == "G18" else "X"
    assert strokes(f"{plane} G0 {axis}10.\nG81 {words} R2. F100")[1:] == told


def test_levels_are_work_coordinates_of_the_tool_tip(strokes) -> None:
    settings = {"offsets": {"G55": (100.0, 200.0, -300.0)}, "tools": {1: ToolOffset(length_mm=80.0)}}
    told = strokes("G55 G43 H1 G0 X0 Y0 Z10.\nG81 X5. Z-8. R2. F100", **settings)
    assert told[1:] == ["R 105 200 -290", "R 105 200 -298", "F 105 200 -308", "R 105 200 -290"]


def test_inch_cycles(strokes) -> None:
    told = strokes("G20 G0 Z1.\nG99 G73 X1. Z-.5 R.1 Q.25 F10.")
    feeds = [float(stroke.split()[-1]) for stroke in told if stroke.startswith("F")]
    assert feeds == pytest.approx([-0.15 * 25.4, -0.4 * 25.4, -0.5 * 25.4], abs=1e-4)


def test_cutting_feed_is_modal_and_kept_after_the_cycle(motions) -> None:
    moved = motions("G0 Z10.\nG81 X5. Z-8. R2. F100\nX6. F150\nG80\nG1 X9.")
    assert [m.feed_mm_min for m in moved if not m.rapid] == [100, 150, 150]


def test_a_cycle_under_cutter_compensation_is_refused(refusal) -> None:
    """Cutter compensation: it is ignored in canned cycles on some controls and an alarm on others."""
    text = "G1 G41 D1 X5. F100\nX10.\nG81 X20. Z-8. R2."
    assert refusal(text, tools={1: ToolOffset(radius_mm=1.0)}).code == "compensation-cycle"
