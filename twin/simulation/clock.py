"""The spindle's angle through a program, and the times at which it passes multiples of the angle step."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np

from twin.arrays import FloatArray

#: Times and signed spindle angles of samples, both of shape (n,).
Turned: TypeAlias = tuple[FloatArray, FloatArray]

#: No samples.
UNSAMPLED: Turned = (np.zeros(0), np.zeros(0))
#: A sample this close before a step's end, in angle steps, belongs to the next step.
_EDGE = 1e-9


class SpindleClock:
    """Turns with the spindle, from angle 0 at program start, and never jumps.

    Samples are counted by the angle turned, in either direction: the n-th is taken when the spindle has turned by n
    angle steps.

    Args:
        rows: samples per revolution.
    """

    def __init__(self, rows: int) -> None:
        self._step_rad = 2.0 * math.pi / rows
        self._rows = rows
        self._turned_steps = 0.0
        self._angle_rad = 0.0

    def advance(self, t_s: float, duration_s: float, spindle_rpm: float, *, ends_only: bool = False) -> Turned:
        """Turn for a while; the samples that are taken meanwhile.

        Args:
            t_s: machine time at the beginning.
            duration_s: how long to turn.
            spindle_rpm: signed speed.
            ends_only: of more than two samples return the first and the last only.

        Returns:
            Times and signed spindle angles of the samples in [t_s, t_s + duration_s), both of shape (n,).
        """
        if spindle_rpm == 0.0 or duration_s <= 0.0:
            return UNSAMPLED
        sense = math.copysign(1.0, spindle_rpm)
        rate = abs(spindle_rpm) / 60.0 * self._rows
        before, angle_rad = self._turned_steps, self._angle_rad
        self.turn(duration_s, spindle_rpm)
        after = self._turned_steps
        first, end = math.ceil(before - _EDGE), math.ceil(after - _EDGE)
        few = ends_only and end - first > 2
        numbers = np.array([first, end - 1.0]) if few else np.arange(first, end, dtype=np.float64)
        times = t_s + np.maximum(0.0, (numbers - before) / rate)
        return times, angle_rad + sense * (numbers - before) * self._step_rad

    def turn(self, duration_s: float, spindle_rpm: float) -> None:
        """Turn for a while without taking samples."""
        if spindle_rpm == 0.0 or duration_s <= 0.0:
            return
        before = self._turned_steps
        self._turned_steps = before + abs(spindle_rpm) / 60.0 * self._rows * duration_s
        self._angle_rad += math.copysign(1.0, spindle_rpm) * (self._turned_steps - before) * self._step_rad
