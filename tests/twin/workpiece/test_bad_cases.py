"""Cuts that fast stores of slices fail on: chains of short sweeps, retraces, islands, extremes of size."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from twin.arrays import FloatArray
from twin.motion.sweep import Body, Sweep
from twin.tolerance import Tolerance
from twin.tools.shape import ToolShape, tool_shape
from twin.workpiece.removal import Removal
from twin.workpiece.stock import SliceSet, box_slices
from twin.workpiece.trislice import CellSlices, PolygonSlices

pytestmark = pytest.mark.compiled

PITCH = 0.5
TOLERANCE = Tolerance.for_pitch(PITCH)
KINDS = {
    "ball": tool_shape("ball", 3.0, 8.0),
    "flat": tool_shape("flat", 3.0, 8.0),
    "bull": tool_shape("bull", 4.0, 8.0, corner_radius_mm=0.8),
    "taper": tool_shape("taper", 1.5, 8.0, corner_radius_mm=0.5, taper_deg=6.0),
}


def block() -> SliceSet:
    return box_slices((0.0, 0.0, -5.0), (12.0, 10.0, 0.0), PITCH)


def chain(shape: ToolShape, points: list[tuple[float, float, float]]) -> list[Sweep]:
    """Sweeps through points, each beginning where the last one ends."""
    body = Body.of(shape, chord_mm=TOLERANCE.chord_mm)
    return [Sweep(body, np.array(a), np.array(b)) for a, b in pairwise(points)]


def areas(workpiece: CellSlices | PolygonSlices) -> FloatArray:
    return np.concatenate([workpiece.areas_mm2(axis) for axis in range(3)])


def both(sweeps: list[Sweep]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Areas left by the chain: cut as a chain, cut with every sweep by itself, and cut in the reference store."""
    together, alone, plain = CellSlices(block()), CellSlices(block()), PolygonSlices(block())
    with Removal(together, TOLERANCE.chord_mm) as removal:
        removal.cut_all(sweeps)
    for workpiece in (alone, plain):
        for sweep in sweeps:  # a removal of its own knows of no earlier sweep
            with Removal(workpiece, TOLERANCE.chord_mm, threads=1) as removal:
                removal.cut(sweep)
    return areas(together), areas(alone), areas(plain)


HELIX = [(6.0 + 2.0 * math.cos(a), 5.0 + 2.0 * math.sin(a), 0.5 - 0.2 * a) for a in np.linspace(0.0, 20.0, 120)]
WAVE = [(x, 5.0 + math.sin(x), -2.0 - 0.7 * math.cos(1.3 * x)) for x in np.linspace(-2.0, 14.0, 107)]
PATHS = {
    "surface": WAVE,
    "retrace": WAVE[:50] + WAVE[49::-1],
    "helix entry": HELIX,
    "plunges": [(3.0, 3.0, 2.0), (3.0, 3.0, -3.0), (3.0, 3.0, 2.0), (9.0, 7.0, 2.0), (9.0, 7.0, -6.0)],
    "tangent to faces": [(-1.5, -3.0, -2.0), (-1.5, 13.0, -2.0), (13.5, 13.0, -2.0), (13.5, -3.0, -2.0)],
    "creeping": [(4.0 + 1e-4 * n, 5.0 + 2e-4 * n, -2.0 - 1e-4 * n) for n in range(100)],
    "standing": [(4.0, 5.0, -2.0)] * 5,
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("path", PATHS)
def test_a_chain_cuts_what_its_sweeps_cut(path: str, kind: str) -> None:
    """Leaving out what the sweep before has cut changes no slice by more than the chords do."""
    together, alone, plain = both(chain(KINDS[kind], PATHS[path]))
    assert np.abs(together - alone).max() < 1.0 * TOLERANCE.chord_mm  # mm2: a chord's error over a millimetre
    assert np.abs(alone - plain).max() < 1e-3


def test_cut_again_nothing_is_left_to_cut() -> None:
    workpiece = CellSlices(block())
    with Removal(workpiece, TOLERANCE.chord_mm) as removal:
        sweeps = chain(KINDS["ball"], WAVE)
        first = removal.cut_all(sweeps).sum()
        assert first > 20.0
        for sweep in sweeps:
            assert removal.cut(sweep) == pytest.approx(0.0, abs=1e-4 * first)


def test_a_wall_thinner_than_the_pitch_stays() -> None:
    workpiece = CellSlices(block())
    with Removal(workpiece, TOLERANCE.chord_mm) as removal:
        for y in (3.5 - 0.1, 6.5 + 0.1):
            removal.cut_all(chain(KINDS["flat"], [(-2.0, y, -3.0), (14.0, y, -3.0)]))
    z = math.floor(4.0 / PITCH)
    wall = workpiece.region(2, z)
    assert wall.area_mm2 == pytest.approx(12.0 * (10.0 - 2 * 3.0), abs=0.2)
    assert workpiece.region(0, 10).area_mm2 == pytest.approx(10.0 * 5.0 - 2 * 3.0 * 3.0, abs=0.1)
    thin = CellSlices(block())
    with Removal(thin, TOLERANCE.chord_mm) as removal:
        for y in (3.4, 6.6):
            removal.cut_all(chain(tool_shape("flat", 3.0, 8.0), [(-2.0, y, -3.0), (14.0, y, -3.0)]))
    across = np.array([[6.0, y, -1.0] for y in (4.95, 5.0, 5.05)])
    assert thin.contains(across, 2).all()


def test_a_slice_cut_into_many_islands() -> None:
    """A grid of grooves leaves pillars, each a ring of its own, with the areas that are left over."""
    slices = box_slices((0.0, 0.0, -3.0), (12.0, 12.0, 0.0), 0.25)
    workpiece, shape = CellSlices(slices), tool_shape("flat", 0.4, 5.0)
    body = Body.of(shape)
    with Removal(workpiece, 1e-4) as removal:
        for n in range(1, 12):
            removal.cut(Sweep(body, np.array([-1.0, n, -2.0]), np.array([13.0, n, -2.0])))
            removal.cut(Sweep(body, np.array([n, -1.0, -2.0]), np.array([n, 13.0, -2.0])))
    region = workpiece.region(2, workpiece.count(2) - 2)
    assert len(region.rings) == 144
    inner, edge = 0.6, 0.8
    assert region.area_mm2 == pytest.approx((10 * inner + 2 * edge) ** 2, abs=1e-6)


@pytest.mark.parametrize("diameter", [0.01 * PITCH, 100.0 * PITCH])
def test_tools_far_from_the_pitch(diameter: float) -> None:
    workpiece, plain = CellSlices(block()), PolygonSlices(block())
    body = Body.of(tool_shape("ball", diameter, 60.0), chord_mm=TOLERANCE.chord_mm)
    sweep = Sweep(body, np.array([-1.0, 5.01, -2.0]), np.array([13.0, 5.02, -2.5]))
    for store in (workpiece, plain):
        with Removal(store, TOLERANCE.chord_mm) as removal:
            removal.cut(sweep)
    assert np.abs(areas(workpiece) - areas(plain)).max() < 1e-3


def test_planes_that_share_cells_do_not_share_cuts() -> None:
    """The planes of a box begin as one; a cut of some leaves the others whole, and bounds the memory."""
    workpiece = CellSlices(box_slices((0.0, 0.0, -10.0), (60.0, 60.0, 0.0), 0.25))
    body = Body.of(tool_shape("ball", 4.0, 10.0))
    with Removal(workpiece, 1e-3) as removal:
        removal.cut(Sweep(body, np.array([10.0, 10.0, -1.0]), np.array([12.0, 10.0, -1.0])))
    far = np.array([[40.0, 40.0, -1.0], [10.0, 40.0, -9.0], [40.0, 10.0, -1.0]])
    near = np.array([[11.0, 10.0, -0.5]])
    for axis in range(3):
        assert workpiece.contains(far, axis).all()
        assert not workpiece.contains(near, axis).any()
        untouched = workpiece.areas_mm2(axis)[-1] if axis < 2 else workpiece.areas_mm2(axis)[0]
        assert untouched == pytest.approx(600.0 if axis < 2 else 3600.0)
