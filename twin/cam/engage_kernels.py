"""A tool over stock that is known as heights on a grid: how low it may go before it touches; compiled."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from twin.arrays import FloatArray


@njit(cache=True, nogil=True)
def _rise(rho: float, shape: FloatArray) -> float:
    """Height of the tool's underside above its tip at a radius; inf outside."""
    disc, corner, slope, arc_radius, arc_height, height, largest = shape
    if rho <= disc:
        return 0.0
    if rho <= arc_radius:
        return corner - math.sqrt(max(0.0, corner * corner - (rho - disc) * (rho - disc)))
    if rho <= largest and slope > 0.0:
        return arc_height + (rho - arc_radius) / slope
    return math.inf


@njit(cache=True, nogil=True)
def tips_on_stock(
    points: FloatArray, heights: FloatArray, frame: FloatArray, shape: FloatArray, first: int, last: int, tips: FloatArray
) -> None:
    """Height of the tip at which a tool touches the stock.

    Args:
        points: shape (m, 2).
        heights: of the stock, shape (nx, ny).
        frame: place of grid point (0, 0) and the pitches along x and y.
        shape: `twin.tools.shape.ToolShape.parameters`.
        first, last: range of points to be worked on.
        tips: shape (m,), filled; -inf where nothing is under the tool.
    """
    nx, ny = heights.shape
    radius = shape[6]
    for k in range(first, last):
        x, y = points[k, 0], points[k, 1]
        best = -math.inf
        i0 = max(0, int(math.ceil((x - radius - frame[0]) / frame[2])))
        i1 = min(nx - 1, int(math.floor((x + radius - frame[0]) / frame[2])))
        for i in range(i0, i1 + 1):
            dx = frame[0] + i * frame[2] - x
            half = math.sqrt(max(0.0, radius * radius - dx * dx))
            j0 = max(0, int(math.ceil((y - half - frame[1]) / frame[3])))
            j1 = min(ny - 1, int(math.floor((y + half - frame[1]) / frame[3])))
            for j in range(j0, j1 + 1):
                if heights[i, j] <= best:
                    continue
                dy = frame[1] + j * frame[3] - y
                tip = heights[i, j] - _rise(math.sqrt(dx * dx + dy * dy), shape)
                if tip > best:
                    best = tip
        tips[k] = best


@njit(cache=True, nogil=True)
def runs(marked: np.ndarray, spacing: FloatArray, bridge: float, bounds: np.ndarray) -> int:
    """Runs of marked points; gaps shorter than a bridge are run through.

    Args:
        marked: shape (n,), bool.
        spacing: length from each point to the next, shape (n - 1,).
        bounds: shape (n, 2), filled with first and last point of each run.

    Returns:
        Number of runs.
    """
    count = 0
    gap = math.inf
    for k in range(len(marked)):
        if k > 0:
            gap += spacing[k - 1]
        if marked[k]:
            if count > 0 and gap <= bridge:
                bounds[count - 1, 1] = k
            else:
                bounds[count, 0] = bounds[count, 1] = k
                count += 1
            gap = 0.0
    return count
