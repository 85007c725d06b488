"""Where lines along u or v enter and leave the material of a plane, and the slope of the boundary there; compiled.

Ends come in pairs: material from the first to the second, from the third to the fourth, and so on. Two ends at
most ``merge`` apart cancel, for a sliver as for a slit. ``slopes`` hold the boundary's d(end) / d(line
position). A line at ``at`` is met by an edge that has one end at most ``at`` and the other above it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import inlined, njit


class LineEnds(NamedTuple):
    """Material on parallel lines of a plane.

    Attributes:
        offsets: shape (lines + 1,); line i has the values from ``offsets[i]`` to ``offsets[i + 1]``, an even number.
        ends_mm: increasing on each line: material from the first to the second, from the third to the fourth, ...
        slopes: d(end) / d(position of the line) of the boundary at each end; 0 where it is square to the line.
    """

    offsets: NDArray[np.int64]
    ends_mm: FloatArray
    slopes: FloatArray


@inlined
def _sort(ends: FloatArray, slopes: FloatArray, first: int, last: int) -> None:
    """Insertion sort of a few ends with their slopes."""
    for i in range(first + 1, last):
        end, slope = ends[i], slopes[i]
        j = i
        while j > first and ends[j - 1] > end:
            ends[j], slopes[j] = ends[j - 1], slopes[j - 1]
            j -= 1
        ends[j], slopes[j] = end, slope


@inlined
def join_sorted(ends: FloatArray, slopes: FloatArray, begin: int, first: int, last: int, merge: float) -> int:
    """Sort the ends [first, last) and append them to those from ``begin`` on, without neighbours that meet.

    Returns:
        Where the ends stop then.
    """
    _sort(ends, slopes, first, last)
    n = first
    for i in range(first, last):
        if n > begin and ends[i] - ends[n - 1] <= merge:
            n -= 1
        else:
            ends[n], slopes[n] = ends[i], slopes[i]
            n += 1
    return n


@njit
def ring_lines(lines: FloatArray, fixed: int, merge: float, edges: FloatArray, out: LineEnds) -> int:
    """Lines through plain rings: every line against every edge.

    Args:
        fixed: 0 for lines u = const, 1 for v = const.
        edges: shape (n, 4), rows (u0, v0, u1, v1).

    Returns:
        The number of ends, or -1 when they do not fit.
    """
    offsets, ends, slopes = out.offsets, out.ends_mm, out.slopes
    free = 1 - fixed
    n = 0
    offsets[0] = 0
    for i in range(len(lines)):
        begin = n
        at = lines[i]
        m = n
        for e in range(len(edges)):
            a, b = edges[e, fixed], edges[e, 2 + fixed]
            if (a <= at) != (b <= at):
                if m >= len(ends):
                    return -1
                slope = (edges[e, 2 + free] - edges[e, free]) / (b - a)
                ends[m], slopes[m] = edges[e, free] + slope * (at - a), slope
                m += 1
        n = join_sorted(ends, slopes, begin, n, m, merge)
        offsets[i + 1] = n
    return n
