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

import numpy as np

from twin.arrays import FloatArray
from twin.cutting import kernels
from twin.cutting.coefficients import CuttingCoefficients
from twin.cutting.engagement import EngagementMap
from twin.tolerance import Tolerance
from twin.tools.edges import CuttingEdges


class ForceModel:
    """Forces of one tool in one material."""

    def __init__(self, edges: CuttingEdges, coefficients: CuttingCoefficients, rows: int, tolerance: Tolerance) -> None:
        self._edges = edges
        self._coefficients = coefficients.values
        self._tolerance = tolerance
        self._angle = edges.pitch_rad[:, None] + edges.lag_rad[None, :]
        self._radial_error = edges.runout_mm * np.cos(edges.runout_rad + self._angle)
        self._cos_kappa, self._sin_kappa = np.cos(edges.kappa_rad), np.sin(edges.kappa_rad)
        even = np.allclose(np.diff(edges.pitch_rad), 2.0 * math.pi / edges.teeth, atol=1e-12)
        alike = even and edges.runout_mm == 0.0 and rows % edges.teeth == 0
        self._period = rows // edges.teeth if alike else rows

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
            spindle_rad: shape (n,), signed spindle angles, one map row apart.
            sense: +1 for M3, -1 for M4.
            feed: unit feed direction.
            engagement: the map that holds at all of these angles.

        Returns:
            Shape (n, 4): Fx, Fy, Fz on the tool in N, torque in N mm.
        """
        n = len(spindle_rad)
        computed = min(n, self._period)
        out = np.empty((computed, 4))
        kernels.sum_forces(
            spindle_rad[:computed],
            float(sense),
            feed,
            feed_per_rev_mm,
            engagement.share,
            engagement.turn,
            engagement.elements,
            self._angle,
            self._edges.pitch_rad,
            self._radial_error,
            self._edges.radius_mm,
            self._cos_kappa,
            self._sin_kappa,
            self._edges.length_mm,
            self._coefficients,
            self._tolerance.chip * feed_per_rev_mm / self._edges.teeth,
            out,
        )
        return out if computed == n else out[np.arange(n) % self._period]
