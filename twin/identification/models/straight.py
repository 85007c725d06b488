"""One straight, level pass into fresh stock: its forces as linear functions of the six cutting coefficients.

The engagement is exact: a point of an edge cuts where its normal looks along the feed (+x, M3), it lies below the
stock's top, and its y lies in the strip that the stock fills. A pass `down` (climb) has the stock on the side y < 0, a
pass `up` on the side y > 0, each so far from the axis that ``radial_depth_mm`` of the nominal radius lies in it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from twin.arrays import FloatArray
from twin.cutting.coefficients import CuttingCoefficients
from twin.cutting.engagement import NO_ENGAGEMENT, EngagementMap
from twin.cutting.forces import ForceModel
from twin.identification.cuts.cuts_file import Direction
from twin.tolerance import Tolerance
from twin.tools.edges import CuttingEdges, meridian
from twin.tools.shape import ToolShape

#: Order of the coefficients in every vector and matrix of this package.
NAMES = ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae")
#: Spindle angles of a response: half a degree apart, the first a quarter of a degree after 0.
ROWS = 720
_MEAN_ELEMENTS = 4000
_RESPONSE_STEP_MM = 0.04
_MOST_ELEMENTS = 250


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StraightPass:
    """A tool in a straight pass along +x, M3.

    Attributes:
        shape: the tool's meridian; its height is at least the axial depth.
        helix_deg: helix angle, right hand positive.
        pitch_rad: shape (teeth,), angle by which each tooth trails tooth 0.
        runout_mm, runout_rad: see `twin.tools.edges.CuttingEdges`.
        axial_depth_mm: height of the stock's top above the tip.
        strip_mm: y that the stock fills, measured from the cutter's axis; infinite where it has no end.
        feed_per_rev_mm: feed per revolution.
    """

    shape: ToolShape
    helix_deg: float
    pitch_rad: FloatArray
    runout_mm: float = 0.0
    runout_rad: float = 0.0
    axial_depth_mm: float
    strip_mm: tuple[float, float]
    feed_per_rev_mm: float


def strip_of(direction: Direction, nominal_radius_mm: float, radial_depth_mm: float) -> tuple[float, float]:
    """The strip of y that the stock fills, from the cutter's axis (M3, feed along +x)."""
    if direction == "slot":
        return -math.inf, math.inf
    wall = radial_depth_mm - nominal_radius_mm
    return (-math.inf, wall) if direction == "down" else (-wall, math.inf)


def reach_mm(cut: StraightPass) -> float:
    """Distance of the farthest engaged point ahead of the cutter's axis."""
    radius = float(cut.shape.radius_mm(cut.axial_depth_mm))
    nearest = max(cut.strip_mm[0], -cut.strip_mm[1], 0.0)
    return math.sqrt(max(0.0, radius**2 - nearest**2))


def mean_matrix(cut: StraightPass) -> FloatArray:
    """Mean force on the tool for unit coefficients, shape (3, 6): the mean is this matrix times the coefficients.

    Without runout the integral over the angle is in closed form and that along the meridian a sum over midpoints; then
    neither helix nor pitch angles matter. With runout it is the mean of `response`.
    """
    if cut.runout_mm > 0.0:
        return np.asarray(response(cut).mean(axis=0))
    edges = _edges(cut, _MEAN_ELEMENTS)
    sin_k, cos_k = np.sin(edges.kappa_rad), np.cos(edges.kappa_rad)
    low, high = _angles(cut, edges.radius_mm)
    c1, s1, span = np.sin(high) - np.sin(low), np.cos(low) - np.cos(high), high - low
    cc = 0.5 * span + 0.25 * (np.sin(2.0 * high) - np.sin(2.0 * low))
    sc = 0.5 * (np.sin(high) ** 2 - np.sin(low) ** 2)
    chip = edges.element_length_mm * cut.feed_per_rev_mm / (2.0 * math.pi)
    edge = edges.element_length_mm * len(cut.pitch_rad) / (2.0 * math.pi)
    rows = [
        [-sc * sin_k, -s1, -cc * sin_k**2, -c1 * sin_k, -cc * sin_k * cos_k, -c1 * cos_k],
        [cc * sin_k, c1, -sc * sin_k**2, -s1 * sin_k, -sc * sin_k * cos_k, -s1 * cos_k],
        [0.0 * sc, 0.0 * sc, c1 * sin_k * cos_k, span * cos_k, -c1 * sin_k**2, -span * sin_k],
    ]
    return np.array([[float(np.sum(v * (edge if k % 2 else chip))) for k, v in enumerate(row)] for row in rows])


def response(cut: StraightPass, rows: int = ROWS) -> FloatArray:
    """Force on the tool at each spindle angle for unit coefficients, shape (rows, 3, 6).

    The angles are (k + 1/2) 2 pi / rows. The forces are those of the simulator (`twin.cutting.forces`), on the exact
    engagement in place of that of slices.
    """
    edges = _edges(cut, max(8, min(_MOST_ELEMENTS, math.ceil(cut.axial_depth_mm / _RESPONSE_STEP_MM))))
    engaged = _map(cut, edges, rows)
    spindle: FloatArray = np.asarray((np.arange(rows) + 0.5) * (2.0 * math.pi / rows), dtype=np.float64)
    model = ForceModel(edges, unit_coefficients(0), rows, Tolerance.for_pitch(_RESPONSE_STEP_MM))
    return model.unit_forces(spindle, 1, np.array([1.0, 0.0, 0.0]), cut.feed_per_rev_mm, engaged)


def unit_coefficients(index: int) -> CuttingCoefficients:
    """One coefficient 1, the others 0."""
    ktc, kte, krc, kre, kac, kae = np.eye(len(NAMES))[index].tolist()
    return CuttingCoefficients(Ktc=ktc, Kte=kte, Krc=krc, Kre=kre, Kac=kac, Kae=kae, source="unit")


def _edges(cut: StraightPass, count: int) -> CuttingEdges:
    """Elements of equal length on corner arc and on wall, up to the stock's top; the flat bottom does not cut."""
    shape, depth = cut.shape, cut.axial_depth_mm
    on_arc = shape.corner_radius_mm * float(shape.kappa_rad(min(depth, shape.arc_height_mm * (1.0 - 1e-15))))
    on_wall = max(0.0, depth - shape.arc_height_mm) / math.cos(shape.taper_rad)
    if on_wall > 0.0:
        on_arc = shape.corner_radius_mm * (0.5 * math.pi - shape.taper_rad)
    bounds = np.array([0.0])
    for length in (on_arc, on_wall):
        if length > 0.0:
            n = max(1, round(count * length / (on_arc + on_wall)))
            bounds = np.concatenate((bounds, bounds[-1] + length * np.arange(1, n + 1) / n))
    bounds = bounds + shape.disc_mm
    at = meridian(shape, 0.5 * (bounds[:-1] + bounds[1:]))
    return CuttingEdges(
        z_mm=at.height_mm,
        radius_mm=at.radius_mm,
        kappa_rad=at.kappa_rad,
        element_length_mm=np.diff(bounds),
        bounds_mm=bounds,
        lag_rad=at.height_mm * math.tan(math.radians(cut.helix_deg)) / shape.nominal_radius_mm,
        pitch_rad=cut.pitch_rad,
        runout_mm=cut.runout_mm,
        runout_rad=cut.runout_rad,
    )


def _angles(cut: StraightPass, radius_mm: FloatArray) -> tuple[FloatArray, FloatArray]:
    """First and last angle, from +x, at which points at these radii are in the stock and on the front."""
    low, high = cut.strip_mm
    return np.arcsin(np.clip(low / radius_mm, -1.0, 1.0)), np.arcsin(np.clip(high / radius_mm, -1.0, 1.0))


def _map(cut: StraightPass, edges: CuttingEdges, rows: int) -> EngagementMap:
    """The exact engagement as a map of the simulator's kind; at the gate n.f = 0 the chip itself ends it.

    The share of a row is the part of the step about it in which the element is engaged, so that elements come in and
    go out over a step, not at a stroke, and their number leaves no steps in the force.
    """
    step = 2.0 * math.pi / rows
    low, high = _angles(cut, edges.radius_mm)
    never = low >= high
    beyond = 0.5 * math.pi + 1.01 * step
    low, high = np.where(low <= -0.5 * math.pi, -beyond, low), np.where(high >= 0.5 * math.pi, beyond, high)
    theta = np.arange(rows) * step
    theta = np.where(theta > math.pi, theta - 2.0 * math.pi, theta)[:, None]
    share = np.clip(0.5 + np.minimum(theta - low, high - theta) / step, 0.0, 1.0)
    share[:, never] = 0.0
    return EngagementMap(share, np.full(share.shape, 0.5), NO_ENGAGEMENT)
