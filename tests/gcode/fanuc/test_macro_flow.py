"""Branches and repetition of FANUC's custom macro B."""

from __future__ import annotations

import pytest


def test_sum_of_1_to_10_with_if_goto(value) -> None:
    """FANUC 30i user's manual, "Branch and repetition", IF [...] GOTO, sample program: the total of 1 to 10 is 55."""
    text = "O9500\n#1=0\n#2=1\nN1 IF[#2 GT 10] GOTO 2\n#1=#1+#2\n#2=#2+1\nGOTO 1\nN2 #100=#1\nM30"
    assert value(text) == 55.0


def test_sum_of_1_to_10_with_while(value) -> None:
    """The same chapter, WHILE [...] DO m, sample program: the total of 1 to 10 is 55."""
    text = "O1\n#1=0\n#2=1\nWHILE[#2 LE 10] DO 1\n#1=#1+#2\n#2=#2+1\nEND 1\n#100=#1\nM30"
    assert value(text) == 55.0


def test_goto_finds_blocks_before_and_behind(ends) -> None:
    """The same chapter, unconditional branch: GOTO n branches to sequence number n, which may be an expression."""
    assert ends("G0 X1.\nGOTO 20\nX2.\nN20 X3.") == [(1, 0, 0), (3, 0, 0)]
    assert ends("#1=10\nGOTO #1\nX2.\nN10 X3.") == [(3, 0, 0)]
    assert ends("#1=0\nN5 #1=#1+1\nG0 X#1\nIF[#1 LT 3]GOTO 5\nY1.") == [(1, 0, 0), (2, 0, 0), (3, 0, 0), (3, 1, 0)]


def test_a_jump_is_to_a_block_of_the_same_program(ends, refusal) -> None:
    text = "O1\nM98 P2\nN10 G0 X1.\nM30\nO2\nGOTO 10\nX9.\nN10 X2.\nM99"
    assert ends(text) == [(2, 0, 0), (1, 0, 0)]
    error = refusal("O1\nGOTO 7\nM30\nO2\nN7 M99")
    assert (error.code, error.place.line) == ("unknown-label", 2)


def test_numbers_written_with_zeros_are_the_same_label(ends) -> None:
    assert ends("GOTO 100\nG0 X9.\nN0100 G0 X1.") == [(1, 0, 0)]


def test_if_then_makes_one_macro_statement(value) -> None:
    """The same chapter, IF [...] THEN: where #1 and #2 are equal, 0 is assigned to #3."""
    assert value("#1=4\n#2=4\n#100=9\nIF[#1 EQ #2] THEN #100=0") == 0.0
    assert value("#1=4\n#2=5\n#100=9\nIF[#1 EQ #2] THEN #100=0") == 9.0


def test_if_then_takes_no_motion(refusal) -> None:
    """The same page: only a single macro statement is executed after THEN."""
    assert refusal("#1=0\nIF[#1 EQ 0] THEN G0 X5.").code == "bad-statement"


@pytest.mark.parametrize(
    ("condition", "holds"),
    [
        ("#1 EQ 5", True),
        ("#1 NE 5", False),
        ("#1 GT 4.999", True),
        ("#1 GE 5.001", False),
        ("#1 LT 5", False),
        ("#1 LE 5", True),
        ("[#1 GT 3] AND [#1 LT 6]", True),
        ("[#1 GT 3] AND [#1 LT 5]", False),
        ("[#1 EQ 9] OR [#1 EQ 5]", True),
        ("#1+1 EQ 2*3", True),
    ],
)
def test_conditions(condition: str, holds: bool, value) -> None:
    """The same chapter, operators EQ, NE, GT, GE, LT, LE; expressions may stand on both sides; AND, OR combine."""
    assert value(f"#1=5\n#100=0\nIF[{condition}] THEN #100=1") == float(holds)


def test_a_while_that_never_holds_is_passed_over(ends) -> None:
    assert ends("WHILE[1 EQ 2]DO1\nG0 X9.\nEND1\nG0 X1.") == [(1, 0, 0)]


def test_loops_nest_to_three_levels(value) -> None:
    """The same chapter, nesting: DO loops may be nested to a maximum depth of three levels: 2 * 3 * 4 = 24 rounds."""
    text = (
        "#100=0\n#1=0\nWHILE[#1 LT 2]DO1\n#2=0\nWHILE[#2 LT 3]DO2\n#3=0\nWHILE[#3 LT 4]DO3\n"
        "#100=#100+1\n#3=#3+1\nEND3\n#2=#2+1\nEND2\n#1=#1+1\nEND1"
    )
    assert value(text) == 24.0


def test_a_number_may_be_used_again_one_after_the_other(value) -> None:
    """The same chapter: the identification numbers 1 to 3 can be used as many times as required."""
    loop = "#1=0\nWHILE[#1 LT 3]DO1\n#1=#1+1\n#100=#100+1\nEND1\n"
    assert value("#100=0\n" + loop + loop) == 6.0


def test_a_loop_without_a_condition_ends_by_a_jump(value) -> None:
    """The same chapter: DO m without WHILE loops for ever; control can be transferred to the outside of a loop."""
    assert value("#1=0\nDO1\n#1=#1+1\nIF[#1 EQ 4]GOTO 9\nEND1\nN9 #100=#1") == 4.0


@pytest.mark.parametrize(
    "text",
    [
        "#1=0\nWHILE[#1 LT 2]DO1\n#1=#1+1",
        "#1=0\nWHILE[#1 LT 2]DO4\n#1=#1+1\nEND4",
        "G0 X1.\nEND1",
        "#1=0\nWHILE[#1 LT 2]DO1\nWHILE[#1 LT 3]DO1\n#1=#1+1\nEND1\nEND1",
        "#1=0\nWHILE[#1 LT 2]DO1\nWHILE[#1 LT 3]DO2\n#1=#1+1\nEND1\nEND2",
        "#1=0\nGOTO 5\nWHILE[#1 LT 2]DO1\nN5 #1=#1+1\nEND1",
    ],
    ids=["no-end", "do4", "end-alone", "same-number", "crossing", "jump-into"],
)
def test_broken_loops_are_refused(text: str, refusal) -> None:
    """The same chapter, alarms PS0124 to PS0127: END and DO must pair, DO1 to DO3, ranges must not cross, and no
    jump leads into a loop."""
    assert refusal(text).code == "bad-loop"


def test_words_in_one_block_with_assignments_use_the_values_before(ends) -> None:
    assert ends("#1=1.\n#1=#1+1\nG0 X#1") == [(2, 0, 0)]


@pytest.mark.parametrize("text", ["GOTO 1.5", "GOTO #5", "GOTO -1", "IF[1 EQ 1] GOTO 77", "GOTO 77"])
def test_jumps_to_no_block_are_refused(text: str, refusal) -> None:
    """FANUC alarm PS0128: illegal macro sequence number."""
    assert refusal(f"G0 X1.\n{text}").code in ("bad-label", "unknown-label")
