"""Spindle speed from what was measured: trigger pulses, an angle, or the tooth-passing lines of a spectrum."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize_scalar

from twin.arrays import FloatArray
from twin.measured.log import ForceLog
from twin.measured.uniform import active, pieces, richest, uniform

#: Multiples of the tooth-passing frequency that are looked at.
_MOST_LINES = 8
#: The comb is looked for at speeds from this to that part of the expected one.
_SEARCHED = (0.65, 1.5)
#: Part of the alternating power that the comb must hold to count as found.
_LEAST_SHARE = 0.25
#: Longest stretch that is looked at, samples.
_MOST_SAMPLES = 1 << 20


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleSpeed:
    """A measured spindle speed.

    Attributes:
        rpm: always positive.
        share: part of the alternating power on the comb's lines, 1 where pulses or an angle give the speed.
        source: ``spectrum``, ``trigger`` or ``angle``.
    """

    rpm: float
    share: float
    source: str


def spindle_speed(log: ForceLog, teeth: int, expected_rpm: float) -> SpindleSpeed | None:
    """The speed of the spindle in a log; None where it cannot be determined.

    Args:
        teeth: of the tool.
        expected_rpm: speeds from 0.65 to 1.5 times this one are looked at in a spectrum.
    """
    if log.trigger_s is not None and len(log.trigger_s) > 2:
        return SpindleSpeed(rpm=60.0 / float(np.median(np.diff(log.trigger_s))), share=1.0, source="trigger")
    if log.spindle_angle_rad is not None and float(np.ptp(log.spindle_angle_rad)) > 2.0 * np.pi:
        return SpindleSpeed(rpm=_speed_of(log.t_s, log.spindle_angle_rad), share=1.0, source="angle")
    return _from_spectrum(uniform(log), teeth, abs(expected_rpm))


def _speed_of(t_s: FloatArray, angle_rad: FloatArray) -> float:
    """Speed, rpm, over most of the samples: the spindle may be stopped at the ends of a log."""
    ahead = max(1, len(t_s) // 200)
    speeds = np.abs(angle_rad[ahead:] - angle_rad[:-ahead]) / (t_s[ahead:] - t_s[:-ahead])
    return 60.0 * float(np.median(speeds)) / (2.0 * np.pi)


def _from_spectrum(log: ForceLog, teeth: int, expected_rpm: float) -> SpindleSpeed | None:
    """Search for the comb on a grid finer than the spectrum's resolution, then refine."""
    part = max(pieces(log), key=lambda s: s.stop - s.start)
    force = log.force_n[part] - log.force_n[part].mean(axis=0)
    force = force[active(force)]
    force = force[richest(force, _MOST_SAMPLES)]
    n = len(force)
    passing = teeth * expected_rpm / 60.0
    low, high = _SEARCHED[0] * passing, _SEARCHED[1] * passing
    if not passing > 0.0 or n / log.rate_hz < 4.0 / passing or high > 0.5 * log.rate_hz:
        return None
    window = np.hanning(n)[:, None]
    moving = (force - force.mean(axis=0)) * window
    padded = 4 * n
    power = np.sum(np.abs(np.fft.rfft(moving, padded, axis=0)) ** 2, axis=1)
    step = log.rate_hz / padded
    found = np.arange(low, high, 0.5 * step)
    scores = _comb(power, step, found, log.rate_hz)
    best = float(found[np.argmax(scores)])
    hz = _refined(power, step, best, log.rate_hz)
    share = _share(power, step, hz, log.rate_hz, n)
    if share < _LEAST_SHARE:
        return None
    return SpindleSpeed(rpm=60.0 * hz / teeth, share=share, source="spectrum")


def _refined(power: FloatArray, step: float, hz: float, rate_hz: float) -> float:
    """The frequency next to one on the grid at which the comb's power, by splines through the grid, is highest."""
    curves = []
    for k in range(1, _lines(hz, rate_hz) + 1):
        middle, half = round(k * hz / step), 2 * k + 6
        part = np.arange(max(middle - half, 0), min(middle + half + 1, len(power)))
        curves.append((k, CubicSpline(part * step, power[part])))

    def loss(at_hz: float) -> float:
        return -sum(float(curve(k * at_hz)) for k, curve in curves)

    found = minimize_scalar(loss, bounds=(hz - step, hz + step), method="bounded", options={"xatol": 1e-4 * step})
    return float(found.x)


def _lines(hz: float, rate_hz: float) -> int:
    return max(1, min(_MOST_LINES, int(0.45 * rate_hz / hz)))


def _comb(power: FloatArray, step: float, hz: FloatArray, rate_hz: float) -> FloatArray:
    """Power on the multiples of frequencies; the same number of multiples for all of them."""
    at = np.arange(len(power)) * step
    total = np.zeros(len(hz))
    for k in range(1, _lines(float(hz.max()), rate_hz) + 1):
        total += np.interp(k * hz, at, power)
    return total


def _share(power: FloatArray, step: float, hz: float, rate_hz: float, n: int) -> float:
    """Part of the power within the width of the lines of the comb, the spindle's own lines between included."""
    at = np.arange(len(power)) * step
    width = 2.5 * rate_hz / n
    near = np.zeros(len(power), bool)
    for k in range(1, int(0.5 * rate_hz / hz) + 1):
        near |= np.abs(at - k * hz) <= width
    alternating = at > 0.3 * hz
    total = float(power[alternating].sum())
    return float(power[near & alternating].sum()) / total if total > 0.0 else 0.0
