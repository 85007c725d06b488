"""A job's material removal alone: no engagement, no forces, no records."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np

from gcode.dialects import dialect_named
from gcode.interpret import interpret
from gcode.program import read_program
from twin.errors import ReplayError
from twin.job import Job
from twin.motion.from_nc import moves_from_nc
from twin.motion.path import Move
from twin.record import Collision
from twin.run.contacts import Contacts, box_of, collision_record, forbidden
from twin.run.material import Material
from twin.run.setup import machine_settings, stock_slices, tool_setup, workpiece
from twin.tolerance import Tolerance
from twin.workpiece.trislice import TriSlices

#: Told of machine time and NC line while the program runs, and of the whole machine time before.
Begin = Callable[[float], None]
At = Callable[[float, int], None]


def machined(
    job: Job, *, begin: Begin = lambda _t: None, at: At = lambda _t, _n: None, threads: int = 2
) -> tuple[TriSlices, tuple[Collision, ...]]:
    """Cut a job's program out of its stock.

    Returns:
        The workpiece afterwards, and what touched it that must not.

    Raises:
        TwinError, GcodeError: a job or program that cannot be replayed.
    """
    tolerance = Tolerance.for_pitch(job.simulation.slice_pitch_mm)
    slices = stock_slices(job)
    tools = {t.number: tool_setup(job, t, tolerance) for t in job.tools}
    store = workpiece(job, slices)
    moves = list(_moves(job))
    for move in moves:
        if move.tool not in tools and not (move.tool == 0 and move.rapid):
            known = ", ".join(str(n) for n in sorted(tools))
            raise ReplayError(
                f"{job.program.file}:{move.nc_line}: tool T{move.tool} is not in the job; expected one of {known}"
            )
    begin(math.fsum(m.duration_s for m in moves))
    material, collisions, t_s = Material(store, tolerance, threads), list[Collision](), 0.0
    try:
        for move in moves:
            at(t_s, move.nc_line)
            tool = tools.get(move.tool)
            if tool is not None and material.near(tool, *box_of(move)):
                contacts = Contacts()
                for start, end in pairwise(move.corners_mm(math.inf, tolerance.chord_mm)):
                    contacts.add(material.cut(tool, start, end, forbidden(move)), t_s, start)
                    contacts.add(material.touches(tool, start, end), t_s, start)
                collisions += [
                    collision_record(kind, contact, move, str(job.program.file))
                    for kind, contact in contacts.found.items()
                ]
            t_s += move.duration_s
        material.flush()
    finally:
        material.close()
    return store, tuple(collisions)


def _moves(job: Job) -> Iterator[Move]:
    program = job.program
    settings = machine_settings(job, stock_slices(job))
    events = interpret(
        read_program(program.file), file=str(program.file), dialect=dialect_named(program.dialect), settings=settings
    )
    moves = moves_from_nc(
        events,
        origin_mm=np.array(job.machine.offsets[job.stock.wcs]),
        start_mm=settings.start_mm,
        tool_length_mm={t.number: t.length_mm for t in job.tools},
        rapid_mm_min=job.machine.rapid_mm_min,
    )
    for item in moves:
        if isinstance(item, Move) and item.length_mm > 0.0:
            yield item
