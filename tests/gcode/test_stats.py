"""Lengths and extremes of paths by closed forms, and the sums of programs."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gcode.errors import Call, Place
from gcode.events import (
    PLANE_AXES,
    ArcMotion,
    Block,
    Dwell,
    LinearMotion,
    MotionState,
    Notice,
    Plane,
    Point,
    ToolChange,
)
from gcode.report.motion_json import motion_objects
from gcode.report.path_geometry import extremes_mm, length_mm, points_mm
from gcode.report.stats import MOST_VALUES, program_stats
from gcode.report.stats_json import stats_object

PLACE = Place(file="t.nc", line=7, column=3, text="G1 X1")
CUTTING = MotionState(tool=2, spindle_rpm=1000.0, spindle_direction=1)


def line(start: Point, end: Point, *, feed: float = 0.0, **changes: Any) -> LinearMotion:
    """A feed, or a rapid without one."""
    values: dict[str, Any] = {"place": PLACE, "state": CUTTING, **changes}
    return LinearMotion(start_mm=start, end_mm=end, rapid=feed == 0.0, feed_mm_min=feed, **values)


def arc(radii: tuple[float, float], start: float, sweep: float, rise: float = 0.0, plane: Plane = 17) -> ArcMotion:
    """An arc about (1, 2, 3) from an angle on, both in rad; its radius goes from one to the other."""
    i, j, k = PLANE_AXES[plane]

    def point(radius: float, angle: float, height: float) -> Point:
        made = [1.0, 2.0, 3.0]
        made[i] += radius * math.cos(angle)
        made[j] += radius * math.sin(angle)
        made[k] += height
        return (made[0], made[1], made[2])

    turns = int(math.copysign(math.ceil(abs(sweep) / (2.0 * math.pi) - 1e-12), sweep))
    first, last = point(radii[0], start, 0.0), point(radii[1], start + sweep, rise)
    if abs(math.remainder(sweep, 2.0 * math.pi)) < 1e-12 and radii[0] == radii[1]:
        closed = list(first)
        closed[k] = last[k]
        last = (closed[0], closed[1], closed[2])
    return ArcMotion(
        place=PLACE,
        state=CUTTING,
        start_mm=first,
        end_mm=last,
        centre_mm=(1.0, 2.0, 3.0),
        plane=plane,
        turns=turns,
        feed_mm_min=120.0,
    )


planes = st.sampled_from((17, 18, 19))
sweeps = st.floats(0.01, 20.0) | st.floats(-20.0, -0.01)


@given(st.floats(0.1, 100.0), st.floats(-3.0, 3.0), sweeps, st.floats(-5.0, 5.0), planes)
def test_a_helix_is_as_long_as_its_unrolled_triangle(
    r: float, start: float, sweep: float, rise: float, p: Plane
) -> None:
    assert length_mm(arc((r, r), start, sweep, rise, p)) == pytest.approx(math.hypot(r * sweep, rise), rel=1e-9)


def test_lengths_in_closed_form() -> None:
    assert length_mm(line((0.0, 0.0, 0.0), (3.0, 4.0, 12.0))) == 13.0
    assert length_mm(arc((5.0, 5.0), 0.0, 2.0 * math.pi)) == pytest.approx(10.0 * math.pi, rel=1e-12)
    slope = 0.05 / math.pi  # r' of a spiral: integral of sqrt(r^2 + r'^2) over the angle
    primitive = [0.5 * (r * math.hypot(r, slope) / slope + slope * math.asinh(r / slope)) for r in (5.0, 5.05)]
    assert length_mm(arc((5.0, 5.05), 0.3, math.pi)) == pytest.approx(primitive[1] - primitive[0], rel=1e-9)


@given(st.floats(0.1, 100.0), st.floats(-0.2, 0.2), st.floats(-3.0, 3.0), sweeps, st.floats(-5.0, 5.0), planes)
def test_extremes_hold_the_path_and_no_more(
    r: float, slope: float, start: float, sweep: float, rise: float, p: Plane
) -> None:
    motion = arc((r, r * (1.0 + slope * min(abs(sweep), 2.0))), start, sweep, rise, p)
    low, high = extremes_mm(motion)
    points = points_mm(motion, 1e-6 * r)
    assert np.all(points >= np.array(low) - 1e-9 * r)
    assert np.all(points <= np.array(high) + 1e-9 * r)
    assert np.allclose(points.min(axis=0), low, atol=3e-6 * r)
    assert np.allclose(points.max(axis=0), high, atol=3e-6 * r)


def test_a_half_circle_bulges_beyond_its_ends() -> None:
    low, high = extremes_mm(arc((10.0, 10.0), -math.pi / 2.0, math.pi))
    assert low == pytest.approx((1.0, -8.0, 3.0), abs=1e-12)
    assert high == pytest.approx((11.0, 12.0, 3.0), abs=1e-12)


@given(st.floats(0.5, 100.0), st.floats(-3.0, 3.0), sweeps, st.floats(1e-3, 0.2), planes)
def test_chords_lie_within_their_tolerance(r: float, start: float, sweep: float, tolerance: float, p: Plane) -> None:
    motion = arc((r, r), start, sweep, plane=p)
    points = points_mm(motion, tolerance)
    assert (tuple(points[0]), tuple(points[-1])) == (motion.start_mm, motion.end_mm)
    middles = (points[1:] + points[:-1]) / 2.0 - np.array(motion.centre_mm)
    assert np.all(r - np.linalg.norm(middles, axis=1) <= tolerance + 1e-9)


def test_a_program_in_sums() -> None:
    state = MotionState(tool=3, spindle_rpm=500.0)
    events = [
        Block(place=PLACE),
        ToolChange(place=PLACE, tool=2),
        line((0.0, 0.0, 0.0), (0.0, 0.0, 100.0)),
        line((0.0, 0.0, 100.0), (0.0, 60.0, 100.0), feed=600.0),
        arc((10.0, 10.0), 0.0, math.pi),
        Block(place=PLACE),
        Dwell(place=PLACE, state=state, seconds=2.5),
        line((0.0, 0.0, 0.0), (30.0, 0.0, 0.0), feed=60.0, state=state, tapping=True),
        Notice(place=PLACE, code="no-motion", text=""),
    ]
    found = program_stats(events, rapid_mm_min=6000.0)
    assert (found.blocks, found.tool_changes, found.notices, found.untimed) == (2, 1, 1, 0)
    assert list(found.tools) == [2, 3]
    second, third, total = found.tools[2], found.tools[3], found.total
    assert (second.rapid_mm, second.rapid_s, third.rapid_mm) == (100.0, 1.0, 0.0)
    assert second.cutting_mm == pytest.approx(60.0 + 10.0 * math.pi)
    assert second.cutting_s == pytest.approx(6.0 + 5.0 * math.pi)
    assert (third.cutting_s, third.dwell_s, third.time_s) == (30.0, 2.5, 32.5)
    assert second.motions == {"rapid": 1, "feed": 1, "arc": 1}
    assert total.motions == {"rapid": 1, "feed": 1, "arc": 1, "tap": 1, "dwell": 1}
    assert total.travel_mm == pytest.approx(second.travel_mm + third.travel_mm)
    assert total.time_s == pytest.approx(second.time_s + third.time_s)
    assert total.feeds_mm_min is not None
    assert total.feeds_mm_min.each == (60.0, 120.0, 600.0)
    assert second.speeds_rpm is not None
    assert second.speeds_rpm.each == (1000.0,)
    assert third.speeds_rpm is None


def test_boxes_of_cutting_and_of_all() -> None:
    found = program_stats([line((0.0, 0.0, 0.0), (0.0, 0.0, 50.0)), arc((10.0, 10.0), 0.0, 2.0 * math.pi)])
    assert found.cutting_box is not None
    assert found.box is not None
    assert found.cutting_box.size_mm == pytest.approx((20.0, 20.0, 0.0), abs=1e-12)
    assert found.box.low_mm == pytest.approx((-9.0, -8.0, 0.0), abs=1e-12)
    assert found.box.high_mm == pytest.approx((11.0, 12.0, 50.0), abs=1e-12)


def test_an_empty_program_has_no_box() -> None:
    found = program_stats([])
    assert (found.box, found.cutting_box, found.total.time_s, dict(found.tools)) == (None, None, 0.0, {})


def test_many_feeds_are_told_by_their_least_and_largest() -> None:
    moves = [line((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), feed=float(1 + n)) for n in range(MOST_VALUES + 1)]
    feeds = program_stats(moves).total.feeds_mm_min
    assert feeds is not None
    assert (feeds.each, feeds.least, feeds.largest) == (None, 1.0, MOST_VALUES + 1.0)


def test_a_motion_at_no_feed_has_no_time_and_is_counted() -> None:
    stopped = LinearMotion(
        place=PLACE, state=CUTTING, start_mm=(0.0, 0.0, 0.0), end_mm=(1.0, 0.0, 0.0), rapid=False, feed_mm_min=0.0
    )
    found = program_stats([stopped])
    assert (found.untimed, found.total.time_s, found.total.cutting_mm) == (1, 0.0, 1.0)


@pytest.mark.parametrize("rate", [0.0, -1.0, math.inf, math.nan])
def test_rates_of_rapids_are_positive_and_finite(rate: float) -> None:
    with pytest.raises(ValueError, match="rapid_mm_min must be positive and finite"):
        program_stats([], rate)


def test_statistics_as_json() -> None:
    made = stats_object(program_stats([line((0.0, 0.0, 0.0), (0.0, 0.0, 100.0), feed=200.0)]))
    assert json.loads(json.dumps(made, allow_nan=False)) == made
    assert made["box_mm"] == {"low": [0.0, 0.0, 0.0], "high": [0.0, 0.0, 100.0], "size": [0.0, 0.0, 100.0]}
    assert made["feeds_mm_min"] == {"least": 200.0, "largest": 200.0, "each": [200.0]}
    assert [tool["tool"] for tool in made["tools"]] == [2]
    assert made["time_s"] == 30.0


def test_motions_as_json() -> None:
    calls = (Call(program="O1000", file="main.nc", line=4),)
    state = MotionState(tool=5, spindle_rpm=800.0, spindle_direction=-1, wcs="G55", length_number=5, radius_number=6)
    place = Place(file="sub.nc", line=12, column=4, calls=calls)
    moved = line((0.0, 0.0, 0.0), (0.1 + 0.2, -0.0, 1.0), feed=200.0, state=state, place=place)
    assert list(motion_objects([Block(place=place), moved])) == [
        {
            "type": "feed",
            "line": 12,
            "end": [0.3, 0.0, 1.0],
            "feed_mm_min": 200.0,
            "tool": 5,
            "spindle_rpm": 800.0,
            "spindle_dir": -1,
            "feed_mode": "per-minute",
            "wcs": "G55",
            "h": 5,
            "d": 6,
            "compensation": "off",
            "file": "sub.nc",
            "column": 4,
            "calls": [{"program": "O1000", "file": "main.nc", "line": 4}],
        }
    ]


@pytest.mark.parametrize(
    ("made", "expected"),
    [
        (lambda: line((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), {"type": "rapid", "feed_mm_min": 0.0}),
        (lambda: line((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), feed=9.0, tapping=True), {"type": "tap", "feed_mm_min": 9.0}),
        (
            lambda: arc((5.0, 5.0), 0.0, -3.0 * math.pi, plane=18),
            {"type": "arc", "plane": 18, "centre": [1.0, 2.0, 3.0], "turns": -2},
        ),
        (
            lambda: line((0.0,) * 3, (0.0,) * 3, feed=1.0, extra=(0.0, 90.0, 0.0, 0.0, 0.0, 0.0)),
            {"type": "feed", "abc": [0.0, 90.0, 0.0]},
        ),
        (
            lambda: line((0.0,) * 3, (0.0,) * 3, feed=1.0, extra=(0.0, 0.0, 0.0, 0.0, 0.0, 4.0)),
            {"type": "feed", "uvw": [0.0, 0.0, 4.0]},
        ),
    ],
)
def test_types_of_motions_and_what_only_they_have(made: Callable[[], Any], expected: dict[str, Any]) -> None:
    (found,) = motion_objects([made()])
    assert expected.items() <= found.items()
    own = {"plane", "centre", "turns", "abc", "uvw", "seconds", "calls"}
    assert own & found.keys() == own & expected.keys()


def test_a_dwell_is_where_the_last_motion_ended() -> None:
    wait = Dwell(place=PLACE, state=CUTTING, seconds=0.5)
    found = list(motion_objects([wait, line((0.0,) * 3, (1.0, 2.0, 3.0)), wait], start_mm=(7.0, 8.0, 9.0)))
    assert [entry["end"] for entry in found] == [[7.0, 8.0, 9.0], [1.0, 2.0, 3.0], [1.0, 2.0, 3.0]]
    assert (found[0]["type"], found[0]["seconds"], found[0]["feed_mm_min"]) == ("dwell", 0.5, 0.0)
