"""Chamfers and roundings between two motions: closed forms, tangency, and what is refused."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from gcode.errors import GcodeError, Place
from gcode.events import PLANE_AXES, ArcMotion, LinearMotion, Motion, MotionState, Plane, Point
from gcode.phases.corners import insert_corner


def space(flat: complex, plane: Plane = 17, height: float = 0.0) -> Point:
    first, second, normal = PLANE_AXES[plane]
    point = [0.0, 0.0, 0.0]
    point[first], point[second], point[normal] = flat.real, flat.imag, height
    return (point[0], point[1], point[2])


def flat(point: Point, plane: Plane = 17) -> complex:
    return complex(point[PLANE_AXES[plane][0]], point[PLANE_AXES[plane][1]])


def line(start: complex, end: complex, plane: Plane = 17, *, number: int = 1, **changes: Any) -> LinearMotion:
    motion = LinearMotion(
        place=Place(file="t.nc", line=number),
        state=MotionState(plane=plane),
        start_mm=space(start, plane),
        end_mm=space(end, plane),
        rapid=False,
        feed_mm_min=100.0 * number,
    )
    return replace(motion, **changes)


def arc(start: complex, centre: complex, sweep: float, plane: Plane = 17, *, number: int = 1) -> ArcMotion:
    return ArcMotion(
        place=Place(file="t.nc", line=number),
        state=MotionState(plane=plane),
        start_mm=space(start, plane),
        end_mm=space(centre + (start - centre) * cmath.exp(1j * sweep), plane),
        centre_mm=space(centre, plane),
        plane=plane,
        turns=1 if sweep > 0.0 else -1,
        feed_mm_min=100.0 * number,
    )


def refused(first: Motion, second: Motion, kind: Any, size: float) -> GcodeError:
    with pytest.raises(GcodeError) as caught:
        insert_corner(first, second, kind, size)
    assert caught.value.place == first.place
    return caught.value


def tangent(motion: Motion, point: complex) -> complex:
    if isinstance(motion, LinearMotion):
        along = flat(motion.end_mm, motion.state.plane) - flat(motion.start_mm, motion.state.plane)
        return along / abs(along)
    radius = point - flat(motion.centre_mm, motion.plane)
    return radius / abs(radius) * (1j if motion.turns > 0 else -1j)


def assert_smooth(before: Motion, after: Motion, plane: Plane) -> None:
    assert before.end_mm == after.start_mm
    point = flat(before.end_mm, plane)
    assert abs(tangent(before, point) - tangent(after, point)) < 1e-6


@pytest.mark.parametrize("plane", [17, 18, 19])
def test_chamfer_takes_its_size_from_both_motions(plane: Plane) -> None:
    first, joint, second = insert_corner(
        line(0j, 50 + 0j, plane), line(50 + 0j, 50 + 30j, plane, number=2), "chamfer", 5.0
    )
    assert flat(first.end_mm, plane) == 45 + 0j == flat(joint.start_mm, plane)
    assert flat(joint.end_mm, plane) == 50 + 5j == flat(second.start_mm, plane)
    assert isinstance(joint, LinearMotion) and not joint.rapid
    assert second.end_mm == space(50 + 30j, plane)


@pytest.mark.parametrize("plane", [17, 18, 19])
def test_rounding_of_a_right_angle(plane: Plane) -> None:
    first, joint, second = insert_corner(
        line(0j, 50 + 0j, plane), line(50 + 0j, 50 - 30j, plane, number=2), "round", 8.0
    )
    assert isinstance(joint, ArcMotion)
    assert (joint.turns, joint.plane) == (-1, plane)
    assert flat(first.end_mm, plane) == pytest.approx(42 + 0j)
    assert flat(second.start_mm, plane) == pytest.approx(50 - 8j)
    assert flat(joint.centre_mm, plane) == pytest.approx(42 - 8j)
    assert joint.sweep_rad == pytest.approx(-math.pi / 2.0)


def test_place_feed_and_axes_are_those_of_the_first_block() -> None:
    extra = (1.0, 2.0, 3.0, 0.0, 0.0, 0.0)
    one = line(0j, 20 + 0j, extra=extra)
    for kind in ("chamfer", "round"):
        first, joint, second = insert_corner(one, line(20 + 0j, 20 + 20j, number=2), kind, 2.0)  # type: ignore[arg-type]
        assert (joint.place, joint.feed_mm_min, joint.extra) == (one.place, 100.0, extra)
        assert (first.place.line, second.place.line) == (1, 2)
        assert (first.feed_mm_min, second.feed_mm_min) == (100.0, 200.0)


@given(st.floats(0.05, 3.0), st.sampled_from([1, -1]), st.floats(0.1, 5.0), st.floats(-math.pi, math.pi))
def test_rounding_between_lines_takes_r_tan_half_the_turn(turn: float, side: int, size: float, heading: float) -> None:
    used = size * math.tan(turn / 2.0)
    d1 = cmath.exp(1j * heading)
    d2 = d1 * cmath.exp(1j * side * turn)
    corner, length = 3 - 2j, used + 1.0
    first, joint, second = insert_corner(
        line(corner - length * d1, corner), line(corner, corner + length * d2), "round", size
    )
    assert isinstance(joint, ArcMotion)
    assert abs(flat(first.end_mm) - (corner - used * d1)) < 1e-6
    assert abs(flat(second.start_mm) - (corner + used * d2)) < 1e-6
    assert joint.sweep_rad == pytest.approx(side * turn, abs=1e-6)
    assert_smooth(first, joint, 17)
    assert_smooth(joint, second, 17)


@given(
    st.floats(-2.8, 2.8),
    st.floats(0.2, 2.0),
    st.floats(4.0, 12.0),
    st.floats(4.0, 12.0),
    st.sampled_from([(0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)]),
    st.sampled_from([17, 18, 19]),
)
def test_rounding_at_arcs_is_tangent_to_both(
    turn: float, size: float, r1: float, r2: float, bends: tuple[int, int], plane: Plane
) -> None:
    assume(abs(turn) > 0.1)
    d2 = cmath.exp(1j * turn)
    first: Motion = line(-30 + 0j, 0j, plane)
    second: Motion = line(0j, 30 * d2, plane, number=2)
    if bends[0]:
        centre, sweep = 1j * bends[0] * r1, bends[0] * 2.5
        first = arc(centre - centre * cmath.exp(-1j * sweep), centre, sweep, plane)
        first = replace(first, end_mm=space(0j, plane))
    if bends[1]:
        second = arc(0j, 1j * bends[1] * r2 * d2, bends[1] * 2.5, plane, number=2)
    try:
        one, joint, two = insert_corner(first, second, "round", size)
    except GcodeError as error:
        assert error.code == "corner-too-large"
        return
    assert isinstance(joint, ArcMotion)
    assert abs(flat(joint.start_mm, plane) - flat(joint.centre_mm, plane)) == pytest.approx(size, abs=1e-6)
    assert_smooth(one, joint, plane)
    assert_smooth(joint, two, plane)
    for motion, given_motion in ((one, first), (two, second)):
        if isinstance(motion, ArcMotion) and isinstance(given_motion, ArcMotion):
            assert 0.0 < abs(motion.sweep_rad) < abs(given_motion.sweep_rad)


def test_rounding_from_a_line_onto_an_arc() -> None:
    """A line along x into a half circle of radius 10 about (0, 10), which leaves the corner straight up.

    The rounding's centre is 3 above the line and 10 - 3 from the arc's centre, where the arc is met from inside.
    """
    half = arc(10 + 10j, 10j, math.pi)
    first, joint, second = insert_corner(line(-20 + 10j, 10 + 10j), half, "round", 3.0)
    assert isinstance(joint, ArcMotion)
    centre = complex(math.sqrt(7.0**2 - 3.0**2), 13.0)
    assert flat(joint.centre_mm) == pytest.approx(centre)
    assert flat(first.end_mm) == pytest.approx(complex(centre.real, 10.0))
    assert flat(second.start_mm) == pytest.approx(10j + 10.0 * (centre - 10j) / 7.0)


def test_a_corner_may_use_up_straight_motions() -> None:
    for kind in ("chamfer", "round"):
        first, joint, second = insert_corner(line(0j, 5 + 0j), line(5 + 0j, 5 + 5j), kind, 5.0)  # type: ignore[arg-type]
        assert first.start_mm == pytest.approx(first.end_mm)
        assert second.start_mm == pytest.approx(second.end_mm)
        assert joint.start_mm == pytest.approx((0.0, 0.0, 0.0))


@pytest.mark.parametrize("kind", ["chamfer", "round"])
@pytest.mark.parametrize("degrees", [-1.0, 0.0, 0.9])
def test_within_one_degree_the_corner_has_no_length(kind: Any, degrees: float) -> None:
    one = line(0j, 10 + 0j)
    two = line(10 + 0j, 10 + 10 * cmath.exp(1j * math.radians(degrees * 0.999)))
    first, joint, second = insert_corner(one, two, kind, 2.0)
    assert (first, second) == (one, two)
    assert joint.start_mm == joint.end_mm == one.end_mm


ONE, TWO = line(0j, 10 + 0j), line(10 + 0j, 10 + 10j, number=2)


@pytest.mark.parametrize(
    ("code", "first", "second", "size"),
    [
        ("corner-size", ONE, TWO, 0.0),
        ("corner-size", ONE, TWO, -1.0),
        ("corner-size", ONE, TWO, math.nan),
        ("corner-too-large", ONE, TWO, 10.1),
        ("corner-too-large", ONE, line(10 + 0j, 10 + 1j), 2.0),
        ("corner-no-motion", ONE, line(10 + 0j, 10 + 0j), 1.0),
        ("corner-no-motion", line(10 + 0j, 10 + 0j), TWO, 1.0),
        ("corner-motion", replace(ONE, rapid=True), TWO, 1.0),
        ("corner-motion", ONE, replace(TWO, rapid=True), 1.0),
        ("corner-plane", ONE, replace(TWO, state=MotionState(plane=18)), 1.0),
        ("corner-plane", ONE, replace(TWO, end_mm=(10.0, 10.0, -1.0)), 1.0),
        ("corner-tangent", ONE, line(10 + 0j, 2 + 0j), 1.0),
    ],
)
@pytest.mark.parametrize("kind", ["chamfer", "round"])
def test_refusals(kind: Any, code: str, first: Motion, second: Motion, size: float) -> None:
    assert refused(first, second, kind, size).code == code


def test_chamfer_at_an_arc_is_refused() -> None:
    assert refused(ONE, arc(10 + 0j, 15 + 0j, -1.0), "chamfer", 1.0).code == "corner-arc-chamfer"


def test_rounding_larger_than_an_arc_that_holds_it_is_refused() -> None:
    """Inside an arc of radius 2 there is no room for one of 3."""
    inside = arc(10 + 0j, 8 + 0j, 3.0)
    error = refused(ONE, inside, "round", 3.0)
    assert error.code == "corner-too-large"
    assert "3.0000 mm" in error.problem
