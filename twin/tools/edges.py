"""Cutting edges as elements along the meridian, shared by all flutes, and the flutes' angles and runout."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from twin.arrays import FloatArray, frozen
from twin.errors import ToolError
from twin.tools.shape import ToolShape


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CuttingEdges:
    """Edge elements of a tool with ``n`` elements and ``teeth`` flutes.

    The element ``i`` of tooth ``m`` stands at the angle ``pitch_rad[m] + lag_rad[i]`` behind the tip of tooth 0,
    against the sense of rotation.

    Attributes:
        z_mm: shape (n,), height of each element's midpoint above the tip.
        radius_mm: shape (n,), radius there.
        kappa_rad: shape (n,), angle between outward normal and tool axis.
        length_mm: shape (n,), length along the meridian: R dkappa on an arc, dz / sin(kappa) on a wall.
        bounds_mm: shape (n + 1,), positions of the elements' ends along the meridian, from 0 at the lowest edge point.
        lag_rad: shape (n,), helix lag z tan(helix) / R of constant lead (R the nominal radius).
        pitch_rad: shape (teeth,), angle of each tooth behind tooth 0, the first 0, increasing below 2 pi.
        runout_mm, runout_rad: offset of the cutter axis from the spindle axis, and its direction measured from the tip
            of tooth 0 in the sense of rotation, so that an element lies ``runout cos(runout_rad + pitch + lag)`` mm
            farther out.
    """

    z_mm: FloatArray
    radius_mm: FloatArray
    kappa_rad: FloatArray
    length_mm: FloatArray
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

    Elements end at multiples of ``axial_step_mm`` in height, so that depths of cut which are such multiples fall
    between elements, and are cut shorter where the meridian is flat, so that none is longer than 1.2 ``axial_step_mm``
    along the meridian either. The bottom of a flat tool has no elements: only the wall and the corner arc cut.

    Args:
        teeth: number of flutes, at least 1.
        helix_deg: helix angle, right hand positive.
        pitch_deg: angles from each tooth to the next, summing to 360; None for even teeth.

    Raises:
        ToolError: values out of range.
    """
    if teeth < 1 or axial_step_mm <= 0.0:
        raise ToolError(f"cutting edges: teeth = {teeth}, axial_step_mm = {axial_step_mm}, expected both above 0")
    levels = _levels(shape.height_mm, axial_step_mm)
    s_levels = _arc_length(shape, levels)
    pieces = np.maximum(1, np.ceil(np.diff(s_levels) / axial_step_mm - 0.2).astype(int))
    bounds = np.concatenate(
        [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(s_levels[:-1], s_levels[1:], pieces, strict=True)]
        + [s_levels[-1:]]
    )
    z = arc_position(shape, 0.5 * (bounds[:-1] + bounds[1:]))
    even = tuple(360.0 / teeth for _ in range(teeth))
    return CuttingEdges(
        z_mm=frozen(z, "z_mm", (None,)),
        radius_mm=frozen(shape.radius_mm(z), "radius_mm", (None,)),
        kappa_rad=frozen(shape.kappa_rad(z), "kappa_rad", (None,)),
        length_mm=frozen(np.diff(bounds), "length_mm", (None,)),
        bounds_mm=frozen(bounds, "bounds_mm", (None,)),
        lag_rad=frozen(z * math.tan(math.radians(helix_deg)) / shape.nominal_radius_mm, "lag_rad", (None,)),
        pitch_rad=frozen(_pitches(pitch_deg or even, teeth), "pitch_rad", (teeth,)),
        runout_mm=runout_mm,
        runout_rad=math.radians(runout_angle_deg),
    )


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


def _arc_length(shape: ToolShape, z: FloatArray) -> FloatArray:
    """Length along the meridian from the lowest edge point to heights z."""
    on_arc = shape.corner_mm * shape.kappa_rad(np.minimum(z, shape.arc_height_mm * (1.0 - 1e-15)))
    at_end = shape.corner_mm * (0.5 * math.pi - shape.taper_rad)
    wall = (z - shape.arc_height_mm) / math.cos(shape.taper_rad)
    return np.asarray(np.where(z < shape.arc_height_mm, on_arc, at_end + wall))


def arc_position(shape: ToolShape, s: FloatArray) -> FloatArray:
    """Height above the tip of positions along the meridian, measured from its lowest edge point."""
    end = shape.corner_mm * (0.5 * math.pi - shape.taper_rad)
    arc = shape.corner_mm * (1.0 - np.cos(s / shape.corner_mm)) if shape.corner_mm > 0.0 else np.zeros_like(s)
    wall = shape.arc_height_mm + (s - end) * math.cos(shape.taper_rad)
    return np.asarray(np.where(s < end, arc, wall))
