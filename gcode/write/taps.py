"""Taps: a stroke into a thread and one out of it are one block, because the spindle reverses between them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from gcode.events import PLANE_AXES, Block, Dwell, Event, LinearMotion, Notice, SpindleChange
from gcode.write.control_memory import ControlMemory, EventStream
from gcode.write.errors import WriteError
from gcode.write.machine_functions import pause
from gcode.write.numbers import Counts, plain

_CYCLES: Mapping[int, str] = {1: "G84", -1: "G74"}
#: Digits after the point of a pitch, which the control multiplies by the speed.
_PITCH_DECIMALS = 7


@dataclass(frozen=True, slots=True)
class Tap:
    """The events after the stroke into a thread.

    Attributes:
        out: the stroke out of it.
        seconds: dwell at the bottom.
        rigid: the spindle is stopped afterwards.
    """

    out: LinearMotion
    seconds: float
    rigid: bool


def tap_of(control: ControlMemory, event: LinearMotion, stream: EventStream) -> Tap:
    """Takes the rest of a tap from the stream.

    Raises:
        WriteError: where no stroke back to the start follows.
    """
    seconds = 0.0
    while (item := stream.take()) is not None:
        match item[1]:
            case Block() | Notice() | SpindleChange():
                continue
            case Dwell():
                seconds += item[1].seconds
            case LinearMotion(tapping=True) as out if _is_back(control, event, out):
                return Tap(out, seconds, _stops(stream, seconds))
            case _:
                break
    raise _error(
        control, event, "a tap without its return stroke", "the stroke out of the thread, back to its start, next"
    )


def _is_back(control: ControlMemory, into: LinearMotion, out: LinearMotion) -> bool:
    place = control.grid.point
    return place(out.start_mm) == place(into.end_mm) and place(out.end_mm) == place(into.start_mm)


def _stops(stream: EventStream, seconds: float) -> bool:
    """True where the spindle stops after a tap; the second dwell of the cycle is taken from the stream."""
    taken: list[tuple[int, Event]] = []
    while (item := stream.take()) is not None and isinstance(item[1], Block | Notice | Dwell):
        if isinstance(item[1], Dwell) and (not seconds or item[1].seconds != seconds):
            break
        if not isinstance(item[1], Dwell):
            taken.append(item)
    if item is not None:
        taken.append(item)
    stream.put_back(*taken)
    return item is not None and isinstance(item[1], SpindleChange) and item[1].spindle_direction == 0


def tap_blocks(control: ControlMemory, event: LinearMotion, tap: Tap, feed: str) -> Iterator[str]:
    """The blocks of a tap.

    Raises:
        WriteError: for one that the control has no words for.
    """
    kind = control.options.rules.tap
    if kind == "none" or not control.direction:
        problem = "tapping" if control.direction else "tapping while the spindle is stopped"
        raise _error(control, event, problem, "a control that taps" if control.direction else "M3 or M4 before it")
    yield from _CONTROLS[kind](control, event, tap, feed)
    control.words.pop("motion", None)
    control.at_mm, control.unsure = event.start_mm, False


def _cycle(control: ControlMemory, event: LinearMotion, tap: Tap, feed: str) -> Iterator[str]:
    """G84 or G74, with its R where the tool is."""
    _, _, k = PLANE_AXES[event.state.plane]
    start, end = _ends(control, event)
    if any(start[axis] != end[axis] for axis in range(3) if axis != k):
        expected = f"a tap along {'XYZ'[k]}, the normal of G{event.state.plane}"
        raise _error(control, event, "a tap that is not square to its plane", expected)
    cycles = control.options.dialect.cycles
    always_rigid = cycles is not None and cycles.always_rigid
    if tap.rigid and not always_rigid:
        yield control.line("M29", control.words["S"])
    words = [*control.modal("plane", f"G{event.state.plane}"), "G99", _CYCLES[control.direction]]
    words += [f"{axis}{control.grid.text(count)}" for axis, count in zip("XYZ", end, strict=True)]
    words.append(f"R{control.grid.text(start[k])}")
    if tap.seconds:
        words.append(pause(control, event, tap.seconds))
    control.words["F"] = feed
    yield control.line(*control.modal("distance", "G90"), *words, feed)
    yield control.line("G80")
    if tap.rigid or always_rigid:
        control.direction = 0


def _stroke(control: ControlMemory, event: LinearMotion, tap: Tap, _feed: str) -> Iterator[str]:
    """G33.1."""
    if tap.seconds:
        raise _error(control, event, f"a tap with a dwell of {tap.seconds:g} s", "a tap without a dwell (G33.1)")
    start, end = _ends(control, event)
    incremental = control.words.get("distance") == "G91"
    shown = (after - before if incremental else after for before, after in zip(start, end, strict=True))
    words = [f"{axis}{control.grid.text(count)}" for axis, count in zip("XYZ", shown, strict=True)]
    pitch = event.feed_mm_min / event.state.spindle_rpm / control.grid.unit_mm
    yield control.line("G33.1", *words, f"K{plain(pitch, _PITCH_DECIMALS)}")


def _ends(control: ControlMemory, event: LinearMotion) -> tuple[Counts, Counts]:
    assert control.at is not None
    return control.at, control.grid.point(event.end_mm)


def _error(control: ControlMemory, event: LinearMotion, problem: str, expected: str) -> WriteError:
    return control.error(event, "tap", problem, expected)


_CONTROLS = {"cycle": _cycle, "stroke": _stroke}
