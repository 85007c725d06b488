"""Array types, and the checks made where data comes in."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray: TypeAlias = NDArray[np.float64]


def places_in_runs(counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """0, 1, 2 ... in each of several consecutive runs, shape (sum of counts,).

    Args:
        counts: length of each run, shape (n,).
    """
    return np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)


def frozen(values: ArrayLike, name: str, shape: tuple[int | None, ...]) -> FloatArray:
    """Copy values into a read-only float array of a given shape.

    Args:
        name: argument name for the message.
        shape: expected shape; None stands for any length.

    Raises:
        ValueError: wrong shape, or a value that is not finite.
    """
    array = np.array(values, dtype=np.float64)
    fits = array.ndim == len(shape) and all(w is None or w == g for w, g in zip(shape, array.shape, strict=True))
    if not fits:
        wanted = "(" + ", ".join("n" if w is None else str(w) for w in shape) + ")"
        raise ValueError(f"{name} must have shape {wanted}, got {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got {array[~np.isfinite(array)][0]}")
    array.flags.writeable = False
    return array
