"""Lower envelope of moving tools over a grid of vertical dexels; compiled.

Heights are cut block by block, 8 x 8 dexels each, with the block's largest height kept beside: a block that the tool
passes above is left after one comparison. Each dexel takes the smallest of its height and the sweep's, so order and
parts do not matter. ``tool`` is `twin.tools.shape.ToolShape.parameters`: disc, corner, tan(taper), arc radius, arc
height, height, radius.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import njit

#: Dexels along a block's side.
BLOCK = 8


@njit
def _profile(tool: FloatArray, rho: float) -> float:
    """Height of the tool's surface above the tip at a distance from the axis, at most the radius."""
    if rho <= tool[0]:
        return 0.0
    if rho <= tool[3]:
        d = rho - tool[0]
        return tool[1] - math.sqrt(max(0.0, tool[1] * tool[1] - d * d))
    if tool[2] > 0.0:
        return tool[4] + (rho - tool[3]) / tool[2]
    return tool[4]


@njit
def _lean(tool: FloatArray, rho: float) -> float:
    """Slope of the meridian at a distance from the axis, up to the radius."""
    if rho <= tool[0]:
        return 0.0
    if rho < tool[3]:
        d = rho - tool[0]
        rest = tool[1] * tool[1] - d * d
        return d / math.sqrt(rest) if rest > 0.0 else math.inf
    return 1.0 / tool[2] if tool[2] > 0.0 else math.inf


@njit
def _resting_place(tool: FloatArray, slope: float, q: float, limit: float) -> float:
    """S in [0, limit] with the largest slope s - h(sqrt(q q + s s)), slope >= 0 and h the convex meridian.

    On the corner arc the angle kappa of the normal is found by Newton steps kept in a bracket; elsewhere it is closed.
    """
    disc, corner, tangent, arc = tool[0], tool[1], tool[2], tool[3]
    flat = math.sqrt(max(0.0, disc * disc - q * q))
    if slope == 0.0:
        return 0.0
    if q < arc and corner > 0.0:
        end = math.sqrt(arc * arc - q * q)
        wall = math.inf if tangent == 0.0 else 1.0 / tangent
        if wall * end / arc >= slope:
            # with t = tan(kappa): t s = slope rho, rho = disc + corner t / sqrt(1 + t t), s = sqrt(rho rho - q q)
            sine = max(0.0, (q - disc) / corner)
            low, high = slope, wall
            if sine > 0.0:
                low = max(slope, sine / math.sqrt(max(1e-300, 1.0 - sine * sine)))
            t = low * (1.0 + 1e-3) if sine > 0.0 else low
            s = 0.0
            for _ in range(80):
                root = math.sqrt(1.0 + t * t)
                rho = disc + corner * t / root
                s = math.sqrt(max(0.0, rho * rho - q * q))
                value = t * s - slope * rho
                if value > 0.0:
                    high = min(high, t)
                else:
                    low = max(low, t)
                following = -1.0
                if s > 0.0:
                    turn = corner / (root * root * root)
                    rise = s + t * rho * turn / s - slope * turn
                    if rise > 0.0:
                        following = t - value / rise
                if not low <= following <= high:
                    following = 0.5 * (low + high) if high < math.inf else 2.0 * low
                done = abs(following - t) <= 1e-9 * t
                t = following
                if done:
                    break
            rho = disc + corner * t / math.sqrt(1.0 + t * t)
            return min(limit, math.sqrt(max(0.0, rho * rho - q * q)))
        flat = end
    if tangent > 0.0:
        wall = 1.0 / tangent
        if slope < wall:
            return min(limit, max(flat, slope * q / math.sqrt(wall * wall - slope * slope)))
        return limit
    return min(limit, flat)


@njit
def block_maxima(heights: FloatArray, maxima: FloatArray) -> None:
    """Largest height of every block, shape (blocks along x, blocks along y)."""
    for i in range(maxima.shape[0]):
        for j in range(maxima.shape[1]):
            maxima[i, j] = heights[i * BLOCK : (i + 1) * BLOCK, j * BLOCK : (j + 1) * BLOCK].max()


@njit
def _ball_block(
    heights: FloatArray,
    i0: int,
    i1: int,
    j0: int,
    j1: int,
    ex0: float,
    ey0: float,
    pitch_x: float,
    pitch_y: float,
    dx: float,
    dy: float,
    dz: float,
    centre: float,
    radius: float,
    bottom: float,
    largest: FloatArray,
) -> None:
    """Cut one block by a ball on a line; e is the first dexel seen from the start, ``centre`` the ball's start height.

    The ball's lower side over a dexel is the least of centre + dz t - sqrt(rest - S (t - middle)^2); S the square of
    the level length, rest that of half the chord of the swept disc. Its minimum lies at ``best``.
    """
    square = dx * dx + dy * dy
    inverse = 1.0 / square if square > 0.0 else 0.0
    root_inverse = math.sqrt(inverse)
    lead = dz * math.sqrt(inverse / (square + dz * dz)) if square > 0.0 else 0.0
    if square == 0.0:
        centre = centre + min(0.0, dz)
        dz = 0.0
    r2 = radius * radius
    for i in range(i1 - i0):
        row = heights[i0 + i][j0:j1]
        ex = ex0 + i * pitch_x
        for j in range(len(row)):
            ey = ey0 + j * pitch_y
            cross = ex * dy - ey * dx
            away = cross * cross * inverse if square > 0.0 else ex * ex + ey * ey
            rest = r2 - away
            inside = max(rest, 0.0)
            root = math.sqrt(inside)
            middle = (ex * dx + ey * dy) * inverse
            first = max(0.0, middle - root * root_inverse)
            last = min(1.0, middle + root * root_inverse)
            t = min(max(middle - lead * root, first), last)
            off = t - middle
            z = max(bottom, centre + dz * t - math.sqrt(max(0.0, inside - square * off * off)))
            old = row[j]
            new = z if (rest >= 0.0) & (first <= last) & (z < old) else old
            row[j] = new
            largest[j] = max(largest[j], new)


@njit
def _flat_block(
    heights: FloatArray,
    i0: int,
    i1: int,
    j0: int,
    j1: int,
    ex0: float,
    ey0: float,
    pitch_x: float,
    pitch_y: float,
    dx: float,
    dy: float,
    dz: float,
    tip: float,
    radius: float,
    bottom: float,
    largest: FloatArray,
) -> None:
    """Cut one block by a flat tool on a line: the lower end of the time in which its disc covers the dexel."""
    square = dx * dx + dy * dy
    inverse = 1.0 / square if square > 0.0 else 0.0
    if square == 0.0:
        tip = tip + min(0.0, dz)
        dz = 0.0
    r2 = radius * radius
    for i in range(i1 - i0):
        row = heights[i0 + i][j0:j1]
        ex = ex0 + i * pitch_x
        for j in range(len(row)):
            ey = ey0 + j * pitch_y
            cross = ex * dy - ey * dx
            away = cross * cross * inverse if square > 0.0 else ex * ex + ey * ey
            rest = r2 - away
            half = math.sqrt(max(rest, 0.0) * inverse)
            middle = (ex * dx + ey * dy) * inverse
            first = max(0.0, middle - half)
            last = min(1.0, middle + half)
            z = max(bottom, tip + dz * (first if dz > 0.0 else last))
            old = row[j]
            new = z if (rest >= 0.0) & (first <= last) & (z < old) else old
            row[j] = new
            largest[j] = max(largest[j], new)


@njit
def _round_block(
    heights: FloatArray,
    i0: int,
    i1: int,
    j0: int,
    j1: int,
    ex0: float,
    ey0: float,
    pitch_x: float,
    pitch_y: float,
    dx: float,
    dy: float,
    dz: float,
    tip: float,
    tool: FloatArray,
    bottom: float,
    largest: FloatArray,
) -> None:
    """Cut one block by any tool on a line; the place along it is searched only where the sweep can be low enough."""
    square = dx * dx + dy * dy
    length = math.sqrt(square)
    radius = tool[6]
    for i in range(i1 - i0):
        row = heights[i0 + i][j0:j1]
        ex = ex0 + i * pitch_x
        for j in range(len(row)):
            ey = ey0 + j * pitch_y
            old = row[j]
            largest[j] = max(largest[j], old)
            if square == 0.0:
                away = math.sqrt(ex * ex + ey * ey)
                if away <= radius:
                    row[j] = min(old, max(bottom, tip + min(0.0, dz) + _profile(tool, away)))
                continue
            q = abs(ex * dy - ey * dx) / length
            rest = radius * radius - q * q
            if rest < 0.0:
                continue
            root = math.sqrt(rest)
            foot = (ex * dx + ey * dy) / length
            # places s from the foot of the dexel on the line
            low, high = max(-foot, -root), min(length - foot, root)
            if low > high:
                continue
            slope = dz / length
            nearest = min(max(0.0, low), high)
            floor = tip + (foot + (low if dz > 0.0 else high)) * slope
            if floor + _profile(tool, min(radius, math.sqrt(q * q + nearest * nearest))) >= old:
                continue
            s = nearest
            if dz != 0.0:
                # the height along the line is convex: on a short line it most often falls or rises all the way
                rho = math.sqrt(q * q + low * low)
                if rho > 0.0 and slope + _lean(tool, rho) * low / rho >= 0.0:
                    s = low
                else:
                    rho = math.sqrt(q * q + high * high)
                    if rho > 0.0 and slope + _lean(tool, rho) * high / rho <= 0.0:
                        s = high
                    else:
                        s = _resting_place(tool, abs(slope), q, root)
                        s = min(max(-s if slope > 0.0 else s, low), high)
            z = tip + (foot + s) * slope + _profile(tool, min(radius, math.sqrt(q * q + s * s)))
            if z < old:
                row[j] = max(bottom, z)


@njit
def _reached(
    maxima: FloatArray,
    near: NDArray[np.bool_],
    bottom: int,
    top: int,
    ex: float,
    ey0: float,
    side_y: float,
    dx: float,
    dy: float,
    dz: float,
    z0: float,
    inverse: float,
    window: float,
    diagonal: float,
    underside: float,
    tool: FloatArray,
) -> None:
    """Which blocks of one row a tool on a line may reach: those nearer than its radius at the block's largest height.

    Args:
        maxima: largest height of each block of the row.
        near: filled from ``bottom`` to ``top``.
        ex, ey0: centre of the row's first block, seen from the start.
        inverse: 1 / square of the level length, 0 for none.
        window: part of the line within which the tool's reach covers some of a block.
    """
    down = min(0.0, dz) if inverse == 0.0 else 0.0
    for j in range(bottom, top + 1):
        ey = ey0 + j * side_y
        middle = (ex * dx + ey * dy) * inverse
        t = min(max(middle, 0.0), 1.0)
        off_x, off_y = ex - t * dx, ey - t * dy
        at = middle - window if dz > 0.0 else middle + window
        lowest = z0 + down + (dz * min(max(at, 0.0), 1.0) if inverse > 0.0 else 0.0)
        over = maxima[j] - lowest
        arc = min(max(over, 0.0), tool[4])
        wide = tool[0] + math.sqrt(max(0.0, arc * (2.0 * tool[1] - arc))) + max(0.0, over - tool[4]) * tool[2]
        reach = min(wide, tool[6]) + diagonal
        away = off_x * off_x + off_y * off_y
        near[j] = (over > 0.0) & (maxima[j] > underside) & (away <= reach * reach)


@njit
def cut_lines(
    heights: FloatArray,
    maxima: FloatArray,
    frame: FloatArray,
    underside: float,
    tool: FloatArray,
    starts: FloatArray,
    ends: FloatArray,
    first_band: int,
    last_band: int,
) -> None:
    """Cut the blocks of rows ``first_band`` to ``last_band - 1`` by a tool on straight lines.

    Args:
        heights: shape (nx, ny), in place.
        maxima: shape (blocks along x, blocks along y), largest height of each block, kept.
        frame: x and y of the first dexel, pitch along x and y.
        underside: height that no dexel goes below.
        starts, ends: shape (k, 3), tool tip.
    """
    radius = tool[6]
    ball = tool[0] == 0.0 and tool[2] == 0.0
    flat = tool[1] == 0.0 and tool[2] == 0.0
    side_x, side_y = BLOCK * frame[2], BLOCK * frame[3]
    reach_x, reach_y = 0.5 * (BLOCK - 1) * frame[2], 0.5 * (BLOCK - 1) * frame[3]
    diagonal = math.hypot(reach_x, reach_y) * (1.0 + 1e-12)
    largest = np.empty(BLOCK)
    near = np.empty(maxima.shape[1], dtype=np.bool_)
    for k in range(len(starts)):
        x0, y0, z0 = starts[k, 0], starts[k, 1], starts[k, 2]
        dx, dy, dz = ends[k, 0] - x0, ends[k, 1] - y0, ends[k, 2] - z0
        left = max(first_band, int(math.floor((x0 + min(0.0, dx) - radius - frame[0]) / side_x)))
        right = min(last_band - 1, int(math.floor((x0 + max(0.0, dx) + radius - frame[0]) / side_x)))
        bottom = max(0, int(math.floor((y0 + min(0.0, dy) - radius - frame[1]) / side_y)))
        top = min(maxima.shape[1] - 1, int(math.floor((y0 + max(0.0, dy) + radius - frame[1]) / side_y)))
        square = dx * dx + dy * dy
        inverse = 1.0 / square if square > 0.0 else 0.0
        window = (radius + diagonal) * math.sqrt(inverse)
        for i in range(left, right + 1):
            ex0 = frame[0] + i * side_x - x0
            _reached(
                maxima[i],
                near,
                bottom,
                top,
                ex0 + reach_x,
                frame[1] + reach_y - y0,
                side_y,
                dx,
                dy,
                dz,
                z0,
                inverse,
                window,
                diagonal,
                underside,
                tool,
            )
            for j in range(bottom, top + 1):
                if not near[j]:
                    continue
                ey0 = frame[1] + j * side_y - y0
                i0, i1 = i * BLOCK, min((i + 1) * BLOCK, heights.shape[0])
                j0, j1 = j * BLOCK, min((j + 1) * BLOCK, heights.shape[1])
                largest[:] = -math.inf
                if ball:
                    _ball_block(
                        heights,
                        i0,
                        i1,
                        j0,
                        j1,
                        ex0,
                        ey0,
                        frame[2],
                        frame[3],
                        dx,
                        dy,
                        dz,
                        z0 + radius,
                        radius,
                        underside,
                        largest,
                    )
                elif flat:
                    _flat_block(
                        heights,
                        i0,
                        i1,
                        j0,
                        j1,
                        ex0,
                        ey0,
                        frame[2],
                        frame[3],
                        dx,
                        dy,
                        dz,
                        z0,
                        radius,
                        underside,
                        largest,
                    )
                else:
                    _round_block(
                        heights, i0, i1, j0, j1, ex0, ey0, frame[2], frame[3], dx, dy, dz, z0, tool, underside, largest
                    )
                maxima[i, j] = largest.max()


@njit
def cut_arcs(
    heights: FloatArray,
    maxima: FloatArray,
    frame: FloatArray,
    underside: float,
    tool: FloatArray,
    arcs: FloatArray,
    first_band: int,
    last_band: int,
) -> None:
    """The same for level arcs: a tool at one height stands nearest to a dexel where the arc does.

    Args:
        arcs: shape (k, 8): centre x, y, tip z, radius of the path, start angle, signed sweep, x and y of the end.
    """
    radius = tool[6]
    side_x, side_y = BLOCK * frame[2], BLOCK * frame[3]
    reach_x, reach_y = 0.5 * (BLOCK - 1) * frame[2], 0.5 * (BLOCK - 1) * frame[3]
    diagonal = math.hypot(reach_x, reach_y) * (1.0 + 1e-12)
    for k in range(len(arcs)):
        cx, cy, z0, path = arcs[k, 0], arcs[k, 1], arcs[k, 2], arcs[k, 3]
        begin, sweep = arcs[k, 4], arcs[k, 5]
        sx, sy = cx + path * math.cos(begin), cy + path * math.sin(begin)
        ex, ey = arcs[k, 6], arcs[k, 7]
        low_x, high_x, low_y, high_y = min(sx, ex), max(sx, ex), min(sy, ey), max(sy, ey)
        for quarter in range(4):
            turn = quarter * 0.5 * math.pi - begin
            turn = turn % (2.0 * math.pi) if sweep > 0.0 else (-turn) % (2.0 * math.pi)
            if turn <= abs(sweep):
                if quarter == 0:
                    high_x = cx + path
                elif quarter == 1:
                    high_y = cy + path
                elif quarter == 2:
                    low_x = cx - path
                else:
                    low_y = cy - path
        left = max(first_band, int(math.floor((low_x - radius - frame[0]) / side_x)))
        right = min(last_band - 1, int(math.floor((high_x + radius - frame[0]) / side_x)))
        bottom = max(0, int(math.floor((low_y - radius - frame[1]) / side_y)))
        top = min(maxima.shape[1] - 1, int(math.floor((high_y + radius - frame[1]) / side_y)))
        for i in range(left, right + 1):
            for j in range(bottom, top + 1):
                old = maxima[i, j]
                if old <= underside or old <= z0:
                    continue
                x, y = frame[0] + i * side_x + reach_x, frame[1] + j * side_y + reach_y
                if abs(math.hypot(x - cx, y - cy) - path) > radius + diagonal:
                    continue
                near = max(0.0, _from_arc(x, y, cx, cy, path, begin, sweep, sx, sy, ex, ey) - diagonal)
                if near > radius or z0 + _profile(tool, near) >= old:
                    continue
                largest = -math.inf
                for a in range(i * BLOCK, min((i + 1) * BLOCK, heights.shape[0])):
                    for b in range(j * BLOCK, min((j + 1) * BLOCK, heights.shape[1])):
                        if heights[a, b] > z0:
                            x, y = frame[0] + a * frame[2], frame[1] + b * frame[3]
                            off = _from_arc(x, y, cx, cy, path, begin, sweep, sx, sy, ex, ey)
                            if off <= radius:
                                heights[a, b] = min(heights[a, b], max(underside, z0 + _profile(tool, off)))
                        largest = max(largest, heights[a, b])
                maxima[i, j] = largest


@njit
def _from_arc(
    x: float,
    y: float,
    cx: float,
    cy: float,
    path: float,
    begin: float,
    sweep: float,
    sx: float,
    sy: float,
    ex: float,
    ey: float,
) -> float:
    """Distance of a point from an arc in the plan."""
    ends = math.sqrt(min((x - sx) ** 2 + (y - sy) ** 2, (x - ex) ** 2 + (y - ey) ** 2))
    turn = math.atan2(y - cy, x - cx) - begin
    turn = turn % (2.0 * math.pi) if sweep > 0.0 else (-turn) % (2.0 * math.pi)
    if turn <= abs(sweep):
        return min(ends, abs(math.hypot(x - cx, y - cy) - path))
    return ends


@njit
def rest_heights(
    heights: FloatArray,
    maxima: FloatArray,
    frame: FloatArray,
    tool: FloatArray,
    points: FloatArray,
    first: int,
    last: int,
    out: FloatArray,
) -> None:
    """Tip height over points ``first`` to ``last - 1`` at which a tool coming down touches the first dexel.

    Args:
        points: shape (m, 2).
        out: shape (m,), filled; -inf where no dexel lies below the tool.
    """
    radius = tool[6]
    side_x, side_y = BLOCK * frame[2], BLOCK * frame[3]
    wide_x, wide_y = (BLOCK - 1) * frame[2], (BLOCK - 1) * frame[3]
    # the dexel that held the tool at the last point most often nearly holds it at the next
    last_a, last_b = 0, 0
    for k in range(first, last):
        px, py = points[k, 0], points[k, 1]
        best = -math.inf
        away = (frame[0] + last_a * frame[2] - px) ** 2 + (frame[1] + last_b * frame[3] - py) ** 2
        if away <= radius * radius:
            best = heights[last_a, last_b] - _profile(tool, math.sqrt(away))
        left = max(0, int(math.floor((px - radius - frame[0]) / side_x)))
        right = min(maxima.shape[0] - 1, int(math.floor((px + radius - frame[0]) / side_x)))
        bottom = max(0, int(math.floor((py - radius - frame[1]) / side_y)))
        top = min(maxima.shape[1] - 1, int(math.floor((py + radius - frame[1]) / side_y)))
        for at in range((right - left + 1) * (top - bottom + 1)):
            i, j = left + at // (top - bottom + 1), bottom + at % (top - bottom + 1)
            if maxima[i, j] <= best:
                continue
            gap_x = max(0.0, frame[0] + i * side_x - px, px - frame[0] - i * side_x - wide_x)
            gap_y = max(0.0, frame[1] + j * side_y - py, py - frame[1] - j * side_y - wide_y)
            near = gap_x * gap_x + gap_y * gap_y
            if near > radius * radius:
                continue
            if maxima[i, j] - _profile(tool, math.sqrt(near)) <= best:
                continue
            for a in range(i * BLOCK, min((i + 1) * BLOCK, heights.shape[0])):
                for b in range(j * BLOCK, min((j + 1) * BLOCK, heights.shape[1])):
                    if heights[a, b] <= best:
                        continue
                    away = (frame[0] + a * frame[2] - px) ** 2 + (frame[1] + b * frame[3] - py) ** 2
                    if away <= radius * radius:
                        tip = heights[a, b] - _profile(tool, math.sqrt(away))
                        if tip > best:
                            best, last_a, last_b = tip, a, b
        out[k] = best


@njit
def thinned(points: FloatArray, spacing: float, chosen: NDArray[np.bool_]) -> None:
    """Choose points, in their order, that stand at least ``spacing`` from all chosen before.

    Args:
        points: shape (m, 2).
        chosen: shape (m,), filled.
    """
    if len(points) == 0:
        return
    low_x, low_y = points[:, 0].min(), points[:, 1].min()
    columns = int((points[:, 0].max() - low_x) / spacing) + 1
    rows = int((points[:, 1].max() - low_y) / spacing) + 1
    head = np.full(columns * rows, -1, dtype=np.int64)
    following = np.full(len(points), -1, dtype=np.int64)
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        column = min(columns - 1, int((x - low_x) / spacing))
        row = min(rows - 1, int((y - low_y) / spacing))
        free = True
        for c in range(max(0, column - 1), min(columns, column + 2)):
            for r in range(max(0, row - 1), min(rows, row + 2)):
                other = head[c * rows + r]
                while other >= 0 and free:
                    if (points[other, 0] - x) ** 2 + (points[other, 1] - y) ** 2 < spacing * spacing:
                        free = False
                    other = following[other]
        chosen[k] = free
        if free:
            cell = column * rows + row
            following[k] = head[cell]
            head[cell] = k
