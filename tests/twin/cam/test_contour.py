from __future__ import annotations

import numpy as np
import pytest
import shapely

from twin.cam.passes.contour import ContourOptions, OutlineLinkPlanner, contour_passes, level_heights, levels_of
from twin.geometry.polygons.outline import box_area
from twin.geometry.polygons.region import Region

SQUARE = [(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)]
#: A frame of 20 x 20 mm around a pocket of 10 x 10 mm.
FRAME = Region.of([(-10, -10), (10, -10), (10, 10), (-10, 10)], SQUARE[::-1])


def options(**changes: object) -> ContourOptions:
    values: dict[str, object] = {
        "window": box_area((-30.0, -30.0), (30.0, 30.0)),
        "stock": box_area((-20.0, -20.0), (20.0, 20.0)),
        "top_mm": 0.0,
        "radial_depth_mm": 2.0,
    }
    return ContourOptions(**(values | changes))  # type: ignore[arg-type]


def signed_area(points: np.ndarray) -> float:
    x, y = points[:-1, 0], points[:-1, 1]
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def test_levels_are_even_and_end_at_the_floor() -> None:
    assert level_heights(-5.0, 0.0, 2.0) == pytest.approx([-5 / 3, -10 / 3, -5.0])
    assert level_heights(-4.0, 0.0, 2.0) == pytest.approx([-2.0, -4.0])


@pytest.mark.parametrize("climb", [True, False])
def test_climb_has_the_part_on_its_right(climb: bool) -> None:
    levels = levels_of(np.array([-1.0]), [FRAME])
    passes = contour_passes(levels, options(climb=climb))
    areas = sorted(signed_area(p.points_mm) for p in passes)
    # the outer outline clockwise and the pocket's counter-clockwise, or both the other way round
    assert areas == pytest.approx([-400.0, 100.0] if climb else [-100.0, 400.0])


def test_layers_lie_at_the_radial_depth_and_are_cut_from_outside_in() -> None:
    levels = levels_of(np.array([-1.0]), [Region.of(SQUARE)])
    passes = contour_passes(levels, options(layers=3))
    part = shapely.Polygon(SQUARE)
    away = [shapely.distance(part, shapely.points(p.points_mm[:, :2])) for p in passes]
    for k, found in zip((2, 1, 0), away, strict=True):
        assert found.min() == pytest.approx(2.0 * k, abs=2e-3) and found.max() == pytest.approx(2.0 * k, abs=2e-3)
        assert found.min() >= 2.0 * k - 1e-6


def test_layers_go_on_until_the_window_is_cleared() -> None:
    levels = levels_of(np.array([-1.0]), [FRAME])
    window = box_area((-14.0, -14.0), (14.0, 14.0))
    passes = contour_passes(levels, options(layers=None, window=window))
    swept = shapely.union_all([shapely.LineString(p.points_mm[:, :2]).buffer(2.0) for p in passes])
    free = window.difference(shapely.Polygon(FRAME.rings[0], [FRAME.rings[1]]))
    assert free.difference(swept).area < 1e-6
    for one in passes:
        assert window.buffer(1e-6).covers(shapely.LineString(one.points_mm[:, :2]))


def test_pockets_are_cut_from_the_middle_and_entered_through_what_is_left() -> None:
    levels = levels_of(np.array([-1.0, -2.0]), [FRAME, FRAME])
    passes = contour_passes(levels, options(layers=None, window=box_area((-6.0, -6.0), (6.0, 6.0))))
    for z, top in ((-1.0, 0.0), (-2.0, -1.0)):
        here = [p for p in passes if p.points_mm[0, 2] == z]
        assert [abs(signed_area(p.points_mm)) for p in here] == sorted(abs(signed_area(p.points_mm)) for p in here)
        assert here[0].top_mm == top
    assert {p.layer for p in passes} == {0, 1}


def test_passes_that_begin_outside_the_stock_meet_no_material_there() -> None:
    levels = levels_of(np.array([-1.0]), [Region.of([(-40.0, -5.0), (40.0, -5.0), (40.0, 5.0), (-40.0, 5.0)])])
    window = box_area((-30.0, -30.0), (30.0, 30.0))
    passes = contour_passes(levels, options(window=window))
    assert len(passes) == 2
    assert all(p.top_mm is None and not p.closed for p in passes)


def test_ways_stay_in_the_free_area() -> None:
    levels = levels_of(np.array([-1.0, -2.0]), [FRAME, FRAME])
    planner = OutlineLinkPlanner(levels, box_area((-30.0, -30.0), (30.0, 30.0)), 0.0)
    assert planner.between(np.array([-4.0, 0, -1]), np.array([4.0, 0, -1])) is not None
    assert planner.between(np.array([0.0, 0, -1]), np.array([15.0, 0, -1])) is None
    down = planner.between(np.array([-4.0, 0, -1]), np.array([4.0, 0, -2]))
    assert down is not None and down.tolist() == [[-4, 0, -1], [4, 0, -1], [4, 0, -2]]
    assert planner.between(np.array([-4.0, 0, -2]), np.array([4.0, 0, -1])) is None
    assert not planner.free(np.array([(0.0, 0.0, -1.5), (1.0, 0.0, -1.5)]))
    assert planner.clear_z_mm(np.zeros(3), np.zeros(3)) == 0.0
