"""Chains of sweeps taken out of a workpiece: the material that is left is that of one sweep after the other."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from twin.arrays import FloatArray
from twin.motion.chain import chained
from twin.motion.sweep import Body, Sweep
from twin.tolerance import Tolerance
from twin.tools.shape import tool_shape
from twin.workpiece.removal import Removal
from twin.workpiece.retraced import Retraced
from twin.workpiece.stock import box_slices
from twin.workpiece.trislice import CellSlices, TriSlices

PITCH_MM = 0.2
TOLERANCE = Tolerance.for_pitch(PITCH_MM)
BLOCK = box_slices((0.0, 0.0, -2.0), (8.0, 8.0, 0.0), PITCH_MM)
BODIES = {
    kind: Body.of(tool_shape(kind, 3.0, 8.0, 0.5, 5.0), chord_mm=TOLERANCE.chord_mm)  # type: ignore[arg-type]
    for kind in ("flat", "ball", "bull", "taper")
}


def helix(kind: str, turns: int, down_mm: float, r: float = 1.0, chords: int = 32) -> list[Sweep]:
    """A helix about the middle of the block, from its top."""
    at = np.arange(turns * chords + 1) / chords
    angle = 2.0 * math.pi * at
    tips = np.column_stack((4.0 + r * np.cos(angle), 4.0 + r * np.sin(angle), -0.013 - down_mm * at))
    return [Sweep(BODIES[kind], a, b) for a, b in pairwise(tips)]


def in_chains(piece: TriSlices, sweeps: list[Sweep], together: int, then: Sweep | None = None) -> float:
    """Cut in groups as a replay does, and at the end what was left."""
    with Removal(piece, TOLERANCE.chord_mm, threads=1) as removal:
        volume = 0.0
        for first in range(0, len(sweeps), together):
            after = sweeps[first + together] if first + together < len(sweeps) else then
            volume += float(removal.cut_all(list(chained(sweeps[first : first + together])), after=after).sum())
        if removal.left is not None:
            volume += removal.cut(removal.left)
        assert removal.left is None
    return volume


def one_by_one(piece: TriSlices, sweeps: list[Sweep]) -> float:
    with Removal(piece, TOLERANCE.chord_mm, threads=1) as removal:
        return float(removal.cut_all(sweeps).sum())


@pytest.mark.compiled
@pytest.mark.parametrize("kind", BODIES)
@pytest.mark.parametrize("down_mm", [0.15, 0.0, -0.01], ids=["down", "level", "up"])
def test_turns_cut_in_chains_leave_the_same_material(kind: str, down_mm: float) -> None:
    sweeps = helix(kind, 3, down_mm)
    if down_mm < 0.0:
        sweeps = [Sweep(s.body, s.start_mm - (0, 0, 0.8), s.end_mm - (0, 0, 0.8)) for s in sweeps]
    fast, slow = CellSlices(BLOCK), CellSlices(BLOCK)
    # both lie between the tool and the tool enlarged by a chord's deviation
    surface_mm2 = 2.0 * math.pi * 2.5 * (0.5 + abs(down_mm)) + math.pi * 2.5**2
    assert in_chains(fast, sweeps, 24, sweeps[-1]) == pytest.approx(
        one_by_one(slow, sweeps), abs=TOLERANCE.chord_mm * surface_mm2
    )
    for axis in range(3):
        assert np.abs(fast.areas_mm2(axis) - slow.areas_mm2(axis)).max() < 16.0 * TOLERANCE.chord_mm
        volume = fast.volume_mm3(axis)
        assert volume == pytest.approx(slow.volume_mm3(axis), abs=TOLERANCE.chord_mm * surface_mm2)


@pytest.mark.compiled
def test_a_flat_tool_on_a_helix_makes_a_round_hole() -> None:
    piece, radius, turns = CellSlices(BLOCK), 2.5, 3
    sweeps = helix("flat", turns, 0.2, 1.0, 128)
    floor = sweeps[-1].end_mm[2]
    corners = [np.array([*s.start_mm[:2], floor]) for s in sweeps[:128]]
    level = [Sweep(BODIES["flat"], a, b) for a, b in pairwise([*corners, sweeps[-1].end_mm])]
    in_chains(piece, [*sweeps, *level], 32)
    enlarged = 1.1 * TOLERANCE.chord_mm
    for axis in range(2):
        across = (np.arange(piece.count(axis)) + 0.5) * PITCH_MM - 4.0
        inner, outer = (2.0 * np.sqrt(np.maximum(0.0, r * r - across**2)) for r in (radius, radius + enlarged))
        hole = 16.0 - piece.areas_mm2(axis)
        assert np.all(hole >= -floor * inner * (1.0 - 1e-9))
        assert np.all(hole <= -floor * outer * (1.0 + 1e-9))
    hole = 64.0 - piece.areas_mm2(2)[-round(-floor / PITCH_MM) :]
    assert np.all((hole >= math.pi * radius**2 - 0.01) & (hole <= math.pi * (radius + enlarged) ** 2))


def path(points: list[tuple[float, float, float]]) -> FloatArray:
    return np.array(points)


def test_chords_that_were_cut_before_leave_a_band() -> None:
    known, body = Retraced(), BODIES["flat"]
    corners = path([(0, 0, -1.0), (1, 0.5, -1.1), (2, 1.5, -1.2)])
    (first,) = chained([Sweep(body, a, b) for a, b in pairwise(corners)])
    assert known.band_mm(first) == math.inf
    known.add(first, end_is_left=True)
    (deeper,) = chained([Sweep(body, a - (0, 0, 0.3), b - (0, 0, 0.3)) for a, b in pairwise(corners)])
    assert known.band_mm(deeper) == math.inf  # the first has not been cut whole yet
    known.add(first, end_is_left=False)
    assert known.band_mm(deeper) == pytest.approx(0.4)
    level = path([(0, 0, -1.5), (1, 0.5, -1.5)])
    (once,) = chained([Sweep(body, *level)])
    known.add(once, end_is_left=False)
    assert known.band_mm(once) < 0.0
    (higher,) = chained([Sweep(body, *(level + np.array((0, 0, 0.2))))])
    (moved,) = chained([Sweep(body, *(level + np.array((1e-6, 0, -0.2))))])
    (other,) = chained([Sweep(BODIES["ball"], *level)])
    assert all(known.band_mm(chain) == math.inf for chain in (higher, moved, other))


@pytest.mark.parametrize("kind", ["ball", "bull", "taper"])
@pytest.mark.parametrize("down_mm", [1.6, -1.6], ids=["down", "up"])
def test_planes_that_a_tip_has_just_reached_are_cut_as_by_each_sweep(kind: str, down_mm: float) -> None:
    """A quarter turn that goes through two planes: each of them is met by the tip within the chain."""
    sweeps = helix(kind, 1, abs(down_mm))[:8]
    if down_mm < 0.0:
        sweeps = [Sweep(s.body, s.end_mm, s.start_mm) for s in reversed(sweeps)]
    together, alone = CellSlices(BLOCK), CellSlices(BLOCK)
    in_chains(together, sweeps, 8)
    one_by_one(alone, sweeps)
    (chain,) = chained(sweeps)
    planes = BLOCK.low_mm[2] + (np.arange(len(BLOCK.regions[2])) + 0.5) * PITCH_MM
    reached = (planes > chain.bounds_mm[0][2]) & (planes < chain.settled_mm)
    assert reached.sum() >= 2
    assert np.abs(together.areas_mm2(2) - alone.areas_mm2(2))[reached].max() < 4.0 * TOLERANCE.chord_mm
