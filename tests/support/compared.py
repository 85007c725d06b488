"""A run made of records with asymmetric forces, and logs of it with something done to them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from support.slot_run import SlotRun
from twin.arrays import FloatArray, frozen
from twin.comparison.run_forces import RunForces, run_forces
from twin.measured.log import ForceLog
from twin.record import Record, RunHeader, Step

RATE_HZ = 5000.0


def records(parameters: dict[str, str] | None = None) -> Iterator[Record]:
    """`SlotRun` with forces that differ on every axis: a slot that begins at 0.8 s, ends at 6.8 s and grows."""
    for record in SlotRun(step_mm=4.0, per_turn=120, collision=False).records():
        if isinstance(record, RunHeader):
            record = replace(record, parameters={"tools[0].number": "1", "tools[0].teeth": "2", **(parameters or {})})
        if isinstance(record, Step) and len(record.samples.t_s):
            record = replace(record, samples=replace(record.samples, force_n=_force(record)))
        yield record


def _force(step: Step) -> FloatArray:
    angle = step.samples.spindle_angle_rad
    cutting = np.any(step.samples.force_n != 0.0, axis=1)
    size = np.where(cutting, 60.0 + 5.0 * step.samples.t_s, 0.0)
    x = -0.3 + 0.5 * np.sin(2.0 * angle) + 0.1 * np.sin(4.0 * angle + 0.4)
    y = 0.6 + 0.4 * np.cos(2.0 * angle + 0.3) - 0.15 * np.cos(6.0 * angle)
    z = 0.2 + 0.1 * np.cos(2.0 * angle - 0.9) + 0.06 * np.sin(8.0 * angle)
    return frozen(size[:, None] * np.column_stack([x, y, z]), "force_n", (None, 3))


def run() -> RunForces:
    return run_forces(Path("run.mcap"), records())


def log_of(
    source: RunForces,
    *,
    lag_s: float = 0.0,
    noise: float = 0.0,
    rate_hz: float = RATE_HZ,
    span_s: tuple[float, float] = (0.0, 7.6),
    add_n: tuple[float, float, float] = (0.0, 0.0, 0.0),
    drift_n_s: tuple[float, float, float] = (0.0, 0.0, 0.0),
    seed: int = 7,
) -> ForceLog:
    """The run as a log: ``lag_s`` late, with noise of that part of each axis's deviation, an offset, a drift.

    Args:
        span_s: of the log's clock.
    """
    t_s = span_s[0] + np.arange(round((span_s[1] - span_s[0]) * rate_hz)) / rate_hz
    force = source.at(t_s - lag_s)
    force = force + noise * force.std(axis=0) * np.random.default_rng(seed).normal(size=force.shape)
    force = force + np.array(add_n) + t_s[:, None] * np.array(drift_n_s)
    return ForceLog(
        t_s=frozen(t_s, "t_s", (None,)),
        force_n=frozen(force, "force_n", (None, 3)),
        rate_hz=rate_hz,
        channels=("Fx", "Fy", "Fz"),
        source=Path("log.csv"),
    )


def write_log(path: Path, log: ForceLog, names: str = "Time [s],Fx [N],Fy [N],Fz [N]") -> Path:
    rows = np.column_stack([log.t_s, log.force_n])
    np.savetxt(path, rows, delimiter=",", header=names, comments="", fmt="%.9g")
    return path
