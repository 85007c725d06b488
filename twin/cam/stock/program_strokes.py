"""NC programs as strokes of their tools, without an object for each motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gcode.dialects import FANUC, Dialect
from gcode.errors import GcodeError, Place
from gcode.events import MotionState
from gcode.flow.interpreter import ProgramSource
from gcode.report.motion_arrays import MotionArrays, MotionKind, motion_arrays
from gcode.settings import MachineSettings
from twin.arrays import FloatArray, frozen
from twin.cam.path.toolpath import arc_sweep_rad
from twin.cam.stock.dexel import Dexels
from twin.cam.stock.strokes import CHORD_MM, Strokes
from twin.motion.path import Arc, Move
from twin.tools.shape import ToolShape


def cut_program(
    stock: Dexels,
    program: ProgramSource,
    tools: Mapping[int, ToolShape],
    *,
    file: str = "<program>",
    dialect: Dialect = FANUC,
    settings: MachineSettings | None = None,
    origin_mm: ArrayLike = (0.0, 0.0, 0.0),
    tool_length_mm: Mapping[int, float] | None = None,
    chord_mm: float = CHORD_MM,
    threads: int | None = None,
) -> None:
    """Lower the stock by all motions of a program, rapid ones too; without a tool of ``tools`` nothing is cut.

    Args:
        stock: in the workpiece frame; changed in place, up to the block that is refused if one is.
        tools: shape of each tool by number.
        origin_mm: origin of the workpiece frame in machine coordinates, shape (3,).
        tool_length_mm: gauge length of each tool; tools that are missing count as 0 (`twin.motion.from_nc`).
        chord_mm: how far chords may lie off arcs that are not level.

    Raises:
        GcodeError: a block that is refused, or a motion with an axis besides X, Y and Z away from 0.
    """
    origin = frozen(origin_mm, "origin_mm", (3,))
    for batch in motion_arrays(program, file=file, dialect=dialect, settings=settings):
        _refuse_further_axes(batch)
        for number, strokes in program_strokes(batch, origin, tool_length_mm or {}, chord_mm):
            if number in tools:
                stock.cut(tools[number], strokes, threads)


def program_strokes(
    motions: MotionArrays, origin_mm: FloatArray, tool_length_mm: Mapping[int, float], chord_mm: float = CHORD_MM
) -> Iterator[tuple[int, Strokes]]:
    """Strokes of the tool tip for each tool, by number."""
    lifts = np.array([_lift(state, tool_length_mm) for state in motions.states]).reshape(-1, 3)
    lift = lifts[motions.state] - origin_mm
    tool = motions.tool
    for number in np.unique(tool).tolist():
        lines = (tool == number) & np.isin(motions.kind, (MotionKind.RAPID, MotionKind.FEED, MotionKind.TAP))
        arcs = np.flatnonzero((tool == number) & (motions.kind == MotionKind.ARC))
        curved = Strokes.of_moves((_arc(motions, int(i), lift[i]) for i in arcs), chord_mm)
        yield (
            number,
            Strokes(
                np.concatenate((motions.start_mm[lines] + lift[lines], curved.starts_mm)),
                np.concatenate((motions.end_mm[lines] + lift[lines], curved.ends_mm)),
                curved.arcs,
            ),
        )


def _lift(state: MotionState, lengths: Mapping[int, float]) -> tuple[float, float, float]:
    """From the controlled point to the tool tip."""
    x, y = state.tool_offset_xy_mm
    return x, y, state.length_offset_mm - lengths.get(state.tool, 0.0)


def _arc(motions: MotionArrays, i: int, lift: FloatArray) -> Move:
    start, end, centre = motions.start_mm[i], motions.end_mm[i], motions.centre_mm[i]
    plane = int(motions.plane[i])
    sweep = arc_sweep_rad(start, end, centre, plane, int(motions.turns[i]))
    return Move(
        start_mm=start + lift,
        end_mm=end + lift,
        arc=Arc(centre_mm=centre + lift, plane=plane, sweep_rad=sweep),
        duration_s=0.0,
        feed_mm_min=0.0,
        spindle_rpm=0.0,
        tool=0,
        rapid=False,
        nc_line=int(motions.line[i]),
    )


def _refuse_further_axes(motions: MotionArrays) -> None:
    further: NDArray[np.bool_] = (motions.extra != 0.0).any(axis=1)
    if further.any():
        i = int(np.argmax(further))
        place = Place(file=motions.files[int(motions.file[i])], line=int(motions.line[i]))
        problem = "an axis besides X, Y, Z is not at 0"
        raise GcodeError(place, "further-axis", problem, "a program for three axes")
