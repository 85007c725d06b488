"""Programs like those that CAM systems write, for `benchmarks.real`: each with the job that replays it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

CUTTING = {"Ktc": 935.62, "Kte": 2.0218, "Krc": 416.73, "Kre": 1.8238, "Kac": 2.72e-05, "Kae": 3.32e-06}
_Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A program and its job.

    Attributes:
        blocks: makes the NC blocks after the spindle has started, the rapid to the start included.
        tool: shape and teeth, as in a job file.
        box_mm: lower and upper corner of the stock.
        fineness: slices, steps and edge elements, mm, and the step of the spindle angle, degrees.
        seconds: of machine time that are replayed by default, counted from the first cut.
    """

    blocks: Callable[[], Iterator[str]]
    tool: dict[str, Any]
    rpm: float
    box_mm: tuple[_Point, _Point]
    fineness: tuple[float, float] = (0.2, 2.0)
    seconds: float = 30.0
    forces: bool = True
    archive: bool = False

    def job(self, program: str) -> dict[str, Any]:
        """The job file's content, for a program file of this name."""
        mm, degrees = self.fineness
        tool = {"number": 1, "teeth": 2, "helix_deg": 30.0, "flute_length_mm": 40.0, "length_mm": 110.0, **self.tool}
        return {
            "program": {"file": program},
            "stock": {"box_mm": {"min": list(self.box_mm[0]), "max": list(self.box_mm[1])}},
            "tools": [tool],
            "simulation": {"slice_pitch_mm": mm, "step_mm": mm, "axial_step_mm": mm, "angle_step_deg": degrees},
            **({"cutting": {**CUTTING, "source": "of no material"}} if self.forces else {}),
        }

    def text(self) -> str:
        """The program."""
        return "\n".join(("G21 G90 G94 G17", "T1 M6", f"S{self.rpm:g} M3", *self.blocks(), "G0 Z50", "M30", ""))


def _scan(
    height: Callable[[float, float], float], size: tuple[float, float], over: float, along: float, feed: float
) -> Iterator[str]:
    """Parallel passes along y over a surface, in a zigzag."""
    rows = np.arange(0.0, size[0] + 1e-9, over).tolist()
    points = np.arange(0.0, size[1] + 1e-9, along).tolist()
    yield f"G0 X0 Y0\nG43 H1 Z5\nG1 Z{height(0.0, 0.0):.4f} F{feed:g}"
    for number, x in enumerate(rows):
        for y in points[:: -1 if number % 2 else 1]:
            yield f"X{x:.4f} Y{y:.4f} Z{height(x, y):.4f}"


def _deep_walls(x: float, y: float) -> float:
    """Ribs with walls of about 75 degrees, 13 mm deep."""
    wave = math.sin(2.0 * math.pi * y / 19.0 + 0.3 * math.sin(x / 6.0))
    return -7.0 + 6.7 * math.tanh(2.2 * wave)


def _bowl(x: float, y: float) -> float:
    return -8.0 - 5.0 * math.sin(x / 17.0) * math.cos(y / 14.0)


def _waves(x: float, y: float) -> float:
    return -6.0 + 4.0 * math.cos(math.hypot(x - 50.0, y - 50.0) / 6.0)


def _relief(x: float, y: float) -> float:
    return -1.5 - 1.2 * math.sin(x / 4.0) * math.cos(y / 3.0)


def _spiral() -> Iterator[str]:
    yield "G0 X34 Y15\nG43 H1 Z5\nG1 Z-1 F2000"
    for i in range(100_000):
        r, a = 4.0 + i * 1e-4, 0.01 * i
        yield f"X{30.0 + r * math.cos(a):.3f} Y{15.0 + r * math.sin(a):.3f}"


def _tight_helix() -> Iterator[str]:
    yield "G0 X30.5 Y15\nG43 H1 Z1\nG1 Z0 F1000"
    for i in range(1000):
        yield f"G3 X30.5 Y15 I-0.5 J0 Z{-0.002 * (i + 1):.4f}"


def _adaptive() -> Iterator[str]:
    """Loops of arcs that go forward by 0.8 mm each, in rows; every loop returns 0.3 mm higher."""
    for row in range(6):
        y = 8.0 + 13.0 * row
        yield f"G0 Z5\nG0 X-8 Y{y:.3f}\nG43 H1 Z-8"
        for i in range(120):
            x = -8.0 + 0.8 * i
            yield f"G1 X{x:.3f} Y{y:.3f} F3000\nG3 X{x:.3f} Y{y + 6.0:.3f} I0 J3"
            yield f"G1 Z-7.7\nG3 X{x + 0.8:.3f} Y{y:.3f} I0.4 J-3 F6000\nG1 Z-8"


def _pocket() -> Iterator[str]:
    """A rectangular pocket of three levels, offset passes from the middle outwards with rounded corners."""
    yield "G0 X50 Y40\nG43 H1 Z5"
    for z in (-2.0, -4.0, -6.0):
        yield "G0 X50 Y40\nG1 Z0.5 F3000"
        for turn in range(4):
            yield f"G3 X50 Y40 I2 J0 Z{z + 2.0 - 0.5 * (turn + 1):.3f} F1500"
        for ring in range(1, 8):
            r = min(2.0, 0.5 * ring)
            x, y = 10.0 + 4.0 * ring, 4.0 * ring
            yield f"G1 X{50 + x:.3f} Y40 F3000"
            for corner, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
                cx, cy = 50 + sx * (x - r), 40 + sy * (y - r)
                ends = [(cx + sx * r, cy), (cx, cy + sy * r)][:: 1 if corner % 2 == 0 else -1]
                (ax, ay), (bx, by) = ends
                yield f"G1 X{ax:.3f} Y{ay:.3f}\nG3 X{bx:.3f} Y{by:.3f} I{cx - ax:.3f} J{cy - ay:.3f}"
            yield f"G1 X{50 + x:.3f} Y40"
        yield "G0 Z5"


def _slot(feed: float) -> Iterator[str]:
    yield f"G0 X-6 Y15\nG43 H1 Z5\nZ-2\nG1 X400 F{feed:g}"


CASES: dict[str, Case] = {
    "parallel, deep walls": Case(
        blocks=lambda: _scan(_deep_walls, (40.0, 40.0), 0.32, 0.8, 1016.0),
        tool={"kind": "ball", "diameter_mm": 3.175},
        rpm=5000,
        box_mm=((-2.0, -2.0, -17.0), (42.0, 42.0, 0.0)),
        fineness=(0.1, 1.0),
        archive=True,
    ),
    "parallel finishing, lines of 1.5 mm": Case(
        blocks=lambda: _scan(_bowl, (100.0, 90.0), 1.5, 1.5, 2500.0),
        tool={"kind": "ball", "diameter_mm": 19.0},
        rpm=6000,
        box_mm=((0.0, 0.0, -30.0), (100.0, 90.0, -2.5)),
    ),
    "waves, lines of 0.5 mm": Case(
        blocks=lambda: _scan(_waves, (100.0, 100.0), 1.0, 0.5, 900.0),
        tool={"kind": "ball", "diameter_mm": 10.0},
        rpm=6000,
        box_mm=((0.0, 0.0, -50.0), (100.0, 100.0, 0.0)),
    ),
    "relief at 5000 mm/min, lines of 0.1 mm": Case(
        blocks=lambda: _scan(_relief, (60.0, 60.0), 0.25, 0.1, 5000.0),
        tool={"kind": "ball", "diameter_mm": 6.0},
        rpm=12000,
        box_mm=((0.0, 0.0, -10.0), (60.0, 60.0, 0.0)),
        seconds=5.0,
    ),
    "adaptive clearing with arcs": Case(
        blocks=_adaptive,
        tool={"kind": "bull", "diameter_mm": 10.0, "corner_radius_mm": 0.5, "teeth": 4},
        rpm=8000,
        box_mm=((0.0, 0.0, -20.0), (90.0, 90.0, 0.0)),
        seconds=10.0,
    ),
    "pocket, flat D10": Case(
        blocks=_pocket,
        tool={"kind": "flat", "diameter_mm": 10.0, "teeth": 3},
        rpm=12000,
        box_mm=((0.0, 0.0, -20.0), (100.0, 80.0, 0.0)),
        seconds=20.0,
    ),
    "spiral, motions of 0.04 mm": Case(
        blocks=_spiral,
        tool={"kind": "ball", "diameter_mm": 8.0},
        rpm=3600,
        box_mm=((0.0, 0.0, -20.0), (60.0, 30.0, 0.0)),
        fineness=(0.1, 1.0),
        seconds=3.0,
        forces=False,
    ),
    "helix R0.5, 0.002 mm a turn": Case(
        blocks=_tight_helix,
        tool={"kind": "flat", "diameter_mm": 10.0},
        rpm=3600,
        box_mm=((0.0, 0.0, -20.0), (60.0, 30.0, 0.0)),
        seconds=20.0,
        forces=False,
    ),
    "slot, 200 mm/min": Case(
        blocks=lambda: _slot(200.0),
        tool={"kind": "ball", "diameter_mm": 8.0},
        rpm=3600,
        box_mm=((0.0, 0.0, -20.0), (400.0, 30.0, 0.0)),
        fineness=(0.1, 1.0),
        seconds=60.0,
    ),
    "slot, 2000 mm/min": Case(
        blocks=lambda: _slot(2000.0),
        tool={"kind": "ball", "diameter_mm": 8.0},
        rpm=3600,
        box_mm=((0.0, 0.0, -20.0), (400.0, 30.0, 0.0)),
        fineness=(0.1, 1.0),
        seconds=10.0,
    ),
}
