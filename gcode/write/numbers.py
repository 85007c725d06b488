"""Numbers as a program writes them: whole counts of the last decimal, so that sums of words never drift."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

from gcode.events import Point

MM_PER_INCH = 25.4
#: A point in whole counts of the last decimal.
Counts: TypeAlias = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Grid:
    """The points that words with `decimals` decimals can name.

    Attributes:
        unit_mm: length of the program's unit.
        decimals: digits after the decimal point.
        zero_mm: program zero in machine coordinates.
    """

    unit_mm: float
    decimals: int
    zero_mm: Point = (0.0, 0.0, 0.0)

    @property
    def step_mm(self) -> float:
        """Length of one count."""
        return self.unit_mm / 10.0**self.decimals

    def count(self, length_mm: float) -> int:
        """The nearest count to a length."""
        return round(length_mm / self.unit_mm * 10.0**self.decimals)

    def point(self, point_mm: Point) -> Counts:
        """The nearest point of the grid to one in machine coordinates."""
        x, y, z = (self.count(value - zero) for value, zero in zip(point_mm, self.zero_mm, strict=True))
        return (x, y, z)

    def position_mm(self, counts: Counts) -> Point:
        """A point of the grid in machine coordinates."""
        x, y, z = (count * self.step_mm + zero for count, zero in zip(counts, self.zero_mm, strict=True))
        return (x, y, z)

    def text(self, count: int) -> str:
        """A count as a number with a decimal point, which every control reads as a length in its unit."""
        return fixed(count, self.decimals)


def fixed(count: int, decimals: int) -> str:
    """``count / 10 ** decimals`` exactly, with a point and without idle zeros: ``12.5``, ``10.``, ``-0.25``."""
    whole, part = divmod(abs(count), int(10**decimals))
    digits = f"{part:0{decimals}d}".rstrip("0") if decimals else ""
    return f"{'-' if count < 0 else ''}{whole}.{digits}"


@lru_cache(maxsize=64)  # feeds and speeds are the same on most lines
def plain(value: float, decimals: int) -> str:
    """A number with at most `decimals` decimals, without a point where it is whole: ``1200``, ``0.25``."""
    return fixed(round(value * 10.0**decimals), decimals).rstrip(".")
