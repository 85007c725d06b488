"""Sorting by keys in compiled code, against numpy's stable sort."""

from __future__ import annotations

import numpy as np
from support.order_kernels import order


def test_the_order_is_that_of_a_stable_sort() -> None:
    rng = np.random.default_rng(3)
    for count in (*range(70), 129, 1000):
        for keys in (rng.integers(0, 1 + count // 2, count), np.arange(count), np.arange(count)[::-1].copy()):
            np.testing.assert_array_equal(order(keys), np.argsort(keys, kind="stable"))
