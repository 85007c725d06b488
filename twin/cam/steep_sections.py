"""More sections where a part's surface runs nearly along them: walls with a draft, crests, flat tops.

Even slices meet a surface at an angle a to them at distances pitch / sin a along the surface, which grow without limit
as the surface turns along the slices. There the pitch is made smaller, so that they stay within a few pitches.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.cam.sections import Sections, SlicedPart, cut_sections
from twin.workpiece.from_mesh import Solid

#: Distances along the surface that are allowed, in pitches; a pitch is divided by no more than the second.
_ALONG, _MOST = 3.0, 16.0
#: By how much the pitch wanted is made larger, again and again, where there would be more sections than slices.
_LARGER = 1.1
#: A face lies across an axis, and has sections of its own, where its normal has this component along it.
_ACROSS = 1.0 - 1e-9


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
    number = np.arange(len(begins)) - np.repeat(np.cumsum(more) - more, more)
    return sections.joined(cut_sections(part.mesh, axis, begins + steps * (number + 1)))


def across_axis(mesh: Solid, axis: int) -> tuple[NDArray[np.int64], FloatArray, FloatArray]:
    """Triangles that do not lie across an axis.

    Returns:
        Their numbers, shape (n,); the sine of the angle between each and planes across the axis; their normals' unit
        vectors times twice their areas, shape (3, n).
    """
    a, b, c = (mesh.vertices_mm.T[:, mesh.triangles[:, i]] for i in range(3))
    (ux, uy, uz), (vx, vy, vz) = b - a, c - a
    cross = np.stack((uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx))
    size = np.sqrt(np.sum(cross**2, axis=0))
    along = np.abs(cross[axis]) / np.where(size > 0.0, size, 1.0)
    which = np.flatnonzero((size > 0.0) & (along < _ACROSS))
    return which, np.sqrt(1.0 - along[which] ** 2), cross[:, which]


def gaps_of(mesh: Solid, which: NDArray[np.int64], sections: Sections) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Gaps between sections that triangles reach into: the first, and one past the last.

    Gap k lies before section k; the first is before all sections and the last behind them.
    """
    heights = mesh.vertices_mm[:, sections.axis][mesh.triangles[which]]
    first = np.searchsorted(sections.positions_mm, heights.min(axis=1), side="right")
    last = np.searchsorted(sections.positions_mm, heights.max(axis=1), side="left") + 1
    return first, np.maximum(last, first + 1)


def _wanted_mm(mesh: Solid, sections: Sections, pitch_mm: float) -> FloatArray:
    """Pitch wanted in every gap between two sections; inf where any will do."""
    which, sine, cross = across_axis(mesh, sections.axis)
    steep = (cross[2] > 0.0) & (sine < 1.0 / _ALONG)
    first, last = gaps_of(mesh, which[steep], sections)
    counts = last - first
    gap = np.repeat(first, counts) + np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    wanted = np.full(len(sections.positions_mm) + 1, np.inf)
    np.minimum.at(wanted, gap, np.repeat(np.maximum(_ALONG * sine[steep], 1.0 / _MOST) * pitch_mm, counts))
    return wanted[1:-1]


def _more(gaps_mm: FloatArray, wanted_mm: FloatArray) -> NDArray[np.int64]:
    """Sections to add in every gap."""
    return np.maximum(0, np.ceil(gaps_mm / wanted_mm * (1.0 - 1e-9)).astype(np.int64) - 1)
