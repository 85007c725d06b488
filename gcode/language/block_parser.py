"""Text of one line -> `ParsedBlock`s: letters and numbers, comments, slash, percent sign and semicolon."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace

from gcode.dialects import FANUC, Dialect
from gcode.dialects.macro_language import MacroLanguage
from gcode.errors import GcodeError, Place
from gcode.language.blocks import ParsedBlock, Word
from gcode.language.expressions import EvaluationError, Source, parse_operand, parse_sum
from gcode.language.statement_parser import parse_assignment, parse_statement

#: Longest line that is read, characters; controls stop at a few hundred.
MAX_LINE = 4096
#: Largest number of a word, in the program's units: far beyond any machine, far below where doubles lose a nanometre.
MAX_VALUE = 1e9

#: Every quantifier is possessive: nothing is tried twice, so that the time grows with the text and not faster.
_PLAIN_NUMBER = r"[+-]?+(?:\d++(?:\.\d*+)?+|\.\d++)"
#: A block of words alone: what most lines are.
_PLAIN = re.compile(rf"(?:[ \t]*+[A-Za-z][ \t]*+{_PLAIN_NUMBER})*+[ \t]*+", re.ASCII)
_PLAIN_WORD = re.compile(rf"[ \t]*+(([A-Za-z])[ \t]*+({_PLAIN_NUMBER}))", re.ASCII)
_CONTROL = re.compile(r"[\x00-\x08\x0a-\x1f\x7f]")
_NUMBER = re.compile(r"[+-]*[0-9.]*")
_GOOD_NUMBER = re.compile(_PLAIN_NUMBER, re.ASCII)
_KEYWORD = re.compile(r"IF|THEN|ELSE|WHILE|DO|END|GOTO|SUB|CALL|REPEAT|RETURN|BREAK|CONTINUE|POPEN|PCLOS|DPRNT|SETVN")
#: Signs that LinuxCNC uses as letters: of polar words, and of a spindle's number.
_SIGN_LETTERS = frozenset("@^$")
_DIGITS = frozenset("0123456789")
#: Signs that continue an expression; a slash after a word's number is left to block delete.
_OPERATORS = frozenset("+-*")
_CONTROL_NAMES = {"\x00": "NUL", "\r": "carriage return", "\x1a": "substitute (Ctrl-Z)"}


def parse_line(place: Place, dialect: Dialect = FANUC, *, block_delete: bool = False) -> ParsedBlock:
    """Parses a line that holds one block; see `parse_blocks`."""
    return parse_blocks(place, dialect, block_delete=block_delete)[0]


def parse_blocks(place: Place, dialect: Dialect = FANUC, *, block_delete: bool = False) -> tuple[ParsedBlock, ...]:
    """Parses one line.

    Letters may be lower case, and blanks may be anywhere or nowhere. The meaning of words is not considered.

    Args:
        place: the line (``place.text``, without its line end) and its location.
        dialect: determines the meaning of a semicolon, and the macro language.
        block_delete: True where the block delete switch is on; then a block with a leading slash is not read.

    Returns:
        The line's blocks, at least one: more where a semicolon ends a block and another one follows.

    Raises:
        GcodeError: for text that is not a block: control characters, an unclosed comment, a letter without a number,
            a number out of range, a broken expression or statement, and lines over `MAX_LINE` characters.
    """
    text = place.text
    if dialect.most_characters is not None and len(text) > dialect.most_characters:
        _check_buffer(place, dialect, dialect.most_characters)
    if len(text) <= MAX_LINE and _PLAIN.fullmatch(text) and not (dialect.macro.named and "O" in text.upper()):
        return (ParsedBlock(place=place, words=_plain_words(place)),)
    _check_characters(place)
    if text.lstrip().startswith("%"):
        return (_percent(place),)
    if text.lstrip().startswith("$"):
        column = text.index("$") + 1
        problem = f"{text.strip()[:24]} is a command to a controller, not a block of a program"
        raise GcodeError(_at(place, column), "unsupported-command", problem, "a letter and its number, or a comment")
    blocks = []
    for number, segment in enumerate(_segments(place, dialect)):
        if segment.characters or segment.comments or not number:
            blocks.append(_block(place, dialect, segment, block_delete=block_delete))
    return tuple(blocks)


def _plain_words(place: Place) -> tuple[Word, ...]:
    words = []
    for match in _PLAIN_WORD.finditer(place.text):
        _, letter, number = match.groups()
        value = float(number)
        if not abs(value) <= MAX_VALUE:
            raise _too_large(place, match.start(1), letter.upper() + number)
        words.append(Word(letter.upper(), value, letter.upper() + number, match.start(1) + 1))
    return tuple(words)


@dataclass(slots=True)
class _Segment:
    """A block's characters without blanks and comments, with their columns."""

    characters: list[str] = field(default_factory=list)
    columns: list[int] = field(default_factory=list)
    comments: list[str] = field(default_factory=list)


def _segments(place: Place, dialect: Dialect) -> list[_Segment]:
    """Splits a line at its semicolons, where they end blocks, and takes comments and blanks out."""
    text, position = place.text, 0
    if text.isascii() and "(" not in text and ";" not in text:
        characters = text.replace(" ", "").replace("\t", "").upper()
        columns = [column for column, character in enumerate(text, 1) if character not in " \t"]
        return [_Segment(list(characters), columns)]
    segments = [_Segment()]
    while position < len(text):
        character, current = text[position], segments[-1]
        if character == "(":
            end = text.find(")", position)
            inner = text.find("(", position + 1)
            if dialect.macro.named and 0 <= inner < end:
                raise GcodeError(_at(place, inner + 1), "nested-comment", "( inside a comment", "one comment at a time")
            if end < 0:
                raise GcodeError(_at(place, position + 1), "unclosed-comment", "a comment that is not closed", ")")
            current.comments.append(text[position + 1 : end])
            position = end
        elif character == ";" and not dialect.semicolon_ends_block:
            current.comments.append(text[position + 1 :])
            break
        elif character == ";":
            segments.append(_tail(place, position))
            if segments[-1].comments:
                break
        elif character not in " \t":
            current.characters.append(character.upper() if character.isascii() else character)
            current.columns.append(position + 1)
        position += 1
    return segments


def _tail(place: Place, position: int) -> _Segment:
    """The text after a semicolon that ends a block: the next block, or text that cannot be one."""
    tail = place.text[position + 1 :]
    first = tail.split(";", 1)[0].strip()
    if first and not _reads_as_block(first):
        return _Segment(comments=[tail.strip()])
    return _Segment()


def _reads_as_block(text: str) -> bool:
    """True for text whose first two characters could begin a block: a letter and its number, a variable, a keyword."""
    bare = re.sub(r"\([^)]*\)", "", text).replace(" ", "").replace("\t", "").upper()
    if not bare:
        return True
    return bool(
        re.match(r"/?\d?(?:,?[A-Z][-+]?[\d.#\[]|#|IF\[|WH(?:I|IL|ILE)?\[|GO(?:T|TO)?[\d#\[]|DO\d|END?\d|O<)", bare)
    )


def _block(place: Place, dialect: Dialect, segment: _Segment, *, block_delete: bool) -> ParsedBlock:
    source = Source("".join(segment.characters), tuple(segment.columns), dialect.macro)
    try:
        return _read(place, source, tuple(segment.comments), block_delete=block_delete)
    except EvaluationError as error:
        raise GcodeError(_at(place, error.column or 1), error.code, error.problem, error.expected) from None


def _read(place: Place, source: Source, comments: tuple[str, ...], *, block_delete: bool) -> ParsedBlock:
    words: list[Word] = []
    position, deleted = _head(place, source, words, block_delete=block_delete)
    if deleted:
        return ParsedBlock(place=place, deleted=True)
    parsed = parse_statement(source, position, lambda start: _then(place, source, start))
    if parsed is not None:
        statement, end = parsed
        if end < len(source.text):
            problem = f"{source.text[end:][:24]} after a statement"
            raise GcodeError(_at(place, source.column(end)), "text-after-statement", problem, "the end of the block")
        return ParsedBlock(place=place, words=tuple(words), statement=statement, comments=comments)
    return _words(place, source, position, words, comments)


def _then(place: Place, source: Source, start: int) -> ParsedBlock:
    """The block after THEN."""
    return _words(place, source, start, [], ())


def _head(place: Place, source: Source, words: list[Word], *, block_delete: bool) -> tuple[int, bool]:
    """A slash and a block number, in either order; whether the block is deleted."""
    position = 0
    while position < len(source.text):
        if source.at(position, "//"):
            break
        if source.at(position, "/"):
            position += 2 if source.text[position + 1 : position + 2] in _DIGITS else 1
            if block_delete:
                return position, True
        elif source.at(position, "N") and source.text[position + 1 : position + 2] in _DIGITS and not words:
            word, position = _word(place, source, position)
            words.append(word)
        else:
            break
    return position, False


def _words(place: Place, source: Source, position: int, words: list[Word], comments: tuple[str, ...]) -> ParsedBlock:
    assignments = []
    name: str | None = None
    while position < len(source.text):
        if source.at(position, "#") and source.language.name != "none":
            assignment, position = parse_assignment(source, position)
            assignments.append(assignment)
        elif source.at(position, "/"):
            problem = "block delete / inside a block"
            raise GcodeError(_at(place, source.column(position)), "block-delete-place", problem, "/ at its start")
        elif source.at(position, "<") or source.at(position, "O<"):
            start = position + source.text[position].count("O")
            end = source.text.find(">", start)
            if end < 0:
                raise _unexpected(place, source, position)
            name, position = source.text[start + 1 : end], end + 1
        else:
            word, position = _word(place, source, position)
            words.append(word)
    return ParsedBlock(
        place=place,
        words=tuple(words),
        assignments=tuple(assignments),
        comments=comments,
        name=name,
        plain=not assignments and all(word.expression is None for word in words),
    )


def _word(place: Place, source: Source, position: int) -> tuple[Word, int]:
    start = position
    if source.at(position, ","):
        position += 1
    if source.at(position, ":") and position == 0:
        letter = "O"
    else:
        letter = source.text[position : position + 1]
        if not (letter.isascii() and letter.isalpha()) and not (letter in _SIGN_LETTERS and source.language.named):
            raise _unexpected(place, source, start)
    letter = source.text[start:position] + letter
    position += 1
    number = _NUMBER.match(source.text, position)
    digits = number[0] if number else ""
    if source.language.named:
        digits, position = _one_sign(digits), position + max(len(digits) - len(_one_sign(digits)), 0)
    end = position + len(digits)
    if _GOOD_NUMBER.fullmatch(digits):
        value = float(digits)
        if not abs(value) <= MAX_VALUE:
            raise _too_large(place, source.column(start) - 1, letter + digits)
        return Word(letter, value, letter + digits, source.column(start)), end
    return _worked_out(place, source, start, letter, position, digits)


def _one_sign(digits: str) -> str:
    """Signs in a row as one."""
    bare = digits.lstrip("+-")
    signs = digits[: len(digits) - len(bare)]
    if len(signs) < 2 or not bare:
        return digits
    return ("-" if signs.count("-") % 2 else "") + bare


def _worked_out(place: Place, source: Source, start: int, letter: str, position: int, digits: str) -> tuple[Word, int]:
    """A word whose number is an expression."""
    following = source.text[position + len(digits) : position + len(digits) + 1]
    column = source.column(start)
    signed = digits in ("", "+", "-")
    if signed and source.language.name != "none" and (following in ("#", "[") or _function_follows(source, position)):
        expression, end = parse_operand(Source(source.text, source.columns, source.language, letter), position)
        if source.text[end : end + 1] in _OPERATORS:
            raise _without_brackets(place, source, position, letter)
        return Word(letter, 0.0, letter + expression.text, column, expression), end
    if signed:
        keyword = _KEYWORD.match(source.text, start)
        if following and following in "#[<=":
            raise _macro(place, column, f"{letter}{digits}{following}", source.language)
        if keyword:
            raise _macro(place, column, keyword[0], source.language)
        shown = f"{letter}{digits}"
        raise GcodeError(_at(place, column), "missing-number", f"{shown} has no number", f"{letter} and a number")
    problem = f"{letter}{digits} is not a number"
    raise GcodeError(_at(place, column), "bad-number", problem, "digits with at most one point")


def _without_brackets(place: Place, source: Source, position: int, letter: str) -> GcodeError:
    """The error for a word whose number is an expression with an operator outside of brackets."""
    expression, end = parse_sum(source, position)
    following = source.text[end : end + 1]
    if following and not following.isalpha() and following not in "#,/":
        return _unexpected(place, source, end)
    column = source.column(position)
    problem = f"{letter}{expression.text} is a computed number without brackets"
    return GcodeError(_at(place, column), "bad-expression", problem, f"{letter}[{expression.text}]")


def _function_follows(source: Source, position: int) -> bool:
    return bool(re.match(r"[+-]?[A-Z]{2,6}\[", source.text[position : position + 8]))


def _too_large(place: Place, index: int, shown: str) -> GcodeError:
    shown = shown if len(shown) <= 25 else shown[:25] + "..."
    problem = f"{shown} is out of range"
    return GcodeError(
        _at(place, index + 1), "number-too-large", problem, f"an absolute value of at most {MAX_VALUE:.0f}"
    )


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


def _check_buffer(place: Place, dialect: Dialect, most: int) -> None:
    """Refuses a block that does not fit into the control's line buffer, which has no blanks and comments in it."""
    text = re.sub(r"\([^)]*\)?|;.*|[ \t/]", "", place.text)
    if len(text) > most:
        problem = (
            f"the block has {len(text)} characters, which the line buffer of a {dialect.name} control does not hold"
        )
        short = replace(place, text=place.text[:80] + "...", column=most + 1)
        raise GcodeError(short, "line-too-long", problem, f"at most {most} characters without blanks and comments")


def _unexpected(place: Place, source: Source, position: int) -> GcodeError:
    """The error for a character that begins no word and no comment."""
    column = source.column(position)
    character = place.text[column - 1]
    if character in "#[=<":
        return _macro(place, column, character, source.language)
    problem = f"unexpected {character!r}"
    if re.match(r"\d,\d", place.text[max(column - 2, 0) :]):
        return GcodeError(
            _at(place, column), "unexpected-character", problem, "a decimal point, which controls require"
        )
    return GcodeError(_at(place, column), "unexpected-character", problem, "a letter and its number, or a comment")


def _macro(place: Place, column: int, shown: str, language: MacroLanguage) -> GcodeError:
    if language.name != "none":
        return GcodeError(_at(place, column), "bad-statement", f"{shown} is not understood", "a word or a statement")
    problem = f"{shown} is macro language (variables, expressions, jumps), which is not supported"
    return GcodeError(_at(place, column), "unsupported-macro", problem, "a plain number after each letter")


def _at(place: Place, column: int) -> Place:
    return replace(place, column=column)
