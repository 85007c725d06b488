"""FANUC's decimal point rule: a number without a point counts least input increments (parameter 3401 bit 0 at 0).

FANUC 30i user's manual, "Decimal point programming": in that setting X1000 is 1 mm (IS-B, 0.001 mm) or 0.1 inch
(0.0001 inch), and X1000. is 1000 mm or inch; with pocket calculator type input both are 1000.
"""

from __future__ import annotations

import pytest

from gcode.events import ArcMotion, Dwell

INCREMENT = {"decimal_point": "increment"}


@pytest.mark.parametrize(
    ("unit", "word", "length_mm"),
    [
        ("G21", "X1000", 1.0),
        ("G21", "X1000.", 1000.0),
        ("G21", "X1", 0.001),
        ("G21", "X-15500", -15.5),
        ("G20", "X10000", 25.4),
        ("G20", "X1.", 25.4),
        ("G20", "X1", 0.00254),
    ],
)
def test_lengths(unit: str, word: str, length_mm: float, ends) -> None:
    assert ends(f"{unit} G0 {word}", **INCREMENT) == [pytest.approx((length_mm, 0, 0))]
    calculator = float(word[1:]) * (25.4 if unit == "G20" else 1.0)
    assert ends(f"{unit} G0 {word}") == [pytest.approx((calculator, 0, 0))]


def test_the_unit_of_an_earlier_block_decides_the_increment(ends) -> None:
    assert ends("G20\nX1000\nG21\nX1000", **INCREMENT) == [pytest.approx((2.54, 0, 0)), (1, 0, 0)]


def test_words_with_and_without_a_point_stand_in_one_block(ends) -> None:
    """The same: numbers with a decimal point and without one can be given together."""
    assert ends("G0 X1000 Y23.7 Z500", **INCREMENT) == [(1, 23.7, 0.5)]


def test_centre_and_radius_of_an_arc(motions) -> None:
    full, half = motions("G2 I10000 F100\nG3 X20000 R10000", **INCREMENT)
    assert isinstance(full, ArcMotion)
    assert (full.centre_mm, half.end_mm) == ((10, 0, 0), (20, 0, 0))
    assert half.centre_mm == pytest.approx((10, 0, 0))


def test_arc_centres_by_k(motions) -> None:
    (arc,) = motions("G18 G2 K5000 F100", **INCREMENT)
    assert arc.centre_mm == (0, 0, 5)


def test_levels_and_pecks_of_a_cycle(strokes) -> None:
    text = "G0 Z10000\nG83 X5000 Z-3000 R2000 Q2500 F100"
    assert strokes(text, **INCREMENT) == strokes("G0 Z10.\nG83 X5. Z-3. R2. Q2.5 F100")


@pytest.mark.parametrize("letter", ["K", "L"])
def test_counts_are_not_lengths(letter: str, strokes) -> None:
    """The repeats of a cycle are a count: K3 is three holes whatever the setting."""
    text = f"G91 G81 X5. Z-3. R-2. {letter}3 F100"
    assert strokes(text, **INCREMENT) == strokes(text)
    modal = f"G91 G81 X5. Z-3. R-2. F100\nX7. {letter}2"
    assert strokes(modal, **INCREMENT) == strokes(modal)


def test_feed_speed_tool_and_offset_numbers_are_not_touched(motions) -> None:
    (moved,) = motions("T3 M6\nS500 M3\nG43 H0\nG1 X1000 F100", **INCREMENT)
    assert (moved.feed_mm_min, moved.state.spindle_rpm, moved.state.tool) == (100, 500, 3)


@pytest.mark.parametrize("unit", ["G21", "G20"])
@pytest.mark.parametrize(("word", "seconds"), [("X1500", 1.5), ("X1.5", 1.5), ("P1500", 1.5)])
def test_a_dwell_counts_milliseconds_in_both_units(unit: str, word: str, seconds: float, run) -> None:
    """FANUC 30i user's manual, "Dwell": the increment of the time is 0.001 s (IS-B), whatever unit lengths have."""
    waits = [e.seconds for e in run(f"{unit}\nG4 {word}", **INCREMENT) if isinstance(e, Dwell)]
    assert waits == pytest.approx([seconds])


@pytest.mark.parametrize("unit", ["G21", "G20"])
def test_angles_count_thousandths_of_a_degree_in_both_units(unit: str, ends) -> None:
    """FANUC 30i user's manual, "Coordinate system rotation": the increment of R is 0.001 degree; so is a polar
    angle's."""
    rotated = ends(f"{unit}\nG68 X0 Y0 R90000\nG0 X1. Y0", **INCREMENT)[-1]
    polar = ends(f"{unit}\nG16\nG0 X1. Y90000", **INCREMENT)[-1]
    length = 25.4 if unit == "G20" else 1.0
    assert rotated == pytest.approx((0, length, 0))
    assert polar == pytest.approx((0, length, 0), abs=1e-9)


@pytest.mark.parametrize("setting", [{}, INCREMENT])
@pytest.mark.parametrize("words", ["P2000", "P2.", "I2000 J2000 K2000", "I2. J2. K2."])
def test_scale_factors_count_thousandths(words: str, setting: dict[str, str], ends) -> None:
    """FANUC 30i user's manual, "Scaling": the unit of a magnification is 0.001, whatever lengths count in."""
    assert ends(f"G51 X0 Y0 Z0 {words}\nG0 X3. Y1.", **setting) == [(6, 2, 0)]


def test_offset_data(ends) -> None:
    text = "G10 L2 P1 X5000\nG10 L10 P1 R3000\nG54 G43 H1 G0 X1. Z0\nG53 X0 Z0"
    assert ends(text, **INCREMENT) == [(6, 0, 0), (0, 0, -3)]


@pytest.mark.parametrize(
    ("letter", "number", "result"), [("X", 24, 1.0), ("I", 4, 1.0), ("A", 1, 1000.0), ("S", 19, 1000.0), ("F", 9, 1000)]
)
def test_arguments_of_a_macro_count_as_their_address_does(letter: str, number: int, result: float, value) -> None:
    """FANUC 30i user's manual, "Macro call", position of the decimal point: arguments without one count the least
    input increment of each address."""
    assert value(f"O1\nG65 P2 {letter}1000\nM30\nO2\n#100=#{number}\nM99", **INCREMENT) == result


def test_variables_and_constants_of_a_macro_are_what_they_say(ends) -> None:
    """FANUC 30i user's manual, "Variables": in an assignment the decimal point can be omitted, 100 is 100.0; a word
    with a variable counts mm."""
    assert ends("#1=100\nG0 X#1\nX[#1+5]", **INCREMENT) == [(100, 0, 0), (105, 0, 0)]


def test_chamfers_and_roundings(motions) -> None:
    moved = motions("G1 X10000 ,C2000 F100\nY10000 ,R3000\nX20000", **INCREMENT)
    assert moved[0].end_mm == pytest.approx((8, 0, 0))
    assert moved[1].end_mm == pytest.approx((10, 2, 0))
    assert moved[2].end_mm == pytest.approx((10, 7, 0))
