"""Periodic forces as multiples of the spindle frequency: a waveform over one revolution, and how it is measured.

A waveform F(phi) has the coefficients c_h with F = Re sum c_h exp(i h phi), c_0 the mean. Least squares on samples that
fill whole revolutions and least squares on these coefficients are the same (Parseval); turning the phase by p
multiplies c_h by exp(i h p).
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from twin.arrays import FloatArray

ComplexArray = NDArray[np.complex128]

#: Part of the given spindle speed within which the true one is looked for.
SPEED_RANGE = 0.01
#: Multiples of the tooth-passing frequency that speed is found by.
_SPEED_ORDERS = 4
#: Trial speeds for each that could be told apart.
_FINENESS = 4
_CHUNK = 16384
#: Samples that speed is found in; more make it no surer and only slower.
_MOST_SPEED_SAMPLES = 40_000


def of_waveform(waveform: NDArray[np.float64], harmonics: int, first_rad: float) -> ComplexArray:
    """Coefficients of values at evenly spaced angles over one revolution.

    Args:
        waveform: shape (n, ...), n above twice ``harmonics``.
        first_rad: angle of the first value.

    Returns:
        Shape (harmonics + 1, ...).
    """
    n = len(waveform)
    c = np.fft.rfft(waveform, axis=0)[: harmonics + 1] * (2.0 / n)
    c[0] *= 0.5
    turn = np.exp(-1j * first_rad * np.arange(harmonics + 1))
    return np.asarray(c * turn.reshape(-1, *([1] * (waveform.ndim - 1))))


def to_waveform(coefficients: ComplexArray, angle_rad: FloatArray) -> FloatArray:
    """Values at angles, shape (n, ...)."""
    basis = np.exp(1j * np.outer(angle_rad, np.arange(len(coefficients))))
    return np.asarray(np.tensordot(basis, coefficients, axes=(1, 0)).real)


def of_samples(
    t_s: FloatArray, force_n: FloatArray, omega_rad_s: float, harmonics: int
) -> tuple[ComplexArray, FloatArray]:
    """Least squares of samples on multiples of a frequency; angle 0 is at t = 0.

    Args:
        force_n: shape (n, axes).

    Returns:
        coefficients, shape (harmonics + 1, axes), and the standard deviation of what is left on each axis.
    """
    columns = 2 * harmonics + 1
    normal, right = np.zeros((columns, columns)), np.zeros((columns, force_n.shape[1]))
    total = np.zeros(force_n.shape[1])
    for basis, part in _basis(t_s, force_n, omega_rad_s, harmonics):
        normal += basis.T @ basis
        right += basis.T @ part
        total += (part**2).sum(axis=0)
    k = np.linalg.lstsq(normal, right, rcond=None)[0]
    left = np.maximum(total - (k * right).sum(axis=0), 0.0)
    sigma = np.sqrt(left / max(1, len(t_s) - columns))
    c = np.concatenate((k[:1].astype(complex), k[1 : harmonics + 1] - 1j * k[harmonics + 1 :]))
    return c, sigma


def _basis(
    t_s: FloatArray, force_n: FloatArray, omega_rad_s: float, harmonics: int
) -> Iterator[tuple[FloatArray, FloatArray]]:
    orders = np.arange(1, harmonics + 1)
    for first in range(0, len(t_s), _CHUNK):
        part = slice(first, first + _CHUNK)
        angle = np.outer(omega_rad_s * t_s[part], orders)
        yield np.concatenate((np.ones((len(angle), 1)), np.cos(angle), np.sin(angle)), axis=1), force_n[part]


def find_speed(t_s: FloatArray, force_n: FloatArray, rpm: float, teeth: int) -> float:
    """The spindle speed near the given one at which multiples of the tooth-passing frequency hold most of the power."""
    middle = len(t_s) // 2
    half = min(middle, _MOST_SPEED_SAMPLES // 2)
    t = t_s[middle - half : middle + half] - t_s[middle]
    f = force_n[middle - half : middle + half]
    f = f - f.mean(axis=0)
    rate = (len(t) - 1) / (t[-1] - t[0])
    base = teeth * rpm * 2.0 * math.pi / 60.0
    orders = [k for k in range(1, _SPEED_ORDERS + 1) if k * base < math.pi * rate * 0.9] or [1]

    def lost(part: float) -> float:
        turn = np.exp(-1j * base * (1.0 + part) * t)
        power, wave = 0.0, np.ones(len(t), dtype=complex)
        for order in range(1, max(orders) + 1):
            wave = wave * turn
            if order in orders:
                power += float(np.sum(np.abs(wave @ f) ** 2))
        return -power

    cycles = base * max(orders) / (2.0 * math.pi) * (t[-1] - t[0])
    trials = np.linspace(-SPEED_RANGE, SPEED_RANGE, 2 * math.ceil(_FINENESS * SPEED_RANGE * cycles) + 1)
    best = float(trials[int(np.argmin([lost(p) for p in trials]))])
    width = float(trials[1] - trials[0])
    found = optimize.minimize_scalar(
        lost, bounds=(best - width, best + width), method="bounded", options={"xatol": 1e-9}
    )
    return rpm * (1.0 + float(found.x))
