"""Tours against exact solutions, brute force and themselves."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from twin.arrays import FloatArray
from twin.cam.path.tour import METHODS, ClearGrid, LinkSpeeds, Method, Search, Tour, order_pieces

PLAIN = LinkSpeeds(feed_mm_s=1.0, rapid_mm_s=1e-6)
FAR = 1e9


def points(n: int, seed: int = 0) -> FloatArray:
    return np.random.default_rng(seed).uniform(0.0, 100.0, (n, 2))


def length(pieces: FloatArray, tour: Tour) -> float:
    run = pieces[tour.order].copy()
    run[tour.backwards] = run[tour.backwards, ::-1]
    return float(np.linalg.norm(np.vstack(((0.0, 0.0), run[:-1, 1])) - run[:, 0], axis=1).sum())


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("two_way", [True, False])
def test_a_tour_visits_all_and_tells_its_time(method: Method, two_way: bool) -> None:
    a = points(60)
    pieces = np.stack((a, a + np.random.default_rng(1).normal(0.0, 5.0, a.shape)), axis=1)
    tour = order_pieces(pieces, (0, 0), PLAIN, lift_s=FAR, two_way=two_way, search=Search(method=method))
    assert sorted(tour.order) == list(range(60))
    assert two_way or not tour.backwards.any()
    assert tour.down.all()
    assert tour.link_s == pytest.approx(length(pieces, tour), rel=1e-9)
    assert tour.link_s <= tour.first_s + 1e-9


@pytest.mark.parametrize("seed", range(4))
def test_small_tours_are_the_best_of_all(seed: int) -> None:
    a = points(7, seed)
    best = min(
        float(np.linalg.norm(np.diff(np.vstack(((0.0, 0.0), a[list(p)])), axis=0), axis=1).sum())
        for p in itertools.permutations(range(7))
    )
    assert order_pieces(a, (0, 0), PLAIN, lift_s=FAR).link_s == pytest.approx(best, rel=1e-9)


@pytest.mark.parametrize("two_way", [True, False])
def test_small_tours_of_pieces_are_the_best_of_all(two_way: bool) -> None:
    a = points(5, 3)
    pieces = np.stack((a, points(5, 4)), axis=1)
    best = math.inf
    for p in itertools.permutations(range(5)):
        for flags in itertools.product([False, True] if two_way else [False], repeat=5):
            run = Tour(order=np.array(p), backwards=np.array(flags), down=np.ones(5, bool), link_s=0.0, first_s=0.0)
            best = min(best, length(pieces, run))
    found = order_pieces(pieces, (0, 0), PLAIN, lift_s=FAR, two_way=two_way)
    assert found.link_s == pytest.approx(best, rel=1e-9)


def test_each_method_is_no_worse_than_the_one_before() -> None:
    times = [order_pieces(points(500), (0, 0), PLAIN, lift_s=FAR, search=Search(method=m)).link_s for m in METHODS]
    assert times == sorted(times, reverse=True)
    # expected length of the best tour through n random points of a square: 0.7124 sqrt(n area), and some border
    assert times[-1] < 1.05 * 0.7124 * math.sqrt(500 * 1e4) * (1.0 + 0.33 / math.sqrt(500) * 2.0)


def test_a_grid_of_points_is_walked_without_a_detour() -> None:
    grid = np.stack(np.meshgrid(np.arange(12.0), np.arange(12.0)), axis=-1).reshape(-1, 2)
    tour = order_pieces(grid, (0, 0), PLAIN, lift_s=FAR, search=Search(iterations=20_000))
    assert tour.link_s == pytest.approx(143.0, abs=1.0)


def test_equal_seeds_give_equal_tours_and_others_differ() -> None:
    tours = [
        order_pieces(points(300), (0, 0), PLAIN, lift_s=FAR, search=Search(seed=s, iterations=300)) for s in (7, 7, 8)
    ]
    assert np.array_equal(tours[0].order, tours[1].order)
    assert not np.array_equal(tours[0].order, tours[2].order)


def test_a_wall_is_gone_around_or_over() -> None:
    # two columns of points on both sides of a wall, near enough to be tempting
    y = np.arange(0.0, 20.0, 2.0)
    a = np.concatenate((np.column_stack((np.full(10, 9.0), y)), np.column_stack((np.full(10, 11.0), y))))
    allowed = np.ones((41, 41), dtype=bool)
    allowed[19:22, :39] = False  # x 9.5 .. 10.5, open above y 19.5
    clear = ClearGrid.of(allowed, (0.0, 0.0), 0.5)
    speeds = LinkSpeeds(feed_mm_s=10.0, rapid_mm_s=500.0)
    tour = order_pieces(a, (9, 0), speeds, lift_s=2.0, clear=clear)
    side = a[tour.order, 0] > 10.0
    assert np.count_nonzero(np.diff(side)) == 1
    k = int(np.flatnonzero(np.diff(side))[0]) + 1
    assert not tour.down[k]
    assert tour.down.sum() == 19


def test_a_link_stays_down_where_it_sees_its_end() -> None:
    """Three points on a line, a wall between the last two: lifted there, although staying down were shorter."""
    allowed = np.ones((9, 5), dtype=bool)
    allowed[6, :] = False
    clear = ClearGrid.of(allowed, (0.0, 0.0), 0.5)
    speeds = LinkSpeeds(feed_mm_s=10.0, rapid_mm_s=500.0)
    points = [[0.5, 1.0], [1.5, 1.0], [4.0, 1.0]]
    assert order_pieces(points, (0, 0), speeds, lift_s=2.0, clear=clear).down.tolist() == [True, True, False]
    assert order_pieces(points, (0, 0), speeds, lift_s=2.0).down.tolist() == [True, True, True]


def test_far_links_go_over_and_near_ones_stay_down() -> None:
    speeds = LinkSpeeds(feed_mm_s=10.0, rapid_mm_s=500.0, rapid_mm_s2=5000.0)
    tour = order_pieces([[1.0, 0.0], [2.0, 0.0], [90.0, 0.0]], (0, 0), speeds, lift_s=0.5)
    assert tour.order.tolist() == [0, 1, 2]
    assert tour.down.tolist() == [True, True, False]
    assert tour.link_s == pytest.approx(0.2 + 0.5 + 0.5 + 88.0 / 500.0 + 0.1, rel=1e-6)


def test_nothing_and_one_piece() -> None:
    assert order_pieces(np.empty((0, 2)), (0, 0), PLAIN).link_s == 0.0
    assert order_pieces([[3.0, 4.0]], (0, 0), PLAIN, lift_s=FAR).link_s == pytest.approx(5.0)


def test_equal_points_are_no_trouble() -> None:
    tour = order_pieces(np.zeros((50, 2)), (0, 0), PLAIN, lift_s=FAR)
    assert sorted(tour.order) == list(range(50))
    assert tour.link_s == pytest.approx(0.0, abs=1e-9)


def test_mistakes_are_named() -> None:
    with pytest.raises(ValueError, match="method must be one of greedy, 2-opt, ils"):
        order_pieces([[0.0, 0.0]], (0, 0), PLAIN, search=Search(method="best"))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="ends_mm must be finite"):
        order_pieces([[0.0, np.nan]], (0, 0), PLAIN)
