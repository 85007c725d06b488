"""Lines through slices: the cells, plain rings and closed forms agree, slopes too."""

from __future__ import annotations

import numpy as np
import pytest

from twin.geometry.column_cells.cells import CellFamily
from twin.geometry.polygons.lines import LineEnds, ring_line_ends
from twin.geometry.polygons.region import Region
from twin.motion.sweep import Body, Sweep
from twin.tools.shape import tool_shape
from twin.workpiece.removal import Removal
from twin.workpiece.stock import box_slices
from twin.workpiece.store import PLANE_AXES
from twin.workpiece.trislice import CellSlices, PolygonSlices

TRIANGLE = np.array([(0.0, 0.0), (10.0, 0.0), (0.0, 5.0)])
PLANES = np.array([0])


def on_line(ends: LineEnds, i: int) -> list[tuple[float, float]]:
    part = slice(ends.offsets[i], ends.offsets[i + 1])
    return list(zip(ends.ends_mm[part].tolist(), ends.slopes[part].tolist(), strict=True))


@pytest.mark.parametrize("cells", [True, False])
def test_a_triangle_in_closed_form(cells: bool) -> None:
    """Its long side is v = 5 - u / 2, or u = 10 - 2 v."""
    region = Region.of(TRIANGLE)

    def through(fixed: int, at: list[float]) -> LineEnds:
        if cells:
            family = CellFamily([region], (0.0, 0.0), (10.0, 5.0), 1.3)
            return family.line_ends(PLANES, fixed, np.array(at), (-1.0, 20.0))
        return ring_line_ends([region.rings], fixed, np.array(at))

    upright = through(0, [-0.5, 1.5, 4.2, 10.5])
    assert upright.offsets.tolist() == [0, 0, 2, 4, 4]
    assert on_line(upright, 1) == [(0.0, 0.0), (pytest.approx(4.25), pytest.approx(-0.5))]
    assert on_line(upright, 2) == [(0.0, 0.0), (pytest.approx(2.9), pytest.approx(-0.5))]
    level = through(1, [0.7, 4.2, 6.0])
    assert level.offsets.tolist() == [0, 2, 4, 4]
    assert on_line(level, 0) == [(0.0, 0.0), (pytest.approx(8.6), pytest.approx(-2.0))]
    assert on_line(level, 1) == [(0.0, 0.0), (pytest.approx(1.6), pytest.approx(-2.0))]


def test_planes_follow_one_another_and_empty_ones_have_no_ends() -> None:
    regions = [Region.of(TRIANGLE), Region(), Region.of(2.0 * TRIANGLE)]
    family = CellFamily(regions, (0.0, 0.0), (20.0, 10.0), 1.0)
    at = np.array([0.5, 3.0])
    cells = family.line_ends(np.array([0, 1, 2]), 0, at, (0.0, 10.0))
    plain = ring_line_ends([r.rings for r in regions], 0, at)
    assert cells.offsets.tolist() == plain.offsets.tolist() == [0, 2, 4, 4, 4, 6, 8]
    assert cells.ends_mm == pytest.approx(plain.ends_mm)


def test_no_planes_and_no_lines() -> None:
    family = CellFamily([Region.of(TRIANGLE)], (0.0, 0.0), (10.0, 5.0), 1.0)
    assert family.line_ends(np.zeros(0, dtype=np.int64), 0, np.array([1.0]), (0.0, 5.0)).offsets.tolist() == [0]
    assert family.line_ends(PLANES, 1, np.zeros(0), (0.0, 5.0)).offsets.tolist() == [0]
    assert ring_line_ends([], 0, np.array([1.0])).offsets.tolist() == [0]


def test_cells_and_polygons_agree_on_machined_slices() -> None:
    box = box_slices((0.0, 0.0, 0.0), (12.0, 10.0, 4.0), 0.5)
    fast, plain = CellSlices(box), PolygonSlices(box)
    body = Body.of(tool_shape("bull", 4.0, 20.0, 1.0), chord_mm=0.005)
    rng = np.random.default_rng(7)
    for store in (fast, plain):
        with Removal(store, 0.005, threads=1) as removal:
            for start, end in np.random.default_rng(3).uniform((0, 0, 1), (12, 10, 5), (12, 2, 3)):
                removal.cut(Sweep(body, start, end))
    for axis in range(3):
        planes = np.arange(0, fast.count(axis), 2)
        for fixed in (0, 1):
            across, along = PLANE_AXES[axis][fixed], PLANE_AXES[axis][1 - fixed]
            at = np.sort(rng.uniform(box.low_mm[across], box.high_mm[across], 20))
            window = float(box.low_mm[along]), float(box.high_mm[along])
            ours = fast.line_ends(axis, planes, fixed, at, window)
            theirs = plain.line_ends(axis, planes, fixed, at, window)
            assert ours.offsets.tolist() == theirs.offsets.tolist()
            assert ours.ends_mm == pytest.approx(theirs.ends_mm, abs=1e-5)
            # a boundary of two pieces that nearly line up may be met on either one
            assert np.quantile(np.abs(np.arctan(ours.slopes) - np.arctan(theirs.slopes)), 0.95) < 1e-3


def test_only_the_window_is_looked_at() -> None:
    family = CellFamily([Region.of(TRIANGLE)], (0.0, 0.0), (10.0, 5.0), 1.0)
    ends = family.line_ends(PLANES, 1, np.array([1.0]), (6.2, 8.9))
    assert ends.ends_mm[-1] == pytest.approx(8.0)
    assert ends.ends_mm[0] == pytest.approx(6.0)
