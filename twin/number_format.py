"""Numbers as people read them."""

from __future__ import annotations

from collections.abc import Iterable

from gcode.cli.number_format import clock, grouped, plural

__all__ = ["clock", "column", "digits", "duration", "grouped", "plural", "size", "volume"]


def digits(value: float) -> str:
    """About three significant digits, never an exponent: ``0.144``, ``66.5``, ``1 470``."""
    size = abs(value)
    for limit, decimals in ((0.9995, 3), (9.995, 2), (999.95, 1)):
        if size < limit:
            return f"{value:.{decimals}f}"
    return grouped(value)


def duration(seconds: float) -> str:
    """A rough time in words: ``8 s``, ``12 min``, ``1.5 h``."""
    for unit, name in ((1.0, "s"), (60.0, "min")):
        if seconds < 99.5 * unit:
            return f"{seconds / unit:.0f} {name}"
    return f"{seconds / 3600.0:.1f} h"


def column(values: Iterable[float]) -> list[str]:
    """Numbers of one column, all with the decimals that the largest of them needs."""
    numbers = list(values)
    largest = max(map(abs, numbers), default=0.0)
    decimals = next((d for limit, d in ((1.0, 3), (10.0, 2), (1000.0, 1)) if largest < limit), 0)
    return [grouped(number, decimals) for number in numbers]


def volume(mm3: float) -> str:
    """A volume in mm³, or in cm³ when it is large."""
    return f"{digits(mm3)} mm³" if abs(mm3) < 10000.0 else f"{digits(mm3 * 1e-3)} cm³"


def size(count: float) -> str:
    """A number of bytes."""
    for unit in ("B", "kB", "MB"):
        if count < 999.5:
            return f"{count:.0f} {unit}" if unit == "B" else f"{count:.1f} {unit}"
        count /= 1000.0
    return f"{count:.1f} GB"
