"""Times of tool paths against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from twin.cam.path.machining_time import Dynamics, machining_time
from twin.cam.path.toolpath import Move, MoveKind, ToolPath
from twin.motion.path import Arc
from twin.tools.shape import tool_shape

TOOL = tool_shape("flat", 10.0, 30.0)
A = 1000.0
DYNAMICS = Dynamics(rapid_mm_min=30_000.0, acceleration_mm_s2=A, rapid_mm_s2=2500.0, corner_tolerance_mm=0.01)


def cut(points: object, feed: float = 6000.0) -> Move:
    return Move(kind=MoveKind.CUT, points_mm=points, feed_mm_min=feed)  # type: ignore[arg-type]


def total(*moves: Move) -> float:
    return machining_time(ToolPath(moves=moves, tool=TOOL), DYNAMICS).total_s


def test_a_long_block_is_a_trapezoid() -> None:
    # 100 mm/s at 1000 mm/s2: 0.1 s and 5 mm each to start and stop, 90 mm at speed
    assert total(cut([[0, 0, 0], [100, 0, 0]])) == pytest.approx(1.1, rel=1e-12)


def test_a_short_block_is_a_triangle() -> None:
    assert total(cut([[0, 0, 0], [0, 4, 0]])) == pytest.approx(2.0 * math.sqrt(4.0 / A), rel=1e-12)


def test_a_rapid_has_its_own_speed_and_acceleration() -> None:
    move = Move(kind=MoveKind.RAPID, points_mm=np.array([[0.0, 0, 0], [0, 0, 200]]))
    assert total(move) == pytest.approx(200.0 / 500.0 + 500.0 / 2500.0, rel=1e-12)


@pytest.mark.parametrize("pieces", [2, 7, 1000])
def test_a_straight_chain_takes_as_long_as_one_block(pieces: int) -> None:
    x = np.linspace(0.0, 100.0, pieces + 1)
    assert total(cut(np.column_stack((x, 0 * x, -x)))) == pytest.approx(
        total(cut([[0, 0, 0], [100, 0, -100]])), rel=1e-9
    )


def test_a_right_angle_is_taken_at_the_speed_of_its_rounding() -> None:
    sine = math.sin(0.25 * math.pi)
    corner = math.sqrt(A * 0.01 * sine / (1.0 - sine))
    # two equal blocks, one end at rest, the other at the corner's speed
    one = 0.1 + (100.0 - corner) / A + (100.0 - (100.0**2 + 100.0**2 - corner**2) / (2.0 * A)) / 100.0
    assert total(cut([[0, 0, 0], [100, 0, 0], [100, 100, 0]])) == pytest.approx(2.0 * one, rel=1e-9)


def test_a_reversal_is_a_stop() -> None:
    assert total(cut([[0, 0, 0], [100, 0, 0], [0, 0, 0]])) == pytest.approx(2.2, rel=1e-9)


def test_look_ahead_brakes_over_many_short_blocks() -> None:
    # a right angle after 1000 pieces of 0.1 mm: as with one block of 100 mm
    x = np.linspace(0.0, 100.0, 1001)
    line = np.column_stack((x, 0 * x, 0 * x))
    assert total(cut(np.vstack((line, [[100.0, 0.1, 0.0], [100.0, 100.0, 0.0]])))) == pytest.approx(
        total(cut([[0, 0, 0], [100, 0, 0], [100, 0.1, 0], [100, 100, 0]])), rel=1e-3
    )


def test_an_arc_is_bounded_by_its_centripetal_acceleration() -> None:
    # r 2.5: 50 mm/s; a whole turn is 15.7 mm, 2.5 mm of it at each end for starting and stopping
    arc = Move(
        kind=MoveKind.CUT,
        points_mm=np.array([[2.5, 0, 0], [2.5, 0, 0]]),
        feed_mm_min=6000.0,
        arc=Arc(centre_mm=np.zeros(3), plane=17, sweep_rad=math.tau),
    )
    length = math.tau * 2.5
    assert total(arc) == pytest.approx(length / 50.0 + 50.0 / A, rel=1e-9)


def test_chords_of_a_circle_take_about_as_long_as_the_circle() -> None:
    t = np.linspace(0.0, math.tau, 721)
    circle = 2.5 * np.column_stack((np.cos(t), np.sin(t), 0 * t))
    assert total(cut(circle)) == pytest.approx(math.tau * 2.5 / 50.0 + 50.0 / A, rel=0.02)


def test_an_arc_goes_on_from_a_tangent_line_without_a_stop() -> None:
    line = cut([[0, -50, 0], [10, -50, 0]])
    arc = Move(
        kind=MoveKind.CUT,
        points_mm=np.array([[10.0, -50, 0], [60, 0, 0]]),
        feed_mm_min=6000.0,
        arc=Arc(centre_mm=np.array([10.0, 0, 0]), plane=17, sweep_rad=0.5 * math.pi),
    )
    assert total(line, arc) == pytest.approx((10.0 + 25.0 * math.pi) / 100.0 + 0.1, rel=1e-9)


def test_kinds_and_moves_add_up() -> None:
    path = ToolPath(
        moves=(
            cut([[0, 0, 0], [30, 0, 0]]),
            Move(kind=MoveKind.RAPID, points_mm=np.array([[30.0, 0, 0], [30, 0, 50]])),
            cut([[30, 0, 50], [30, 0, 0]], 600.0),
        ),
        tool=TOOL,
    )
    times = machining_time(path, DYNAMICS)
    assert times.kind_s[MoveKind.CUT] + times.kind_s[MoveKind.RAPID] == pytest.approx(times.total_s)
    assert times.cutting_s == pytest.approx(times.move_s[0] + times.move_s[2])
    assert times.move_s[1] == pytest.approx(2.0 * math.sqrt(50.0 / 2500.0))


def test_no_moves_take_no_time() -> None:
    assert machining_time(ToolPath(moves=(), tool=TOOL), DYNAMICS).total_s == 0.0


def test_values_that_cannot_be_are_refused() -> None:
    with pytest.raises(ValueError, match="corner_tolerance_mm must be above 0"):
        Dynamics(corner_tolerance_mm=0.0)
