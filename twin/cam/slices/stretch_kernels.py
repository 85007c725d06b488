"""Runs of marked points along a line; compiled."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import njit


@njit
def runs(marked: NDArray[np.bool_], spacing: FloatArray, bridge: float, bounds: NDArray[np.int64]) -> int:
    """Runs of marked points; gaps shorter than a bridge are run through.

    Args:
        marked: shape (n,), bool.
        spacing: length from each point to the next, shape (n - 1,).
        bounds: shape (n, 2), filled with first and last point of each run.

    Returns:
        Number of runs.
    """
    count = 0
    gap = math.inf
    for k in range(len(marked)):
        if k > 0:
            gap += spacing[k - 1]
        if marked[k]:
            if count > 0 and gap <= bridge:
                bounds[count - 1, 1] = k
            else:
                bounds[count, 0] = bounds[count, 1] = k
                count += 1
            gap = 0.0
    return count
