"""A job's NC program as motions and events, and what must hold of it before anything is cut."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator

import numpy as np

from gcode.dialects import dialect_named
from gcode.events import Event, ToolChange
from gcode.flow.interpret import interpret
from gcode.language.program import read_program
from gcode.settings import MachineSettings
from twin.errors import ReplayError
from twin.job import Job
from twin.motion.from_nc import moves_from_nc
from twin.motion.path import Move


def program_moves(job: Job, settings: MachineSettings) -> Iterator[Move | Event]:
    """Motions of the tool tip in workpiece coordinates, and what else the program does, in order.

    Raises:
        GcodeError: a program that cannot be interpreted, when its line comes.
        TwinError: a motion that cannot be replayed.
    """
    program = job.program
    events = interpret(
        read_program(program.file), file=str(program.file), dialect=dialect_named(program.dialect), settings=settings
    )
    return moves_from_nc(
        events,
        origin_mm=np.array(job.machine.offsets[job.stock.wcs]),
        start_mm=settings.start_mm,
        tool_length_mm={t.number: t.length_mm for t in job.tools},
        rapid_mm_min=job.machine.rapid_mm_min,
    )


def checked_time_s(job: Job, settings: MachineSettings, tools: Collection[int]) -> float:
    """How long the program takes, motions and tool changes, with the whole of it read and its tools checked.

    Args:
        tools: numbers of the job's tools.

    Raises:
        ReplayError: a tool that is not in the job, a feed motion without a tool.
        TwinError, GcodeError: as `program_moves`.
    """
    return math.fsum(_checked_durations(job, settings, tools))


def _checked_durations(job: Job, settings: MachineSettings, tools: Collection[int]) -> Iterator[float]:
    known = ", ".join(str(n) for n in sorted(tools))
    for item in program_moves(job, settings):
        if isinstance(item, ToolChange):
            if item.tool not in tools and item.tool != 0:
                raise ReplayError(f"{item.place}: tool T{item.tool} is not in the job; expected one of {known}")
            yield job.machine.tool_change_s
        elif isinstance(item, Move):
            if item.tool == 0 and not item.rapid and item.length_mm > 0.0:
                raise ReplayError(
                    f"{job.program.file}:{item.nc_line}: feed motion without a tool in the spindle; "
                    "expected a tool change (T.. M6) before it, or program.tool in the job"
                )
            yield item.duration_s
