"""Material removal of a job alone, without engagement, forces and records."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import closing
from itertools import pairwise

from gcode.events import ToolChange
from twin.job import Job
from twin.motion.path import Move
from twin.record import Collision
from twin.simulation.chords import chain_groups, chains
from twin.simulation.contacts import Contacts, box_of, collision_record, forbidden
from twin.simulation.material import Material
from twin.simulation.setup import prepare
from twin.simulation.short_motions import Joined, joined
from twin.simulation.tools import ToolSetup
from twin.workpiece.trislice import TriSlices

#: Called with the machine time of the whole program before it runs, and with machine time and NC line while it runs.
Begin = Callable[[float], None]
At = Callable[[float, int], None]


def machined(
    job: Job, *, begin: Begin = lambda _t: None, at: At = lambda _t, _n: None, threads: int = 2
) -> tuple[TriSlices, tuple[Collision, ...]]:
    """Machine a job's program from its stock.

    Args:
        job: the job.
        begin: called once with the machine time of the whole program, s.
        at: called for every motion with its start time, s, and NC line.
        threads: number of threads.

    Returns:
        The machined workpiece and the collisions.

    Raises:
        TwinError, GcodeError: a job or program that cannot be replayed.
    """
    with closing(prepare(job, threads=threads, preview=False)) as setup:
        begin(setup.header.planned_time_s)
        collisions, t_s = list[Collision](), 0.0
        for any_item in joined(setup.moves, setup.step_mm, setup.tolerance.join_mm):
            item = any_item.whole if isinstance(any_item, Joined) else any_item
            if isinstance(item, ToolChange):
                t_s += job.machine.tool_change_s
            if not isinstance(item, Move):
                continue
            at(t_s, item.nc_line)
            tool = setup.tools.get(item.tool)
            if tool is not None and item.length_mm > 0.0 and setup.material.near(tool, *box_of(item)):
                contacts = _cut(setup.material, tool, item, setup.tolerance.chord_mm, t_s)
                collisions += (
                    collision_record(kind, met, item, str(job.program.file), shank_assumed=tool.shank_assumed)
                    for kind, met in contacts.found(setup.material.contact_mm3).items()
                )
            t_s += item.duration_s
        setup.material.flush()
        return setup.material.workpiece, tuple(collisions)


def _cut(material: Material, tool: ToolSetup, move: Move, chord_mm: float, t_s: float) -> Contacts:
    """Remove the material of one motion and return its forbidden contacts."""
    contacts = Contacts()
    pieces = ((start, end, 0.0) for start, end in pairwise(move.corners_mm(math.inf, chord_mm)))
    if chains(move) and forbidden(move) is None:
        for chords in chain_groups(pieces, tool, material):
            for start, end, _ in chords:
                material.add_chord(tool, start, end)
                contacts.add(material.touches(tool, start, end), t_s, start)
        return contacts
    for start, end, _ in pieces:
        contacts.add(material.cut(tool, start, end, forbidden(move)), t_s, start)
        contacts.add(material.touches(tool, start, end), t_s, start)
    return contacts
