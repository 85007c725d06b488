"""Engagement without forces: found at some of many steps, and at those between only where it changes."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from twin.cutting.engagement import Positions
from twin.motion.sweep import SweptVolume
from twin.record import Engagement
from twin.simulation.setup import Setup
from twin.simulation.solve import Solved
from twin.simulation.tools import ToolSetup

#: Longest distance from a step whose engagement is found to the next, in steps and in tool radii.
_APART_STEPS, _APART_RADII = 8.0 * (1.0 + 1e-9), 0.25
#: Engagements are alike when width, arc and removal rate differ by no more than this part, or by a slice's pitch.
_ALIKE = 0.1


def solved_where_it_changes(
    at: Positions, length_mm: float, spindle_rpm: float, tool: ToolSetup, setup: Setup, pending: SweptVolume
) -> list[Solved]:
    """The engagement at each position along a path, found at some of them.

    Where two next to each other are not alike, one halfway between them is found too, and so on. Others take that of
    the nearest.

    Args:
        length_mm: longest distance between neighbours.
        pending: sweeps that are not yet subtracted from the slices.
    """
    n, apart_mm = len(at), min(_APART_STEPS * setup.step_mm, _APART_RADII * tool.cutter.radius_mm)
    wanted = np.unique(np.append(np.arange(0, n, max(1, int(apart_mm / length_mm))), n - 1)).tolist()
    solved: dict[int, Solved] = {}
    pitch_mm = float(np.max(setup.material.workpiece.pitch_mm))
    while wanted:
        nothing, rpm = [np.zeros(0)] * len(wanted), np.full(len(wanted), spindle_rpm)
        solved |= zip(wanted, setup.solver.solve(tool, at.take(wanted), nothing, rpm, pending)(), strict=True)
        wanted = [
            (a + b) // 2
            for a, b in pairwise(sorted(solved))
            if b - a > 1 and not _alike(solved[a].engagement, solved[b].engagement, pitch_mm, tool.cutter.radius_mm)
        ]
    known = np.array(sorted(solved), dtype=np.int64)
    return [solved[i] for i in known[_nearest(known, n)].tolist()]


def _nearest(known: NDArray[np.int64], n: int) -> NDArray[np.int64]:
    """For each number below n, which of the known ones, in order, is nearest; the lower of two."""
    right = np.searchsorted(known, np.arange(n))
    left = np.maximum(0, right - 1)
    return np.where(known[right] - np.arange(n) < np.arange(n) - known[left], right, left)


def _alike(a: Engagement, b: Engagement, pitch_mm: float, radius_mm: float) -> bool:
    """Whether two engagements are nearly the same, to what slices resolve."""
    if a.cutting != b.cutting:
        return False
    width_mm = max(a.radial_width_mm, b.radial_width_mm)
    rate_mm3_s = max(a.removal_rate_mm3_s, b.removal_rate_mm3_s)
    pairs = (
        (a.radial_width_mm, b.radial_width_mm, pitch_mm),
        (a.arc_rad, b.arc_rad, pitch_mm / radius_mm),
        (a.removal_rate_mm3_s, b.removal_rate_mm3_s, rate_mm3_s * pitch_mm / width_mm if width_mm > 0.0 else 0.0),
    )
    return all(abs(x - y) <= max(_ALIKE * max(x, y), least) for x, y, least in pairs)
