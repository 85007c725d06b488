"""Keeps a run in memory and takes its forces as numpy arrays: mean of a steady part, tooth-passing harmonics."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from twin.job import load_job
from twin.simulation.replay import Replay
from twin.sinks.memory import MemorySink

JOB = Path(__file__).parent / "ball_slot" / "job.toml"
STEADY_S = (5.0, 6.0)
SAMPLES_A_REVOLUTION = 360


def main() -> None:
    with MemorySink() as sink, Replay(load_job(JOB)) as run:
        for record in run:
            sink.write(record)
    forces = sink.forces()
    steady = (forces["t_s"] >= STEADY_S[0]) & (forces["t_s"] < STEADY_S[1])
    fy = forces["fy_n"][steady]
    revolutions = len(fy) // SAMPLES_A_REVOLUTION
    spectrum = (
        np.abs(np.fft.rfft(fy[: revolutions * SAMPLES_A_REVOLUTION])) * 2.0 / (revolutions * SAMPLES_A_REVOLUTION)
    )
    print(f"Fy from {STEADY_S[0]} to {STEADY_S[1]} s: mean {fy.mean():.2f} N, peak {fy.max():.2f} N")
    for order in (2, 4, 6, 8):
        print(f"  {order} per revolution: {spectrum[order * revolutions]:.2f} N")


if __name__ == "__main__":
    main()
