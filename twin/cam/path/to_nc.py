"""Tool paths to an NC program and a job file that replays it.

Part coordinates become program coordinates as is: the work offset is the part's origin.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np

from gcode.dialects import dialect_named
from gcode.errors import Place
from gcode.events import (
    ArcMotion,
    CoolantChange,
    Event,
    LinearMotion,
    MotionState,
    Plane,
    Point,
    ProgramStop,
    SpindleChange,
    ToolChange,
)
from gcode.write import WriteError, WriteOptions, write_program
from twin.arrays import FloatArray
from twin.cam.path.toolpath import Move, ToolPath
from twin.errors import ToolPathError
from twin.tools.shape import ToolShape

Coolant: TypeAlias = Literal["off", "mist", "flood"]
Dialect: TypeAlias = Literal["fanuc", "haas", "linuxcnc", "grbl"]

_NOWHERE = Place(file="tool path", line=1)
#: Digits after the point in mm: rounding is then 0.05 um an axis.
DECIMALS = 4
_PLANES: dict[int, Plane] = {17: 17, 18: 18, 19: 19}
#: Part of a turn by which a sweep may exceed whole turns and be those.
_SAME_TURN = 1e-9
#: Longest line of a header's comment.
_COMMENT = 100


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Operation:
    """A tool path with all that a program needs besides.

    Attributes:
        path: what the tool does.
        number: tool number, and that of its length offset.
        spindle_rpm: above 0; clockwise (M3).
        coolant: ``off``, ``mist`` or ``flood``.
        teeth: number of flutes, for the job file.
        length_mm: gauge length of the tool, for the job file and the length offset.
    """

    path: ToolPath
    number: int = 1
    spindle_rpm: float
    coolant: Coolant = "flood"
    teeth: int = 2
    length_mm: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class NcOptions:
    """How the program is written.

    Attributes:
        dialect: ``fanuc``, ``haas``, ``linuxcnc``, ``grbl``; the last has no tool change, so it takes one tool only.
        decimals: digits after the point of coordinates, mm.
        header: comments at the program's beginning.
        wcs: work offset whose zero is the part's origin.
        program_number: O word, where the control has one.
    """

    dialect: Dialect = "fanuc"
    decimals: int = DECIMALS
    header: tuple[str, ...] = ()
    wcs: str = "G54"
    program_number: int | None = None


def write_nc(path: Path | str, operations: Sequence[Operation], options: NcOptions) -> int:
    """Write a program, whole or not at all.

    Args:
        operations: carried out in their order.

    Returns:
        Number of lines.

    Raises:
        ToolPathError: nothing is cut, two tools on a control without tool change, or the file cannot be written.
    """
    operations = [o for o in operations if o.path.moves]
    if not operations or all(o.path.empty for o in operations):
        raise ToolPathError(f"{path}: no file is written, for the tool path is empty; expected one that cuts something")
    try:
        return write_program(path, nc_events(operations, options), _write_options(operations, options))
    except (WriteError, ValueError) as error:
        raise ToolPathError(f"{path}: {error}") from error
    except OSError as error:
        raise ToolPathError(f"{path}: cannot be written: {error.strerror}") from error


def _write_options(operations: Sequence[Operation], options: NcOptions) -> WriteOptions:
    numbers = {o.number for o in operations}
    if options.dialect == "grbl" and len(numbers) > 1:
        raise ToolPathError(f"grbl has no tool change: tools {sorted(numbers)}; expected one tool")
    lines = [*options.header, *(line for o in operations for line in _comments(o))]
    return WriteOptions(
        dialect=dialect_named(options.dialect),
        decimals=options.decimals,
        header=tuple(plain_comment(line) for line in lines),
        wcs=options.wcs,
        program_number=options.program_number,
        tool=operations[0].number if options.dialect == "grbl" else 0,
    )


def _comments(operation: Operation) -> Iterator[str]:
    path = operation.path
    yield f"T{operation.number}: {describe(path.tool)}, S{operation.spindle_rpm:g}: {path.name or 'tool path'}"
    yield from path.notes


def plain_comment(text: str) -> str:
    """Text as every control takes it in a comment: printable ASCII, no parentheses, not too long."""
    swapped = text.translate({ord("("): "[", ord(")"): "]", ord("²"): "2", ord("³"): "3", ord("µ"): "u"})
    ascii_only = "".join(c if c.isascii() and c.isprintable() else "?" for c in swapped)
    return ascii_only[:_COMMENT].rstrip()


def describe(tool: ToolShape) -> str:
    """A tool in a few words: ``ball D8``."""
    kind, diameter = kind_of(tool), 2.0 * tool.nominal_radius_mm
    corner = f" rc{tool.corner_radius_mm:g}" if kind in ("bull", "taper") and tool.corner_radius_mm else ""
    return f"{kind} D{diameter:g}{corner}"


def kind_of(tool: ToolShape) -> Literal["flat", "ball", "bull", "taper"]:
    """The catalogue's name of a shape."""
    if tool.taper_rad:
        return "taper"
    if tool.corner_radius_mm == 0.0:
        return "flat"
    return "ball" if tool.disc_mm == 0.0 else "bull"


def nc_events(operations: Iterable[Operation], options: NcOptions) -> Iterator[Event]:
    """The events of a program: tool, spindle, coolant, motions with a length offset, end."""
    tool, at, spindle, coolant = 0, None, 0.0, "off"
    last: Operation | None = None
    for operation in operations:
        state = _state(operation, options)
        if operation.number != tool:
            if last is not None and at is not None:
                yield from _above_longer(last, at, operation, _state(last, options))
                at = _tip_after_change(last, at, operation)
            if tool and coolant != "off":
                yield CoolantChange(place=_NOWHERE, mist=False, flood=False)
            yield ToolChange(place=_NOWHERE, tool=operation.number)
            tool, spindle, coolant = operation.number, 0.0, "off"
        if operation.spindle_rpm != spindle:
            spindle = operation.spindle_rpm
            yield SpindleChange(place=_NOWHERE, spindle_rpm=spindle, spindle_direction=1)
        if operation.coolant != coolant:
            coolant = operation.coolant
            yield CoolantChange(place=_NOWHERE, mist=coolant == "mist", flood=coolant == "flood")
        yield from _motions(operation, state, at)
        at, last = operation.path.moves[-1].end_mm, operation
    yield CoolantChange(place=_NOWHERE, mist=False, flood=False)
    yield SpindleChange(place=_NOWHERE, spindle_rpm=spindle, spindle_direction=0)
    yield ProgramStop(place=_NOWHERE, optional=False, end=True)


def _above_longer(last: Operation, at: FloatArray, following: Operation, state: MotionState) -> Iterator[LinearMotion]:
    """Up by as much as the following tool is longer, so that its tip is not below this one."""
    longer = following.length_mm - last.length_mm
    if longer > 0.0:
        above = (float(at[0]), float(at[1]), float(at[2]) + longer)
        yield LinearMotion(place=_NOWHERE, state=state, start_mm=_point(at), end_mm=above, rapid=True, feed_mm_min=0.0)


def _tip_after_change(last: Operation, at: FloatArray, following: Operation) -> FloatArray:
    """Where the tip of the following tool is: the spindle stays where it is."""
    shorter = max(0.0, last.length_mm - following.length_mm)
    return np.array([at[0], at[1], at[2] + shorter])


def _state(operation: Operation, options: NcOptions) -> MotionState:
    offset = options.dialect != "grbl"
    return MotionState(
        tool=operation.number,
        spindle_rpm=operation.spindle_rpm,
        spindle_direction=1,
        length_offset_mm=operation.length_mm if offset else 0.0,
        length_number=operation.number if offset else None,
        wcs=options.wcs,
    )


def _motions(operation: Operation, state: MotionState, at: FloatArray | None) -> Iterator[LinearMotion | ArcMotion]:
    """An operation's motions; a rapid to its first point is put in front."""
    first = operation.path.moves[0].start_mm
    begin = _point(first if at is None else at)
    if at is not None and begin != _point(first):
        over = (float(first[0]), float(first[1]), max(begin[2], float(first[2])))
        for end in (over, _point(first)):
            if end != begin:
                yield LinearMotion(place=_NOWHERE, state=state, start_mm=begin, end_mm=end, rapid=True, feed_mm_min=0.0)
                begin = end
    elif at is None:
        yield LinearMotion(place=_NOWHERE, state=state, start_mm=begin, end_mm=begin, rapid=True, feed_mm_min=0.0)
    for move in operation.path.moves:
        for event in _move_events(move, state, begin):
            yield event
            begin = event.end_mm


def _move_events(move: Move, state: MotionState, begin: Point) -> Iterator[LinearMotion | ArcMotion]:
    if move.arc is not None:
        plane: Plane = _PLANES[move.arc.plane]
        turns = max(1, math.ceil(abs(move.arc.sweep_rad) / math.tau - _SAME_TURN))
        yield ArcMotion(
            place=_NOWHERE,
            state=replace(state, plane=plane),
            start_mm=begin,
            end_mm=_point(move.end_mm),
            centre_mm=_point(move.arc.centre_mm),
            plane=plane,
            turns=turns if move.arc.sweep_rad > 0.0 else -turns,
            feed_mm_min=move.feed_mm_min,
        )
        return
    points: list[Point] = [begin, *map(tuple, move.points_mm[1:].tolist())]
    for start, end in pairwise(points):
        yield LinearMotion(
            place=_NOWHERE, state=state, start_mm=start, end_mm=end, rapid=move.rapid, feed_mm_min=move.feed_mm_min
        )


def _point(point: FloatArray) -> Point:
    return (float(point[0]), float(point[1]), float(point[2]))
