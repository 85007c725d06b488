"""Lines, arcs and helices divided into chords; NC events turned into moves of the tool tip."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from gcode.errors import Place
from gcode.events import ArcMotion, Dwell, LinearMotion, MotionState, ToolChange
from twin.motion.from_nc import moves_from_nc
from twin.motion.path import Arc, Move
from twin.motion.rapids import independent_legs

PLACE = Place(file="t.nc", line=7)


def arc_move(plane: int, sweep: float, rise: float, radius: float = 5.0) -> Move:
    i, j, k = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}[plane]
    centre, start, end = np.full(3, 2.0), np.full(3, 2.0), np.full(3, 2.0)
    start[i] += radius
    end[i] += radius * math.cos(sweep)
    end[j] += radius * math.sin(sweep)
    end[k] += rise
    arc = Arc(centre_mm=centre, plane=plane, sweep_rad=sweep)
    return Move(
        start_mm=start,
        end_mm=end,
        arc=arc,
        duration_s=1.0,
        feed_mm_min=1.0,
        spindle_rpm=0.0,
        tool=1,
        rapid=False,
        nc_line=1,
    )


@pytest.mark.parametrize("plane", [17, 18, 19])
@pytest.mark.parametrize("sweep", [math.pi / 2, -math.pi / 2, 2 * math.pi, -5 * math.pi])
@pytest.mark.parametrize("rise", [0.0, -3.0])
def test_chords_of_an_arc_stay_within_tolerance_and_step(plane: int, sweep: float, rise: float) -> None:
    move = arc_move(plane, sweep, rise)
    assert move.length_mm == pytest.approx(math.hypot(5.0 * sweep, rise))
    corners = move.corners_mm(0.5, 0.002)
    assert np.array_equal(corners[0], move.start_mm)
    assert np.array_equal(corners[-1], move.end_mm)
    pieces = np.diff(corners, axis=0)
    assert np.linalg.norm(pieces, axis=1).max() <= 0.5 + 1e-9
    middle = 0.5 * (corners[:-1] + corners[1:])
    i, j, _ = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}[plane]
    assert 5.0 - np.hypot(middle[:, i] - 2.0, middle[:, j] - 2.0).min() <= 0.002 + 1e-9
    turn = np.cross(pieces[0], pieces[1])[{17: 2, 18: 1, 19: 0}[plane]]
    assert math.copysign(1.0, turn) == math.copysign(1.0, sweep)


@pytest.mark.parametrize("turns", [3.0, -2.5, 12.3])
def test_the_turns_of_an_arc_have_the_same_corners(turns: float) -> None:
    move = arc_move(17, 2.0 * math.pi * turns, -3.0)
    corners = move.corners_mm(0.7, 0.01)
    per_turn = next(i for i in range(3, len(corners)) if np.allclose(corners[i, :2], corners[0, :2]))
    assert np.abs(corners[per_turn:-1, :2] - corners[: -per_turn - 1, :2]).max() < 1e-12
    steps = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    assert steps.max() <= 0.7
    assert steps[:-1] == pytest.approx(steps[0])
    assert np.array_equal(corners[-1], move.end_mm)


def test_a_straight_move_is_one_piece() -> None:
    move = Move(
        start_mm=np.zeros(3),
        end_mm=np.array([3.0, 4.0, 0.0]),
        duration_s=1.0,
        feed_mm_min=300.0,
        spindle_rpm=0.0,
        tool=1,
        rapid=False,
        nc_line=1,
    )
    assert len(move.corners_mm(0.1, 0.001)) == 2
    assert move.length_mm == 5.0


def moves(*events: LinearMotion | ArcMotion | Dwell | ToolChange) -> list[object]:
    return list(
        moves_from_nc(
            events,
            origin_mm=np.array([100.0, 50.0, -200.0]),
            start_mm=(130.0, 60.0, 0.0),
            tool_length_mm={1: 80.0},
            rapid_mm_min=30000.0,
        )
    )


def test_the_tip_is_the_controlled_point_with_the_right_offset_and_lower_without() -> None:
    with_offset = MotionState(tool=1, length_offset_mm=80.0, spindle_rpm=1000.0, spindle_direction=-1)
    without = MotionState(tool=1)
    line = {"place": PLACE, "rapid": False, "feed_mm_min": 300.0}
    first, second = moves(
        LinearMotion(state=with_offset, start_mm=(100.0, 50.0, -190.0), end_mm=(110.0, 50.0, -190.0), **line),
        LinearMotion(state=without, start_mm=(110.0, 50.0, -110.0), end_mm=(110.0, 60.0, -110.0), **line),
    )
    assert isinstance(first, Move)
    assert isinstance(second, Move)
    assert first.start_mm.tolist() == [0.0, 0.0, 10.0]
    assert first.end_mm.tolist() == [10.0, 0.0, 10.0]
    assert first.duration_s == pytest.approx(2.0)
    assert first.spindle_rpm == -1000.0
    assert first.nc_line == 7
    assert second.start_mm.tolist() == [10.0, 0.0, 10.0]


def test_rapids_take_the_rapid_rate_and_dwells_their_time() -> None:
    state = MotionState(tool=1, length_offset_mm=80.0)
    rapid = LinearMotion(
        place=PLACE, state=state, start_mm=(0.0, 0.0, 0.0), end_mm=(0.0, 0.0, 50.0), rapid=True, feed_mm_min=0.0
    )
    first, second, third = moves(rapid, Dwell(place=PLACE, state=state, seconds=2.5), ToolChange(place=PLACE, tool=2))
    assert isinstance(first, Move)
    assert isinstance(second, Move)
    assert first.rapid
    assert first.duration_s == pytest.approx(0.1)
    assert second.duration_s == 2.5
    assert np.array_equal(second.start_mm, first.end_mm)
    assert isinstance(third, ToolChange)


def test_a_dwell_is_where_the_tool_is_also_before_any_motion_and_after_a_tool_change() -> None:
    with_tool, without = MotionState(tool=1), MotionState(tool=0)
    rapid = LinearMotion(
        place=PLACE, state=with_tool, start_mm=(0.0, 0.0, 0.0), end_mm=(100.0, 50.0, -50.0), rapid=True, feed_mm_min=0.0
    )
    dwells = [Dwell(place=PLACE, state=state, seconds=1.0) for state in (without, with_tool)]
    first, second, _, third, fourth = moves(*dwells, rapid, *dwells)
    tips = [m.start_mm.tolist() for m in (first, second, third, fourth) if isinstance(m, Move)]
    assert tips == [[30.0, 10.0, 200.0], [30.0, 10.0, 120.0], [0.0, 0.0, 150.0], [0.0, 0.0, 70.0]]


def test_axes_that_move_independently_arrive_one_after_another() -> None:
    move = Move(
        start_mm=np.array([0.0, 0.0, 50.0]),
        end_mm=np.array([100.0, -40.0, 20.0]),
        duration_s=1.0,
        feed_mm_min=6000.0,
        spindle_rpm=0.0,
        tool=1,
        rapid=True,
        nc_line=3,
    )
    legs = list(independent_legs(move, np.array([6000.0, 6000.0, 2000.0])))
    assert [leg.end_mm.tolist() for leg in legs] == [
        pytest.approx([40.0, -40.0, 50.0 - 40.0 / 3.0]),
        pytest.approx([90.0, -40.0, 20.0]),
        [100.0, -40.0, 20.0],
    ]
    assert [leg.duration_s for leg in legs] == pytest.approx([0.4, 0.5, 0.1])
    assert all(leg.feed_mm_min == pytest.approx(60.0 * leg.length_mm / leg.duration_s) for leg in legs)
    assert [np.array_equal(a.end_mm, b.start_mm) for a, b in pairwise(legs)] == [True, True]
    together = replace(move, end_mm=np.array([30.0, 30.0, 80.0]))
    assert [leg.end_mm.tolist() for leg in independent_legs(together, np.full(3, 6000.0))] == [[30.0, 30.0, 80.0]]
