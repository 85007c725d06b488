"""Sums and peaks of force samples; compiled."""

from __future__ import annotations

import math

import numpy as np

from twin.arrays import FloatArray
from twin.jit import njit

#: Entries of the result of `measure`.
SUMS, PEAKS = slice(0, 5), slice(5, 11)


@njit
def measure(force: FloatArray, torque: FloatArray, power: FloatArray) -> FloatArray:
    """Sums and peaks of the samples of one step.

    Args:
        force: shape (n, 3), n > 0.
        torque, power: shape (n,).

    Returns:
        Shape (11,): sums of Fx, Fy, Fz, of the resultant and the torque; largest sizes of Fx, Fy, Fz, largest
        resultant, torque, power.
    """
    out = np.zeros(11)
    out[9], out[10] = torque[0], power[0]
    for i in range(len(torque)):
        x, y, z = force[i, 0], force[i, 1], force[i, 2]
        resultant = math.sqrt(x * x + y * y + z * z)
        out[0] += x
        out[1] += y
        out[2] += z
        out[3] += resultant
        out[4] += torque[i]
        out[5] = max(out[5], abs(x))
        out[6] = max(out[6], abs(y))
        out[7] = max(out[7], abs(z))
        out[8] = max(out[8], resultant)
        out[9] = max(out[9], torque[i])
        out[10] = max(out[10], power[i])
    return out
