"""Phase of the spindle in one window, without a trigger or at a speed that was not quite the programmed one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize_scalar

from twin.arrays import FloatArray

_PARTS = 720
#: The search looks at no more samples than this.
_MOST_SAMPLES = 4000


def best_shift(
    simulated: Callable[[FloatArray], FloatArray], t_s: FloatArray, measured_n: FloatArray, turn_s: float
) -> tuple[float, FloatArray]:
    """The shift within half a revolution at which the simulation is nearest to the measurement in a window.

    Args:
        simulated: force at times, shape (m, 3).
        t_s: shape (m,), times of the window's samples.
        measured_n: shape (m, 3).
        turn_s: duration of a revolution.

    Returns:
        the shift, s: the simulation is taken that much later; and the simulation there, shape (m, 3).
    """
    some = slice(None, None, max(1, len(t_s) // _MOST_SAMPLES))

    def loss(shift_s: float) -> float:
        return float(np.sum((simulated(t_s[some] + shift_s) - measured_n[some]) ** 2))

    shifts = (np.arange(_PARTS + 1) / _PARTS - 0.5) * turn_s
    losses = [loss(s) for s in shifts.tolist()]
    start = float(shifts[int(np.argmin(losses))])
    step = turn_s / _PARTS
    found = minimize_scalar(loss, bounds=(start - step, start + step), method="bounded")
    best = float(found.x) if float(found.fun) < min(losses) else start
    return best, simulated(t_s + best)
