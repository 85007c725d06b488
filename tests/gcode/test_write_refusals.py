"""What cannot be written is refused, naming the event or the option."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from support.streams import PLACE, START, TOOLS, Path

from gcode.dialects import DIALECTS, GRBL, LINUXCNC
from gcode.events import Dwell, Event, LinearMotion, ProgramStop, SpindleChange
from gcode.write import WriteError, WriteOptions, program_lines


def one(change: Callable[[LinearMotion], Any]) -> list[Event]:
    motion = LinearMotion(
        place=PLACE, state=Path(random.Random(1)).state, start_mm=START, end_mm=(0.0, 0.0, 1.0), rapid=False,
        feed_mm_min=100.0,
    )  # fmt: skip
    changed = change(motion)
    return [motion, *(changed if isinstance(changed, list) else [changed])]


def on(motion: LinearMotion, **changes: Any) -> LinearMotion:
    """A motion on from the end of this one."""
    return replace(motion, **{"start_mm": motion.end_mm, **changes})


def longer(motion: LinearMotion, length_mm: float, number: int | None) -> LinearMotion:
    """The same with a length offset, which leaves the gauge point where it is."""
    x, y, z = motion.end_mm
    state = replace(motion.state, length_offset_mm=length_mm, length_number=number)
    return on(motion, start_mm=(x, y, z - length_mm), state=state)


END = ProgramStop(place=PLACE, optional=False, end=True)


@pytest.mark.parametrize(
    ("events", "options", "message"),
    [
        (
            one(lambda m: replace(m, start_mm=(0.0, 0.0, 2.0))), {},
            "stream:1:1: a motion from (0, 0, 2), where the last one ended at (0, 0, 1); "
            "expected motions that begin where the last one ends [gap] (event 1)",
        ),
        (one(lambda m: on(m, end_mm=(0.0, math.nan, 1.0))), {}, "expected finite lengths [bad-value]"),
        (one(lambda m: on(m, feed_mm_min=0.0)), {}, "a feed of 0 mm/min; expected a finite feed"),
        (one(lambda m: on(m, feed_mm_min=1e-4)), {}, "that is not 0 in 3 decimals [bad-value]"),
        (
            one(lambda m: on(m, extra=(90.0, 0.0, 0.0, 0.0, 0.0, 0.0))), {},
            "further axes at (90.0, 0.0, 0.0, 0.0, 0.0, 0.0); expected motions in x, y and z [further-axes]",
        ),
        (one(lambda m: [END, m]), {}, "an event after the end of the program; expected the end as the last event"),
        (one(lambda m: Dwell(place=PLACE, state=m.state, seconds=-1.0)), {}, "a dwell of -1 s; expected a finite time"),
        (
            one(lambda m: SpindleChange(place=PLACE, spindle_rpm=math.inf, spindle_direction=1)), {},
            "a spindle speed of inf rpm; expected a finite speed of 0 or more",
        ),
        (
            one(lambda m: on(m, state=replace(m.state, tool=2))), {"dialect": "grbl"},
            "a change to tool 2, and grbl has no tool change; expected one tool, named by WriteOptions.tool "
            "[tool-change]",
        ),
        (
            one(lambda m: longer(m, 10.0, None)), {},
            "a length offset of 10 mm without a number; expected an offset with a number, as fanuc requires",
        ),
        (
            one(lambda m: longer(m, 10.0, 1)), {"tools": TOOLS},
            "H1 with a length of 10 mm; expected 75 mm, as in the tool table [tool-length]",
        ),
        (
            one(lambda m: on(m, tapping=True)), {},
            "a tap without its return stroke; expected the stroke out of the thread, back to its start, next [tap]",
        ),
    ],
)  # fmt: skip
def test_events_that_cannot_be_written(events: list[Event], options: dict[str, Any], message: str) -> None:
    with pytest.raises(WriteError) as caught:
        list(program_lines(events, WriteOptions(**{**options, "dialect": DIALECTS[options.get("dialect", "fanuc")]})))
    assert message in str(caught.value)
    assert caught.value.index in (1, 2)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"units": "cm"}, "units must be one of mm, inch, got 'cm'"),
        ({"distance": "both"}, "distance must be one of absolute, incremental, got 'both'"),
        ({"arcs": "r"}, "arcs must be one of centre, radius, got 'r'"),
        ({"decimals": 9}, "decimals must be from 0 to 6, got 9"),
        ({"number_step": 0}, "number_step must be from 1 to 1000, got 0"),
        ({"program_number": 10000}, "program_number must be from 1 to 9999, got 10000"),
        ({"program_number": 1, "dialect": LINUXCNC}, "program_number: linuxcnc has no program numbers, got 1"),
        ({"percent": True, "dialect": GRBL}, "percent: grbl has no percent signs"),
        ({"tool": -1}, "tool must be 0 or more, got -1"),
        ({"shift_mm": (0.0, math.nan, 0.0)}, "shift_mm must be three finite lengths, got (0.0, nan, 0.0)"),
        ({"header": ("A (B)",)}, "header must be printable ASCII without parentheses, got 'A (B)'"),
        ({"header": ("A\nG0 X1",)}, "header must be printable ASCII without parentheses, got 'A\\nG0 X1'"),
        ({"wcs": "G60"}, "wcs must be one of G54, G55, G56, G57, G58, G59, G54.1, got 'G60'"),
    ],
)
def test_options_are_checked(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=r"must|has no") as caught:
        WriteOptions(**options)
    assert str(caught.value) == message
