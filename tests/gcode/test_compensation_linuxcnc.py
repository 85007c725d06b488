"""LinuxCNC's cutter compensation by hand: entry, corners, what waits, and what is refused. The tool's radius is 2."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from typing import Any

import pytest

from gcode import compensation
from gcode.errors import GcodeError, Place
from gcode.events import ArcMotion, Dwell, Event, LinearMotion, Motion, MotionState

R = 2.0


def at(line: int) -> Place:
    return Place(file="t.ngc", line=line)


def line(start: complex, end: complex, number: int = 1, **changes: Any) -> LinearMotion:
    motion = LinearMotion(
        place=at(number),
        state=MotionState(),
        start_mm=(start.real, start.imag, 0.0),
        end_mm=(end.real, end.imag, 0.0),
        rapid=False,
        feed_mm_min=100.0 * number,
    )
    return replace(motion, **changes)


def arc(start: complex, centre: complex, sweep: float, number: int = 1) -> ArcMotion:
    end = centre + (start - centre) * cmath.exp(1j * sweep)
    return ArcMotion(
        place=at(number),
        state=MotionState(),
        start_mm=(start.real, start.imag, 0.0),
        end_mm=(end.real, end.imag, 0.0),
        centre_mm=(centre.real, centre.imag, 0.0),
        plane=17,
        turns=1 if sweep > 0.0 else -1,
        feed_mm_min=100.0 * number,
    )


def begin(motion: Motion, side: Any = "left", radius: float = R) -> compensation.Compensation:
    return compensation.begin("linuxcnc", side, radius, motion.state.plane, motion.start_mm, place=motion.place)


def run(*motions: Motion, side: Any = "left", radius: float = R) -> list[Motion]:
    comp, events = begin(motions[0], side, radius), list[Event]()
    for motion in motions:
        comp, made = compensation.move(comp, motion)
        events.extend(made)
    events.extend(compensation.end(comp)[0])
    return [event for event in events if isinstance(event, LinearMotion | ArcMotion)]


def ends(moves: list[Motion]) -> list[complex]:
    return [complex(*move.end_mm[:2]) for move in moves]


def refusal(*motions: Motion) -> GcodeError:
    with pytest.raises(GcodeError) as caught:
        run(*motions)
    return caught.value


ENTRY = line(0j, 20 + 0j, 1)


def test_straight_entry_ends_beside_its_programmed_end() -> None:
    assert ends(run(ENTRY)) == pytest.approx([20 + 2j])
    assert ends(run(ENTRY, side="right")) == pytest.approx([20 - 2j])
    assert ends(run(ENTRY, radius=-R)) == pytest.approx([20 - 2j])


def test_entry_arc_is_replaced_by_one_tangent_to_the_same_end() -> None:
    """From the origin about (0, 10) to (10, 10), from inside: it ends at (8, 10), heading up.

    Its centre (x, 10) is level with its end and as far from the origin as from there.
    """
    (made,) = run(arc(0j, 10j, math.pi / 2.0))
    assert isinstance(made, ArcMotion)
    x = (64.0 - 100.0) / 16.0
    assert complex(*made.end_mm[:2]) == pytest.approx(8 + 10j)
    assert complex(*made.centre_mm[:2]) == pytest.approx(complex(x, 10.0))


def test_convex_corner_is_an_arc_about_the_programmed_corner_at_the_feed_of_the_coming_block() -> None:
    made = run(ENTRY, line(20 + 0j, 20 - 30j, 2))
    joint = made[1]
    assert isinstance(joint, ArcMotion)
    assert ends(made) == pytest.approx([20 + 2j, 22 + 0j, 22 - 30j])
    assert (joint.turns, joint.centre_mm, joint.feed_mm_min, joint.place.line) == (-1, (20.0, 0.0, 0.0), 200.0, 2)


def test_convex_corner_before_a_rapid_is_cut_straight() -> None:
    rapid = line(20 + 0j, 20 - 30j, 2, rapid=True, feed_mm_min=0.0)
    made = run(ENTRY, rapid)
    assert [isinstance(move, LinearMotion) and move.rapid for move in made] == [False, True, True]
    assert ends(made) == pytest.approx([20 + 2j, 22 + 0j, 22 - 30j])


def test_concave_corner_moves_the_end_of_the_block_before() -> None:
    made = run(ENTRY, line(20 + 0j, 20 + 30j, 2), line(20 + 30j, 60 + 30j, 3))
    assert ends(made)[:2] == pytest.approx([18 + 2j, 18 + 30j])


def test_almost_straight_corners_are_left_as_they_are() -> None:
    """Below 0.05 rad the end beside the block before holds, on either side."""
    for angle in (0.049, -0.049):
        d2 = cmath.exp(1j * angle)
        assert ends(run(ENTRY, line(20 + 0j, 20 + 30 * d2, 2))) == pytest.approx([20 + 2j, 20 + 30 * d2 + 2j * d2])


def test_plunges_wait_with_the_block_before_them_and_move_with_its_end() -> None:
    down = line(20 + 0j, 20 + 0j, 2, end_mm=(20.0, 0.0, -5.0))
    after = line(20 + 0j, 20 + 30j, 3, start_mm=(20.0, 0.0, -5.0), end_mm=(20.0, 30.0, -5.0))
    made = run(ENTRY, down, after)
    assert [move.end_mm for move in made[:2]] == [pytest.approx((18.0, 2.0, 0.0)), pytest.approx((18.0, 2.0, -5.0))]


def test_the_way_round_a_corner_is_level() -> None:
    ramp = line(20 + 0j, 20 - 30j, 2, end_mm=(20.0, -30.0, -5.0))
    heights = [(move.start_mm[2], move.end_mm[2]) for move in run(ENTRY, ramp)]
    assert heights == [(0.0, 0.0), (0.0, 0.0), (0.0, -5.0)]


def test_other_events_keep_their_order() -> None:
    dwell = Dwell(place=at(1), state=MotionState(), seconds=1.0)
    comp = compensation.queue(begin(ENTRY), dwell)
    comp, events = compensation.move(comp, ENTRY)
    assert events == (dwell,)
    comp = compensation.queue(comp, dwell)
    _, events = compensation.move(comp, line(20 + 0j, 20 + 30j, 2))
    assert [type(event).__name__ for event in events] == ["LinearMotion", "Dwell"]


def test_without_an_entry_nothing_has_moved() -> None:
    assert compensation.end(begin(line(3 + 4j, 9 + 0j))) == ((), (3.0, 4.0, 0.0))


def test_g40_ends_beside_the_programmed_end_from_where_the_next_motion_starts() -> None:
    comp, _ = compensation.move(begin(ENTRY), ENTRY)
    _, point = compensation.end(comp)
    assert point == pytest.approx((20.0, 2.0, 0.0))
    leave = line(20 + 0j, 20 + 30j, 2)
    entry, last = compensation.cancel(comp, leave)
    assert isinstance(entry, LinearMotion) and isinstance(last, LinearMotion)
    assert (last.start_mm, last.end_mm) == (entry.end_mm, leave.end_mm)


def test_radius_zero_changes_nothing() -> None:
    path = [ENTRY, line(20 + 0j, 20 - 30j, 2), arc(20 - 30j, 20 - 40j, 1.0, 3)]
    assert run(*path, radius=0.0) == path


def test_a_whole_circle_stays_whole() -> None:
    circle = arc(20 + 0j, 20 + 10j, 2.0 * math.pi, 2)
    made = run(ENTRY, replace(circle, end_mm=circle.start_mm), line(20 + 0j, 40 + 0j, 3))[1]
    assert isinstance(made, ArcMotion)
    assert made.sweep_rad == pytest.approx(2.0 * math.pi)
    assert made.start_mm == pytest.approx((20.0, 2.0, 0.0))


@pytest.mark.parametrize(
    ("code", "number", "path"),
    [
        ("compensation-entry", 1, [line(0j, 2 + 0j)]),
        ("compensation-entry", 1, [line(0j, 0j, 1, end_mm=(0.0, 0.0, 9.0))]),
        ("compensation-arc-entry", 1, [arc(0j, 1j, 3.0)]),
        ("compensation-radius", 1, [arc(0j, 1.9j, 3.0)]),
        ("compensation-radius", 2, [ENTRY, arc(20 + 0j, 20 + 2j, 3.0, 2)]),
        ("compensation-gouge", 3, [ENTRY, line(20 + 0j, 40 + 0j, 2), line(40 + 0j, 40 + 1j, 3), line(40 + 1j, 0j, 4)]),
        ("compensation-gouge", 2, [ENTRY, line(20 + 0j, 21 + 0j, 2), line(21 + 0j, 21 + 9j, 3)]),
        ("compensation-gouge", 3, [ENTRY, line(20 + 0j, 40 + 0j, 2), arc(40 + 0j, 40 + 3j * cmath.exp(1.4j), 2.0, 3)]),
        ("compensation-plane", 2, [ENTRY, line(20 + 0j, 30 + 0j, 2, state=MotionState(plane=18))]),
    ],
)
def test_refusals(code: str, number: int, path: list[Motion]) -> None:
    error = refusal(*path)
    assert (error.code, error.place.line) == (code, number)


def test_no_compensation_in_the_yz_plane() -> None:
    with pytest.raises(GcodeError) as caught:
        compensation.begin("linuxcnc", "left", R, 19, (0.0, 0.0, 0.0), place=at(4))
    assert (caught.value.code, caught.value.place.line) == ("compensation-plane", 4)


def test_on_while_on() -> None:
    with pytest.raises(GcodeError) as caught:
        compensation.change(begin(ENTRY), "right", R, place=at(4))
    assert (caught.value.code, caught.value.place.line) == ("compensation-on", 4)


def test_an_arc_may_not_leave_compensation() -> None:
    comp, _ = compensation.move(begin(ENTRY), ENTRY)
    with pytest.raises(GcodeError) as caught:
        compensation.cancel(comp, arc(20 + 0j, 20 + 9j, 1.0, 5))
    assert (caught.value.code, caught.value.place.line) == ("compensation-arc-exit", 5)
