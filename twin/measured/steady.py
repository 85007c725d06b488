"""The part of a log in which the cut is steady, found by the log itself."""

from __future__ import annotations

import numpy as np

from twin.arrays import FloatArray
from twin.errors import MeasuredError
from twin.measured.log import ForceLog, Gap
from twin.measured.uniform import outside_gaps, uniform

#: Length of the blocks whose level is looked at where no speed is known, s.
_BLOCK_S = 0.02
#: Smoothing over so many blocks.
_SMOOTHED = 5
#: A block is steady when its level is within this part of the level of the cut.
_WITHIN = 0.2
#: Blocks below this part of the highest level are no cut.
_CUTTING = 0.5


def steady_window(log: ForceLog, rpm: float | None = None) -> Gap:
    """First and last time of the longest steady cut.

    The RMS of the resultant over blocks of whole revolutions (20 ms where the speed is not known), smoothed by a
    running median of five, must stay within 20 % of its median over all blocks that reach half of the highest level.
    One block at each end of the longest such stretch is left away where the cut begins or ends there.

    Raises:
        MeasuredError: nothing steady for three blocks.
    """
    log = uniform(log)
    block_s = _BLOCK_S if not rpm else 60.0 / abs(rpm) * max(1, round(_BLOCK_S * abs(rpm) / 60.0))
    size = max(2, round(block_s * log.rate_hz))
    count = len(log.t_s) // size
    if count < 3:
        raise MeasuredError(f"{log.source}: {log.duration_s:g} s, expected at least {3 * block_s:g} s for a steady cut")
    levels = _levels(log, size, count)
    top = float(np.percentile(levels, 98.0))
    cut = float(np.median(levels[levels >= _CUTTING * top]))
    good = np.abs(levels - cut) <= _WITHIN * cut
    good &= outside_gaps(log, log.t_s[size * np.arange(count) + size // 2])
    begin, end = _longest(good)
    begin, end = begin + (begin > 0), end - (end < count)
    if end - begin < 1 or cut <= 0.0:
        raise MeasuredError(f"{log.source}: no steady cut found, expected forces that stay within 20 % for 60 ms")
    return float(log.t_s[begin * size]), float(log.t_s[end * size - 1])


def _levels(log: ForceLog, size: int, count: int) -> FloatArray:
    """RMS of the resultant over blocks, smoothed."""
    square = np.sum(log.force_n[: count * size] ** 2, axis=1).reshape(count, size)
    levels = np.sqrt(square.mean(axis=1))
    half = _SMOOTHED // 2
    padded = np.pad(levels, half, mode="edge")
    return np.asarray(np.median(np.lib.stride_tricks.sliding_window_view(padded, _SMOOTHED), axis=1))


def _longest(good: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> tuple[int, int]:
    """Begin and end of the longest stretch of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], good.astype(np.int8), [0]])))
    if not len(edges):
        return 0, 0
    begins, ends = edges[::2], edges[1::2]
    at = int(np.argmax(ends - begins))
    return int(begins[at]), int(ends[at])
