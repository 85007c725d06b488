"""Cutter compensation (G40, G41, G42) as geometry of motions: the programmed motions in, the tool centre's out.

A `Compensation` begins with G41 or G42. Each programmed motion comes out once the next one has determined its end;
other events in between are queued after it, in order. The effect of G40 depends on the control: see `end` and `cancel`.
All lengths are mm; motions are in machine coordinates.
"""

from __future__ import annotations

from gcode.compensation.fanuc import FanucCompensation, signed
from gcode.compensation.fanuc_vectors import Joint, StartupType
from gcode.compensation.interface import Compensation, Hand, Style, finite_radius
from gcode.compensation.interface import plane_refused as _plane_refused
from gcode.compensation.linuxcnc import LinuxCncCompensation
from gcode.compensation.planar import WorkingPlane
from gcode.errors import Place
from gcode.events import Event, Motion, Plane, Point


def begin(
    style: Style,
    side: Hand,
    radius_mm: float,
    plane: Plane,
    position_mm: Point,
    *,
    place: Place,
    joint: Joint = "linear",
    unit_mm: float = 1.0,
) -> Compensation:
    """Turns compensation on (G41, G42). Nothing moves yet: the next motion in the plane is the entry.

    Args:
        style: the control, and for FANUC the type of start-up and cancel (parameter 5003 bits 0 and 1).
        side: where the tool is, seen along the programmed motion against the plane's positive normal.
        radius_mm: radius of the tool; a negative one swaps the sides.
        plane: 17, 18 or 19.
        position_mm: where the tool is.
        place: the block, for a refusal.
        joint: how FANUC joins outside corners: ``linear``, or ``arc`` (parameter 19607 bit 2).
        unit_mm: length of the program's unit (25.4 with G20), by which one of LinuxCNC's tolerances is measured.

    Raises:
        GcodeError: ``compensation-plane`` for a plane that the control does not compensate in,
            ``compensation-radius`` for a radius that is not a number.
    """
    finite_radius(radius_mm, place)
    if style != "linuxcnc":
        frame, offset = WorkingPlane(plane=plane), signed(side, radius_mm)
        at, height = frame.flat(position_mm), frame.height(position_mm)
        kind: StartupType = "A" if style == "fanuc-A" else "B"
        return FanucCompensation(
            frame=frame, at=at, height=height, kind=kind, joint=joint, offset=offset, previous=offset
        )
    if plane == 19:
        raise _plane_refused(place, plane)
    frame = WorkingPlane(plane=plane, mirrored=signed(side, radius_mm) < 0.0)
    at, height = frame.flat(position_mm), frame.height(position_mm)
    radius = abs(radius_mm)
    return LinuxCncCompensation(
        frame=frame, at=at, height=height, radius=radius, programmed=at, centre=at, unit_mm=unit_mm
    )


def move(comp: Compensation, motion: Motion) -> tuple[Compensation, tuple[Event, ...]]:
    """Takes the next programmed motion.

    Args:
        comp: the present compensation.
        motion: the motion as programmed, from the programmed end of the one before.

    Returns:
        Compensation after it, and what is finished: motions of the tool's centre with the place, feed and state of
        their blocks, paths around corners between them (FANUC: with those of the block before the corner, LinuxCNC: of
        the block after it), and the events queued among them.

    Raises:
        GcodeError: ``compensation-gouge``, ``compensation-radius``, ``compensation-no-intersection``,
            ``compensation-entry``, ``compensation-arc-entry`` or ``compensation-plane``. For a corner that cannot be
            cut, the place is that of the block that would go wrong, which may be the one before.
    """
    return comp.move(motion)


def queue(comp: Compensation, event: Event) -> Compensation:
    """Queues an event that is not a motion after the waiting motion.

    FANUC counts the `Block` events among them: with more than two blocks without motion in the plane the control no
    longer sees the next motion, and the waiting one ends at right angles to itself.
    """
    return comp.queue(event)


def end(comp: Compensation) -> tuple[tuple[Event, ...], Point]:
    """Turns compensation off without a motion (G40 alone, or the end of the program).

    Returns:
        All waiting events, the last motion ending at right angles to itself, and the position of the tool's centre.
        The next motion starts there and goes to its programmed end: the offset is left with it. With LinuxCNC axes
        that this motion does not name go to where the program believes them to be, the uncompensated point.

    Raises:
        GcodeError: ``compensation-gouge``.
    """
    return comp.end()


def cancel(comp: Compensation, motion: Motion) -> tuple[Event, ...]:
    """Turns compensation off with a motion in the same block (G40 X... Y...).

    Args:
        comp: the present compensation.
        motion: the motion as programmed, from the programmed end of the one before.

    Returns:
        All waiting events and the motion that cancels. With FANUC a motion along the plane's normal does not cancel:
        the tool stays off the path, at the end of the last motion returned, and leaves the offset with its next motion.

    Raises:
        GcodeError: ``compensation-arc-entry`` (FANUC) or ``compensation-arc-exit`` (LinuxCNC) for an arc, and those
            of `move`.
    """
    return comp.cancel(motion)


def change(comp: Compensation, side: Hand, radius_mm: float, *, place: Place, alone: bool = False) -> Compensation:
    """G41, G42 or another D while compensation is on.

    FANUC: with another offset the vectors at the end of the coming block are the new ones, those at its start the old
    ones; with another side the tool goes from the vector at right angles to the end of the block before to the one at
    right angles to the start of the block after; the same code again, alone in its block, gives a vector at right
    angles to the block before, at inner and outer corners alike.

    Args:
        comp: the present compensation.
        side: where the tool is from now on.
        radius_mm: its radius from now on; a negative one swaps the sides.
        place: the block, for a refusal.
        alone: True where the block has no motion in the plane.

    Raises:
        GcodeError: ``compensation-on`` with LinuxCNC, which wants G40 first.
    """
    return comp.change(side, radius_mm, place=place, alone=alone)


__all__ = ["Compensation", "Hand", "Joint", "Style", "begin", "cancel", "change", "end", "move", "queue"]
