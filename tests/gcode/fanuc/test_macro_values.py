"""Arithmetic, vacant variables and rounding of FANUC's custom macro B, worked out by hand."""

from __future__ import annotations

import math

import pytest


@pytest.mark.parametrize(
    ("expression", "result"),
    [
        ("1+2*3", 7.0),
        ("[1+2]*3", 9.0),
        ("10-4-3", 3.0),
        ("24/4/2", 3.0),
        ("2+12/4-1", 4.0),
        ("7 MOD 4+1", 4.0),
        ("1+7 MOD 4", 4.0),
        ("12 OR 3 AND 1", 13.0),
        ("12 AND 10 XOR 1", 9.0),
        ("1+2 OR 4", 7.0),
        ("-3*-2", 6.0),
        ("2*SIN[30]+1", 2.0),
        ("SQRT[SIN[30]*8]", 2.0),
        ("[[[1+1]*2]+1]*2", 10.0),
    ],
)
def test_priority_of_operations(expression: str, result: float, value) -> None:
    """FANUC 30i user's manual, "Arithmetic and logic operation", priority: functions; then * / AND MOD; then
    + - OR XOR; brackets first, operations of one priority from left to right."""
    assert value(f"#100={expression}") == pytest.approx(result)


@pytest.mark.parametrize(
    ("expression", "result"),
    [
        ("FUP[1.2]", 2.0),
        ("FIX[1.2]", 1.0),
        ("FUP[-1.2]", -2.0),
        ("FIX[-1.2]", -1.0),
        ("FUP[3.0]", 3.0),
        ("FIX[1.9]+FUP[1.1]", 3.0),
        ("ROUND[1.4999]", 1.0),
        ("ROUND[1.5]", 2.0),
        ("ROUND[-1.5]", -2.0),
        ("ABS[-7.25]", 7.25),
        ("BIN[37]", 25.0),
        ("BCD[25]", 37.0),
        ("BCD[BIN[153]]", 153.0),
        ("EXP[LN[5]]", 5.0),
        ("LN[EXP[2]]", 2.0),
        ("POW[2,10]", 1024.0),
        ("POW[2,-1]", 0.5),
        ("SQRT[2]*SQRT[2]", 2.0),
    ],
)
def test_functions(expression: str, result: float, value) -> None:
    """FANUC 30i user's manual, "Arithmetic and logic operation": FUP makes the size larger and FIX smaller (#1=1.2,
    #2=-1.2: 2, 1, -2, -1); ROUND is to the nearest whole number; BIN reads the hexadecimal digits as decimal ones."""
    assert value(f"#100={expression}") == pytest.approx(result)


@pytest.mark.parametrize(
    ("expression", "degrees"),
    [
        ("ATAN[1]/[1]", 45.0),
        ("ATAN[1]/[-1]", 135.0),
        ("ATAN[-1]/[-1]", 225.0),
        ("ATAN[-1]/[1]", 315.0),
        ("ATAN[1,1]", 45.0),
        ("ATAN[1]", 45.0),
        ("ATAN[-1]", -45.0),
        ("ASIN[0.5]", 30.0),
        ("ASIN[-0.5]", 330.0),
        ("ACOS[-1]", 180.0),
        ("ACOS[0.5]", 60.0),
    ],
)
def test_ranges_of_the_inverse_functions(expression: str, degrees: float, value) -> None:
    """FANUC 30i user's manual, with parameter 6004 NAT at 0: ATAN[a]/[b] is 0 to 360 (ATAN[-1]/[-1] is 225), ASIN 270
    to 90 by way of 0, ACOS 180 to 0; ATAN of one argument -90 to 90. Angles are degrees."""
    assert value(f"#100={expression}") == pytest.approx(degrees)


def test_angles_are_degrees_and_decimal_parts_of_them(value) -> None:
    """FANUC 30i user's manual: 90 degrees 30 minutes are 90.5 degrees."""
    assert value("#100=COS[90.5]") == pytest.approx(math.cos(math.radians(90.5)))
    assert value("#100=TAN[45]") == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("expression", "code"),
    [
        ("1/0", "bad-operation"),
        ("5 MOD 0", "bad-operation"),
        ("SQRT[-1]", "bad-operation"),
        ("LN[0]", "bad-operation"),
        ("ASIN[1.5]", "bad-operation"),
        ("ADP[5]", "unsupported-function"),
        ("[1+2", "bad-expression"),
        ("NO[5]", "unknown-function"),
    ],
)
def test_operations_without_a_result_are_alarms(expression: str, code: str, refusal) -> None:
    """FANUC alarms PS0112 (zero divide), PS0119 (argument value error), PS0118 (too many or wrong brackets)."""
    error = refusal(f"G0 X0\n#100={expression}")
    assert (error.code, error.place.line) == (code, 2)


def test_vacant_in_operations(value) -> None:
    """FANUC 30i user's manual, "Variables", undefined variable: #2=#1 hands the vacant on, an operation counts 0."""
    assert value("#100=#1") is None
    assert value("#100=#1*5") == 0.0
    assert value("#100=#1+#1") == 0.0
    assert value("#100=7\n#100=#0") is None
    assert value("#1=3\n#100=#1+#0") == 3.0


@pytest.mark.parametrize(
    ("condition", "vacant", "zero"),
    [
        ("#1 EQ #0", True, False),
        ("#1 NE 0", True, False),
        ("#1 GE #0", True, True),
        ("#1 GT 0", False, False),
        ("#1 LE #0", True, True),
        ("#1 LT 0", False, False),
        ("#1 EQ 0", False, True),
        ("#1 NE #0", False, True),
    ],
)
def test_vacant_in_conditions(condition: str, vacant: bool, zero: bool, value) -> None:
    """FANUC 30i user's manual, "Variables", table of conditional expressions: vacant differs from 0 in EQ and NE
    only."""
    told = f"#100=5\nIF[{condition}]THEN #100=6"
    assert value(told) == (6.0 if vacant else 5.0)
    assert value(f"#1=0\n{told}") == (6.0 if zero else 5.0)


def test_a_word_whose_variable_is_vacant_is_ignored(ends) -> None:
    """FANUC 30i user's manual: with #1 vacant G90 X100 Y#1 is G90 X100; with #1=0 it is G90 X100 Y0."""
    assert ends("G0 X1 Y1\nG90 X100. Y#1") == [(1, 1, 0), (100, 1, 0)]
    assert ends("G0 X1 Y1\n#1=0\nG90 X100. Y#1") == [(1, 1, 0), (100, 0, 0)]
    assert ends("G0 X1 Y1\nX-#1 Y[#1]\nX[#1+2]") == [(1, 1, 0), (2, 1, 0)]


def test_a_word_is_rounded_to_the_least_input_increment(ends) -> None:
    """FANUC 30i user's manual, "Variables": with #1=12.3456 and increments of 1/1000 mm, G00 X#1 is G00 X12.346."""
    assert ends("#1=12.3456\nG0 X#1") == [(12.346, 0, 0)]
    assert ends("#1=12.3456\nG0 X-#1 Y[#1*2]") == [(-12.346, 24.691, 0)]
    assert ends("G20\n#1=1.23456\nG0 X#1") == [pytest.approx((1.2346 * 25.4, 0, 0))]


def test_moving_back_by_the_sum_of_two_variables_misses_the_start(ends) -> None:
    """FANUC 30i user's manual, ROUND function: with #1=1.2345 and #2=2.3456 the moves X-#1 and X-#2 are -1.235 and
    -2.346; X[#1+#2] is 3.580 and misses the start by 0.001; X[ROUND[#1]+ROUND[#2]] is 3.581 and does not."""
    there = "#1=1.2345\n#2=2.3456\nG91 G0 X-#1\nG1 X-#2 F300\n"
    assert ends(f"{there}G0 X[#1+#2]")[-1] == pytest.approx((-0.001, 0, 0))
    assert ends(f"{there}G0 X[ROUND[#1]+ROUND[#2]]")[-1] == pytest.approx((0, 0, 0))


def test_round_in_a_word_and_in_an_assignment(ends) -> None:
    """The same page: in an address ROUND rounds to the address's least input increment, elsewhere to a whole
    number."""
    assert ends("#1=27/32\nG0 X[ROUND[#1]]\n#2=ROUND[#1]\nX#2") == [(0.844, 0, 0), (1, 0, 0)]
    assert ends("#1=27/32\nG20\nG0 X[ROUND[#1]]") == [pytest.approx((0.8438 * 25.4, 0, 0))]


def test_a_whole_number_word_is_rounded(motions) -> None:
    """FANUC 30i user's manual, "Variables": a value in an address is rounded to its significant digits; those of H,
    T, D and S are whole."""
    (moved,) = motions("#1=2.4999\n#2=1499.6\nT#1 M6\nS#2 M3\nG0 X1.")
    assert (moved.state.tool, moved.state.spindle_rpm) == (2, 1500)
