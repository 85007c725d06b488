"""Macro calls of FANUC: arguments, levels of local variables, modal calls."""

from __future__ import annotations

import pytest


def called(arguments: str, body: str, before: str = "") -> str:
    """A program that calls O100 with arguments; `body` is the macro's."""
    return f"O1\n{before}\nG65 P100 {arguments}\nM30\nO100\n{body}\nM99"


LIST_ONE = dict(zip("ABCIJKDEFHMQRSTUVWXYZ", [1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 13, *range(17, 27)], strict=True))


@pytest.mark.parametrize(("letter", "number"), LIST_ONE.items())
def test_argument_list_one(letter: str, number: int, value) -> None:
    """FANUC 30i user's manual, "Macro call", argument specification I: A is #1, B #2, C #3, I #4 ... Z #26."""
    assert value(called(f"{letter}7.5", f"#100=#{number}")) == 7.5


@pytest.mark.parametrize(("place", "number"), [(n, n + 4) for n in range(30)])
def test_argument_list_two(place: int, number: int, value) -> None:
    """The same, argument specification II: A, B, C once, then ten sets of I, J, K from #4 to #33."""
    words = " ".join(f"{'IJK'[n % 3]}{n + 0.5}" for n in range(30))
    assert value(called(words, f"#100=#{number}")) == place + 0.5


@pytest.mark.parametrize(
    ("number", "result"), [(1, 1.0), (2, 2.0), (3, None), (4, -3.0), (5, None), (6, None), (7, 5.0)]
)
def test_mixed_lists_take_the_later_argument(number: int, result: float | None, value) -> None:
    """The same, example G65 A1.0 B2.0 I-3.0 I4.0 D5.0: both I4.0 and D5.0 are for #7, and D5.0, the latter, holds."""
    assert value(called("A1.0 B2.0 I-3.0 I4.0 D5.0", f"#100=#{number}")) == result


@pytest.mark.parametrize("word", ["G5", "O5", "N5"])
def test_letters_that_are_no_arguments(word: str, refusal) -> None:
    """The same: G, L, N, O, P cannot be arguments; L is the count and P the program."""
    assert refusal(called(word, "G0 X1.")).place.line == 3


def test_l_repeats_the_macro_with_its_arguments(value) -> None:
    """The same: the number of repetitions is given by L; one where it is missing."""
    assert value(called("A5. L3", "#101=#101+#1\n#100=#101", "#101=0")) == 15.0


def test_each_level_has_local_variables_of_its_own(value) -> None:
    """The same, local variable levels: a macro call saves the caller's, and M99 restores them; those that are no
    arguments are vacant."""
    text = (
        "O1\n#1=1\n#2=77\nG65 P2 A2\n#100=#1*100+#101\n#103=#2\nM30\n"
        "O2\n#102=#2\nG65 P3 A3\n#101=#101+#1*10\nM99\nO3\n#101=#1\n#1=999\nM99"
    )
    assert value(text) == 123.0
    assert value(text, 102) is None
    assert value(text, 103) == 77.0


def test_m98_has_the_local_variables_of_its_caller(value) -> None:
    """The same, differences between macro and subprogram calls: M98 does not change the level of local variables."""
    assert value("O1\n#1=4\nM98 P2\n#100=#1\nM30\nO2\n#1=#1+1\nM99") == 5.0


def test_common_variables_are_shared_by_all_levels(value) -> None:
    assert value("O1\n#100=1\n#500=2\nG65 P2\nM30\nO2\n#100=#100+#500\nM99") == 3.0


def test_g65_returns_into_the_block_that_m99_p_names(ends) -> None:
    assert ends("O1\nG65 P2\nG0 X1.\nN50 G0 X5.\nM30\nO2\nM99 P50") == [(5, 0, 0)]


def test_motions_of_a_macro_leave_the_modes_as_they_end(motions) -> None:
    """A macro's G and F are the program's own: only local variables have levels."""
    moved = motions("O1\nG0 X1.\nG65 P2\nX3.\nM30\nO2\nG1 X2. F50\nM99")
    assert [(m.end_mm[0], m.rapid) for m in moved] == [(1, True), (2, False), (3, False)]


CYCLE = (
    "O9110\n#1=#4001\n#3=#4003\n#4=#4109\n#5=#5003\nG0 G90 Z#18\nG1 Z#26 F#9\nIF[#4010 EQ 98]GOTO 1\nG0 Z#18\nGOTO 2\n"
    "N1 G0 Z#5\nN2 G#1 G#3 F#4\nM99"
)


@pytest.mark.parametrize(("level", "height"), [("G98", 10.0), ("G99", 2.0)])
def test_a_drilling_cycle_as_a_modal_macro(level: str, height: float, strokes) -> None:
    """FANUC 30i user's manual, "Modal call (G66)", sample: a drilling cycle is made by a macro that is called after
    every positioning and that restores modes; its own motions call nothing."""
    text = f"O1\n{level} G0 X0 Y0 Z10.\nG66 P9110 Z-5. R2. F500\nG90 X20.\nY30.\nG67\nX50.\nM30\n{CYCLE}"
    hole = ["R {} 2", "F {} -5", f"R {{}} {height:g}"]
    assert strokes(text) == [
        "R 0 0 10",
        "R 20 0 10",
        *(step.format("20 0") for step in hole),
        f"R 20 30 {height:g}",
        *(step.format("20 30") for step in hole),
        f"R 50 30 {height:g}",
    ]


def test_g66_does_not_call_in_blocks_that_move_nothing(ends) -> None:
    """The same: the macro is called after every block with motion along an axis, from the next block on."""
    text = "O1\nG0 X1.\nG66 P2\nM8\nS100\nX3.\nG67\nX4.\nM30\nO2\nG91 Y1.\nG90\nM99"
    assert ends(text) == [(1, 0, 0), (3, 0, 0), (3, 1, 0), (4, 1, 0)]


def test_l_of_g66_repeats_each_call(ends) -> None:
    assert ends("O1\nG66 P2 L2\nG0 X1.\nG67\nM30\nO2\nG91 Y1.\nG90\nM99") == [(1, 0, 0), (1, 1, 0), (1, 2, 0)]


def test_a_macro_that_is_not_there(refusal) -> None:
    error = refusal("O1\nG65 P77 A1.\nM30")
    assert (error.code, error.place.line) == ("unknown-program", 2)
    assert refusal("O1\nG65 A1.\nM30").code == "missing-word"


def test_an_error_in_a_macro_tells_the_calls_that_led_there(refusal) -> None:
    error = refusal("O1\nG65 P2 A0\nM30\nO2\n#100=1/#1\nM99")
    assert (error.code, error.place.line) == ("bad-operation", 5)
    assert [(call.program, call.line) for call in error.place.calls] == [("O2", 2)]
