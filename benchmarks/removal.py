"""Speed of removal alone, fast store against reference store, and its growth over a zigzag: prints one JSON object.

    python -m benchmarks.removal [--passes 40] [--reference-passes 2]

Ball R4, 2 mm deep, slices at 0.1 mm, one sweep a millimetre. The reference store is so slow that a few passes
are enough.
"""

from __future__ import annotations

import argparse
import statistics
import time

import numpy as np

from benchmarks.report import report
from twin.motion.sweep import Body, Sweep
from twin.tolerance import Tolerance
from twin.tools.shape import tool_shape
from twin.workpiece.removal import Removal
from twin.workpiece.stock import box_slices
from twin.workpiece.trislice import CellSlices, PolygonSlices, TriSlices

LENGTH_MM = 30.0
PITCH_MM = 0.1
STEP_OVER_MM = 0.5


def passes(piece: TriSlices, count: int) -> list[float]:
    """Milliseconds per mm of path of each pass."""
    tolerance = Tolerance.for_pitch(PITCH_MM)
    body = Body.of(tool_shape("ball", 8.0, 20.0), chord_mm=tolerance.chord_mm)
    times = []
    with Removal(piece, tolerance.chord_mm) as removal:
        for number in range(count):
            y = 4.0 + STEP_OVER_MM * number
            begin = time.perf_counter()
            for x in np.arange(0.0, LENGTH_MM):
                removal.cut(Sweep(body, np.array([x, y, -2.0]), np.array([x + 1.0, y, -2.0])))
            times.append((time.perf_counter() - begin) * 1000.0 / LENGTH_MM)
    return times


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--passes", type=int, default=40)
    parser.add_argument("--reference-passes", type=int, default=2)
    options = parser.parse_args()
    slices = box_slices((0.0, 0.0, -5.0), (LENGTH_MM, 8.0 + STEP_OVER_MM * options.passes, 0.0), PITCH_MM)
    passes(CellSlices(slices), 1)
    fast = passes(CellSlices(slices), options.passes)
    slow = passes(PolygonSlices(slices), options.reference_passes)
    report(
        "removal",
        fast_median_ms_per_mm=round(statistics.median(fast), 3),
        reference_median_ms_per_mm=round(statistics.median(slow), 3),
        reference_over_fast=round(statistics.median(slow) / statistics.median(fast[: len(slow)]), 2),
        last_passes_over_first=round(statistics.median(fast[-3:]) / statistics.median(fast[1:4]), 3),
        passes=options.passes,
    )


if __name__ == "__main__":
    main()
