"""Expressions of the macro languages: parsed once into functions, evaluated against a scope of variables."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from gcode.dialects.macro_language import MacroLanguage, MathError, rounded

#: Brackets inside each other; no control takes a tenth of it.
MAX_DEPTH = 60
#: Whole numbers of up to this many digits are exact as doubles.
_EXACT_DIGITS = 15
_NUMBER = re.compile(r"\d++(?:\.\d*+)?+|\.\d++", re.ASCII)
_NAME = re.compile(r"[A-Z]+")
_OPERATOR = re.compile(r"\*\*|[-+*/]|MOD?|AND?|XOR?|OR|EQ|NE|GT|GE|LT|LE")
#: Operators by their abbreviations.
_ABBREVIATED = {"MO": "MOD", "AN": "AND", "XO": "XOR"}

Function: TypeAlias = Callable[["Scope"], "float | None"]
Step: TypeAlias = Callable[["float | None", "Scope"], float]


class EvaluationError(Exception):
    """An expression that cannot be read or has no value.

    Attributes:
        code: short stable name of the kind of error.
        problem: the problem.
        expected: a correct alternative.
        column: column in the line, counted from 1; 0 where it is not known.
    """

    def __init__(self, code: str, problem: str, expected: str = "", column: int = 0) -> None:
        self.code = code
        self.problem = problem
        self.expected = expected
        self.column = column
        super().__init__(problem)


class Scope(Protocol):
    """Where an expression's variables are looked up."""

    def number(self, index: int) -> float | None:
        """Value of #index, None where it is vacant."""

    def named(self, name: str) -> float | None:
        """Value of #<name>."""

    def exists(self, name: str) -> bool:
        """True where #<name> was set."""

    def has(self, index: int) -> bool:
        """True where there is a variable #index."""

    def steps(self, letter: str) -> int:
        """Least input increments of an address that make one unit, 0 where its numbers are not rounded."""


@dataclass(frozen=True, slots=True)
class Expression:
    """An expression, ready to be evaluated.

    Attributes:
        text: as written, in upper case and without blanks.
        column: where it begins, counted from 1.
        function: gives its value in a scope.
        whole: the whole number that it is, None for another number and anything to compute.
    """

    text: str
    column: int
    function: Function
    whole: int | None = None

    def evaluate(self, scope: Scope) -> float | None:
        """The value, None for vacant.

        Raises:
            EvaluationError: where it has none, or one that is not a finite number.
        """
        value = self.function(scope)
        if value is not None and not math.isfinite(value):
            raise EvaluationError("bad-value", f"{self.text} is out of range", "a finite number", self.column)
        return value


@dataclass(frozen=True, slots=True, kw_only=True)
class Variable:
    """A variable as a target or operand: ``#101``, ``#[#1+2]`` (``index``), or ``#<name>`` (``name``).

    Attributes:
        index: the number, or what computes it; None for a named one.
        name: name in lower case and without blanks, None for a numbered one. A leading underscore makes it global.
        column: column of the ``#``, counted from 1.
    """

    index: Expression | None = None
    name: str | None = None
    column: int = 1


@dataclass(frozen=True, slots=True)
class Source:
    """A line without its blanks and comments, in upper case, and the column of each character left.

    Attributes:
        text: the characters.
        columns: column of each.
        language: macro language.
        letter: address whose number is being read, empty outside of words.
    """

    text: str
    columns: tuple[int, ...]
    language: MacroLanguage
    letter: str = ""

    def column(self, position: int) -> int:
        """Column of a character, or of the end."""
        return self.columns[position] if position < len(self.columns) else (self.columns[-1] + 1 if self.columns else 1)

    def at(self, position: int, token: str) -> bool:
        """True where `token` begins at this position."""
        return self.text.startswith(token, position)

    def error(self, position: int, code: str, problem: str, expected: str = "") -> EvaluationError:
        """An error at a character."""
        return EvaluationError(code, problem, expected, self.column(position))


def parse_operand(source: Source, position: int, depth: int = 0) -> tuple[Expression, int]:
    """Reads a number, variable, bracketed expression or function, with its sign.

    Returns:
        The expression, and the position after it.

    Raises:
        EvaluationError: where there is none.
    """
    function, end = _signed(source, position, depth)
    text = source.text[position:end]
    whole = int(text) if text.isdecimal() and text.isascii() and len(text) <= _EXACT_DIGITS else None
    return Expression(text, source.column(position), function, whole), end


def parse_sum(source: Source, position: int) -> tuple[Expression, int]:
    """Reads operands and the operators between them, without brackets around them, as far as they go.

    Returns:
        The expression, and the position after it.

    Raises:
        EvaluationError: where there is none.
    """
    function, end = _binary(source, position, 0, 1)
    return Expression(source.text[position:end], source.column(position), function), end


def _signed(source: Source, position: int, depth: int) -> tuple[Function, int]:
    if depth > MAX_DEPTH:
        raise source.error(position, "nesting", f"more than {MAX_DEPTH} brackets inside each other", "fewer")
    character = source.text[position : position + 1]
    if character in ("+", "-") and character:
        function, end = _signed(source, position + 1, depth + 1)
        return (_negated(function) if character == "-" else function), end
    return _operand(source, position, depth)


def _negated(function: Function) -> Function:
    def negative(scope: Scope) -> float | None:
        value = function(scope)
        return None if value is None else -value

    return negative


def _operand(source: Source, position: int, depth: int) -> tuple[Function, int]:
    number = _NUMBER.match(source.text, position)
    if number:
        value = float(number[0])
        return (lambda _scope: value), number.end()
    if source.at(position, "#"):
        variable, end = parse_variable(source, position, depth + 1)
        return _reading(variable), end
    if source.at(position, "["):
        return _bracket(source, position, depth)
    name = _NAME.match(source.text, position)
    if name:
        return _call(source, position, name[0], depth)
    shown = source.text[position : position + 1] or "the end of the block"
    expected = "a number, a variable #, a bracket [ or a function"
    raise source.error(position, "bad-expression", f"{shown} where a value is expected", expected)


def parse_variable(source: Source, position: int, depth: int = 0) -> tuple[Variable, int]:
    """Reads a variable: ``#`` and a number, another variable, a bracketed expression, or a name in <>."""
    column = source.column(position)
    if source.at(position + 1, "<"):
        end = source.text.find(">", position)
        if end < 0 or not source.language.named:
            raise source.error(position, "bad-variable", "#< without a name this control knows", "# and a number")
        return Variable(name=source.text[position + 2 : end].lower(), column=column), end + 1
    index, end = parse_operand(source, position + 1, depth + 1)
    return Variable(index=index, column=column), end


def _reading(variable: Variable) -> Function:
    if variable.name is not None:
        name = variable.name
        return lambda scope: _located(scope.named, name, variable.column)
    index = variable.index
    if index is None:
        raise ValueError("a variable needs an index or a name")

    def read(scope: Scope) -> float | None:
        return _located(scope.number, variable_number(index, scope), variable.column)

    return read


def _located(function: Callable[..., float | None], argument: object, column: int) -> float | None:
    try:
        return function(argument)
    except EvaluationError as error:
        error.column = error.column or column
        raise


def variable_number(index: Expression, scope: Scope) -> int:
    """The number that an index names.

    Raises:
        EvaluationError: where it is none.
    """
    if index.whole is not None:
        return index.whole
    value = index.evaluate(scope)
    if value is None or abs(value - round(value)) > 1e-4 or value < 0.0:
        shown = "vacant" if value is None else f"{value:g}"
        raise EvaluationError("bad-variable", f"#{shown}", "the number of a variable", index.column)
    return round(value)


def _bracket(source: Source, position: int, depth: int) -> tuple[Function, int]:
    function, end = _binary(source, position + 1, 0, depth + 1)
    if not source.at(end, "]"):
        _closing(source, position, end)
    return function, end + 1


def _binary(source: Source, position: int, least: int, depth: int) -> tuple[Function, int]:
    """Precedence climbing over the language's table; all operators bind to the left."""
    left, position = _signed(source, position, depth)
    steps: list[Step] = []
    while True:
        match = _OPERATOR.match(source.text, position)
        name = match[0] if match else ""
        if name in _ABBREVIATED and source.language.abbreviates:
            name = _ABBREVIATED[name]
        rank = source.language.operators.get(name)
        if match is None or rank is None or rank[0] < least:
            return (_chained(left, tuple(steps)) if steps else left), position
        right, end = _binary(source, match.end(), rank[0] + 1, depth + 1)
        steps.append(_applied(source, position, name, right))
        position = end


def _chained(left: Function, steps: tuple[Step, ...]) -> Function:
    """Operators one after another, in a loop: a line holds more of them than calls may be nested."""

    def value(scope: Scope) -> float | None:
        result = left(scope)
        for step in steps:
            result = step(result, scope)
        return result

    return value


def _applied(source: Source, position: int, name: str, right: Function) -> Step:
    """An operator and its right operand, to be applied to the left operand."""
    operator, column = source.language.operators[name][1], source.column(position)
    compares_vacant = source.language.vacant and name in source.language.comparisons

    def apply(a: float | None, scope: Scope) -> float:
        b = right(scope)
        if compares_vacant and (a is None or b is None):
            return float((a is b) == (name == "EQ"))
        try:
            return operator(a or 0.0, b or 0.0)
        except MathError as error:
            raise EvaluationError("bad-operation", error.problem, error.expected, column) from None
        except (OverflowError, ValueError):
            raise EvaluationError("bad-operation", f"{name} overflows", "a finite number", column) from None

    return apply


def _call(source: Source, position: int, letters: str, depth: int) -> tuple[Function, int]:
    language = source.language
    name = _function_name(language, letters)
    bracket = position + len(letters)
    if name is None or not source.at(bracket, "["):
        if letters in language.refused:
            raise source.error(position, "unsupported-function", f"{letters} is not supported")
        known = ", ".join(sorted(language.functions)) or "none"
        raise source.error(
            position, "unknown-function", f"{letters} is not a function", f"one of {known}, and a bracket"
        )
    if name == "EXISTS":
        return _existence(source, bracket)
    argument, end = _binary(source, bracket + 1, 0, depth + 1)
    if source.at(end, ",") and name in language.pairs:
        other, end = _binary(source, end + 1, 0, depth + 1)
        _closing(source, bracket, end)
        return _of_two(source, position, language.pairs[name], argument, other), end + 1
    _closing(source, bracket, end)
    if name == "ATAN" and source.at(end + 1, "/["):
        other, behind = _bracket(source, end + 2, depth + 1)
        if language.arctangent is None:
            raise source.error(position, "unknown-function", "ATAN")
        return _of_two(source, position, language.arctangent, argument, other), behind
    if name not in language.functions:
        expected = "ATAN[a]/[b]" if name == "ATAN" else f"{name}[a,b]"
        raise source.error(position, "bad-expression", f"{name} with one argument", expected)
    return _of_one(source, position, name, argument), end + 1


def _function_name(language: MacroLanguage, letters: str) -> str | None:
    names = [*language.functions, *language.pairs, *(["EXISTS"] if language.named else [])]
    if language.arctangent is not None:
        names.append("ATAN")
    if letters in names:
        return letters
    if language.abbreviates:
        return next((name for name in names if len(letters) >= 2 and name.startswith(letters)), _ALIASES.get(letters))
    return None


#: Other spellings of functions.
_ALIASES = {"SQR": "SQRT", "RND": "ROUND", "ATN": "ATAN"}


def _closing(source: Source, bracket: int, end: int) -> None:
    if source.at(end, "]"):
        return
    if end < len(source.text):
        problem = f"unexpected {source.text[end]!r} inside brackets"
        raise source.error(end, "bad-expression", problem, "an operator or ]")
    raise source.error(bracket, "bad-expression", "[ is not closed before the end of the block", "]")


def _existence(source: Source, bracket: int) -> tuple[Function, int]:
    variable, end = parse_variable(source, bracket + 1)
    _closing(source, bracket, end)
    name = variable.name
    if name is None:
        index = variable.index
        if index is None:
            raise ValueError("a variable needs an index or a name")
        return (lambda scope: float(scope.has(variable_number(index, scope)))), end + 1
    return (lambda scope: float(scope.exists(name))), end + 1


def _of_one(source: Source, position: int, name: str, argument: Function) -> Function:
    function, column = source.language.functions[name], source.column(position)
    letter = source.letter if name == "ROUND" else ""

    def value(scope: Scope) -> float:
        try:
            steps = scope.steps(letter) if letter else 0
            return rounded(argument(scope) or 0.0, steps) if steps else function(argument(scope) or 0.0)
        except MathError as error:
            raise EvaluationError("bad-operation", error.problem, error.expected, column) from None
        except (OverflowError, ValueError):
            raise EvaluationError("bad-operation", f"{name} out of range", "a finite number", column) from None

    return value


def _of_two(
    source: Source, position: int, function: Callable[[float, float], float], first: Function, second: Function
) -> Function:
    column = source.column(position)

    def value(scope: Scope) -> float:
        try:
            return function(first(scope) or 0.0, second(scope) or 0.0)
        except MathError as error:
            raise EvaluationError("bad-operation", error.problem, error.expected, column) from None

    return value
