"""What Haas mills do in their own way, after the mill operator's manual."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcode.events import CoolantChange, Dwell, SpindleChange
from gcode.settings import ToolOffset

HAAS = "haas"
TOOLS = {2: ToolOffset(length_mm=100.0, length_wear_mm=0.5, radius_mm=6.0, radius_wear_mm=-0.1)}
HOME = {"home_mm": (0.0, 0.0, 500.0)}


def test_m97_calls_a_block_of_the_same_program(ends) -> None:
    """M97 Local sub-program call, example O00011: P names a line N, L repeats, M99 ends it."""
    text = (
        "O00011 (M97 CALL)\nT1 M06\nG00 G90 G54 X0 Y0 S1000 M03\nG43 H00 Z1.\nG01 Z0 F20.\nM97 P1000 L2\nG00 G90 Z1.\n"
        "M30\nN1000 (N LINE THAT RUNS AFTER M97)\nG01 G91 Z-0.1\nG90 X2.\nG91 Z-0.1\nG90 X0\nM99"
    )
    levels = [(x, round(z, 9)) for x, _, z in ends(text, HAAS)]
    assert levels[3:] == [
        *((0, -0.1), (2, -0.1), (2, -0.2), (0, -0.2)),
        *((0, -0.3), (2, -0.3), (2, -0.4), (0, -0.4)),
        (0, 1),
    ]


def test_m97_needs_its_line(refusal) -> None:
    assert refusal("O1\nM97 P77\nM30", HAAS).code == "unknown-label"
    assert refusal("O1\nM97\nM30", HAAS).code == "missing-word"
    assert refusal("O1\nM97 P1\nM30").code == "unknown-code"


def test_m98_counts_by_l_alone(ends, refusal, tmp_path: Path) -> None:
    """M98 Sub-program call: P is the program, in this file or another, L the count; P is never split."""
    sub = "O1000\nG91 X1.\nG90\nM99\n"
    assert ends(f"O1\nM98 P1000 L3\nM30\n{sub}", HAAS) == [(1, 0, 0), (2, 0, 0), (3, 0, 0)]
    assert refusal(f"O1\nM98 P31000\nM30\n{sub}", HAAS).code == "unknown-program"
    (tmp_path / "O31000.nc").write_text("O31000\nG0 X9.\nM99\n")
    assert ends("O1\nM98 P31000\nG65 P31000\nM30", HAAS, search_path=(tmp_path,)) == [(9, 0, 0), (9, 0, 0)]


OFFSETS = {"offsets": {"G54": (0, 0, 0), **{f"G54.1 P{n}": (float(n), 0.0, 0.0) for n in range(1, 100)}}}


@pytest.mark.parametrize(
    ("code", "number"),
    [("G154 P1", 1), ("G154 P20", 20), ("G154 P99", 99), ("G110", 1), ("G111", 2), ("G129", 20), ("G54 P5", 5)],
)
def test_additional_work_offsets(code: str, number: int, ends) -> None:
    """G154 Select work coordinates P1-P99; G110 to G129 are G154 P1 to P20."""
    assert ends(f"{code} G0 X100.", HAAS, **OFFSETS) == [(100 + number, 0, 0)]


def test_g154_p_is_1_to_99(refusal) -> None:
    assert refusal("G154 P100", HAAS).expected == "P1 to P99"
    assert refusal("G154", HAAS).code == "missing-word"
    assert refusal("G154 P1").code == "unknown-code"


def test_g10_sets_additional_offsets_by_l20(ends) -> None:
    assert ends("G10 L20 P3 X7.\nG154 P3 G0 X1.\nG112 X2.", HAAS) == [(8, 0, 0), (9, 0, 0)]


def test_g28_without_axes_returns_all_of_them(ends) -> None:
    """G28 Return to machine zero: all axes where none is named, else the named ones by way of the given place."""
    settings = {"home_mm": (10.0, 20.0, 30.0)}
    assert ends("G0 X1. Y2. Z3.\nG28", HAAS, **settings)[-1] == (10, 20, 30)
    assert ends("G0 X1. Y2. Z3.\nG28 G91 Z0", HAAS, **settings)[1:] == [(1, 2, 3), (1, 2, 30)]
    assert ends("G28 G90 X5. Y5.", HAAS, **settings) == [(5, 5, 0), (10, 20, 0)]


def test_g28_ends_the_tool_length_offset(motions) -> None:
    """G28: it cancels the tool length offset, so Z0 behind it is Z0 of the spindle; FANUC's stays on."""
    text = "G43 H2 G0 Z10.\nG91 G28 Z0\nG90 Z50."
    haas, fanuc = motions(text, HAAS, tools=TOOLS, **HOME)[-1], motions(text, tools=TOOLS, **HOME)[-1]
    assert (haas.state.length_offset_mm, haas.end_mm[2]) == (0, 50)
    assert (fanuc.state.length_offset_mm, fanuc.end_mm[2]) == (100.5, 50)


@pytest.mark.parametrize(("index", "number"), [(2002, 100.0), (2202, 0.5), (2402, 6.0), (2602, -0.1)])
def test_variables_of_tool_offsets(index: int, number: float, value) -> None:
    """Macro variables: #2001-2200 tool length, #2201-2400 length wear, #2401-2600 tool radius, #2601-2800 its wear."""
    assert value(f"#100=#{index}", dialect=HAAS, tools=TOOLS) == number


def test_variables_of_work_offsets(value, ends) -> None:
    """Macro variables: #5201 is the G52 offset, #5221 G54, #7001 G110 (G154 P1), #7381 G129."""
    assert value("G52 X3.\n#100=#5201", dialect=HAAS) == 3.0
    assert value("#100=#7381", dialect=HAAS, **OFFSETS) == 20.0
    assert ends("#5201=4.\nG0 X1.", HAAS) == [(5, 0, 0)]


def test_3000_raises_an_alarm_from_1000_on(refusal) -> None:
    """Macro variables: #3000 = 15 (MESSAGE) is alarm 1015."""
    assert refusal("#3000= 15 (MESSAGE)", HAAS).problem == "the program raises alarm 1015: MESSAGE"


def test_words_are_rounded_to_the_last_decimal(ends) -> None:
    """Macros, address substitution: with #1 = .123456, G01 X#1 moves to .1235 inch, or .123 mm."""
    assert ends("#1=.123456\nG0 X#1", HAAS) == [(0.123, 0, 0)]
    assert ends("#1=.123456\nG20\nG0 X#1", HAAS) == [pytest.approx((0.1235 * 25.4, 0, 0))]


def test_round_in_an_address(ends) -> None:
    """Macros, ROUND: with #1 = 1.00333, X[#1+#1] is 2.0067 inch and X[ROUND[#1]+ROUND[#1]] 2.0066."""
    first, second = ends("G20\n#1=1.00333\nG0 X[#1+#1]\nX[ROUND[#1]+ROUND[#1]]", HAAS)
    assert (first[0], second[0]) == pytest.approx((2.0067 * 25.4, 2.0066 * 25.4), abs=1e-9)


def test_dwells_are_seconds_with_a_point(run) -> None:
    """G04 Dwell: P is seconds with a decimal point, milliseconds without one."""
    assert [e.seconds for e in run("G4 P1500\nG4 P1.5\nM30", HAAS) if isinstance(e, Dwell)] == [1.5, 1.5]
    hole = "S500 M3\nG0 Z10.\nG82 X1. Z-5. R2. P0.25 F100\nM30"
    assert [e.seconds for e in run(hole, HAAS) if isinstance(e, Dwell)] == [0.25]


def test_tapping_needs_no_m3(run) -> None:
    """G84 Tapping: rigid; the control starts the spindle clockwise before the cycle."""
    turns = [
        e.spindle_direction for e in run("S500\nG84 X1. Z-5. R-1. F500\nM30", HAAS) if isinstance(e, SpindleChange)
    ]
    assert turns == [0, 1, -1, 0]


def test_setting_22_is_the_retraction_of_a_peck(strokes) -> None:
    """G73 High-speed peck drilling: back by setting 22 after every Q, here 1.27 mm (0.05 inch)."""
    told = strokes("S500 M3\nG0 Z10.\nG99 G73 X1. Z-9. R0 Q5. F100", HAAS)
    assert told[3:] == ["F 1 0 -5", "R 1 0 -3.73", "F 1 0 -9", "R 1 0 0"]


def test_repeats_by_l(strokes) -> None:
    told = strokes("G0 Z10.\nG91 G99 G81 X1. Z-5. R-9. L2 F100", HAAS)
    assert [stroke for stroke in told if stroke.startswith("F")] == ["F 1 0 -4", "F 2 0 -4"]


def test_f_of_a_helix_is_the_feed_along_it(motions) -> None:
    assert motions("G0 X10.\nG3 X-10. I-10. Z40. F100", HAAS)[-1].feed_mm_min == pytest.approx(100)


@pytest.mark.parametrize(
    "code",
    [
        "G12 I5. D1 F50",
        "G13 I5. D1 F50",
        "G47 P0 J5.",
        "G70 I5. J0 L6",
        "G71",
        "G72",
        "G101 X0",
        "G150",
        "G143",
        "G234",
    ],
)
def test_codes_that_are_refused_by_name(code: str, refusal) -> None:
    error = refusal(f"G0 X1.\n{code}", HAAS)
    assert (error.code, error.place.line) == ("unsupported-code", 2)


@pytest.mark.parametrize("code", ["G66.1 P5", "M198 P5", "G5.1 Q1", "G92.1 X0"])
def test_codes_of_fanuc_that_haas_has_not(code: str, refusal) -> None:
    assert refusal(f"O1\n{code}\nM30", HAAS).code == "unknown-code"


def test_modes_at_power_on(motions) -> None:
    """G codes marked as defaults: G00, G17, G40, G49, G54, G80, G90, G94, G97, G98."""
    (moved,) = motions("X5.", HAAS)
    state = moved.state
    assert (moved.rapid, state.plane, state.wcs, state.compensation) == (True, 17, "G54", "off")
    assert (state.feed_mode, state.length_offset_mm) == ("per-minute", 0)


def test_coolant(run) -> None:
    told = [(e.mist, e.flood) for e in run("M8\nM9\nM88\nM89\nM30", HAAS) if isinstance(e, CoolantChange)]
    assert told == [(False, True), (False, False)]
