"""Sums, peaks and the digest of a run, per tool and in total."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from twin.arrays import FloatArray
from twin.record import RunSummary, Step, ToolSummary
from twin.simulation import kernels

_TOP_LINES = 10
Four = tuple[float, float, float, float]


@dataclass(slots=True)
class _Sums:
    """Running sums of one tool; force order x, y, z, resultant."""

    description: str
    cutting_s: float = 0.0
    air_s: float = 0.0
    rapid_s: float = 0.0
    sampled_s: float = 0.0
    impulse: FloatArray = field(default_factory=lambda: np.zeros(5))
    peak: FloatArray = field(default_factory=lambda: np.zeros(4))
    peak_torque_nm: float = 0.0
    peak_power_w: float = 0.0
    peak_line: int = 0


class Totals:
    """Sums up the steps of a run.

    Args:
        descriptions: text for each tool by number.

    Attributes:
        collisions: number of collisions so far.
    """

    def __init__(self, descriptions: dict[int, str]) -> None:
        self._descriptions = descriptions
        self._tools: dict[int, _Sums] = {}
        self._lines: dict[int, tuple[float, str]] = {}
        self._block = ""
        self._digest = hashlib.sha256()
        self._time_s = 0.0
        self._steps = 0
        self._samples = 0
        self.collisions = 0

    def _tool(self, number: int) -> _Sums:
        sums = self._tools.get(number)
        if sums is None:
            sums = self._tools[number] = _Sums(self._descriptions.get(number, "no tool"))
        return sums

    def set_block(self, text: str) -> None:
        """Set the text of the NC block to which the next steps belong."""
        self._block = text

    def add_time(self, t_s: float) -> None:
        """Advance machine time to ``t_s``."""
        self._time_s = max(self._time_s, t_s)

    def add_step(self, step: Step, sample_s: float) -> None:
        """Add a step whose force samples are ``sample_s`` seconds apart."""
        tool = self._tool(step.tool)
        self._steps += 1
        self.add_time(step.t_s + step.duration_s)
        if step.engagement.cutting:
            tool.cutting_s += step.duration_s
        elif step.rapid:
            tool.rapid_s += step.duration_s
        else:
            tool.air_s += step.duration_s
        samples = step.samples
        n = len(samples.t_s)
        self._samples += n
        if n == 0:
            return
        for array in (samples.t_s, samples.spindle_angle_rad, samples.force_n, samples.torque_nm):
            self._digest.update(np.ascontiguousarray(array).tobytes())
        if step.engagement.cutting:
            self._add_forces(tool, step, sample_s)

    def _add_forces(self, tool: _Sums, step: Step, sample_s: float) -> None:
        samples = step.samples
        sums, peaks = kernels.measure(samples.force_n, samples.torque_nm, samples.power_w)
        highest = float(peaks[kernels.RESULTANT])
        tool.sampled_s += sample_s * len(samples.torque_nm)
        tool.impulse += sums * sample_s
        if highest > tool.peak[kernels.RESULTANT]:
            tool.peak_line = step.nc_line
        tool.peak = np.maximum(tool.peak, peaks[: kernels.TORQUE])
        tool.peak_torque_nm = max(tool.peak_torque_nm, float(peaks[kernels.TORQUE]))
        tool.peak_power_w = max(tool.peak_power_w, float(peaks[kernels.POWER]))
        if highest > self._lines.get(step.nc_line, (0.0, ""))[0]:
            self._lines[step.nc_line] = (highest, self._block)
            if len(self._lines) > 100 * _TOP_LINES:
                self._lines = {line: (force, text) for line, text, force in self._highest()}

    def _highest(self) -> list[tuple[int, str, float]]:
        ordered = sorted(self._lines.items(), key=lambda item: (-item[1][0], item[0]))
        return [(line, text, force) for line, (force, text) in ordered[:_TOP_LINES]]

    def summary(
        self, *, complete: bool, areas_mm2: tuple[FloatArray, ...], removed_mm3: Mapping[int, float]
    ) -> RunSummary:
        """The run so far.

        Args:
            complete: whether the program came to its end.
            areas_mm2: areas of all slices, one array per family; part of the digest.
            removed_mm3: volume removed by each tool.
        """
        digest = self._digest.copy()
        for areas in areas_mm2:
            digest.update(np.ascontiguousarray(areas).tobytes())
        sums = self._tools.values()
        sampled = sum(t.sampled_s for t in sums)
        impulse = sum((t.impulse for t in sums), np.zeros(5))
        peak = np.max([np.zeros(4), *(t.peak for t in sums)], axis=0)
        return RunSummary(
            complete=complete,
            machine_time_s=self._time_s,
            cutting_time_s=sum(t.cutting_s for t in sums),
            removed_volume_mm3=sum(removed_mm3.values()),
            steps=self._steps,
            samples=self._samples,
            peak_force_n=_four(peak),
            mean_force_n=_four(impulse / sampled if sampled > 0.0 else impulse),
            collisions=self.collisions,
            tools=tuple(
                _tool_summary(number, t, removed_mm3.get(number, 0.0)) for number, t in sorted(self._tools.items())
            ),
            top_lines=tuple(self._highest()),
            digest=digest.hexdigest(),
        )


def _four(values: FloatArray) -> Four:
    return float(values[0]), float(values[1]), float(values[2]), float(values[3])


def _tool_summary(number: int, t: _Sums, removed_mm3: float) -> ToolSummary:
    mean = t.impulse / t.sampled_s if t.sampled_s > 0.0 else t.impulse
    return ToolSummary(
        number=number,
        description=t.description,
        cutting_time_s=t.cutting_s,
        air_time_s=t.air_s,
        rapid_time_s=t.rapid_s,
        removed_volume_mm3=removed_mm3,
        peak_force_n=_four(t.peak),
        mean_force_n=_four(mean),
        peak_torque_nm=t.peak_torque_nm,
        mean_torque_nm=float(mean[kernels.TORQUE]),
        peak_power_w=t.peak_power_w,
        peak_line=t.peak_line,
    )
