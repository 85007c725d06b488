"""Delay of a log: cross-correlation over all delays, then refined below a sample."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from scipy import fft, signal
from scipy.optimize import minimize_scalar

from twin.arrays import FloatArray
from twin.comparison.run_forces import RunForces
from twin.errors import CompareError
from twin.measured.log import AXES, ForceLog, Gap
from twin.measured.uniform import outside_gaps, richest

#: An overlap shorter than this part of the shorter record counts as none.
_LEAST_OVERLAP = 0.3
#: Peaks that reach the best one to this part are as good.
_AS_GOOD = 0.99
#: ... and as long an overlap, square root, to this part.
_AS_LONG = 0.9
#: This many peaks are refined before the best is taken ...
_REFINED = 3
#: ... and then neighbours a tooth period away are tried, at most this many on each side.
_CLIMBED = 40
#: Delays that fit as well are far apart when they lie this part of the log from each other; then those that reach the
#: best to this part are taken for equals.
FAR_RIVALS = 0.25
_EQUAL = 0.998
#: Most samples that are correlated over all delays; longer records are thinned out first.
_MOST_SAMPLES = 1 << 20
#: The simulation is sampled this many times finer, and at this rate at least, before it is band-limited to the log's;
#: never more times finer than the second number.
_FINER, _FINEST = 4, 20_000
_FINE_HZ = 20000.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Delay:
    """Delay of a log.

    Attributes:
        lag_s: run time = log time - lag.
        score: correlation over the overlap at that lag, all measured axes together, at most 1.
        rivals_s: other lags that fit as well, nearest first.
    """

    lag_s: float
    score: float
    rivals_s: tuple[float, ...] = ()


def simulated_at_rate(run: RunForces, begin_s: float, count: int, rate_hz: float) -> FloatArray:
    """Shape (count, 3), the run's force on an even grid, band-limited to its rate."""
    pad = 16
    finer = min(max(_FINER, int(np.ceil(_FINE_HZ / rate_hz))), _FINEST)
    fine = run.at(begin_s + (np.arange((count + 2 * pad) * finer) / finer - pad) / rate_hz)
    return np.asarray(signal.resample_poly(fine, 1, finer, axis=0)[pad : pad + count])


def find_delay(run: RunForces, log: ForceLog, within_s: float | None = None, windows: Sequence[Gap] = ()) -> Delay:
    """The delay at which log and run correlate best.

    For every delay the correlation coefficient over the overlap is taken, all measured axes together, each less its
    mean there. Weighted by the square root of the overlap, so that a short chance likeness does not win, it gives
    about where to look; among the peaks that are about as good there and overlap about as long, the best few are
    refined by the maximum of the band-limited correlation, and the highest coefficient wins. Where equals lie far
    apart, for the cut is steady, the one is taken that covers the windows and is nearest to 0.

    Args:
        log: evenly sampled.
        within_s: only delays up to this size are looked at.
        windows: where the two are to be compared, on the run's clock.

    Raises:
        CompareError: no delay within reach has an overlap.
    """
    axes = [AXES.index(a) for a in log.axes]
    grid = _Grid.of(run, log)
    scores, weights, lags = grid.scores(axes)
    if within_s is not None:
        near = np.abs(lags) <= within_s + 0.5 / grid.rate_hz
        scores, weights, lags = scores[near], weights[near], lags[near]
    if not len(scores) or (scores * weights).max() <= 0.0:
        reach = f" within {within_s:g} s" if within_s is not None else ""
        raise CompareError(f"{log.source}: no delay{reach} at which the log follows the run; give it by --lag SECONDS")
    peaks = _peaks(scores, weights)
    likely = sorted(peaks, key=lambda p: _top(scores, p), reverse=True)[:_REFINED]
    fine = [_refined(run, log, axes, float(lags[p]), 1.0 / grid.rate_hz) for p in likely]
    shared = _shared(run, log, fine)
    found = [_pearson(run, log, axes, lag, shared) for lag in fine]
    lag = _climbed(run, log, axes, fine[int(np.argmax(found))], within_s)
    if max(abs(float(lags[p]) - lag) for p in peaks) > FAR_RIVALS * log.duration_s:
        equals = [float(lags[p]) for p in peaks if _top(scores, p) >= _EQUAL * _top(scores, likely[0])]
        chosen = min(equals, key=lambda rival: (not _covers(log, rival, windows), abs(rival)), default=lag)
        lag = _refined(run, log, axes, chosen, 1.0 / grid.rate_hz)
    rivals = sorted((float(lags[p]) for p in peaks), key=lambda rival: abs(rival - lag))[1:]
    return Delay(lag_s=lag, score=_pearson(run, log, axes, lag), rivals_s=tuple(rivals))


@dataclass(frozen=True, slots=True)
class _Grid:
    """Run and log on grids of one rate; ``valid`` is 1 for samples of the log, 0 in its gaps, None without gaps."""

    rate_hz: float
    run_begin_s: float
    log_begin_s: float
    run_n: FloatArray
    log_n: FloatArray
    valid: FloatArray | None

    @classmethod
    def of(cls, run: RunForces, log: ForceLog) -> _Grid:
        begin, end = run.span_s
        thin = max(1, int(np.ceil((end - begin + log.duration_s) * log.rate_hz / _MOST_SAMPLES)))
        rate = log.rate_hz / thin
        measured = log.force_n if thin == 1 else signal.resample_poly(log.force_n, 1, thin, axis=0, padtype="line")
        count = int((end - begin) * rate) + 1
        first = float(log.t_s[0])
        valid = outside_gaps(log, first + np.arange(len(measured)) / rate).astype(float) if log.gaps else None
        return cls(rate, begin, first, simulated_at_rate(run, begin, count, rate), np.asarray(measured), valid)

    @property
    def shorter(self) -> float:
        """Samples of the run or of the log, whichever has fewer."""
        return min(len(self.run_n), len(self.log_n) if self.valid is None else float(self.valid.sum()))

    def scores(self, axes: Sequence[int]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Correlation at every delay, its weight, and the delays in s."""
        totals = [self._sums(i, i) for i in axes]
        both = sum((t[0] for t in totals), np.zeros(1))
        power = np.sqrt(sum((t[1] for t in totals), np.zeros(1)) * sum((t[2] for t in totals), np.zeros(1)))
        count = totals[0][3]
        floor = 1e-9 * float(power.max())
        coefficient = np.where(power > floor, both / np.maximum(power, floor or 1.0), 0.0)
        weight = np.where(count >= _LEAST_OVERLAP * self.shorter, np.sqrt(count / self.shorter), 0.0)
        shifts = np.arange(-(len(self.run_n) - 1), len(self.log_n))
        coefficient = np.where(weight > 0.0, coefficient, 0.0)
        return coefficient, weight, self.log_begin_s - self.run_begin_s + shifts / self.rate_hz

    def _sums(
        self, log_axis: int, run_axis: int, *, centred: bool = True
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Covariance and variances over the overlap, times its length, and the length, at every shift.

        Args:
            centred: False leaves the means in: sums of products and squares.
        """
        m, s = self.log_n[:, log_axis], self.run_n[:, run_axis]
        if self.valid is not None:
            return _sums_between_gaps(m, s, self.valid, centred=centred)
        if centred:
            m, s = m - m.mean(), s - s.mean()
        shifts = np.arange(-(len(s) - 1), len(m))
        in_m = np.maximum(shifts, 0), np.minimum(shifts + len(s), len(m))
        in_s = np.maximum(-shifts, 0), np.minimum(len(m) - shifts, len(s))
        count = (in_m[1] - in_m[0]).astype(float)
        sum_m = _total(m, *in_m) if centred else np.zeros(len(shifts))
        sum_s = _total(s, *in_s) if centred else np.zeros(len(shifts))
        both = np.asarray(signal.correlate(m, s, mode="full", method="fft")) - sum_m * sum_s / count
        var_m = _total(m * m, *in_m) - sum_m**2 / count
        var_s = _total(s * s, *in_s) - sum_s**2 / count
        return both, np.maximum(var_m, 0.0), np.maximum(var_s, 0.0), count


def _sums_between_gaps(
    m: FloatArray, s: FloatArray, valid: FloatArray, *, centred: bool
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """The sums of `_Grid._sums` over the samples outside gaps."""
    if centred:
        m, s = m - np.average(m, weights=valid), s - s.mean()
    ones = np.ones(len(s))

    def over(of_log: FloatArray, of_run: FloatArray) -> FloatArray:
        return np.asarray(signal.correlate(of_log, of_run, mode="full", method="fft"))

    inside = np.rint(over(valid, ones))
    count = np.maximum(inside, 1.0)
    both, sum_m, sum_s = over(valid * m, s), over(valid * m, ones), over(valid, s)
    var_m, var_s = over(valid * m * m, ones), over(valid, s * s)
    if centred:
        both, var_m, var_s = both - sum_m * sum_s / count, var_m - sum_m**2 / count, var_s - sum_s**2 / count
    return both, np.maximum(var_m, 0.0), np.maximum(var_s, 0.0), inside


def _total(
    values: FloatArray, begin: np.ndarray[tuple[int], np.dtype[np.int_]], end: np.ndarray[tuple[int], np.dtype[np.int_]]
) -> FloatArray:
    """Sums of values from begin to end, for many of them."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray(sums[end] - sums[begin])


def _refined(run: RunForces, log: ForceLog, axes: Sequence[int], lag_s: float, reach_s: float) -> float:
    """The maximum of the band-limited correlation next to a delay on the grid."""
    rate = log.rate_hz
    begin, end = run.span_s
    inside = (log.t_s - lag_s >= begin) & (log.t_s - lag_s <= end)
    first, last = int(np.argmax(inside)), len(inside) - int(np.argmax(inside[::-1]))
    part = richest(log.force_n[first:last] - log.force_n[first:last].mean(axis=0), _MOST_SAMPLES)
    first, count = first + part.start, part.stop - part.start
    if count < 4:
        return lag_s
    measured = log.force_n[first : first + count][:, axes]
    if log.gaps:
        good = outside_gaps(log, log.t_s[first : first + count])
        measured = np.where(good[:, None], measured - measured[good].mean(axis=0), 0.0) if good.any() else measured
    simulated = simulated_at_rate(run, float(log.t_s[first]) - lag_s, count, rate)[:, axes]
    taper = signal.windows.tukey(count, min(1.0, 0.05 + 16.0 / count))[:, None]
    size = fft.next_fast_len(2 * count, real=True)
    spectra = [np.fft.rfft(taper * (v - v.mean(axis=0)), size, axis=0) for v in (measured, simulated)]
    cross = np.sum(spectra[0] * np.conj(spectra[1]), axis=1)
    turn = 2.0j * np.pi * np.fft.rfftfreq(size, 1.0 / rate)
    strong = np.abs(cross) > 1e-6 * np.abs(cross).max(initial=0.0)
    cross, turn = cross[strong], turn[strong]

    def loss(shift_s: float) -> float:
        return -float(np.sum(cross * np.exp(turn * shift_s)).real)

    reach = max(reach_s, 1.0 / rate)
    grid = np.linspace(-reach, reach, 2 * int(np.ceil(4.0 * reach * rate)) + 1)
    start = float(grid[np.argmin([loss(s) for s in grid.tolist()])])
    step = float(grid[1] - grid[0])
    found = minimize_scalar(loss, bounds=(start - step, start + step), method="bounded", options={"xatol": 1e-5 / rate})
    return lag_s + float(found.x)


def _covers(log: ForceLog, lag_s: float, windows: Sequence[Gap]) -> bool:
    """Whether a log has samples throughout the windows at a delay."""
    first, last = log.span_s
    step = 1.5 / log.rate_hz
    return all(first - lag_s <= begin + step and last - lag_s >= end - step for begin, end in windows)


def _climbed(run: RunForces, log: ForceLog, axes: Sequence[int], lag_s: float, within_s: float | None) -> float:
    """The best delay among those whole tooth periods away: neighbours differ by less than the grid shows."""
    turning = run.speed_in(run.span_s)
    if turning is None or not turning[0]:
        return lag_s
    period = 60.0 / abs(turning[0]) / turning[1]
    part = _shared(run, log, (lag_s - _CLIMBED * period, lag_s + _CLIMBED * period))
    best, height = lag_s, _pearson(run, log, axes, lag_s, part)
    for step in (period, -period):
        for _ in range(_CLIMBED):
            higher = _pearson(run, log, axes, best + step, part)
            if higher <= height or (within_s is not None and abs(best + step) > within_s):
                break
            best, height = best + step, higher
    return best if best == lag_s else _refined(run, log, axes, best, 1.0 / log.rate_hz)


def _shared(run: RunForces, log: ForceLog, lags: Sequence[float]) -> Gap:
    """The stretch of the log that overlaps with the run at all of some delays; all of it where they lie far apart."""
    begin, end = run.span_s
    first, last = max(lags) + begin, min(lags) + end
    overlap = min(last, float(log.t_s[-1])) - max(first, float(log.t_s[0]))
    return (first, last) if overlap > 0.5 * min(end - begin, log.duration_s) * _LEAST_OVERLAP else log.span_s


def _pearson(run: RunForces, log: ForceLog, axes: Sequence[int], lag_s: float, part: Gap | None = None) -> float:
    """Correlation over the overlap at one delay, all axes together; ``part`` of the log only, if given."""
    t_s = log.t_s - lag_s
    begin, end = run.span_s
    inside = (t_s >= begin) & (t_s <= end) & outside_gaps(log, log.t_s)
    if part is not None:
        inside &= (log.t_s >= part[0]) & (log.t_s <= part[1])
    m, s = log.force_n[inside][:, axes], run.at(t_s[inside])[:, axes]
    m, s = m - m.mean(axis=0), s - s.mean(axis=0)
    power = float(np.sqrt(np.sum(m * m) * np.sum(s * s)))
    return float(np.sum(m * s)) / power if power > 0.0 else 0.0


def _peaks(scores: FloatArray, weights: FloatArray) -> list[int]:
    """The best place, weighted, and all peaks that are about as good or better and overlap about as long."""
    best = int(np.argmax(scores * weights))
    peaks = signal.find_peaks(scores, height=_AS_GOOD * scores[best])[0].tolist()
    return list(dict.fromkeys([best, *(p for p in peaks if weights[p] >= _AS_LONG * weights[best])]))


def _top(scores: FloatArray, at: int) -> float:
    """Height of a peak by the parabola through its three highest samples: a delay may lie between two samples."""
    if not 0 < at < len(scores) - 1:
        return float(scores[at])
    left, middle, right = (float(s) for s in scores[at - 1 : at + 2])
    bend = left - 2.0 * middle + right
    return middle - (left - right) ** 2 / (8.0 * bend) if bend < 0.0 else middle


def better_axes(run: RunForces, log: ForceLog) -> tuple[dict[str, str], float]:
    """The signed axis of the log that fits each axis of the run best, at its own best delay, and its score.

    The means count here: in a steady slot two reversed signs look like half a tooth period of delay, but for the means.

    Returns:
        for x, y, z of the tool the signed axis of the log as it is now, e.g. ``{"x": "-y", ...}``.
    """
    grid = _Grid.of(run, log)
    axes = [AXES.index(a) for a in log.axes]
    if len(axes) < 3:
        return {a: a for a in log.axes}, 0.0
    sums = {(i, j): grid._sums(i, j, centred=False) for i in axes for j in axes}
    count = sums[axes[0], axes[0]][3]
    weight = np.where(count >= _LEAST_OVERLAP * grid.shorter, np.sqrt(count / grid.shorter), 0.0)
    var_m = sum((sums[i, i][1] for i in axes), np.zeros(1))
    var_s = sum((sums[j, j][2] for j in axes), np.zeros(1))
    power = np.sqrt(var_m * var_s)
    floor = 1e-9 * float(power.max())
    best, chosen = -1.0, {a: a for a in AXES}
    for order, signs in product(permutations(axes), product((1.0, -1.0), repeat=3)):
        both = sum((s * sums[i, j][0] for j, (i, s) in enumerate(zip(order, signs, strict=True))), np.zeros(1))
        score = float(np.max(np.where(power > floor, both / np.maximum(power, floor or 1.0), 0.0) * weight))
        if score > best + 1e-12:
            best = score
            chosen = {
                AXES[j]: ("-" if s < 0.0 else "") + AXES[i] for j, (i, s) in enumerate(zip(order, signs, strict=True))
            }
    return chosen, best
