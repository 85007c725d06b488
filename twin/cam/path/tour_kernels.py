"""Order of pieces of a tool path: greedy nearest neighbour, 2-opt with Or-opt, iterated local search; compiled.

Piece i has two ends, 2 i and 2 i + 1, and is run from one to the other; a point is a piece whose ends are one. A tour
is an array of pieces with a flag each that says whether it is run backwards. It is closed through a last piece, the
dummy, that costs nothing to reach and stands right before the fixed start, so an open path is a closed tour.

The link between two ends takes the shorter of two times: at feed across the cleared area, where no wall stands
between; or up, across at the rapid rate, and down. ``speeds`` holds (feed speed, feed acceleration, rapid speed,
rapid acceleration), mm/s and mm/s2; ``lift`` the time of going up from an end and down to it; ``clear`` the distance
from each cell of a grid to the nearest place where the tool must not be.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import njit

#: Time of a link that must stay as it is.
_FIXED = -1e7
#: Smallest gain that counts, s.
_GAIN = 1e-9
_MOST_SEGMENT = 50
#: Moves in a row at one piece, against going round in circles by rounding.
_MOST_MOVES = 1000


@njit
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


@njit
def _sees(ax: float, ay: float, bx: float, by: float, clear: FloatArray, grid: FloatArray) -> bool:
    """Whether a straight line keeps off the walls: it leaps as far as the distance to the nearest one allows."""
    length = math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))
    pitch = grid[2]
    s = 0.0
    while True:
        t = s / length if length > 0.0 else 0.0
        i = int(math.floor((ax + t * (bx - ax) - grid[0]) / pitch + 0.5))
        j = int(math.floor((ay + t * (by - ay) - grid[1]) / pitch + 0.5))
        if i < 0 or j < 0 or i >= clear.shape[0] or j >= clear.shape[1] or clear[i, j] <= 0.0:
            return False
        if s >= length:
            return True
        s = min(length, s + max(0.5 * pitch, clear[i, j] - pitch))


@njit
def link_s(
    e: int, f: int, ends: FloatArray, lift: FloatArray, speeds: FloatArray, clear: FloatArray, grid: FloatArray
) -> float:
    """Time of the link from end e to end f, the same to the last bit as that from f to e."""
    n = ends.shape[0]
    if e > f:
        e, f = f, e
    if e >= n or f >= n:
        return _FIXED if min(e, f) < 2 else 0.0
    ax, ay, bx, by = ends[e, 0], ends[e, 1], ends[f, 0], ends[f, 1]
    length = math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))
    over = lift[e] + lift[f] + trapezoid_s(length, speeds[2], speeds[3])
    stay = trapezoid_s(length, speeds[0], speeds[1])
    if stay >= over or clear.shape[0] == 0:
        return min(stay, over)
    return stay if _sees(ax, ay, bx, by, clear, grid) else over


@njit
def links_down(
    out: NDArray[np.int64],
    into: NDArray[np.int64],
    ends: FloatArray,
    lift: FloatArray,
    speeds: FloatArray,
    clear: FloatArray,
    grid: FloatArray,
    down: NDArray[np.bool_],
) -> None:
    """Fill in which links, from the ends ``out`` to the ends ``into``, are run at feed without going up."""
    for k in range(len(out)):
        e, f = out[k], into[k]
        length = math.hypot(ends[f, 0] - ends[e, 0], ends[f, 1] - ends[e, 1])
        over = lift[e] + lift[f] + trapezoid_s(length, speeds[2], speeds[3])
        down[k] = link_s(e, f, ends, lift, speeds, clear, grid) < over


@njit
def greedy(
    ends: FloatArray,
    lift: FloatArray,
    speeds: FloatArray,
    clear: FloatArray,
    grid: FloatArray,
    two_way: bool,
    cell: float,
) -> tuple[NDArray[np.int64], NDArray[np.int8]]:
    """Always the piece that is reached soonest, from piece 0 on.

    Ends lie in square cells; rings of cells are searched outwards until no nearer end can be in the next ring.
    """
    n = ends.shape[0] // 2
    x0, y0 = ends[:, 0].min(), ends[:, 1].min()
    nx = int((ends[:, 0].max() - x0) / cell) + 1
    ny = int((ends[:, 1].max() - y0) / cell) + 1
    counts = np.zeros(nx * ny + 1, dtype=np.int64)
    homes = np.empty(2 * n, dtype=np.int64)
    for e in range(2 * n):
        homes[e] = int((ends[e, 0] - x0) / cell) * ny + int((ends[e, 1] - y0) / cell)
        counts[homes[e] + 1] += 1
    begins = np.cumsum(counts)
    members = np.empty(2 * n, dtype=np.int64)
    places = np.empty(2 * n, dtype=np.int64)
    sizes = np.zeros(nx * ny, dtype=np.int64)
    for e in range(2 * n):
        c = homes[e]
        if e < 2 or (e % 2 == 1 and not two_way):
            continue
        places[e] = begins[c] + sizes[c]
        members[places[e]] = e
        sizes[c] += 1
    tour = np.empty(n, dtype=np.int64)
    back = np.zeros(n, dtype=np.int8)
    tour[0] = 0
    at = 1
    least_lift = lift.min()
    for k in range(1, n):
        ci = int((ends[at, 0] - x0) / cell)
        cj = int((ends[at, 1] - y0) / cell)
        best, chosen = math.inf, -1
        for ring in range(max(nx, ny) + 1):
            reach = max(0.0, (ring - 1) * cell)
            least = min(
                trapezoid_s(reach, speeds[0], speeds[1]),
                lift[at] + least_lift + trapezoid_s(reach, speeds[2], speeds[3]),
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
                        t = link_s(at, members[m], ends, lift, speeds, clear, grid)
                        if t < best:
                            best, chosen = t, members[m]
        node = chosen // 2
        tour[k], back[k] = node, chosen % 2
        at = chosen ^ 1
        for e in (2 * node, 2 * node + 1):
            if e % 2 == 1 and not two_way:
                continue
            c = homes[e]
            last = begins[c] + sizes[c] - 1
            moved = members[last]
            members[places[e]], places[moved] = moved, places[e]
            sizes[c] -= 1
    return tour, back


@njit
def tour_s(
    tour: NDArray[np.int64],
    back: NDArray[np.int8],
    ends: FloatArray,
    lift: FloatArray,
    speeds: FloatArray,
    clear: FloatArray,
    grid: FloatArray,
) -> float:
    """Time of all links of an open path."""
    total = 0.0
    for k in range(len(tour) - 1):
        e, f = 2 * tour[k] + 1 - back[k], 2 * tour[k + 1] + back[k + 1]
        total += link_s(e, f, ends, lift, speeds, clear, grid)
    return total


@njit
def _reverse(tour: NDArray[np.int64], back: NDArray[np.int8], place: NDArray[np.int64], first: int, last: int) -> None:
    """Run positions first..last of the closed tour the other way."""
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


@njit
def _turn(
    tour: NDArray[np.int64], back: NDArray[np.int8], place: NDArray[np.int64], log: NDArray[np.int64],
    first: int, last: int,
) -> None:  # fmt: skip
    """A reversal that is noted, so that it can be taken back; ``log[0]`` counts them."""
    n = len(tour)
    first, last = first % n, last % n
    _reverse(tour, back, place, first, last)
    count = log[0]
    if 2 * count + 2 < len(log):
        log[1 + 2 * count], log[2 + 2 * count] = first, last
    log[0] = count + 1


@njit
def _turn_shorter(
    tour: NDArray[np.int64], back: NDArray[np.int8], place: NDArray[np.int64], log: NDArray[np.int64],
    first: int, last: int,
) -> None:  # fmt: skip
    """Reverse positions first..last, or all others if they are fewer: the same closed tour."""
    n = len(tour)
    if 2 * ((last - first) % n + 1) > n:
        first, last = last + 1, first - 1
    _turn(tour, back, place, log, first, last)


@njit
def _push(queue: NDArray[np.int64], waits: NDArray[np.bool_], node: int) -> None:
    """Put a piece at the end of the ring of those to look at; its first two entries are head and count."""
    if waits[node]:
        return
    size = len(queue) - 2
    queue[2 + (queue[0] + queue[1]) % size] = node
    queue[1] += 1
    waits[node] = True


@njit
def _pop(queue: NDArray[np.int64], waits: NDArray[np.bool_]) -> int:
    size = len(queue) - 2
    node = queue[2 + queue[0]]
    queue[0] = (queue[0] + 1) % size
    queue[1] -= 1
    waits[node] = False
    return int(node)


@njit
def _swap_neighbours(
    tour: NDArray[np.int64], back: NDArray[np.int8], place: NDArray[np.int64], log: NDArray[np.int64],
    a: int, b: int, c: int,
) -> None:  # fmt: skip
    """Positions a..b-1 and b..c-1 change places, each in its own direction: three reversals."""
    size = (c - b) % len(tour)
    _turn(tour, back, place, log, a, c - 1)
    _turn(tour, back, place, log, a, a + size - 1)
    _turn(tour, back, place, log, a + size, c - 1)


@njit
def _insert(
    tour: NDArray[np.int64], back: NDArray[np.int8], place: NDArray[np.int64], log: NDArray[np.int64],
    first: int, last: int, u: int, turned: bool,
) -> None:  # fmt: skip
    """Positions first..last move into the gap behind position u, by the shorter way around."""
    n = len(tour)
    ahead, behind = (u - last) % n, (first - u - 1) % n
    if ahead < behind:
        if turned:
            _turn(tour, back, place, log, first, u)
            _turn(tour, back, place, log, first, first + ahead - 1)
        else:
            _swap_neighbours(tour, back, place, log, first, last + 1, u + 1)
    elif turned:
        _turn(tour, back, place, log, u + 1, last)
        _turn(tour, back, place, log, last - behind + 1, last)
    else:
        _swap_neighbours(tour, back, place, log, u + 1, first, last + 1)


@njit
def _improve(
    node: int,
    tour: NDArray[np.int64],
    back: NDArray[np.int8],
    place: NDArray[np.int64],
    near: NDArray[np.int64],
    soonest: FloatArray,
    ends: FloatArray,
    lift: FloatArray,
    speeds: FloatArray,
    clear: FloatArray,
    grid: FloatArray,
    two_way: bool,
    log: NDArray[np.int64],
    queue: NDArray[np.int64],
    waits: NDArray[np.bool_],
) -> float:
    """The first 2-opt or Or-opt move found at a piece that shortens the tour; returns its gain, 0 if there is none."""
    n = len(tour)
    for side in range(2):  # 0: the link after the piece, 1: the one before it
        p = place[node]
        if side == 0:
            q = (p + 1) % n
            e, f = 2 * tour[p] + 1 - back[p], 2 * tour[q] + back[q]
        else:
            q = (p - 1) % n
            e, f = 2 * tour[p] + back[p], 2 * tour[q] + 1 - back[q]
        old = link_s(e, f, ends, lift, speeds, clear, grid)
        if old <= _GAIN:
            continue
        for k in range(near.shape[1]):
            if soonest[e, k] >= old - _GAIN:
                break
            other = near[e, k]
            r = place[other]
            if r in (p, q):
                continue
            # 2-opt: e to the like end of the other piece, and the two that are left to each other
            if two_way:
                if side == 0:
                    s = (r + 1) % n
                    g, h = 2 * tour[r] + 1 - back[r], 2 * tour[s] + back[s]
                else:
                    s = (r - 1) % n
                    g, h = 2 * tour[r] + back[r], 2 * tour[s] + 1 - back[s]
                new = link_s(e, g, ends, lift, speeds, clear, grid)
                if new < old - _GAIN:
                    gain = old - new + link_s(g, h, ends, lift, speeds, clear, grid)
                    gain -= link_s(f, h, ends, lift, speeds, clear, grid)
                    if gain > _GAIN:
                        for m in (p, q, r, s):
                            _push(queue, waits, tour[m])
                        if side == 0:
                            _turn_shorter(tour, back, place, log, q, r)
                        else:
                            _turn_shorter(tour, back, place, log, r, q)
                        return gain
            # Or-opt: one to three pieces beginning at the other one come between e and f
            for way in range(2):  # 0: they keep their direction along the tour, 1: they are turned
                if way == 1 and not two_way:
                    continue
                for size in range(1, 4):
                    # the piece next to e is `other`; the others follow on the side away from e
                    forward = (side == 0) == (way == 0)
                    first = r if forward else (r - size + 1) % n
                    last = (first + size - 1) % n
                    if (p - first) % n < size or (q - first) % n < size:
                        break
                    before, after = (first - 1) % n, (last + 1) % n
                    if (before, after) == (q, p) or n < size + 4:
                        break
                    fe, le = 2 * tour[first] + back[first], 2 * tour[last] + 1 - back[last]
                    g, h = (fe, le) if forward else (le, fe)
                    new = link_s(e, g, ends, lift, speeds, clear, grid)
                    if new >= old - _GAIN:
                        break
                    b, a = 2 * tour[before] + 1 - back[before], 2 * tour[after] + back[after]
                    gain = old - new - link_s(h, f, ends, lift, speeds, clear, grid)
                    gain += link_s(b, fe, ends, lift, speeds, clear, grid)
                    gain += link_s(le, a, ends, lift, speeds, clear, grid)
                    gain -= link_s(b, a, ends, lift, speeds, clear, grid)
                    if gain <= _GAIN:
                        continue
                    for m in (p, q, first, last, before, after):
                        _push(queue, waits, tour[m])
                    # the gap between positions u and u + 1 takes them in
                    u = p if side == 0 else q
                    _insert(tour, back, place, log, first, last, u, way == 1)
                    return gain
    return 0.0


@njit
def _settle(
    tour: NDArray[np.int64],
    back: NDArray[np.int8],
    place: NDArray[np.int64],
    near: NDArray[np.int64],
    soonest: FloatArray,
    ends: FloatArray,
    lift: FloatArray,
    speeds: FloatArray,
    clear: FloatArray,
    grid: FloatArray,
    two_way: bool,
    log: NDArray[np.int64],
    queue: NDArray[np.int64],
    waits: NDArray[np.bool_],
) -> float:
    """Improve until no piece in the queue has a move left; returns the gain."""
    total = 0.0
    n_ends = ends.shape[0]
    while queue[1] > 0:
        node = _pop(queue, waits)
        if 2 * node >= n_ends:
            continue
        for _ in range(_MOST_MOVES):
            gain = _improve(
                node, tour, back, place, near, soonest, ends, lift, speeds, clear, grid, two_way, log, queue, waits
            )
            if gain <= 0.0:
                break
            total += gain
    return total


@njit
def local_search(
    tour: NDArray[np.int64],
    back: NDArray[np.int8],
    near: NDArray[np.int64],
    soonest: FloatArray,
    ends: FloatArray,
    lift: FloatArray,
    speeds: FloatArray,
    clear: FloatArray,
    grid: FloatArray,
    two_way: bool,
) -> float:
    """2-opt and Or-opt from a closed tour until nothing is gained, in place; returns the gain, s.

    ``near`` has a row of pieces for each end, nearest first, ``soonest`` the least time of a link to them. The dummy is
    piece ``len(tour) - 1``.
    """
    n = len(tour)
    place, queue, waits, log = _state(tour)
    for k in range(n):
        _push(queue, waits, tour[k])
    return _settle(tour, back, place, near, soonest, ends, lift, speeds, clear, grid, two_way, log, queue, waits)


@njit
def _state(
    tour: NDArray[np.int64],
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_], NDArray[np.int64]]:
    n = len(tour)
    place = np.empty(n, dtype=np.int64)
    for k in range(n):
        place[tour[k]] = k
    return place, np.zeros(n + 3, dtype=np.int64), np.zeros(n, dtype=np.bool_), np.zeros(4001, dtype=np.int64)


@njit
def iterate(
    random: int,
    iterations: int,
    tour: NDArray[np.int64],
    back: NDArray[np.int8],
    near: NDArray[np.int64],
    soonest: FloatArray,
    ends: FloatArray,
    lift: FloatArray,
    speeds: FloatArray,
    clear: FloatArray,
    grid: FloatArray,
    two_way: bool,
) -> tuple[float, int]:
    """Iterated local search: double-bridges of neighbouring stretches, each kept if it ends shorter, else taken back.

    Args:
        random: state of the generator (Park and Miller's, 1 to 2^31 - 2); to be handed on.

    Returns:
        The gain in s, and the generator's next state.
    """
    n = len(tour)
    place, queue, waits, log = _state(tour)
    longest = min(_MOST_SEGMENT, (n - 2) // 3)
    total = 0.0
    if longest < 1:
        return total, random
    for _ in range(iterations):
        random = random * 48271 % 2147483647
        a = random % n
        random = random * 48271 % 2147483647
        b = a + 1 + random % longest
        random = random * 48271 % 2147483647
        c = b + 1 + random % longest
        pa, ia, ib, ib0, ic, ic0 = (a - 1) % n, a, b % n, (b - 1) % n, c % n, (c - 1) % n
        la, fa = 2 * tour[pa] + 1 - back[pa], 2 * tour[ia] + back[ia]
        lb, fb = 2 * tour[ib0] + 1 - back[ib0], 2 * tour[ib] + back[ib]
        lc, fc = 2 * tour[ic0] + 1 - back[ic0], 2 * tour[ic] + back[ic]
        gain = link_s(la, fa, ends, lift, speeds, clear, grid) + link_s(lb, fb, ends, lift, speeds, clear, grid)
        gain += link_s(lc, fc, ends, lift, speeds, clear, grid) - link_s(la, fb, ends, lift, speeds, clear, grid)
        gain -= link_s(lc, fa, ends, lift, speeds, clear, grid) + link_s(lb, fc, ends, lift, speeds, clear, grid)
        if abs(gain) > -0.5 * _FIXED:  # the link from dummy to start would go
            continue
        log[0] = 0
        for m in (pa, ia, ib0, ib, ic0, ic):
            _push(queue, waits, tour[m])
        _swap_neighbours(tour, back, place, log, ia, ib, ic)
        gain += _settle(tour, back, place, near, soonest, ends, lift, speeds, clear, grid, two_way, log, queue, waits)
        if gain >= -1e-12 or 2 * log[0] + 2 >= len(log):
            total += gain
            continue
        for k in range(log[0] - 1, -1, -1):
            _reverse(tour, back, place, log[1 + 2 * k], log[2 + 2 * k])
    return total, random
