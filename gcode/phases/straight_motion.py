"""One straight motion as an event."""

from __future__ import annotations

import math

from gcode.control.command import Command
from gcode.control.state import State
from gcode.events import Extra, LinearMotion, Point
from gcode.phases.end_points import feed_mm_min, moved_to, settled
from gcode.phases.modes import Result


def straight(
    state: State,
    command: Command,
    end: Point,
    *,
    rapid: bool,
    extra: Extra | None = None,
    tapping: bool = False,
) -> Result:
    """A straight motion to `end` (controlled point, machine coordinates), also where the tool is there already."""
    start = state.position_mm
    feed = 0.0 if rapid else feed_mm_min(state, command, math.dist(start, end))
    state = settled(state, command)
    after = moved_to(state, end, extra)
    event = LinearMotion(
        place=command.block.place,
        state=state.machine,
        start_mm=start,
        end_mm=end,
        rapid=rapid,
        feed_mm_min=feed,
        tapping=tapping,
        extra=after.extra,
    )
    return after, (event,)
