"""Detection of cut and air in a log, and of the steady part of the cut."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from twin.arrays import FloatArray

Span = tuple[float, float]

#: The force must repeat this many times more in the cut than in air for the two to be told apart.
_CONTRAST = 2.2
#: Multiples of the tooth-passing frequency that the force is looked at in.
_ORDERS = 3
#: Between the levels of air and cut, where one ends and the other begins.
_THRESHOLD = 0.25
#: Revolutions of the running median that takes the scatter off.
_SMOOTHED = 5
#: Air nearer to the cut than this many revolutions is omitted.
_CLEAR_REVOLUTIONS = 3
#: Least revolutions of a stretch of air that is used.
_LEAST_AIR = 5
#: Contact is what varies more than air by this many standard deviations, or by this part of the contrast.
_SCATTER = 4.0
_FAINT = 0.01
#: How much farther than its reach the tool goes before the cut is called steady.
_ENTRY = 1.05


@dataclass(frozen=True, slots=True)
class CutAndAir:
    """Cut and air in a log.

    Attributes:
        cut_s: from, to: the longest stretch in which the force varies within each revolution.
        air_s: stretches before and after it without.
        begins, ends: whether the log has the beginning and the end of the cut.
    """

    cut_s: Span
    air_s: tuple[Span, ...]
    begins: bool
    ends: bool


def find_cut(t_s: FloatArray, force_n: FloatArray, revolution_s: float, teeth: int) -> CutAndAir:
    """Separate cut from air by the part of the force that repeats with the spindle in each revolution.

    A log that varies alike throughout is all cut.

    Args:
        t_s: shape (n,), increasing.
        force_n: shape (n, axes).
    """
    edges, activity = _activity(t_s, force_n, revolution_s, teeth)
    low, high = np.percentile(activity, 2.0), np.percentile(activity, 95.0)
    whole = (float(t_s[0]), float(t_s[-1]))
    if len(activity) < 3 * _LEAST_AIR or high < _CONTRAST * low:
        return CutAndAir(whole, (), False, False)
    cutting = activity > low + _THRESHOLD * (high - low)
    first, last = _longest(_closed(cutting))
    cut = (float(edges[first]), float(edges[last + 1]))
    touch, leave = _contact(activity, first, last, float(high - low), cutting)
    clear = _CLEAR_REVOLUTIONS * revolution_s
    spans = ((whole[0], float(edges[touch]) - clear), (float(edges[leave + 1]) + clear, whole[1]))
    air = tuple(s for s in spans if s[1] - s[0] >= _LEAST_AIR * revolution_s)
    return CutAndAir(cut, air, first > 0, last < len(activity) - 1)


def steady_part(found: CutAndAir, reach_mm: float, feed_mm_s: float, revolution_s: float) -> Span | None:
    """The part of a straight cut in which the whole front of the tool is in the stock; None where there is none.

    From the first touch the tool goes as far as its front reaches before its axis until all of it is in, and as far
    before the end it begins to leave.

    Args:
        reach_mm: how far engaged points lie before the axis.
    """
    trim = max(_ENTRY * reach_mm / feed_mm_s, 2.0 * revolution_s)
    first = found.cut_s[0] + (trim if found.begins else 0.0)
    last = found.cut_s[1] - (trim if found.ends else 0.0)
    least = 3.0 * revolution_s if found.begins or found.ends else 0.0
    return (first, last) if last - first >= least else None


def _activity(t_s: FloatArray, force_n: FloatArray, revolution_s: float, teeth: int) -> tuple[FloatArray, FloatArray]:
    """Ends of blocks of one revolution, and how much of the force in each repeats with the spindle and the teeth.

    The RMS of the lowest multiples of the spindle frequency, the mean taken off: noise and zero hardly show in it.
    """
    count = max(1, int((t_s[-1] - t_s[0]) / revolution_s))
    edges = t_s[0] + revolution_s * np.arange(count + 1)
    at = np.searchsorted(t_s, edges)
    samples = np.maximum(np.diff(at), 1)
    centred = force_n - force_n.mean(axis=0)
    mean = _block_sums(centred, at) / samples[:, None]
    most = max(1, min(_ORDERS * teeth, int(0.45 * len(t_s) / count)))
    turn = np.exp(-2j * np.pi / revolution_s * (t_s - t_s[0]))
    wave, power = np.ones(len(t_s), dtype=complex), np.zeros(count)
    for _ in range(most):
        wave = wave * turn
        found = _block_sums(centred * wave[:, None], at) - mean * _block_sums(wave[:, None], at)
        power += 2.0 * (np.abs(found / samples[:, None]) ** 2).sum(axis=1)
    return edges, np.asarray(np.sqrt(ndimage.median_filter(power, _SMOOTHED, mode="nearest")))


def _block_sums(values: NDArray[Any], at: NDArray[np.intp]) -> NDArray[Any]:
    """Sums of rows between neighbouring indices."""
    sums = np.concatenate((np.zeros((1, values.shape[1]), dtype=values.dtype), np.cumsum(values, axis=0)))
    return np.asarray(np.diff(sums[at], axis=0))


def _contact(
    activity: FloatArray, first: int, last: int, contrast: float, cutting: np.ndarray[tuple[int], np.dtype[np.bool_]]
) -> tuple[int, int]:
    """First and last block with any contact about a cut: its beginning may be weaker than what is called cut."""
    air = activity[~cutting]
    middle = float(np.median(air))
    scatter = 1.4826 * float(np.median(np.abs(air - middle)))
    limit = middle + max(_SCATTER * scatter, _FAINT * contrast)
    while first > 0 and activity[first - 1] > limit:
        first -= 1
    while last < len(activity) - 1 and activity[last + 1] > limit:
        last += 1
    return first, last


def _closed(cutting: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Holes of one or two revolutions filled."""
    out = cutting.copy()
    on = np.flatnonzero(cutting)
    for a, b in pairwise(on.tolist()):
        if 1 < b - a <= 3:
            out[a:b] = True
    return out


def _longest(cutting: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> tuple[int, int]:
    """First and last block of the longest run."""
    padded = np.concatenate(([False], cutting, [False])).astype(np.int8)
    starts, stops = np.flatnonzero(np.diff(padded) == 1), np.flatnonzero(np.diff(padded) == -1)
    best = int(np.argmax(stops - starts))
    return int(starts[best]), int(stops[best]) - 1
