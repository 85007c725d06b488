"""Lower envelope of moving tools over a grid of vertical dexels; compiled.

Heights are cut block by block, 8 x 8 dexels each. The largest height of every block is kept as well: a block that the
tool passes above is skipped after one comparison. Each dexel takes the smaller of its height and the sweep's, so the
order of strokes and their division do not matter.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import helper, njit
from twin.tools.meridian import Meridian
from twin.tools.meridian_kernels import is_ball, is_flat, profile_height, profile_slope, resting_offset

#: Dexels along a block's side.
BLOCK = 8


class Grid(NamedTuple):
    """Positions of dexels and blocks, mm.

    Attributes:
        x, y: position of the first dexel.
        pitch_x, pitch_y: distance of dexels.
        floor: height that no dexel goes below.
        side_x, side_y: sides of a block.
        half_x, half_y: from a block's first dexel to its middle.
        half_diagonal: half the distance of a block's opposite corners.
    """

    x: float
    y: float
    pitch_x: float
    pitch_y: float
    floor: float
    side_x: float
    side_y: float
    half_x: float
    half_y: float
    half_diagonal: float


class Stock(NamedTuple):
    """A dexel model.

    Attributes:
        heights: shape (nx, ny), changed in place.
        maxima: shape (blocks along x, blocks along y), largest height of each block.
        grid: where the dexels are.
    """

    heights: FloatArray
    maxima: FloatArray
    grid: Grid


class _Stroke(NamedTuple):
    """A straight motion of the tip: start and vector."""

    x: float
    y: float
    z: float
    dx: float
    dy: float
    dz: float


class _Block(NamedTuple):
    """Dexels i0 to i1 - 1, j0 to j1 - 1; where the first of them lies as seen from a stroke's start; their pitch."""

    i0: int
    i1: int
    j0: int
    j1: int
    ex: float
    ey: float
    pitch_x: float
    pitch_y: float
    floor: float


class _Arc(NamedTuple):
    """A level arc of the tip; sweep is signed."""

    x: float
    y: float
    z: float
    radius: float
    begin: float
    sweep: float
    start_x: float
    start_y: float
    end_x: float
    end_y: float


@njit
def grid_of(x: float, y: float, pitch_x: float, pitch_y: float, floor: float) -> Grid:
    """A grid, with the sizes of its blocks."""
    half_x, half_y = 0.5 * (BLOCK - 1) * pitch_x, 0.5 * (BLOCK - 1) * pitch_y
    half_diagonal = math.hypot(half_x, half_y) * (1.0 + 1e-12)
    return Grid(x, y, pitch_x, pitch_y, floor, BLOCK * pitch_x, BLOCK * pitch_y, half_x, half_y, half_diagonal)


@njit
def block_maxima(heights: FloatArray, maxima: FloatArray) -> None:
    """Largest height of every block, shape (blocks along x, blocks along y)."""
    for i in range(maxima.shape[0]):
        for j in range(maxima.shape[1]):
            maxima[i, j] = heights[i * BLOCK : (i + 1) * BLOCK, j * BLOCK : (j + 1) * BLOCK].max()


@helper
def _number(length: float, side: float) -> int:
    """Number of the block in which a length from the first dexel lies."""
    return int(math.floor(length / side))


@helper
def _stroke(starts: FloatArray, ends: FloatArray, k: int) -> _Stroke:
    x, y, z = starts[k, 0], starts[k, 1], starts[k, 2]
    return _Stroke(x, y, z, ends[k, 0] - x, ends[k, 1] - y, ends[k, 2] - z)


@helper
def _block(shape: tuple[int, int], grid: Grid, stroke: _Stroke, i: int, j: int) -> _Block:
    return _Block(
        i * BLOCK,
        min((i + 1) * BLOCK, shape[0]),
        j * BLOCK,
        min((j + 1) * BLOCK, shape[1]),
        grid.x + i * grid.side_x - stroke.x,
        grid.y + j * grid.side_y - stroke.y,
        grid.pitch_x,
        grid.pitch_y,
        grid.floor,
    )


@njit
def cut_lines(
    stock: Stock, tool: Meridian, starts: FloatArray, ends: FloatArray, first_band: int, last_band: int
) -> None:
    """Cut the blocks of rows ``first_band`` to ``last_band - 1`` by a tool on straight lines.

    Args:
        starts, ends: shape (k, 3), tool tip.
    """
    heights, maxima, grid = stock.heights, stock.maxima, stock.grid
    radius, ball, flat = tool.radius, is_ball(tool), is_flat(tool)
    largest = np.empty(BLOCK)
    reached = np.empty(maxima.shape[1], dtype=np.bool_)
    for k in range(len(starts)):
        stroke = _stroke(starts, ends, k)
        left = max(first_band, _number(stroke.x + min(0.0, stroke.dx) - radius - grid.x, grid.side_x))
        right = min(last_band - 1, _number(stroke.x + max(0.0, stroke.dx) + radius - grid.x, grid.side_x))
        bottom = max(0, _number(stroke.y + min(0.0, stroke.dy) - radius - grid.y, grid.side_y))
        top = min(maxima.shape[1] - 1, _number(stroke.y + max(0.0, stroke.dy) + radius - grid.y, grid.side_y))
        for i in range(left, right + 1):
            _mark_reached(maxima[i], grid, tool, stroke, (i, bottom, top), reached)
            for j in range(bottom, top + 1):
                if not reached[j]:
                    continue
                block = _block(heights.shape, grid, stroke, i, j)
                largest[:] = -math.inf
                if ball:
                    _cut_by_ball(heights, block, stroke, radius, largest)
                elif flat:
                    _cut_by_flat(heights, block, stroke, radius, largest)
                else:
                    _cut_by_any(heights, block, stroke, tool, largest)
                maxima[i, j] = largest.max()


@helper
def _mark_reached(
    maxima: FloatArray,
    grid: Grid,
    tool: Meridian,
    stroke: _Stroke,
    blocks: tuple[int, int, int],
    reached: NDArray[np.bool_],
) -> None:
    """Which blocks of a row a tool on a line may reach: those nearer than its radius at the block's largest height.

    Args:
        maxima: largest height of each block of the row.
        blocks: number of the row, its first block and its last.
        reached: filled from the first block to the last.
    """
    i, bottom, top = blocks
    disc, corner, tangent, arc_height, radius = tool.disc, tool.corner, tool.tangent, tool.arc_height, tool.radius
    z, dx, dy, dz = stroke.z, stroke.dx, stroke.dy, stroke.dz
    floor, half_diagonal = grid.floor, grid.half_diagonal
    square = dx * dx + dy * dy
    inverse = 1.0 / square if square > 0.0 else 0.0
    # centre of the row's first block, seen from the start
    ex = grid.x + i * grid.side_x - stroke.x + grid.half_x
    ey0 = grid.y + grid.half_y - stroke.y
    # part of the line within which the tool's reach covers some of a block
    window = (radius + half_diagonal) * math.sqrt(inverse)
    down = min(0.0, dz) if inverse == 0.0 else 0.0
    for j in range(bottom, top + 1):
        ey = ey0 + j * grid.side_y
        middle = (ex * dx + ey * dy) * inverse
        t = min(max(middle, 0.0), 1.0)
        off_x, off_y = ex - t * dx, ey - t * dy
        at = middle - window if dz > 0.0 else middle + window
        lowest = z + down + (dz * min(max(at, 0.0), 1.0) if inverse > 0.0 else 0.0)
        over = maxima[j] - lowest
        arc = min(max(over, 0.0), arc_height)
        wide = disc + math.sqrt(max(0.0, arc * (2.0 * corner - arc))) + max(0.0, over - arc_height) * tangent
        reach = min(wide, radius) + half_diagonal
        away = off_x * off_x + off_y * off_y
        reached[j] = (over > 0.0) & (maxima[j] > floor) & (away <= reach * reach)


@helper
def _cut_by_ball(heights: FloatArray, block: _Block, stroke: _Stroke, radius: float, largest: FloatArray) -> None:
    """Cut one block by a ball on a line.

    The ball's lower side over a dexel is the least of centre + dz t - sqrt(rest - S (t - middle)^2); S the square of
    the level length, rest that of half the chord of the swept disc. The loop over dexels has no branches, so that the
    compiler can work on several at once.
    """
    i0, i1, j0, j1, ex0, ey0, pitch_x, pitch_y, floor = block
    _, _, z0, dx, dy, dz = stroke
    centre = z0 + radius
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
            z = max(floor, centre + dz * t - math.sqrt(max(0.0, inside - square * off * off)))
            old = row[j]
            new = z if (rest >= 0.0) & (first <= last) & (z < old) else old
            row[j] = new
            largest[j] = max(largest[j], new)


@helper
def _cut_by_flat(heights: FloatArray, block: _Block, stroke: _Stroke, radius: float, largest: FloatArray) -> None:
    """Cut one block by a flat tool on a line: the lower end of the time in which its disc covers the dexel."""
    i0, i1, j0, j1, ex0, ey0, pitch_x, pitch_y, floor = block
    _, _, tip, dx, dy, dz = stroke
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
            z = max(floor, tip + dz * (first if dz > 0.0 else last))
            old = row[j]
            new = z if (rest >= 0.0) & (first <= last) & (z < old) else old
            row[j] = new
            largest[j] = max(largest[j], new)


@helper
def _cut_by_any(heights: FloatArray, block: _Block, stroke: _Stroke, tool: Meridian, largest: FloatArray) -> None:
    """Cut one block by any tool on a line; the position along it is searched only where the sweep can be low enough.

    Heights before the cut are kept as the largest ones: they are bounds, and save a pass over the block.
    """
    i0, i1, j0, j1, ex0, ey0, pitch_x, pitch_y, floor = block
    _, _, tip, dx, dy, dz = stroke
    radius = tool.radius
    square = dx * dx + dy * dy
    length = math.sqrt(square)
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
                    row[j] = min(old, max(floor, tip + min(0.0, dz) + profile_height(tool, away)))
                continue
            q = abs(ex * dy - ey * dx) / length
            rest = radius * radius - q * q
            if rest < 0.0:
                continue
            root = math.sqrt(rest)
            foot = (ex * dx + ey * dy) / length
            # positions s from the foot of the dexel on the line
            low, high = max(-foot, -root), min(length - foot, root)
            if low > high:
                continue
            slope = dz / length
            nearest = min(max(0.0, low), high)
            least = tip + (foot + (low if dz > 0.0 else high)) * slope
            if least + profile_height(tool, min(radius, math.sqrt(q * q + nearest * nearest))) >= old:
                continue
            s = nearest
            if dz != 0.0:
                # the height along the line is convex: on a short line it most often falls or rises all the way
                rho_low, rho_high = math.sqrt(q * q + low * low), math.sqrt(q * q + high * high)
                if rho_low > 0.0 and slope + profile_slope(tool, rho_low) * low / rho_low >= 0.0:
                    s = low
                elif rho_high > 0.0 and slope + profile_slope(tool, rho_high) * high / rho_high <= 0.0:
                    s = high
                else:
                    s = resting_offset(tool, abs(slope), q, root)
                    s = min(max(-s if slope > 0.0 else s, low), high)
            z = tip + (foot + s) * slope + profile_height(tool, min(radius, math.sqrt(q * q + s * s)))
            if z < old:
                row[j] = max(floor, z)


@njit
def cut_arcs(stock: Stock, tool: Meridian, arcs: FloatArray, first_band: int, last_band: int) -> None:
    """The same for level arcs: a tool at one height comes closest to a dexel where the arc does.

    Args:
        arcs: shape (k, 8): centre x, y, tip z, radius of the path, start angle, signed sweep, x and y of the end.
    """
    heights, maxima, grid = stock.heights, stock.maxima, stock.grid
    radius, half_diagonal = tool.radius, grid.half_diagonal
    for k in range(len(arcs)):
        arc = _arc(arcs, k)
        low_x, high_x, low_y, high_y = _arc_box(arc)
        left = max(first_band, _number(low_x - radius - grid.x, grid.side_x))
        right = min(last_band - 1, _number(high_x + radius - grid.x, grid.side_x))
        bottom = max(0, _number(low_y - radius - grid.y, grid.side_y))
        top = min(maxima.shape[1] - 1, _number(high_y + radius - grid.y, grid.side_y))
        for i in range(left, right + 1):
            for j in range(bottom, top + 1):
                old = maxima[i, j]
                if old <= grid.floor or old <= arc.z:
                    continue
                x = grid.x + i * grid.side_x + grid.half_x
                y = grid.y + j * grid.side_y + grid.half_y
                if abs(math.hypot(x - arc.x, y - arc.y) - arc.radius) > radius + half_diagonal:
                    continue
                near = max(0.0, _from_arc(arc, x, y) - half_diagonal)
                if near <= radius and arc.z + profile_height(tool, near) < old:
                    maxima[i, j] = _cut_block_by_arc(heights, grid, tool, arc, i, j)


@helper
def _cut_block_by_arc(heights: FloatArray, grid: Grid, tool: Meridian, arc: _Arc, i: int, j: int) -> float:
    """Cut one block by a tool on a level arc; its largest height."""
    floor, radius, z = grid.floor, tool.radius, arc.z
    largest = -math.inf
    for a in range(i * BLOCK, min((i + 1) * BLOCK, heights.shape[0])):
        for b in range(j * BLOCK, min((j + 1) * BLOCK, heights.shape[1])):
            if heights[a, b] > z:
                off = _from_arc(arc, grid.x + a * grid.pitch_x, grid.y + b * grid.pitch_y)
                if off <= radius:
                    heights[a, b] = min(heights[a, b], max(floor, z + profile_height(tool, off)))
            largest = max(largest, heights[a, b])
    return largest


@helper
def _arc(arcs: FloatArray, k: int) -> _Arc:
    x, y, radius, begin = arcs[k, 0], arcs[k, 1], arcs[k, 3], arcs[k, 4]
    start_x, start_y = x + radius * math.cos(begin), y + radius * math.sin(begin)
    return _Arc(x, y, arcs[k, 2], radius, begin, arcs[k, 5], start_x, start_y, arcs[k, 6], arcs[k, 7])


@helper
def _turned(arc: _Arc, angle: float) -> float:
    """How far along the sweep a direction lies, rad in [0, 2 pi)."""
    turn = angle - arc.begin
    return turn % (2.0 * math.pi) if arc.sweep > 0.0 else (-turn) % (2.0 * math.pi)


@helper
def _arc_box(arc: _Arc) -> tuple[float, float, float, float]:
    """Least and largest x, least and largest y of an arc."""
    low_x, high_x = min(arc.start_x, arc.end_x), max(arc.start_x, arc.end_x)
    low_y, high_y = min(arc.start_y, arc.end_y), max(arc.start_y, arc.end_y)
    for quarter in range(4):
        if _turned(arc, quarter * 0.5 * math.pi) <= abs(arc.sweep):
            if quarter == 0:
                high_x = arc.x + arc.radius
            elif quarter == 1:
                high_y = arc.y + arc.radius
            elif quarter == 2:
                low_x = arc.x - arc.radius
            else:
                low_y = arc.y - arc.radius
    return low_x, high_x, low_y, high_y


@helper
def _from_arc(arc: _Arc, x: float, y: float) -> float:
    """Distance of a point from an arc in the plan."""
    ends = math.sqrt(min((x - arc.start_x) ** 2 + (y - arc.start_y) ** 2, (x - arc.end_x) ** 2 + (y - arc.end_y) ** 2))
    if _turned(arc, math.atan2(y - arc.y, x - arc.x)) <= abs(arc.sweep):
        return min(ends, abs(math.hypot(x - arc.x, y - arc.y) - arc.radius))
    return ends


@njit
def rest_heights(stock: Stock, tool: Meridian, points: FloatArray, first: int, last: int, out: FloatArray) -> None:
    """Tip height over points ``first`` to ``last - 1`` at which a tool coming down touches the first dexel.

    Args:
        points: shape (m, 2).
        out: shape (m,), filled; -inf where no dexel lies below the tool.
    """
    heights, maxima, grid = stock.heights, stock.maxima, stock.grid
    low_x, low_y, pitch_x, pitch_y, side_x, side_y = (
        grid.x,
        grid.y,
        grid.pitch_x,
        grid.pitch_y,
        grid.side_x,
        grid.side_y,
    )
    wide_x, wide_y, radius = 2.0 * grid.half_x, 2.0 * grid.half_y, tool.radius
    # the dexel that held the tool at the last point most often nearly holds it at the next
    last_a, last_b = 0, 0
    for k in range(first, last):
        x, y = points[k, 0], points[k, 1]
        best = -math.inf
        away = (low_x + last_a * pitch_x - x) ** 2 + (low_y + last_b * pitch_y - y) ** 2
        if away <= radius * radius:
            best = heights[last_a, last_b] - profile_height(tool, math.sqrt(away))
        left = max(0, _number(x - radius - low_x, side_x))
        right = min(maxima.shape[0] - 1, _number(x + radius - low_x, side_x))
        bottom = max(0, _number(y - radius - low_y, side_y))
        top = min(maxima.shape[1] - 1, _number(y + radius - low_y, side_y))
        for at in range((right - left + 1) * (top - bottom + 1)):
            i, j = left + at // (top - bottom + 1), bottom + at % (top - bottom + 1)
            if maxima[i, j] <= best:
                continue
            gap_x = max(0.0, low_x + i * side_x - x, x - low_x - i * side_x - wide_x)
            gap_y = max(0.0, low_y + j * side_y - y, y - low_y - j * side_y - wide_y)
            near = gap_x * gap_x + gap_y * gap_y
            if near > radius * radius or maxima[i, j] - profile_height(tool, math.sqrt(near)) <= best:
                continue
            for a in range(i * BLOCK, min((i + 1) * BLOCK, heights.shape[0])):
                for b in range(j * BLOCK, min((j + 1) * BLOCK, heights.shape[1])):
                    if heights[a, b] <= best:
                        continue
                    away = (low_x + a * pitch_x - x) ** 2 + (low_y + b * pitch_y - y) ** 2
                    if away <= radius * radius:
                        tip = heights[a, b] - profile_height(tool, math.sqrt(away))
                        if tip > best:
                            best, last_a, last_b = tip, a, b
        out[k] = best


@njit
def thinned(points: FloatArray, spacing: float, chosen: NDArray[np.bool_]) -> None:
    """Choose points, in their order, that lie at least ``spacing`` from all chosen before.

    Args:
        points: shape (m, 2).
        chosen: shape (m,), filled.
    """
    if len(points) == 0:
        return
    low_x, low_y = points[:, 0].min(), points[:, 1].min()
    columns = int((points[:, 0].max() - low_x) / spacing) + 1
    rows = int((points[:, 1].max() - low_y) / spacing) + 1
    # chosen points of every cell as a linked list
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
