"""Sections of chains of sweeps: those of the union of their sweeps."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely

from twin.arrays import FloatArray
from twin.geometry.column_cells.strips import Strips
from twin.motion.chain import Chain, chained, follows
from twin.motion.sweep import Body, Sweep
from twin.tools.shape import ToolShape, tool_shape

CHORD_MM, PITCH_MM = 0.002, 0.5
SHAPES = {
    "flat": tool_shape("flat", 6.0, 12.0),
    "ball": tool_shape("ball", 6.0, 12.0),
    "bull": tool_shape("bull", 6.0, 12.0, 1.0),
    "taper": tool_shape("taper", 4.0, 12.0, 0.5, 8.0),
}


def arc(r: float, from_rad: float, sweep_rad: float, down_mm: float, chords: int) -> FloatArray:
    """Corners of a helical arc about (10, 10) from z = -2.1."""
    t = np.linspace(0.0, 1.0, chords + 1)
    angle = from_rad + sweep_rad * t
    return np.column_stack((10.0 + r * np.cos(angle), 10.0 + r * np.sin(angle), -2.1 - down_mm * t))


def sweeps(shape: ToolShape, corners: FloatArray) -> list[Sweep]:
    body = Body.of(shape, chord_mm=CHORD_MM)
    return [Sweep(body, a, b) for a, b in pairwise(corners)]


def polygon(strips: Strips, k: int) -> shapely.Geometry:
    """The section on plane ``k``, below z = 0."""
    found = np.flatnonzero(strips.at == k)
    outline = strips.outline(int(found[0])) if len(found) else None
    return shapely.Polygon() if outline is None else shapely.make_valid(shapely.Polygon(outline))


def low(axis: int) -> float:
    return -6.0 if axis == 2 else 0.0


@pytest.mark.compiled
@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize(("from_rad", "sweep_rad", "down_mm"), [(0.2, 1.3, 0.03), (2.9, -1.2, 0.0), (4.8, 1.4, -0.03)])
def test_a_chain_has_the_sections_of_its_sweeps(kind: str, from_rad: float, sweep_rad: float, down_mm: float) -> None:
    each = sweeps(SHAPES[kind], arc(3.0, from_rad, sweep_rad, down_mm, 10))
    (chain,) = chained(each)
    for axis in range(3):
        got = chain.strips(axis, low(axis), PITCH_MM, 40, CHORD_MM)
        parts = [sweep.strips(axis, low(axis), PITCH_MM, 40, 0.2 * CHORD_MM) for sweep in each]
        assert len(got.at) == max(p.at[-1] for p in parts) - min(p.at[0] for p in parts) + 1
        for k in range(got.at[0], got.at[-1] + 1, 7):
            have, want = polygon(got, k), shapely.union_all([polygon(p, k) for p in parts])
            # near the tip of a ball, sections that grow along the chain leave a gap that a strip fills
            thickness = 0.4 * CHORD_MM if axis != 2 or SHAPES[kind].corner_radius_mm == 0.0 else 2.0 * CHORD_MM
            assert have.symmetric_difference(want).area <= thickness * max(want.length, 1.0)


def test_a_section_that_is_all_of_the_tool_repeats_on_the_planes_above() -> None:
    (chain,) = chained(sweeps(SHAPES["flat"], arc(3.0, 0.2, 0.6, 0.03, 3)))
    strips = chain.strips(2, -2.6, 0.5, 3, 0.1)
    first, second = strips.nodes[: strips.offsets[1]], strips.nodes[strips.offsets[1] : strips.offsets[2]]
    assert len(strips.at) == 2
    assert np.array_equal(first, second)


@pytest.mark.parametrize("kind", ["flat", "bull"])
def test_where_the_body_at_the_end_is_left_nothing_is_fresh(kind: str) -> None:
    corners = arc(3.0, 0.2, 0.6, 0.03, 3)
    (chain,) = chained(sweeps(SHAPES[kind], corners))
    strips = chain.strips(0, 10.05, 1.0, 3, 0.1, end_is_left=True, top_mm=0.0)
    east, north, _ = corners[-1]
    for i in range(len(strips.at)):
        w = 10.55 + strips.at[i]
        for n in range(strips.offsets[i], strips.offsets[i + 1]):
            if math.hypot(w - east, strips.nodes[n, 0] - north) < SHAPES[kind].disc_mm - 0.01:
                assert not strips.fresh[n]
    assert strips.fresh.any()
    assert not strips.fresh.all()


def test_a_chain_that_lies_below_another_is_a_band() -> None:
    (chain,) = chained(sweeps(SHAPES["ball"], arc(3.0, 0.2, 0.6, 0.03, 3)))
    strips = chain.strips(1, 9.0, 1.0, 2, 0.1, band_mm=0.25)
    assert np.allclose(strips.nodes[:, 2] - strips.nodes[:, 1], 0.25)
    assert len(chain.strips(1, 9.0, 1.0, 2, 0.1, band_mm=-1.0).at) == 0
    whole, band = (chain.strips(2, -2.3, 1.0, 5, 0.1, band_mm=b) for b in (math.inf, 0.25))
    assert whole.offsets[-1] > whole.offsets[-2]
    assert band.offsets[-1] == band.offsets[-2]  # the whole radius of the tool has passed there


def test_chains_end_where_an_axis_turns_or_a_sweep_does_not_follow() -> None:
    each = sweeps(SHAPES["flat"], arc(3.0, 0.0, 2.0 * math.pi, 0.1, 16))
    chains = list(chained(each))
    assert [len(chain.corners_mm) - 1 for chain in chains] == [4, 4, 4, 4]
    assert all(follows(b, a) for a, b in pairwise(chains))
    assert [len(chain.corners_mm) - 1 for chain in chained([*each[:2], *each[3:5]])] == [2, 1, 1]
    assert all(isinstance(chain, Chain) and chain.descends for chain in chains)
