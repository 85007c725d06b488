"""What the parser hands on: one block of a program as words with their places, nothing interpreted yet."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

from gcode.errors import GcodeError, Place


class Word(NamedTuple):
    """One word of a block: an address letter and its number.

    Attributes:
        letter: address letter in upper case; with a comma before it for ``,C`` and ``,R``.
        value: the number, in the program's units.
        text: the word in upper case and without blanks, as error messages name it.
        column: column of the letter in the line, counted from 1.
    """

    letter: str
    value: float
    text: str
    column: int

    @property
    def has_point(self) -> bool:
        """True where the number was written with a decimal point."""
        return "." in self.text


@dataclass(frozen=True, slots=True, kw_only=True)
class ParsedBlock:
    """One line of a program, taken apart.

    Attributes:
        place: file, line and text of the block; its column is 1.
        words: the words in their order, N and O included. A letter other than G and M stands once.
        comments: texts of the comments without their brackets or semicolon.
        deleted: True where a block delete slash was obeyed; then ``words`` is empty.
        percent: True for a line that is a percent sign.
    """

    place: Place
    words: tuple[Word, ...] = ()
    comments: tuple[str, ...] = ()
    deleted: bool = False
    percent: bool = False

    def place_of(self, word: Word | None) -> Place:
        """Place of one word of this block, or of the block itself for None."""
        return self.place if word is None else replace(self.place, column=word.column)

    def error(self, word: Word | None, code: str, problem: str, expected: str = "") -> GcodeError:
        """The error that refuses this block because of `word` (None: because of the block as a whole)."""
        return GcodeError(self.place_of(word), code, problem, expected)
