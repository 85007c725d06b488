"""Random streams of events, as a tool path or an interpreted program is one."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field, replace

from gcode.errors import Place
from gcode.events import (
    PLANE_AXES,
    ArcMotion,
    CoolantChange,
    Dwell,
    Event,
    LinearMotion,
    Motion,
    MotionState,
    Point,
    ProgramStop,
    SpindleChange,
    ToolChange,
)
from gcode.settings import ToolOffset

PLACE = Place(file="stream", line=1)
START: Point = (3.0, -4.0, 250.0)
TOOLS = {
    1: ToolOffset(length_mm=75.0, radius_mm=5.0),
    2: ToolOffset(length_mm=31.25),
    3: ToolOffset(length_mm=-12.5, length_wear_mm=0.5),
}


@dataclass
class Path:
    """Events one after another, each motion from where the last one ended.

    Args:
        random: where the numbers come from.
        decimals: decimals that all coordinates are rounded to, None for all digits.
    """

    random: random.Random
    decimals: int | None = None
    at: Point = START
    state: MotionState = field(default_factory=MotionState)
    events: list[Event] = field(default_factory=list)

    def number(self, least: float, most: float) -> float:
        """A number of the range."""
        value = self.random.uniform(least, most)
        return value if self.decimals is None else round(value, self.decimals)

    def line(self, end: Point | None = None, *, rapid: bool | None = None, feed: float | None = None) -> None:
        """A straight motion; now and then one along a single axis, or to where the tool is."""
        if end is None:
            moved = [self.random.random() < 0.7 for _ in range(3)]
            x, y, z = (self.number(-200.0, 200.0) if moves else at for moves, at in zip(moved, self.at, strict=True))
            end = (x, y, z)
        rapid = self.random.random() < 0.3 if rapid is None else rapid
        self._motion(
            LinearMotion(
                place=PLACE,
                state=self.state,
                start_mm=self.at,
                end_mm=end,
                rapid=rapid,
                feed_mm_min=0.0 if rapid else feed or self.feed(),
            )
        )

    def arc(
        self,
        radius: float | None = None,
        sweep: float | None = None,
        turns: int | None = None,
        rise: float | None = None,
    ) -> None:
        """An arc or helix in any plane."""
        plane = self.random.choice((17, 18, 19))
        i, j, k = PLANE_AXES[plane]
        radius = radius or 10.0 ** self.random.uniform(-0.5, 2.5)
        sense = self.random.choice((-1, 1))
        turns = turns or self.random.choice((1, 1, 1, 1, 2, 4))
        swept = sweep or self.random.choice((self.random.uniform(0.2, 6.0), math.pi / 2, math.pi, math.tau))
        angle = self.random.choice((self.random.uniform(0.0, math.tau), 0.0, math.pi / 2))
        centre, end = list(self.at), list(self.at)
        centre[i] -= radius * math.cos(angle)
        centre[j] -= radius * math.sin(angle)
        if swept < math.tau:
            end[i] = centre[i] + radius * math.cos(angle + sense * swept)
            end[j] = centre[j] + radius * math.sin(angle + sense * swept)
        end[k] += self.random.choice((0.0, self.number(-5.0, 5.0))) if rise is None else rise
        if self.decimals is not None:
            centre = [round(value, self.decimals) for value in centre]
            end = [round(value, self.decimals) for value in end]
        self._motion(
            ArcMotion(
                place=PLACE,
                state=replace(self.state, plane=plane),
                start_mm=self.at,
                end_mm=(end[0], end[1], end[2]),
                centre_mm=(centre[0], centre[1], centre[2]),
                plane=plane,
                turns=sense * turns,
                feed_mm_min=self.feed(),
            )
        )

    def feed(self) -> float:
        """A feed, mm/min."""
        return float(self.random.choice((100, 254, 762.5, round(self.random.uniform(1.0, 5000.0), 2))))

    def tool(self, number: int | None = None) -> None:
        """A change of tool, which stops the spindle, and a straight motion."""
        number = self.random.choice(sorted(TOOLS)) if number is None else number
        self.turn(0)
        self.events.append(ToolChange(place=PLACE, tool=number))
        self.state = replace(self.state, tool=number)
        self.line()

    def length(self, number: int | None = None, sign: float = 1.0) -> None:
        """A motion with another length offset, or none: the controlled point is elsewhere on the tool, which stays."""
        number = self.random.choice((None, *TOOLS)) if number is None else number
        length = 0.0 if number is None else sign * TOOLS[number].whole_length_mm
        self.at = (*self.at[:2], self.at[2] + self.state.length_offset_mm - length)
        self.state = replace(self.state, length_number=number, length_offset_mm=length)
        self.line()

    def turn(self, direction: int | None = None) -> None:
        """Another speed or direction of the spindle."""
        direction = self.random.choice((-1, 0, 1)) if direction is None else direction
        rpm = float(self.random.choice((500, 3600, 12000)))
        self.events.append(SpindleChange(place=PLACE, spindle_rpm=rpm, spindle_direction=direction))  # type: ignore[arg-type]
        self.state = replace(self.state, spindle_rpm=rpm, spindle_direction=direction)  # type: ignore[arg-type]

    def cool(self) -> None:
        """Other coolant."""
        mist, flood = self.random.choice(((False, False), (True, False), (False, True), (True, True)))
        self.events.append(CoolantChange(place=PLACE, mist=mist, flood=flood))

    def dwell(self) -> None:
        """A dwell of whole milliseconds."""
        self.events.append(Dwell(place=PLACE, state=self.state, seconds=self.random.randint(0, 2000) / 1000.0))

    def stop(self) -> None:
        """M0 or M1."""
        self.events.append(ProgramStop(place=PLACE, optional=self.random.random() < 0.5, end=False))

    def tap(self, *, seconds: float = 0.0, rigid: bool = False, forward: int = 1) -> None:
        """A thread along z, as a tapping cycle makes it."""
        self.turn(forward)
        self.state = replace(self.state, plane=17)
        feed = 1.25 * self.state.spindle_rpm
        top, bottom = self.at, (*self.at[:2], self.at[2] - 12.5)
        for end in (bottom, top):
            into = end is bottom
            self._motion(
                LinearMotion(
                    place=PLACE,
                    state=self.state,
                    start_mm=self.at,
                    end_mm=end,
                    rapid=False,
                    feed_mm_min=feed,
                    tapping=True,
                )
            )
            if seconds:
                self.events.append(Dwell(place=PLACE, state=self.state, seconds=seconds))
            direction = -forward if into else 0 if rigid else forward
            self.state = replace(self.state, spindle_direction=direction)  # type: ignore[arg-type]
            rpm = self.state.spindle_rpm
            self.events.append(SpindleChange(place=PLACE, spindle_rpm=rpm, spindle_direction=direction))  # type: ignore[arg-type]

    def _motion(self, motion: Motion) -> None:
        self.events.append(motion)
        self.at = motion.end_mm


def random_stream(
    source: random.Random, steps: int, *, changes: bool = True, decimals: int | None = None
) -> list[Event]:
    """A stream of so many steps.

    Args:
        source: where the numbers come from.
        steps: how many.
        changes: whether tools, length offsets and further threads are among them.
        decimals: decimals of coordinates, None for all digits.
    """
    path = Path(source, decimals)
    path.line()
    kinds = [*[path.line] * 6, *[path.arc] * 5, path.dwell, path.turn, path.cool, path.stop]
    kinds += [path.tool, path.length, path.tap] if changes else []
    for _ in range(steps):
        source.choice(kinds)()
    return path.events


def motions_of(events: list[Event]) -> list[Motion]:
    """The motions among events."""
    return [event for event in events if isinstance(event, LinearMotion | ArcMotion)]
