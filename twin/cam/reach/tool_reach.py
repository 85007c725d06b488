"""Material that a tool cannot reach: the part inflated, shrunk again, and compared (the tri-slice paper, section 3.2).

The inflated part is where the tool's reference point may not be; everything else is swept with the tool and taken away.
What remains outside the part, the tool cannot remove. With a ball about its centre the tool may come from any
side; with a tool about its tip it comes from above, and material below an overhang is out of reach.
"""

from __future__ import annotations

from dataclasses import dataclass

from twin.arrays import FloatArray
from twin.cam.reach.slabs import slabs_mm
from twin.cam.reach.tool_positions import even_positions, tool_positions
from twin.cam.reach.uncut_regions import UncutRegion, uncut_regions
from twin.cam.slices.offset import CHORD_PITCHES, away, frame_boxes, towards
from twin.cam.slices.sections import Sections, SlicedPart
from twin.cam.slices.structuring_element import StructuringElement
from twin.geometry.mesh.closest import ClosestPoints
from twin.geometry.polygons.convolution import Convolution
from twin.geometry.polygons.shapes import Shapes, boundaries, minus, to_shapes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reach:
    """Material left by one tool on a part.

    Attributes:
        element: the tool.
        axis: normal of the slices it was found on.
        pitch_mm: their distance.
        thin_mm: regions nowhere thicker than this are noise of the slices, and omitted.
        uncut_regions: connected regions of uncut material, the largest first.
    """

    element: StructuringElement
    axis: int
    pitch_mm: float
    thin_mm: float
    uncut_regions: tuple[UncutRegion, ...]

    @property
    def volume_mm3(self) -> float:
        """Volume of the uncut material."""
        return sum((r.volume_mm3 for r in self.uncut_regions), 0.0)

    @property
    def thickness_mm(self) -> float:
        """Its thickness, the largest distance from the part; 0 without any."""
        return max((r.thickness_mm for r in self.uncut_regions), default=0.0)


def tool_reach(
    part: SlicedPart,
    element: StructuringElement,
    *,
    axis: int = 2,
    thin_mm: float | None = None,
    threads: int | None = None,
) -> Reach:
    """Material left by a tool on a part.

    Args:
        element: `StructuringElement.ball` for a ball that may come from any side, `StructuringElement.tool` for a tool
            from above.
        axis: normal of the slices to work on; 2 for tools from above.
        thin_mm: least thickness that counts; `thin_bound_mm` if not given.
        threads: threads to work with, all cores if not given; results do not depend on it.

    Raises:
        ValueError: a tool from above on slices that do not lie across z.
    """
    if axis != 2 and not element.centred:
        raise ValueError(f"tools from above need slices across z, got axis {axis}")
    pitch = float(part.slices.pitch_mm[axis])
    least = thin_bound_mm(element, pitch) if thin_mm is None else thin_mm
    sections = part.sections(axis)
    planes = part.slices.positions_mm(axis)
    closed = _closed(part, sections, planes, element, threads)
    own = to_shapes(part.slices.regions[axis])
    left = minus(closed, own)
    surface = ClosestPoints(part.mesh.vertices_mm, part.mesh.triangles, part.mesh.edges)
    found = uncut_regions(left, planes, slabs_mm(part.mesh, axis, planes, pitch), axis, surface, least, threads)
    return Reach(element=element, axis=axis, pitch_mm=pitch, thin_mm=least, uncut_regions=found)


def thin_bound_mm(element: StructuringElement, pitch_mm: float) -> float:
    """Thickness up to which uncut regions may come from the slices' pitch alone.

    Where a surface lies nearly along the slices these know it to about half a pitch; the tool's sweep over it between
    two planes misses as much again, less what its radius bridges. `tool_positions` adds planes where that would
    be the tool's deepest positions.
    """
    return min(pitch_mm, 0.5 * pitch_mm + pitch_mm**2 / element.radius_mm)


def _closed(
    part: SlicedPart, sections: Sections, planes: FloatArray, element: StructuringElement, threads: int | None
) -> Shapes:
    """Sections of the part and its uncut material: all that no position of the tool reaches, within the part's box."""
    axis, pitch = sections.axis, float(part.slices.pitch_mm[sections.axis])
    outer, box = frame_boxes(part.slices, axis, element)
    radius, chord = element.radius_mm, CHORD_PITCHES * pitch
    shapes, radii = to_shapes(sections.regions), towards(element, axis)
    inflated = Convolution(shapes, sections.positions_mm, radii, radius, chord, threads=threads)
    planes_of, walls, free = tool_positions(inflated, outer, even_positions(part, axis, planes, element), pitch)
    radii = away(element, axis)
    swept = Convolution(free, planes_of, radii, radius, chord, threads=threads, edges=boundaries(walls))
    return minus(box, swept.on(planes))
