"""How low a tool may go along straight lines over a part: the upper boundary of its inflated slices.

For scanning paths only the upper boundary of an inflated part counts. On the plane of a line it is the envelope of all
neighbouring profiles, each inflated by the tool's section at its distance (the tri-slice paper, eq. 1). It is computed
without polygons, exactly along the line. Between slices, where heights change smoothly, their largest is interpolated
by a parabola across three slices; at edges and walls it is not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cam.slices import cl_line_kernels as kernels
from twin.cam.slices.polylines import FINER, Samples, polylines
from twin.cam.slices.sections import Sections
from twin.cam.slices.structuring_element import StructuringElement
from twin.geometry.polygons.clip import DECIMALS, LEAST_AREA_MM2
from twin.geometry.polygons.region import Region, signed_area_mm2
from twin.geometry.threads import in_parts

#: Lines, and cells to refine, that are not worth several threads.
_FEW_PLANES, _FEW_CELLS = 4, 64
#: Distance of the samples of `cl_regions`, in square roots of chord times radius: an arc's own chord would be sqrt(8).
_STEP = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Profiles:
    """The upper sides of a part's sections across x or y, ready for `cl_heights`.

    Attributes:
        axis: 0 for sections normal to x (lines along y), 1 for sections normal to y (lines along x).
        pieces: their upper segments and corners.
        low_mm, high_mm: range along the lines that the sections fill.
        floor_mm: lowest point of the sections.
    """

    axis: int
    pieces: kernels.Pieces
    low_mm: float
    high_mm: float
    floor_mm: float

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
        segments = np.empty((len(points), kernels.SEGMENT_COLUMNS))
        corners = np.empty((len(points), kernels.CORNER_COLUMNS))
        segment_begins, corner_begins = np.empty((2, len(firsts)), dtype=np.int64)
        outlines = kernels.Outlines(points, begins, firsts)
        kernels.profile_pieces(outlines, segments, segment_begins, corners, corner_begins)
        low, high = (float(points[:, 0].min()), float(points[:, 0].max())) if len(points) else (0.0, 0.0)
        return cls(
            axis=sections.axis,
            pieces=kernels.Pieces(
                np.ascontiguousarray(segments[: segment_begins[-1]].T),
                segment_begins,
                np.ascontiguousarray(corners[: corner_begins[-1]].T),
                corner_begins,
                sections.positions_mm,
            ),
            low_mm=low,
            high_mm=high,
            floor_mm=float(points[:, 1].min()) if len(points) else 0.0,
        )


def cl_heights(
    profiles: Profiles,
    element: StructuringElement,
    planes_mm: FloatArray,
    samples: Samples,
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
        samples: along every line.
        allowance_mm: material to leave everywhere.
        smooth: False omits material between sections, as the paper does: heights are then never too large.
        threads: threads to work with, all cores if not given; results do not depend on it.

    Returns:
        shape (p, n), mm; -inf where the tool touches nothing.

    Raises:
        ToolError: an allowance that the element cannot have.
    """
    grown = element.with_allowance(allowance_mm)
    return _heights(profiles, grown, planes_mm, samples, smooth, threads)[0]


def _heights(
    profiles: Profiles,
    element: StructuringElement,
    planes_mm: FloatArray,
    samples: Samples,
    smooth: bool,
    threads: int | None,
) -> tuple[FloatArray, NDArray[np.int64]]:
    """Heights, and the section that is touched at each."""
    planes = np.ascontiguousarray(planes_mm, dtype=np.float64)
    heights, best = np.empty((len(planes), samples.count)), np.empty((len(planes), samples.count), dtype=np.int64)

    row = kernels.SampleRow(float(samples.start_mm), float(samples.step_mm), samples.count)
    end = kernels.ToolEnd(float(element.disc_mm), float(element.corner_radius_mm))

    def part(first: int, last: int) -> None:
        kernels.envelope(profiles.pieces, end, planes[first:last], row, smooth, heights[first:last], best[first:last])

    in_parts(part, len(planes), threads=threads, few=_FEW_PLANES)
    return heights + element.drop_mm, best


def cl_lines(
    profiles: Profiles,
    element: StructuringElement,
    planes_mm: FloatArray,
    samples: Samples,
    floor_mm: float,
    *,
    allowance_mm: float = 0.0,
    chord_mm: float = 0.001,
    smooth: bool = True,
    threads: int | None = None,
) -> list[FloatArray]:
    """The polylines that an element's reference point follows along lines over a part.

    Heights as of `cl_heights`, with samples in between wherever chords would stand off by more than ``chord_mm``, at
    inner corners and at walls: there the line first leaves the wall and then descends vertically.

    Args:
        samples: the evenly spaced samples to begin with; the first and the last are the lines' ends.
        floor_mm: least height, also where the tool touches nothing.
        chord_mm: how far chords may stand off.

    Returns:
        for every plane shape (n, 2): position along the line, increasing or equal, and height.

    Raises:
        ToolError: an allowance that the element cannot have.
    """
    grown = element.with_allowance(allowance_mm)
    heights, best = _heights(profiles, grown, planes_mm, samples, smooth, threads)

    def within(rows: NDArray[np.int64], cells: NDArray[np.int64]) -> FloatArray:
        touched = np.stack((best[rows, cells], best[rows, cells + 1]), axis=1)
        return _refined(profiles, grown, np.asarray(planes_mm)[rows], samples, cells, touched, smooth, threads)

    return polylines(samples, heights, within, floor_mm=floor_mm, chord_mm=chord_mm)


def cl_regions(
    sections: Sections,
    element: StructuringElement,
    planes_mm: FloatArray,
    *,
    chord_mm: float,
    threads: int | None = None,
) -> tuple[Region, ...]:
    """Areas below the CL lines, down to the part's lowest point: where the tip of a tool may not be.

    Args:
        sections: across x or y.
        chord_mm: how far chords may stand off.
    """
    profiles = Profiles.of(sections)
    radius, floor = element.radius_mm, profiles.floor_mm
    step = _STEP * math.sqrt(chord_mm * radius)
    samples = Samples.between(profiles.low_mm - radius, profiles.high_mm + radius, step)
    lines = cl_lines(profiles, element, planes_mm, samples, floor, chord_mm=chord_mm, smooth=False, threads=threads)
    return tuple(Region.of(*_below(line, floor)) for line in lines)


def _below(line: FloatArray, floor_mm: float) -> list[FloatArray]:
    """The areas between a line and the floor as rings, counter-clockwise."""
    high = np.concatenate(([False], line[:, 1] > floor_mm, [False]))
    changes = np.flatnonzero(np.diff(high.astype(np.int8)))
    rings = []
    for first, last in zip(changes[::2], changes[1::2], strict=True):
        run = line[first:last]
        before = line[first - 1] if first > 0 else np.array((run[0, 0], floor_mm))
        after = line[last] if last < len(line) else np.array((run[-1, 0], floor_mm))
        ring = np.round(np.vstack((before, run, after))[::-1], DECIMALS)
        ring = ring[np.any(ring != np.roll(ring, 1, axis=0), axis=1)]
        if len(ring) >= 3 and signed_area_mm2(ring) > LEAST_AREA_MM2:
            rings.append(ring)
    return rings


def _refined(
    profiles: Profiles,
    element: StructuringElement,
    planes_mm: FloatArray,
    samples: Samples,
    cells: NDArray[np.int64],
    touched: NDArray[np.int64],
    smooth: bool,
    threads: int | None,
) -> FloatArray:
    """Heights within cells, shape (cells, FINER + 1)."""
    starts = np.column_stack((planes_mm, samples.at_mm[cells]))
    heights = np.empty((len(cells), FINER + 1))

    end, step = kernels.ToolEnd(float(element.disc_mm), float(element.corner_radius_mm)), float(samples.step_mm) / FINER

    def part(first: int, last: int) -> None:
        kernels.refine(profiles.pieces, end, starts[first:last], touched[first:last], step, smooth, heights[first:last])

    in_parts(part, len(cells), threads=threads, few=_FEW_CELLS)
    return heights + element.drop_mm
