"""Blocks without motion: tool, spindle, coolant, dwell, stop."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from gcode.dialects.codes import Status
from gcode.events import CoolantChange, Dwell, Event, MotionState, ProgramStop, SpindleChange, ToolChange
from gcode.write.control_memory import ControlMemory
from gcode.write.numbers import plain

_SPINDLE: Mapping[int, str] = {1: "M3", -1: "M4", 0: "M5"}
#: Digits after the point of P in G4 where it counts seconds.
_SECONDS_DECIMALS = 4


def tool_change(control: ControlMemory, event: ToolChange) -> Iterator[str]:
    """M6; after it the spindle is stopped and the position is unknown."""
    rule = control.options.dialect.codes.get("M6")
    if rule is None or rule.status is not Status.EXECUTED:
        if event.tool == control.tool:
            return
        problem = f"a change to tool {event.tool}, and {control.options.dialect.name} has no tool change"
        raise control.error(event, "tool-change", problem, "one tool, named by WriteOptions.tool")
    control.tool, control.direction, control.unsure = event.tool, 0, True
    yield control.line(f"T{event.tool}", "M6")


def spindle_change(control: ControlMemory, event: SpindleChange) -> Iterator[str]:
    """S, M3, M4, M5."""
    return spindle(control, event, event.spindle_rpm, event.spindle_direction)


def spindle(control: ControlMemory, event: Event, rpm: float, direction: int) -> Iterator[str]:
    """Words for what changes of speed and direction."""
    if not math.isfinite(rpm) or rpm < 0.0:
        raise control.error(event, "bad-value", f"a spindle speed of {rpm:g} rpm", "a finite speed of 0 or more")
    speed = f"S{plain(rpm, control.options.rules.speed_decimals)}"
    words = [speed] if control.words.get("S", "S0") != speed else []
    control.words["S"] = speed
    if control.direction != direction:
        control.direction = direction
        words.append(_SPINDLE[direction])
    if words:
        yield control.line(*words)


def coolant(control: ControlMemory, event: CoolantChange) -> Iterator[str]:
    """M7, M8, M9."""
    if (control.mist and not event.mist) or (control.flood and not event.flood):
        control.mist = control.flood = False
        yield control.line("M9")
    if event.mist and not control.mist:
        yield control.line("M7")
    if event.flood and not control.flood:
        yield control.line("M8")
    control.mist, control.flood = event.mist, event.flood


def ready(control: ControlMemory, event: Event, state: MotionState) -> Iterator[str]:
    """Tool and spindle as a motion's state has them, where no event has set them."""
    if state.tool != control.tool:
        yield from tool_change(control, ToolChange(place=event.place, tool=state.tool))
    yield from spindle(control, event, state.spindle_rpm, state.spindle_direction)


def dwell(control: ControlMemory, event: Dwell) -> Iterator[str]:
    """G4."""
    yield from ready(control, event, event.state)
    yield control.line("G4", pause(control, event, event.seconds))


def pause(control: ControlMemory, event: Event, seconds: float) -> str:
    """P for a time."""
    if not math.isfinite(seconds) or seconds < 0.0:
        raise control.error(event, "bad-value", f"a dwell of {seconds:g} s", "a finite time of 0 or more")
    word = control.options.dialect.dwell["P"]
    return f"P{plain(seconds / word.seconds, 0 if word.pointed is None else _SECONDS_DECIMALS)}"


def stop(control: ControlMemory, event: ProgramStop) -> Iterator[str]:
    """M0, M1, M30."""
    if event.end:
        control.ended = True
        yield control.line("M30")
        return
    message = "".join(c for c in event.message if c.isascii() and c.isprintable() and c not in "()")
    yield control.line("M1" if event.optional else "M0", *([f"({message})"] if message else []))
