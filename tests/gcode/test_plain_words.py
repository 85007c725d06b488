"""Plain lines are found, and their numbers are those of Python to the last bit."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from support.nc_lines import numbers

from gcode.bulk.plain_words import plain_end, read_words


@settings(max_examples=300, deadline=None)
@given(st.lists(numbers(30), min_size=1))
@example(["9007199254740993.0"[-9:], "-0", "-.0", "+0.1", "0.30000000000000004", "999999999.999999999999999"])
@example(["000000001.00000000000000000000000000001", "-123456789.5000000000000000000000000001", "5e0"[:1]])
def test_numbers_are_those_of_float(texts: list[str]) -> None:
    text = "".join(f"x{number}\r\n" for number in texts).encode()
    words = read_words(text, 0, plain_end(text, 0, 1000))
    assert words.value.tobytes() == np.array([float(number) for number in texts]).tobytes()
    assert words.pointed.tolist() == ["." in number for number in texts]
    assert words.line.tolist() == list(range(len(texts)))
    assert bytes(words.letter) == b"X" * len(texts)


@pytest.mark.parametrize(
    "line",
    [
        *("", " ", "\t", "X1", "g01x-1.y+.5 z 3", "N10 G1 X1.5", "F100X2", "X1 G0", "N999999999", "G 1", "\r", "F+1."),
        *("G2X1R2", "i1j2k3r4g03", "S100M3", "m08", "X1(c)", "(c) Y1 (d)", "(X1 G2; %)", "X1;", "X1; "),
    ],
)
def test_plain_lines(line: str) -> None:
    assert plain_end(f"{line}\n".encode(), 0, 9) == len(line) + 1


@pytest.mark.parametrize(("tail", "plain"), [("; a (b", True), (";abort,x", False), (";\u00e9", False), (";(X1", True)])
def test_a_semicolon_that_starts_a_comment(tail: str, plain: bool) -> None:
    text = f"X1{tail}\n".encode()
    assert plain_end(text, 0, 9, semicolon_ends_block=False) == (len(text) if plain else 0)
