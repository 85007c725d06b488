"""Speed of the dexel model: an R4 ball on a finishing's short moves at 0.1 mm, against a plain z-map: prints JSON.

    python -m benchmarks.dexel [--passes 60] [--step 0.3]

The z-map is the usual one: the tool stands at each point in turn, every dexel below it is compared; what lies between
two points is not cut. Both run on one thread over the same path, in CPU time, best of three; then ours on all cores in
wall time, and other tools.
"""

from __future__ import annotations

import argparse
import math
import time

import numpy as np
from numba import njit

from benchmarks.report import report
from twin.arrays import FloatArray
from twin.cam.stock.dexel import Dexels
from twin.cam.stock.strokes import Strokes
from twin.tools.text import parse_tool

PITCH_MM = 0.1
ALLOWANCE_MM = 0.3
REPEATS = 3


@njit(cache=True)
def plain_zmap(heights: FloatArray, low: float, pitch: float, points: FloatArray, radius: float) -> None:
    """Lower a height grid by a ball standing at points."""
    for k in range(len(points)):
        x, y, centre = points[k, 0], points[k, 1], points[k, 2] + radius
        i0, i1 = max(0, math.ceil((x - radius - low) / pitch)), math.floor((x + radius - low) / pitch)
        j0, j1 = max(0, math.ceil((y - radius - low) / pitch)), math.floor((y + radius - low) / pitch)
        for i in range(i0, min(heights.shape[0] - 1, i1) + 1):
            dx = low + i * pitch - x
            for j in range(j0, min(heights.shape[1] - 1, j1) + 1):
                dy = low + j * pitch - y
                rest = radius * radius - dx * dx - dy * dy
                if rest >= 0.0:
                    z = centre - math.sqrt(rest)
                    if z < heights[i, j]:
                        heights[i, j] = z


def surface(x: FloatArray, y: FloatArray) -> FloatArray:
    """Hills and hollows of up to 40 degrees."""
    return np.asarray(1.5 * np.sin(x / 3.0) * np.cos(y / 4.0))


def finishing(passes: int, step: float) -> FloatArray:
    """Zigzag over the surface, 0.3 mm from pass to pass."""
    x = np.arange(5.0, 95.0, step)
    rows = [np.column_stack((x[:: 1 if k % 2 == 0 else -1], np.full(len(x), 10.0 + 0.3 * k))) for k in range(passes)]
    plan = np.concatenate(rows)
    return np.column_stack((plan, surface(plan[:, 0], plan[:, 1])))


def stock() -> Dexels:
    """Stock after a semi-finishing: the surface and 0.3 mm."""
    flat = Dexels((0.0, 0.0), (100.0, 80.0), PITCH_MM, 9.0, -30.0)
    x, y = np.meshgrid(flat.x_mm, flat.y_mm, indexing="ij")
    return Dexels((0.0, 0.0), (100.0, 80.0), PITCH_MM, surface(x, y) + ALLOWANCE_MM, -30.0)


def moves_a_second(text: str, points: FloatArray, threads: int | None) -> tuple[float, Dexels]:
    """Speed of the exact model, and what it leaves."""
    tool, strokes = parse_tool(text), Strokes.through(points)
    clock = time.process_time if threads == 1 else time.perf_counter
    stock().cut(tool, Strokes.through(points[:9]), threads)
    best = math.inf
    for _ in range(REPEATS):
        dexels = stock()
        begin = clock()
        dexels.cut(tool, strokes, threads)
        best = min(best, clock() - begin)
    return (len(points) - 1) / best, dexels


def zmap_points_a_second(points: FloatArray) -> tuple[float, FloatArray]:
    """Speed of the plain z-map, and its heights."""
    best = math.inf
    for _ in range(REPEATS):
        plain = stock()
        low = float(plain.x_mm[0])
        plain_zmap(plain.heights_mm.copy(), low, PITCH_MM, points[:2], 4.0)
        begin = time.process_time()
        plain_zmap(plain.heights_mm, low, PITCH_MM, points, 4.0)
        best = min(best, time.process_time() - begin)
    return len(points) / best, plain.heights_mm


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--passes", type=int, default=60)
    parser.add_argument("--step", type=float, default=0.3)
    options = parser.parse_args()
    points = finishing(options.passes, options.step)
    zmap, left = zmap_points_a_second(points)
    ball, exact = moves_a_second("ball 8", points, 1)
    report(
        "dexel",
        moves=len(points) - 1,
        step_mm=options.step,
        ball_moves_a_second=round(ball),
        ball_moves_a_second_all_cores=round(moves_a_second("ball 8", points, None)[0]),
        plain_zmap_points_a_second=round(zmap),
        times_plain_zmap=round(ball / zmap, 2),
        most_left_by_zmap_um=round(1000.0 * float((left - exact.heights_mm).max()), 1),
        flat_moves_a_second=round(moves_a_second("flat 8", points, 1)[0]),
        bull_moves_a_second=round(moves_a_second("bull 8 r1", points, 1)[0]),
    )


if __name__ == "__main__":
    main()
