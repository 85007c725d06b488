"""Laws that hold for every program: random arcs, random ways of writing one text, random rubbish."""

from __future__ import annotations

import math
import random
import tracemalloc
from dataclasses import replace
from itertools import pairwise

from hypothesis import given, settings
from hypothesis import strategies as st

from gcode.dialects import DIALECTS
from gcode.errors import GcodeError
from gcode.events import PLANE_AXES, ArcMotion, Block, Event, LinearMotion, Point
from gcode.flow.interpreter import check, interpret
from gcode.settings import MachineSettings, ToolOffset

SETTINGS = MachineSettings(tools={1: ToolOffset(length_mm=75.0)}, home_mm=(0.0, 0.0, 400.0), start_mm=(5.0, 5.0, 300.0))
PLANE = st.sampled_from(sorted(PLANE_AXES))
SENSE = st.sampled_from([2, 3])
LENGTH = st.floats(-300.0, 300.0).map(lambda x: round(x, 4))

PROGRAM = """%
O12 (A PART)
N10 G17 G21 G90 G40 G49 G80
N20 T3 M6
N30 S4000 M3
N40 G0 X-12.5 Y0.25 M8
G43 Z5. H1
G1 Z-1.5 F120.
G3 X-7.5 Y5.25 I0. J5.
G91 G1 X10. Y-.5
G90 G18 G2 X12.5 Z-1.5 R5.
G19 G3 Y7. Z0.75 J2.25 K0.
G4 P250
G28 G91 Z0.
G90 G53 X0. Y0.
M9
M30
"""


def run(text: str) -> list[Event]:
    return list(interpret(text, settings=SETTINGS))


def without_places(events: list[Event]) -> list[Event]:
    nowhere = events[0].place
    return [replace(event, place=nowhere) for event in events]


def motions(events: list[Event]) -> list[LinearMotion | ArcMotion]:
    return [event for event in events if isinstance(event, LinearMotion | ArcMotion)]


def radii(arc: ArcMotion) -> tuple[float, float]:
    i, j, _ = PLANE_AXES[arc.plane]
    at, centre = (arc.start_mm, arc.end_mm), arc.centre_mm
    first, second = (math.hypot(p[i] - centre[i], p[j] - centre[j]) for p in at)
    return first, second


def word(axis: int, value: float, letters: str = "XYZ") -> str:
    return f"{letters[axis]}{value:.4f}"


@given(PLANE, SENSE, st.floats(0.05, 500.0), st.floats(0.0, 2 * math.pi), st.floats(0.05, 2 * math.pi - 0.05), LENGTH)
def test_an_arc_by_its_centre(plane: int, code: int, radius: float, at: float, swept: float, rise: float) -> None:
    """Radii agree within the text's rounding, and the sweep is the one that was written."""
    i, j, k = PLANE_AXES[plane]
    sign = 1 if code == 3 else -1
    to_centre = (-radius * math.cos(at), -radius * math.sin(at))
    to_end = (radius * (math.cos(at + sign * swept)), radius * math.sin(at + sign * swept))
    words = [word(i, to_centre[0] + to_end[0]), word(j, to_centre[1] + to_end[1]), word(k, rise)]
    words += [word(i, to_centre[0], "IJK"), word(j, to_centre[1], "IJK")]
    (arc,) = motions(run(f"G91 G{plane} G{code} F100 {' '.join(words)}\nM30"))
    assert isinstance(arc, ArcMotion)
    start, end = radii(arc)
    rounding = 4 * 0.5e-4
    assert abs(start - end) <= rounding
    assert abs(arc.sweep_rad - sign * swept) <= 2 * rounding / radius + 1e-9
    assert arc.centre_mm[k] == arc.start_mm[k]
    assert math.isclose(arc.end_mm[k] - arc.start_mm[k], round(rise, 4), abs_tol=1e-9)


@given(PLANE, SENSE, LENGTH, LENGTH, st.floats(1.0, 100.0), st.booleans())
def test_an_arc_by_its_radius(plane: int, code: int, along: float, across: float, factor: float, long: bool) -> None:
    """Both ends lie on the circle; R > 0 gives at most half a turn, R < 0 at least half."""
    chord = math.hypot(along, across)
    if chord < 0.01:
        return
    i, j, _ = PLANE_AXES[plane]
    radius = (chord / 2.0) * factor
    text = f"G91 G{plane} G{code} F100 {word(i, along)} {word(j, across)} R{'-' if long else ''}{radius:.9f}"
    (arc,) = motions(run(text + "\nM30"))
    assert isinstance(arc, ArcMotion)
    start, end = radii(arc)
    assert math.isclose(start, end, rel_tol=1e-9)
    assert math.isclose(start, radius, rel_tol=1e-6)
    assert (abs(arc.sweep_rad) >= math.pi - 1e-6) if long else (abs(arc.sweep_rad) <= math.pi + 1e-6)
    assert arc.sweep_rad * (1 if code == 3 else -1) > 0


@given(st.randoms(use_true_random=False))
def test_blanks_case_zeros_and_comments_do_not_matter(source: random.Random) -> None:
    def rewritten(character: str) -> str:
        if character == " ":
            return source.choice(["", " ", "   ", "\t", " (c) "])
        if character.isalpha():
            return source.choice(["", " "]) + source.choice([character.lower(), character]) + source.choice(["", " "])
        return character + source.choice(["", "", " "])

    lines = PROGRAM.splitlines()
    changed = [line if line.startswith(("%", "O")) else "".join(map(rewritten, line)) for line in lines]
    assert without_places(run("\n".join(changed))) == without_places(run(PROGRAM))


@given(st.lists(st.tuples(LENGTH, LENGTH, LENGTH), min_size=1, max_size=12))
def test_inch_and_incremental_rewrites_make_the_same_motions(points: list[Point]) -> None:
    absolute = "\n".join(f"X{x:.4f} Y{y:.4f} Z{z:.4f}" for x, y, z in points)
    inch = "\n".join(f"X{x / 25.4:.12f} Y{y / 25.4:.12f} Z{z / 25.4:.12f}" for x, y, z in points)
    path = [(0.0, 0.0, 0.0), *points]
    steps = "\n".join(f"X{q[0] - p[0]:.4f} Y{q[1] - p[1]:.4f} Z{q[2] - p[2]:.4f}" for p, q in pairwise(path))
    head = "G90 G0 X0 Y0 Z0\nG1 F254\n"
    texts = [head + absolute, "G20 G90 G0 X0 Y0 Z0\nG1 F10\n" + inch, head + "G91\n" + steps]
    first, *others = [motions(run(text)) for text in texts]
    for other in others:
        assert len(other) == len(first)
        for a, b in zip(first, other, strict=True):
            assert math.dist(a.end_mm, b.end_mm) < 1e-6
            assert math.isclose(a.feed_mm_min, b.feed_mm_min, rel_tol=1e-12)


def test_each_motion_starts_where_the_last_ended() -> None:
    """Counted at the gauge point, which a change of the length offset leaves where it is."""
    moved = motions(run(PROGRAM))
    assert len(moved) == 10
    for before, after in pairwise(moved):
        gauge = [m[2] + s.length_offset_mm for m, s in ((before.end_mm, before.state), (after.start_mm, after.state))]
        assert before.end_mm[:2] == after.start_mm[:2]
        assert math.isclose(gauge[0], gauge[1], abs_tol=1e-9)


GROUPS = (0, 1, 2, 3, 4, 17, 18, 19, 20, 28, 43, 53, 90, 91)
BITS = st.sampled_from(
    [*(f"G{n}" for n in GROUPS), "M6", "M30", *"XYZIJKRFSTHPNOM", *"0123456789.-+", *"()/;%#[] \t\x00\r\nÄ"]
)


@given(st.lists(BITS, max_size=60).map("".join), st.sampled_from(sorted(DIALECTS)))
@settings(max_examples=300)
def test_rubbish_is_refused_and_nothing_else(text: str, dialect: str) -> None:
    """Only `GcodeError` ever comes out, `check` finds the first of them too, and places are in the text."""
    control, errors = DIALECTS[dialect], check(text, dialect=DIALECTS[dialect])
    try:
        events = list(interpret(text, dialect=control))
    except GcodeError as error:
        assert str(errors[0]) == str(error)
    else:
        assert errors == []
        assert all(math.isfinite(x) for m in motions(events) for x in (*m.start_mm, *m.end_mm))
    lines = text.split("\n")
    for error in errors:
        assert 1 <= error.place.column <= len(lines[error.place.line - 1]) + 1


@given(st.binary(max_size=200))
def test_random_bytes(data: bytes) -> None:
    for error in check(data.decode("latin-1")):
        assert error.underlined()


def test_memory_does_not_grow_with_the_program() -> None:
    """Lines are made, interpreted and dropped: the events of 9,000 lines would be some megabytes."""
    stream = interpret(f"G1 X{n % 7}. F100." for n in range(10_000))
    for _ in zip(range(1000), stream, strict=False):
        pass
    tracemalloc.start()
    try:
        blocks = sum(isinstance(event, Block) for event in stream)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert blocks > 9000
    assert peak < 500_000
