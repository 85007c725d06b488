"""Stretches of marked points along a line."""

from __future__ import annotations

import numpy as np
import pytest

from twin.cam.slices.stretch_kernels import runs


@pytest.mark.parametrize(
    ("marked", "bridge", "expected"),
    [
        ("....", 5.0, []),
        ("xxxx", 1.0, [(0, 3)]),
        ("xxx", 0.5, [(0, 0), (1, 1), (2, 2)]),
        (".xx.x", 1.5, [(1, 2), (4, 4)]),
        (".xx.x", 2.0, [(1, 4)]),
        ("x...x.x", 3.0, [(0, 0), (4, 6)]),
        ("x...x.x", 4.0, [(0, 6)]),
        ("...x", 9.0, [(3, 3)]),
    ],
)
def test_gaps_up_to_the_bridge_are_run_through(marked: str, bridge: float, expected: list[tuple[int, int]]) -> None:
    """A gap's length is that from the last marked point to the next."""
    bounds = np.zeros((len(marked), 2), dtype=np.int64)
    count = runs(np.array([m == "x" for m in marked]), np.ones(len(marked) - 1), bridge, bounds)
    assert [(int(a), int(b)) for a, b in bounds[:count]] == expected


def test_a_gap_is_measured_along_the_line() -> None:
    bounds = np.zeros((3, 2), dtype=np.int64)
    assert runs(np.array([True, False, True]), np.array([0.1, 0.2]), 0.31, bounds) == 1
    assert runs(np.array([True, False, True]), np.array([0.1, 0.25]), 0.31, bounds) == 2
