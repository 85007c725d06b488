"""The order in which pieces of a tool path are cut: greedy nearest neighbour, 2-opt with Or-opt, iterated local search.

The mold paper (section 2.2) orders the points of remaining regions by a travelling salesman's tour with a fixed start.
Here a piece is a point or a stretch of path with two ends, and the tour's cost is time: a link is either fed across
the cleared area or goes up, across at the rapid rate and down again, whichever is sooner.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

from twin.arrays import FloatArray, frozen
from twin.cam.path import tour_kernels as kernels

Method: TypeAlias = Literal["greedy", "2-opt", "ils"]
METHODS: tuple[Method, ...] = ("greedy", "2-opt", "ils")

#: Neighbours looked at from each end.
_NEAR = 10
#: Iterations between two looks at the clock.
_CHUNK = 200


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkSpeeds:
    """Speeds of links, all above 0.

    Attributes:
        feed_mm_s, feed_mm_s2: speed and acceleration of a link that stays down.
        rapid_mm_s, rapid_mm_s2: those of a link at the safe height.
    """

    feed_mm_s: float
    feed_mm_s2: float = 1e12
    rapid_mm_s: float
    rapid_mm_s2: float = 1e12

    @property
    def numbers(self) -> kernels.Speeds:
        """The form that kernels take."""
        return kernels.Speeds(
            float(self.feed_mm_s), float(self.feed_mm_s2), float(self.rapid_mm_s), float(self.rapid_mm_s2)
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ClearGrid:
    """Where links may stay down.

    Attributes:
        low_mm: position of grid point (0, 0), shape (2,).
        pitch_mm: distance of the grid points.
        distance_mm: at each grid point the distance to the nearest one where the tool must not be, 0 there;
            shape (nx, ny).
    """

    low_mm: FloatArray
    pitch_mm: float
    distance_mm: FloatArray

    @classmethod
    def of(cls, allowed: NDArray[np.bool_], low_mm: ArrayLike, pitch_mm: float) -> ClearGrid:
        """From a map of the positions where the tool may be, shape (nx, ny); outside the map it must not be."""
        framed = np.pad(allowed, 1)
        distance = np.asarray(distance_transform_edt(framed))[1:-1, 1:-1] * pitch_mm
        return cls(low_mm=frozen(low_mm, "low_mm", (2,)), pitch_mm=pitch_mm, distance_mm=np.ascontiguousarray(distance))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tour:
    """An order of pieces.

    Attributes:
        order: the pieces in the order in which they are cut, shape (n,).
        backwards: which of them are run from their second end to their first, shape (n,).
        down: which of them are reached without going up, from the one before or the start, shape (n,).
        link_s: time of all links.
        first_s: that of the greedy tour it began with.
    """

    order: NDArray[np.int64]
    backwards: NDArray[np.bool_]
    down: NDArray[np.bool_]
    link_s: float
    first_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Search:
    """How a tour is searched for.

    Attributes:
        method: greedy alone, with 2-opt and Or-opt after it, or with iterated local search after that.
        seed: of the double-bridges; equal seeds give equal tours.
        iterations: double-bridges; 5 a piece, at least 500, if not given.
        budget_s: longest time spent on double-bridges; with it, the result depends on the machine. Not limited if None.
    """

    method: Method = "ils"
    seed: int = 1
    iterations: int | None = None
    budget_s: float | None = None


def order_pieces(
    ends_mm: ArrayLike,
    start_mm: ArrayLike,
    speeds: LinkSpeeds,
    *,
    lift_s: ArrayLike = 0.0,
    start_lift_s: float = 0.0,
    clear: ClearGrid | None = None,
    two_way: bool = True,
    search: Search | None = None,
) -> Tour:
    """Find a short order of pieces from a fixed start; the end is free.

    Args:
        ends_mm: both ends of each piece, shape (n, 2, 2); or points, shape (n, 2).
        start_mm: shape (2,).
        lift_s: time of going up from an end, or down to it, to where rapids are free: one for all, or shape (n, 2).
        start_lift_s: that of the start.
        clear: where links may stay down; everywhere if not given.
        two_way: whether pieces may be run backwards.
        search: how; iterated local search if not given.

    Raises:
        ValueError: wrong shapes, values that are not finite, or an unknown method.
    """
    search = search or Search()
    if search.method not in METHODS:
        raise ValueError(f"method must be one of {', '.join(METHODS)}, got {search.method!r}")
    pieces = np.asarray(ends_mm, dtype=np.float64)
    if pieces.ndim == 2:
        pieces = np.repeat(pieces[:, None, :], 2, axis=1)
    pieces = frozen(pieces, "ends_mm", (None, 2, 2))
    start = frozen(start_mm, "start_mm", (2,))
    if not len(pieces):
        none = np.empty(0, dtype=np.int64)
        return Tour(order=none, backwards=none.astype(bool), down=none.astype(bool), link_s=0.0, first_s=0.0)
    ends = np.vstack((start, start, pieces.reshape(-1, 2)))
    lift = np.concatenate(
        ([start_lift_s] * 2, np.broadcast_to(np.asarray(lift_s, np.float64), (len(pieces), 2)).ravel())
    )
    return _search(_links(ends, lift, speeds, clear), two_way, search)


def _links(ends: FloatArray, lift: FloatArray, speeds: LinkSpeeds, clear: ClearGrid | None) -> kernels.Links:
    if clear is None:
        return kernels.Links(ends, lift, speeds.numbers, np.empty((0, 0)), 0.0, 0.0, 0.0)
    x, y = clear.low_mm.tolist()
    return kernels.Links(ends, lift, speeds.numbers, clear.distance_mm, x, y, float(clear.pitch_mm))


def _search(links: kernels.Links, two_way: bool, search: Search) -> Tour:
    n = len(links.ends) // 2
    extent = float(np.ptp(links.ends, axis=0).max()) or 1.0
    tour, back = kernels.greedy(links, two_way, extent / max(1.0, (0.5 * n) ** 0.5))
    first = kernels.tour_s(tour, back, links)
    if search.method != "greedy" and n > 3:
        # the dummy closes the tour; its two ends are nowhere
        tour, back = np.append(tour, n), np.append(back, np.int8(0))
        neighbours = _neighbours(links, two_way)
        kernels.local_search(tour, back, links, neighbours)
        if search.method == "ils":
            _iterate(tour, back, links, neighbours, search)
        tour, back = _opened(tour, back)
    total = kernels.tour_s(tour, back, links)
    out, into = 2 * tour[:-1] + 1 - back[:-1], 2 * tour[1:] + back[1:]
    down = np.empty(n - 1, dtype=np.bool_)
    kernels.links_down(out, into, links, down)
    return Tour(order=tour[1:] - 1, backwards=back[1:] == 1, down=down, link_s=total, first_s=first)


def _iterate(
    tour: NDArray[np.int64],
    back: NDArray[np.int8],
    links: kernels.Links,
    neighbours: kernels.Neighbours,
    search: Search,
) -> None:
    left = search.iterations if search.iterations is not None else max(500, 5 * len(tour))
    random = 1 + search.seed % 2147483646
    end = None if search.budget_s is None else time.monotonic() + search.budget_s
    while left > 0 and (end is None or time.monotonic() < end):
        _, random = kernels.iterate(random, min(left, _CHUNK), tour, back, links, neighbours)
        left -= _CHUNK


def _neighbours(links: kernels.Links, two_way: bool) -> kernels.Neighbours:
    """For each end the pieces whose ends are nearest, and the least time of a link to them, both shape (2 n, k)."""
    ends, lift, speeds = links.ends, links.lift, links.speeds
    count = min(_NEAR, len(ends) // 2 - 1)
    distances, near = cKDTree(ends).query(ends, k=min(len(ends), 2 * count + 2))
    table = np.empty((len(ends), count), dtype=np.int64)
    reach = np.empty((len(ends), count))
    kernels.distinct(np.asarray(near, dtype=np.int64), np.asarray(distances, dtype=np.float64), table, reach)
    stay = kernels.trapezoids_s(reach, speeds.feed, speeds.feed_acceleration)
    over = lift[:, None] + lift.min() + kernels.trapezoids_s(reach, speeds.rapid, speeds.rapid_acceleration)
    return kernels.Neighbours(table, np.minimum(stay, over), two_way)


def _opened(tour: NDArray[np.int64], back: NDArray[np.int8]) -> tuple[NDArray[np.int64], NDArray[np.int8]]:
    """The open path from the start away from the dummy."""
    n = len(tour)
    at = int(np.flatnonzero(tour == 0)[0])
    if tour[(at + 1) % n] == n - 1:  # it runs in the other direction
        tour, back, at = tour[::-1], 1 - back[::-1], n - 1 - at
    order = np.roll(np.arange(n), -at)
    return np.ascontiguousarray(tour[order][:-1]), np.ascontiguousarray(back[order][:-1])
