"""The picture of docs/compare.md: examples/ball_slot against a synthetic log made from it, no measurement.

python tools/make_comparison_picture.py
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray
from twin.comparison.comparison import compare_files
from twin.comparison.plots import window_waveforms
from twin.comparison.run_forces import RunForces, read_run_forces
from twin.job import load_job
from twin.measured.settings import CompareSettings
from twin.simulation.replay import Replay
from twin.sinks.mcap_sink import McapSink

ROOT = Path(__file__).parents[1]
PICTURE = ROOT / "docs" / "pictures" / "compare.png"
RATE_HZ, LATE_S = 10000.0, 0.3456


def synthetic_log(run: RunForces) -> FloatArray:
    """Rows of time and dynamometer forces: 8 % larger, runout, noise, an offset, other axes, late."""
    t_s = np.arange(int(21.0 * RATE_HZ)) / RATE_HZ
    angle = run.angle_at(t_s - LATE_S)
    force = run.at(t_s - LATE_S) * (1.08 + 0.1 * np.cos(angle))[:, None]
    force += np.array([3.0, -2.0, 1.0]) + np.random.default_rng(1).normal(0.0, 1.5, force.shape)
    return np.column_stack([t_s, -force[:, 1], -force[:, 0], force[:, 2]])


def main() -> None:
    """Replay, make the log, compare, draw."""
    with tempfile.TemporaryDirectory() as folder:
        run, log = Path(folder) / "slot.mcap", Path(folder) / "synthetic.csv"
        with Replay(load_job(ROOT / "examples" / "ball_slot" / "job.toml")) as replay, McapSink(run) as sink:
            for record in replay:
                sink.write(record)
        rows = synthetic_log(read_run_forces(run))
        np.savetxt(log, rows, delimiter=",", header="Time [s],Fx [N],Fy [N],Fz [N]", comments="", fmt="%.6g")
        settings = CompareSettings(map="x=-Fy,y=-Fx,z=Fz", windows=("4.00:4.05",), offset="air")
        found = compare_files(run, log, settings)
        PICTURE.write_bytes(window_waveforms(found, found.windows[0]))
    print(PICTURE)


if __name__ == "__main__":
    main()
