from __future__ import annotations

import math

import pytest
import shapely

from twin.geometry.polygons.corners import Corners


def test_corners_that_stand_out_are_found_and_inner_ones_are_not() -> None:
    shape = shapely.Polygon([(0, 0), (10, 0), (10, 10), (5, 5), (0, 10)])
    found = Corners.of(shape, 0.01)
    assert sorted(map(tuple, found.sharp_mm.tolist())) == [(0, 0), (0, 10), (10, 0), (10, 10)]
    assert found.rings == 1


def test_round_outlines_have_no_corners() -> None:
    assert len(Corners.of(shapely.Point(0, 0).buffer(10.0, quad_segs=64), 1e-4).sharp_mm) == 0


def test_how_far_corners_wander() -> None:
    one = Corners.of(shapely.box(0, 0, 10, 10), 0.01)
    assert one.wander_mm(Corners.of(shapely.box(0, 0, 10.5, 10), 0.01)) == pytest.approx(0.5)
    holed = shapely.box(0, 0, 10, 10) - shapely.box(4, 4, 6, 6)
    assert one.wander_mm(Corners.of(holed, 0.01)) == math.inf
    assert Corners.of(shapely.Polygon(), 0.01).wander_mm(one) == math.inf
