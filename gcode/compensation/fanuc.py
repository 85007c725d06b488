"""Cutter compensation of FANUC's controls (operator's manual, "Details of cutter compensation").

The control reads one motion in the plane ahead: each motion waits until the next one determines its end. At the end of
a block offset vectors lead from the programmed corner to the tool's centre (`gcode.compensation.fanuc_vectors`).
Offsets are signed here: positive to the left of the path, negative to the right.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from gcode.compensation.fanuc_vectors import (
    Corner,
    Joint,
    StartupType,
    cancel_vectors,
    corner_vectors,
    startup_vectors,
    upright,
)
from gcode.compensation.interface import Compensation, Hand, finite_radius, fits, gouge
from gcode.compensation.planar import Segment, dot
from gcode.errors import GcodeError, Place
from gcode.events import Block, Event, LinearMotion, Motion, Notice, Point

#: Blocks without motion in the plane that the control can skip and still find the next motion.
BLOCKS_READ_OVER = 2
#: A compensated motion may be reversed by this length, mm, through rounding.
_ROUNDING_MM = 1e-6
_ROUNDING_RAD = 1e-4


@dataclass(frozen=True, slots=True, kw_only=True)
class Waiting:
    """A motion in the plane whose end the next one decides.

    Attributes:
        segment: the motion as programmed.
        offset: signed offset at its end, mm.
        startup: True for the motion that begins compensation.
    """

    segment: Segment
    offset: float
    startup: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class FanucCompensation(Compensation):
    """See the module.

    Attributes:
        kind: type of start-up and cancel, A or B.
        joint: how acute outside corners are joined.
        offset: signed offset for the ends of the coming motions, mm.
        previous: signed offset for the start of the next motion; it differs after a change of the offset.
        square: True where the next corner gets the vector at right angles to the block before it.
        waiting: the motion that waits, None before the start-up.
        held: what follows it.
    """

    kind: StartupType
    offset: float
    previous: float
    joint: Joint = "linear"
    square: bool = False
    waiting: Waiting | None = None
    held: tuple[Event, ...] = ()

    def move(self, motion: Motion) -> tuple[FanucCompensation, tuple[Event, ...]]:
        """Takes the next programmed motion; see `gcode.compensation.move`."""
        segment = self.segment(motion)
        if not segment.moves:
            return self._beside(motion)
        if self.waiting is None:
            return self._start_up(segment)
        if segment.turns * self.offset > 0.0:
            fits(segment, max(abs(self.offset), abs(self.previous)))
        after, events = self._joined(self.waiting, segment, self._corner(self.waiting, segment))
        waiting = Waiting(segment=segment, offset=self.offset)
        return replace(after, waiting=waiting, previous=self.offset, square=False)._up(motion), events

    def queue(self, event: Event) -> FanucCompensation:
        """Queues an event after the waiting motion; see `gcode.compensation.queue`."""
        return replace(self, held=(*self.held, event))

    def end(self) -> tuple[tuple[Event, ...], Point]:
        """Ends without a motion; see `gcode.compensation.end`."""
        after, events = self._upright_end()
        return events, after.frame.space(after.at, after.height)

    def cancel(self, motion: Motion) -> tuple[Event, ...]:
        """Ends with a motion; see `gcode.compensation.cancel`."""
        segment = self.segment(motion)
        if segment.centre is not None:
            raise _arc_refused(segment, "cancelled")
        if self.waiting is None or not segment.moves:
            after, events = self._upright_end()
            end = after.at if not segment.moves else segment.end
        else:
            corner = Corner(before=self.waiting.segment, after=segment, offset=self.waiting.offset)
            vectors = cancel_vectors(corner, self.kind, self.joint)
            after, events = self._joined(self.waiting, segment, vectors)
            end = segment.end
        return (*events, after.frame.motion(replace(segment, start=after.at, end=end)))

    def change(self, side: Hand, radius_mm: float, *, place: Place, alone: bool) -> FanucCompensation:
        """Continues with another offset; see `gcode.compensation.change`."""
        offset = signed(side, finite_radius(radius_mm, place))
        turned = offset * self.previous < 0.0
        same = offset == self.offset
        square = self.square or (alone and same)
        return replace(self, offset=offset, previous=offset if turned else self.previous, square=square)

    def _beside(self, motion: Motion) -> tuple[FanucCompensation, tuple[Event, ...]]:
        """A motion along the plane's normal, or none at all: it waits with the motion before it, if there is one."""
        if self.waiting is not None:
            return replace(self, held=(*self.held, motion))._up(motion), ()
        after, events = self._released()
        lifted = after.frame.motion(after.frame.segment(motion).between(after.at, after.at))
        return after._up(motion), (*events, lifted)

    def _start_up(self, segment: Segment) -> tuple[FanucCompensation, tuple[Event, ...]]:
        if segment.centre is not None:
            raise _arc_refused(segment, "begun")
        after, events = self._released()
        waiting = Waiting(segment=segment, offset=self.offset, startup=True)
        return replace(after, waiting=waiting, previous=self.offset, square=False)._up(segment.motion), events

    def _corner(self, waiting: Waiting, segment: Segment) -> tuple[complex, ...]:
        """Points that the tool's centre passes between two motions."""
        corner = Corner(before=waiting.segment, after=segment, offset=waiting.offset)
        if self.previous * waiting.offset < 0.0:
            return (*upright(waiting.segment, waiting.offset), *corner.starting(self.previous))
        if self.square or self._read_over(segment.motion) > BLOCKS_READ_OVER:
            points = upright(waiting.segment, waiting.offset)
            return points if segment.centre is None else (*points, *corner.starting(self.previous))
        if waiting.startup:
            return startup_vectors(corner, self.kind, self.joint)
        return corner_vectors(corner, self.joint)

    def _read_over(self, motion: Motion) -> int:
        """Blocks without motion in the plane between the motion that waits and `motion`."""
        return sum(isinstance(event, Block) and event.place != motion.place for event in self.held)

    def _joined(
        self, waiting: Waiting, segment: Segment, points: tuple[complex, ...]
    ) -> tuple[FanucCompensation, tuple[Event, ...]]:
        """The waiting motion, ending at the first of `points`, the path over the others, and the held events."""
        height = self.frame.height(waiting.segment.motion.end_mm)
        first = waiting.segment.between(self.at, points[0])
        _in_direction(waiting, first)
        events: list[Event] = [self.frame.motion(first)]
        at = first.end
        for point in points[1:]:
            if abs(point - at) > _ROUNDING_MM:
                events.append(self._corner_motion(waiting, at, point, height))
                at = point
        if self._read_over(segment.motion) > BLOCKS_READ_OVER:
            events.append(_blind(waiting, self._read_over(segment.motion)))
        after, more = replace(self, at=at)._released()
        return after, (*events, *more)

    def _corner_motion(self, waiting: Waiting, start: complex, end: complex, height: float) -> Motion:
        """One section of the path around a corner, at the feed of the block before it."""
        motion, corner = waiting.segment.motion, waiting.segment.end
        radius = abs(waiting.offset)
        round_it = self.joint == "arc" and not waiting.segment.rapid
        if round_it and max(abs(abs(start - corner) - radius), abs(abs(end - corner) - radius)) <= _ROUNDING_MM:
            turns = -1 if waiting.offset > 0.0 else 1
            return self.frame.arc(motion, (start, end), corner, turns, height)
        return self.frame.line(motion, start, end, height)

    def _upright_end(self) -> tuple[FanucCompensation, tuple[Event, ...]]:
        """All that waits; the last motion ends with a vector at right angles to it."""
        if self.waiting is None:
            return self._released()
        segment = self.waiting.segment
        after, events = self._joined(self.waiting, segment, upright(segment, self.waiting.offset))
        return replace(after, waiting=None), events

    def _released(self) -> tuple[FanucCompensation, tuple[Event, ...]]:
        """The held events, with motions along the normal at the position that the tool's centre has reached."""
        events = tuple(
            self.frame.motion(self.frame.segment(event).between(self.at, self.at))
            if isinstance(event, LinearMotion)
            else event
            for event in self.held
        )
        return replace(self, held=()), events

    def _up(self, motion: Motion) -> FanucCompensation:
        return replace(self, height=self.frame.height(motion.end_mm))


def signed(side: Hand, radius_mm: float) -> float:
    """Signed offset of a tool on one side of the path: positive to the left."""
    return radius_mm if side == "left" else -radius_mm


def _in_direction(waiting: Waiting, made: Segment) -> None:
    """The interference check: the tool's centre must not run against the programmed motion.

    The manual calls it interference where the direction differs by 90 to 270 degrees, and for an arc where the angle
    that it sweeps differs by more than 180 degrees.

    Raises:
        GcodeError: ``compensation-gouge``.
    """
    if waiting.startup:
        return
    segment, radius = waiting.segment, abs(waiting.offset)
    if made.centre is None:
        if dot(segment.direction_out, made.end - made.start) < -_ROUNDING_MM:
            raise gouge(segment, radius, "interference: the compensated motion opposes the programmed one")
    elif abs(made.sweep_rad) > abs(segment.sweep_rad) + _ROUNDING_RAD:
        raise gouge(segment, radius, "interference: the compensated arc opposes the programmed one")


def _arc_refused(segment: Segment, what: str) -> GcodeError:
    chord = abs(segment.end - segment.start)
    problem = f"cutter compensation is {what} by an arc, which ends {chord:.4f} mm from its start"
    return GcodeError(segment.motion.place, "compensation-arc-entry", problem, "a straight motion (G0 or G1)")


def _blind(waiting: Waiting, blocks: int) -> Notice:
    text = (
        f"{blocks} blocks without motion in the plane of compensation follow, and the control reads past only "
        f"{BLOCKS_READ_OVER}: the tool ends this block regardless of the corner, where it may gouge or leave material"
    )
    return Notice(place=waiting.segment.motion.place, code="compensation-look-ahead", text=text)
