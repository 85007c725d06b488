"""Programs from events."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from gcode.events import (
    ArcMotion,
    Block,
    CoolantChange,
    Dwell,
    Event,
    LinearMotion,
    Notice,
    ProgramStop,
    SpindleChange,
    ToolChange,
)
from gcode.whole_file import whole_file
from gcode.write.control_memory import ControlMemory, EventStream
from gcode.write.machine_functions import coolant, dwell, spindle_change, stop, tool_change
from gcode.write.motions import motion
from gcode.write.options import WriteOptions


def program_lines(events: Iterable[Event], options: WriteOptions | None = None) -> Iterator[str]:
    """The lines of a program with these events.

    The program's motions are the events' motions with each point rounded to the decimals that are written, so no
    error adds up, incremental programs included. An arc that rounding would change, or that the control
    would refuse, becomes chords within one count of the last decimal. An arc that is the first motion, or the first
    after a change of tool or length offset, is led in by a straight feed to its start. Every feed is one per minute
    (G94). Cutter compensation, work offsets, subprograms and cycles are already in the motions and are not written
    again, but for taps. Tool, spindle and length offset are taken from the events that change them and, where there
    are none, from the motions' states. `Block` and `Notice` are not written.

    Args:
        events: from `interpret`, or own motions; each begins at the end of the one before.
        options: default `WriteOptions()`.

    Yields:
        Lines without their ends.

    Raises:
        WriteError: at the first event that cannot be written; the lines before it have been yielded.
    """
    options = options or WriteOptions()
    control = ControlMemory(options, options.grid, options.tool)
    stream = EventStream(iter(enumerate(events)))
    yield from _beginning(control)
    while (item := stream.take()) is not None:
        control.index, event = item
        yield from _blocks(control, event, stream)
    yield from _ending(control)


def write_program(path: Path | str, events: Iterable[Event], options: WriteOptions | None = None) -> int:
    """Writes a program file, whole or not at all: an existing file stays until the new one is complete.

    Args:
        path: file to write.
        events: as for `program_lines`.
        options: default `WriteOptions()`.

    Returns:
        Number of lines.

    Raises:
        WriteError: see `program_lines`.
        OSError: where the file cannot be written.
    """
    path, lines = Path(path), 0
    with whole_file(path) as partial, partial.open("w", encoding="ascii", newline="\n") as file:
        for line in program_lines(events, options):
            file.write(f"{line}\n")
            lines += 1
    return lines


def _beginning(control: ControlMemory) -> Iterator[str]:
    options, rules = control.options, control.options.rules
    if options.with_percent:
        yield "%"
    if options.program_number is not None:
        yield f"O{options.program_number:0{rules.program_digits}d}"
    for line in options.header:
        yield f"({line})"
    modes = rules.safe_start if options.safe_start else "G90"
    control.words["distance"] = "G90"
    if options.safe_start:
        control.words["plane"] = "G17"
    yield control.line("G20" if options.units == "inch" else "G21", modes, *([options.wcs] if options.wcs else []))


def _ending(control: ControlMemory) -> Iterator[str]:
    if not control.ended:
        yield control.line("M30")
    if control.options.with_percent:
        yield "%"


def _blocks(control: ControlMemory, event: Event, stream: EventStream) -> Iterator[str]:
    if control.ended and not isinstance(event, Block | Notice):
        raise control.error(event, "after-end", "an event after the end of the program", "the end as the last event")
    if isinstance(event, LinearMotion | ArcMotion):
        return motion(control, event, stream)
    if not isinstance(event, Block | Notice):
        control.state = None
    match event:
        case ToolChange():
            return tool_change(control, event)
        case SpindleChange():
            return spindle_change(control, event)
        case CoolantChange():
            return coolant(control, event)
        case Dwell():
            return dwell(control, event)
        case ProgramStop():
            return stop(control, event)
        case Block() | Notice():
            return iter(())
