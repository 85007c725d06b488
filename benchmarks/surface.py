"""Removal alone on a surface program of real size: prints one JSON object.

    python -m benchmarks.surface [--lines 100000]

A mold of 100 x 80 mm, finished with a ball of R3 in parallel passes 0.5 mm apart, straight motions of 0.15 mm: about
107,000 lines of G1, interpreted from text and subtracted from slices at 0.2 mm.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from benchmarks.report import report
from gcode.report.motion_arrays import motion_arrays
from twin.motion.sweep import Body, Sweep
from twin.tolerance import Tolerance
from twin.tools.shape import tool_shape
from twin.workpiece.removal import Removal
from twin.workpiece.stock import box_slices
from twin.workpiece.trislice import CellSlices

PITCH_MM = 0.2
#: Sweeps handed on at a time.
TOGETHER = 32


def height(x: float, y: float) -> float:
    """The mold's floor, mm."""
    return -6.0 - 4.0 * math.sin(x / 9.0) * math.cos(y / 7.0) - 2.0 * math.sin(x / 3.0 + y / 5.0)


def program() -> Iterator[str]:
    """The NC program, line by line."""
    yield "G21 G90 G94"
    yield "S12000 M3"
    yield f"G1 X0 Y0 Z{height(0.0, 0.0):.4f} F3000"
    for number in range(161):
        y = 0.5 * number
        for x in np.arange(0.0, 100.0001, 0.15)[:: -1 if number % 2 else 1]:
            yield f"X{x:.4f} Y{y:.4f} Z{height(x, y):.4f}"
    yield "M30"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--lines", type=int, default=1_000_000, help="motions to cut at most")
    options = parser.parse_args()
    text = "\n".join(program())
    begin = time.perf_counter()
    points = np.concatenate([batch.end_mm for batch in motion_arrays(text)])[: options.lines + 1]
    read_s = time.perf_counter() - begin
    tolerance = Tolerance.for_pitch(PITCH_MM)
    body = Body.of(tool_shape("ball", 6.0, 20.0), chord_mm=tolerance.chord_mm)
    piece = CellSlices(box_slices((0.0, 0.0, -20.0), (100.0, 80.0, 0.0), PITCH_MM))
    sweeps = [Sweep(body, a, b) for a, b in pairwise(points)]
    begin = time.perf_counter()
    with Removal(piece, tolerance.chord_mm) as removal:
        volume = sum(removal.cut_all(sweeps[i : i + TOGETHER]).sum() for i in range(0, len(sweeps), TOGETHER))
    wall_s = time.perf_counter() - begin
    report(
        "surface",
        motions=len(sweeps),
        reading_s=round(read_s, 3),
        removal_s=round(wall_s, 1),
        ms_per_motion=round(1000.0 * wall_s / len(sweeps), 3),
        removed_mm3=round(float(volume), 1),
    )


if __name__ == "__main__":
    main()
