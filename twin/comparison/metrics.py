"""Errors of a simulation against a measurement, one axis in one window."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.arrays import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisErrors:
    """One axis in one window; the error is simulated less measured. A ratio by zero is None.

    Attributes:
        axis: ``x``, ``y``, ``z``, or ``resultant``.
        mean_abs_n: mean of the error's magnitude: the "mean error" of the tri-slice paper's Table 6.
        rms_n: root of its mean square.
        max_n: its largest magnitude: the "maximum error" of that table.
        bias_n: its mean.
        measured_mean_n, simulated_mean_n: means.
        measured_rms_n, simulated_rms_n: RMS values.
        measured_peak_n, simulated_peak_n: largest magnitudes.
        rms_by_rms: error's RMS by the measured RMS.
        rms_by_peak: error's RMS by the measured peak.
        max_by_peak: largest error by the measured peak.
        ratio_of_means, ratio_of_peaks: simulated divided by measured.
        correlation: of the two waveforms, None where one is constant.
    """

    axis: str
    mean_abs_n: float
    rms_n: float
    max_n: float
    bias_n: float
    measured_mean_n: float
    simulated_mean_n: float
    measured_rms_n: float
    simulated_rms_n: float
    measured_peak_n: float
    simulated_peak_n: float
    rms_by_rms: float | None
    rms_by_peak: float | None
    max_by_peak: float | None
    ratio_of_means: float | None
    ratio_of_peaks: float | None
    correlation: float | None


def axis_errors(axis: str, measured_n: FloatArray, simulated_n: FloatArray) -> AxisErrors:
    """Errors of one axis.

    Args:
        measured_n, simulated_n: shape (n,), n >= 1, at the same moments.
    """
    error = simulated_n - measured_n
    rms = _rms(error)
    peak = float(np.abs(measured_n).max())
    largest = float(np.abs(error).max())
    return AxisErrors(
        axis=axis,
        mean_abs_n=float(np.abs(error).mean()),
        rms_n=rms,
        max_n=largest,
        bias_n=float(error.mean()),
        measured_mean_n=float(measured_n.mean()),
        simulated_mean_n=float(simulated_n.mean()),
        measured_rms_n=_rms(measured_n),
        simulated_rms_n=_rms(simulated_n),
        measured_peak_n=peak,
        simulated_peak_n=float(np.abs(simulated_n).max()),
        rms_by_rms=_ratio(rms, _rms(measured_n)),
        rms_by_peak=_ratio(rms, peak),
        max_by_peak=_ratio(largest, peak),
        ratio_of_means=_ratio(float(simulated_n.mean()), float(measured_n.mean())),
        ratio_of_peaks=_ratio(float(np.abs(simulated_n).max()), peak),
        correlation=_correlation(measured_n, simulated_n),
    )


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _ratio(a: float, b: float) -> float | None:
    return a / b if b != 0.0 else None


def _correlation(a: FloatArray, b: FloatArray) -> float | None:
    a, b = a - a.mean(), b - b.mean()
    power = float(np.sqrt(np.sum(a * a) * np.sum(b * b)))
    tiny = 1e-12 * len(a) * float(np.abs(a).max() * np.abs(b).max() or 1.0)
    return float(np.clip(np.sum(a * b) / power, -1.0, 1.0)) if power > tiny else None
