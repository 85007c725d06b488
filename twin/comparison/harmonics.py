"""Lines of the spindle and of the teeth, measured and simulated side by side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.arrays import FloatArray

#: Multiples of the tooth-passing frequency that are listed.
_MOST_TOOTH_LINES = 6
#: Window length in periods of the lowest line needed to separate the lines.
_LEAST_PERIODS = 1.0
#: Samples for each unknown of the fit.
_LEAST_SAMPLES = 2.0
#: A fit of this many samples is well conditioned: the normal equations, which are faster, serve as well.
_MANY_SAMPLES = 4000
#: Lines below this part of the largest one have no phase that means anything.
_FAINT = 0.02


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """One frequency of one axis.

    Attributes:
        order: multiple of the spindle's frequency.
        tooth_order: multiple of the tooth-passing frequency, None for a line of the spindle alone (runout).
        measured_n, simulated_n: amplitudes.
        phase_rad: simulated less measured, -pi to pi; None where a line is faint.
    """

    axis: str
    order: int
    tooth_order: int | None
    hz: float
    measured_n: float
    simulated_n: float
    phase_rad: float | None


def lines(
    axes: tuple[str, ...], t_s: FloatArray, measured_n: FloatArray, simulated_n: FloatArray, rpm: float, teeth: int
) -> list[Line]:
    """Amplitudes by a least-squares fit of sines, so that a window need not be whole periods.

    Args:
        t_s: shape (n,).
        measured_n, simulated_n: shape (n, k), k axes.
        rpm: spindle speed; its sign does not matter.

    Returns:
        none where the window is shorter than a tooth period, or sampled too coarsely. The spindle's own lines are among
        them from one revolution on.
    """
    spindle_hz = abs(rpm) / 60.0
    orders = _orders(t_s, spindle_hz, teeth)
    if not orders:
        return []
    measured, simulated = (_fit(t_s, values, spindle_hz, orders) for values in (measured_n, simulated_n))
    made = []
    for column, axis in enumerate(axes):
        top = float(np.abs(measured[:, column]).max())
        for row, order in enumerate(orders):
            m, s = complex(measured[row, column]), complex(simulated[row, column])
            clear = min(abs(m), abs(s)) > _FAINT * top and top > 0.0
            made.append(
                Line(
                    axis=axis,
                    order=order,
                    tooth_order=order // teeth if order % teeth == 0 else None,
                    hz=order * spindle_hz,
                    measured_n=abs(m),
                    simulated_n=abs(s),
                    phase_rad=float(np.angle(s * np.conj(m))) if clear else None,
                )
            )
    return made


def _orders(t_s: FloatArray, spindle_hz: float, teeth: int) -> list[int]:
    """Multiples of the spindle's frequency that the window can tell apart."""
    if len(t_s) < 8 or not spindle_hz > 0.0:
        return []
    step = float(np.median(np.diff(t_s)))
    length = float(t_s[-1] - t_s[0]) + step
    highest = 0.45 / step
    tooth = [k * teeth for k in range(1, _MOST_TOOTH_LINES + 1) if k * teeth * spindle_hz < highest]
    if length * spindle_hz * teeth < _LEAST_PERIODS * 0.999 or not tooth:
        return []
    spindle = list(range(1, teeth)) if length * spindle_hz >= _LEAST_PERIODS * 0.999 else []
    orders = sorted({*tooth, *(o for o in spindle if o * spindle_hz < highest)})
    return orders if len(t_s) >= _LEAST_SAMPLES * (2 * len(orders) + 1) else []


def _fit(
    t_s: FloatArray, values: FloatArray, spindle_hz: float, orders: list[int]
) -> np.ndarray[tuple[int, int], np.dtype[np.complex128]]:
    """Complex amplitudes, shape (orders, k): values = mean + Re(sum of amplitude exp(i order w t))."""
    turn = 2.0 * np.pi * spindle_hz * (t_s - t_s[0])
    columns = [np.ones(len(t_s))]
    for order in orders:
        columns += [np.cos(order * turn), np.sin(order * turn)]
    sines = np.column_stack(columns)
    if len(t_s) > _MANY_SAMPLES:
        found = np.linalg.solve(sines.T @ sines, sines.T @ values)
    else:
        found = np.linalg.lstsq(sines, values, rcond=None)[0]
    return np.asarray(found[1::2] - 1j * found[2::2])
