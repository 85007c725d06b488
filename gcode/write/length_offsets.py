"""Tool length offsets: the words that set them, and where the controlled point is afterwards."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from gcode.dialects.codes import Status
from gcode.events import Motion
from gcode.settings import ToolOffset
from gcode.write.control_memory import ControlMemory, LengthOffset
from gcode.write.numbers import plain

#: Two positions or lengths that differ by no more than this, mm, are one.
SAME_MM = 1e-6
#: Decimals of a length that is not a row of a table.
_LENGTH_DECIMALS = 7
_SIGNS: Mapping[str, float] = {"G43": 1.0, "G44": -1.0}


def set_length(control: ControlMemory, event: Motion) -> tuple[list[str], list[str]]:
    """Puts on the length offset of a motion, and checks that the motion begins where the last one ended.

    Returns:
        Words for a block of their own, and words for the block of the motion.

    Raises:
        WriteError: for a gap between motions, and for an offset that cannot be written.
    """
    state, old = event.state, control.length
    new = LengthOffset(state.length_number, state.length_offset_mm, state.tool_offset_xy_mm)
    _check_gap(control, event, old, new)
    if old == new:
        return [], []
    control.length, control.unsure = new, True
    control.at = control.grid.point(event.start_mm)
    words = list(_words(control, event, new))
    return (words, []) if words[0] == "G43.1" else ([], words)


def check_gap(control: ControlMemory, event: Motion) -> None:
    """Checks that a motion with the offset of the last one begins where that ended.

    Raises:
        WriteError: for a gap between them.
    """
    if control.at_mm != event.start_mm:
        _check_gap(control, event, control.length, control.length)


def _check_gap(control: ControlMemory, event: Motion, old: LengthOffset, new: LengthOffset) -> None:
    if control.at_mm is None:
        return
    moved = zip(control.at_mm, old.vector_mm, new.vector_mm, strict=True)
    expected = tuple(at + before - after for at, before, after in moved)
    if math.dist(expected, event.start_mm) > max(SAME_MM, control.grid.step_mm):
        problem = f"a motion from {_shown(event.start_mm)}, where the last one ended at {_shown(expected)}"
        raise control.error(event, "gap", problem, "motions that begin where the last one ends")


def _words(control: ControlMemory, event: Motion, new: LengthOffset) -> Iterator[str]:
    dialect = control.options.dialect
    dynamic = dialect.codes.get("G43.1")
    if new == LengthOffset():
        yield "G49"
    elif new.number is not None and "G43" in dialect.codes:
        yield _by_number(control, event, new.number, new.length_mm)
        yield f"H{new.number}"
    elif dynamic is not None and dynamic.status is Status.EXECUTED:
        yield dynamic.code
        for axis, length in zip("XYZ", new.vector_mm, strict=True):
            if axis in dynamic.letters:
                yield f"{axis}{plain(length / control.grid.unit_mm, _LENGTH_DECIMALS)}"
    else:
        problem = f"a length offset of {new.length_mm:g} mm without a number"
        raise control.error(event, "tool-length", problem, f"an offset with a number, as {dialect.name} requires")


def _by_number(control: ControlMemory, event: Motion, number: int, length_mm: float) -> str:
    """G43, or G44 where the table shows that the length is subtracted."""
    tools, codes = control.options.tools, control.options.dialect.codes
    if tools is None:
        return "G43"
    row = tools.get(number, ToolOffset())
    for code, sign in _SIGNS.items():
        if code in codes and abs(sign * row.whole_length_mm - length_mm) <= SAME_MM:
            return code
    problem = f"H{number} with a length of {length_mm:g} mm"
    raise control.error(event, "tool-length", problem, f"{row.whole_length_mm:g} mm, as in the tool table")


def _shown(point: tuple[float, ...]) -> str:
    return f"({', '.join(f'{value:.6g}' for value in point)})"
