"""NC events as the records that a timeline shows."""

from __future__ import annotations

from collections.abc import Mapping

from gcode.events import Block, CoolantChange, Event, Notice, ProgramStop, SpindleChange, ToolChange
from twin.record import NcEvent

_SPINDLE_WORDS = {1: "M3", -1: "M4", 0: "M5"}


def nc_event(event: Event, t_s: float, tools: Mapping[int, str]) -> NcEvent:
    """Describe an event that is not a motion.

    Args:
        tools: description of each tool by number.
    """
    line = event.place.line
    match event:
        case Block():
            return NcEvent(t_s=t_s, nc_line=line, kind="block", text=event.place.text)
        case ToolChange():
            name = tools.get(event.tool, "no tool")
            return NcEvent(t_s=t_s, nc_line=line, kind="tool", text=f"T{event.tool} {name}")
        case SpindleChange():
            word = _SPINDLE_WORDS[event.spindle_direction]
            return NcEvent(t_s=t_s, nc_line=line, kind="spindle", text=f"{word} S{event.spindle_rpm:g}")
        case CoolantChange():
            on = [name for name, flag in (("mist", event.mist), ("flood", event.flood)) if flag]
            return NcEvent(t_s=t_s, nc_line=line, kind="coolant", text=f"coolant {' and '.join(on) or 'off'}")
        case ProgramStop():
            text = "program end" if event.end else "optional stop" if event.optional else "program stop"
            return NcEvent(t_s=t_s, nc_line=line, kind="stop", text=text)
        case Notice():
            return NcEvent(t_s=t_s, nc_line=line, kind="notice", text=event.text)
        case _:
            raise TypeError(f"motions are moves, not events: {event}")
