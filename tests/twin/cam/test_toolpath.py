from __future__ import annotations

import math

import numpy as np
import pytest

from twin.cam.path.toolpath import Move, MoveKind, ToolPath, arc_sweep_rad, rapid_over
from twin.motion.path import Arc
from twin.tools.shape import tool_shape

BALL = tool_shape("ball", 8.0, 20.0)


def cut(*points: tuple[float, float, float], feed: float = 600.0) -> Move:
    return Move(kind=MoveKind.CUT, points_mm=np.array(points), feed_mm_min=feed)


def test_lengths_times_and_box_of_a_path() -> None:
    half = Move(
        kind=MoveKind.LEAD,
        points_mm=np.array([(10.0, 0.0, 0.0), (10.0, 4.0, 0.0)]),
        feed_mm_min=300.0,
        arc=Arc(centre_mm=np.array([10.0, 2.0, 0.0]), plane=17, sweep_rad=math.pi),
    )
    path = ToolPath(moves=(cut((0, 0, 0), (10, 0, 0)), half), tool=BALL)
    assert path.lengths_mm() == {MoveKind.CUT: 10.0, MoveKind.LEAD: pytest.approx(2.0 * math.pi)}
    assert path.duration_s(10_000.0) == pytest.approx(1.0 + 2.0 * math.pi / 300.0 * 60.0)
    low, high = path.box_mm()
    assert low.tolist() == [0.0, 0.0, 0.0]
    assert high == pytest.approx([12.0, 4.0, 0.0], abs=1e-9)
    assert path.points == 3


def test_moves_begin_where_the_last_one_ends() -> None:
    with pytest.raises(ValueError, match=r"moves\[1\] begins 1 mm from where moves\[0\] ends"):
        ToolPath(moves=(cut((0, 0, 0), (1, 0, 0)), cut((1, 1, 0), (2, 1, 0))), tool=BALL)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"points_mm": np.zeros((1, 3))}, "must have shape"),
        ({"points_mm": np.array([(0.0, 0.0, math.nan), (1.0, 0.0, 0.0)])}, "must be finite"),
        ({"feed_mm_min": 0.0}, "feed_mm_min must be 0 for a rapid and above 0 else"),
        ({"kind": MoveKind.RAPID}, "feed_mm_min must be 0 for a rapid"),
        ({"kind": "slide"}, "slide"),
    ],
)
def test_moves_that_cannot_be_are_refused(changes: dict[str, object], message: str) -> None:
    values = {"kind": MoveKind.CUT, "points_mm": np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]), "feed_mm_min": 600.0}
    with pytest.raises(ValueError, match=message):
        Move(**(values | changes))  # type: ignore[arg-type]


def test_two_paths_are_joined_at_the_safe_height() -> None:
    one = ToolPath(moves=(cut((0, 0, 0), (1, 0, 0)),), tool=BALL, name="rough")
    two = ToolPath(moves=(cut((5, 5, -1), (6, 5, -1)),), tool=BALL, name="finish")
    both = ToolPath.joined([one, two], 10.0)
    assert both.name == "rough + finish"
    assert [m.kind for m in both.moves] == [MoveKind.CUT, *[MoveKind.RAPID] * 3, MoveKind.CUT]
    assert both.box_mm(MoveKind.RAPID)[1].tolist() == [5.0, 5.0, 10.0]


def test_half_a_million_points_are_one_array() -> None:
    x = np.linspace(0.0, 100.0, 500_001)
    move = Move(kind=MoveKind.CUT, points_mm=np.column_stack((x, 0.0 * x, 0.0 * x)), feed_mm_min=100.0)
    path = ToolPath(moves=(move,), tool=BALL)
    assert path.points == 500_001
    assert path.lengths_mm()[MoveKind.CUT] == pytest.approx(100.0)


def test_rapids_leave_out_what_has_no_length() -> None:
    assert len(rapid_over((0, 0, 5), (1, 0, 5), 5.0)) == 1


def test_sweep_counts_whole_turns() -> None:
    start, centre = np.array([1.0, 0.0, 0.0]), np.zeros(3)
    assert arc_sweep_rad(start, np.array([0.0, 1.0, 0.0]), centre, 17, 1) == pytest.approx(0.5 * math.pi)
    assert arc_sweep_rad(start, np.array([0.0, 1.0, 0.0]), centre, 17, -1) == pytest.approx(-1.5 * math.pi)
    assert arc_sweep_rad(start, start, centre, 17, 2) == pytest.approx(4.0 * math.pi)
