"""One straight pass of a tool through a block, stepped by the program's own parts, against a golden waveform."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from twin.arrays import FloatArray
from twin.cutting.coefficients import CuttingCoefficients
from twin.cutting.engagement import EngagementMap, EngagementRule, Engager
from twin.cutting.forces import ForceModel
from twin.motion.sweep import Body, Sweep, SweptVolume
from twin.tolerance import Tolerance
from twin.tools.edges import cutting_edges
from twin.tools.shape import tool_shape
from twin.workpiece.removal import Removal
from twin.workpiece.stock import box_slices
from twin.workpiece.trislice import CellSlices

GOLDEN = Path(__file__).parent.parent / "golden" / "forces"
ROWS = 360
#: Where along x the tool is when the forces are taken; the block begins at 0.
AT_X_MM = 20.0


def golden_case(name: str) -> dict[str, Any]:
    case: dict[str, Any] = json.loads((GOLDEN / f"{name}.json").read_text())
    return case


def golden_names() -> list[str]:
    return sorted(p.stem for p in GOLDEN.glob("*.json"))


@dataclass(frozen=True)
class Errors:
    """Errors of a waveform in percent: RMS of the vector error of the peak resultant; the largest error of a mean
    component of the mean resultant; the mean torque's own error."""

    rms_pct: float
    mean_pct: float
    torque_pct: float


class StraightPass:
    """A pass along +x (or down a ramp), the tool entered and somewhat into the block before forces are taken."""

    def __init__(
        self, case: dict[str, Any], *, pitch_mm: float = 0.1, rule: EngagementRule = "majority", edge_terms: bool = True
    ) -> None:
        self.case = case
        t = case["tool"]
        depth = case["axial_depth_mm"]
        shape = tool_shape(
            t["kind"],
            t["diameter_mm"],
            max(depth + 3.0, 0.5 * t["diameter_mm"] + 2.0),
            t["corner_radius_mm"] if t["kind"] == "bull" else 0.0,
        )
        self.tolerance = Tolerance.for_pitch(pitch_mm)
        self.edges = cutting_edges(
            shape,
            teeth=t["teeth"],
            helix_deg=t["helix_deg"],
            axial_step_mm=pitch_mm,
            runout_mm=t["runout_mm"],
            runout_angle_deg=t["runout_angle_deg"],
        )
        self.body = Body.of(shape, chord_mm=self.tolerance.chord_mm)
        reach = round(0.5 * t["diameter_mm"] + 6.0, 1)
        low_y, high_y = case["stock_y_from_axis_mm"]
        low = np.array([0.0, -reach if low_y is None else low_y, -depth - 2.0])
        high = np.array([40.0, reach if high_y is None else high_y, 0.0])
        self.workpiece = CellSlices(box_slices(low, high, pitch_mm))
        self.removal = Removal(self.workpiece, self.tolerance.chord_mm)
        ramp = math.radians(case["ramp_deg"])
        self.feed = np.array([math.cos(ramp), 0.0, -math.sin(ramp)])
        self.per_rev_mm = case["feed_mm_min"] / case["spindle_rpm"]
        self.engager = Engager(shape, self.edges, ROWS, rule, self.tolerance)
        values = dict(case["coefficients"])
        if not edge_terms:
            values |= {"Kte": 0.0, "Kre": 0.0, "Kae": 0.0}
        self.model = ForceModel(self.edges, CuttingCoefficients(**values, source="test"), ROWS, self.tolerance)
        self._lead_in()

    def _lead_in(self) -> None:
        """Cut up to 1 mm before the place where forces are taken."""
        if self.case["previous_pass_y_mm"] is not None:
            self.cut(np.array([-20.0, self.case["previous_pass_y_mm"], 0.0]), 80.0)
        self.cut(np.array([0.0, 0.0, 0.0]) + (AT_X_MM - 1.0) * self.feed / self.feed[0] - 40.0 * self.feed, 40.0)

    def cut(self, offset_mm: FloatArray, length_mm: float) -> float:
        """Sweep along the feed from a place at the pass's own height; returns the removed volume."""
        start = offset_mm + np.array([0.0, 0.0, -self.case["axial_depth_mm"]])
        if self.case["ramp_deg"]:
            start[2] += AT_X_MM * math.tan(math.radians(self.case["ramp_deg"]))
        return self.removal.cut(Sweep(self.body, start, start + length_mm * self.feed))

    def engage(self, forward_mm: float) -> EngagementMap:
        """Engagement with the tool somewhat forward of the place where forces are taken."""
        tip = np.array([AT_X_MM, 0.0, -self.case["axial_depth_mm"]]) + forward_mm * self.feed
        per_tooth = self.per_rev_mm / self.edges.teeth
        found = self.engager.engage(
            tip, self.feed, self.case["feed_mm_min"] / 60.0, per_tooth, self.workpiece, SweptVolume([])
        )
        assert found is not None
        return found

    def waveform(self, forward_mm: float) -> FloatArray:
        """Fx, Fy, Fz (N) and torque (N mm) at each degree, shape (360, 4)."""
        spindle = np.radians(np.arange(360.0))
        return self.model.forces(spindle, 1, self.feed, self.per_rev_mm, self.engage(forward_mm))

    def errors(self, forward_mm: float, leave_out: tuple[int, ...] = ()) -> Errors:
        """Compare a waveform with the golden one, some of its degrees left out of the RMS."""
        want = np.array(self.case["force_on_tool_n"])
        want_torque = np.array(self.case["torque_nmm"])
        got = self.waveform(forward_mm)
        keep = np.setdiff1d(np.arange(360), leave_out)
        off = np.sum((got[keep, :3] - want[keep]) ** 2, axis=1)
        peak = np.sqrt(np.sum(want**2, axis=1)).max()
        mean = want.mean(axis=0)
        return Errors(
            rms_pct=100.0 * float(np.sqrt(off.mean()) / peak),
            mean_pct=100.0 * float(np.abs(got[:, :3].mean(axis=0) - mean).max() / np.linalg.norm(mean)),
            torque_pct=100.0 * float(got[:, 3].mean() / want_torque.mean() - 1.0),
        )

    def close(self) -> None:
        self.removal.close()
