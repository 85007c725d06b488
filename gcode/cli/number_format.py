"""Numbers and times for tables and messages."""

from __future__ import annotations

from collections.abc import Iterable


def clock(seconds: float) -> str:
    """A time as ``1:02.3`` (minutes), or ``2:01:02`` from an hour on."""
    tenths = round(seconds * 10.0)
    if tenths < 36000:
        return f"{tenths // 600}:{tenths % 600 // 10:02d}.{tenths % 10}"
    whole = round(seconds)
    return f"{whole // 3600}:{whole // 60 % 60:02d}:{whole % 60:02d}"


def grouped(value: float, decimals: int = 0) -> str:
    """A number with separated thousands: ``12 345``."""
    return f"{value:,.{decimals}f}".replace(",", " ")


def short(value: float) -> str:
    """A number with three decimals at most, without trailing zeros: ``200``, ``0.05``, ``1234.568``."""
    return f"{value:.3f}".rstrip("0").rstrip(".")


def plural(count: int, word: str) -> str:
    """``no errors``, ``1 error``, ``2 errors``."""
    return f"{count} {word}" if count == 1 else f"{count or 'no'} {word}s"


def joined(values: Iterable[float], most: int) -> str:
    """Numbers one after another, or the least and largest of more than `most`."""
    numbers = list(values)
    return ", ".join(map(short, numbers)) if len(numbers) <= most else span(numbers[0], numbers[-1])


def span(least: float, largest: float) -> str:
    """``100 to 500``, or one number where both are the same."""
    a, b = short(least), short(largest)
    return a if a == b else f"{a} to {b}"
