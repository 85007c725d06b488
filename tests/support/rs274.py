"""LinuxCNC's stand-alone interpreter ``rs274``: running it, and reading its canonical calls as motions.

``apt-get install --no-install-recommends linuxcnc-uspace`` brings it. It prints every canonical call with four decimals
of the program's unit, in program coordinates. A point of a call becomes the controlled point in machine coordinates by
adding the G92 offset, turning about z by the rotation and adding the work offset; the tool's length offset is left out.

What is particular to the stand-alone program:

- it keeps its tool table in ``$HOME/.tool.mmap``, so that two runs at a time with one home spoil or crash each other;
  without a table it takes one of LinuxCNC's samples;
- its tables (``.tbl``, ``.var``) are in inches, while a program that names no unit is in millimetres;
- it keeps the number of an active length offset over G20 and G21, so that 2 inch become 2 mm (a real machine does not);
- ``CHANGE_TOOL`` names the row of the tool, ``SELECT_TOOL`` its number; ``CHANGE_TOOL_NUMBER`` (M61) names the row too;
- G33 is a feed between two calls that tie it to the spindle; a rigid tapping is one call with its bottom;
- of a spline it prints nothing but that there is one, of a probing motion only where it would end;
- ``G93`` is printed as the speed that it comes to.
"""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, TypeAlias

Point: TypeAlias = tuple[float, float, float]
Kind: TypeAlias = Literal["rapid", "feed", "arc", "tap", "dwell", "spline", "probe"]

RS274 = shutil.which("rs274")
MM_PER_INCH = 25.4
ORIGIN: Point = (0.0, 0.0, 0.0)
#: Coordinate indices (first, second, normal) of the planes, by G code.
AXES: Mapping[int, tuple[int, int, int]] = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
PLANE_OF_NAME: Mapping[str, int] = {"XY": 17, "XZ": 18, "YZ": 19}
#: What the last decimal printed may be off by, in the program's unit, and how many such numbers make one point.
DECIMALS, TERMS = 0.00005, 3 * math.sqrt(3.0)
TURNING: Mapping[str, int] = {
    "START_SPINDLE_CLOCKWISE": 1,
    "START_SPINDLE_COUNTERCLOCKWISE": -1,
    "STOP_SPINDLE_TURNING": 0,
}
CALL = re.compile(r"^\s*\d+ N(?:\.+|\d*) *([A-Z][A-Z0-9_]+)\((.*)\)\s*$", re.MULTILINE)
NUMBER = re.compile(r"-?(?:\d+\.?\d*(?:e[-+]?\d+)?|nan|inf)")


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """One motion or dwell, whoever made it.

    Attributes:
        kind: a ``spline`` has no known end.
        end: controlled point in machine coordinates at the end, mm.
        abc: positions of the axes A, B, C at the end, degrees.
        feed: mm/min, or mm per revolution with ``per_revolution``; 0 for a rapid. While the feed follows the spindle
            (G33, tapping) what it comes to at the commanded speed, mm/min.
        seconds: length of a dwell.
        plane: 17, 18 or 19 for an arc, otherwise 0.
        centre: of an arc; its coordinate along the plane's normal is 0.
        turns: signed turns of an arc, counter-clockwise positive.
        tool: number of the tool in the spindle.
        rpm: commanded speed; None where the control holds the surface speed (G96), of which a listing says no speed.
        direction: +1, -1 or 0 of the spindle.
        rounding: how far a point may be off by the decimals of a listing, mm; 0 where there is none.
    """

    kind: Kind
    end: Point
    abc: Point = ORIGIN
    feed: float = 0.0
    per_revolution: bool = False
    seconds: float = 0.0
    plane: int = 0
    centre: Point = ORIGIN
    turns: int = 0
    tool: int = 0
    rpm: float | None = 0.0
    direction: int = 0
    rounding: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Listing:
    """What a run printed.

    Attributes:
        calls: canonical calls in order: name and the text between the brackets.
        error: what it refused the program for, empty where it ran through.
    """

    calls: tuple[tuple[str, str], ...]
    error: str

    @property
    def open_end(self) -> bool:
        """True where all that was refused is the program's end without M2, M30 or a percent sign."""
        return "File ended with no percent sign or program end" in self.error


def run(
    program: Path,
    *,
    table: Path | None = None,
    parameters: Path | None = None,
    search_path: Path | None = None,
    block_delete: bool = False,
    timeout_s: float = 60.0,
) -> Listing:
    """Runs a program file from its own folder, where subroutine files are looked for first.

    Args:
        program: the program's file, in a folder that may be written to.
        table: tool table.
        parameters: parameter file; it is written to.
        search_path: another folder of subroutine files.
        block_delete: whether lines that begin with a slash are left out.
        timeout_s: after which the run is given up.

    Raises:
        subprocess.TimeoutExpired: for a program that does not end.
        RuntimeError: for an interpreter that crashed.
    """
    command = [str(RS274), "-g", *(("-b",) if block_delete else ())]
    if table:
        command += ["-t", str(table.resolve())]
    if parameters:
        command += ["-v", str(parameters.resolve())]
    if search_path:
        settings = program.parent / "rs274.ini"
        settings.write_text(f"[RS274NGC]\nSUBROUTINE_PATH = {search_path.resolve()}\n")
        command += ["-i", settings.name]
    done = subprocess.run(
        [*command, program.name],
        cwd=program.parent,
        capture_output=True,
        check=False,
        timeout=timeout_s,
        stdin=subprocess.DEVNULL,
        env={**os.environ, "HOME": str(program.parent.resolve())},
    )
    if done.returncode < 0:
        raise RuntimeError(f"rs274 crashed with signal {-done.returncode} on {program}")
    calls = CALL.findall(done.stdout.decode(errors="replace"))
    error = done.stderr.decode(errors="replace").strip().replace("\n", " | ")
    return Listing(calls=tuple(calls), error=(error or "refused") if done.returncode else "")


def run_text(text: str, folder: Path, **options: Path | None) -> Listing:
    """Runs a program given as text, in `folder`."""
    program = folder / "program.ngc"
    program.write_text(text)
    return run(program, table=options.get("table"), parameters=options.get("parameters"))


@dataclass(slots=True)
class Reader:
    """The machine as the canonical calls describe it, and the moves so far."""

    rows: Sequence[int] = ()
    unit: float = 1.0
    work: Point = ORIGIN
    shift: Point = ORIGIN
    work_abc: Point = ORIGIN
    shift_abc: Point = ORIGIN
    angle: float = 0.0
    plane: int = 17
    feed: float = 0.0
    per_revolution: bool = False
    synchronised: float = 0.0
    selected: int = 0
    speed: float = 0.0
    surface: bool = False
    now: Move = field(default_factory=lambda: Move(kind="rapid", end=ORIGIN))
    moves: list[Move] = field(default_factory=list)

    def point(self, x: float, y: float, z: float) -> Point:
        """A point of a call in machine coordinates, mm."""
        dx, dy, dz = (value * self.unit + by for value, by in zip((x, y, z), self.shift, strict=True))
        cos, sin = math.cos(self.angle), math.sin(self.angle)
        return (dx * cos - dy * sin + self.work[0], dx * sin + dy * cos + self.work[1], dz + self.work[2])

    def angles(self, of: Sequence[float]) -> Point:
        """The axes A, B, C of a call in machine coordinates, degrees."""
        a, b, c = (sum(parts) for parts in zip(of, self.work_abc, self.shift_abc, strict=True))
        return (a, b, c)

    def read(self, name: str, inside: str) -> None:
        """Takes one canonical call; those without meaning for motion are passed over."""
        numbers = [float(n) for n in NUMBER.findall(inside)]
        if name in TURNING:
            if numbers[0] == 0:
                self.now = replace(self.now, direction=TURNING[name])
        elif name in MODES:
            MODES[name](self, inside, numbers)
        elif name in MOTIONS:
            self.add(MOTIONS[name](self, numbers))

    def add(self, move: Move) -> None:
        """Adds a move, with the feed that holds for it; tapping comes back to where it began."""
        if move.kind not in ("rapid", "dwell"):
            by_angle = self.synchronised * self.speed
            revolution = self.per_revolution and not by_angle
            move = replace(move, feed=by_angle or self.feed, per_revolution=revolution)
        self.moves.append(replace(move, rounding=DECIMALS * self.unit * TERMS))
        if move.kind not in ("dwell", "tap", "spline"):
            self.now = replace(self.now, end=move.end, abc=move.abc)

    def straight(self, kind: Kind, numbers: list[float]) -> Move:
        return replace(self.now, kind=kind, end=self.point(*numbers[:3]), abc=self.angles(numbers[3:6]))

    def arc(self, numbers: list[float]) -> Move:
        i, j, k = AXES[self.plane]
        end, centre = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        end[i], end[j], end[k] = numbers[0], numbers[1], numbers[5]
        centre[i], centre[j], centre[k] = numbers[2], numbers[3], numbers[5]
        middle = list(self.point(*centre))
        middle[k] = 0.0
        return replace(
            self.now,
            kind="arc",
            end=self.point(*end),
            abc=self.angles(numbers[6:9]),
            plane=self.plane,
            centre=(middle[0], middle[1], middle[2]),
            turns=int(numbers[4]),
        )

    def set_unit(self, inside: str, _: list[float]) -> None:
        self.unit = MM_PER_INCH if "INCH" in inside else 1.0

    def set_work(self, _: str, numbers: list[float]) -> None:
        x, y, z = (n * self.unit for n in numbers[1:4])
        self.work, self.work_abc = (x, y, z), (numbers[4], numbers[5], numbers[6])

    def set_shift(self, _: str, numbers: list[float]) -> None:
        x, y, z = (n * self.unit for n in numbers[:3])
        self.shift, self.shift_abc = (x, y, z), (numbers[3], numbers[4], numbers[5])

    def set_angle(self, _: str, numbers: list[float]) -> None:
        self.angle = math.radians(numbers[0])

    def set_plane(self, inside: str, _: list[float]) -> None:
        self.plane = PLANE_OF_NAME.get(inside[-2:], 17)

    def set_feed(self, _: str, numbers: list[float]) -> None:
        self.feed = numbers[0] * self.unit

    def synchronise(self, _: str, numbers: list[float]) -> None:
        self.synchronised = numbers[0] * self.unit

    def unsynchronise(self, *_: object) -> None:
        self.synchronised = 0.0

    def set_feed_mode(self, _: str, numbers: list[float]) -> None:
        self.per_revolution = numbers[-1] == 1

    def set_speed(self, _: str, numbers: list[float]) -> None:
        if numbers[0] == 0:
            self.speed = numbers[1]
            self.now = replace(self.now, rpm=None if self.surface else self.speed)

    def set_speed_mode(self, _: str, numbers: list[float]) -> None:
        if numbers[0] == 0:
            self.surface = numbers[1] > 0.0
            self.now = replace(self.now, rpm=None if self.surface else self.speed)

    def select_tool(self, _: str, numbers: list[float]) -> None:
        self.selected = int(numbers[0])

    def change_tool(self, *_: object) -> None:
        self.now = replace(self.now, tool=self.selected)

    def set_tool(self, _: str, numbers: list[float]) -> None:
        row = int(numbers[0])
        self.now = replace(self.now, tool=self.rows[row - 1] if 0 < row <= len(self.rows) else row)


MODES: Mapping[str, Callable[[Reader, str, list[float]], None]] = {
    "USE_LENGTH_UNITS": Reader.set_unit,
    "SET_G5X_OFFSET": Reader.set_work,
    "SET_G92_OFFSET": Reader.set_shift,
    "SET_XY_ROTATION": Reader.set_angle,
    "SELECT_PLANE": Reader.set_plane,
    "SET_FEED_RATE": Reader.set_feed,
    "SET_FEED_MODE": Reader.set_feed_mode,
    "START_SPEED_FEED_SYNC": Reader.synchronise,
    "STOP_SPEED_FEED_SYNCH": Reader.unsynchronise,
    "SET_SPINDLE_SPEED": Reader.set_speed,
    "SET_SPINDLE_MODE": Reader.set_speed_mode,
    "SELECT_TOOL": Reader.select_tool,
    "CHANGE_TOOL": Reader.change_tool,
    "CHANGE_TOOL_NUMBER": Reader.set_tool,
}

MOTIONS: Mapping[str, Callable[[Reader, list[float]], Move]] = {
    "STRAIGHT_TRAVERSE": lambda reader, numbers: reader.straight("rapid", numbers),
    "STRAIGHT_FEED": lambda reader, numbers: reader.straight("feed", numbers),
    "STRAIGHT_PROBE": lambda reader, numbers: reader.straight("probe", numbers),
    "ARC_FEED": Reader.arc,
    "RIGID_TAP": lambda reader, numbers: replace(reader.now, kind="tap", end=reader.point(*numbers[:3])),
    "DWELL": lambda reader, numbers: replace(reader.now, kind="dwell", seconds=numbers[0]),
    "NURBS_FEED": lambda reader, numbers: replace(reader.now, kind="spline"),
}


def moves_of(calls: Iterable[tuple[str, str]], rows: Sequence[int] = ()) -> list[Move]:
    """The motions and dwells of canonical calls, also those to where the tool is.

    Args:
        calls: name of each call and the text between its brackets.
        rows: tool numbers of the tool table in the order of its rows, which M61 needs.
    """
    reader = Reader(rows=rows)
    for name, inside in calls:
        reader.read(name, inside)
    return reader.moves


def rows_of(table: Path | None) -> list[int]:
    """Tool numbers of a tool table in the order of its rows."""
    if table is None:
        return []
    return [int(number) for number in re.findall(r"^[^;\n]*?\bT(\d+)", table.read_text(), re.MULTILINE | re.IGNORECASE)]
