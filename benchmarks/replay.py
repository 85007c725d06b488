"""Speed of a whole replay against machine time: prints one JSON object.

    python -m benchmarks.replay [--job examples/ball_slot/job.toml] [--repeat 3]

Kernels are compiled by a first run that does not count. Records are discarded; `benchmarks.archive` measures what
keeping them costs.
"""

from __future__ import annotations

import argparse
import statistics
import time
from pathlib import Path

from benchmarks.report import report
from twin.job import Job, load_job
from twin.record import RunSummary
from twin.simulation.replay import Replay

EXAMPLES = Path(__file__).parents[1] / "examples"


def once(job: Job) -> tuple[float, RunSummary]:
    begin = time.perf_counter()
    with Replay(job) as run:
        for _ in run:
            pass
        summary = run.summary(complete=True)
    return time.perf_counter() - begin, summary


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--job", type=Path, default=EXAMPLES / "ball_slot" / "job.toml")
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    job = load_job(options.job)
    first_s, summary = once(job)
    walls = [once(job)[0] for _ in range(options.repeat)]
    median = statistics.median(walls)
    report(
        "replay",
        job=options.job.parent.name,
        machine_time_s=round(summary.machine_time_s, 3),
        steps=summary.steps,
        samples=summary.samples,
        first_run_s=round(first_s, 3),
        median_s=round(median, 3),
        min_s=round(min(walls), 3),
        max_s=round(max(walls), 3),
        real_time_factor=round(summary.machine_time_s / median, 2),
        ms_per_step=round(1000.0 * median / summary.steps, 3),
    )


if __name__ == "__main__":
    main()
