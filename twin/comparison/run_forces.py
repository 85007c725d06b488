"""A run's forces as functions of machine time, with the number of teeth of its tools."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray, frozen
from twin.errors import CompareError
from twin.measured.log import Gap
from twin.record import Record, RunHeader, RunSummary, Step

#: ``ball D8 z2``
_TEETH_IN_NAME = re.compile(r"\bz(\d+)\b")
_TOOL_KEY = re.compile(r"^tools\[(\d+)\]\.(number|teeth)$")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunForces:
    """Forces on the tool over a whole run.

    Attributes:
        path: the run's file.
        t_s: shape (n,), strictly increasing machine time.
        force_n: shape (n, 3), linear between the samples.
        spindle_angle_rad: shape (n,).
        steps: shape (k, 5): start and end of each step with the spindle turning, its signed speed (rpm), tool number,
            and 1 where it cuts.
        teeth: of each tool by number.
    """

    path: Path
    header: RunHeader
    digest: str
    t_s: FloatArray
    force_n: FloatArray
    spindle_angle_rad: FloatArray
    steps: FloatArray
    teeth: dict[int, int]

    @property
    def span_s(self) -> Gap:
        """Times of the first and the last sample."""
        return float(self.t_s[0]), float(self.t_s[-1])

    def at(self, t_s: FloatArray) -> FloatArray:
        """Shape (m, 3), force at times; zero outside the run."""
        columns = [np.interp(t_s, self.t_s, self.force_n[:, axis], left=0.0, right=0.0) for axis in range(3)]
        return np.column_stack(columns)

    def angle_at(self, t_s: FloatArray) -> FloatArray:
        """Shape (m,), spindle angle at times, rad."""
        return np.interp(t_s, self.t_s, self.spindle_angle_rad)

    def speed_in(self, window: Gap) -> tuple[float, int] | None:
        """Spindle speed, rpm, and teeth of the tool that cuts longest in a window; None where nothing cuts."""
        begin, end = np.maximum(self.steps[:, 0], window[0]), np.minimum(self.steps[:, 1], window[1])
        share = np.where(self.steps[:, 4] > 0.0, np.maximum(end - begin, 0.0), 0.0)
        if not share.sum() > 0.0:
            return None
        keys = [tuple(row) for row in self.steps[:, 2:4].tolist()]
        totals: dict[tuple[float, ...], float] = {}
        for key, seconds in zip(keys, share.tolist(), strict=True):
            totals[key] = totals.get(key, 0.0) + seconds
        rpm, tool = max(totals, key=lambda key: totals[key])
        return float(rpm), self.teeth.get(int(tool), 1)

    def air(self, margin_s: float, reach_s: float) -> tuple[Gap, ...]:
        """Stretches in which nothing is cut, including the time before and after the run.

        Args:
            margin_s: distance that they keep from cuts.
            reach_s: extent before and after the run.
        """
        cuts = self.steps[self.steps[:, 4] > 0.0, :2]
        begins = np.concatenate([[self.t_s[0] - reach_s], cuts[:, 1] + margin_s])
        ends = np.concatenate([cuts[:, 0] - margin_s, [self.t_s[-1] + reach_s]])
        latest = np.maximum.accumulate(begins)
        return tuple((float(b), float(e)) for b, e in zip(latest, ends, strict=True) if e > b)


def read_run_forces(path: str | PathLike[str]) -> RunForces:
    """The forces of an archived run.

    Raises:
        ArchiveError: see `twin.archive.read_run`.
        CompareError: a run without forces.
    """
    from twin.archive import read_run

    return run_forces(Path(path), read_run(path))


def run_forces(path: Path, records: Iterable[Record]) -> RunForces:
    """The forces among a run's records.

    Raises:
        CompareError: a run without forces.
    """
    from twin.archive.run_metadata import without_samples

    header, digest = None, ""
    times: list[FloatArray] = []
    forces: list[FloatArray] = []
    angles: list[FloatArray] = []
    rows: list[tuple[float, float, float, float, float]] = []
    for record in records:
        match record:
            case RunHeader():
                header = record
            case RunSummary():
                digest = record.digest
            case Step():
                end_s = record.t_s + record.duration_s
                rows.append((record.t_s, end_s, record.spindle_rpm, record.tool, record.engagement.cutting))
                _take(record, times, forces, angles)
    if header is not None and (reason := without_samples(header)):
        raise CompareError(f"{path}: {reason}")
    if header is None or not rows or not any(np.any(f) for f in forces):
        raise CompareError(f"{path}: a run without forces; replay its job with cutting coefficients")
    t_s, force, angle = np.concatenate(times), np.concatenate(forces), np.concatenate(angles)
    keep = np.concatenate([[True], np.diff(np.maximum.accumulate(t_s)) > 0.0])
    return RunForces(
        path=path,
        header=header,
        digest=digest,
        t_s=frozen(t_s[keep], "t_s", (None,)),
        force_n=frozen(force[keep], "force_n", (None, 3)),
        spindle_angle_rad=frozen(angle[keep], "spindle_angle_rad", (None,)),
        steps=frozen(rows, "steps", (None, 5)),
        teeth=teeth_of(header),
    )


def _take(step: Step, times: list[FloatArray], forces: list[FloatArray], angles: list[FloatArray]) -> None:
    """A step's samples; one without any has no force at its begin and end."""
    samples = step.samples
    if len(samples.t_s):
        times.append(samples.t_s)
        forces.append(samples.force_n)
        angles.append(samples.spindle_angle_rad)
        return
    begin = np.nextafter(step.t_s, np.inf)
    angle = float(angles[-1][-1]) if angles else 0.0
    turn = 2.0 * np.pi * step.spindle_rpm / 60.0 * step.duration_s
    times.append(np.array([begin, step.t_s + step.duration_s]))
    forces.append(np.zeros((2, 3)))
    angles.append(np.array([angle, angle + turn]))


def teeth_of(header: RunHeader) -> dict[int, int]:
    """Teeth by tool number, from the job's settings, else from the tool's description (``ball D8 z2``)."""
    found: dict[str, dict[str, int]] = {}
    for key, value in header.parameters.items():
        if parts := _TOOL_KEY.match(key):
            found.setdefault(parts[1], {})[parts[2]] = int(value)
    teeth = {t["number"]: t["teeth"] for t in found.values() if len(t) == 2}
    for tool in header.tools:
        if tool.number not in teeth and (match := _TEETH_IN_NAME.search(tool.description)):
            teeth[tool.number] = int(match[1])
    return teeth
