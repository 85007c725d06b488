"""Operators and functions of the macro languages as tables of plain functions on floats. Angles are degrees."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

Binary: TypeAlias = Callable[[float, float], float]
Unary: TypeAlias = Callable[[float], float]

#: LinuxCNC takes two values nearer than this as equal.
_EQUAL = 1e-4
#: What arithmetic in doubles may take from a half, in least input increments.
_HALF = 1e-6
#: Whole numbers below this are exact, so they have bits.
_LARGEST_BITS = 1 << 53


class MathError(Exception):
    """An operation that has no result: the operation, and the values allowed."""

    def __init__(self, problem: str, expected: str) -> None:
        self.problem = problem
        self.expected = expected
        super().__init__(problem)


@dataclass(frozen=True, slots=True, kw_only=True)
class MacroLanguage:
    """Variables, expressions and statements of a control.

    Attributes:
        name: for messages: ``fanuc``, ``linuxcnc`` or ``none``.
        operators: priority (higher binds tighter) and function of each binary operator.
        comparisons: those of them that distinguish vacant from 0.
        functions: functions of one bracketed argument by name.
        pairs: functions of two arguments in one bracket, with a comma between.
        refused: functions that are known and not supported.
        abbreviates: a function's first two letters stand for it.
        arctangent: of ATAN[a]/[b].
        vacant: a variable may hold nothing.
        named: variables may have names, and O-words name subroutines.
        tail_comments: a semicolon begins a comment.
        locals: how many variables from #1 on belong to a level of calls.
    """

    name: str
    operators: Mapping[str, tuple[int, Binary]] = field(default_factory=dict)
    comparisons: frozenset[str] = frozenset()
    functions: Mapping[str, Unary] = field(default_factory=dict)
    pairs: Mapping[str, Binary] = field(default_factory=dict)
    refused: frozenset[str] = frozenset()
    abbreviates: bool = False
    arctangent: Binary | None = None
    vacant: bool = False
    named: bool = False
    tail_comments: bool = True
    locals: int = 0


def _divide(a: float, b: float) -> float:
    if b == 0.0:
        raise MathError(f"{a:g} divided by 0", "a divisor that is not 0")
    return a / b


def _modulo(a: float, b: float) -> float:
    """Remainder with the sign of the divisor's size: never negative."""
    if b == 0.0:
        raise MathError(f"{a:g} MOD 0", "a divisor that is not 0")
    rest = math.fmod(a, b)
    return rest + abs(b) if rest < 0.0 else rest


def _remainder(a: float, b: float) -> float:
    """Remainder with the sign of the dividend."""
    if b == 0.0:
        raise MathError(f"{a:g} MOD 0", "a divisor that is not 0")
    return math.fmod(a, b)


def _power(a: float, b: float) -> float:
    try:
        value: float | complex = a**b
    except (OverflowError, ZeroDivisionError):
        value = math.nan
    if isinstance(value, complex) or not math.isfinite(value):
        raise MathError(f"{a:g} to the power {b:g}", "a power that is a number")
    return value


def _bits(value: float) -> int:
    if not abs(value) < _LARGEST_BITS:
        raise MathError(f"the bits of {value:g}", "a whole number below 2^53")
    return round(value)


def _trig(function: Unary) -> Unary:
    def of_degrees(angle: float) -> float:
        quarter = math.fmod(angle, 360.0)
        return function(math.radians(quarter))

    return of_degrees


def _arc(function: Unary, name: str) -> Unary:
    def in_degrees(value: float) -> float:
        if not -1.0 <= value <= 1.0:
            raise MathError(f"{name}[{value:g}]", "-1 to 1")
        return math.degrees(function(value))

    return in_degrees


def _square_root(value: float) -> float:
    if value < 0.0:
        raise MathError(f"SQRT[{value:g}]", "0 or more")
    return math.sqrt(value)


def _logarithm(value: float) -> float:
    if value <= 0.0:
        raise MathError(f"LN[{value:g}]", "more than 0")
    return math.log(value)


def _exponential(value: float) -> float:
    try:
        return math.exp(value)
    except OverflowError:
        raise MathError(f"EXP[{value:g}]", "at most 709") from None


def _whole(function: Callable[[float], int]) -> Unary:
    def of_finite(value: float) -> float:
        return float(function(value))

    return of_finite


def _half_away(value: float) -> int:
    return int(value + math.copysign(0.5, value))


def rounded(value: float, steps: int) -> float:
    """The nearest multiple of 1/`steps`, halves away from 0, as a number of an address is rounded."""
    return _half_away(value * steps + math.copysign(_HALF, value)) / steps


def _away(value: float) -> int:
    return math.ceil(value) if value > 0.0 else math.floor(value)


def _arctangent_signed(a: float, b: float) -> float:
    return math.degrees(math.atan2(a, b))


def _arctangent_turn(a: float, b: float) -> float:
    """0 to 360 degrees."""
    angle = math.degrees(math.atan2(a, b))
    return angle + 360.0 if angle < 0.0 else angle


def _arcsine_turn(value: float) -> float:
    """270 to 90 degrees, through 0."""
    angle = _arc(math.asin, "ASIN")(value)
    return angle + 360.0 if angle < 0.0 else angle


def _from_bcd(value: float) -> float:
    text = f"{_bits(value):x}"
    if value < 0.0 or not text.isdecimal():
        raise MathError(f"BIN[{value:g}]", "a number in binary coded decimals")
    return float(int(text))


def _to_bcd(value: float) -> float:
    if not 0.0 <= value <= 99_999_999.0:
        raise MathError(f"BCD[{value:g}]", "0 to 99999999")
    return float(int(str(_bits(value)), 16))


_ARITHMETIC: Mapping[str, Binary] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": _divide,
}
_TRIGONOMETRY: Mapping[str, Unary] = {
    "SIN": _trig(math.sin),
    "COS": _trig(math.cos),
    "TAN": _trig(math.tan),
    "ACOS": _arc(math.acos, "ACOS"),
    "ABS": abs,
    "SQRT": _square_root,
    "LN": _logarithm,
    "EXP": _exponential,
    "ROUND": _whole(_half_away),
}


def _comparisons(tolerance: float) -> dict[str, Binary]:
    return {
        "EQ": lambda a, b: float(abs(a - b) <= tolerance if tolerance else a == b),
        "NE": lambda a, b: float(abs(a - b) > tolerance if tolerance else a != b),
        "GT": lambda a, b: float(a > b),
        "GE": lambda a, b: float(a >= b),
        "LT": lambda a, b: float(a < b),
        "LE": lambda a, b: float(a <= b),
    }


def _ranked(*ranks: Mapping[str, Binary]) -> dict[str, tuple[int, Binary]]:
    """Operators by priority, the weakest rank first."""
    return {name: (rank, function) for rank, row in enumerate(ranks) for name, function in row.items()}


NO_MACRO = MacroLanguage(name="none")

FANUC_MACRO = MacroLanguage(
    name="fanuc",
    operators=_ranked(
        _comparisons(0.0),
        {
            "+": _ARITHMETIC["+"],
            "-": _ARITHMETIC["-"],
            "OR": lambda a, b: float(_bits(a) | _bits(b)),
            "XOR": lambda a, b: float(_bits(a) ^ _bits(b)),
        },
        {
            "*": _ARITHMETIC["*"],
            "/": _divide,
            "AND": lambda a, b: float(_bits(a) & _bits(b)),
            "MOD": _remainder,
        },
    ),
    comparisons=frozenset({"EQ", "NE"}),
    functions={
        **_TRIGONOMETRY,
        "ASIN": _arcsine_turn,
        "ATAN": lambda a: math.degrees(math.atan(a)),
        "FIX": _whole(math.trunc),
        "FUP": _whole(_away),
        "BIN": _from_bcd,
        "BCD": _to_bcd,
    },
    pairs={"ATAN": _arctangent_turn, "POW": _power},
    refused=frozenset({"ADP", "PRM"}),
    abbreviates=True,
    arctangent=_arctangent_turn,
    vacant=True,
    tail_comments=False,
    locals=33,
)

LINUXCNC_MACRO = MacroLanguage(
    name="linuxcnc",
    operators=_ranked(
        {
            "AND": lambda a, b: float(a != 0.0 and b != 0.0),
            "OR": lambda a, b: float(a != 0.0 or b != 0.0),
            "XOR": lambda a, b: float((a != 0.0) != (b != 0.0)),
        },
        _comparisons(_EQUAL),
        {"+": _ARITHMETIC["+"], "-": _ARITHMETIC["-"]},
        {"*": _ARITHMETIC["*"], "/": _divide, "MOD": _modulo},
        {"**": _power},
    ),
    functions={
        **_TRIGONOMETRY,
        "ASIN": _arc(math.asin, "ASIN"),
        "FIX": _whole(math.floor),
        "FUP": _whole(math.ceil),
    },
    arctangent=_arctangent_signed,
    named=True,
    locals=30,
)
