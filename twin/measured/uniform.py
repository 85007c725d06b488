"""Evenly spaced samples: short gaps bridged, long ones kept as gaps; another rate without aliasing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np
from scipy import signal

from twin.arrays import FloatArray, frozen
from twin.errors import MeasuredError
from twin.measured.log import Correction, ForceLog, vector

#: Times may deviate from an even grid by this part of an interval before the samples are interpolated to it.
_EVEN = 0.02
#: Largest numerator and denominator of a ratio of rates.
_MOST_RATIO = 20000
_PLAIN_RATIO = 64
#: Largest number of samples of an even grid for each measured one.
_MOST_FILL = 20
#: A log in parts with gaps between them may have more, up to this many, where the parts have samples enough; and so
#: may a log at another rate.
_MOST_SAMPLES = 4_000_000
_LEAST_PART = 16


def uniform(log: ForceLog) -> ForceLog:
    """The log on an even grid of its own rate; where it is uneven or has gaps, linear between its samples.

    Gaps stay in ``gaps``: comparisons omit them.
    """
    steps = np.diff(log.t_s) * log.rate_hz
    if np.abs(np.cumsum(steps - 1.0)).max(initial=0.0) < _EVEN:
        return log
    count = int(log.duration_s * log.rate_hz + _EVEN) + 1
    apart = bool(log.gaps) and len(log.t_s) >= _LEAST_PART * (len(log.gaps) + 1)
    if count > max(_MOST_FILL * len(log.t_s), _MOST_SAMPLES) and apart:
        begin, end = max(log.gaps, key=lambda gap: gap[1] - gap[0])
        raise MeasuredError(
            f"{log.source}: a gap of {end - begin:g} s, from {begin:g} to {end:g} s, is too long to be bridged at "
            f"{log.rate_hz:g} Hz, expected at most {_MOST_SAMPLES / log.rate_hz:g} s in all; split the log there"
        )
    if count > _MOST_FILL * len(log.t_s) and not apart:
        raise MeasuredError(
            f"{log.source}: {len(log.t_s)} samples over {log.duration_s:g} s, expected about {count} at "
            f"{log.rate_hz:g} Hz: most of the log is missing"
        )
    t_s = log.t_s[0] + np.arange(count) / log.rate_hz
    note = "uneven or missing samples: linear between neighbours on an even grid"
    if log.gaps:
        note += "; gaps take no part in the comparison"
    return replace(_at(log, t_s), notes=(*log.notes, note))


def resample(log: ForceLog, rate_hz: float) -> ForceLog:
    """The log at another rate, band-limited by a symmetric filter: no aliasing, no delay.

    Args:
        rate_hz: wanted rate; the nearest ratio of whole numbers up to 20000 is taken.

    Raises:
        MeasuredError: a rate that is not above 0, leaves no samples, or makes millions from few.
    """
    if not 0.0 < rate_hz < np.inf:
        raise MeasuredError(f"rate {rate_hz:g} Hz, expected a number above 0")
    log = uniform(log)
    count, most = len(log.t_s) / log.rate_hz * rate_hz, max(len(log.t_s), _MOST_SAMPLES)
    if count > most:
        raise MeasuredError(f"rate {rate_hz:g} Hz makes {count:.3g} samples, expected at most {most} for this log")
    ratio = Fraction(rate_hz / log.rate_hz).limit_denominator(_PLAIN_RATIO)
    if ratio == 0 or abs(float(ratio) * log.rate_hz / rate_hz - 1.0) > 1e-12:
        ratio = Fraction(rate_hz / log.rate_hz).limit_denominator(_MOST_RATIO)
    if ratio == 0 or len(log.t_s) * ratio < 2:
        raise MeasuredError(f"rate {rate_hz:g} Hz leaves less than 2 of {len(log.t_s)} samples at {log.rate_hz:g} Hz")
    if ratio == 1:
        return log
    got = log.rate_hz * float(ratio)
    force = signal.resample_poly(log.force_n, ratio.numerator, ratio.denominator, axis=0, padtype="line")
    t_s = log.t_s[0] + np.arange(len(force)) / got
    angle = None if log.spindle_angle_rad is None else np.interp(t_s, log.t_s, log.spindle_angle_rad)
    done = Correction(
        kind="resample",
        text=f"resampled from {log.rate_hz:g} Hz to {got:g} Hz, band-limited, without delay",
        values={"from_hz": log.rate_hz, "to_hz": got},
    )
    return replace(
        log,
        t_s=vector(t_s, "t_s"),
        force_n=frozen(force, "force_n", (None, 3)),
        rate_hz=got,
        spindle_angle_rad=None if angle is None else vector(angle, "spindle_angle_rad"),
        corrections=(*log.corrections, done),
    )


def pieces(log: ForceLog) -> Iterator[slice]:
    """The parts of an even log between its gaps."""
    start = 0
    for begin, end in log.gaps:
        stop = int(np.searchsorted(log.t_s, begin, side="right"))
        if stop > start:
            yield slice(start, stop)
        start = int(np.searchsorted(log.t_s, end, side="left"))
    if start < len(log.t_s):
        yield slice(start, len(log.t_s))


def outside_gaps(log: ForceLog, t_s: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Shape (n,), which times on the log's clock lie in no gap."""
    good = np.ones(len(t_s), bool)
    for begin, end in log.gaps:
        good &= (t_s <= begin) | (t_s >= end)
    return good


def richest(force_n: FloatArray, count: int) -> slice:
    """The stretch of ``count`` samples that holds most of the power; all of them where there are no more."""
    if len(force_n) <= count:
        return slice(0, len(force_n))
    power = np.concatenate([[0.0], np.cumsum(np.sum(force_n**2, axis=1))])
    start = int(np.argmax(power[count:] - power[:-count]))
    return slice(start, start + count)


def active(force_n: FloatArray) -> slice:
    """The stretch between the first and the last hundredth of the power: without the air around a cut."""
    power = np.cumsum(np.sum(force_n**2, axis=1))
    first, last = np.searchsorted(power, (0.01 * power[-1], 0.99 * power[-1]))
    return slice(int(first), int(last) + 1)


def _at(log: ForceLog, t_s: FloatArray) -> ForceLog:
    """The log at other times, linear between its samples."""
    force = np.column_stack([np.interp(t_s, log.t_s, log.force_n[:, axis]) for axis in range(3)])
    angle = None if log.spindle_angle_rad is None else np.interp(t_s, log.t_s, log.spindle_angle_rad)
    return replace(
        log,
        t_s=vector(t_s, "t_s"),
        force_n=frozen(force, "force_n", (None, 3)),
        spindle_angle_rad=None if angle is None else vector(angle, "spindle_angle_rad"),
    )
