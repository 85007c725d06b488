"""FANUC's cutter compensation: each figure of the manual's chapter as a closed form.

The tool has the radius 5 and is on the left unless said; the corner is at the origin and the block before it runs
along x. ``turn`` is the angle by which the path turns to the left there: positive is an inner corner.
"""

from __future__ import annotations

import cmath
import itertools
import math
from dataclasses import replace
from typing import Any

import pytest

from gcode import compensation
from gcode.errors import GcodeError, Place
from gcode.events import PLANE_AXES, ArcMotion, Block, Dwell, Event, LinearMotion, Motion, MotionState, Notice, Plane
from gcode.events import Point as SpacePoint

R = 5.0
TYPES = ("fanuc-A", "fanuc-B")


def at(line: int) -> Place:
    return Place(file="t.nc", line=line)


def space(flat: complex, plane: Plane, height: float) -> SpacePoint:
    first, second, normal = PLANE_AXES[plane]
    point = [0.0, 0.0, 0.0]
    point[first], point[second], point[normal] = flat.real, flat.imag, height
    return (point[0], point[1], point[2])


def flat(point: SpacePoint, plane: Plane = 17) -> complex:
    return complex(point[PLANE_AXES[plane][0]], point[PLANE_AXES[plane][1]])


def line(start: complex, end: complex, number: int = 1, plane: Plane = 17, z: tuple[float, float] = (0, 0)) -> Motion:
    return LinearMotion(
        place=at(number),
        state=MotionState(plane=plane),
        start_mm=space(start, plane, z[0]),
        end_mm=space(end, plane, z[1]),
        rapid=False,
        feed_mm_min=100.0 * number,
    )


def arc(start: complex, centre: complex, sweep: float, number: int = 1, plane: Plane = 17) -> Motion:
    return ArcMotion(
        place=at(number),
        state=MotionState(plane=plane),
        start_mm=space(start, plane, 0.0),
        end_mm=space(centre + (start - centre) * cmath.exp(1j * sweep), plane, 0.0),
        centre_mm=space(centre, plane, 0.0),
        plane=plane,
        turns=1 if sweep > 0.0 else -1,
        feed_mm_min=100.0 * number,
    )


def begin(style: Any, motion: Motion, side: Any = "left", radius: float = R, **more: Any) -> compensation.Compensation:
    return compensation.begin(style, side, radius, motion.state.plane, motion.start_mm, place=motion.place, **more)


def run(style: Any, motions: list[Motion], *, side: Any = "left", radius: float = R, cancel: bool = False, **more: Any):  # type: ignore[no-untyped-def]
    """The events of a path; with `cancel` the last motion is that of G40."""
    comp = begin(style, motions[0], side, radius, **more)
    events: list[Event] = []
    for motion in motions[:-1] if cancel else motions:
        comp, made = compensation.move(comp, motion)
        events.extend(made)
    events.extend(compensation.cancel(comp, motions[-1]) if cancel else compensation.end(comp)[0])
    moves = [event for event in events if isinstance(event, LinearMotion | ArcMotion)]
    for before, after in itertools.pairwise(moves):
        assert before.end_mm == after.start_mm
    return moves


def ends(moves: list[Motion], plane: Plane = 17) -> list[complex]:
    return [flat(move.end_mm, plane) for move in moves]


def towards(turn_deg: float) -> complex:
    return cmath.exp(1j * math.radians(turn_deg))


def mitre(turn_deg: float) -> complex:
    """Meeting point of two lines at the distance R to the left, by the half-angle formula."""
    half = math.radians(turn_deg) / 2.0
    return complex(-R * math.tan(half), R)


def refusal(style: Any, motions: list[Motion], **more: Any) -> GcodeError:
    with pytest.raises(GcodeError) as caught:
        run(style, motions, **more)
    return caught.value


def first_ends(style: Any, turn: float, count: int, **more: Any) -> list[complex]:
    """Start-up along x to the corner, then a long block after it: where the tool's centre goes first."""
    return ends(run(style, [line(-40 + 0j, 0j, 1), line(0j, 200 * towards(turn), 2)], **more))[:count]


class TestStartUp:
    @pytest.mark.parametrize("turn", [-150.0, -90.0, -45.0, 0.0, 45.0, 90.0, 150.0])
    def test_type_a_ends_at_right_angles_to_the_next_block(self, turn: float) -> None:
        assert first_ends("fanuc-A", turn, 1) == pytest.approx([1j * R * towards(turn)])

    @pytest.mark.parametrize("turn", [10.0, 90.0, 150.0])
    def test_type_b_does_so_at_inner_corners(self, turn: float) -> None:
        assert first_ends("fanuc-B", turn, 1) == pytest.approx([1j * R * towards(turn)])

    @pytest.mark.parametrize("turn", [-10.0, -60.0, -90.0])
    def test_type_b_ends_at_the_intersection_at_an_obtuse_outer_corner(self, turn: float) -> None:
        assert first_ends("fanuc-B", turn, 1) == pytest.approx([mitre(turn)])

    @pytest.mark.parametrize("turn", [-91.0, -120.0, -170.0])
    def test_type_b_goes_round_an_acute_outer_corner_on_straight_lines(self, turn: float) -> None:
        normal = 1j * R * towards(turn)
        assert first_ends("fanuc-B", turn, 2) == pytest.approx([R * (1 + 1j), normal - R * towards(turn)])

    @pytest.mark.parametrize("style", TYPES)
    def test_an_arc_is_refused(self, style: str) -> None:
        error = refusal(style, [arc(0j, 10j, 1.0, 7), line(0j, 1j)])
        assert (error.code, error.place.line) == ("compensation-arc-entry", 7)

    @pytest.mark.parametrize("style", TYPES)
    def test_a_block_without_motion_in_the_plane_makes_no_vector(self, style: str) -> None:
        plunge = line(-40 + 0j, -40 + 0j, 1, z=(9.0, 2.0))
        moves = run(style, [plunge, line(-40 + 0j, 0j, 2, z=(2.0, 2.0)), line(0j, 50j, 3, z=(2.0, 2.0))])
        assert moves[0] == plunge
        assert flat(moves[1].end_mm) == pytest.approx(-R)

    def test_onto_an_arc_at_right_angles_to_its_tangent(self) -> None:
        moves = run("fanuc-A", [line(-40 + 0j, 0j, 1), arc(0j, -20j, -1.0, 2)])
        assert ends(moves) == pytest.approx([R * 1j, -20j + 25j * cmath.exp(-1j)])
        assert flat(moves[1].centre_mm) == -20j


class TestOffsetMode:
    """A block along x from -100 after the start-up, then the corner at the origin."""

    def path(self, turn: float, before: Motion | None = None, after: Motion | None = None) -> list[Motion]:
        before = before or line(-100 + 0j, 0j, 2)
        start = flat(before.start_mm)
        after = after or line(0j, 200 * towards(turn), 3)
        return [line(start - 60, start, 1), before, after]

    def ends(self, turn: float, **more: Any) -> list[complex]:
        return ends(run("fanuc-A", self.path(turn, more.pop("before", None), more.pop("after", None)), **more))[1:]

    @pytest.mark.parametrize("turn", [150.0, 90.0, 30.0, 1e-5, 0.0, -1e-5, -30.0, -90.0])
    def test_inner_and_obtuse_outer_corners_of_lines_meet_at_the_intersection(self, turn: float) -> None:
        made = self.ends(turn)
        assert made[0] == pytest.approx(mitre(turn))
        assert len(made) == 2

    @pytest.mark.parametrize("turn", [-90.1, -120.0, -179.0, 180.0])
    def test_an_acute_outer_corner_gets_two_points_and_a_straight_line(self, turn: float) -> None:
        d2 = towards(turn)
        made = self.ends(turn)
        assert made[:2] == pytest.approx([R * (1 + 1j), R * (1j * d2 - d2)])
        assert made[2] == pytest.approx(200 * d2 + R * 1j * d2)

    @pytest.mark.parametrize("turn", [-30.0, -120.0])
    def test_outer_corners_by_an_arc_where_the_parameter_asks_for_it(self, turn: float) -> None:
        moves = run("fanuc-A", self.path(turn), joint="arc")
        joint = moves[2]
        assert isinstance(joint, ArcMotion)
        assert flat(joint.centre_mm) == 0j
        assert joint.sweep_rad == pytest.approx(math.radians(turn))
        assert (joint.place.line, joint.feed_mm_min) == (2, 200.0)
        assert ends(moves)[1:3] == pytest.approx([R * 1j, R * 1j * towards(turn)])

    def test_the_way_round_a_corner_belongs_to_the_block_before(self) -> None:
        moves = run("fanuc-A", self.path(-120.0))
        assert [(move.place.line, move.feed_mm_min) for move in moves] == [
            (1, 100.0),
            (2, 200.0),
            (2, 200.0),
            (3, 300.0),
        ]

    def test_inner_corner_of_a_line_and_an_arc(self) -> None:
        """An arc of radius 20 about (20, 0), met from outside: the tool's centre is 25 from there and 5 above x."""
        made = self.ends(0.0, after=arc(0j, 20 + 0j, -2.0, 3))
        assert made[0] == pytest.approx(complex(20.0 - math.sqrt(25.0**2 - R**2), R))

    def test_inner_corner_of_a_line_and_an_arc_cut_from_inside(self) -> None:
        """An arc of radius 20 about (-20, 0): the tool's centre is 15 from there and 5 above x."""
        made = self.ends(0.0, after=arc(0j, -20 + 0j, 2.0, 3))
        assert made[0] == pytest.approx(complex(-20.0 + math.sqrt(15.0**2 - R**2), R))

    def test_inner_corner_of_an_arc_and_a_line_mirrors_that(self) -> None:
        before = arc(-20j - 20 + 0j, -20 + 0j, math.pi / 2.0, 2)
        made = ends(run("fanuc-A", [line(-80 - 20j, -20 - 20j, 1), before, line(0j, -60 + 0j, 3)]))
        assert made[1] == pytest.approx(complex(-20.0 + math.sqrt(15.0**2 - R**2), -R))

    def test_inner_corner_of_two_arcs(self) -> None:
        """Arcs of radius 20 about (0, -20), left, and (20, 0), both met from outside: 25 from either centre."""
        before = arc(-20 - 20j, -20j, -math.pi / 2.0, 2)
        made = ends(run("fanuc-A", [line(-20 - 80j, -20 - 20j, 1), before, arc(0j, 20 + 0j, -2.0, 3)]))
        along = math.sqrt(25.0**2 - 200.0)
        assert made[1] == pytest.approx(10 - 10j + along * cmath.exp(0.75j * math.pi))

    def test_obtuse_outer_corner_of_a_line_and_an_arc(self) -> None:
        """The arc is reached along its tangent."""
        made = self.ends(0.0, after=arc(0j, -20 + 0j, -2.0, 3))
        assert made[:2] == pytest.approx([mitre(-90.0), R + 0j])

    def test_acute_outer_corner_of_two_arcs(self) -> None:
        before = arc(-20 - 20j, -20j, -math.pi / 2.0, 2)
        after = arc(0j, 20j * towards(-120.0), 1.0, 3)
        made = ends(run("fanuc-A", [line(-20 - 80j, -20 - 20j, 1), before, after]))[1:]
        d2 = towards(-120.0)
        assert made[:4] == pytest.approx([R * 1j, R * (1 + 1j), R * (1j * d2 - d2), R * 1j * d2])

    def test_a_full_circle_stays_one(self) -> None:
        for side, radius in (("left", 15.0), ("right", 25.0)):
            circle = arc(0j, 20j, 2.0 * math.pi, 2)
            circle = replace(circle, end_mm=circle.start_mm)
            made = run("fanuc-A", [line(-40 + 0j, 0j, 1), circle, line(0j, 40 + 0j, 3)], side=side)[1]
            assert isinstance(made, ArcMotion)
            assert made.sweep_rad == pytest.approx(2.0 * math.pi)
            assert abs(flat(made.start_mm) - 20j) == pytest.approx(radius)

    @pytest.mark.parametrize("plane", [17, 18, 19])
    def test_every_plane(self, plane: Plane) -> None:
        path = [line(-160 + 0j, -100 + 0j, 1, plane), line(-100 + 0j, 0j, 2, plane), line(0j, 200j, 3, plane)]
        assert ends(run("fanuc-A", path), plane)[1] == pytest.approx(mitre(90.0))

    def test_helices_keep_their_heights(self) -> None:
        helix = replace(arc(0j, 20j, 1.0, 2), end_mm=(*arc(0j, 20j, 1.0).end_mm[:2], -3.0))
        made = run("fanuc-A", [line(-40 + 0j, 0j, 1), helix])[1]
        assert (made.start_mm[2], made.end_mm[2]) == (0.0, -3.0)

    def test_negative_radius_swaps_the_sides(self) -> None:
        path = self.path(-120.0)
        assert run("fanuc-B", path, radius=-R) == run("fanuc-B", path, side="right")

    def test_radius_zero_leaves_the_path(self) -> None:
        path = self.path(-120.0)
        assert run("fanuc-A", path, radius=0.0) == path


class TestReadingAhead:
    def comp(self) -> compensation.Compensation:
        first = line(-40 + 0j, 0j, 1)
        comp, _ = compensation.move(begin("fanuc-A", first), first)
        comp, _ = compensation.move(comp, line(0j, 60 + 0j, 2))
        return comp

    def test_other_events_come_out_in_order_behind_the_block(self) -> None:
        comp, dwell = self.comp(), Dwell(place=at(3), state=MotionState(), seconds=1.0)
        comp = compensation.queue(compensation.queue(comp, Block(place=at(3))), dwell)
        comp, made = compensation.move(comp, line(60 + 0j, 60 + 0j, 4, z=(0.0, 8.0)))
        assert made == ()
        comp = compensation.queue(comp, Block(place=at(5)))
        _, events = compensation.move(comp, line(60 + 0j, 60 + 60j, 5, z=(8.0, 8.0)))
        assert [type(event).__name__ for event in events] == ["LinearMotion", "Block", "Dwell", "LinearMotion", "Block"]
        lifted = events[3]
        assert isinstance(lifted, LinearMotion)
        assert lifted.start_mm == pytest.approx((55.0, 5.0, 0.0))
        assert lifted.end_mm == pytest.approx((55.0, 5.0, 8.0))

    @pytest.mark.parametrize(("blocks", "seen"), [(0, True), (1, True), (2, True), (3, False)])
    def test_over_more_than_two_blocks_the_next_motion_is_not_seen(self, blocks: int, seen: bool) -> None:
        comp = self.comp()
        for number in range(blocks):
            comp = compensation.queue(comp, Block(place=at(3 + number)))
        comp = compensation.queue(comp, Block(place=at(9)))
        comp, events = compensation.move(comp, line(60 + 0j, 60 + 60j, 9))
        first = events[0]
        assert isinstance(first, LinearMotion)
        assert flat(first.end_mm) == pytest.approx(55 + 5j if seen else 60 + 5j)
        notices = [event for event in events if isinstance(event, Notice)]
        assert [notice.code for notice in notices] == ([] if seen else ["compensation-look-ahead"])
        last = compensation.end(comp)[0][0]
        assert isinstance(last, LinearMotion)
        assert last.start_mm == first.end_mm
        assert flat(last.end_mm) == pytest.approx(55 + 60j)


class TestCancel:
    def ends(self, style: str, turn: float) -> list[complex]:
        path = [line(-160 + 0j, -100 + 0j, 1), line(-100 + 0j, 0j, 2), line(0j, 40 * towards(turn), 3)]
        made = ends(run(style, path, cancel=True))[1:]
        assert made[-1] == pytest.approx(40 * towards(turn))
        return made[:-1]

    @pytest.mark.parametrize("turn", [-150.0, -60.0, 60.0])
    def test_type_a_leaves_at_right_angles_to_the_block_before(self, turn: float) -> None:
        assert self.ends("fanuc-A", turn) == pytest.approx([R * 1j])

    def test_type_b_by_the_kind_of_corner(self) -> None:
        d2 = towards(-150.0)
        assert self.ends("fanuc-B", 60.0) == pytest.approx([R * 1j])
        assert self.ends("fanuc-B", -60.0) == pytest.approx([mitre(-60.0)])
        assert self.ends("fanuc-B", -150.0) == pytest.approx([R * (1 + 1j), R * (1j * d2 - d2)])

    @pytest.mark.parametrize("style", TYPES)
    def test_an_arc_is_refused(self, style: str) -> None:
        path = [line(-40 + 0j, 0j, 1), line(0j, 40 + 0j, 2), arc(40 + 0j, 40 + 10j, 1.0, 3)]
        error = refusal(style, path, cancel=True)
        assert (error.code, error.place.line) == ("compensation-arc-entry", 3)

    def test_g40_alone_ends_at_right_angles(self) -> None:
        first = line(-40 + 0j, 0j, 1)
        comp, _ = compensation.move(begin("fanuc-B", first), first)
        comp, _ = compensation.move(comp, line(0j, 60 + 0j, 2, z=(0.0, 4.0)))
        events, point = compensation.end(comp)
        assert point == pytest.approx((60.0, 5.0, 4.0))
        assert ends([event for event in events if isinstance(event, LinearMotion)]) == pytest.approx([60 + 5j])

    def test_a_motion_along_the_normal_does_not_leave_the_offset(self) -> None:
        path = [line(-40 + 0j, 0j, 1), line(0j, 60 + 0j, 2), line(60 + 0j, 60 + 0j, 3, z=(0.0, 9.0))]
        assert run("fanuc-A", path, cancel=True)[-1].end_mm == pytest.approx((60.0, 5.0, 9.0))


class TestChange:
    def changed(self, side: Any, radius: float, after: list[Motion], *, alone: bool = False) -> list[Motion]:
        path = [line(-160 + 0j, -100 + 0j, 1), line(-100 + 0j, 0j, 2)]
        comp = begin("fanuc-A", path[0])
        events: list[Event] = []
        for motion in path:
            comp, made = compensation.move(comp, motion)
            events.extend(made)
        comp = compensation.change(comp, side, radius, place=at(3), alone=alone)
        for motion in after:
            comp, made = compensation.move(comp, motion)
            events.extend(made)
        events.extend(compensation.end(comp)[0])
        return [event for event in events if isinstance(event, LinearMotion | ArcMotion)][1:]

    def test_another_side_crosses_over_at_the_corner(self) -> None:
        made = ends(self.changed("right", R, [line(0j, 80 * towards(-30.0), 3)]))
        beside = -1j * R * towards(-30.0)
        assert made == pytest.approx([R * 1j, beside, 80 * towards(-30.0) + beside])

    def test_another_offset_holds_from_the_end_of_the_next_block(self) -> None:
        made = ends(self.changed("left", 8.0, [line(0j, 80j, 3), line(80j, 80 + 80j, 4)]))
        assert made == pytest.approx([-R + R * 1j, complex(-8.0, 88.0), complex(80.0, 88.0)])

    def test_an_arc_goes_from_the_old_offset_to_the_new(self) -> None:
        made = self.changed("left", 6.0, [arc(0j, 20j, math.pi / 2.0, 3)])
        assert ends(made) == pytest.approx([R * 1j, 14 + 20j])

    def test_the_same_code_alone_makes_a_vector_at_right_angles(self) -> None:
        for turn in (60.0, -60.0):
            end = 80 * towards(turn)
            made = ends(self.changed("left", R, [line(0j, end, 3)], alone=True))
            assert made == pytest.approx([R * 1j, end + 1j * R * towards(turn)])
        assert len(self.changed("left", R, [line(0j, 80j, 3)])) == 2


class TestRefusals:
    def test_groove_narrower_than_the_tool(self) -> None:
        """Interference (PS0041): the bottom of 8 mm between two inner corners would be run backwards."""
        path = [line(-90 + 0j, -40 + 0j, 1), line(-40 + 0j, 0j, 2), line(0j, 8j, 3), line(8j, -40 + 8j, 4)]
        error = refusal("fanuc-A", path)
        assert (error.code, error.place.line) == ("compensation-gouge", 3)
        assert "8.0000 mm" in error.problem and "5.0000 mm" in error.problem

    def test_groove_as_wide_as_the_tool_is_cut(self) -> None:
        path = [line(-90 + 0j, -40 + 0j, 1), line(-40 + 0j, 0j, 2), line(0j, 10j, 3), line(10j, -40 + 10j, 4)]
        assert ends(run("fanuc-A", path))[1:3] == pytest.approx([-5 + 5j, -5 + 5j])

    def test_arc_that_the_corners_use_up(self) -> None:
        path = [line(-90 + 0j, -40 + 0j, 1), line(-40 + 0j, 0j, 2), arc(0j, -20 + 0j, 0.3, 3)]
        end = flat(path[-1].end_mm)
        error = refusal("fanuc-A", [*path, line(end, -60 + 8j, 4)])
        assert (error.code, error.place.line) == ("compensation-gouge", 3)

    @pytest.mark.parametrize("radius", [R, 4.0])
    def test_arc_not_greater_than_the_tool(self, radius: float) -> None:
        error = refusal("fanuc-A", [line(-40 + 0j, 0j, 1), arc(0j, radius * 1j, 1.0, 2)])
        assert (error.code, error.place.line) == ("compensation-radius", 2)

    def test_shifted_paths_that_do_not_meet(self) -> None:
        """An arc of radius 8 from inside leaves a circle of radius 3, which the line 5 beside does not reach."""
        path = [line(-90 + 0j, -40 + 0j, 1), line(-40 + 0j, 0j, 2), arc(0j, -8 * cmath.exp(-0.1j), 2.0, 3)]
        assert refusal("fanuc-A", path).code == "compensation-no-intersection"

    def test_another_plane(self) -> None:
        error = refusal("fanuc-A", [line(-40 + 0j, 0j, 1), line(0j, 10j, 2, plane=18)])
        assert (error.code, error.place.line) == ("compensation-plane", 2)

    @pytest.mark.parametrize("radius", [math.nan, math.inf])
    def test_radius_that_is_no_number(self, radius: float) -> None:
        with pytest.raises(GcodeError) as caught:
            begin("fanuc-A", line(0j, 1 + 0j), radius=radius)
        assert caught.value.code == "compensation-radius"
