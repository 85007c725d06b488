"""Cutting forces at spindle angles from an engagement map (tri-slice paper, eq. 2 to 5, corrected).

The equations themselves are in `twin.cutting.equation_kernels`; with runout the chip is the least that each earlier
tooth left (Kline & DeVor).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from twin.arrays import FloatArray
from twin.cutting.coefficients import CuttingCoefficients
from twin.cutting.edge_arrays import Flutes
from twin.cutting.engagement import EngagementMap, EngagementMaps, edge_arrays, row_angles
from twin.cutting.equation_kernels import Coefficients
from twin.cutting.force_kernels import LINEAR, Step, Steps, sum_forces_of_steps, sum_unit_forces
from twin.tolerance import Tolerance
from twin.tools.edges import CuttingEdges


class ForceModel:
    """Forces of one tool in one material."""

    def __init__(self, edges: CuttingEdges, coefficients: CuttingCoefficients, rows: int, tolerance: Tolerance) -> None:
        self._edges, self._rows = edge_arrays(edges), row_angles(rows)
        self._coefficients = Coefficients(*(float(getattr(coefficients, name)) for name in Coefficients._fields))
        self._least_chip = float(tolerance.chip / edges.teeth)
        even = np.allclose(np.diff(edges.pitch_rad), 2.0 * math.pi / edges.teeth, atol=1e-12)
        alike = bool(even) and edges.runout_mm == 0.0
        self._period = rows // edges.teeth if alike and rows % edges.teeth == 0 else rows
        self._flutes = _flutes(edges, 1 if alike else edges.teeth)

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

    def unit_forces(
        self, spindle_rad: FloatArray, sense: int, feed: FloatArray, feed_per_rev_mm: float, engagement: EngagementMap
    ) -> FloatArray:
        """Forces under the linear law for each coefficient being 1 and the others 0, whatever those of the model.

        Arguments are those of `forces`.

        Returns:
            Shape (n, 3, 6): Fx, Fy, Fz on the tool per unit of the coefficients, in the order of `Coefficients`.
        """
        out = np.empty((len(spindle_rad), 3, LINEAR))
        step = Step(
            first_rad=float(spindle_rad[0]),
            sense=float(sense),
            feed_x=float(feed[0]),
            feed_y=float(feed[1]),
            feed_z=float(feed[2]),
            feed_per_rev=feed_per_rev_mm,
            period=self._period,
            least_chip=self._least_chip * feed_per_rev_mm,
        )
        sum_unit_forces(step, engagement.share, engagement.turn, self._flutes, self._edges, self._rows, out)
        return out

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
        steps = Steps(
            first_rad=np.array([float(angles[0]) if len(angles) else 0.0 for angles in spindle_rad]),
            offsets=offsets,
            sense=sense,
            feed=feed,
            feed_per_rev=feed_per_rev_mm,
            share=engagement.share,
            turn=engagement.turn,
        )
        sum_forces_of_steps(
            steps, self._flutes, self._edges, self._rows, self._coefficients, self._period, self._least_chip, out
        )
        return [out[a:b] for a, b in pairwise(offsets.tolist())]


def _flutes(edges: CuttingEdges, backs: int) -> Flutes:
    """Flutes with the material left by as many earlier teeth: feed since they passed, and runout between them."""
    angle = edges.pitch_rad[:, None] + edges.lag_rad[None, :]
    radial = edges.runout_mm * np.cos(edges.runout_rad + angle)
    part, runout_step_mm = np.empty((edges.teeth, backs)), np.empty((edges.teeth, backs, len(edges.z_mm)))
    for m in range(edges.teeth):
        for b in range(backs):
            other = m - b - 1
            gap = edges.pitch_rad[m] - edges.pitch_rad[other] + (2.0 * math.pi if other < 0 else 0.0)
            part[m, b] = gap / (2.0 * math.pi)
            runout_step_mm[m, b] = radial[m] - radial[other]
    return Flutes(angle, part, runout_step_mm)
