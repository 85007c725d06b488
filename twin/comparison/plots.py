"""Pictures of a comparison, as PNG bytes. Measured grey, simulated in the axis's colour, errors red."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator
from scipy import signal

from twin.arrays import FloatArray
from twin.comparison.comparison import Comparison, WindowResult
from twin.measured.log import AXES
from twin.pages.figures import AXIS_COLOURS, DPI, RESULTANT, WIDTH, dress, png, stack

_MEASURED = "#5b626c"
_ERROR = "#a03090"
#: A record is drawn as the band between its extremes once it has more samples than this.
_BAND_SAMPLES = 6000
_BANDS = 1800
_SPECTRUM_S = 0.5
_ANGLE_BINS = 72


def whole_record(found: Comparison) -> bytes:
    """All axes over the whole overlap, the windows shaded."""
    axes = found.log.axes
    figure, parts = stack(len(axes), 1.9)
    for part, axis in zip(parts, axes, strict=True):
        i = AXES.index(axis)
        _curve(part, found.t_s, found.measured_n[:, i], _MEASURED, "measured", 1.0)
        _curve(part, found.t_s, found.simulated_n[:, i], AXIS_COLOURS[axis], "simulated", 0.75)
        for window in found.windows:
            if not window.whole:
                part.axvspan(*window.span_s, color="#ffe28a", lw=0, zorder=0)
                for edge in window.span_s:
                    part.axvline(edge, color="#d99a00", lw=0.8, zorder=4)
        dress(part, f"F{axis}, N")
    parts[-1].set_xlabel("run time, s")
    return png(figure)


def window_waveforms(found: Comparison, window: WindowResult) -> bytes:
    """All axes in one window, and the error below the two."""
    axes = found.log.axes
    figure, parts = stack(len(axes), 2.1)
    for part, axis in zip(parts, axes, strict=True):
        i = AXES.index(axis)
        measured, simulated = window.measured_n[:, i], window.simulated_n[:, i]
        _curve(part, window.t_s, measured, _MEASURED, "measured", 1.0)
        _curve(part, window.t_s, simulated, AXIS_COLOURS[axis], "simulated", 0.9)
        if len(window.t_s) <= _BAND_SAMPLES:
            part.plot(window.t_s, simulated - measured, color=_ERROR, lw=0.9, label="simulated − measured")
        part.axhline(0.0, color="#c9ced6", lw=0.7, zorder=0)
        dress(part, f"F{axis}, N")
    parts[-1].set_xlabel("run time, s")
    return png(figure)


def spectra(found: Comparison) -> bytes:
    """Amplitude spectra over the whole overlap, multiples of the tooth-passing frequency marked."""
    axes = found.log.axes
    figure, parts = stack(len(axes), 1.9)
    turning = found.run.speed_in((float(found.t_s[0]), float(found.t_s[-1])))
    passing = abs(turning[0]) / 60.0 * turning[1] if turning else 0.0
    top = min(0.5 * found.log.rate_hz, 12.0 * passing if passing else np.inf)
    for part, axis in zip(parts, axes, strict=True):
        i = AXES.index(axis)
        for values, color, name in (
            (found.measured_n, _MEASURED, "measured"),
            (found.simulated_n, AXIS_COLOURS[axis], "simulated"),
        ):
            hz, amplitude = _amplitudes(values[:, i], found.log.rate_hz)
            keep = hz <= top
            part.semilogy(hz[keep], np.maximum(amplitude[keep], 1e-6), color=color, lw=1.0, label=name)
        for k in range(1, 13):
            if passing and k * passing <= top:
                part.axvline(k * passing, color="#c9ced6", lw=0.7, zorder=0)
        low, high = part.get_ylim()
        part.set_ylim(max(low, 1e-4 * high), high)
        part.set_xlim(0.0, top)
        dress(part, f"F{axis} amplitude, N")
    parts[-1].set_xlabel(
        "frequency, Hz" + (f"  (lines: multiples of {passing:g} Hz, tooth passing)" if passing else "")
    )
    return png(figure)


def error_histogram(found: Comparison) -> bytes:
    """Frequency of errors, each axis, each window."""
    axes = found.log.axes
    figure = Figure(figsize=(WIDTH, 2.7), dpi=DPI, layout="constrained")
    parts = figure.subplots(1, len(axes), sharey=True, squeeze=False)[0]
    styles = ("-", "--", ":", "-.")
    for part, axis in zip(parts, axes, strict=True):
        i = AXES.index(axis)
        errors = [w.simulated_n[:, i] - w.measured_n[:, i] for w in found.windows]
        reach = float(np.percentile(np.abs(np.concatenate(errors)), 99.8)) or 1.0
        fewest = min(len(e) for e in errors)
        edges = np.linspace(-reach, reach, 2 * int(np.clip(0.9 * np.sqrt(fewest), 4, 25)) + 1)
        for k, (window, error) in enumerate(zip(found.windows, errors, strict=True)):
            counts = np.histogram(error, edges)[0] / len(error)
            name = f"{window.span_s[0]:g}–{window.span_s[1]:g} s"
            part.stairs(100.0 * counts, edges, color=AXIS_COLOURS[axis], ls=styles[k % 4], lw=1.3, label=name)
        part.axvline(0.0, color="#c9ced6", lw=0.7, zorder=0)
        dress(part, "", len(found.windows) <= 4)
        part.set_xlabel(f"error of F{axis}, N")
    parts[0].set_ylabel("samples, %")
    return png(figure)


def polar(found: Comparison, window: WindowResult) -> bytes:
    """Force against the spindle's angle: mean and range of the measurement over the turns, mean of the simulation."""
    axes = found.log.axes
    figure = Figure(figsize=(WIDTH, 3.05), dpi=DPI, layout="constrained")
    names = [*axes, "resultant"] if len(axes) > 1 else list(axes)
    for k, axis in enumerate(names):
        part = figure.add_subplot(1, len(names), k + 1, projection="polar")
        assert isinstance(part, PolarAxes)
        _polar_axis(part, window, axis)
        part.set_title(f"|F{axis}|, N" if axis in AXES else "resultant, N", fontsize=9)
    handles, labels = figure.axes[-1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    return png(figure)


def _polar_axis(part: PolarAxes, window: WindowResult, axis: str) -> None:
    """One polar plot; angles as the spindle turns, 0 with the tip of tooth 0 at +x."""
    angle = np.mod(window.spindle_angle_rad, 2.0 * np.pi)
    bins = np.minimum((angle / (2.0 * np.pi) * _ANGLE_BINS).astype(int), _ANGLE_BINS - 1)
    middle = (np.arange(_ANGLE_BINS) + 0.5) * 2.0 * np.pi / _ANGLE_BINS
    measured, simulated = (_size(v, axis) for v in (window.measured_n, window.simulated_n))
    low, mean, high = _over_bins(measured, bins)
    _, simulated_mean, _ = _over_bins(simulated, bins)
    closed = np.append(middle, middle[0])

    def ring(values: FloatArray) -> FloatArray:
        return np.append(values, values[0])

    part.fill_between(closed, ring(low), ring(high), color=_MEASURED, alpha=0.22, lw=0, label="measured, all turns")
    part.plot(closed, ring(mean), color=_MEASURED, lw=1.3, label="measured, mean")
    color = AXIS_COLOURS.get(axis, RESULTANT)
    part.plot(closed, ring(simulated_mean), color=color, lw=1.3, label="simulated, mean")
    part.set_theta_direction(-1)
    part.set_thetagrids(range(0, 360, 90), fontsize=7)
    part.tick_params(labelsize=7, pad=-1)
    part.set_rlabel_position(22.5)
    part.yaxis.set_major_locator(MaxNLocator(3))
    part.grid(color="#d5dae1", lw=0.6)


def _size(force_n: FloatArray, axis: str) -> FloatArray:
    if axis in AXES:
        return np.abs(force_n[:, AXES.index(axis)])
    length: FloatArray = np.linalg.norm(force_n, axis=1)
    return length


def _over_bins(
    values: FloatArray, bins: np.ndarray[tuple[int], np.dtype[np.int_]]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Least, mean and greatest value in each bin; NaN where it is empty."""
    low, high = np.full(_ANGLE_BINS, np.inf), np.full(_ANGLE_BINS, -np.inf)
    np.minimum.at(low, bins, values)
    np.maximum.at(high, bins, values)
    count = np.bincount(bins, minlength=_ANGLE_BINS)
    total = np.bincount(bins, values, minlength=_ANGLE_BINS)
    empty = count == 0
    mean = np.where(empty, np.nan, total / np.maximum(count, 1))
    return np.where(empty, np.nan, low), mean, np.where(empty, np.nan, high)


def _amplitudes(values: FloatArray, rate_hz: float) -> tuple[FloatArray, FloatArray]:
    """Frequencies and amplitudes, averaged over stretches of about half a second."""
    size = min(len(values), max(64, round(_SPECTRUM_S * rate_hz)))
    hz, power = signal.welch(values, rate_hz, window="hann", nperseg=size, scaling="spectrum", detrend="constant")
    return np.asarray(hz), np.sqrt(2.0 * np.asarray(power))


def _curve(part: Axes, t_s: FloatArray, values: FloatArray, color: str, name: str, alpha: float) -> None:
    """A line, or the band between the extremes of neighbours where there are too many samples for a line."""
    if len(t_s) <= _BAND_SAMPLES:
        part.plot(t_s, values, color=color, lw=1.2, label=name, alpha=alpha)
        return
    size = len(t_s) // _BANDS
    count = len(t_s) // size
    blocks = values[: count * size].reshape(count, size)
    part.fill_between(
        t_s[: count * size : size],
        blocks.min(axis=1),
        blocks.max(axis=1),
        color=color,
        alpha=alpha * 0.75,
        lw=0.3,
        label=name,
    )
