"""A job's material removal alone: no engagement, no forces, no records."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import closing
from itertools import pairwise

from gcode.events import ToolChange
from twin.job import Job
from twin.motion.path import Move
from twin.record import Collision
from twin.simulation.contacts import Contacts, box_of, collision_record, forbidden
from twin.simulation.material import Material
from twin.simulation.setup import prepare
from twin.simulation.tools import ToolSetup
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
    with closing(prepare(job, threads=threads, preview=False)) as setup:
        begin(setup.header.planned_time_s)
        collisions, t_s = list[Collision](), 0.0
        for item in setup.moves:
            if isinstance(item, ToolChange):
                t_s += job.machine.tool_change_s
            if not isinstance(item, Move):
                continue
            at(t_s, item.nc_line)
            tool = setup.tools.get(item.tool)
            if tool is not None and item.length_mm > 0.0 and setup.material.near(tool, *box_of(item)):
                contacts = _cut(setup.material, tool, item, setup.tolerance.chord_mm, t_s)
                name = str(job.program.file)
                collisions += [collision_record(kind, found, item, name) for kind, found in contacts.found.items()]
            t_s += item.duration_s
        setup.material.flush()
        return setup.material.workpiece, tuple(collisions)


def _cut(material: Material, tool: ToolSetup, move: Move, chord_mm: float, t_s: float) -> Contacts:
    """Take one motion away; what touched that must not."""
    contacts = Contacts()
    for start, end in pairwise(move.corners_mm(math.inf, chord_mm)):
        contacts.add(material.cut(tool, start, end, forbidden(move)), t_s, start)
        contacts.add(material.touches(tool, start, end), t_s, start)
    return contacts
