"""Replays of programs like those that CAM systems write: prints one JSON object.

    python -m benchmarks.real [--only TEXT] [--seconds 5] [--threads 2] [--no-forces] [--profile] [--whole]

The machine time of each program's first part over the processor time and the wall time of its replay, without its
set-up. The stages of the example's mold are replayed on stocks that lie above the part by their allowance. A first
short replay of each, which loads or compiles the code, does not count. With --whole, the stages of the mold are
replayed to their end, and the processor time a millimetre in the last tenth of the path is compared with the first.
"""

from __future__ import annotations

import argparse
import cProfile
import math
import pstats
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.mold import write_mold
from benchmarks.real_programs import CASES, CUTTING
from benchmarks.report import report
from twin.job import Job, job_from_dict
from twin.moldmaking import STAGES, MoldPlan, mold_from_dict
from twin.moldmaking.programs import replay_tables, write_programs
from twin.record import Step
from twin.simulation.replay import Replay
from twin.sinks.mcap_sink import McapSink

_JOB = Path(__file__).parents[1] / "examples" / "mold" / "job.toml"
#: Height of the stock above the part in each stage's replay, mm; None for a whole block.
_ABOVE_MM = {"rough": None, "semi": 0.5, "finish": 0.12}
_MOLD_SECONDS = 20.0


def mold_jobs(folder: Path, triangles: int, *, forces: bool) -> Iterator[tuple[str, Job]]:
    """The stages of the example's mold, each a job of its own."""
    part = folder / "mold.stl"
    write_mold(part, triangles)
    plan = MoldPlan(mold_from_dict(tomllib.loads(_JOB.read_text()), folder))
    paths = write_programs(plan, STAGES, force=True)
    tables = replay_tables(plan, paths["all"])
    for stage in STAGES:
        above_mm = _ABOVE_MM[stage]
        stock = tables["stock"] if above_mm is None else {"stl": str(part), "offset_mm": [0.0, 0.0, above_mm]}
        yield (
            f"mold, {stage}",
            job_from_dict(
                {
                    **tables,
                    "program": {**tables["program"], "file": str(paths[stage])},
                    "stock": stock,
                    "simulation": {"slice_pitch_mm": 0.2, "step_mm": 0.2, "axial_step_mm": 0.2, "angle_step_deg": 2.0},
                    **({"cutting": {**CUTTING, "source": "of no material"}} if forces else {}),
                },
                folder,
            ),
        )


def jobs(folder: Path, options: argparse.Namespace) -> Iterator[tuple[str, Job, float, bool]]:
    """Name, job, machine time to be replayed, and whether an archive is written, of each row."""
    for name, case in CASES.items():
        if options.only in name:
            program = folder / f"{len(name)}.nc"
            program.write_text(case.text())
            job = job_from_dict(case.job(program.name), folder)
            yield name, job.without_forces() if options.no_forces else job, case.seconds, case.archive
    if options.only in "mold, rough, semi, finish" or options.only.startswith("mold"):
        for name, job in mold_jobs(folder, options.mold, forces=not options.no_forces):
            if options.only in name:
                yield name, job, math.inf if options.whole else _MOLD_SECONDS, False


def replayed(job: Job, seconds: float, threads: int, archive: Path | None) -> dict[str, Any]:
    """Replay machine time of a job, counted from its first cut."""
    cpu, wall = time.process_time(), time.perf_counter()
    with (
        McapSink(archive, force=True) if archive else nullcontext() as sink,
        Replay(job, threads=threads, preview=False) as run,
    ):
        set_up_s = time.process_time() - cpu
        cpu, wall = time.process_time(), time.perf_counter()
        first_cut_s, motions, line, steps = math.inf, 0, -1, 0
        path_mm, spent_s = [0.0], [0.0]
        for record in run:
            if sink is not None:
                sink.write(record)
            if isinstance(record, Step):
                steps, motions, line = steps + 1, motions + (record.nc_line != line), record.nc_line
                if record.engagement.cutting:
                    path_mm.append(path_mm[-1] + math.dist(record.start_mm, record.end_mm))
                    spent_s.append(time.process_time() - cpu)
                first_cut_s = min(first_cut_s, record.t_s if record.engagement.cutting else math.inf)
                if record.t_s - first_cut_s > seconds:
                    break
        summary = run.summary()
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    return {
        "machine_s": round(summary.machine_time_s, 2),
        "machine over processor time": round(summary.machine_time_s / cpu, 2),
        "machine over wall time": round(summary.machine_time_s / wall, 2),
        "cpu_s": round(cpu, 2),
        "set_up_s": round(set_up_s, 2),
        "last tenth over first": round(_last_over_first(path_mm, spent_s), 2),
        "ms a step": round(1000.0 * cpu / max(1, steps), 3),
        "ms a motion": round(1000.0 * cpu / max(1, motions), 3),
        "removed_mm3": round(summary.removed_volume_mm3, 3),
        "collisions": summary.collisions,
        "peak_n": round(summary.peak_force_n[3], 3),
        "digest": summary.digest[:16],
    }


def _last_over_first(path_mm: list[float], spent_s: list[float]) -> float:
    """Time a millimetre in the last tenth of a path over that in the first."""
    tenths = np.interp(np.array([0.0, 0.1, 0.9, 1.0]) * path_mm[-1], path_mm, spent_s)
    return float((tenths[3] - tenths[2]) / max(tenths[1] - tenths[0], 1e-9))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="rows whose name contains this text")
    parser.add_argument("--seconds", type=float, default=math.inf, help="most machine time of each, from the first cut")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--no-forces", action="store_true")
    parser.add_argument("--profile", action="store_true", help="print where the time goes")
    parser.add_argument("--whole", action="store_true", help="replay the mold's stages to their end")
    parser.add_argument("--mold", type=int, default=50_000, help="triangles of the mold")
    options = parser.parse_args()
    rows = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for title, job, seconds, archive in jobs(folder, options):
            seconds = min(seconds, options.seconds)
            replayed(job, min(2.0, 0.1 * seconds), options.threads, None)
            profile = cProfile.Profile()
            if options.profile:
                profile.enable()
            rows[title] = replayed(job, seconds, options.threads, folder / "run.mcap" if archive else None)
            if options.profile:
                profile.disable()
                print(title, file=sys.stderr)
                pstats.Stats(profile, stream=sys.stderr).sort_stats("tottime").print_stats(18)
    report("real", threads=options.threads, forces=not options.no_forces, rows=rows)


if __name__ == "__main__":
    main()
