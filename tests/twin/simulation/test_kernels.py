"""Sums and peaks of a step's samples against numpy."""

from __future__ import annotations

import numpy as np
import pytest

from twin.simulation.kernels import measure


def test_sums_and_peaks_of_samples() -> None:
    rng = np.random.default_rng(3)
    force, torque, power = rng.normal(size=(50, 3)), rng.normal(size=50), rng.normal(size=50) - 10.0
    sums, peaks = measure(force, torque, power)
    resultant = np.linalg.norm(force, axis=1)
    assert sums == pytest.approx([*force.sum(axis=0), resultant.sum(), torque.sum()])
    assert peaks == pytest.approx([*np.abs(force).max(axis=0), resultant.max(), torque.max(), power.max()])
