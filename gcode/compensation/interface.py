"""Interface of a cutter compensation, and the checks that both controls share."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Literal, TypeAlias

from gcode.compensation.planar import SAME_POINT_MM, Segment, WorkingPlane
from gcode.errors import GcodeError, Place
from gcode.events import Event, Motion, Plane, Point

Style: TypeAlias = Literal["linuxcnc", "fanuc-A", "fanuc-B"]
Hand: TypeAlias = Literal["left", "right"]

#: Name of the two axes that each plane compensates.
PLANE_NAMES: dict[int, str] = {17: "XY", 18: "ZX", 19: "YZ"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Compensation(ABC):
    """Cutter compensation that is on: an immutable value, which each motion replaces by the next one.

    The tool's centre is at `at` in the plane once all events returned so far are executed.

    Attributes:
        frame: the plane, and how it is seen.
        at: position of the centre in the plane, mm.
        height: its position along the plane's normal, mm.
    """

    frame: WorkingPlane
    at: complex
    height: float

    @abstractmethod
    def move(self, motion: Motion) -> tuple[Compensation, tuple[Event, ...]]:
        """See `gcode.compensation.move`."""

    @abstractmethod
    def queue(self, event: Event) -> Compensation:
        """See `gcode.compensation.queue`."""

    @abstractmethod
    def end(self) -> tuple[tuple[Event, ...], Point]:
        """See `gcode.compensation.end`."""

    @abstractmethod
    def cancel(self, motion: Motion) -> tuple[Event, ...]:
        """See `gcode.compensation.cancel`."""

    @abstractmethod
    def change(self, side: Hand, radius_mm: float, *, place: Place, alone: bool) -> Compensation:
        """See `gcode.compensation.change`."""

    def segment(self, motion: Motion) -> Segment:
        """`motion` seen flat, once it is known to belong to the plane.

        Raises:
            GcodeError: ``compensation-plane``.
        """
        if motion.state.plane != self.frame.plane:
            raise plane_changed(motion.place, self.frame.plane, motion.state.plane)
        return self.frame.segment(motion)


def plane_changed(place: Place, plane: Plane, other: Plane) -> GcodeError:
    """The refusal of a motion in a plane other than that of the compensation."""
    problem = f"a motion in the {PLANE_NAMES[other]} plane (G{other})"
    expected = f"G{plane}, in which cutter compensation is on, or G40 first"
    return GcodeError(place, "compensation-plane", problem, expected)


def plane_refused(place: Place, plane: Plane) -> GcodeError:
    """The refusal of a plane that LinuxCNC does not compensate in."""
    problem = f"cutter compensation in the {PLANE_NAMES[plane]} plane (G{plane})"
    return GcodeError(place, "compensation-plane", problem, "G17 or G18")


def fits(segment: Segment, radius: float) -> None:
    """Checks an arc that is cut from inside.

    Raises:
        GcodeError: ``compensation-radius`` where the arc is not greater than the tool.
    """
    if segment.centre is None:
        return
    arc = abs(segment.end - segment.centre)
    if arc - radius <= SAME_POINT_MM:
        problem = f"the tool of radius {radius:.4f} mm does not fit inside the arc of radius {arc:.4f} mm"
        expected = f"an arc of more than {radius:.4f} mm, or a smaller tool"
        raise GcodeError(segment.motion.place, "compensation-radius", problem, expected)


def gouge(segment: Segment, radius: float, why: str) -> GcodeError:
    """The refusal of a block that the tool cannot cut without harm to its neighbour."""
    length = abs(segment.sweep_rad * abs(segment.end - segment.centre)) if segment.centre is not None else 0.0
    length = length or abs(segment.end - segment.start)
    problem = f"{why}: the block is {length:.4f} mm long in the plane, the tool's radius {radius:.4f} mm"
    return GcodeError(segment.motion.place, "compensation-gouge", problem, "a wider corner or a smaller tool")


def finite_radius(radius_mm: float, place: Place) -> float:
    """`radius_mm`, once it is known to be a number.

    Raises:
        GcodeError: ``compensation-radius``.
    """
    if not math.isfinite(radius_mm):
        raise GcodeError(place, "compensation-radius", f"a cutter radius of {radius_mm} mm", "a finite radius")
    return radius_mm
