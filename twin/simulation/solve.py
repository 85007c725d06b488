"""Engagement and forces of many steps together, in threads.

Steps whose material no longer changes do not depend on each other. They are solved in parts of a fixed size, and a part
gives the same numbers to the last bit, whichever thread works on it and however many there are.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from twin.arrays import FloatArray
from twin.cutting.engagement import NO_ENGAGEMENT, Positions, Prepared, Scratch
from twin.motion.sweep import SweptVolume
from twin.record import Engagement
from twin.simulation.tools import ToolSetup
from twin.workpiece.trislice import TriSlices

_T = TypeVar("_T")
#: Steps that one thread works on at a time: enough to make calls cheap, few enough to stay in its cache; and most
#: entries of their engagement maps, for memory.
PART, PART_ENTRIES = 16, 4_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Solved:
    """Engagement and forces of one step.

    Attributes:
        engagement: of the tool with the material.
        loads: shape (n, 4), Fx, Fy, Fz in N and torque in N mm at the step's samples; None in air and without a force
            model.
    """

    engagement: Engagement
    loads: FloatArray | None


IN_AIR = Solved(NO_ENGAGEMENT, None)


class StepSolver:
    """Solves the steps of tools in one workpiece.

    Args:
        threads: how many parts are worked on at a time.
    """

    def __init__(self, workpiece: TriSlices, threads: int) -> None:
        self._workpiece = workpiece
        self._local = threading.local()
        self._pool = ThreadPoolExecutor(max_workers=threads) if threads > 1 else None

    def solve(
        self,
        tool: ToolSetup,
        at: Positions,
        spindle_rad: Sequence[FloatArray],
        spindle_rpm: FloatArray,
        pending: SweptVolume,
    ) -> Callable[[], list[Solved]]:
        """Begin to solve steps: their engagement and forces.

        The material must not change until the answer is there.

        Args:
            tool: the moving tool.
            at: positions of the tool, one per step.
            spindle_rad: signed spindle angles of each step's samples.
            spindle_rpm: shape (n,), signed speeds.
            pending: sweeps that are not yet subtracted from the slices.

        Returns:
            A function that waits for the answer, one `Solved` per step.
        """
        prepared = tool.engager.prepare(at, self._workpiece)
        size = max(1, min(PART, PART_ENTRIES // tool.engager.entries))

        def part(first: int) -> list[Solved]:
            last = min(first + size, len(at))
            of_part = at.part(first, last), spindle_rad[first:last], spindle_rpm[first:last]
            return self._part(tool, *of_part, pending, prepared)

        firsts = range(0, len(at), size)
        parts = map(part, firsts) if self._pool is None else self._pool.map(part, firsts)
        return lambda: [solved for solveds in parts for solved in solveds]

    def _part(
        self,
        tool: ToolSetup,
        at: Positions,
        spindle_rad: Sequence[FloatArray],
        spindle_rpm: FloatArray,
        pending: SweptVolume,
        prepared: Prepared,
    ) -> list[Solved]:
        maps = tool.engager.engage_all(at, self._workpiece, pending, prepared, self._scratch())
        if maps is None:
            return [IN_AIR] * len(at)
        loads: Sequence[FloatArray | None] = [None] * len(at)
        if tool.forces is not None:
            per_rev_mm = at.feed_mm_s * 60.0 / np.abs(spindle_rpm)
            loads = tool.forces.forces_of_steps(spindle_rad, np.sign(spindle_rpm), at.feed, per_rev_mm, maps)
        given = zip(maps.summaries, loads, strict=True)
        return [Solved(summary, load) if summary.cutting else IN_AIR for summary, load in given]

    def _scratch(self) -> Scratch:
        if not hasattr(self._local, "scratch"):
            self._local.scratch = Scratch()
        scratch: Scratch = self._local.scratch
        return scratch

    def close(self) -> None:
        """End the threads."""
        if self._pool is not None:
            self._pool.shutdown()


def one_ahead(items: Iterator[_T]) -> Iterator[_T]:
    """The same items, each passed on when the next one has been made, so that the work of both overlaps."""
    held: list[_T] = []
    for item in items:
        held.append(item)
        if len(held) > 1:
            yield held.pop(0)
    yield from held
