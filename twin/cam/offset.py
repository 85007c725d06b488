"""Offsets of sliced parts by convolution of neighbouring slices (the tri-slice paper, section 2.2, eq. 1).

The section of an inflated part on a plane is the union of all neighbouring sections, each inflated by the radius that
the structuring element has at its distance: sqrt(r^2 - d^2) for a ball. Shrinking is inflating what is not there.

Conventions. With `StructuringElement.ball` the result is where the ball's centre may not be; with
`StructuringElement.tool` where the tool's tip may not be (tools reach up without end). Rounding arcs are inscribed with
chords no further than ``chord_mm`` inside; sections between slices are left out, so an inflated part is never too large,
and a shrunk one never too small. How much it may lack is told by `bound_mm`.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import shapely

from twin.arrays import FloatArray, frozen
from twin.cam.element import StructuringElement
from twin.cam.sections import SlicedPart, Sections
from twin.geometry.region import Region
from twin.geometry.shapes import Shapes, to_region, to_shapes
from twin.workpiece.stock import SliceSet

#: Chords of rounding arcs stand this part of a slice pitch inside of them.
CHORD_PITCHES = 0.005

Radii = Callable[[FloatArray], FloatArray]


def inflate(
    part: SlicedPart | SliceSet,
    element: StructuringElement,
    *,
    allowance_mm: float = 0.0,
    axes: Sequence[int] = (0, 1, 2),
    chord_mm: float | None = None,
    threads: int | None = None,
) -> SliceSet:
    """Inflate a part by a structuring element.

    Args:
        part: a `SlicedPart`, whose faces across an axis are then exact, or bare slices, whose faces are known to half a
            pitch.
        element: a ball about its centre, or a tool about its tip.
        allowance_mm: material to leave everywhere.
        axes: directions wanted; the others have no planes in the result.
        chord_mm: how far chords of rounding arcs may stand inside; `CHORD_PITCHES` of the pitch where not told.
        threads: threads to work with, all cores if not given; results do not depend on it.

    Returns:
        Slices at the same pitch and on the same planes, and as many more on every side as the element reaches.

    Raises:
        ToolError: an allowance that the element cannot have.
    """
    grown = element.with_allowance(allowance_mm)
    slices = part.slices if isinstance(part, SlicedPart) else part
    frame = _Frame.around(slices, grown)
    chord = CHORD_PITCHES * float(slices.pitch_mm.min()) if chord_mm is None else chord_mm
    families: list[tuple[Region, ...]] = [(), (), ()]
    for axis in axes:
        sections = part.sections(axis) if isinstance(part, SlicedPart) else Sections.of(part, axis)
        families[axis] = inflated_planes(sections, grown, frame.positions(axis), chord_mm=chord, threads=threads)
    return frame.slice_set(families)


def inflated_planes(
    sections: Sections,
    element: StructuringElement,
    planes_mm: FloatArray,
    *,
    chord_mm: float,
    threads: int | None = None,
) -> tuple[Region, ...]:
    """Sections of the inflated part on any planes; see `inflate`.

    Args:
        planes_mm: shape (n,), positions along the sections' axis.
    """
    return tuple(to_region(s) for s in _inflated_shapes(sections, element, planes_mm, chord_mm, threads))


def _inflated_shapes(
    sections: Sections, element: StructuringElement, planes_mm: FloatArray, chord_mm: float, threads: int | None
) -> Shapes:
    shapes = to_shapes(sections.regions)
    radii = element.z_radii_mm if sections.axis == 2 else element.ball_radii_mm
    return convolved(shapes, sections.positions_mm, planes_mm, radii, arc_segments(element.radius_mm, chord_mm), threads)


def inflate_individually(slices: SliceSet, radius_mm: float, *, chord_mm: float | None = None) -> SliceSet:
    """Inflate every slice alone, as if its neighbours were not there (the tri-slice paper, fig. 3): for comparison.

    The result depends on the direction of the slices, as it must not.
    """
    chord = CHORD_PITCHES * float(slices.pitch_mm.min()) if chord_mm is None else chord_mm
    segments = arc_segments(radius_mm, chord)
    frame = _Frame.around(slices, StructuringElement.ball(radius_mm))
    families = []
    for axis in range(3):
        grown = shapely.buffer(to_shapes(slices.regions[axis]), radius_mm, quad_segs=segments)
        empty = (Region(),) * frame.more(axis)
        families.append(empty + tuple(to_region(s) for s in grown) + empty)
    return frame.slice_set(families)


def arc_segments(radius_mm: float, chord_mm: float) -> int:
    """Segments a quarter circle of this radius needs, so that no chord stands further inside of it than ``chord_mm``."""
    half = math.acos(max(0.0, 1.0 - chord_mm / radius_mm))
    return max(2, math.ceil(0.25 * math.pi / half))


def convolved(
    shapes: Shapes, positions_mm: FloatArray, planes_mm: FloatArray, radii: Radii, segments: int, threads: int | None
) -> Shapes:
    """Union, on every plane, of all sections inflated by the radius that belongs to their distance (eq. 1).

    A section that lies inside of the next one, which is inflated by as much or more, is left out: that changes nothing.

    Args:
        shapes: sections at ``positions_mm``, which increase.
        radii: from heights above a plane to radii, NaN out of reach.
        segments: segments a quarter circle.
    """
    inside_next, inside_last = _nested(shapes)

    def plane(at_mm: float) -> shapely.Geometry:
        radius = radii(positions_mm - at_mm)
        wanted = _undominated(radius, inside_next, inside_last) & ~shapely.is_empty(shapes)
        grown = shapely.buffer(shapes[wanted], radius[wanted], quad_segs=segments)
        return shapely.union_all(grown)

    made = np.empty(len(planes_mm), dtype=object)
    count = threads or os.cpu_count() or 1
    if count == 1:
        made[:] = [plane(float(p)) for p in planes_mm]
    else:
        with ThreadPoolExecutor(max_workers=count) as pool:
            made[:] = list(pool.map(plane, planes_mm.tolist()))
    return made


def _nested(shapes: Shapes) -> tuple[np.ndarray, np.ndarray]:
    """Whether each section lies inside of the next, and inside of the last one before it."""
    shapely.prepare(shapes)
    inside_next, inside_last = np.zeros(len(shapes), dtype=bool), np.zeros(len(shapes), dtype=bool)
    same = np.array([a is b for a, b in zip(shapes[:-1], shapes[1:], strict=True)], dtype=bool)
    inside_next[:-1] = same | shapely.covers(shapes[1:], shapes[:-1])
    inside_last[1:] = same | shapely.covers(shapes[:-1], shapes[1:])
    return inside_next, inside_last


def _undominated(radius: FloatArray, inside_next: np.ndarray, inside_last: np.ndarray) -> np.ndarray:
    """Sections within reach that no neighbour makes needless."""
    keep = ~np.isnan(radius)
    keep[:-1] &= ~(inside_next[:-1] & (radius[1:] > radius[:-1]))
    keep[1:] &= ~(inside_last[1:] & (radius[:-1] >= radius[1:]))
    return keep


class _Frame:
    """Planes and box of a result: those of the slices, and more around them."""

    def __init__(self, slices: SliceSet, more: tuple[int, int, int], margin_mm: float) -> None:
        self._slices, self._more, self._margin = slices, more, margin_mm

    @classmethod
    def around(cls, slices: SliceSet, element: StructuringElement) -> _Frame:
        x, y, z = (math.ceil(element.radius_mm / float(p) + 1.0) for p in slices.pitch_mm)
        return cls(slices, (x, y, z), element.radius_mm)

    def more(self, axis: int) -> int:
        """Planes added at either end."""
        return self._more[axis]

    def positions(self, axis: int) -> FloatArray:
        """All planes across an axis."""
        extra, pitch = self._more[axis], float(self._slices.pitch_mm[axis])
        count = len(self._slices.regions[axis]) + 2 * extra
        positions: FloatArray = self._slices.low_mm[axis] + (np.arange(-extra, count - extra) + 0.5) * pitch
        return positions

    def slice_set(self, families: Sequence[tuple[Region, ...]]) -> SliceSet:
        """The result."""
        reach = np.array(self._more) * self._slices.pitch_mm
        return SliceSet(
            low_mm=frozen(self._slices.low_mm - reach, "low_mm", (3,)),
            high_mm=frozen(self._slices.high_mm + reach, "high_mm", (3,)),
            pitch_mm=self._slices.pitch_mm,
            regions=tuple(families),
        )
