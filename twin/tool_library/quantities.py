"""Lengths, angles and counts as libraries write them: numbers, or text with a unit, a fraction, a decimal comma."""

from __future__ import annotations

import math
import re
from typing import Literal, TypeAlias

LibraryUnit: TypeAlias = Literal["mm", "inch"]

MM_PER: dict[LibraryUnit, float] = {"mm": 1.0, "inch": 25.4}
_LENGTHS = {
    **dict.fromkeys(("mm", "millimeter", "millimeters", "millimetre", "millimetres", "metric"), 1.0),
    **dict.fromkeys(("in", "inch", "inches", '"', "''", "″", "”", "imperial"), 25.4),
    **dict.fromkeys(("um", "µm", "μm", "micron", "microns"), 1e-3),
    **dict.fromkeys(("thou", "mil", "mils"), 0.0254),
    **dict.fromkeys(("ft", "foot", "feet", "'", "′"), 304.8),
    "cm": 10.0,
    "m": 1000.0,
}
_ANGLES = {**dict.fromkeys(("deg", "degree", "degrees", "°", "º"), 1.0), "rad": math.degrees(1.0)}
#: Characters of a size, at most.
_LONGEST = 60
_NUMBER = r"[-+]?(?:\d[\d.,]*|[.,]\d+)(?:[eE][-+]?\d+)?"
_QUANTITY = re.compile(rf"({_NUMBER})\s*([^\d\s.,+-]*)")
_FRACTION = re.compile(r"([-+]?)(?:(\d+)[\s-]+)?(\d+)\s*/\s*(\d+)\s*([^\d\s.,+/-]*)")
_GROUPED = re.compile(r"\d{1,3}(?:([.,])\d{3})+(?:([.,])\d+)?")


def unit_named(text: object) -> LibraryUnit | None:
    """The unit that a word means, None for any other."""
    factor = _LENGTHS.get(str(text).strip().lower()) if isinstance(text, str) else None
    return {1.0: "mm", 25.4: "inch"}.get(factor or 0.0)  # type: ignore[return-value]


def length_mm(value: object, unit: LibraryUnit) -> float:
    """A length in mm.

    Args:
        value: a number, or text such as ``6.35``, ``30,0 mm``, ``1/4 in`` or ``1-1/8"``.
        unit: unit of a number without one.

    Raises:
        ValueError: not a length; the message is what was expected.
    """
    number, word = _split(value, "a length, e.g. 6.35 mm")
    if word and word not in _LENGTHS:
        raise ValueError("a length in mm or inches")
    factor = _LENGTHS[word] if word else MM_PER[unit]
    return number if factor == 1.0 else round(number * factor, 9)


def angle_deg(value: object) -> float:
    """An angle in degrees; a number without a unit is in degrees.

    Raises:
        ValueError: not an angle; the message is what was expected.
    """
    number, word = _split(value, "an angle, e.g. 45 deg")
    if word and word not in _ANGLES:
        raise ValueError("an angle in degrees")
    return number * _ANGLES.get(word, 1.0)


def whole(value: object) -> int:
    """A count or a tool number: a whole number, or text of one.

    Raises:
        ValueError: not a whole number; the message is what was expected.
    """
    number, word = _split(value, "a whole number")
    if word or number != round(number) or abs(number) > 1e9:
        raise ValueError("a whole number")
    return int(number)


def _split(value: object, expected: str) -> tuple[float, str]:
    """Number and unit word of a value."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(expected)
    try:
        number, word = (float(value), "") if not isinstance(value, str) else _parsed(value.strip(), expected)
    except OverflowError:
        number, word = math.inf, ""
    if not math.isfinite(number):
        raise ValueError(expected)
    return number, word


def _parsed(text: str, expected: str) -> tuple[float, str]:
    if len(text) > _LONGEST:
        raise ValueError(expected)
    if found := _FRACTION.fullmatch(text):
        sign, units, above, below, word = found.groups()
        if int(below) == 0:
            raise ValueError(expected)
        number = float(units or 0) + int(above) / int(below)
        return -number if sign == "-" else number, word.lower()
    found = _QUANTITY.fullmatch(text)
    if found is None:
        raise ValueError(expected)
    try:
        return float(_with_point(found[1])), found[2].lower()
    except ValueError:
        raise ValueError(expected) from None


def _with_point(text: str) -> str:
    """A number with a point: ``30,0`` is 30.0, ``1.234,5`` and ``1,234.5`` are 1234.5."""
    plain = text.lstrip("+-")
    grouped = _GROUPED.fullmatch(plain)
    if grouped is not None and grouped[1] != grouped[2] and (grouped[2] or plain.count(grouped[1]) > 1):
        text = text.replace(grouped[1], "")
    return text.replace(",", ".")
