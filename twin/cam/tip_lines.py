"""How low a tool may go along straight lines over a part: the upper boundary of its inflated slices.

For scanning paths only the upper boundary of an inflated part counts. On the plane of a line it is the envelope of all
neighbouring profiles, each inflated by the tool's section at its distance (the tri-slice paper, eq. 1); it is computed
without polygons, exactly along the line. Between slices, where heights change smoothly, their largest is interpolated by
a parabola across three slices; at edges and walls it is not.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cam import tip_line_kernels as kernels
from twin.cam.element import StructuringElement
from twin.cam.sections import Sections


@dataclass(frozen=True, slots=True, eq=False)
class Profiles:
    """The upper sides of a part's sections across x or y, ready for `tip_heights`.

    Attributes:
        axis: 0 for sections normal to x (lines along y), 1 for sections normal to y (lines along x).
        positions_mm: shape (m,), increasing.
        segments, segment_begins, corners, corner_begins: see `twin.cam.tip_line_kernels.profile_pieces`.
        low_mm, high_mm: range along the lines that the sections fill.
    """

    axis: int
    positions_mm: FloatArray
    segments: FloatArray
    segment_begins: NDArray[np.int64]
    corners: FloatArray
    corner_begins: NDArray[np.int64]
    low_mm: float
    high_mm: float

    @classmethod
    def of(cls, sections: Sections) -> Profiles:
        """Prepare sections across x or y.

        Raises:
            ValueError: sections across z.
        """
        if sections.axis not in (0, 1):
            raise ValueError(f"profiles need sections across x or y, got axis {sections.axis}")
        rings = [r for region in sections.regions for r in region.rings]
        points = np.concatenate(rings) if rings else np.empty((0, 2))
        begins = np.cumsum([0] + [len(r) for r in rings])
        firsts = np.cumsum([0] + [len(region.rings) for region in sections.regions])
        segments, corners = np.empty((len(points), 6)), np.empty((len(points), 6))
        segment_begins, corner_begins = np.empty((2, len(firsts)), dtype=np.int64)
        kernels.profile_pieces(points, begins, firsts, segments, segment_begins, corners, corner_begins)
        low, high = (float(points[:, 0].min()), float(points[:, 0].max())) if len(points) else (0.0, 0.0)
        return cls(
            axis=sections.axis,
            positions_mm=sections.positions_mm,
            segments=segments[: segment_begins[-1]].copy(),
            segment_begins=segment_begins,
            corners=corners[: corner_begins[-1]].copy(),
            corner_begins=corner_begins,
            low_mm=low,
            high_mm=high,
        )


def tip_heights(
    profiles: Profiles,
    element: StructuringElement,
    planes_mm: FloatArray,
    start_mm: float,
    step_mm: float,
    count: int,
    *,
    allowance_mm: float = 0.0,
    smooth: bool = True,
    threads: int | None = None,
) -> FloatArray:
    """Lowest heights of an element's reference point along lines over a part.

    Args:
        element: `StructuringElement.tool` gives heights of the tool's tip, `StructuringElement.ball` of the ball's
            centre.
        planes_mm: shape (p,), positions of the lines across the sections' axis: y of lines along x, or x of lines
            along y. Any positions will do.
        start_mm, step_mm, count: evenly spaced places along every line.
        allowance_mm: material to leave everywhere.
        smooth: False leaves out what lies between sections, as the paper does: heights are then never too large.
        threads: threads to work with, all cores if not given; results do not depend on it.

    Returns:
        shape (p, count), mm; -inf where the tool touches nothing.

    Raises:
        ToolError: an allowance that the element cannot have.
    """
    grown = element.with_allowance(allowance_mm)
    planes = np.ascontiguousarray(planes_mm, dtype=np.float64)
    heights = np.empty((len(planes), count))

    def part(rows: slice) -> None:
        kernels.envelope(
            profiles.segments,
            profiles.segment_begins,
            profiles.corners,
            profiles.corner_begins,
            profiles.positions_mm,
            planes[rows],
            grown.disc_mm,
            grown.corner_mm,
            start_mm,
            step_mm,
            smooth,
            heights[rows],
        )

    _in_parts(part, len(planes), threads or os.cpu_count() or 1)
    return heights + grown.drop_mm


def _in_parts(work, count: int, threads: int) -> None:  # type: ignore[no-untyped-def]
    """Call a function with runs of rows, in threads."""
    size = max(1, -(-count // (4 * threads)))
    runs = [slice(i, min(i + size, count)) for i in range(0, count, size)]
    if threads == 1:
        for run in runs:
            work(run)
    else:
        with ThreadPoolExecutor(max_workers=threads) as pool:
            list(pool.map(work, runs))
