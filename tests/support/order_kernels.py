"""The order of keys, for callers that are not compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from twin.geometry.sorting_kernels import order_of
from twin.jit import njit


@njit
def order(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """As `order_of`."""
    return order_of(keys)
