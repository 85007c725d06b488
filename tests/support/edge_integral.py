"""Cutting forces of a straight pass by integration along the meridian, without any part of the program.

Conventions of tests/golden/README.md: feed +x, M3, angle 0 has the tip of tooth 0 at +x, force on the tool, edge length
the meridian's, runout by Kline and DeVor with its angle from the tip of tooth 0 in the sense of rotation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray

NAMES = ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae")
#: Coefficients of no material, none of them small.
SOME = np.array([1900.0, 22.0, 700.0, 45.0, 400.0, 12.0])
#: Angles at a time, so that the arrays stay in the processor's cache.
_ANGLES = 64


@dataclass(frozen=True)
class Pass:
    """Sizes in mm; ``wall`` is the strip of y that the stock fills."""

    diameter: float = 16.0
    corner: float = 3.0
    teeth: int = 2
    helix_deg: float = 25.0
    axial: float = 2.0
    wall: tuple[float, float] = (-math.inf, math.inf)
    rpm: float = 800.0
    feed: float = 160.0
    runout: float = 0.0
    runout_deg: float = 0.0
    points: int = 400

    def but(self, **changes: float) -> Pass:
        return replace(self, **changes)

    @property
    def direction(self) -> str:
        low, high = self.wall
        return "slot" if math.isinf(low) and math.isinf(high) else "down" if math.isinf(low) else "up"

    @property
    def radial(self) -> float:
        low, high = self.wall
        radius = 0.5 * self.diameter
        return {"slot": self.diameter, "down": high + radius, "up": radius - low}[self.direction]

    def forces(self, angle_rad: FloatArray, k: FloatArray) -> FloatArray:
        """Shape (n, 3)."""
        radius = 0.5 * self.diameter
        flat = radius - self.corner
        arc_end = self.corner * math.acos(max(0.0, 1.0 - self.axial / self.corner)) if self.corner > 0.0 else 0.0
        length = arc_end + max(0.0, self.axial - self.corner)
        s = (np.arange(self.points) + 0.5) * length / self.points
        kappa = np.where(s < arc_end, s / self.corner if self.corner else 0.0, 0.5 * math.pi)
        z = np.where(s < arc_end, self.corner * (1.0 - np.cos(kappa)), self.corner + s - arc_end)
        r, sk, ck, db = flat + self.corner * np.sin(kappa), np.sin(kappa), np.cos(kappa), length / self.points
        lag = z * math.tan(math.radians(self.helix_deg)) / radius
        chip_feed, toward = self.feed / self.rpm / self.teeth, math.radians(self.runout_deg)
        behind = 2.0 * math.pi * np.arange(self.teeth)[:, None] / self.teeth + lag
        out_by = [[0.0 * lag] for _ in range(self.teeth)]
        if self.runout:  # alike teeth: the one before cut the most
            steps = 2.0 * math.pi * np.arange(1, self.teeth + 1)[:, None] / self.teeth
            out_by = [self.runout * (np.cos(toward + b) - np.cos(toward + b - steps)) for b in behind]
        out = np.zeros((len(angle_rad), 3))
        for first in range(0, len(angle_rad), _ANGLES):
            part = slice(first, first + _ANGLES)
            cos_a, sin_a = np.cos(angle_rad[part, None]), np.sin(angle_rad[part, None])
            for cos_b, sin_b, backs in zip(np.cos(behind), np.sin(behind), out_by, strict=True):
                c, t = cos_a * cos_b + sin_a * sin_b, cos_a * sin_b - sin_a * cos_b
                chip = np.min([n * chip_feed * c * sk + by * sk for n, by in enumerate(backs, 1)], axis=0)
                cuts = (c > 0.0) & (chip > 0.0) & (r * t > self.wall[0]) & (r * t < self.wall[1])
                width = np.where(cuts, db, 0.0)
                # per unit of the coefficients of chip area (k[0], k[2], k[4]) and of edge length
                for per, (kt, kr, ka) in ((chip * width, k[0::2]), (width, k[1::2])):
                    along, across = per * c, per * t
                    out[part, 0] -= kt * across.sum(axis=1) + along @ (kr * sk + ka * ck)
                    out[part, 1] += kt * along.sum(axis=1) - across @ (kr * sk + ka * ck)
                    out[part, 2] += per @ (kr * ck - ka * sk)
        return out

    def mean(self, k: FloatArray) -> FloatArray:
        """Shape (3,)."""
        return _mean_of(self, tuple(k.tolist())).copy()

    def tool(self) -> dict[str, object]:
        """The tool's table of a file of cuts."""
        table: dict[str, object] = {"diameter_mm": self.diameter, "teeth": self.teeth, "helix_deg": self.helix_deg}
        if self.corner == 0.0:
            return table | {"kind": "flat"}
        if self.corner == 0.5 * self.diameter:
            return table | {"kind": "ball"}
        return table | {"kind": "bull", "corner_radius_mm": self.corner}

    def cut(self, name: str) -> dict[str, object]:
        """The cut's table of a file of cuts, without measurement."""
        return {
            "name": name,
            "direction": self.direction,
            "axial_depth_mm": self.axial,
            "radial_depth_mm": self.radial,
            "spindle_rpm": self.rpm,
            "feed_mm_min": self.feed,
        }


@cache
def _mean_of(cut: Pass, k: tuple[float, ...]) -> FloatArray:
    return np.asarray(cut.forces((np.arange(1440) + 0.5) * math.pi / 720.0, np.array(k)).mean(axis=0))


#: Slots and side cuts, both ways, with feeds and depths that differ.
BULL_CUTS = tuple(
    Pass(axial=axial, feed=feed, wall=wall)
    for axial, wall in ((2.0, (-math.inf, math.inf)), (5.0, (0.0, math.inf)), (4.0, (-math.inf, -2.0)))
    for feed in (80.0, 160.0, 320.0)
)
#: Table 5 of Kaneko et al., down milling.
BALL_CUTS = tuple(
    Pass(diameter=8.0, corner=4.0, helix_deg=30.0, rpm=3600.0, feed=feed, axial=axial, wall=(-math.inf, radial - 4.0))
    for axial, radial in ((8.0, 1.5), (5.0, 3.0), (2.0, 7.0))
    for feed in (100.0, 200.0, 300.0)
)


def log_rows(
    cut: Pass, k: FloatArray, *, rate_hz: float, air_s: float, cut_s: float, phase_rad: float
) -> tuple[FloatArray, NDArray[np.float64]]:
    """Times and forces on the tool: air, a cut that begins and ends at a stroke, air."""
    t = np.arange(0.0, 2.0 * air_s + cut_s, 1.0 / rate_hz)
    inside = (t >= air_s) & (t <= air_s + cut_s)
    force = np.zeros((len(t), 3))
    force[inside] = cut.forces(cut.rpm * math.pi / 30.0 * t[inside] + phase_rad, k)
    return t, force
