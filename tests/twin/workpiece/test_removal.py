"""Removal: fast and reference stores agree, volumes are the closed forms, awkward cuts behave."""

from __future__ import annotations

import math
import os
from itertools import pairwise

import numpy as np
import pytest

from twin.arrays import FloatArray
from twin.geometry.polygons.region import Region
from twin.motion.sweep import Body, Sweep
from twin.tolerance import Tolerance
from twin.tools.shape import ToolShape, tool_shape
from twin.workpiece.removal import Removal
from twin.workpiece.stock import SliceSet, box_slices
from twin.workpiece.trislice import CellSlices, PolygonSlices, TriSlices

#: Plain Python is 100 times slower: fewer cuts are enough there.
CUTS = 40 if os.environ.get("NUMBA_DISABLE_JIT") == "1" else 2400
TOOLS = (
    tool_shape("ball", 3.0, 8.0),
    tool_shape("flat", 2.0, 8.0),
    tool_shape("bull", 4.0, 8.0, corner_radius_mm=0.8),
    tool_shape("taper", 1.0, 8.0, corner_radius_mm=0.5, taper_deg=6.0),
)


def sweep_of(shape: ToolShape, start: FloatArray, end: FloatArray, tolerance: Tolerance) -> Sweep:
    return Sweep(Body.of(shape, chord_mm=tolerance.chord_mm), np.array(start, float), np.array(end, float))


def assert_alike(fast: TriSlices, slow: TriSlices) -> None:
    for axis in range(3):
        assert np.abs(fast.areas_mm2(axis) - slow.areas_mm2(axis)).max() < 1e-4


def test_fast_and_reference_agree_on_every_slice_over_thousands_of_cuts() -> None:
    slices = box_slices((0.0, 0.0, -4.0), (9.0, 8.0, 0.0), 0.8)
    tolerance = Tolerance.for_pitch(0.8)
    fast, slow = CellSlices(slices), PolygonSlices(slices)
    rng = np.random.default_rng(11)
    with Removal(fast, tolerance.chord_mm) as quick, Removal(slow, tolerance.chord_mm) as plain:
        for number in range(CUTS):
            start = rng.uniform((-2.0, -2.0, -3.5), (11.0, 10.0, 0.5))
            move = rng.uniform(-2.0, 2.0, 3) * (rng.random(3) < 0.6)
            sweep = sweep_of(TOOLS[number % 4], start, start + move, tolerance)
            assert quick.cut(sweep) == pytest.approx(plain.cut(sweep), abs=1e-3)
            if number % 100 == 99 or number == CUTS - 1:
                assert_alike(fast, slow)
            if number % 300 == 299:  # begin again before nothing is left
                fast, slow = CellSlices(slices), PolygonSlices(slices)
                quick.workpiece, plain.workpiece = fast, slow


def test_stores_agree_on_points_rings_and_lines() -> None:
    slices = box_slices((0.0, 0.0, -4.0), (9.0, 8.0, 0.0), 0.5)
    tolerance = Tolerance.for_pitch(0.5)
    stores = CellSlices(slices), PolygonSlices(slices)
    for store in stores:
        with Removal(store, tolerance.chord_mm) as removal:
            for i, tool in enumerate(TOOLS):
                removal.cut(sweep_of(tool, (2.0 * i, 1.0, -2.0), (2.0 * i + 1.0, 7.0, -1.0), tolerance))
    rng = np.random.default_rng(1)
    points = rng.uniform((-0.5, -0.5, -4.5), (9.5, 8.5, 0.5), (3000, 3))
    lines = np.sort(rng.uniform(-0.5, 9.5, 40))
    for axis in range(3):
        assert np.array_equal(stores[0].contains(points, axis), stores[1].contains(points, axis))
        for k in range(0, stores[0].count(axis), 3):
            assert stores[0].region(axis, k).area_mm2 == pytest.approx(stores[1].region(axis, k).area_mm2, abs=1e-4)
            fast, slow = (store.line_ends(axis, np.array([k]), 0, lines, (-9.0, 9.0))[:2] for store in stores)
            lengths = [[np.sum(v[a + 1 : b : 2] - v[a:b:2]) for a, b in pairwise(o)] for o, v in (fast, slow)]
            assert lengths[0] == pytest.approx(lengths[1], abs=1e-4)
    for enough in (1, 2):
        votes = [np.zeros(len(points), dtype=np.int8) for _ in stores]
        for store, found in zip(stores, votes, strict=True):
            store.prepare(points.min(axis=0), points.max(axis=0))
            store.count_votes(points, enough, found)
        assert np.array_equal(votes[0] >= enough, votes[1] >= enough)


@pytest.mark.compiled
@pytest.mark.parametrize(("axis", "limit"), [(0, 5e-4), (1, 5e-4), (2, 2e-3)])
def test_a_ball_slot_has_the_volume_of_the_closed_form(axis: int, limit: float) -> None:
    """R4, 2 mm deep, through a block 20 mm long: the circle's segment times the length."""
    tolerance = Tolerance.for_pitch(0.1)
    piece = CellSlices(box_slices((0.0, -6.0, -4.0), (20.0, 6.0, 0.0), 0.1))
    before = piece.volume_mm3(axis)
    with Removal(piece, tolerance.chord_mm) as removal:
        reported = removal.cut(sweep_of(tool_shape("ball", 8.0, 20.0), (-6.0, 0.0, -2.0), (26.0, 0.0, -2.0), tolerance))
    segment = 16.0 * math.acos(0.5) - 2.0 * math.sqrt(12.0)
    assert before - piece.volume_mm3(axis) == pytest.approx(20.0 * segment, rel=limit)
    assert reported == pytest.approx(20.0 * segment, rel=1.5e-3)


@pytest.mark.compiled
def test_many_short_sweeps_remove_what_one_long_one_does() -> None:
    tolerance = Tolerance.for_pitch(0.2)
    long, short = (CellSlices(box_slices((0.0, -6.0, -4.0), (20.0, 6.0, 0.0), 0.2)) for _ in range(2))
    ball = tool_shape("ball", 8.0, 20.0)
    at = np.linspace(-6.0, 14.0, 101)
    with Removal(long, tolerance.chord_mm) as removal:
        whole = removal.cut(sweep_of(ball, (-6.0, 0.5, -2.0), (14.0, 0.5, -2.0), tolerance))
    with Removal(short, tolerance.chord_mm, threads=1) as removal:
        parts = sum(removal.cut(sweep_of(ball, (a, 0.5, -2.0), (b, 0.5, -2.0), tolerance)) for a, b in pairwise(at))
    assert parts == pytest.approx(whole, rel=1e-3)
    for axis in range(3):
        # every step's polygon stands off the tool by up to the chord tolerance, along the whole length of the wall
        assert np.abs(long.areas_mm2(axis) - short.areas_mm2(axis)).max() < 20.0 * 2.0 * tolerance.chord_mm


@pytest.mark.compiled
def test_threads_do_not_change_a_bit() -> None:
    tolerance = Tolerance.for_pitch(0.5)
    rng = np.random.default_rng(2)
    starts = rng.uniform((-2.0, -2.0, -3.0), (11.0, 10.0, 0.5), (200, 3))
    areas = []
    for threads in (1, 2):
        piece = CellSlices(box_slices((0.0, 0.0, -4.0), (9.0, 8.0, 0.0), 0.5))
        with Removal(piece, tolerance.chord_mm, threads=threads) as removal:
            for i, start in enumerate(starts):
                removal.cut(sweep_of(TOOLS[i % 4], start, start + np.array([0.7, 0.3, 0.0]), tolerance))
        areas.append([piece.areas_mm2(axis).tobytes() for axis in range(3)])
    assert areas[0] == areas[1]


def test_awkward_cuts() -> None:
    tolerance = Tolerance.for_pitch(0.5)
    flat = tool_shape("flat", 2.0, 8.0)

    def cut(start: tuple[float, ...], end: tuple[float, ...], shape: ToolShape = flat) -> tuple[float, CellSlices]:
        piece = CellSlices(box_slices((0.0, 0.0, -4.0), (9.0, 8.0, 0.0), 0.5))
        with Removal(piece, tolerance.chord_mm) as removal:
            return removal.cut(sweep_of(shape, np.array(start), np.array(end), tolerance)), piece

    # the bottom lies exactly on a plane of the xy slices, then exactly between two
    for depth, planes in ((-1.25, 3), (-1.5, 3)):
        volume, piece = cut((4.0, -5.0, depth), (4.0, 13.0, depth))
        assert np.count_nonzero(piece.areas_mm2(2) < 72.0 - 1.0) == planes
        assert volume == pytest.approx(16.0 * -depth, rel=0.08)
    # a wall of the slot lies exactly on a plane of the yz slices
    volume, piece = cut((4.25 - 1.0, -5.0, -2.0), (4.25 - 1.0, 13.0, -2.0))
    assert volume == pytest.approx(32.0, rel=0.1)
    # tangent to a face: nothing; larger than the stock: everything; no motion: the tool's own place
    assert cut((-1.0 - 2.0 * tolerance.chord_mm, -5.0, -2.0), (-1.0 - 2.0 * tolerance.chord_mm, 13.0, -2.0))[0] == 0.0
    volume, piece = cut((4.0, 4.0, -9.0), (4.0, 4.0, -9.0), tool_shape("flat", 40.0, 20.0))
    assert volume == pytest.approx(288.0)
    assert all(piece.region(axis, 1).empty for axis in range(3))
    assert cut((4.0, 4.0, -4.0), (4.0, 4.0, -4.0))[0] == pytest.approx(4.0 * math.pi, rel=0.06)
    # a plunge, and a wall thinner than the pitch left between two passes
    assert cut((4.0, 4.0, 1.0), (4.0, 4.0, -3.0))[0] == pytest.approx(3.0 * math.pi, rel=0.06)


def test_a_tool_far_larger_or_smaller_than_the_pitch() -> None:
    tolerance = Tolerance.for_pitch(0.5)
    piece = CellSlices(box_slices((0.0, 0.0, -4.0), (9.0, 8.0, 0.0), 0.5))
    with Removal(piece, tolerance.chord_mm) as removal:
        tiny = sweep_of(tool_shape("ball", 0.01, 1.0), (2.0, 2.0, -0.4), (7.0, 2.0, -0.4), tolerance)
        assert 0.0 <= removal.cut(tiny) < 0.5
        huge = sweep_of(tool_shape("ball", 100.0, 60.0), (4.5, 4.0, -1.0), (4.6, 4.0, -1.0), tolerance)
        assert removal.cut(huge) == pytest.approx(72.0 - 72.0 * (9**2 + 8**2) / 12.0 / 100.0, rel=0.05)


def test_slices_without_material_stay_empty() -> None:
    full = box_slices((0.0, 0.0, -4.0), (9.0, 8.0, 0.0), 0.5)
    hollow = SliceSet(
        low_mm=full.low_mm,
        high_mm=full.high_mm,
        pitch_mm=full.pitch_mm,
        regions=tuple((Region(),) * len(family) for family in full.regions),
    )
    tolerance = Tolerance.for_pitch(0.5)
    for store in (CellSlices(hollow), PolygonSlices(hollow)):
        with Removal(store, tolerance.chord_mm) as removal:
            assert removal.cut(sweep_of(TOOLS[0], (1.0, 1.0, -2.0), (5.0, 1.0, -2.0), tolerance)) == 0.0
        assert store.volume_mm3(0) == 0.0
