"""Random programs against LinuxCNC's own interpreter, where its stand-alone program ``rs274`` is installed.

``apt-get install --no-install-recommends linuxcnc-uspace`` brings it. It prints canonical calls with four decimals of
the program's unit, in program coordinates; here they are brought to machine coordinates of the controlled point.
"""

from __future__ import annotations

import math
import random
import re
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

import pytest

from gcode.dialects import LINUXCNC
from gcode.errors import GcodeError
from gcode.events import PLANE_AXES, ArcMotion, LinearMotion, Point
from gcode.interpret import interpret
from gcode.settings import MachineSettings

RS274 = shutil.which("rs274")
pytestmark = pytest.mark.skipif(RS274 is None, reason="rs274 is not installed")

TOLERANCE_MM = 0.003
#: The stand-alone interpreter is an inch machine: its tables are in inches, and written here as such.
OFFSETS_IN: dict[str, Point] = {"G54": (1.0, -2.0, 0.5), "G55": (4.0, 3.0, -1.0)}
HOME_IN: Point = (0.25, 0.5, 6.0)
LENGTHS_IN = {1: 2.0, 2: 3.5}
PARAMETERS = {"G54": 5221, "G55": 5241}
PLANE_OF_NAME = {"XY": (0, 1, 2, 17), "XZ": (2, 0, 1, 18), "YZ": (1, 2, 0, 19)}


class Move(NamedTuple):
    kind: str
    end: Point
    plane: int = 0
    centre: Point = (0.0, 0.0, 0.0)
    turns: int = 0


def scaled(point: Point) -> Point:
    x, y, z = point
    return (x * 25.4, y * 25.4, z * 25.4)


SETTINGS = MachineSettings(
    offsets={name: scaled(offset) for name, offset in OFFSETS_IN.items()},
    home_mm=scaled(HOME_IN),
    length_offsets_mm={number: length * 25.4 for number, length in LENGTHS_IN.items()},
)


def ours(text: str) -> list[Move]:
    moves: list[Move] = []
    for event in interpret(text, dialect=LINUXCNC, settings=SETTINGS):
        if isinstance(event, LinearMotion):
            moves.append(Move("rapid" if event.rapid else "feed", event.end_mm))
        elif isinstance(event, ArcMotion):
            centre = list(event.centre_mm)
            centre[PLANE_AXES[event.plane][2]] = 0.0
            moves.append(Move("arc", event.end_mm, event.plane, tuple(centre), event.turns))
    return moves


def canonical_calls(text: str, folder: Path) -> str:
    (folder / "p.ngc").write_text(text)
    (folder / "t.tbl").write_text("".join(f"T{n} P{n} Z{z} D0.25\n" for n, z in LENGTHS_IN.items()))
    tables = [(5161, HOME_IN), *((PARAMETERS[name], offset) for name, offset in OFFSETS_IN.items())]
    rows = sorted((first + axis, value) for first, point in tables for axis, value in enumerate(point))
    required = {5220: 1.0, **dict(rows)}
    (folder / "p.var").write_text("".join(f"{number}\t{value}\n" for number, value in sorted(required.items())))
    command = [str(RS274), "-g", "-t", "t.tbl", "-v", "p.var", "p.ngc"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=60)
    return done.stdout + done.stderr


def theirs(output: str) -> list[Move]:
    """The moves of a canonical listing, in machine coordinates, mm, without those to where the tool is."""
    unit, plane = 1.0, PLANE_OF_NAME["XY"]
    offset, length, at = (0.0, 0.0, 0.0), 0.0, (0.0, 0.0, 0.0)
    moves: list[Move] = []
    for name, inside in re.findall(r"N\S*\s+(\w+)\(([^)]*)\)", output):
        numbers = [float(n) for n in re.findall(r"-?\d+\.\d+|-?\d+", inside)]
        if name == "USE_LENGTH_UNITS":
            unit = 25.4 if "INCH" in inside else 1.0
        elif name == "SET_G5X_OFFSET":
            offset = tuple(n * unit for n in numbers[1:4])
        elif name == "USE_TOOL_LENGTH_OFFSET":
            at = (at[0], at[1], at[2] + length - numbers[2] * unit)
            length = numbers[2] * unit
        elif name == "SELECT_PLANE":
            plane = PLANE_OF_NAME[inside[-2:]]
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            end = tuple(n * unit + o for n, o in zip(numbers[:3], offset, strict=True))
            if math.dist(at, end) > TOLERANCE_MM:
                moves.append(Move("rapid" if name.endswith("TRAVERSE") else "feed", end))
            at = end
        elif name == "ARC_FEED":
            moves.append(arc_of(numbers, unit, plane, offset))
            at = moves[-1].end
    return moves


def arc_of(numbers: list[float], unit: float, plane: tuple[int, int, int, int], offset: Point) -> Move:
    """An arc; along the plane's normal, where the listing says nothing of a centre, it gets 0."""
    i, j, k, code = plane
    end, centre = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
    end[i], end[j] = numbers[0] * unit + offset[i], numbers[1] * unit + offset[j]
    centre[i], centre[j] = numbers[2] * unit + offset[i], numbers[3] * unit + offset[j]
    end[k] = numbers[5] * unit + offset[k]
    return Move("arc", tuple(end), code, tuple(centre), int(numbers[4]))


def random_program(source: random.Random) -> str:
    lines = ["G21 G90 G17 G54", "F100", "T1 M6", "G0 X3 Y4 Z5"]
    unit = 1.0
    for _ in range(60):
        line, unit = random_block(source, unit)
        lines.append(line)
    return "\n".join([*lines, "M2", ""])


def random_block(source: random.Random, unit: float) -> tuple[str, float]:
    """A block or two that are right whatever comes before, and the unit after."""

    def length(limit: float = 80.0) -> str:
        return f"{source.uniform(-limit, limit) / unit:.4f}"

    kind = source.choice(["line", "line", "line", "arc", "arc", "radius", "set", "machine", "reference"])
    if kind == "line":
        axes = "".join(f" {a}{length()}" for a in "XYZ" if source.random() < 0.7) or " X0"
        return f"{source.choice(['G90', 'G91'])} {source.choice(['G0', 'G1', 'G1'])}{axes}", unit
    if kind in ("arc", "radius"):
        return random_arc(source, unit, by_radius=kind == "radius"), unit
    if kind == "machine":
        return f"G90 G0 G53 Z{length()}", unit
    if kind == "reference":
        return f"{source.choice(['G90', 'G91'])} G28 {source.choice('XYZ')}{length(5.0)}", unit
    # rs274 keeps the number of a length offset over a change of units, so that 2 inch become 2 mm: never both at once
    code = source.choice(["G49\nG20", "G49\nG21", "G54", "G55", "G43 H1", "G43 H2", "G43", "G49"])
    return code, {"G49\nG20": 25.4, "G49\nG21": 1.0}.get(code, unit)


def random_arc(source: random.Random, unit: float, *, by_radius: bool) -> str:
    letters, centres, third, plane = source.choice(
        [("XY", "IJ", "Z", "G17"), ("ZX", "KI", "Y", "G18"), ("YZ", "JK", "X", "G19")]
    )
    radius, at, swept = source.uniform(1.0, 60.0) / unit, source.uniform(0.0, 6.28), source.uniform(0.2, 6.0)
    u, v = -radius * math.cos(at), -radius * math.sin(at)
    du, dv = u + radius * math.cos(at + swept), v + radius * math.sin(at + swept)
    words = f"{letters[0]}{du:.6f} {letters[1]}{dv:.6f}"
    words += f" {third}{source.uniform(-5.0, 5.0) / unit:.4f}" if source.random() < 0.5 else ""
    long = "-" if swept > math.pi else ""
    centre = f"R{long}{radius:.6f}" if by_radius else f"{centres[0]}{u:.6f} {centres[1]}{v:.6f}"
    return f"G91 {plane} G3 {words} {centre}"


@pytest.mark.parametrize("seed", range(20))
def test_random_programs(seed: int, tmp_path: Path) -> None:
    text = random_program(random.Random(seed))
    expected = theirs(canonical_calls(text, tmp_path))
    moves = ours(text)
    assert len(moves) == len(expected)
    for number, (move, wanted) in enumerate(zip(moves, expected, strict=True)):
        assert (move.kind, move.plane, move.turns) == (wanted.kind, wanted.plane, wanted.turns), number
        assert math.dist(move.end, wanted.end) < TOLERANCE_MM, (number, move, wanted)
        assert math.dist(move.centre, wanted.centre) < TOLERANCE_MM, (number, move, wanted)


@pytest.mark.parametrize(
    "text",
    [
        "G1 X1",
        "X1",
        "F1 G2 X1",
        "F1 G2 X1 R5 I1",
        "F1 G2 X1 I.5 K1",
        "F1 G2 X5 Y0 R1",
        "F1 G2 X50 Y0 I24.9857",
        "F1 G90.1 G2 X1 I.5",
        "F1 G2 R5",
        "G0 G1 X1",
        "G0 X1 X2",
        "G0 X1 P5",
        "G0 X1 H1",
        "G0 X1 Q5",
        "G91 G0 G53 X1",
        "F1 G2 X2 Y0 I1 J2\nG53 X1",
        "G0 G28 X1",
        "G43 H9",
        "G4",
        "G4 P-1",
        "F-1",
        "S-1",
        "T-1",
        "T1.5",
        "G777",
        "M400",
        "G0 X1 (open",
        "G0 X1.2.3",
        "G0 X",
        "G0 X1 *",
    ],
)
def test_what_they_refuse_is_refused(text: str, tmp_path: Path) -> None:
    assert "PROGRAM_END" not in canonical_calls(f"G21\n{text}\nM2\n", tmp_path)
    with pytest.raises(GcodeError):
        ours(f"G21\n{text}\nM2\n")
