"""Measurement of one cut from its log: mean force, its standard error, and the waveform over one revolution.

Every choice (cut, air, zero, speed) is in the notes; each can be given in the file of cuts instead.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.errors import IdentifyError, MeasuredError
from twin.identification.cuts.cuts_file import Cut
from twin.identification.cuts.fit_settings import Fit
from twin.identification.fit.harmonics import SPEED_RANGE, ComplexArray, find_speed, of_samples
from twin.measured.axes import aliases
from twin.measured.forces import read_forces
from twin.measured.log import AXES, ForceLog
from twin.measured.spindle import spindle_speed
from twin.measured.steady import CutAndAir, Span, steady_part

#: Multiples of the tooth-passing frequency in a waveform, unless the file gives them.
_ORDERS = 12
_MOST_HARMONICS = 60
#: Highest multiple, in parts of the samples of one revolution; half of them is the Nyquist limit.
_BELOW_NYQUIST = 0.4
#: How notes of a speed that may be wrong begin.
SPEED_DOUBT = "spindle speed in doubt"
#: Fewer revolutions do not determine a speed within 1 %.
_LEAST_SPEED_TURNS = 8
#: Times in a file are rounded by less than this part of their interval.
_ROUNDED = 0.25
#: Parts of the window that the mean's standard error is found from.
_BATCHES = 20


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measured:
    """One cut as measured; forces on the tool, machine axes.

    Attributes:
        mean_n: shape (3,), NaN on an axis that was not measured.
        error_n: shape (3,), standard errors of the means, NaN where unknown.
        harmonics: shape (count + 1, 3), the waveform, angle 0 at the log's time 0; None without a log, or with too few
            samples a revolution.
        noise_n: shape (3,), standard deviation of single samples about the waveform.
        rpm: spindle speed.
        window_s: the part of the log that was used.
        samples_per_rev: of the log.
        zero_n, drift_n_s: shape (3,), subtracted zero in the middle of the cut, and its change with time.
        notes: results and choices, one line each.
    """

    mean_n: FloatArray
    error_n: FloatArray
    harmonics: ComplexArray | None = None
    noise_n: FloatArray | None = None
    rpm: float
    window_s: Span | None = None
    samples_per_rev: float = math.inf
    zero_n: FloatArray | None = None
    drift_n_s: FloatArray | None = None
    notes: tuple[str, ...] = ()

    @property
    def axes(self) -> NDArray[np.bool_]:
        """Shape (3,), which axes were measured."""
        return np.isfinite(self.mean_n)


def given_mean(cut: Cut, rpm: float) -> Measured:
    """A cut with its mean force in the file.

    Raises:
        MeasuredError: an axis map of unknown columns.
    """
    assert cut.mean_force_n is not None
    values, errors = np.array(cut.mean_force_n), np.array(cut.mean_error_n or (math.nan,) * 3)
    if (axis_map := cut.axis_map) is not None:
        columns = ["Fx_N", "Fy_N", "Fz_N"]
        terms = axis_map.terms(aliases(columns))
        mixed, squares = np.full(3, math.nan), np.full(3, math.nan)
        for axis, parts in terms.items():
            i = AXES.index(axis)
            mixed[i] = sum(f * values[columns.index(c)] for f, c in parts)
            squares[i] = sum((f * errors[columns.index(c)]) ** 2 for f, c in parts)
        values, errors = mixed, np.sqrt(squares)
    sign = -1.0 if cut.force_on == "workpiece" else 1.0
    return Measured(mean_n=sign * values, error_n=errors, rpm=rpm, notes=("mean force as given",))


def log_of(cut: Cut, rpm: float) -> ForceLog:
    """The cut's log as forces on the tool.

    Args:
        rpm: makes time of a column of the spindle's angle, where there is no time.

    Raises:
        MeasuredError: see `twin.measured.forces.read_forces`.
    """
    assert cut.log is not None
    reading = cut if cut.rpm is not None else cut.model_copy(update={"rpm": rpm})
    return read_forces(cut.log, reading)


def straight_window(cut: Cut, log: ForceLog, found: CutAndAir, reach_mm: float, rpm: float, feed_mm_s: float) -> Span:
    """The steady part of a straight cut in its log's time.

    Raises:
        IdentifyError: there is none.
    """
    if cut.window_s is not None:
        return cut.window_s
    steady = steady_part(found, reach_mm, feed_mm_s, 60.0 / rpm)
    if steady is None:
        raise IdentifyError(
            f"{log.source}: the cut from {found.cut_s[0]:.3f} to {found.cut_s[1]:.3f} s is too short to have a steady "
            f"part: the tool enters and leaves for {reach_mm / feed_mm_s:.3f} s each; give window_s = [from, to]"
        )
    return steady


def measure(
    cut: Cut, log: ForceLog, found: CutAndAir, window: Span, rpm: float, teeth: int, fit: Fit, seems: float = 1.0
) -> Measured:
    """Mean and waveform in a window of a log.

    Args:
        rpm: spindle speed as given.
        seems: speed that is found in the simulated force of this window, in parts of the true one: where the engagement
            changes the force leads or lags the spindle.

    Raises:
        IdentifyError: less than a revolution in the window.
        MeasuredError: a window outside the log.
    """
    inside, notes = _inside(log, window, rpm), [*log.notes]
    zero = _zero(cut, log, found, 0.5 * (window[0] + window[1]), 60.0 / rpm)
    t = log.t_s[inside]
    f = log.force_n[inside] - zero.at(t)
    samples = log.rate_hz * 60.0 / rpm
    if samples > 2.5 * teeth:
        rpm, more = _speed(
            replace(log, t_s=t, force_n=f, spindle_angle_rad=None, trigger_s=None), rpm, teeth, fit, seems
        )
        notes += more
    mean, error, used = _mean(t, f, 60.0 / rpm)
    measured = np.array([axis in log.axes for axis in AXES])
    count = harmonic_count(fit, teeth, rpm, samples)
    harmonics = noise = None
    if count >= 1 and inside.sum() >= 3 * count:
        turns = (t >= used[0]) & (t <= used[1])
        harmonics, noise = of_samples(t[turns], f[turns], rpm * 2.0 * math.pi / 60.0, count)
    notes += [zero.note, f"steady cut from {used[0]:.3f} to {used[1]:.3f} s, {'as given' if cut.window_s else 'found'}"]
    return Measured(
        mean_n=np.where(measured, mean, math.nan),
        error_n=np.where(measured, np.hypot(error, zero.error_n), math.nan),
        harmonics=harmonics,
        noise_n=noise,
        rpm=rpm,
        window_s=used,
        samples_per_rev=samples,
        zero_n=zero.value_n,
        drift_n_s=zero.drift_n_s,
        notes=tuple(notes),
    )


def harmonic_count(fit: Fit, teeth: int, rpm: float, samples_per_rev: float) -> int:
    """Multiples of the spindle frequency that a waveform is compared in."""
    wanted = fit.harmonics or min(_ORDERS * teeth, _MOST_HARMONICS)
    limits = [wanted, math.floor(_BELOW_NYQUIST * samples_per_rev)]
    if fit.lowpass_hz is not None:
        limits.append(math.floor(fit.lowpass_hz * 60.0 / rpm * (1.0 + 1e-9)))
    return min(limits)


def _inside(log: ForceLog, window: Span, rpm: float) -> NDArray[np.bool_]:
    first, last = log.span_s
    slack = 2.0 / log.rate_hz
    if window[0] < first - slack or window[1] > last + slack:
        raise MeasuredError(
            f"{log.source}: window {window[0]:g} to {window[1]:g} s is not in the log, "
            f"which has {first:.4f} to {last:.4f} s"
        )
    inside = np.asarray((log.t_s >= window[0]) & (log.t_s <= window[1]))
    if inside.sum() < 3 or window[1] - window[0] + (1.0 + _ROUNDED) / log.rate_hz < 60.0 / rpm:
        raise IdentifyError(
            f"{log.source}: window {window[0]:g} to {window[1]:g} s has {int(inside.sum())} samples, expected a whole "
            f"revolution: {60.0 / rpm:.4f} s at {rpm:g} rpm"
        )
    return inside


def _speed(log: ForceLog, rpm: float, teeth: int, fit: Fit, seems: float) -> tuple[float, list[str]]:
    """The speed of the waveform in a window; the given one if requested, or where none near it stands out."""
    if log.duration_s < _LEAST_SPEED_TURNS * 60.0 / rpm:
        return rpm, [f"spindle speed {rpm:g} rpm as given: too few revolutions to find it"]
    seen = spindle_speed(log, teeth, rpm)
    if seen is not None and abs(seen.rpm / rpm - 1.0) > SPEED_RANGE:
        return rpm, [f"{SPEED_DOUBT}: the force repeats as at {seen.rpm:.0f} rpm, {rpm:g} rpm is given and taken"]
    if fit.speed == "given":
        return rpm, []
    found = find_speed(log.t_s, log.force_n, rpm, teeth) / seems
    if abs(found / rpm - 1.0) > 0.98 * SPEED_RANGE:
        return rpm, [f"{SPEED_DOUBT}: none found within {100 * SPEED_RANGE:g} % of {rpm:g} rpm, which is taken"]
    return found, [f"spindle speed {found:.2f} rpm found, {rpm:g} given"]


def _mean(t_s: FloatArray, force_n: FloatArray, revolution_s: float) -> tuple[FloatArray, FloatArray, Span]:
    """Mean over whole revolutions, its standard error from the means of parts, and the window it is taken in.

    A sample stands for the interval about it, so that a revolution of samples is a revolution.
    """
    interval = (t_s[-1] - t_s[0]) / (len(t_s) - 1)
    begin, end = t_s[0] - 0.5 * interval, t_s[-1] + 0.5 * interval
    turns = max(1, math.floor((end - begin + _ROUNDED * interval) / revolution_s))
    first = 0.5 * (begin + end - turns * revolution_s)
    batches = min(_BATCHES, turns)
    ends = np.clip(first + revolution_s * np.round(np.linspace(0, turns, batches + 1)), begin, end)
    borders = np.concatenate(([begin], 0.5 * (t_s[1:] + t_s[:-1]), [end]))
    area = np.concatenate((np.zeros((1, force_n.shape[1])), np.cumsum(np.diff(borders)[:, None] * force_n, axis=0)))
    at = np.column_stack([np.interp(ends, borders, area[:, axis]) for axis in range(force_n.shape[1])])
    means = np.diff(at, axis=0) / np.diff(ends)[:, None]
    error = np.std(means, axis=0, ddof=1) / math.sqrt(batches) if batches > 2 else np.full(force_n.shape[1], math.nan)
    return (at[-1] - at[0]) / (ends[-1] - ends[0]), error, (float(ends[0]), float(ends[-1]))


@dataclass(frozen=True, slots=True, eq=False)
class _Zero:
    """A line through the air: value in the middle of the cut, slope, standard error there; each of shape (3,)."""

    middle_s: float
    value_n: FloatArray
    drift_n_s: FloatArray
    error_n: FloatArray
    note: str

    def at(self, t_s: FloatArray) -> FloatArray:
        """Shape (n, 3)."""
        return self.value_n + np.outer(t_s - self.middle_s, self.drift_n_s)


def _zero(cut: Cut, log: ForceLog, found: CutAndAir, middle_s: float, revolution_s: float) -> _Zero:
    """The zero that is subtracted from the force."""
    spans = cut.air_s if cut.air_s is not None else found.air_s
    if cut.zero == "none" or not spans:
        if cut.zero in ("line", "constant"):
            raise IdentifyError(f'{log.source}: no air found for zero = "{cut.zero}"; give air_s = [[from, to], ...]')
        why = "as requested" if cut.zero == "none" else "no air found"
        return _Zero(middle_s, np.zeros(3), np.zeros(3), np.zeros(3), f"zero not corrected: {why}")
    t, f = _block_means(log, spans, revolution_s)
    around = min(a for a, _ in spans) < middle_s < max(b for _, b in spans)
    line = cut.zero == "line" or (cut.zero == "auto" and around)
    basis = np.column_stack((np.ones(len(t)), t - middle_s)) if line else np.ones((len(t), 1))
    k, *_ = np.linalg.lstsq(basis, f, rcond=None)
    freedom = len(t) - basis.shape[1]
    variance = ((f - basis @ k) ** 2).sum(axis=0) / freedom if freedom > 0 else np.zeros(3)
    error = np.sqrt(variance * np.linalg.pinv(basis.T @ basis)[0, 0])
    drift = k[1] if line else np.zeros(3)
    text = f"zero {_listed(k[0], 2)} N" + (f", drift {_listed(drift, 3)} N/s" if line else "")
    return _Zero(middle_s, k[0], drift, error, f"{text} subtracted, by {_listed_air(spans)}")


def _listed(values: FloatArray, digits: int) -> str:
    return ", ".join(f"{v:+.{digits}f}" for v in values)


def _block_means(log: ForceLog, spans: Iterable[Span], revolution_s: float) -> tuple[FloatArray, FloatArray]:
    """Means of the force over revolutions in air, with their times."""
    times, means = [], []
    for first, last in spans:
        count = max(1, int((last - first) / revolution_s))
        edges = np.linspace(first, last, count + 1)
        at = np.searchsorted(log.t_s, edges)
        for a, b in pairwise(at.tolist()):
            if b > a:
                times.append(float(log.t_s[a:b].mean()))
                means.append(log.force_n[a:b].mean(axis=0))
    if not times:
        raise MeasuredError(f"{log.source}: no samples in air_s, {_listed_air(spans)}")
    return np.array(times), np.array(means)


def _listed_air(spans: Iterable[Span]) -> str:
    return "air from " + " and ".join(f"{a:.3f} to {b:.3f} s" for a, b in spans)
