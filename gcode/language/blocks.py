"""One parsed block of a program: its words with their columns, its assignments, its statement of the macro language.

Data only; nothing is interpreted yet. Statements come from two languages: FANUC's custom macro B (assignments, IF,
WHILE, GOTO) and LinuxCNC's O-words.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any, NamedTuple, TypeAlias

from gcode.dialects.macro_language import rounded
from gcode.errors import GcodeError, Place
from gcode.language.expressions import EvaluationError, Expression, Scope, Variable


class Word(NamedTuple):
    """One word of a block: an address letter and its number.

    Attributes:
        letter: address letter in upper case; with a comma before it for ``,C`` and ``,R``.
        value: the number, in the program's units; 0 where `expression` gives it.
        text: the word in upper case and without blanks, as error messages name it.
        column: column of the letter in the line, counted from 1.
        expression: computes the number; None where it is written.
    """

    letter: str
    value: float
    text: str
    column: int
    expression: Expression | None = None

    @property
    def has_point(self) -> bool:
        """True where the number was written with a decimal point, or computed."""
        return "." in self.text or "#" in self.text or "[" in self.text


@dataclass(frozen=True, slots=True, kw_only=True)
class Assignment:
    """``#i = expression``."""

    target: Variable
    value: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class Goto:
    """``GOTO n``, or ``IF [condition] GOTO n``; ``condition`` None for the unconditional one."""

    target: Expression
    condition: Expression | None = None
    column: int = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class IfThen:
    """``IF [condition] THEN statement``: an assignment, or a block of words."""

    condition: Expression
    then: ParsedBlock
    column: int = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class While:
    """``WHILE [condition] DO m``; ``DO m`` alone (``condition`` None) loops until something jumps out."""

    label: int
    condition: Expression | None = None
    column: int = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class End:
    """``END m``."""

    label: int
    column: int = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Output:
    """``POPEN``, ``DPRNT[...]``, ``BPRNT[...]``, ``PCLOS``, ``SETVN``: understood, without any effect on motion."""

    keyword: str
    text: str
    column: int = 1


class OKeyword(Enum):
    """Keyword of an O-word line."""

    SUB = "sub"
    ENDSUB = "endsub"
    CALL = "call"
    RETURN = "return"
    IF = "if"
    ELSEIF = "elseif"
    ELSE = "else"
    ENDIF = "endif"
    WHILE = "while"
    ENDWHILE = "endwhile"
    DO = "do"
    BREAK = "break"
    CONTINUE = "continue"
    REPEAT = "repeat"
    ENDREPEAT = "endrepeat"


@dataclass(frozen=True, slots=True, kw_only=True)
class OWord:
    """``o<label> keyword [argument]...`` of LinuxCNC.

    Attributes:
        label: canonical label: the number as text (``100``) or the name in lower case; None where ``label_value``
            computes it (``o#1 call``).
        label_value: expression that gives a computed label.
        keyword: the keyword.
        arguments: bracketed expressions after the keyword: a condition, a count, arguments of a call, results.
        column: column of the O, counted from 1.
    """

    label: str | None
    keyword: OKeyword
    label_value: Expression | None = None
    arguments: tuple[Expression, ...] = ()
    column: int = 1


Statement: TypeAlias = Goto | IfThen | While | End | Output | OWord


@dataclass(frozen=True, slots=True, kw_only=True)
class ParsedBlock:
    """One parsed block of a program.

    Attributes:
        place: file, line and text of the block; its column is 1.
        words: the words in their order, N and O included.
        assignments: ``#i = ...`` of the block, which take effect once all its words were read.
        statement: its statement of the macro language, None for a block of words.
        comments: texts of the comments without their brackets or semicolon.
        deleted: True where a block delete slash was obeyed; then ``words`` is empty.
        percent: True for a line that is a percent sign.
        name: ``<NAME>`` of a program, after O or M98.
        plain: True where the words are all plain numbers.
    """

    place: Place
    words: tuple[Word, ...] = ()
    assignments: tuple[Assignment, ...] = ()
    statement: Statement | None = None
    comments: tuple[str, ...] = ()
    deleted: bool = False
    percent: bool = False
    name: str | None = None
    plain: bool = True

    def place_of(self, word: Word | None) -> Place:
        """Location of one word of this block, or of the block itself for None."""
        return self.place if word is None else replace(self.place, column=word.column)

    def place_at(self, column: int) -> Place:
        """Location of a column of this block."""
        return replace(self.place, column=column)

    def error(self, word: Word | None, code: str, problem: str, expected: str = "") -> GcodeError:
        """The error that refuses this block because of `word` (None: because of the block as a whole)."""
        return GcodeError(self.place_of(word), code, problem, expected)

    def error_at(self, column: int, code: str, problem: str, expected: str = "") -> GcodeError:
        """The error that refuses this block because of the text at `column`."""
        return GcodeError(self.place_at(column), code, problem, expected)

    def evaluated(self, scope: Scope, *, exact: bool = False) -> ParsedBlock:
        """The block with plain numbers; words whose value is vacant are omitted.

        Args:
            scope: values of variables, and to what the numbers of each address are rounded.
            exact: True where nothing is rounded.

        Raises:
            GcodeError: for a word whose expression has no value.
        """
        words: list[Word] = []
        for word in self.words:
            if word.expression is None:
                words.append(word)
                continue
            value = self.value_of(word.expression, scope)
            if value is not None:
                steps = 0 if exact else scope.steps(word.letter)
                words.append(Word(word.letter, rounded(value, steps) if steps else value, word.text, word.column))
        return ParsedBlock(
            place=self.place,
            words=tuple(words),
            assignments=self.assignments,
            statement=self.statement,
            comments=self.comments,
            deleted=self.deleted,
            percent=self.percent,
            name=self.name,
        )

    def value_of(self, expression: Expression, scope: Scope) -> float | None:
        """Value of an expression of this block.

        Raises:
            GcodeError: where it has none.
        """
        result: float | None = self.guarded(expression.evaluate, scope)
        return result

    def guarded(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """The result of a function whose `EvaluationError` becomes an error of this block."""
        try:
            return function(*arguments)
        except EvaluationError as error:
            raise self.error_at(error.column or 1, error.code, error.problem, error.expected) from None
