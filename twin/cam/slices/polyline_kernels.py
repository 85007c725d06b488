"""Lines from heights at even samples and within cells, with inner corners and walls; compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import helper, njit

#: Change of slope that makes an inner corner, and slope that makes a wall.
_CORNER = 0.02
_WALL = 50.0


@helper
def _joined(
    heights: FloatArray, cells: NDArray[np.int64], finer: FloatArray, start: float, step: float, line: FloatArray
) -> int:
    """One line through even samples, and through those within its rough cells; its number of points."""
    parts, count, rough = finer.shape[1] - 1, 0, 0
    for k in range(len(heights)):
        at = start + step * k
        if rough < len(cells) and cells[rough] == k:
            for j in range(parts):
                line[count, 0], line[count, 1] = at + step / parts * j, finer[rough, j]
                count += 1
            rough += 1
        else:
            line[count, 0], line[count, 1] = at, heights[k]
            count += 1
    return count


@helper
def _slope(line: FloatArray, i: int) -> float:
    return (line[i + 1, 1] - line[i, 1]) / (line[i + 1, 0] - line[i, 0])


@helper
def _with_corners(line: FloatArray, made: FloatArray) -> int:
    """A line with a point at every inner corner between two of its points: where its sides, extended, meet."""
    count = 0
    for i in range(len(line)):
        if 2 <= i < len(line) - 1:
            left, right, width = _slope(line, i - 2), _slope(line, i), line[i, 0] - line[i - 1, 0]
            if right - left > _CORNER:
                ahead = (line[i, 1] - line[i - 1, 1] - right * width) / (left - right)
                if 0.0 < ahead < width:
                    made[count, 0], made[count, 1] = line[i - 1, 0] + ahead, line[i - 1, 1] + left * ahead
                    count += 1
        made[count, 0], made[count, 1] = line[i, 0], line[i, 1]
        count += 1
    return count


@helper
def _with_walls(line: FloatArray, made: FloatArray) -> int:
    """A line that is upright where it is nearly so, on the side away from the wall."""
    count = 0
    for i in range(len(line)):
        if i > 0:
            rise = line[i, 1] - line[i - 1, 1]
            if abs(rise) > _WALL * (line[i, 0] - line[i - 1, 0]):
                down = rise < 0.0
                made[count, 0] = line[i, 0] if down else line[i - 1, 0]
                made[count, 1] = line[i - 1, 1] if down else line[i, 1]
                count += 1
        made[count, 0], made[count, 1] = line[i, 0], line[i, 1]
        count += 1
    return count


@njit
def lines(
    heights: FloatArray,
    begins: NDArray[np.int64],
    cells: NDArray[np.int64],
    finer: FloatArray,
    start: float,
    step: float,
    points: FloatArray,
    ends: NDArray[np.int64],
) -> None:
    """All lines, one after the other.

    Args:
        heights: shape (p, n), at even samples.
        begins: shape (p + 1,), where each line's rough cells begin.
        cells: shape (c,), the rough cells, increasing in each line; cell k begins at sample k.
        finer: shape (c, m + 1), heights within these, both ends included.
        start, step: of the even samples.
        points: shape (at least 4 (p n + c m), 2), filled.
        ends: shape (p,), filled with where each line ends.
    """
    n, m = heights.shape[1], finer.shape[1] - 1
    most = 0
    for p in range(len(heights)):
        most = max(most, n + (begins[p + 1] - begins[p]) * m)
    one, two = np.empty((most, 2)), np.empty((2 * most, 2))
    end = 0
    for p in range(len(heights)):
        a, b = begins[p], begins[p + 1]
        count = _joined(heights[p], cells[a:b], finer[a:b], start, step, one)
        count = _with_corners(one[:count], two)
        end += _with_walls(two[:count], points[end:])
        ends[p] = end
