"""CL lines over triangles, from the drop-cutter's heights, which are exact at every point."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cam.slices.polylines import FINER, Samples, polylines


def drop_lines(
    lowest: Callable[[FloatArray], FloatArray],
    along: int,
    planes_mm: FloatArray,
    samples: Samples,
    *,
    floor_mm: float,
    chord_mm: float,
) -> list[FloatArray]:
    """The polylines that a tip follows along x or y, see `twin.cam.slices.polylines.polylines`.

    Args:
        lowest: lowest tips over plan points, shape (n, 2), as `twin.cam.surface.drop_cutter.DropCutter.drop`.
        along: 0 for lines along x, 1 for lines along y.
        planes_mm: shape (p,), positions of the lines across that.
        samples: the evenly spaced samples to begin with.
        floor_mm: least height.
        chord_mm: how far chords may lie off.
    """
    planes = np.asarray(planes_mm, dtype=np.float64)

    def heights(at: FloatArray, across: FloatArray) -> FloatArray:
        at, across = np.broadcast_arrays(at, across)
        points = (at.ravel(), across.ravel()) if along == 0 else (across.ravel(), at.ravel())
        return lowest(np.column_stack(points)).reshape(at.shape)

    def within(rows: NDArray[np.int64], cells: NDArray[np.int64]) -> FloatArray:
        inner = samples.step_mm / FINER * np.arange(FINER + 1)
        return heights(samples.at_mm[cells, None] + inner, planes[rows, None])

    return polylines(
        samples, heights(samples.at_mm[None, :], planes[:, None]), within, floor_mm=floor_mm, chord_mm=chord_mm
    )
