"""A job's material removal alone: no engagement, no forces, no records."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

from gcode.events import ToolChange
from twin.job import Job
from twin.motion.path import Move
from twin.record import Collision
from twin.simulation.contacts import Contacts, box_of, collision_record, forbidden
from twin.simulation.material import Material
from twin.simulation.program import checked_time_s, program_moves
from twin.simulation.setup import ToolSetup, machine_settings, stock_slices, tool_setup, workpiece
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
    settings = machine_settings(job, slices)
    tools = {t.number: tool_setup(job, t, tolerance) for t in job.tools}
    begin(checked_time_s(job, settings, tools))
    store = workpiece(job, slices)
    material, collisions, t_s = Material(store, tolerance, threads), list[Collision](), 0.0
    try:
        for item in program_moves(job, settings):
            if isinstance(item, ToolChange):
                t_s += job.machine.tool_change_s
            if not isinstance(item, Move):
                continue
            at(t_s, item.nc_line)
            tool = tools.get(item.tool)
            if tool is not None and item.length_mm > 0.0 and material.near(tool, *box_of(item)):
                contacts = _cut(material, tool, item, tolerance, t_s)
                place = str(job.program.file)
                collisions += [collision_record(kind, found, item, place) for kind, found in contacts.found.items()]
            t_s += item.duration_s
        material.flush()
    finally:
        material.close()
    return store, tuple(collisions)


def _cut(material: Material, tool: ToolSetup, move: Move, tolerance: Tolerance, t_s: float) -> Contacts:
    """Take one motion away; what touched that must not."""
    contacts = Contacts()
    for start, end in pairwise(move.corners_mm(math.inf, tolerance.chord_mm)):
        contacts.add(material.cut(tool, start, end, forbidden(move)), t_s, start)
        contacts.add(material.touches(tool, start, end), t_s, start)
    return contacts
