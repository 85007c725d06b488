"""Cutting edges as elements along the meridian, shared by all flutes, and the flutes' angles and runout."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from twin.arrays import FloatArray, frozen
from twin.errors import ToolError
from twin.tools.meridian_kernels import meridian_points
from twin.tools.shape import ToolShape


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CuttingEdges:
    """Edge elements of a tool with ``n`` elements and ``teeth`` flutes.

    The element ``i`` of tooth ``m`` is at the angle ``pitch_rad[m] + lag_rad[i]`` behind the tip of tooth 0,
    against the sense of rotation.

    Attributes:
        z_mm: shape (n,), height of each element's midpoint above the tip.
        radius_mm: shape (n,), radius there.
        kappa_rad: shape (n,), angle between outward normal and tool axis.
        element_length_mm: shape (n,), length along the meridian: R dkappa on an arc, dz / sin(kappa) on a wall.
        bounds_mm: shape (n + 1,), positions of the elements' ends along the meridian, from 0 on the axis.
        lag_rad: shape (n,), helix lag z tan(helix) / R of constant lead (R the nominal radius).
        pitch_rad: shape (teeth,), angle of each tooth behind tooth 0, the first 0, increasing below 2 pi.
        runout_mm, runout_rad: offset of the cutter axis from the spindle axis, and its direction measured from the tip
            of tooth 0 in the sense of rotation, so that an element lies ``runout cos(runout_rad + pitch + lag)`` mm
            farther out.
    """

    z_mm: FloatArray
    radius_mm: FloatArray
    kappa_rad: FloatArray
    element_length_mm: FloatArray
    bounds_mm: FloatArray
    lag_rad: FloatArray
    pitch_rad: FloatArray
    runout_mm: float = 0.0
    runout_rad: float = 0.0

    @property
    def teeth(self) -> int:
        """Number of flutes."""
        return len(self.pitch_rad)

    def positions_mm(self, tooth: int, spindle_rad: float, clockwise: bool = True) -> FloatArray:
        """Element midpoints of a tooth relative to the tool tip, shape (n, 3), without runout.

        At spindle angle 0 the tip of tooth 0 points along +x; an M3 spindle turns clockwise seen from above.
        """
        theta = self.theta_rad(tooth, spindle_rad, clockwise)
        return np.column_stack((self.radius_mm * np.cos(theta), self.radius_mm * np.sin(theta), self.z_mm))

    def normals(self, tooth: int, spindle_rad: float, clockwise: bool = True) -> FloatArray:
        """Outward unit normals at the element midpoints, shape (n, 3)."""
        theta = self.theta_rad(tooth, spindle_rad, clockwise)
        sin_k, cos_k = np.sin(self.kappa_rad), np.cos(self.kappa_rad)
        return np.column_stack((np.cos(theta) * sin_k, np.sin(theta) * sin_k, -cos_k))

    def theta_rad(self, tooth: int, spindle_rad: float, clockwise: bool = True) -> FloatArray:
        """Angle of each element counter-clockwise from +x, shape (n,)."""
        sense = 1.0 if clockwise else -1.0
        return np.asarray(-spindle_rad + sense * (self.pitch_rad[tooth] + self.lag_rad))


def cutting_edges(
    shape: ToolShape,
    *,
    teeth: int,
    helix_deg: float = 0.0,
    axial_step_mm: float,
    pitch_deg: tuple[float, ...] | None = None,
    runout_mm: float = 0.0,
    runout_angle_deg: float = 0.0,
) -> CuttingEdges:
    """Divide a tool's edges into elements.

    On the wall and the corner arc elements end at multiples of ``axial_step_mm`` in height, so that depths of cut which
    are such multiples fall between elements, and are cut shorter where the meridian is flat, so that none is longer
    than 1.2 ``axial_step_mm`` along the meridian either. The flat bottom of a tool carries end edges from the axis to
    the corner: their normal looks down (kappa = 0), so they cut in plunges and ramps only.

    Args:
        teeth: number of flutes, at least 1.
        helix_deg: helix angle, right hand positive.
        pitch_deg: angles from each tooth to the next, summing to 360; None for constant pitch.

    Raises:
        ToolError: values out of range.
    """
    if teeth < 1 or axial_step_mm <= 0.0:
        raise ToolError(f"cutting edges: teeth = {teeth}, axial_step_mm = {axial_step_mm}, expected both above 0")
    bounds = np.concatenate((_bottom_bounds(shape, axial_step_mm), _side_bounds(shape, axial_step_mm)))
    points = meridian(shape, 0.5 * (bounds[:-1] + bounds[1:]))
    even = tuple(360.0 / teeth for _ in range(teeth))
    lag = points.height_mm * math.tan(math.radians(helix_deg)) / shape.nominal_radius_mm
    return CuttingEdges(
        z_mm=frozen(points.height_mm, "z_mm", (None,)),
        radius_mm=frozen(points.radius_mm, "radius_mm", (None,)),
        kappa_rad=frozen(points.kappa_rad, "kappa_rad", (None,)),
        element_length_mm=frozen(np.diff(bounds), "element_length_mm", (None,)),
        bounds_mm=frozen(bounds, "bounds_mm", (None,)),
        lag_rad=frozen(lag, "lag_rad", (None,)),
        pitch_rad=frozen(_pitches(pitch_deg or even, teeth), "pitch_rad", (teeth,)),
        runout_mm=runout_mm,
        runout_rad=math.radians(runout_angle_deg),
    )


class MeridianPoints(NamedTuple):
    """Points of a tool's meridian: radius, height above the tip, angle kappa of the normal; each of shape (n,)."""

    radius_mm: FloatArray
    height_mm: FloatArray
    kappa_rad: FloatArray


def meridian(shape: ToolShape, s_mm: FloatArray) -> MeridianPoints:
    """Points at lengths along the meridian from the axis: over the flat bottom, the corner arc, the wall.

    Args:
        s_mm: shape (n,), lengths.
    """
    out = np.empty((3, len(s_mm)))
    meridian_points(s_mm, shape.disc_mm, shape.corner_radius_mm, shape.taper_rad, out)
    return MeridianPoints(*out)


def _bottom_bounds(shape: ToolShape, step: float) -> FloatArray:
    """Ends of the elements of the flat bottom but the last, which is the first of the side."""
    if shape.disc_mm == 0.0:
        return np.zeros(0)
    return np.linspace(0.0, shape.disc_mm, max(1, math.ceil(shape.disc_mm / step)), endpoint=False)


def _side_bounds(shape: ToolShape, step: float) -> FloatArray:
    """Ends of the elements of corner arc and wall."""
    levels = shape.disc_mm + _length_to_height(shape, _levels(shape.height_mm, step))
    pieces = np.maximum(1, np.ceil(np.diff(levels) / step - 0.2).astype(int))
    parts = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(levels[:-1], levels[1:], pieces, strict=True)]
    return np.concatenate([*parts, levels[-1:]])


def _pitches(pitch_deg: tuple[float, ...], teeth: int) -> FloatArray:
    if len(pitch_deg) != teeth or min(pitch_deg) <= 0.0 or abs(sum(pitch_deg) - 360.0) > 1e-6:
        raise ToolError(f"cutting edges: pitch_deg = {list(pitch_deg)}, expected {teeth} angles above 0 summing to 360")
    return np.radians(np.concatenate(([0.0], np.cumsum(pitch_deg[:-1]))))


def _levels(height: float, step: float) -> FloatArray:
    count = int(height / step * (1.0 + 1e-12))
    levels = [i * step for i in range(count + 1)]
    if height - levels[-1] > 1e-9 * height:
        levels.append(height)
    else:
        levels[-1] = height
    return np.array(levels)


def _length_to_height(shape: ToolShape, z: FloatArray) -> FloatArray:
    """Length along corner arc and wall from the end of the flat bottom to heights z."""
    on_arc = shape.corner_radius_mm * shape.kappa_rad(np.minimum(z, shape.arc_height_mm * (1.0 - 1e-15)))
    at_end = shape.corner_radius_mm * (0.5 * math.pi - shape.taper_rad)
    wall = (z - shape.arc_height_mm) / math.cos(shape.taper_rad)
    return np.asarray(np.where(z < shape.arc_height_mm, on_arc, at_end + wall))
