"""Laws of cutter compensation, for random paths and both kinds of control."""

from __future__ import annotations

import cmath
import itertools
import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gcode import compensation
from gcode.errors import GcodeError, Place
from gcode.events import ArcMotion, Event, LinearMotion, Motion, MotionState

STYLES = ("linuxcnc", "fanuc-A", "fanuc-B")
styles = st.sampled_from(STYLES)
sides = st.sampled_from(["left", "right"])
#: LinuxCNC leaves corners below 0.05 rad as they are, and may then be a little nearer.
CORNER_RAD = 0.06


def motion_of(start: complex, end: complex, number: int, centre: complex | None = None, turns: int = 1) -> Motion:
    keys: dict[str, Any] = {
        "place": Place(file="t.nc", line=number),
        "state": MotionState(),
        "start_mm": (start.real, start.imag, 0.0),
        "end_mm": (end.real, end.imag, 0.0),
        "feed_mm_min": 100.0,
    }
    if centre is None:
        return LinearMotion(**keys, rapid=False)
    return ArcMotion(**keys, centre_mm=(centre.real, centre.imag, 0.0), plane=17, turns=turns)


def polyline(points: list[complex]) -> list[Motion]:
    return [motion_of(a, b, n) for n, (a, b) in enumerate(itertools.pairwise(points), start=1)]


def run(style: Any, side: Any, radius: float, motions: list[Motion]) -> list[Motion]:
    comp = compensation.begin(style, side, radius, 17, motions[0].start_mm, place=motions[0].place)
    events: list[Event] = []
    for motion in motions:
        comp, made = compensation.move(comp, motion)
        events.extend(made)
    events.extend(compensation.end(comp)[0])
    return [event for event in events if isinstance(event, LinearMotion | ArcMotion)]


def run_or_code(style: Any, side: Any, radius: float, motions: list[Motion]) -> list[Motion] | str:
    try:
        return run(style, side, radius, motions)
    except GcodeError as error:
        return error.code


def samples(motion: Motion, count: int = 20) -> list[complex]:
    start, end = complex(*motion.start_mm[:2]), complex(*motion.end_mm[:2])
    if isinstance(motion, LinearMotion):
        return [start + (end - start) * k / count for k in range(count + 1)]
    centre, sweep = complex(*motion.centre_mm[:2]), motion.sweep_rad
    return [centre + (start - centre) * cmath.exp(1j * sweep * k / count) for k in range(count + 1)]


def distance(point: complex, start: complex, end: complex) -> float:
    along = (end - start) / abs(end - start)
    share = min(max(((point - start) / along).real, 0.0), abs(end - start))
    return abs(point - start - share * along)


def turned(first: complex, second: complex) -> float:
    return abs(cmath.phase(second / first))


@st.composite
def convex_polygons(draw: st.DrawFn) -> list[complex]:
    """Corners counter-clockwise on an ellipse."""
    gaps = draw(st.lists(st.floats(0.3, 2.0), min_size=3, max_size=8))
    scale, a, b = 2.0 * math.pi / sum(gaps), draw(st.floats(1.0, 40.0)), draw(st.floats(1.0, 40.0))
    angles = [scale * sum(gaps[:k]) for k in range(len(gaps))]
    return [complex(a * math.cos(angle), b * math.sin(angle)) for angle in angles]


@given(styles, convex_polygons(), st.floats(0.1, 20.0))
@settings(deadline=None)
def test_outside_a_convex_polygon_the_tool_touches_every_edge_and_cuts_none(
    style: str, corners: list[complex], radius: float
) -> None:
    edges = list(zip(corners, [*corners[1:], corners[0]], strict=True))
    directions = [b - a for a, b in edges]
    assume(all(turned(d, e) > CORNER_RAD for d, e in zip(directions, [*directions[1:], directions[0]], strict=True)))
    along = directions[0] / abs(directions[0])
    path = polyline([corners[0] - (radius + 10.0) * along, *corners, corners[0]])
    made = run(style, "right", radius, path)[1:]
    assert min(distance(point, a, b) for motion in made for point in samples(motion) for a, b in edges) > radius - 1e-6
    straight = [motion for motion in made if isinstance(motion, LinearMotion)]
    for a, b in edges:
        reach = (distance((a + b) / 2.0, complex(*m.start_mm[:2]), complex(*m.end_mm[:2])) for m in straight)
        assert min(reach) == pytest.approx(radius, abs=1e-6)


@st.composite
def folded_lines(draw: st.DrawFn) -> list[complex]:
    """A long first block, then shorter ones, of which no two in a row turn the path by 3 rad or more."""
    points, heading, before = [0j, 9 + 0j], 0.0, 0.0
    for _ in range(draw(st.integers(1, 4))):
        side = draw(st.sampled_from([-1.0, 1.0]))
        side = -side if side * before > 2.9 - CORNER_RAD else side
        turn = side * draw(st.floats(CORNER_RAD, min(2.9, 2.9 - side * before)))
        heading, before = heading + turn, turn
        points.append(points[-1] + cmath.rect(draw(st.floats(1.0, 30.0)), heading))
    return points


@given(styles, sides, st.floats(0.1, 4.0), folded_lines())
@settings(deadline=None)
def test_the_tool_never_cuts_the_block_it_is_on_nor_its_neighbours(
    style: str, side: str, radius: float, points: list[complex]
) -> None:
    """Local as the controls' own checks are: a path that curls up on itself is none of it."""
    made = run_or_code(style, side, radius, polyline(points))
    if isinstance(made, str):
        assert made == "compensation-gouge"
        return
    for motion in made:
        block = motion.place.line
        if block == 1 or (isinstance(motion, LinearMotion) and math.dist(motion.start_mm, motion.end_mm) == 0.0):
            continue
        for other in range(max(block - 1, 2), min(block + 1, len(points) - 1) + 1):
            for point in samples(motion):
                assert distance(point, points[other - 1], points[other]) > radius - 1e-6


@given(styles, st.floats(0.2, 3.0), st.floats(0.1, 3.0), st.floats(-math.pi, math.pi))
def test_inner_corners_of_lines_meet_at_the_exact_intersection(
    style: str, radius: float, turn: float, heading: float
) -> None:
    d1 = cmath.exp(1j * heading)
    d2 = d1 * cmath.exp(1j * turn)
    length = radius * math.tan(turn / 2.0) + radius + 1.0
    corner = 7 - 3j
    entry = corner - 2 * length * d1
    made = run(style, "left", radius, polyline([entry, corner - length * d1, corner, corner + length * d2]))
    expected = corner + 1j * radius * (d1 + d2) / (1.0 + math.cos(turn))
    assert abs(complex(*made[1].end_mm[:2]) - expected) < 1e-6


def mirrored(motion: Motion) -> Motion:
    def flip(point: tuple[float, float, float]) -> tuple[float, float, float]:
        return (point[0], -point[1], point[2])

    if isinstance(motion, LinearMotion):
        return replace(motion, start_mm=flip(motion.start_mm), end_mm=flip(motion.end_mm))
    return replace(
        motion,
        start_mm=flip(motion.start_mm),
        end_mm=flip(motion.end_mm),
        centre_mm=flip(motion.centre_mm),
        turns=-motion.turns,
    )


@st.composite
def paths(draw: st.DrawFn) -> list[Motion]:
    """A straight entry, then lines and arcs."""
    motions, at, heading = [motion_of(0j, 12 + 0j, 1)], 12 + 0j, 0.0
    for number in range(draw(st.integers(1, 4))):
        heading += draw(st.one_of(st.just(0.0), st.floats(-3.0, 3.0)))
        size, sweep = draw(st.floats(2.0, 20.0)), draw(st.one_of(st.just(0.0), st.floats(-5.0, 5.0)))
        if abs(sweep) < 0.2:
            end = at + cmath.rect(size, heading)
            motions.append(motion_of(at, end, number + 2))
        else:
            centre = at + cmath.rect(size, heading + math.copysign(math.pi / 2.0, sweep))
            end = centre + (at - centre) * cmath.exp(1j * sweep)
            motions.append(motion_of(at, end, number + 2, centre, 1 if sweep > 0.0 else -1))
            heading += sweep
        at = end
    return motions


@given(styles, paths(), st.floats(0.1, 5.0))
@settings(deadline=None)
def test_a_mirrored_path_on_the_other_side_is_the_mirrored_result(
    style: str, path: list[Motion], radius: float
) -> None:
    made = run_or_code(style, "left", radius, path)
    other = run_or_code(style, "right", radius, [mirrored(motion) for motion in path])
    if isinstance(made, str) or isinstance(other, str):
        assert made == other
        return
    for mine, theirs in zip(made, [mirrored(motion) for motion in other], strict=True):
        assert mine.start_mm == pytest.approx(theirs.start_mm, abs=1e-6)
        assert mine.end_mm == pytest.approx(theirs.end_mm, abs=1e-6)


@given(styles, paths(), sides, st.floats(0.1, 5.0))
@settings(deadline=None)
def test_the_tool_s_centre_moves_without_a_gap(style: str, path: list[Motion], side: str, radius: float) -> None:
    made = run_or_code(style, side, radius, path)
    if isinstance(made, str):
        assert made.startswith("compensation-")
        return
    assert made[0].start_mm == path[0].start_mm
    for before, after in itertools.pairwise(made):
        assert before.end_mm == after.start_mm


@given(styles, st.booleans(), st.sampled_from([1, -1]), st.floats(0.1, 4.9), st.floats(5.0, 50.0))
def test_a_whole_circle_is_one_of_the_radius_less_or_more_the_tool_s(
    style: str, inside: bool, turns: int, radius: float, circle: float
) -> None:
    side = "left" if inside == (turns > 0) else "right"
    whole = motion_of(0j, 0j, 2, turns * circle * 1j, turns)
    made = run(style, side, radius, [motion_of(-20 + 0j, 0j, 1), whole, motion_of(0j, 20 + 0j, 3)])[1]
    assert isinstance(made, ArcMotion)
    assert made.centre_mm == whole.centre_mm  # type: ignore[union-attr]
    assert made.sweep_rad == pytest.approx(2.0 * math.pi * turns)
    for point in (made.start_mm, made.end_mm):
        assert math.dist(point, made.centre_mm) == pytest.approx(circle - radius if inside else circle + radius)
