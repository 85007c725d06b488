"""Motions that nearly retrace others: cells keep few edges, and what is cut stays that of the reference store."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from twin.geometry.column_cells.query_kernels import top_heights
from twin.geometry.column_cells.thin_kernels import MANY_EDGES, thinned
from twin.motion.sweep import Body, Sweep
from twin.tolerance import Tolerance
from twin.tools.shape import tool_shape
from twin.workpiece.removal import Removal
from twin.workpiece.stock import box_slices
from twin.workpiece.trislice import CellSlices, PolygonSlices, TriSlices

PITCH_MM = 0.2
TOLERANCE = Tolerance.for_pitch(PITCH_MM)
BLOCK = box_slices((0.0, 0.0, -2.0), (6.0, 6.0, 0.0), PITCH_MM)


def turns(kind: str, count: int, down_mm: float, out_mm: float, chords: int = 16) -> list[Sweep]:
    """A helix or a spiral about the middle of the block."""
    body = Body.of(tool_shape(kind, 3.0, 8.0), chord_mm=TOLERANCE.chord_mm)
    at = np.arange(count * chords + 1) / chords
    r, angle = 1.0 + out_mm * at, 2.0 * math.pi * at
    tips = np.column_stack((3.0 + r * np.cos(angle), 3.0 + r * np.sin(angle), -0.3 - down_mm * at))
    return [Sweep(body, a, b) for a, b in pairwise(tips)]


def cut(piece: TriSlices, sweeps: list[Sweep]) -> float:
    with Removal(piece, TOLERANCE.chord_mm, threads=1) as removal:
        return float(removal.cut_all(sweeps).sum())


@pytest.mark.compiled
@pytest.mark.parametrize(("down_mm", "out_mm"), [(0.02, 0.0), (0.0, 0.02)], ids=["helix", "spiral"])
@pytest.mark.parametrize("kind", ["ball", "flat"])
def test_turns_close_to_each_other_leave_few_edges_and_the_material_of_the_reference(
    kind: str, down_mm: float, out_mm: float
) -> None:
    sweeps = turns(kind, 3, down_mm, out_mm)
    fast, slow = CellSlices(BLOCK), PolygonSlices(BLOCK)
    assert cut(fast, sweeps) == pytest.approx(cut(slow, sweeps), rel=1e-4)
    for axis in range(3):
        assert np.abs(fast.areas_mm2(axis) - slow.areas_mm2(axis)).max() < 1e-3
    mean, most = fast.edges_per_cell
    assert mean < MANY_EDGES  # several times as many without merging, and more with every turn
    assert most < 3 * MANY_EDGES


def test_edges_on_a_line_become_one_and_ends_corners_and_closing_edges_stay() -> None:
    u = np.linspace(0.0, 1.0, 11)
    rows = [(a, 0.1 * a, b, 0.1 * b, 1.0) for a, b in pairwise(u)]
    rows += [(1.0, 0.1, 1.5, 0.4, 1.0), (1.5, 0.4, 2.0, 0.1, 1.0)]
    rows += [(0.0, 1.0, 0.5, 1.0, 1.0), (0.5, 1.0, 1.0, 1.0, 1.0), (1.0, 1.0, 1.5, 1.0 - 1e-7, 1.0)]
    rows += [(0.0, 0.0, 0.5, 0.0, -1.0)]
    edges = np.array(rows)[::-1].copy()
    count = thinned(edges, len(edges), 1.0, 1e-5)
    found = sorted(map(tuple, edges[:count].tolist()))
    assert found == sorted(
        [
            (0.0, 0.0, 1.0, 0.1, 1.0),
            (1.0, 0.1, 1.5, 0.4, 1.0),
            (1.5, 0.4, 2.0, 0.1, 1.0),
            (0.0, 1.0, 1.0, 1.0, 1.0),
            (1.0, 1.0, 1.5, 1.0 - 1e-7, 1.0),
            (0.0, 0.0, 0.5, 0.0, -1.0),
        ]
    )


def test_points_that_edges_replace_stay_within_the_bound() -> None:
    u = np.linspace(0.0, 1.0, 201)
    v = 0.5 - np.sqrt(4.0 - u * u) / 8.0 + 2e-6 * (np.arange(201) % 2)
    edges = np.column_stack((u[:-1], v[:-1], u[1:], v[1:], np.ones(200)))
    count = thinned(edges, 200, 2.0, 1e-4)
    left = edges[:count]
    assert count < 20
    assert (left[0, 0], left[-1, 2]) == (0.0, 1.0)
    assert left[1:, :2].tolist() == left[:-1, 2:4].tolist()
    assert np.abs(np.interp(u, [*left[:, 0], 1.0], [*left[:, 1], left[-1, 3]]) - v).max() <= 1.05e-4


def test_heights_of_the_material_in_columns() -> None:
    piece = CellSlices(BLOCK)
    cut(piece, [Sweep(Body.of(tool_shape("flat", 3.0, 8.0)), np.array([-2.0, 3.0, -0.6]), np.array([8.0, 3.0, -0.6]))])
    tops = piece.tops(0, 4, 2, (-1.0, 9.0), -0.6)
    assert tops.heights.shape == (2, 6)
    assert (tops.u_low, tops.size) == (0.0, 5 * PITCH_MM)
    assert tops.heights[:, 2:4] == pytest.approx(-0.6)
    assert tops.heights[:, [0, 5]] == pytest.approx(0.0)
    assert piece.tops(0, 4, 0, (0.0, 1.0), 0.0).heights.size == 0
    family = CellSlices(BLOCK)._families[0]
    heights = np.zeros((1, 1))
    top_heights(family.store, family.grid, 0, 0, 0.0, heights)
    assert math.isinf(heights[0, 0])


@pytest.mark.compiled
def test_a_floor_that_is_lowered_again_and_again_is_not_divided() -> None:
    """Each chord of a helix lowers the floor under a flat tool; its cells keep the edges of the last ones only."""
    edges = []
    for count in (1, 4):
        piece = CellSlices(BLOCK)
        cut(piece, turns("flat", count, 0.1, 0.0, 32))
        edges.append(piece.edges_per_cell[0])
    assert edges[1] < 1.25 * edges[0] < 15.0
