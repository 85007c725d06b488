"""Cutter compensation of LinuxCNC's interpreter.

A straight entry ends off its programmed end, an entry arc is replaced by one tangent to the same end. Convex
corners are joined by an arc about the programmed corner, concave ones by moving the end of the motion before, which
therefore waits for the next one. Corners of less than 0.05 rad are left as they are. All is written for a tool on the
left; for one on the right the frame is mirrored.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace

from gcode.compensation.interface import Compensation, Hand, fits, gouge
from gcode.compensation.linuxcnc_concave import meeting_point
from gcode.compensation.planar import Segment, dot, swept, unit
from gcode.errors import GcodeError, Place
from gcode.events import Event, LinearMotion, Motion, Point

#: Corners flatter than this, rad, are taken as straight.
FLAT_RAD = 0.05
#: A shortened arc may sweep this much more than the programmed one before it counts as reversed: rad in a program in
#: mm, and as many times less as its unit is longer.
SWEEP_RAD = 0.0254


@dataclass(frozen=True, slots=True, kw_only=True)
class Held:
    """A motion that waits for the next one, which may move its end.

    Attributes:
        segment: the motion with the ends it has before the next one is known.
        original: the motion as programmed.
        checked: False for an entry, whose direction is free.
    """

    segment: Segment
    original: Segment
    checked: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class LinuxCncCompensation(Compensation):
    """See the module.

    Attributes:
        radius: the tool's radius, mm, not negative; with 0 every motion goes out as it is.
        programmed: programmed end of the last motion in the plane.
        centre: the tool's centre at the end of the last motion, if nothing moves that end.
        unit_mm: length of the program's unit, on which LinuxCNC's tolerance of a reversed arc depends.
        entered: True after the entry motion.
        held: what waits, in order: the last motion in the plane first, then all that followed it.
    """

    radius: float
    programmed: complex
    centre: complex
    unit_mm: float = 1.0
    entered: bool = False
    held: tuple[Held | Event, ...] = ()

    def move(self, motion: Motion) -> tuple[LinuxCncCompensation, tuple[Event, ...]]:
        """Takes the next programmed motion; see `gcode.compensation.move`."""
        segment = self.segment(motion)
        if self.radius == 0.0:
            after = replace(self, programmed=segment.end, centre=segment.end, entered=True)
            after, events = after._flushed(segment.start)
            return after._stands(segment.end, motion), (*events, motion)
        if not self.entered:
            return self._enter(segment)
        if not segment.moves:
            return self._wait(Held(segment=segment, original=segment), motion, self.centre), ()
        if segment.centre is None:
            return self._straight(segment)
        return self._arc(segment)

    def queue(self, event: Event) -> LinuxCncCompensation:
        """Queues an event after the waiting motion; see `gcode.compensation.queue`."""
        return replace(self, held=(*self.held, event))

    def end(self) -> tuple[tuple[Event, ...], Point]:
        """Ends without a motion; see `gcode.compensation.end`."""
        after, events = self._flushed(self.centre, check=True)
        return events, after.frame.space(after.at, self.height)

    def cancel(self, motion: Motion) -> tuple[Event, ...]:
        """Ends with a motion; see `gcode.compensation.cancel`."""
        if not isinstance(motion, LinearMotion):
            problem = "an arc as the exit from cutter compensation"
            raise GcodeError(motion.place, "compensation-arc-exit", problem, "a straight motion")
        events, point = self.end()
        return (*events, replace(motion, start_mm=point))

    def change(self, side: Hand, radius_mm: float, *, place: Place, alone: bool) -> LinuxCncCompensation:
        """Refuses; see `gcode.compensation.change`."""
        word = "alone in its block" if alone else "in a block with a motion"
        problem = f"cutter compensation to the {side} ({radius_mm:.4f} mm), {word}, while it is on"
        raise GcodeError(place, "compensation-on", problem, "G40 first")

    def _enter(self, segment: Segment) -> tuple[LinuxCncCompensation, tuple[Event, ...]]:
        made = self._entry_line(segment) if segment.centre is None else self._entry_arc(segment, segment.centre)
        waiting = Held(segment=made, original=segment, checked=False)
        after, events = self._flushed(self.at)
        after = replace(after, entered=True, programmed=segment.end)
        return after._wait(waiting, segment.motion, made.end), events

    def _entry_line(self, segment: Segment) -> Segment:
        length = abs(segment.end - segment.start)
        if length <= self.radius:
            problem = f"the entry motion of {length:.4f} mm is not longer than the tool's radius"
            expected = f"more than {self.radius:.4f} mm in the plane"
            raise GcodeError(segment.motion.place, "compensation-entry", problem, expected)
        return segment.between(segment.start, segment.end + 1j * self.radius * segment.direction_in)

    def _entry_arc(self, segment: Segment, about: complex) -> Segment:
        """An arc from where the tool is, tangent at its end to the programmed arc shifted by the tool's radius."""
        if abs(segment.end - segment.start) <= self.radius:
            problem = f"the entry arc ends {abs(segment.end - segment.start):.4f} mm from its start"
            expected = f"more than the tool's radius of {self.radius:.4f} mm"
            raise GcodeError(segment.motion.place, "compensation-arc-entry", problem, expected)
        if segment.turns > 0:
            fits(segment, self.radius)
        end = segment.end + 1j * self.radius * segment.direction_out
        inward = unit(about - end)
        chord = (segment.start - end) / inward
        if abs(chord.real) < 1e-6 * abs(chord):
            problem = f"no entry arc leads to {self.radius:.4f} mm from the programmed arc"
            expected = "a different start point"
            raise GcodeError(segment.motion.place, "compensation-arc-entry", problem, expected)
        centre = end + inward * abs(chord) ** 2 / (2.0 * chord.real)
        return replace(segment, end=end, centre=centre)

    def _straight(self, segment: Segment) -> tuple[LinuxCncCompensation, tuple[Event, ...]]:
        offset = 1j * self.radius * segment.direction_in
        turn, before = self._turn(segment), self._last.segment
        over_the_top = turn > math.pi - FLAT_RAD and before.turns < 0
        if turn < -FLAT_RAD or turn > math.pi + FLAT_RAD or over_the_top:
            after, events = self._flushed(self._meeting(segment), check=True)
        elif turn > FLAT_RAD:
            after, events = self._rounded(segment, self.programmed + offset, check=True)
        else:
            after, events = self._flushed(self.centre)
        return after._hold(segment, segment.end + offset), events

    def _arc(self, segment: Segment) -> tuple[LinuxCncCompensation, tuple[Event, ...]]:
        if segment.turns > 0:
            fits(segment, self.radius)
        turn, outside = self._turn(segment), segment.turns < 0
        over_the_top = outside and abs(turn - math.pi) < FLAT_RAD
        if turn < -FLAT_RAD or turn > math.pi + FLAT_RAD or over_the_top:
            after, events = self._flushed(self._meeting(segment), check=True)
        elif turn > FLAT_RAD:
            corner = self.programmed + 1j * self.radius * segment.direction_in
            after, events = self._rounded(segment, corner, check=False)
        else:
            after, events = self._flushed(self.centre)
        return after._hold(segment, segment.end + 1j * self.radius * segment.direction_out), events

    @property
    def _last(self) -> Held:
        """The last motion in the plane; there is one after the entry."""
        return next(item for item in self.held if isinstance(item, Held))

    def _turn(self, segment: Segment) -> float:
        """Angle, rad, by which the path turns away from the tool, from -pi/2 to below 3 pi/2: convex from 0 to pi."""
        before = (self.centre - self.programmed) / 1j
        angle = -cmath.phase(segment.direction_in / before)
        return angle + 2.0 * math.pi if angle < -math.pi / 2.0 else angle

    def _meeting(self, segment: Segment) -> complex:
        """Where the shifted path of `segment` meets that of the motion before."""
        return meeting_point(self._last.segment, segment, self.programmed, self.centre, self.radius)

    def _rounded(
        self, segment: Segment, corner: complex, *, check: bool
    ) -> tuple[LinuxCncCompensation, tuple[Event, ...]]:
        """The motion before, and the path around a convex corner to `corner`, at the feed of the coming block."""
        after, events = self._flushed(self.centre, check=check)
        if segment.rapid:
            joint: Motion = self.frame.line(segment.motion, after.at, corner, self.height)
        else:
            joint = self.frame.arc(segment.motion, (after.at, corner), self.programmed, -1, self.height)
        return replace(after, at=corner), (*events, joint)

    def _hold(self, segment: Segment, end: complex) -> LinuxCncCompensation:
        shifted = segment.between(self.at, end)
        after = replace(self, programmed=segment.end)
        return after._wait(Held(segment=shifted, original=segment), segment.motion, end)

    def _wait(self, waiting: Held, motion: Motion, centre: complex) -> LinuxCncCompensation:
        height = self.frame.height(motion.end_mm)
        return replace(self, held=(*self.held, waiting), centre=centre, height=height)

    def _stands(self, at: complex, motion: Motion) -> LinuxCncCompensation:
        return replace(self, at=at, height=self.frame.height(motion.end_mm))

    def _flushed(self, end: complex, *, check: bool = False) -> tuple[LinuxCncCompensation, tuple[Event, ...]]:
        """All that waits, with the last motion in the plane ending at `end`."""
        at, events = self.at, list[Event]()
        for item in self.held:
            if isinstance(item, Held):
                segment = item.segment.between(at, end)
                if check and item.checked:
                    _reachable(item, segment, self.radius, SWEEP_RAD / self.unit_mm)
                events.append(self.frame.motion(segment))
                at = segment.end
            else:
                events.append(item)
        return replace(self, at=at, held=()), tuple(events)


def _reachable(item: Held, segment: Segment, radius: float, tolerance_rad: float) -> None:
    """Refuses a motion that its new end turns round."""
    if not item.original.moves:
        return
    if segment.centre is None:
        if dot(item.original.end - item.original.start, segment.end - segment.start) < 0.0:
            raise gouge(item.original, radius, "the straight motion cannot be reached in a concave corner")
        return
    sweep = swept(segment.start, segment.end, segment.centre, segment.turns)
    if abs(sweep) > abs(item.original.sweep_rad) + tolerance_rad:
        raise gouge(item.original, radius, "the arc cannot be reached in a concave corner")
