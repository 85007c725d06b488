"""Lexer and parser: words with their places, comments, slash and percent; and the refusals, message for message."""

from __future__ import annotations

import pytest

from gcode.dialects import FANUC, GRBL, LINUXCNC
from gcode.errors import GcodeError, Place
from gcode.language.block_parser import MAX_LINE, parse_blocks, parse_line
from gcode.language.blocks import ParsedBlock


def parse(text: str, *, linuxcnc: bool = False, block_delete: bool = False) -> ParsedBlock:
    place = Place(file="t.nc", line=7, text=text)
    return parse_line(place, LINUXCNC if linuxcnc else FANUC, block_delete=block_delete)


def words(text: str) -> list[tuple[str, float]]:
    return [(word.letter, word.value) for word in parse(text).words]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("X1", 1.0),
        ("X1.", 1.0),
        ("X.5", 0.5),
        ("X-.5", -0.5),
        ("X+1", 1.0),
        ("X-0", 0.0),
        ("X007", 7.0),
        ("x2.50", 2.5),
    ],
)
def test_decimal_forms(text: str, value: float) -> None:
    assert words(text) == [("X", value)]


def test_words_need_no_blanks_and_may_hold_them() -> None:
    expected = [("N", 10.0), ("G", 1.0), ("X", -12.5), ("Y", 3.0)]
    assert words("N10G01X-12.5Y3") == expected
    assert words("  n 10\tg 0 1 x - 1 2 . 5   y3  ") == expected


def test_words_carry_their_text_and_column() -> None:
    block = parse("N5 (in) g01 X 1 .5")
    assert [(w.text, w.column) for w in block.words] == [("N5", 1), ("G01", 9), ("X1.5", 13)]
    assert [w.has_point for w in block.words] == [False, False, True]


def test_comments_are_kept_apart() -> None:
    block = parse("(first)G0(second) X1 ; the rest (of it", linuxcnc=True)
    assert block.comments == ("first", "second", " the rest (of it")


def test_a_semicolon_ends_a_block_in_fanuc() -> None:
    blocks = parse_blocks(Place(file="t.nc", line=7, text="G0X1;G1Y2 (b);"), FANUC)
    assert [[w.text for w in block.words] for block in blocks] == [["G0", "X1"], ["G1", "Y2"]]
    assert blocks[1].comments == ("b",)
    assert words("G0X1;") == [("G", 0.0), ("X", 1.0)]


def test_a_comment_may_hold_any_printable_text() -> None:
    assert parse("(Fräser Ø6 → 3/4% #5 [x])").comments == ("Fräser Ø6 → 3/4% #5 [x]",)


@pytest.mark.parametrize("text", ["/G1X1", " /1 G1 X1", "N10 /G1X1", "/ G1 X1"])
def test_block_delete_reads_the_block_or_does_not(text: str) -> None:
    assert ("X", 1.0) in words(text)
    deleted = parse(text, block_delete=True)
    assert deleted.deleted
    assert deleted.words == ()


def test_a_deleted_block_is_not_read_at_all() -> None:
    assert parse("/ no block at all", block_delete=True).deleted


@pytest.mark.parametrize("text", ["%", "  % ", "%(tape)", "% ; end"])
def test_percent(text: str) -> None:
    assert parse(text).percent


@pytest.mark.parametrize("text", ["", "   ", "\t"])
def test_empty_lines_have_no_words(text: str) -> None:
    assert parse(text) == ParsedBlock(place=Place(file="t.nc", line=7, text=text))


MACRO = (
    "is macro language (variables, expressions, jumps), which is not supported; "
    "expected a plain number after each letter"
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("G1 X", "t.nc:7:4: X has no number; expected X and a number [missing-number]"),
        ("G1 X-Y1", "t.nc:7:4: X- has no number; expected X and a number [missing-number]"),
        ("G1 X1.2.3", "t.nc:7:4: X1.2.3 is not a number; expected digits with at most one point [bad-number]"),
        ("X.", "t.nc:7:1: X. is not a number; expected digits with at most one point [bad-number]"),
        ("X10000000000", "t.nc:7:1: X10000000000 is out of range; "
         "expected an absolute value of at most 1000000000 [number-too-large]"),
        ("G1 (open", "t.nc:7:4: a comment that is not closed; expected ) [unclosed-comment]"),
        ("X12,5", "t.nc:7:4: unexpected ','; expected a decimal point, which controls require [unexpected-character]"),
        ("G1 X1)", "t.nc:7:6: unexpected ')'; expected a letter and its number, or a comment [unexpected-character]"),
        ("G1 *", "t.nc:7:4: unexpected '*'; expected a letter and its number, or a comment [unexpected-character]"),
        ("G1 X²", "t.nc:7:4: X has no number; expected X and a number [missing-number]"),
        ("Ä1", "t.nc:7:1: unexpected 'Ä'; expected a letter and its number, or a comment [unexpected-character]"),
        ("X٣", "t.nc:7:1: X has no number; expected X and a number [missing-number]"),
        ("o<sub> call", "t.nc:7:8: CALL is not understood; expected a word or a statement [bad-statement]"),
        ("o100 sub", "t.nc:7:6: SUB is not understood; expected a word or a statement [bad-statement]"),
        ("G1 /X1", "t.nc:7:4: block delete / inside a block; expected / at its start [block-delete-place]"),
        ("%123", "t.nc:7:1: text after %: 123; expected % alone in its line [bad-percent]"),
        ("G1\x00X1", "t.nc:7:3: NUL (0x00) in the line; expected printable text [control-character]"),
        ("G1\rX1", "t.nc:7:3: carriage return (0x0d) in the line; expected printable text [control-character]"),
        ("(a\x07)", "t.nc:7:3: control character (0x07) in the line; expected printable text [control-character]"),
        ("X1" + " " * MAX_LINE, "t.nc:7:1: the line is too long; "
         f"expected at most {MAX_LINE} characters [line-too-long]"),
    ],
)  # fmt: skip
def test_refusals(text: str, message: str) -> None:
    with pytest.raises(GcodeError) as caught:
        parse(text)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("G1 X#100", "4: X#"),
        ("G1 X-[1+2]", "4: X-["),
        ("#100=5", "1: #"),
        ("IF[#1EQ2]GOTO5", "1: IF"),
        ("N1 GOTO 5", "4: GOTO"),
        ("WHILE[#1LT2]DO1", "1: WHILE"),
        ("END1", "1: END"),
        ("o<sub> call", "8: CALL"),
        ("o100 sub", "6: SUB"),
    ],
)
def test_grbl_has_no_macro_language(text: str, shown: str) -> None:
    with pytest.raises(GcodeError) as caught:
        parse_line(Place(file="t.nc", line=7, text=text), GRBL)
    assert str(caught.value).upper() == f"t.nc:7:{shown} {MACRO} [unsupported-macro]".upper()


def test_there_are_no_exponents() -> None:
    assert words("X1e400") == [("X", 1.0), ("E", 400.0)]


def test_a_semicolon_is_a_comment_in_linuxcnc() -> None:
    block = parse("G0X1;G0Y2", linuxcnc=True)
    assert block.comments == ("G0Y2",)
    assert [word.letter for word in block.words] == ["G", "X"]


def test_the_underline_stands_under_the_word() -> None:
    with pytest.raises(GcodeError) as caught:
        parse("G1 X1 Y.")
    assert caught.value.underlined().splitlines()[1:] == ["    G1 X1 Y.", "          ^"]


def test_a_refused_long_line_is_not_shown_in_full() -> None:
    with pytest.raises(GcodeError) as caught:
        parse("X" + "1" * 100_000)
    assert len(caught.value.underlined()) < 300
