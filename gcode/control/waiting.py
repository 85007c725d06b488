"""Motions that wait for the next one: a corner to be cut or rounded, and cutter compensation, as part of the state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from gcode.compensation import Compensation
from gcode.events import Event, Motion, Point

CornerKind: TypeAlias = Literal["chamfer", "round"]


@dataclass(frozen=True, slots=True, kw_only=True)
class WaitingCorner:
    """A motion that ends in a corner to be cut or rounded, and the events since.

    Attributes:
        motion: the motion before the corner.
        kind: ``chamfer`` or ``round``.
        size_mm: length of ,C or radius of ,R.
        events: events after the motion, in order.
    """

    motion: Motion
    kind: CornerKind
    size_mm: float
    events: tuple[Event, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class WaitingPath:
    """The part of the path that is not finished until the next motion is known.

    Attributes:
        compensation: cutter compensation that is on, None for none.
        cancelling: the next motion turns it off.
        at_mm: position of the tool after G40 alone, off the programmed path; None where it is on the path.
        corner: a corner whose second motion is still to come, None for none.
    """

    compensation: Compensation | None = None
    cancelling: bool = False
    at_mm: Point | None = None
    corner: WaitingCorner | None = None

    @property
    def compensates(self) -> bool:
        """True while cutter compensation is on."""
        return self.compensation is not None
