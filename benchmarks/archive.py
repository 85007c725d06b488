"""Speed of writing and reading a run's file, against the mcap library's own writer: prints one JSON object.

    python -m benchmarks.archive [--seconds 60] [--repeat 3]

The run is a cut at 3600 rpm with a force sample each degree and a step each 30 ms: 21,600 samples a machine second. No
two of its revolutions are alike, or, for the second size, all of them.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mcap.writer import Writer

from benchmarks.report import report
from twin.archive import read_forces, schemas
from twin.record import Engagement, ForceSamples, RunHeader, Step
from twin.sinks.mcap_sink import McapSink

RATE_HZ = 21_600
STEP_S = 0.03
#: The library's writer is so slow that a part of the run is enough.
LIBRARY_SHARE = 10


def make_steps(seconds: float, *, change: float = 0.01) -> list[Step]:
    """Steps of a cut whose forces change from sample to sample by a part of them."""
    random = np.random.default_rng(1)
    per_step = round(RATE_HZ * STEP_S)
    steps = []
    for index in range(round(seconds / STEP_S)):
        t_s = (index * per_step + np.arange(per_step)) / RATE_HZ
        angle = 120.0 * np.pi * t_s
        force = np.column_stack([50.0 * np.abs(np.sin(angle)), 30.0 * np.cos(2.0 * angle), np.full(per_step, -10.0)])
        force *= 1.0 + change * random.normal(size=force.shape)
        torque = 0.004 * force[:, 0]
        power = torque * 3600.0 * (2.0 * np.pi / 60.0)
        samples = ForceSamples(
            t_s=t_s,
            spindle_angle_rad=angle,
            force_n=force,
            torque_nm=torque,
            power_w=power,
        )
        steps.append(
            Step(
                index=index,
                t_s=index * STEP_S,
                duration_s=STEP_S,
                start_mm=(0.1 * index, 0.0, -2.0),
                end_mm=(0.1 * index + 0.1, 0.0, -2.0),
                nc_line=4,
                tool=1,
                rapid=False,
                feed_mm_min=200.0,
                spindle_rpm=3600.0,
                engagement=Engagement(axial_depth_mm=2.0, cutting=True),
                samples=samples,
            )
        )
    return steps


def write_run(path: Path, steps: list[Step]) -> None:
    header = RunHeader(
        twin_version="benchmark",
        program="slot.nc",
        stock_bounds_mm=np.array([[0.0, 0.0, -20.0], [60.0, 60.0, 0.0]]),
        slice_pitch_mm=(0.1, 0.1, 0.1),
        tools=(),
        planned_time_s=len(steps) * STEP_S,
        parameters={},
    )
    with McapSink(path, force=True) as sink:
        sink.write(header)
        for step in steps:
            sink.write(step)


def write_with_library(path: Path, steps: list[Step]) -> None:
    message = schemas.message_class(schemas.FORCE)
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start(schemas.PROFILE, "library")
        schema = writer.register_schema(schemas.FORCE, schemas.ENCODING, schemas.descriptor_set(schemas.FORCE))
        channel = writer.register_channel(schemas.FORCE_TOPIC, schemas.ENCODING, schema)
        for step in steps:
            s = step.samples
            columns = (s.t_s, s.spindle_angle_rad, *s.force_n.T, s.torque_nm, s.power_w)
            for t, angle, x, y, z, torque, power in zip(*(c.tolist() for c in columns), strict=True):
                one = message(
                    t_s=t,
                    spindle_angle_rad=angle,
                    fx_n=x,
                    fy_n=y,
                    fz_n=z,
                    torque_nm=torque,
                    power_w=power,
                    nc_line=step.nc_line,
                    tool=step.tool,
                )
                time_ns = round(t * 1e9)
                writer.add_message(channel, time_ns, one.SerializeToString(), time_ns)
        writer.finish()


def rate(job: Callable[[], object], messages: int, repeat: int) -> float:
    """Median of samples a second."""
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        job()
        times.append(time.perf_counter() - start)
    return round(messages / statistics.median(times))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0, help="machine time of the run")
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    steps = make_steps(options.seconds)
    count = sum(len(s.samples.t_s) for s in steps)
    part = steps[: max(1, len(steps) // LIBRARY_SHARE)]
    part_count = sum(len(s.samples.t_s) for s in part)
    with tempfile.TemporaryDirectory() as folder:
        run, other = Path(folder) / "run.mcap", Path(folder) / "library.mcap"
        alike = Path(folder) / "alike.mcap"
        write_run(alike, make_steps(options.seconds, change=0.0))
        report(
            "archive",
            samples=count,
            repeat=options.repeat,
            write_samples_per_s=rate(lambda: write_run(run, steps), count, options.repeat),
            library_write_samples_per_s=rate(lambda: write_with_library(other, part), part_count, options.repeat),
            read_samples_per_s=rate(lambda: read_forces(run), count, options.repeat),
            bytes_per_sample=round(run.stat().st_size / count, 1),
            bytes_per_sample_alike=round(alike.stat().st_size / count, 1),
        )


if __name__ == "__main__":
    main()
