"""Kernels that sort numbers by keys; numba's own sorting takes much longer to compile."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from twin.jit import helper

#: Numbers that are sorted by insertion, before longer runs are merged.
_RUN = 16


@helper
def sort_by(order: NDArray[np.int64], keys: NDArray[Any]) -> None:
    """Sort indices of keys, those of equal keys in the order they were in.

    Args:
        order: indices of keys, sorted in place.
        keys: of any kind that compares; not a number is not a key.
    """
    count = len(order)
    for first in range(0, count, _RUN):
        for i in range(first + 1, min(first + _RUN, count)):
            index, k = order[i], i
            while k > first and keys[order[k - 1]] > keys[index]:
                order[k] = order[k - 1]
                k -= 1
            order[k] = index
    if count <= _RUN:
        return
    aside = np.empty(count, dtype=np.int64)
    run = _RUN
    while run < count:
        for first in range(0, count - run, 2 * run):
            _merge(order, keys, aside, first, first + run, min(first + 2 * run, count))
        run *= 2


@helper
def order_of(keys: NDArray[Any]) -> NDArray[np.int64]:
    """Indices of keys in the order of the keys, those of equal keys increasing."""
    order = np.empty(len(keys), dtype=np.int64)
    for i in range(len(keys)):
        order[i] = i
    sort_by(order, keys)
    return order


@helper
def _merge(
    order: NDArray[np.int64], keys: NDArray[Any], aside: NDArray[np.int64], first: int, middle: int, last: int
) -> None:
    """Merge the sorted runs from ``first`` and from ``middle``; of equal keys those of the first run come first."""
    if not keys[order[middle - 1]] > keys[order[middle]]:
        return
    for i in range(first, middle):
        aside[i] = order[i]
    left, right, k = first, middle, first
    while left < middle:
        if right < last and keys[order[right]] < keys[aside[left]]:
            order[k] = order[right]
            right += 1
        else:
            order[k] = aside[left]
            left += 1
        k += 1
