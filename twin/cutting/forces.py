"""Cutting forces at spindle angles from an engagement map (tri-slice paper, eq. 2 to 5, corrected).

    dF_t = (Ktc h + Kte) db,  dF_r = (Krc h + Kre) db,  dF_a = (Kac h + Kae) db          (the paper prints Kre in dF_t)
    h = s_t (n . f); with runout the least of what each earlier tooth left (Kline & DeVor)

Force on the tool in machine axes; rows x, y, z, columns t, r, a (the paper's eq. 4 is no rotation as printed):

    -sin t   -cos t sin k   -cos t cos k
     cos t   -sin t sin k   -sin t cos k          M4 turns the sign of the first column
     0        cos k         -sin k
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from twin.arrays import FloatArray
from twin.cutting import kernels
from twin.cutting.coefficients import CuttingCoefficients
from twin.cutting.engagement import EngagementMap, EngagementMaps
from twin.tolerance import Tolerance
from twin.tools.edges import CuttingEdges


class ForceModel:
    """Forces of one tool in one material."""

    def __init__(self, edges: CuttingEdges, coefficients: CuttingCoefficients, rows: int, tolerance: Tolerance) -> None:
        self._edges = edges
        self._coefficients = coefficients.values
        self._tolerance = tolerance
        self._angle = edges.pitch_rad[:, None] + edges.lag_rad[None, :]
        self._cos_kappa, self._sin_kappa = np.cos(edges.kappa_rad), np.sin(edges.kappa_rad)
        theta = np.arange(rows) * (2.0 * math.pi / rows)
        self._cos_row, self._sin_row = np.cos(theta), np.sin(theta)
        even = np.allclose(np.diff(edges.pitch_rad), 2.0 * math.pi / edges.teeth, atol=1e-12)
        alike = bool(even) and edges.runout_mm == 0.0
        self._period = rows // edges.teeth if alike and rows % edges.teeth == 0 else rows
        self._feed_part, self._error = self._earlier_teeth(1 if alike else edges.teeth)

    def _earlier_teeth(self, backs: int) -> tuple[FloatArray, FloatArray]:
        """What the teeth before each tooth left: part of the feed per revolution since then, and runout.

        Returns:
            Shapes (teeth, backs) and (teeth, backs, elements): part of a revolution between a tooth and the one so
            many before it, and how much farther out its elements are, mm.
        """
        edges = self._edges
        radial = edges.runout_mm * np.cos(edges.runout_rad + self._angle)
        part, error = np.empty((edges.teeth, backs)), np.empty((edges.teeth, backs, len(edges.z_mm)))
        for m in range(edges.teeth):
            for b in range(backs):
                other = m - b - 1
                gap = edges.pitch_rad[m] - edges.pitch_rad[other] + (2.0 * math.pi if other < 0 else 0.0)
                part[m, b] = gap / (2.0 * math.pi)
                error[m, b] = radial[m] - radial[other]
        return part, error

    def forces(
        self,
        spindle_rad: FloatArray,
        sense: int,
        feed: FloatArray,
        feed_per_rev_mm: float,
        engagement: EngagementMap,
    ) -> FloatArray:
        """Forces and torque at evenly spaced spindle angles.

        Args:
            spindle_rad: shape (n,), signed spindle angles, one map row apart in the sense of rotation.
            sense: +1 for M3, -1 for M4.
            feed: unit feed direction.
            engagement: the map that holds at all of these angles.

        Returns:
            Shape (n, 4): Fx, Fy, Fz on the tool in N, torque in N mm.
        """
        maps = EngagementMaps(engagement.share[None], engagement.turn[None], (engagement.summary,))
        found = self.forces_of_steps(
            [spindle_rad], np.array([float(sense)]), feed[None, :], np.array([feed_per_rev_mm]), maps
        )
        return found[0]

    def forces_of_steps(
        self,
        spindle_rad: Sequence[FloatArray],
        sense: FloatArray,
        feed: FloatArray,
        feed_per_rev_mm: FloatArray,
        engagement: EngagementMaps,
    ) -> list[FloatArray]:
        """Forces and torque in several steps; see `forces`.

        Args:
            spindle_rad: signed spindle angles of each step's samples.
            sense, feed_per_rev_mm: shape (steps,).
            feed: shape (steps, 3).
            engagement: a map a step.

        Returns:
            Shape (n, 4) each, views of one array.
        """
        offsets = np.zeros(len(spindle_rad) + 1, dtype=np.int64)
        np.cumsum([len(angles) for angles in spindle_rad], out=offsets[1:])
        out = np.empty((int(offsets[-1]), 4))
        kernels.sum_forces_of_steps(
            np.array([float(angles[0]) if len(angles) else 0.0 for angles in spindle_rad]),
            offsets,
            self._period,
            sense,
            feed,
            feed_per_rev_mm,
            self._feed_part,
            engagement.share,
            engagement.turn,
            self._angle,
            self._error,
            self._edges.radius_mm,
            self._cos_kappa,
            self._sin_kappa,
            self._edges.length_mm,
            self._cos_row,
            self._sin_row,
            self._coefficients,
            self._tolerance.chip / self._edges.teeth,
            out,
        )
        return [out[a:b] for a, b in pairwise(offsets.tolist())]
