"""Order of pieces of a tool path: greedy nearest neighbour, 2-opt with Or-opt, iterated local search; compiled.

Piece i has two ends, 2 i and 2 i + 1, and is run from one to the other; a point is a piece whose ends are one. A tour
is an array of pieces with a flag each that states whether it is run backwards. It is closed through a last piece, the
dummy, that costs nothing to reach and comes right before the fixed start, so an open path is a closed tour.

The link between two ends takes the shorter of two times: at feed across the cleared area, where there is no wall
between them; or up, across at the rapid rate, and down.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import helper, njit

#: Time of a link that must stay as it is.
_FIXED = -1e7
#: Smallest gain that counts, s.
_GAIN = 1e-9
_MOST_SEGMENT = 50
#: Moves in a row at one piece, against endless repetition by rounding.
_MOST_MOVES = 1000
#: Reversals that can be taken back.
_LOGGED = 2000


class Speeds(NamedTuple):
    """Speed and acceleration of links at feed and of rapids, mm/s and mm/s2."""

    feed: float
    feed_acceleration: float
    rapid: float
    rapid_acceleration: float


class Links(NamedTuple):
    """All that the time of a link depends on.

    Attributes:
        ends: shape (2 n, 2), positions of the ends in the plan, mm.
        lift: shape (2 n,), time of going up from an end, or down to it, s.
        speeds: of links.
        clear: shape (nx, ny), distance from each point of a map to the nearest position where the tool must not be,
            mm; shape (0, 0) where links at feed are allowed everywhere.
        x, y: position of the map's first point, mm.
        pitch: distance of its points, mm.
    """

    ends: FloatArray
    lift: FloatArray
    speeds: Speeds
    clear: FloatArray
    x: float
    y: float
    pitch: float


class Closed(NamedTuple):
    """A closed tour in the making.

    Attributes:
        tour, back: shape (n,), pieces in their order, and whether each is run backwards.
        place: shape (n,), where each piece is in the tour.
        log: reversals that were made: their number, then first and last position of each.
        queue: ring of pieces to look at: head, number of entries, entries.
        waits: shape (n,), which pieces are in the queue.
    """

    tour: NDArray[np.int64]
    back: NDArray[np.int8]
    place: NDArray[np.int64]
    log: NDArray[np.int64]
    queue: NDArray[np.int64]
    waits: NDArray[np.bool_]


class Neighbours(NamedTuple):
    """Candidates of the search.

    Attributes:
        near: shape (2 n, k), the pieces nearest to each end, nearest first.
        soonest: shape (2 n, k), least time of a link to each.
        two_way: whether pieces may be run backwards.
    """

    near: NDArray[np.int64]
    soonest: FloatArray
    two_way: bool


class _Gap(NamedTuple):
    """The link between neighbouring positions p and q: from end e of the one to end f of the other, and its time.

    Side 0 is the link after the piece at p, side 1 the one before it.
    """

    side: int
    p: int
    q: int
    e: int
    f: int
    old: float


class _Cells(NamedTuple):
    """Free ends in square cells: those of cell c are ``members[begins[c] : begins[c] + sizes[c]]``.

    Attributes:
        x, y, size: low corner and size of the cells.
        columns, rows: their numbers.
        homes: shape (2 n,), the cell of each end.
        begins, sizes: of each cell's members.
        members: ends.
        places: shape (2 n,), where each end is among the members.
    """

    x: float
    y: float
    size: float
    columns: int
    rows: int
    homes: NDArray[np.int64]
    begins: NDArray[np.int64]
    sizes: NDArray[np.int64]
    members: NDArray[np.int64]
    places: NDArray[np.int64]


@helper
def trapezoid_s(length: float, speed: float, acceleration: float) -> float:
    """Time from rest to rest over a length."""
    if length * acceleration < speed * speed:
        return 2.0 * math.sqrt(length / acceleration)
    return length / speed + speed / acceleration


@njit
def trapezoids_s(lengths: FloatArray, speed: float, acceleration: float) -> FloatArray:
    """`trapezoid_s` of a table of lengths."""
    times = np.empty_like(lengths)
    for i in range(lengths.shape[0]):
        for j in range(lengths.shape[1]):
            times[i, j] = trapezoid_s(lengths[i, j], speed, acceleration)
    return times


@njit
def distinct(near: NDArray[np.int64], distances: FloatArray, table: NDArray[np.int64], reach: FloatArray) -> None:
    """The pieces of the nearest ends of each end, nearest first, each once and not its own; the last one fills up."""
    for e in range(near.shape[0]):
        k = 0
        for m in range(near.shape[1]):
            piece = near[e, m] // 2
            known = piece == e // 2
            for j in range(k):
                known = known or table[e, j] == piece
            if not known and k < table.shape[1]:
                table[e, k], reach[e, k] = piece, distances[e, m]
                k += 1
        for j in range(max(k, 1), table.shape[1]):
            table[e, j], reach[e, j] = table[e, j - 1], reach[e, j - 1]


@helper
def _sees(ax: float, ay: float, bx: float, by: float, links: Links) -> bool:
    """Whether a straight line keeps off the walls: it leaps as far as the distance to the nearest one allows."""
    clear, x, y, pitch = links.clear, links.x, links.y, links.pitch
    length = math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))
    s = 0.0
    while True:
        t = s / length if length > 0.0 else 0.0
        i = int(math.floor((ax + t * (bx - ax) - x) / pitch + 0.5))
        j = int(math.floor((ay + t * (by - ay) - y) / pitch + 0.5))
        if i < 0 or j < 0 or i >= clear.shape[0] or j >= clear.shape[1] or clear[i, j] <= 0.0:
            return False
        if s >= length:
            return True
        s = min(length, s + max(0.5 * pitch, clear[i, j] - pitch))


@njit
def link_s(e: int, f: int, links: Links) -> float:
    """Time of the link from end e to end f, the same to the last bit as that from f to e."""
    ends, lift, speeds = links.ends, links.lift, links.speeds
    n = ends.shape[0]
    if e > f:
        e, f = f, e
    if e >= n or f >= n:
        return _FIXED if min(e, f) < 2 else 0.0
    ax, ay, bx, by = ends[e, 0], ends[e, 1], ends[f, 0], ends[f, 1]
    length = math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))
    over = lift[e] + lift[f] + trapezoid_s(length, speeds.rapid, speeds.rapid_acceleration)
    stay = trapezoid_s(length, speeds.feed, speeds.feed_acceleration)
    if stay >= over or links.clear.shape[0] == 0:
        return min(stay, over)
    return stay if _sees(ax, ay, bx, by, links) else over


@njit
def links_down(out: NDArray[np.int64], into: NDArray[np.int64], links: Links, down: NDArray[np.bool_]) -> None:
    """Fill in which links, from the ends ``out`` to the ends ``into``, are run at feed without going up."""
    ends, lift, speeds = links.ends, links.lift, links.speeds
    for k in range(len(out)):
        e, f = out[k], into[k]
        length = math.hypot(ends[f, 0] - ends[e, 0], ends[f, 1] - ends[e, 1])
        over = lift[e] + lift[f] + trapezoid_s(length, speeds.rapid, speeds.rapid_acceleration)
        down[k] = link_s(e, f, links) < over


@njit
def greedy(links: Links, two_way: bool, cell: float) -> tuple[NDArray[np.int64], NDArray[np.int8]]:
    """Always the piece that is reached soonest, from piece 0 on."""
    n = links.ends.shape[0] // 2
    cells = _cells(links.ends, two_way, cell)
    tour = np.empty(n, dtype=np.int64)
    back = np.zeros(n, dtype=np.int8)
    tour[0] = 0
    at = 1
    least_lift = links.lift.min()
    for k in range(1, n):
        chosen = _soonest(at, links, cells, least_lift)
        node = chosen // 2
        tour[k], back[k] = node, chosen % 2
        at = chosen ^ 1
        _remove(2 * node, cells)
        if two_way:
            _remove(2 * node + 1, cells)
    return tour, back


@helper
def _cells(ends: FloatArray, two_way: bool, size: float) -> _Cells:
    """All ends where a piece can be begun, but those of the start, in cells."""
    n = ends.shape[0] // 2
    x0, y0 = ends[:, 0].min(), ends[:, 1].min()
    nx = int((ends[:, 0].max() - x0) / size) + 1
    ny = int((ends[:, 1].max() - y0) / size) + 1
    counts = np.zeros(nx * ny + 1, dtype=np.int64)
    homes = np.empty(2 * n, dtype=np.int64)
    for e in range(2 * n):
        homes[e] = int((ends[e, 0] - x0) / size) * ny + int((ends[e, 1] - y0) / size)
        counts[homes[e] + 1] += 1
    begins = np.cumsum(counts)
    members = np.empty(2 * n, dtype=np.int64)
    places = np.empty(2 * n, dtype=np.int64)
    sizes = np.zeros(nx * ny, dtype=np.int64)
    for e in range(2, 2 * n):
        if e % 2 == 0 or two_way:
            c = homes[e]
            places[e] = begins[c] + sizes[c]
            members[places[e]] = e
            sizes[c] += 1
    return _Cells(x0, y0, size, nx, ny, homes, begins, sizes, members, places)


@helper
def _remove(e: int, cells: _Cells) -> None:
    """Take an end out of its cell; the cell's last one takes its place."""
    members, places, c = cells.members, cells.places, cells.homes[e]
    moved = members[cells.begins[c] + cells.sizes[c] - 1]
    members[places[e]], places[moved] = moved, places[e]
    cells.sizes[c] -= 1


@helper
def _soonest(at: int, links: Links, cells: _Cells, least_lift: float) -> int:
    """The free end that is reached soonest from an end.

    Rings of cells are searched outwards until no sooner end can be in the next ring.
    """
    x0, y0, cell, nx, ny = cells.x, cells.y, cells.size, cells.columns, cells.rows
    begins, sizes, members = cells.begins, cells.sizes, cells.members
    ends, lift, speeds = links.ends, links.lift, links.speeds
    ci = int((ends[at, 0] - x0) / cell)
    cj = int((ends[at, 1] - y0) / cell)
    best, chosen = math.inf, -1
    for ring in range(max(nx, ny) + 1):
        reach = max(0.0, (ring - 1) * cell)
        least = min(
            trapezoid_s(reach, speeds.feed, speeds.feed_acceleration),
            lift[at] + least_lift + trapezoid_s(reach, speeds.rapid, speeds.rapid_acceleration),
        )
        if chosen >= 0 and least >= best:
            break
        for i in range(max(0, ci - ring), min(nx, ci + ring + 1)):
            step = 1 if abs(i - ci) == ring else max(1, 2 * ring)
            for j in range(cj - ring, cj + ring + 1, step):
                if j < 0 or j >= ny:
                    continue
                c = i * ny + j
                for m in range(begins[c], begins[c] + sizes[c]):
                    t = link_s(at, members[m], links)
                    if t < best:
                        best, chosen = t, members[m]
    return chosen


@njit
def tour_s(tour: NDArray[np.int64], back: NDArray[np.int8], links: Links) -> float:
    """Time of all links of an open path."""
    total = 0.0
    for k in range(len(tour) - 1):
        total += link_s(2 * tour[k] + 1 - back[k], 2 * tour[k + 1] + back[k + 1], links)
    return total


@helper
def _first_end(closed: Closed, p: int) -> int:
    """The end at which the piece at a position is begun."""
    return 2 * closed.tour[p] + closed.back[p]


@helper
def _last_end(closed: Closed, p: int) -> int:
    """The end at which the piece at a position ends."""
    return 2 * closed.tour[p] + 1 - closed.back[p]


@helper
def _reverse(closed: Closed, first: int, last: int) -> None:
    """Run positions first..last of the closed tour the other way round."""
    tour, back, place = closed.tour, closed.back, closed.place
    n = len(tour)
    inner = (last - first) % n + 1
    i, j = first, last
    for _ in range(inner // 2):
        a, b = tour[i], tour[j]
        tour[i], tour[j] = b, a
        back[i], back[j] = 1 - back[j], 1 - back[i]
        place[a], place[b] = j, i
        i += 1
        if i == n:
            i = 0
        j -= 1
        if j < 0:
            j = n - 1
    if inner % 2 == 1:
        back[i] = 1 - back[i]


@helper
def _turn(closed: Closed, first: int, last: int) -> None:
    """A reversal that is logged, so that it can be taken back."""
    log, n = closed.log, len(closed.tour)
    first, last = first % n, last % n
    _reverse(closed, first, last)
    count = log[0]
    if 2 * count + 2 < len(log):
        log[1 + 2 * count], log[2 + 2 * count] = first, last
    log[0] = count + 1


@helper
def _turn_shorter(closed: Closed, first: int, last: int) -> None:
    """Reverse positions first..last, or all others if they are fewer: the same closed tour."""
    n = len(closed.tour)
    if 2 * ((last - first) % n + 1) > n:
        first, last = last + 1, first - 1
    _turn(closed, first, last)


@helper
def _push(closed: Closed, node: int) -> None:
    """Put a piece at the end of the queue, unless it is in it."""
    queue, waits = closed.queue, closed.waits
    if waits[node]:
        return
    size = len(queue) - 2
    queue[2 + (queue[0] + queue[1]) % size] = node
    queue[1] += 1
    waits[node] = True


@helper
def _pop(closed: Closed) -> int:
    """Take the first piece out of the queue."""
    queue = closed.queue
    size = len(queue) - 2
    node = queue[2 + queue[0]]
    queue[0] = (queue[0] + 1) % size
    queue[1] -= 1
    closed.waits[node] = False
    return int(node)


@helper
def _swap_neighbours(closed: Closed, a: int, b: int, c: int) -> None:
    """Exchange positions a..b-1 and b..c-1, each in its own direction: three reversals."""
    size = (c - b) % len(closed.tour)
    _turn(closed, a, c - 1)
    _turn(closed, a, a + size - 1)
    _turn(closed, a + size, c - 1)


@helper
def _insert(closed: Closed, first: int, last: int, u: int, turned: bool) -> None:
    """Move positions first..last into the gap after position u, on the shorter side of the tour."""
    n = len(closed.tour)
    ahead, behind = (u - last) % n, (first - u - 1) % n
    if ahead < behind:
        if turned:
            _turn(closed, first, u)
            _turn(closed, first, first + ahead - 1)
        else:
            _swap_neighbours(closed, first, last + 1, u + 1)
    elif turned:
        _turn(closed, u + 1, last)
        _turn(closed, last - behind + 1, last)
    else:
        _swap_neighbours(closed, u + 1, first, last + 1)


@helper
def _gap(closed: Closed, links: Links, p: int, side: int) -> _Gap:
    """The link on one side of the piece at position p."""
    n = len(closed.tour)
    if side == 0:
        q = (p + 1) % n
        e, f = _last_end(closed, p), _first_end(closed, q)
    else:
        q = (p - 1) % n
        e, f = _first_end(closed, p), _last_end(closed, q)
    return _Gap(side, p, q, e, f, link_s(e, f, links))


@helper
def _improve(node: int, closed: Closed, links: Links, neighbours: Neighbours) -> float:
    """The first 2-opt or Or-opt move found at a piece that shortens the tour; returns its gain, 0 if there is none."""
    place, near, soonest, two_way = closed.place, neighbours.near, neighbours.soonest, neighbours.two_way
    for side in range(2):
        gap = _gap(closed, links, place[node], side)
        if gap.old <= _GAIN:
            continue
        for k in range(near.shape[1]):
            if soonest[gap.e, k] >= gap.old - _GAIN:
                break
            r = place[near[gap.e, k]]
            if r in (gap.p, gap.q):
                continue
            if two_way:
                gain = _two_opt(closed, links, gap, r)
                if gain > 0.0:
                    return gain
            for turned in range(2 if two_way else 1):
                gain = _or_opt(closed, links, gap, r, turned == 1)
                if gain > 0.0:
                    return gain
    return 0.0


@helper
def _two_opt(closed: Closed, links: Links, gap: _Gap, r: int) -> float:
    """Link e to the like end of the piece at position r, and the two ends that are left over, if that gains."""
    tour, n = closed.tour, len(closed.tour)
    if gap.side == 0:
        s = (r + 1) % n
        g, h = _last_end(closed, r), _first_end(closed, s)
    else:
        s = (r - 1) % n
        g, h = _first_end(closed, r), _last_end(closed, s)
    new = link_s(gap.e, g, links)
    if new >= gap.old - _GAIN:
        return 0.0
    gain = gap.old - new + link_s(g, h, links)
    gain -= link_s(gap.f, h, links)
    if gain <= _GAIN:
        return 0.0
    for m in (gap.p, gap.q, r, s):
        _push(closed, tour[m])
    if gap.side == 0:
        _turn_shorter(closed, gap.q, r)
    else:
        _turn_shorter(closed, r, gap.q)
    return gain


@helper
def _or_opt(closed: Closed, links: Links, gap: _Gap, r: int, turned: bool) -> float:
    """Bring one to three pieces, from the one at position r on, between e and f, if that gains.

    The piece at r comes next to e; the others follow on the side away from e. They keep their direction along the tour,
    or are turned.
    """
    tour, n = closed.tour, len(closed.tour)
    p, q, old = gap.p, gap.q, gap.old
    forward = (gap.side == 0) != turned
    for size in range(1, 4):
        first = r if forward else (r - size + 1) % n
        last = (first + size - 1) % n
        if (p - first) % n < size or (q - first) % n < size:
            break
        before, after = (first - 1) % n, (last + 1) % n
        if (before, after) == (q, p) or n < size + 4:
            break
        fe, le = _first_end(closed, first), _last_end(closed, last)
        g, h = (fe, le) if forward else (le, fe)
        new = link_s(gap.e, g, links)
        if new >= old - _GAIN:
            break
        b, a = _last_end(closed, before), _first_end(closed, after)
        gain = old - new - link_s(h, gap.f, links)
        gain += link_s(b, fe, links)
        gain += link_s(le, a, links)
        gain -= link_s(b, a, links)
        if gain <= _GAIN:
            continue
        for m in (p, q, first, last, before, after):
            _push(closed, tour[m])
        # the gap between positions u and u + 1 takes them in
        _insert(closed, first, last, p if gap.side == 0 else q, turned)
        return gain
    return 0.0


@helper
def _settle(closed: Closed, links: Links, neighbours: Neighbours) -> float:
    """Improve until no piece in the queue has a move left; returns the gain."""
    total = 0.0
    n_ends, queue = links.ends.shape[0], closed.queue
    while queue[1] > 0:
        node = _pop(closed)
        if 2 * node >= n_ends:
            continue
        for _ in range(_MOST_MOVES):
            gain = _improve(node, closed, links, neighbours)
            if gain <= 0.0:
                break
            total += gain
    return total


@njit
def local_search(tour: NDArray[np.int64], back: NDArray[np.int8], links: Links, neighbours: Neighbours) -> float:
    """2-opt and Or-opt from a closed tour until nothing is gained, in place; returns the gain, s.

    The dummy is piece ``len(tour) - 1``.
    """
    closed = _closed(tour, back)
    for k in range(len(tour)):
        _push(closed, tour[k])
    return _settle(closed, links, neighbours)


@helper
def _closed(tour: NDArray[np.int64], back: NDArray[np.int8]) -> Closed:
    n = len(tour)
    place = np.empty(n, dtype=np.int64)
    for k in range(n):
        place[tour[k]] = k
    log = np.zeros(2 * _LOGGED + 1, dtype=np.int64)
    return Closed(tour, back, place, log, np.zeros(n + 3, dtype=np.int64), np.zeros(n, dtype=np.bool_))


@helper
def _random(state: int) -> int:
    """The next number of Park and Miller's generator, 1 to 2^31 - 2."""
    return state * 48271 % 2147483647


@helper
def _exchange_gain(closed: Closed, links: Links, a: int, b: int, c: int) -> float:
    """Gain of exchanging positions a..b-1 and b..c-1, each in its own direction."""
    n = len(closed.tour)
    la, fa = _last_end(closed, (a - 1) % n), _first_end(closed, a % n)
    lb, fb = _last_end(closed, (b - 1) % n), _first_end(closed, b % n)
    lc, fc = _last_end(closed, (c - 1) % n), _first_end(closed, c % n)
    gain = link_s(la, fa, links) + link_s(lb, fb, links)
    gain += link_s(lc, fc, links) - link_s(la, fb, links)
    gain -= link_s(lc, fa, links) + link_s(lb, fc, links)
    return gain


@njit
def iterate(
    random: int,
    iterations: int,
    tour: NDArray[np.int64],
    back: NDArray[np.int8],
    links: Links,
    neighbours: Neighbours,
) -> tuple[float, int]:
    """Iterated local search: double-bridges of neighbouring stretches, each kept if it ends shorter, else taken back.

    Args:
        random: state of the generator, to be handed on.

    Returns:
        The gain in s, and the generator's next state.
    """
    n = len(tour)
    closed = _closed(tour, back)
    log = closed.log
    longest = min(_MOST_SEGMENT, (n - 2) // 3)
    total = 0.0
    if longest < 1:
        return total, random
    for _ in range(iterations):
        random = _random(random)
        a = random % n
        random = _random(random)
        b = a + 1 + random % longest
        random = _random(random)
        c = b + 1 + random % longest
        gain = _exchange_gain(closed, links, a, b, c)
        if abs(gain) > -0.5 * _FIXED:  # the link from dummy to start would go
            continue
        log[0] = 0
        for m in (a - 1, a, b - 1, b, c - 1, c):
            _push(closed, tour[m % n])
        _swap_neighbours(closed, a, b % n, c % n)
        gain += _settle(closed, links, neighbours)
        if gain >= -1e-12 or 2 * log[0] + 2 >= len(log):
            total += gain
            continue
        for k in range(log[0] - 1, -1, -1):
            _reverse(closed, log[1 + 2 * k], log[2 + 2 * k])
    return total, random
