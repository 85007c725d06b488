"""Statements of a program's macro language: what a line says besides, or instead of, words. Data only.

Two languages: FANUC's custom macro B (assignments, IF, WHILE, GOTO) and LinuxCNC's parameters and O-words.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from gcode.language.blocks import ParsedBlock
    from gcode.language.expressions import Expression


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
    """What an O-word line says."""

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
        keyword: what is said of it.
        arguments: bracketed expressions behind the keyword: a condition, a count, arguments of a call, results.
        column: column of the O, counted from 1.
    """

    label: str | None
    keyword: OKeyword
    label_value: Expression | None = None
    arguments: tuple[Expression, ...] = ()
    column: int = 1


Statement: TypeAlias = Goto | IfThen | While | End | Output | OWord
