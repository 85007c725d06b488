"""How well slices at a pitch know an inflated part."""

from __future__ import annotations

import numpy as np

from twin.cam.scan import ACROSS
from twin.plan.paths import Ground
from twin.plan.settings import PathSettings
from twin.tools.shape import ToolShape
from twin.workpiece.from_mesh import Solid

#: Share of the surface's area that the bound is for.
_SHARE = 0.99
#: A face lies across the slices' axis, and is known exactly, where its normal has this component along it.
_ACROSS = 1.0 - 1e-9


def pitch_bound_mm(settings: PathSettings, ground: Ground) -> float:
    """See `sag_mm`, for the family of slices that a path is made from.

    A level of a flat tool needs nothing but the section at its own height, which is exact; rows of the drop-cutter need
    no slices.
    """
    if settings.exact:
        return 0.0
    if settings.strategy == "contour" and ground.tool.corner_mm == 0.0:
        return 0.0
    axis = ACROSS[settings.direction] if settings.strategy == "scan" else 2
    return sag_mm(ground.part.mesh, ground.tool, float(ground.part.slices.pitch_mm[axis]), axis)


def sag_mm(part: Solid, tool: ToolShape, pitch_mm: float, axis: int) -> float:
    """How far a tool may sink between two slices, for 99 % of the surface that does not lie across the axis.

    Slices meet a face whose normal has the component n along their axis at distances s = pitch / sqrt(1 - n^2) along
    the face. A tool of radius r that rests on lines so far apart sinks in between by r - sqrt(r^2 - s^2 / 4), and never
    by more than pitch * n, for the next slice behind the place is at most a pitch away along the axis.
    """
    a, b, c = (part.vertices_mm[part.triangles[:, i]] for i in range(3))
    cross = np.cross(b - a, c - a)
    size = np.linalg.norm(cross, axis=1)
    along = np.abs(cross[:, axis]) / np.where(size > 0.0, size, 1.0)
    used = (along < _ACROSS) & (size > 0.0)
    if not used.any():
        return 0.0
    radius = tool.corner_mm or tool.nominal_radius_mm
    apart = np.minimum(pitch_mm / np.sqrt(1.0 - along[used] ** 2), 2.0 * radius)
    sag = np.minimum(radius - np.sqrt(radius**2 - 0.25 * apart**2), pitch_mm * along[used])
    order = np.argsort(sag)
    grown = np.cumsum(size[used][order])
    return float(sag[order][np.searchsorted(grown, _SHARE * grown[-1])])
