"""Triangle surfaces over a plan, from a function of height."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from twin.arrays import FloatArray


def terrain(height: Callable[[FloatArray, FloatArray], FloatArray], fields: int, size_mm: float = 6.0) -> FloatArray:
    """Two triangles for each of fields x fields squares, shape (2 fields^2, 3, 3), turned upwards."""
    x, y = np.meshgrid(*(np.linspace(0.0, size_mm, fields + 1),) * 2, indexing="ij")
    net = np.stack((x, y, height(x, y)), axis=-1)
    a, b, c, d = net[:-1, :-1], net[1:, :-1], net[1:, 1:], net[:-1, 1:]
    halves = [np.stack(t, axis=-2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))]
    return np.concatenate(halves)


def waves(x: FloatArray, y: FloatArray) -> FloatArray:
    """Smooth hills and hollows."""
    return np.asarray(np.sin(x) * np.cos(1.3 * y))


def rough(x: FloatArray, y: FloatArray) -> FloatArray:
    """Every vertex at a height of its own, the same in every run."""
    return np.random.default_rng(7).uniform(0.0, 2.0, x.shape)


def block(x: FloatArray, y: FloatArray) -> FloatArray:
    """A plateau with steep sides and sharp borders."""
    return np.where((x > 2.0) & (x < 4.0) & (y > 2.0) & (y < 5.0), 3.0, 0.0)


def plane32(x: FloatArray, y: FloatArray) -> FloatArray:
    """A slanted plane with the rounding of a file's 32-bit numbers: nearly level edges, up and down at random."""
    return np.asarray((0.3 * x + 0.1 * y).astype(np.float32).astype(np.float64))
