"""Tours against OR-tools' routing: length after the same time, 200 to 10,000 points.

    python -m benchmarks.tour --points 200 1000 --seconds 5

Points are random in a square, the start is a corner, the end is free, and the cost is the distance.
"""

from __future__ import annotations

import argparse
import math
import time

import numpy as np

from benchmarks.report import report
from twin.arrays import FloatArray
from twin.cam.path.tour import LinkSpeeds, Search, order_pieces

#: Distance alone: a millimetre a second, and no way over.
_PLAIN = LinkSpeeds(feed_mm_s=1.0, rapid_mm_s=1e-6)
_FAR_S = 1e9
#: Units a mm in the other solver, which counts in whole numbers.
_UNITS = 1000
#: More points than this would need gigabytes for a table of distances.
_MOST_IN_TABLE = 4000


def length_mm(points: FloatArray, order: FloatArray) -> float:
    return float(np.linalg.norm(np.diff(np.vstack(([0.0, 0.0], points[order])), axis=0), axis=1).sum())


def ours(points: FloatArray, seconds: float) -> tuple[float, float]:
    begin = time.perf_counter()
    search = Search(iterations=10**9, budget_s=seconds)
    tour = order_pieces(points, (0.0, 0.0), _PLAIN, lift_s=_FAR_S, search=search)
    return length_mm(points, tour.order), time.perf_counter() - begin


def theirs(points: FloatArray, seconds: float) -> tuple[float | None, float]:
    """OR-tools: cheapest arc first, then guided local search; None where it finds nothing, or is not installed."""
    begin = time.perf_counter()
    try:
        from ortools.constraint_solver import pywrapcp, routing_enums_pb2
    except ImportError:
        return None, 0.0
    places = np.vstack(([0.0, 0.0], points))
    n = len(places)
    # a last node that costs nothing to reach leaves the end free
    manager = pywrapcp.RoutingIndexManager(n + 1, 1, [0], [n])
    model = pywrapcp.RoutingModel(manager)
    if n <= _MOST_IN_TABLE:
        table = np.zeros((n + 1, n + 1), dtype=np.int64)
        table[:n, :n] = np.rint(np.linalg.norm(places[:, None] - places[None], axis=2) * _UNITS)
        cost = model.RegisterTransitMatrix(table.tolist())
    else:
        x, y = (places[:, i].tolist() for i in (0, 1))

        def distance(i: int, j: int) -> int:
            a, b = manager.IndexToNode(i), manager.IndexToNode(j)
            return 0 if n in (a, b) else round(_UNITS * math.hypot(x[a] - x[b], y[a] - y[b]))

        cost = model.RegisterTransitCallback(distance)
    model.SetArcCostEvaluatorOfAllVehicles(cost)
    wanted = pywrapcp.DefaultRoutingSearchParameters()
    wanted.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PATH_CHEAPEST_ARC
    wanted.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
    wanted.time_limit.FromMilliseconds(int(1000 * seconds))
    found = model.SolveWithParameters(wanted)
    return (found.ObjectiveValue() / _UNITS if found else None), time.perf_counter() - begin


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, nargs="+", default=[200, 1000, 3000, 10_000])
    parser.add_argument("--seconds", type=float, nargs="+", default=[5.0, 10.0, 20.0, 60.0])
    options = parser.parse_args()
    ours(np.random.default_rng(0).uniform(0.0, 100.0, (50, 2)), 0.1)  # compiles
    rows = []
    for n, seconds in zip(options.points, options.seconds, strict=True):
        points = np.random.default_rng(n).uniform(0.0, 100.0, (n, 2))
        (mine, mine_s), (other, other_s) = ours(points, seconds), theirs(points, seconds)
        rows.append(
            {
                "points": n,
                "limit_s": seconds,
                "length_mm": mine,
                "time_s": mine_s,
                "ortools_mm": other,
                "ortools_s": other_s,
                "ratio": None if other is None else mine / other,
            }
        )
    report("tour", tours=rows)


if __name__ == "__main__":
    main()
