from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from twin.arrays import FloatArray
from twin.cam.path.arc_fit import FitOptions, fit_move, fit_path
from twin.cam.path.toolpath import Move, MoveKind, ToolPath
from twin.tools.shape import tool_shape

#: Rounding of sums of a few numbers of size 100.
NOISE = 1e-9


def in_plane(plane: int, flat: FloatArray) -> FloatArray:
    """Points (n, 2) as (x, y), (x, z) or (y, z) in space."""
    axes = {17: (0, 1), 18: (0, 2), 19: (1, 2)}[plane]
    points = np.full((len(flat), 3), 3.0)
    points[:, axes] = flat
    return points


def cut(points: FloatArray) -> Move:
    return Move(kind=MoveKind.CUT, points_mm=points, feed_mm_min=600.0)


def arc_points(radius: float, first_deg: float, last_deg: float, count: int) -> FloatArray:
    angle = np.radians(np.linspace(first_deg, last_deg, count))
    return radius * np.column_stack((np.cos(angle), np.sin(angle)))


@pytest.mark.parametrize("plane", [17, 18, 19])
@pytest.mark.parametrize("way", [1, -1])
def test_points_of_an_arc_become_one_arc(plane: int, way: int) -> None:
    points = in_plane(plane, arc_points(12.0, 10.0, 160.0, 400)[::way])
    (arc,) = fit_move(cut(points), FitOptions(tolerance_mm=0.001))
    assert arc.arc is not None and arc.arc.plane == plane
    assert abs(arc.arc.sweep_rad) == pytest.approx(math.radians(150.0), abs=1e-6)
    middle = arc.chords_mm(1e-4)
    assert shapely.hausdorff_distance(shapely.LineString(points), shapely.LineString(middle)) < 0.001


def test_a_full_circle_becomes_few_arcs_and_comes_back() -> None:
    ring = in_plane(17, arc_points(5.0, 0.0, 360.0, 1001))
    ring[-1] = ring[0]
    arcs = list(fit_move(cut(ring), FitOptions(tolerance_mm=0.001)))
    assert len(arcs) == 3
    assert sum(a.length_mm for a in arcs) == pytest.approx(10.0 * math.pi, abs=1e-3)


@settings(max_examples=60, deadline=None)
@given(
    steps=st.lists(st.tuples(st.floats(0.01, 1.0), st.floats(-0.5, 0.5)), min_size=3, max_size=60),
    tolerance=st.sampled_from([0.001, 0.01, 0.1]),
    share=st.sampled_from([0.0, 0.3, 1.0]),
    back=st.booleans(),
)
def test_the_result_stays_within_both_bounds(
    steps: list[tuple[float, float]], tolerance: float, share: float, back: bool
) -> None:
    line = np.cumsum(np.array(steps), axis=0)
    line = line[::-1] if back else line
    options = FitOptions(tolerance_mm=tolerance, gouge_mm=share * tolerance, material="below")
    fitted = list(fit_move(cut(in_plane(18, line)), options))
    path = ToolPath(moves=tuple(fitted), tool=tool_shape("ball", 8.0, 20.0))
    assert path.moves[0].start_mm[0] == line[0, 0] and path.moves[-1].end_mm[0] == line[-1, 0]
    made = np.concatenate([m.chords_mm(1e-5)[:, (0, 2)] for m in fitted])
    near = shapely.distance(shapely.LineString(line), shapely.points(made))
    assert near.max() <= tolerance + 2e-5
    # the line is a function of x, and so is the result: what lies below it cuts too deep
    order = np.argsort(line[:, 0])
    depth = np.interp(made[:, 0], line[order, 0], line[order, 1]) - made[:, 1]
    assert near[depth > 0.0].max(initial=0.0) <= share * tolerance + 2e-5


@pytest.mark.parametrize(("climb", "material"), [(True, "right"), (False, "left")])
def test_a_bound_on_the_side_of_the_part(climb: bool, material: str) -> None:
    ring = shapely.Point(0.0, 0.0).buffer(5.0, quad_segs=90)
    points = np.array(shapely.orient_polygons(ring).exterior.coords)
    points = points[::-1] if climb else points
    options = FitOptions(tolerance_mm=0.01, gouge_mm=1e-4, material=material)  # type: ignore[arg-type]
    made = np.concatenate([m.chords_mm(1e-6)[:, :2] for m in fit_move(cut(in_plane(17, points)), options)])
    inside = shapely.contains_xy(ring, made)
    assert shapely.distance(ring.exterior, shapely.points(made[inside])).max(initial=0.0) <= 1e-4 + 1e-6


def test_points_in_space_are_thinned_within_the_smaller_tolerance() -> None:
    t = np.linspace(0.0, 3.0, 500)
    helix = np.column_stack((np.cos(t), np.sin(t), 0.2 * t))
    (made,) = fit_move(cut(helix), FitOptions(tolerance_mm=0.01, gouge_mm=0.001))
    assert made.arc is None and 10 < len(made.points_mm) < 60
    off = [
        np.min(np.linalg.norm(np.linspace(a, b, 200)[:, None] - helix[None], axis=2), axis=1).max()
        for a, b in zip(made.points_mm, made.points_mm[1:], strict=False)
    ]
    spacing = float(np.linalg.norm(helix[1] - helix[0]))
    assert max(off) <= math.hypot(0.001, 0.5 * spacing) + 1e-6


def test_rapids_and_arcs_are_left_alone_and_feeds_kept() -> None:
    up = Move(kind=MoveKind.RAPID, points_mm=np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 5.0)]))
    line = Move(kind=MoveKind.CUT, points_mm=np.array([(0.0, 0.0, 5.0), (1, 0, 5), (2, 0, 5)]), feed_mm_min=77.0)
    path = fit_path(ToolPath(moves=(up, line), tool=tool_shape("ball", 8.0, 20.0)), FitOptions(tolerance_mm=0.01))
    assert path.moves[0] is up
    assert len(path.moves[1].points_mm) == 2 and path.moves[1].feed_mm_min == 77.0


@pytest.mark.parametrize("values", [{"tolerance_mm": 0.0}, {"tolerance_mm": 0.1, "gouge_mm": 0.2}])
def test_tolerances_that_cannot_be(values: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="_mm must be"):
        FitOptions(**values)  # type: ignore[arg-type]
