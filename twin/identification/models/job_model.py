"""A cut of any engagement: its job is replayed once for each coefficient, the others being zero."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray
from twin.comparison.run_forces import RunForces
from twin.errors import IdentifyError
from twin.identification.fit.harmonics import ComplexArray, find_speed
from twin.identification.fit.means import START
from twin.identification.models.straight import NAMES, unit_coefficients
from twin.job import Cutting, Job, load_job
from twin.record import RunHeader, Step
from twin.simulation.replay import Replay

Span = tuple[float, float]
#: Spindle speeds that differ by less are one.
_SAME_SPEED = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class JobRun:
    """A job's forces for unit coefficients.

    Attributes:
        file: the job file.
        t_s, angle_rad: shape (n,), machine time and spindle angle of the samples with forces.
        force_n: shape (n, 3, 6), force on the tool.
        header: of the run.
        row_rad: spindle angle between samples.
        cut_s: machine time of the first and the last contact in feed.
        rpm, feed_per_tooth_mm, teeth, radius_mm: of the steps that cut.
    """

    file: Path
    t_s: FloatArray
    angle_rad: FloatArray
    force_n: FloatArray
    header: RunHeader
    row_rad: float
    cut_s: Span
    rpm: float
    feed_per_tooth_mm: float
    teeth: int
    radius_mm: float

    def forces(self, k: FloatArray) -> RunForces:
        """The run with these coefficients, shape (6,)."""
        return RunForces(
            path=self.file,
            header=self.header,
            digest="",
            t_s=self.t_s,
            force_n=self.force_n @ k,
            spindle_angle_rad=self.angle_rad,
            steps=np.array([[*self.cut_s, self.rpm, 1.0, 1.0]]),
            teeth={1: self.teeth},
        )

    def seeming_speed(self, window_s: Span, rate_hz: float) -> float:
        """The speed that is found in the run's own force, in parts of the true one."""
        t_s = np.arange(window_s[0], window_s[1], 1.0 / rate_hz)
        if window_s[1] - window_s[0] < 120.0 / self.rpm:
            return 1.0
        return find_speed(t_s, self.forces(np.array(START)).at(t_s), self.rpm, self.teeth) / self.rpm

    def model(self, window_s: Span) -> JobModel:
        """The mean revolution in a window of machine time.

        Raises:
            IdentifyError: a window without a whole revolution of cutting.
        """
        turn_s = 60.0 / self.rpm
        turns = math.floor((window_s[1] - window_s[0]) / turn_s * (1.0 + 1e-9))
        first = 0.5 * (window_s[0] + window_s[1] - turns * turn_s)
        inside = (self.t_s >= first - 1e-12) & (self.t_s < first + turns * turn_s - 1e-9 * turn_s)
        if turns < 1 or not inside.any():
            raise IdentifyError(
                f"{self.file}: nothing is cut for a revolution ({turn_s:.4f} s) from {window_s[0]:g} to "
                f"{window_s[1]:g} s of machine time; it cuts from {self.cut_s[0]:.3f} to {self.cut_s[1]:.3f} s"
            )
        samples = turns * round(2.0 * math.pi / self.row_rad)
        return JobModel(self, self.angle_rad[inside], self.force_n[inside], samples)


@dataclass(slots=True, eq=False)
class JobModel:
    """The mean revolution of a job's run; see `twin.identification.models.model.Model`."""

    run: JobRun
    angle_rad: FloatArray
    force_n: FloatArray
    samples: int

    @property
    def feed_per_tooth_mm(self) -> float:
        """See `Model`."""
        return self.run.feed_per_tooth_mm

    @property
    def teeth(self) -> int:
        """See `Model`."""
        return self.run.teeth

    @property
    def has_runout(self) -> bool:
        """The job has its own."""
        return False

    def means(self) -> FloatArray:
        """See `Model`."""
        return np.asarray(self.force_n.sum(axis=0) / self.samples)

    def harmonics(self, count: int, runout_mm: FloatArray | None = None) -> ComplexArray:  # noqa: ARG002
        """See `Model`; the runout is the job's, not the given one."""
        turn = np.exp(-1j * np.outer(np.arange(count + 1), self.angle_rad))
        c = np.tensordot(turn, self.force_n, axes=(1, 0)) * (2.0 / self.samples)
        c[0] *= 0.5
        return np.asarray(c)


def replay_units(path: Path) -> JobRun:
    """Replay a job once for each coefficient.

    Raises:
        TwinError, gcode.errors.GcodeError: a job that cannot be replayed.
        IdentifyError: a job that cuts nothing, with several tools, speeds, or with an M4 spindle.
    """
    job = load_job(path)
    header, steps = _replayed(_with_unit(job, 0))
    cutting = [s for s in steps if s.engagement.cutting and not s.rapid]
    tools, speeds = {s.tool for s in cutting}, {s.spindle_rpm for s in cutting}
    if not cutting:
        raise IdentifyError(f"{path}: this job cuts nothing, expected a test cut")
    if len(tools) > 1 or max(speeds) - min(speeds) > _SAME_SPEED or min(speeds) <= 0.0:
        listed = f"tools {sorted(tools)} at {', '.join(f'{s:g}' for s in sorted(speeds))} rpm"
        raise IdentifyError(f"{path}: this job cuts with {listed}; expected one tool at one speed, M3")
    tool, rpm = job.tool(cutting[0].tool), cutting[0].spindle_rpm
    samples = [s.samples for s in steps]
    forces = [_forces(steps), *(_forces(_replayed(_with_unit(job, k))[1]) for k in range(1, len(NAMES)))]
    return JobRun(
        file=path,
        t_s=np.concatenate([s.t_s for s in samples]),
        angle_rad=np.concatenate([s.spindle_angle_rad for s in samples]),
        force_n=np.stack(forces, axis=2),
        header=header,
        row_rad=math.radians(job.simulation.angle_step_deg),
        cut_s=(cutting[0].t_s, cutting[-1].t_s + cutting[-1].duration_s),
        rpm=rpm,
        feed_per_tooth_mm=max(s.feed_mm_min for s in cutting) / (rpm * tool.teeth),
        teeth=tool.teeth,
        radius_mm=0.5 * tool.diameter_mm,
    )


def _with_unit(job: Job, index: int) -> Job:
    values = unit_coefficients(index)
    cutting = Cutting(**{name: getattr(values, name) for name in NAMES}, source=values.source)
    tools = tuple(tool.model_copy(update={"cutting": None}) for tool in job.tools)
    return job.model_copy(update={"cutting": cutting, "tools": tools})


def _replayed(job: Job) -> tuple[RunHeader, list[Step]]:
    with Replay(job, preview=False) as run:
        records = [record for record in run if isinstance(record, RunHeader | Step)]
    header = records[0]
    assert isinstance(header, RunHeader)
    return header, [record for record in records if isinstance(record, Step)]


def _forces(steps: list[Step]) -> FloatArray:
    return np.concatenate([s.samples.force_n for s in steps])
