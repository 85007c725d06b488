"""Steps of a canned cycle, in coordinates of its plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

#: Coordinates along the plane's first and second axis and along its normal, mm.
Position: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Move:
    """A straight motion to a point in program coordinates, mm.

    Attributes:
        first: coordinate along the plane's first axis.
        second: coordinate along its second axis.
        normal: coordinate along its normal, the drilling axis.
        rapid: True for a positioning motion, False for one at the programmed feed.
        tapping: True for a stroke into or out of a thread.
    """

    first: float
    second: float
    normal: float
    rapid: bool
    tapping: bool = False

    @property
    def end(self) -> Position:
        """Where it ends."""
        return (self.first, self.second, self.normal)


@dataclass(frozen=True, slots=True)
class Pause:
    """A dwell at the place reached, always longer than nothing."""

    seconds: float


@dataclass(frozen=True, slots=True)
class Spindle:
    """The spindle turns from here on in this direction: +1 clockwise (M3), -1 (M4), 0 stopped."""

    direction: int


@dataclass(frozen=True, slots=True)
class Orient:
    """The spindle stops at its orientation angle."""


@dataclass(frozen=True, slots=True)
class OperatorStop:
    """The program waits: the operator retracts the tool by hand, to where the cycle returns, and starts it again."""


Step: TypeAlias = Move | Pause | Spindle | Orient | OperatorStop
