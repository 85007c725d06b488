"""The spindle's angle is continuous and its samples are counted, never lost or doubled."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.simulation.clock import SpindleClock


@given(st.lists(st.tuples(st.floats(1e-4, 0.5), st.sampled_from([0.0, 600.0, 3600.0, -1200.0])), max_size=30))
def test_samples_are_one_angle_step_apart_whatever_the_steps(parts: list[tuple[float, float]]) -> None:
    clock = SpindleClock(360)
    t, turned = 0.0, 0.0
    times, angles = [], []
    for duration, rpm in parts:
        sample_t, sample_angle = clock.advance(t, duration, rpm)
        assert np.all(sample_t >= t)
        assert np.all(sample_t < t + duration + 1e-9)
        times.extend(sample_t)
        angles.extend(sample_angle)
        t += duration
        turned += abs(rpm) / 60.0 * 360.0 * duration
    assert abs(len(times) - turned) <= 1.0 + 1e-6
    assert np.all(np.diff(times) > -1e-12)
    steps = np.abs(np.diff(angles))
    if all(rpm >= 0.0 for _, rpm in parts):
        assert steps == pytest.approx(np.full(len(steps), math.radians(1.0)), abs=1e-9)


def test_angle_starts_at_zero_and_m4_turns_back() -> None:
    clock = SpindleClock(4)
    times, angles = clock.advance(0.0, 1.0, 60.0)
    assert times.tolist() == [0.0, 0.25, 0.5, 0.75]
    assert angles == pytest.approx(np.radians([0.0, 90.0, 180.0, 270.0]))
    times, angles = clock.advance(1.0, 0.5, -60.0)
    assert times.tolist() == [1.0, 1.25]
    assert angles == pytest.approx(np.radians([360.0, 270.0]))


def test_a_standing_spindle_gives_no_samples() -> None:
    times, angles = SpindleClock(360).advance(3.0, 10.0, 0.0)
    assert len(times) == len(angles) == 0
