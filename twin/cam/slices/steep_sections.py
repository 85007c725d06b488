"""More sections where a part's surface runs nearly along them: walls with a draft, crests, flat tops.

Even slices meet a surface at an angle a to them at distances pitch / sin a along the surface, which grow without limit
as the surface turns along the slices. There the pitch is made smaller, so that they stay within a few pitches.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray, places_in_runs
from twin.cam.slices.sections import Sections, SlicedPart, cut_sections, slanted_triangles
from twin.workpiece.solids.from_mesh import Solid

#: Distances along the surface that are allowed, in pitches; a pitch is divided by no more than the second.
_ALONG, _MOST = 3.0, 16.0
#: By how much the pitch wanted is made larger, again and again, where there would be more sections than slices.
_LARGER = 1.1


def with_steep_sections(part: SlicedPart, axis: int) -> Sections:
    """A part's sections across an axis with more of them where its upper surface runs along them.

    No more are added than there are even slices: if these would not do, the pitch is less small everywhere.
    """
    sections = part.sections(axis)
    gaps = np.diff(sections.positions_mm)
    wanted = _wanted_mm(part.mesh, sections, float(part.slices.pitch_mm[axis]))
    more = _more(gaps, wanted)
    while more.sum() > len(part.slices.regions[axis]):
        wanted *= _LARGER
        more = _more(gaps, wanted)
    if not more.any():
        return sections
    begins, steps = np.repeat(sections.positions_mm[:-1], more), np.repeat(gaps / (more + 1), more)
    return sections.joined(cut_sections(part.mesh, axis, begins + steps * (places_in_runs(more) + 1)))


def slopes(vectors: FloatArray, axis: int) -> FloatArray:
    """Sine of the angle between triangles with these `Solid.area_vectors_mm2` and planes across an axis."""
    return np.asarray(np.sqrt(1.0 - (vectors[axis] / np.linalg.norm(vectors, axis=0)) ** 2))


def gaps_of(mesh: Solid, which: NDArray[np.int64], sections: Sections) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Gaps between sections that triangles reach into: the first, and one past the last.

    Gap k lies before section k; the first is before all sections and the last after them.
    """
    heights = mesh.vertices_mm[:, sections.axis][mesh.triangles[which]]
    first = np.searchsorted(sections.positions_mm, heights.min(axis=1), side="right")
    last = np.searchsorted(sections.positions_mm, heights.max(axis=1), side="left") + 1
    return first, np.maximum(last, first + 1)


def _wanted_mm(mesh: Solid, sections: Sections, pitch_mm: float) -> FloatArray:
    """Pitch wanted in every gap between two sections; inf where any will do."""
    which, vectors = slanted_triangles(mesh, sections.axis)
    sine = slopes(vectors, sections.axis)
    steep = (vectors[2] > 0.0) & (sine < 1.0 / _ALONG)
    first, last = gaps_of(mesh, which[steep], sections)
    counts = last - first
    gap = np.repeat(first, counts) + places_in_runs(counts)
    wanted = np.full(len(sections.positions_mm) + 1, np.inf)
    np.minimum.at(wanted, gap, np.repeat(np.maximum(_ALONG * sine[steep], 1.0 / _MOST) * pitch_mm, counts))
    return wanted[1:-1]


def _more(gaps_mm: FloatArray, wanted_mm: FloatArray) -> NDArray[np.int64]:
    """Sections to add in every gap."""
    return np.maximum(0, np.ceil(gaps_mm / wanted_mm * (1.0 - 1e-9)).astype(np.int64) - 1)
