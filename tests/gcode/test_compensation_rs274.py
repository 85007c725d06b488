"""LinuxCNC's own interpreter (``rs274``, where it is installed) as the oracle for its cutter compensation."""

from __future__ import annotations

import cmath
import itertools
import json
import math
import random
import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest
from support.reference import GCODE

from gcode import compensation
from gcode.errors import GcodeError, Place
from gcode.events import PLANE_AXES, ArcMotion, Event, LinearMotion, Motion, MotionState, Plane, Point

RS274 = shutil.which("rs274")
needs_rs274 = pytest.mark.skipif(RS274 is None, reason="rs274 is not installed")

TOLERANCE_MM = 0.003
NAMES: dict[int, str] = {17: "XYZIJ", 18: "ZXYKI"}


def point_of(plane: Plane, flat: complex, height: float) -> Point:
    first, second, normal = PLANE_AXES[plane]
    point = [0.0, 0.0, 0.0]
    point[first], point[second], point[normal] = flat.real, flat.imag, height
    return (point[0], point[1], point[2])


def rounded(value: complex) -> complex:
    return complex(round(value.real, 6), round(value.imag, 6))


class Program:
    """A random path as text and as motions."""

    def __init__(self, source: random.Random, plane: Plane, side: str, radius: float) -> None:
        self.source, self.plane = source, plane
        self.at, self.height = 0j, 5.0
        self.heading = source.uniform(-math.pi, math.pi)
        self.motions: list[Motion] = []
        code = {"left": "G41.1", "right": "G42.1"}[side]
        self.lines = [
            "G21 G90 G40",
            f"G{plane} F100 G0 {self.words(self.at, self.height)}",
            f"{code} D{2 * radius:.6f}",
        ]

    def words(self, flat: complex, height: float) -> str:
        names = NAMES[self.plane]
        return f"{names[0]}{flat.real:.6f} {names[1]}{flat.imag:.6f} {names[2]}{height:.6f}"

    @property
    def text(self) -> str:
        """The program, its compensation ended."""
        return "\n".join([*self.lines, "G40", ""])

    def keys(self, code: str) -> dict[str, object]:
        place = Place(file="p.ngc", line=len(self.lines) + 1, text=code)
        return {"place": place, "state": MotionState(plane=self.plane)}

    def line(self, length: float, heading: float, *, rapid: bool, height: float) -> None:
        end = rounded(self.at + cmath.rect(length, heading))
        start = point_of(self.plane, self.at, self.height)
        feed = 0.0 if rapid else 100.0
        self.motions.append(
            LinearMotion(
                **self.keys("line"),
                start_mm=start,
                end_mm=point_of(self.plane, end, height),
                rapid=rapid,
                feed_mm_min=feed,
            )
        )
        self.lines.append(f"G{0 if rapid else 1} {self.words(end, height)}")
        self.heading = cmath.phase(end - self.at) if end != self.at else self.heading
        self.at, self.height = end, height

    def arc(self, radius: float, heading: float, sweep: float, *, height: float) -> None:
        turns = 1 if sweep > 0.0 else -1
        centre = rounded(self.at + cmath.rect(radius, heading + turns * math.pi / 2.0))
        end = rounded(centre + (self.at - centre) * cmath.exp(1j * sweep))
        self.motions.append(
            ArcMotion(
                **self.keys("arc"),
                start_mm=point_of(self.plane, self.at, self.height),
                end_mm=point_of(self.plane, end, height),
                centre_mm=point_of(self.plane, centre, self.height),
                plane=self.plane,
                turns=turns,
                feed_mm_min=100.0,
            )
        )
        names, offset = NAMES[self.plane], centre - self.at
        words = f"{names[3]}{offset.real:.6f} {names[4]}{offset.imag:.6f}"
        self.lines.append(f"G{3 if turns > 0 else 2} {self.words(end, height)} {words}")
        self.heading = heading + sweep
        self.at, self.height = end, height

    def step(self) -> None:
        source = self.source
        turn = source.choice((0.0, source.uniform(-3.0, 3.0), source.uniform(-1.2, 1.2)))
        height = self.height if source.random() < 0.8 else round(source.uniform(0.0, 5.0), 3)
        kind = source.random()
        if kind < 0.1:
            self.line(0.0, 0.0, rapid=False, height=height)
        elif kind < 0.6:
            self.line(source.uniform(4.0, 30.0), self.heading + turn, rapid=source.random() < 0.15, height=height)
        else:
            sweep = source.choice((-1.0, 1.0)) * source.uniform(0.3, 5.5)
            self.arc(source.uniform(2.0, 15.0), self.heading + turn, sweep, height=height)


def program(seed: int) -> tuple[Program, str, float]:
    source = random.Random(seed)
    plane: Plane = 17 if source.random() < 0.6 else 18
    side, radius = source.choice(("left", "right")), round(source.uniform(0.5, 3.0), 3)
    made = Program(source, plane, side, radius)
    if source.random() < 0.7:
        made.line(source.uniform(radius + 1.0, 20.0), made.heading, rapid=False, height=2.0)
    else:
        made.step()
    for _ in range(source.randint(2, 5)):
        made.step()
    return made, side, radius


Made = tuple[str, Point, Point, int]


def made_of(events: tuple[Event, ...]) -> list[Made]:
    """The motions that go anywhere: kind, end, centre (0 along the normal), turns."""
    made: list[Made] = []
    for event in events:
        if isinstance(event, ArcMotion):
            centre = list(event.centre_mm)
            centre[PLANE_AXES[event.plane][2]] = 0.0
            made.append(("arc", event.end_mm, (centre[0], centre[1], centre[2]), event.turns))
        elif isinstance(event, LinearMotion) and math.dist(event.start_mm, event.end_mm) > 1e-3:
            made.append(("rapid" if event.rapid else "feed", event.end_mm, (0.0, 0.0, 0.0), 0))
    return made


def ours(motions: list[Motion], side: str, radius: float) -> list[Made] | GcodeError:
    first = motions[0]
    events: list[Event] = []
    comp = compensation.begin("linuxcnc", side, radius, first.state.plane, first.start_mm, place=first.place)
    try:
        for motion in motions:
            comp, more = compensation.move(comp, motion)
            events.extend(more)
        events.extend(compensation.end(comp)[0])
    except GcodeError as error:
        return error
    for before, after in itertools.pairwise(events):
        assert math.dist(before.end_mm, after.start_mm) < 1e-9
    return made_of(tuple(events))


def theirs(texts: Sequence[str], planes: Sequence[Plane], folder: Path) -> list[list[Made]] | str:
    """What the interpreter makes of programs one after the other in one process, or why it refuses one."""
    (folder / "p.ngc").write_text("".join(f"(NEXT)\n{text}" for text in texts) + "M2\n")
    (folder / "t.tbl").write_text("T1 P1 Z0 D0.25\n")
    (folder / "p.var").write_text("5220\t1.0\n5221\t0\n")
    command = [str(RS274), "-g", "-t", "t.tbl", "-v", "p.var", "p.ngc"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=60)
    said = (done.stdout + done.stderr).strip().splitlines()
    if done.returncode != 0:
        return " / ".join(said[-3:])
    _, *listings = done.stdout.split('COMMENT("NEXT")')
    return [canonical(listing, plane)[1:] for listing, plane in zip(listings, planes, strict=True)]


def canonical(output: str, plane: Plane) -> list[Made]:
    made: list[Made] = []
    at: Point = (math.inf, 0.0, 0.0)
    for name, inside in re.findall(r"N\S*\s+(\w+)\(([^)]*)\)", output):
        numbers = [float(n) for n in re.findall(r"-?\d+\.\d+|-?\d+", inside)]
        if name == "ARC_FEED":
            end = point_of(plane, complex(*numbers[:2]), numbers[5])
            made.append(("arc", end, point_of(plane, complex(*numbers[2:4]), 0.0), int(numbers[4])))
            at = end
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            end = (numbers[0], numbers[1], numbers[2])
            if math.dist(at, end) > 1e-3:
                made.append(("rapid" if name.endswith("TRAVERSE") else "feed", end, (0.0, 0.0, 0.0), 0))
            at = end
    return made


def assert_same(mine: list[Made], other: list[Made]) -> None:
    assert [(m[0], m[3]) for m in mine] == [(m[0], m[3]) for m in other]
    for (_, end, centre, _), (_, their_end, their_centre, _) in zip(mine, other, strict=True):
        assert math.dist(end, their_end) < TOLERANCE_MM
        assert math.dist(centre, their_centre) < TOLERANCE_MM


@needs_rs274
@pytest.mark.parametrize("batch", range(8))
def test_random_paths_come_out_as_from_the_interpreter_itself(batch: int, tmp_path: Path) -> None:
    accepted: list[tuple[Program, list[Made]]] = []
    refused = 0
    for seed in range(batch * 20, batch * 20 + 20):
        made, side, radius = program(seed)
        mine = ours(made.motions, side, radius)
        if isinstance(mine, GcodeError):
            refused += 1
            assert isinstance(theirs([made.text], [made.plane], tmp_path), str), f"seed {seed}: {mine}"
        else:
            accepted.append((made, mine))
    others = theirs([made.text for made, _ in accepted], [made.plane for made, _ in accepted], tmp_path)
    assert not isinstance(others, str), others
    for (_, mine), other in zip(accepted, others, strict=True):
        assert_same(mine, other)
    assert accepted and refused


def event_of(row: dict[str, object], start: Point) -> Motion:
    """A motion of a list of expected motions."""
    end: Point = tuple(row["end"])  # type: ignore[assignment, arg-type]
    keys = {"place": Place(file="test.ngc", line=1), "state": MotionState(), "start_mm": start, "end_mm": end}
    if row["t"] == "arc":
        return ArcMotion(**keys, centre_mm=tuple(row["centre"]), plane=17, turns=row["rot"], feed_mm_min=60.0)
    return LinearMotion(**keys, rapid=row["t"] == "rapid", feed_mm_min=60.0)


@pytest.mark.skipif(not GCODE.is_dir(), reason="TWIN_REFERENCE_DIR does not hold it")
def test_entry_by_a_line_and_an_arc_of_the_reference_program() -> None:
    folder = GCODE / "ccomp__mill-line-arc-entry"
    rows = json.loads((folder / "expected_motions.json").read_text())
    half = len(rows) // 2
    start: Point = tuple(rows[0]["end"])
    motions: list[Motion] = []
    for row in rows[1:half]:
        motions.append(event_of(row, motions[-1].end_mm if motions else start))
    mine = ours(motions, "left", 12.7)
    assert not isinstance(mine, GcodeError)
    expected = made_of(tuple(event_of(row, start) for row in rows[half + 1 :]))
    assert_same(mine, expected)
