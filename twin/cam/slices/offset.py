"""Offsets of sliced parts by convolution of neighbouring slices (the tri-slice paper, section 2.2, eq. 1).

The section of an inflated part on a plane is the union of all neighbouring sections, each inflated by the radius that
the structuring element has at its distance: sqrt(r^2 - d^2) for a ball. Shrinking inflates the space outside the part.

Conventions. With `StructuringElement.ball` the result is where the ball's centre may not be; with
`StructuringElement.tool` where the tool's tip may not be. As tools reach up without end, that is everything below the
inflated top; on planes across x and y it is found by `cl_lines`. Elsewhere rounding arcs are inscribed, with
chords no further than ``chord_mm`` inside, and material between slices is omitted: an inflated part is never too
large, and a shrunk one never too small, except for what GEOS omits, see `twin.geometry.polygons.guards`. `bound_mm`
gives how much may be missing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from twin.arrays import FloatArray, frozen
from twin.cam.slices.cl_lines import cl_regions
from twin.cam.slices.sections import Sections, SlicedPart, outside_sections
from twin.cam.slices.structuring_element import StructuringElement
from twin.geometry.polygons.convolution import Convolution, Radii, arc_segments
from twin.geometry.polygons.region import Region
from twin.geometry.polygons.shapes import Shape, boundaries, box_shape, grown_each, minus, to_region, to_shapes
from twin.workpiece.stock import SliceSet
from twin.workpiece.store import PLANE_AXES

#: Chords of rounding arcs stand this part of a slice pitch inside of them.
CHORD_PITCHES = 0.005


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
        chord_mm: how far chords of rounding arcs may lie inside; `CHORD_PITCHES` of the pitch if not given.
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


def bound_mm(element: StructuringElement, pitch_mm: float, slope_rad: float = 0.5 * math.pi) -> float:
    """How far an inflated part may lie inside the exact one, for material between its slices.

    Where a flat or convex surface makes an angle a with the planes of the slices, the nearest slices are at most half a
    pitch away, p / (2 sin a) along the surface: the element's curvature loses p^2 / (8 r sin^2 a) there, and the part's
    own as much again where its radius is not smaller. Nowhere is more lost than half a pitch, except at faces that lie
    across the slices of a part without `SlicedPart.faces`, which are known to one pitch.

    Args:
        slope_rad: angle between the surface and the planes of the slices; 90 degrees if not given.
    """
    radius = element.corner_radius_mm if element.corner_radius_mm > 0.0 else element.radius_mm
    sine = math.sin(slope_rad)
    return min(0.5 * pitch_mm, pitch_mm**2 / (4.0 * radius * sine * sine)) if sine > 0.0 else 0.5 * pitch_mm


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
    if not element.centred and sections.axis != 2:
        return cl_regions(sections, element, planes_mm, chord_mm=chord_mm, threads=threads)
    shapes, radii = to_shapes(sections.regions), towards(element, sections.axis)
    grown = Convolution(shapes, sections.positions_mm, radii, element.radius_mm, chord_mm, threads=threads)
    return tuple(to_region(s) for s in grown.on(planes_mm))


def shrink(
    part: SlicedPart | SliceSet,
    element: StructuringElement,
    *,
    axes: Sequence[int] = (0, 1, 2),
    chord_mm: float | None = None,
    threads: int | None = None,
) -> SliceSet:
    """Shrink a part: the space around it is inflated, and the rest remains (the tri-slice paper's intersection).

    Shrinking an inflated part by the same element closes it: gaps that the element does not fit into stay filled.

    Args:
        part: as for `inflate`.
        element: for a tool the result is where every point of the tool's body, upside up, is inside the inflated part.
        axes: directions wanted; the others have no planes in the result.
        chord_mm: how far chords of rounding arcs may lie inside.
        threads: threads to work with, all cores if not given; results do not depend on it.

    Returns:
        Slices on the same planes.
    """
    slices = part.slices if isinstance(part, SlicedPart) else part
    chord = CHORD_PITCHES * float(slices.pitch_mm.min()) if chord_mm is None else chord_mm
    families: list[tuple[Region, ...]] = [(), (), ()]
    for axis in axes:
        sections = outside_sections(part.mesh, axis) if isinstance(part, SlicedPart) else None
        own = Sections.of(slices, axis)
        wide = _with_nothing_beyond(
            own if sections is None else own.joined(sections), element, float(slices.pitch_mm[axis])
        )
        outer, box = frame_boxes(slices, axis, element)
        inside = to_shapes(wide.regions)
        swept = Convolution(
            minus(outer, inside),
            wide.positions_mm,
            away(element, axis),
            element.radius_mm,
            chord,
            threads=threads,
            edges=boundaries(inside),
        )
        families[axis] = tuple(to_region(s) for s in minus(box, swept.on(own.positions_mm)))
    return SliceSet(low_mm=slices.low_mm, high_mm=slices.high_mm, pitch_mm=slices.pitch_mm, regions=tuple(families))


def _with_nothing_beyond(sections: Sections, element: StructuringElement, pitch_mm: float) -> Sections:
    """Sections with empty ones on either side, as far as the element reaches."""
    reach = pitch_mm * np.arange(1, math.ceil(2.0 * element.radius_mm / pitch_mm) + 2)
    ends = sections.positions_mm[[0, -1]]
    around = np.concatenate((ends[0] - reach, ends[1] + reach))
    order = np.sort(around)
    return sections.joined(Sections(axis=sections.axis, positions_mm=order, regions=(Region(),) * len(order)))


def frame_boxes(slices: SliceSet, axis: int, element: StructuringElement) -> tuple[Shape, Shape]:
    """Rectangle around a part and its surroundings on a plane, and the part's own."""
    u, v = PLANE_AXES[axis]
    low, high, far = slices.low_mm, slices.high_mm, 3.0 * element.radius_mm
    return (
        box_shape(low[u] - far, low[v] - far, high[u] + far, high[v] + far),
        box_shape(low[u], low[v], high[u], high[v]),
    )


def towards(element: StructuringElement, axis: int) -> Radii:
    """Radii that a part's sections are inflated by, from their heights above a plane of the tool's reference point."""
    return element.z_radii_mm if axis == 2 else element.ball_radii_mm


def away(element: StructuringElement, axis: int) -> Radii:
    """Radii of the tool's own sections on a plane, from the heights of its reference point above the plane."""
    return (lambda above: element.z_radii_mm(-above)) if axis == 2 else element.ball_radii_mm


def inflate_individually(slices: SliceSet, radius_mm: float, *, chord_mm: float | None = None) -> SliceSet:
    """Inflate every slice alone, without its neighbours (the tri-slice paper, fig. 3): for comparison.

    The result depends on the direction of the slices, which it should not.
    """
    chord = CHORD_PITCHES * float(slices.pitch_mm.min()) if chord_mm is None else chord_mm
    segments = arc_segments(radius_mm, chord)
    frame = _Frame.around(slices, StructuringElement.ball(radius_mm))
    families = []
    for axis in range(3):
        grown = grown_each(to_shapes(slices.regions[axis]), radius_mm, segments)
        empty = (Region(),) * frame.more(axis)
        families.append(empty + tuple(to_region(s) for s in grown) + empty)
    return frame.slice_set(families)


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
