"""Rapids in which each axis moves independently: a path of straight legs, not one straight line (a dog-leg)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from twin.arrays import FloatArray
from twin.motion.path import Move

#: Axes that arrive within this part of the motion's time arrive together.
_TOGETHER = 1e-9


def independent_legs(move: Move, axis_rapid_mm_min: FloatArray) -> Iterator[Move]:
    """The legs of a rapid in which all axes start together, each at its own rate until it is at its end.

    Args:
        move: the straight motion.
        axis_rapid_mm_min: shape (3,), rate of each axis.

    Yields:
        One leg for each time at which an axis arrives; the last one ends exactly where the motion does.
    """
    way = move.end_mm - move.start_mm
    arrival_s = np.abs(way) / axis_rapid_mm_min * 60.0
    total_s = float(arrival_s.max())
    times = np.sort(arrival_s[arrival_s > _TOGETHER * total_s])
    times = times[np.append(np.diff(times) > _TOGETHER * total_s, True)]
    start, before_s = move.start_mm, 0.0
    for at_s in times.tolist():
        gone = np.minimum(1.0, np.divide(at_s, arrival_s, out=np.ones(3), where=arrival_s > 0.0))
        end = move.end_mm if at_s == total_s else move.start_mm + way * gone
        duration_s = at_s - before_s
        speed = float(np.linalg.norm(end - start)) / duration_s * 60.0
        yield replace(move, start_mm=start, end_mm=end, duration_s=duration_s, feed_mm_min=speed)
        start, before_s = end, at_s
