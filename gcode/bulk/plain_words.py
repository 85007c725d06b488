"""Many lines of plain words at once: a regular expression finds them, array arithmetic reads their numbers.

A plain line may begin with N and holds words G0 to G3, X, Y, Z, I, J, K, R, F, S, M3 to M5, M7 to M9 with plain numbers
in any order, comments between them, and nothing else; it may be empty.
The numbers are the doubles that `float` gives for their text, to the last bit.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

_BLANKS = rb"[ \t]{0,9}+"
#: Nine digits before the point stay below the largest number that a word may have.
_UNSIGNED = rb"(?:[0-9]{1,9}+(?:\.[0-9]{0,30}+)?+|\.[0-9]{1,30}+)"
_NUMBER = rb"[Nn]" + _BLANKS + rb"[0-9]{1,9}+(?!\.)" + _BLANKS
#: A comment that ends the program (``(abort,...)``) is left to the interpreter.
_NO_ABORT = rb"(?![ \t]*+[Aa][Bb][Oo][Rr][Tt])"
_WORDS = (
    rb"[XYZIJKRxyzijkr]" + _BLANKS + rb"[+-]?+" + _UNSIGNED,
    rb"[Gg]" + _BLANKS + rb"(?:0[0-3]?+|[1-3])(?![0-9.])",
    rb"[FfSs]" + _BLANKS + rb"\+?+" + _UNSIGNED,
    rb"[Mm]" + _BLANKS + rb"0?+[345789](?![0-9.])",
    rb"\(" + _NO_ABORT + rb"[\t -'*-~]{0,200}+\)",
)
#: The end of a line by the meaning of a semicolon: it ends the block, or it starts a comment.
_LINE_ENDS = {True: rb"(?:;[ \t]{0,9}+)?+\r?+\n", False: rb"(?:;" + _NO_ABORT + rb"[\t -~]{0,200}+)?+\r?+\n"}
#: Every quantifier is possessive, so that nothing is tried twice and the time grows with the text and not faster.
_LINE = _BLANKS + rb"(?:" + _NUMBER + rb")?+(?:(?:" + rb"|".join(_WORDS) + rb")" + _BLANKS + rb")*+"
_COMMENT = re.compile(rb"\([^)]*+\)|;[^\n]*+")

#: A whole number of up to this many digits is exact as a double, and so is the power of ten that divides it.
_EXACT_DIGITS = 15
_POWERS = np.array([float(10**k) for k in range(64)])
#: Counts of digits, letters and line ends, packed so that one running sum counts all three.
_FIELD = 21
_MASK = (1 << _FIELD) - 1
_COUNTS = np.zeros(256, dtype=np.int64)
_COUNTS[ord("0") : ord("9") + 1] = 1
_COUNTS[ord("A") : ord("Z") + 1] = _COUNTS[ord("a") : ord("z") + 1] = 1 << _FIELD
_COUNTS[ord("\n")] = 1 << 2 * _FIELD
#: Clears the bit that distinguishes a lower-case letter from a capital.
_CAPITAL = np.uint8(0xDF)
#: Longest text that the packed counts hold.
MAX_BYTES = _MASK
#: Text that is searched for a number of lines, and at least: more than the longest line has.
_BYTES_PER_LINE, _LEAST_BYTES = 64, 8192


@dataclass(frozen=True, slots=True, eq=False)
class WordArrays:
    """The words of consecutive plain lines, in their order.

    Attributes:
        letter: address letters, capital, as character codes.
        line: line of each, counted from 0.
        value: numbers, in the program's units.
        pointed: True where the number was written with a decimal point.
    """

    letter: NDArray[np.uint8]
    line: NDArray[np.int64]
    value: NDArray[np.float64]
    pointed: NDArray[np.bool_]


def plain_end(buffer: bytes, offset: int, max_lines: int, *, semicolon_ends_block: bool = True) -> int:
    """Finds the end of the plain lines that begin at `offset`: after the line end of the last of at most `max_lines`.

    A last line without a line end is not one of them. Where lines are long there may be fewer than there could be: a
    further call finds the rest.

    Args:
        buffer: the program's text.
        offset: where a line begins.
        max_lines: how many lines to take at most.
        semicolon_ends_block: whether a semicolon ends a block, else it starts a comment.
    """
    if max_lines < 1:
        return offset
    most_bytes = min(MAX_BYTES, max(_LEAST_BYTES, _BYTES_PER_LINE * max_lines))
    match = _lines(semicolon_ends_block).match(buffer, offset, min(len(buffer), offset + most_bytes))
    end = offset if match is None else buffer.rfind(b"\n", offset, match.end()) + 1
    if buffer.count(b"\n", offset, end) > max_lines:
        text = np.frombuffer(buffer, np.uint8, end - offset, offset)
        end = offset + int(np.flatnonzero(text == ord("\n"))[max_lines - 1]) + 1
    return end


@lru_cache(maxsize=2)
def _lines(semicolon_ends_block: bool) -> re.Pattern[bytes]:
    return re.compile(rb"(?:" + _LINE + _LINE_ENDS[semicolon_ends_block] + rb")++")


def read_words(buffer: bytes, offset: int, end: int) -> WordArrays:
    """Takes plain lines apart.

    Args:
        buffer: the program's text.
        offset: where the first line begins.
        end: after the end of the last line, as `plain_end` returns it.
    """
    lines = buffer[offset:end]
    if b"(" in lines or b";" in lines:
        lines = _COMMENT.sub(lambda comment: b" " * len(comment[0]), lines)
    text = np.frombuffer(lines, np.uint8)
    seen = _COUNTS[text].cumsum()
    at = np.flatnonzero(text >= ord("A"))
    before = seen[at]
    digits = text - np.uint8(ord("0"))
    mantissa, ends = _whole_numbers(digits[digits < 10].astype(np.float64), before & _MASK)
    points = seen[text == ord(".")]
    decimals = np.zeros(at.size, dtype=np.int64)
    decimals_of = (points >> _FIELD & _MASK) - 1
    decimals[decimals_of] = ends[decimals_of] - (points & _MASK)
    value = mantissa / _POWERS[decimals]
    minus = (seen[text == ord("-")] >> _FIELD & _MASK) - 1
    value[minus] = -value[minus]
    _read_long(lines, at, np.diff(ends, prepend=0), value)
    pointed = np.zeros(at.size, dtype=np.bool_)
    pointed[decimals_of] = True
    return WordArrays(text[at] & _CAPITAL, before >> 2 * _FIELD, value, pointed)


def _whole_numbers(
    digits: NDArray[np.float64], begins: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The digits of each word as a whole number, and how many digits there are up to its end."""
    ends = np.append(begins[1:], digits.size)[: begins.size]
    if not begins.size:
        return np.empty(0), ends
    places = np.repeat(ends - 1, ends - begins) - np.arange(digits.size)
    return np.add.reduceat(_POWERS[places] * digits, begins), ends


def _read_long(lines: bytes, at: NDArray[np.intp], counts: NDArray[np.int64], value: NDArray[np.float64]) -> None:
    """Reads the numbers with more digits than exact arithmetic has room for, one by one, into `value`."""
    for index in np.flatnonzero(counts > _EXACT_DIGITS).tolist():
        stop = int(at[index + 1]) if index + 1 < at.size else len(lines)
        word = lines[int(at[index]) + 1 : stop]
        value[index] = float(word.split(b"\n", 1)[0])
