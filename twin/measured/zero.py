"""Zero of the amplifier: a constant offset, or a line through what was recorded while nothing was cut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from twin.arrays import FloatArray, frozen
from twin.errors import MeasuredError
from twin.measured.log import AXES, Correction, ForceLog, Gap

#: A line needs air at times that are this part of the log apart.
_LEAST_SPREAD = 0.2
_LEAST_SAMPLES = 10


def shift_zero(log: ForceLog, offset_n: Sequence[float], origin: str = "as given") -> ForceLog:
    """Subtract a constant.

    Args:
        offset_n: x, y, z: reading of the log (as force on the tool, machine axes) without force.
        origin: source of the numbers, human-readable.
    """
    zero = np.array([o if axis in log.axes else 0.0 for axis, o in zip(AXES, offset_n, strict=True)])
    listed = ", ".join(f"{axis} {o:.4g} N" for axis, o in zip(AXES, zero.tolist(), strict=True) if axis in log.axes)
    done = Correction(kind="offset", text=f"offset {listed} subtracted, {origin}", values={"offset_n": zero.tolist()})
    return _less(log, np.broadcast_to(zero, log.force_n.shape), done)


def offset_of(log: ForceLog, air: Sequence[Gap]) -> FloatArray:
    """Shape (3,), mean force over air segments.

    Raises:
        MeasuredError: no samples in them.
    """
    inside = in_windows(log.t_s, air)
    if inside.sum() < _LEAST_SAMPLES:
        raise _no_air(log, air)
    return np.asarray(log.force_n[inside].mean(axis=0))


def remove_drift(log: ForceLog, air: Sequence[Gap]) -> ForceLog:
    """Subtract a line for each axis, fitted by least squares to air segments.

    Raises:
        MeasuredError: no samples in them, or all at one end of the log.
    """
    inside = in_windows(log.t_s, air)
    if inside.sum() < _LEAST_SAMPLES:
        raise _no_air(log, air)
    t_s = log.t_s[inside]
    if np.ptp(t_s) < _LEAST_SPREAD * log.duration_s:
        raise MeasuredError(
            f"{log.source}: air only from {t_s[0]:.3f} to {t_s[-1]:.3f} s of {log.duration_s:.3f} s; for a line "
            "expected air at both ends of the log: correct the offset alone"
        )
    middle = float(t_s.mean())
    slope, level = np.polyfit(t_s - middle, log.force_n[inside], 1)
    line = level + (log.t_s - middle)[:, None] * slope
    listed = ", ".join(f"{axis} {s:.3g} N/s" for axis, s in zip(AXES, slope.tolist(), strict=True) if axis in log.axes)
    done = Correction(
        kind="drift",
        text=f"line through the air segments subtracted: {listed}",
        values={"drift_n_s": slope.tolist(), "level_n": level.tolist(), "at_s": middle},
    )
    return _less(log, line, done)


def in_windows(t_s: FloatArray, windows: Sequence[Gap]) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Shape (n,), which times lie in one of the windows."""
    inside = np.zeros(len(t_s), bool)
    for begin, end in windows:
        inside |= (t_s >= begin) & (t_s <= end)
    return inside


def _less(log: ForceLog, what: FloatArray, done: Correction) -> ForceLog:
    force = log.force_n - what
    for index, axis in enumerate(AXES):
        if axis not in log.axes:
            force[:, index] = 0.0
    return replace(log, force_n=frozen(force, "force_n", (None, 3)), corrections=(*log.corrections, done))


def _no_air(log: ForceLog, air: Sequence[Gap]) -> MeasuredError:
    listed = ", ".join(f"{a:.4f} to {b:.4f} s" for a, b in air) or "none"
    begin, end = log.span_s
    return MeasuredError(
        f"{log.source}: no samples in the air segments ({listed}), the log covers {begin:.4f} to {end:.4f} s; "
        "give the segment by --offset BEGIN:END on the log's clock, or the offset by --offset X,Y,Z"
    )
