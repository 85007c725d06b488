"""Text of one line -> `ParsedBlock`: a lexer that knows letters, numbers, comments, slash and percent, and no more."""

from __future__ import annotations

import re
from dataclasses import replace

from gcode.blocks import ParsedBlock, Word
from gcode.dialects import FANUC, Dialect
from gcode.errors import GcodeError, Place

#: Longest line that is read, characters; controls stop at a few hundred.
MAX_LINE = 4096
#: Largest number of a word, in the program's units: far beyond any machine, far below where doubles lose a nanometre.
MAX_VALUE = 1e9

_TOKEN = re.compile(
    r"[ \t]*(?:(?P<letter>,?[ \t]*[A-Za-z])[ \t]*(?P<number>[+-]?[0-9. \t]*)"
    r"|\((?P<comment>[^)]*)\)|;(?P<tail>.*)|/(?P<slash>[1-9]?))"
)
_CONTROL = re.compile(r"[\x00-\x08\x0a-\x1f\x7f]")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)", re.ASCII)
_WORDS_ONLY = re.compile(r"(?:[ \t]*[A-Za-z][ \t]*[+-]?[ \t]*[0-9.][0-9. \t]*)+")
_KEYWORD = re.compile(
    r"IF|THEN|ELSE|WHILE|DO|END|GOTO|SUB|CALL|REPEAT|RETURN|BREAK|CONTINUE|POPEN|PCLOS|DPRNT|BPRNT|SETVN", re.IGNORECASE
)
_BLANKS = str.maketrans("", "", " \t")
_REPEATABLE = frozenset("GM")
_CONTROL_NAMES = {"\x00": "NUL", "\r": "carriage return", "\x1a": "substitute (Ctrl-Z)"}


def parse_line(place: Place, dialect: Dialect = FANUC, *, block_delete: bool = False) -> ParsedBlock:
    """Takes one line apart.

    Letters may be lower case, and blanks may stand anywhere or nowhere. Nothing is said about what the words mean.

    Args:
        place: the line (``place.text``, without its line end) and where it stands.
        dialect: decides what a semicolon is.
        block_delete: True where the block delete switch is on; then a line with a leading slash is not read.

    Raises:
        GcodeError: for text that is no block: control characters, an unclosed comment, a letter without a number,
            a number out of range, a letter given twice, macro language, and lines over `MAX_LINE` characters.
    """
    text = place.text
    _check_characters(place)
    if text.lstrip().startswith("%"):
        return _percent(place)
    words: list[Word] = []
    comments: list[str] = []
    position, stop = 0, len(text.rstrip())
    while position < stop:
        match = _TOKEN.match(text, position)
        if match is None:
            raise _unexpected(place, position)
        kind = match.lastgroup
        if kind == "number":
            _append(words, _word(place, match), place)
        elif kind == "slash":
            _check_slash(place, match.start("slash") - 1, words)
            if block_delete:
                return ParsedBlock(place=place, deleted=True)
        else:
            comments.append(match[kind] if kind else "")
            if kind == "tail" and dialect.semicolon_ends_block:
                _check_tail(place, match)
        position = match.end()
    return ParsedBlock(place=place, words=tuple(words), comments=tuple(comments))


def _word(place: Place, match: re.Match[str]) -> Word:
    column = match.start("letter") + 1
    letter = match["letter"].translate(_BLANKS).upper()
    number = match["number"].translate(_BLANKS)
    if not _NUMBER.fullmatch(number):
        raise _bad_number(place, match, letter, number)
    value = float(number)
    if not abs(value) <= MAX_VALUE:
        shown = number if len(number) <= 24 else number[:24] + "..."
        problem = f"{letter}{shown} is out of range"
        raise GcodeError(_at(place, column), "number-too-large", problem, f"at most {MAX_VALUE:.0f} in size")
    return Word(letter, value, letter + number, column)


def _bad_number(place: Place, match: re.Match[str], letter: str, number: str) -> GcodeError:
    """The error for a letter whose number is missing, broken, or a piece of macro language."""
    following = place.text[match.end() : match.end() + 1]
    column = match.start("letter") + 1
    keyword = _KEYWORD.match(place.text, match.start("letter"))
    if number in ("", "+", "-"):
        if following and following in "#[<=":
            return _macro(place, column, f"{letter}{number}{following}")
        if keyword:
            return _macro(place, column, keyword[0].upper())
        shown = f"{letter}{number}"
        return GcodeError(_at(place, column), "missing-number", f"{shown} has no number", f"{letter} and a number")
    return GcodeError(
        _at(place, column), "bad-number", f"{letter}{number} is no number", "digits with at most one point"
    )


def _append(words: list[Word], word: Word, place: Place) -> None:
    if word.letter not in _REPEATABLE:
        for other in words:
            if other.letter == word.letter:
                problem = f"{word.letter} is given twice: {other.text} and {word.text}"
                raise GcodeError(_at(place, word.column), "repeated-word", problem, f"one {word.letter} in a block")
    words.append(word)


def _percent(place: Place) -> ParsedBlock:
    column = place.text.index("%") + 1
    rest = re.sub(r"\([^)]*\)|;.*", "", place.text[column:]).strip()
    if rest:
        raise GcodeError(_at(place, column), "bad-percent", f"text after %: {rest}", "% alone in its line")
    return ParsedBlock(place=place, percent=True)


def _check_characters(place: Place) -> None:
    if len(place.text) > MAX_LINE:
        short = replace(place, text=place.text[:80] + "...")
        raise GcodeError(short, "line-too-long", "the line is too long", f"at most {MAX_LINE} characters")
    found = _CONTROL.search(place.text)
    if found:
        character = found[0]
        name = _CONTROL_NAMES.get(character, "control character")
        problem = f"{name} (0x{ord(character):02x}) in the line"
        raise GcodeError(_at(place, found.start() + 1), "control-character", problem, "printable text")


def _check_slash(place: Place, index: int, words: list[Word]) -> None:
    if any(word.letter != "N" for word in words):
        problem = "block delete / inside a block"
        raise GcodeError(_at(place, index + 1), "block-delete-place", problem, "/ at the start of the block")


def _check_tail(place: Place, match: re.Match[str]) -> None:
    """Refuses words after a semicolon that ends the block: as a comment they would be skipped in silence."""
    if _WORDS_ONLY.fullmatch(match["tail"].strip()):
        problem = f"words after the end of the block: {match['tail'].strip()}"
        raise GcodeError(_at(place, match.start("tail") + 1), "text-after-semicolon", problem, "one block in a line")


def _unexpected(place: Place, position: int) -> GcodeError:
    """The error for a character that begins no word and no comment."""
    rest = place.text[position:].lstrip()
    column = len(place.text) - len(rest) + 1
    if rest[0] == "(":
        return GcodeError(_at(place, column), "unclosed-comment", "a comment without its end", ") in the same line")
    if rest[0] in "#[=<":
        return _macro(place, column, rest[0])
    problem = f"unexpected {rest[0]!r}"
    return GcodeError(_at(place, column), "unexpected-character", problem, "a letter and its number, or a comment")


def _macro(place: Place, column: int, shown: str) -> GcodeError:
    problem = f"{shown} is macro language (variables, expressions, jumps), which is not supported"
    return GcodeError(_at(place, column), "unsupported-macro", problem, "a plain number after each letter")


def _at(place: Place, column: int) -> Place:
    return replace(place, column=column)
