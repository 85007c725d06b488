"""Sums and peaks of force samples; compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from twin.arrays import FloatArray
from twin.jit import njit

#: Entries of sums and peaks; power has a peak only.
FX, FY, FZ, RESULTANT, TORQUE, POWER = range(6)


class Measured(NamedTuple):
    """Samples of one step.

    Attributes:
        sums: shape (5,), of Fx, Fy, Fz, the resultant, the torque.
        peaks: shape (6,), largest sizes of Fx, Fy, Fz, largest resultant, torque, power.
    """

    sums: FloatArray
    peaks: FloatArray


@njit
def measure(force: FloatArray, torque: FloatArray, power: FloatArray) -> Measured:
    """Sums and peaks of the samples of one step.

    Args:
        force: shape (n, 3), n > 0.
        torque, power: shape (n,).
    """
    sums, peaks = np.zeros(5), np.zeros(6)
    peaks[TORQUE], peaks[POWER] = torque[0], power[0]
    for i in range(len(torque)):
        x, y, z = force[i, 0], force[i, 1], force[i, 2]
        resultant = math.sqrt(x * x + y * y + z * z)
        sums[FX] += x
        sums[FY] += y
        sums[FZ] += z
        sums[RESULTANT] += resultant
        sums[TORQUE] += torque[i]
        peaks[FX] = max(peaks[FX], abs(x))
        peaks[FY] = max(peaks[FY], abs(y))
        peaks[FZ] = max(peaks[FZ], abs(z))
        peaks[RESULTANT] = max(peaks[RESULTANT], resultant)
        peaks[TORQUE] = max(peaks[TORQUE], torque[i])
        peaks[POWER] = max(peaks[POWER], power[i])
    return Measured(sums, peaks)
