"""How accurately slices at a pitch describe an inflated part."""

from __future__ import annotations

import numpy as np

from twin.cam.slices.sections import Sections, slanted_triangles
from twin.cam.slices.steep_sections import gaps_of, slopes
from twin.planning.paths import PlanSetup
from twin.planning.settings import PathSettings
from twin.tools.shape import ToolShape
from twin.workpiece.solids.from_mesh import Solid

#: Share of the surface's area that the bound is for.
_SHARE = 0.99


def pitch_bound_mm(settings: PathSettings, setup: PlanSetup) -> float:
    """Bound on the error between slices, mm; see `sag_mm`.

    It is 0 for levels of a flat tool, which need only the section at their own height, and for rows of the drop-cutter,
    which need no slices.
    """
    if settings.exact or (settings.strategy == "contour" and setup.tool.corner_radius_mm == 0.0):
        return 0.0
    return sag_mm(setup.part.mesh, setup.tool, setup.sections)


def sag_mm(part: Solid, tool: ToolShape, sections: Sections) -> float:
    """How far a tool may sink between two sections, mm, for 99 % of the surface that is not square to their axis.

    Sections d apart meet a face at an angle a to them at distances s = d / sin a along the face. A tool of radius r
    that rests on two lines at distance s sinks in between by r - sqrt(r^2 - s^2 / 4), and never by more than d cos a,
    as the next section is at most d away along the axis.
    """
    which, vectors = slanted_triangles(part, sections.axis)
    if len(which) == 0:
        return 0.0
    sine = slopes(vectors, sections.axis)
    gaps = np.concatenate(([0.0], np.diff(sections.positions_mm), [0.0, 0.0]))
    widest = np.maximum.reduceat(gaps, np.column_stack(gaps_of(part, which, sections)).ravel())[::2]
    radius = tool.corner_radius_mm or tool.nominal_radius_mm
    apart = np.minimum(widest / sine, 2.0 * radius)
    sag = np.minimum(radius - np.sqrt(radius**2 - 0.25 * apart**2), widest * np.sqrt(1.0 - sine**2))
    order = np.argsort(sag)
    grown = np.cumsum(np.linalg.norm(vectors, axis=0)[order])
    return float(sag[order][np.searchsorted(grown, _SHARE * grown[-1])])
