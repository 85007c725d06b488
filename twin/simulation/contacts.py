"""Contacts with the stock that must not be: gathered over a motion, and reported once for each kind."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from twin.arrays import FloatArray
from twin.errors import ReplayError
from twin.motion.path import Move
from twin.record import Collision, CollisionKind
from twin.simulation.material import Material, Touch
from twin.simulation.tools import ToolSetup

#: Where the tool has neither shank nor holder in the job.
_ASSUMED_SHANK = "the tool above its flutes, where its diameter is taken to go on, touches the stock"
_WORDS: dict[CollisionKind, str] = {
    "rapid": "rapid motion through the stock",
    "spindle-stopped": "feed motion through the stock with the spindle stopped",
    "shank": "the shank touches the stock",
    "holder": "the holder touches the stock",
}


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """Time and tool position at which a body first met material, and the volumes met since, see `Touch`."""

    t_s: float
    start_mm: FloatArray
    met_mm3: float
    volume_mm3: float


class Contacts:
    """Collisions of one motion by kind.

    The material that a cutting part removes adds up over the pieces of a motion. Shank and holder remove nothing and
    would meet the same material again in the next piece, so for them the piece that met most counts. The sums of the
    whole motion decide, so a collision does not depend on where the motion is divided.
    """

    def __init__(self) -> None:
        self._met: dict[CollisionKind, Contact] = {}

    def add(self, touches: Iterable[Touch], t_s: float, start_mm: FloatArray) -> None:
        """Note the touches of one piece of the motion.

        Args:
            t_s, start_mm: machine time and tool tip, shape (3,), at the beginning of the piece.
        """
        for kind, met, volume in touches:
            first = self._met.get(kind, Contact(t_s, start_mm, 0.0, 0.0))
            if kind in ("rapid", "spindle-stopped"):
                met, volume = first.met_mm3 + met, first.volume_mm3 + volume
            else:
                met, volume = max(first.met_mm3, met), max(first.volume_mm3, volume)
            self._met[kind] = Contact(first.t_s, first.start_mm, met, volume)

    def found(self, least_mm3: float) -> dict[CollisionKind, Contact]:
        """The contacts that met more than a volume of material, by the kind of their collision."""
        return {kind: contact for kind, contact in self._met.items() if contact.met_mm3 > least_mm3}


class StartCheck:
    """Refuses a tool whose first motion near the stock begins inside the material.

    Args:
        program: name of the NC program, for the message.
    """

    def __init__(self, program: str) -> None:
        self._program = program
        self._checked_tool = 0

    def check(self, tool: ToolSetup, move: Move, material: Material) -> None:
        """Check a motion near the stock; only the first one after a tool change can be refused.

        Raises:
            ReplayError: the tool is inside the stock, and has not cut its way there.
        """
        if tool.number == self._checked_tool:
            return
        self._checked_tool = tool.number
        volume = material.volume_inside(tool, move.start_mm)
        if volume > material.contact_mm3:
            x, y, z = move.start_mm
            raise ReplayError(
                f"{self._program}:{move.nc_line}: tool T{tool.number} ({tool.description}) begins inside the "
                f"stock at X{x:g} Y{y:g} Z{z:g}; expected a start outside it (machine.start_mm, or the program's "
                "tool change position)"
            )


def collision_record(
    kind: CollisionKind, contact: Contact, move: Move, program: str, *, shank_assumed: bool
) -> Collision:
    """The record of a collision, with a human-readable line that names NC line and position."""
    words = _ASSUMED_SHANK if kind == "shank" and shank_assumed else _WORDS[kind]
    x, y, z = point(contact.start_mm)
    message = (
        f"{program}:{move.nc_line}: T{move.tool}: {words}, "
        f"from X{x:.3f} Y{y:.3f} Z{z:.3f}, {contact.volume_mm3:.3g} mm3"
    )
    return Collision(
        t_s=contact.t_s,
        nc_line=move.nc_line,
        tool=move.tool,
        kind=kind,
        point_mm=(x, y, z),
        volume_mm3=contact.volume_mm3,
        message=message,
    )


def point(p: FloatArray) -> tuple[float, float, float]:
    """Coordinates as plain numbers."""
    return float(p[0]), float(p[1]), float(p[2])


def box_of(move: Move) -> tuple[FloatArray, FloatArray]:
    """Two opposite corners of a motion's box."""
    if move.arc is None:
        return move.start_mm, move.end_mm
    corners = move.corners_mm(math.inf, 0.01 * move.length_mm)
    reach = 0.02 * move.length_mm
    return corners.min(axis=0) - reach, corners.max(axis=0) + reach


def forbidden(move: Move) -> CollisionKind | None:
    """The kind of collision when this motion meets material; None for a motion that is to cut."""
    if move.rapid:
        return "rapid"
    return "spindle-stopped" if move.spindle_rpm == 0.0 else None
