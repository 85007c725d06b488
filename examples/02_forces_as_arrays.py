"""Forces of a run as numpy arrays: mean and peak of a steady part, harmonics of the tooth-passing frequency."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import twin

JOB = Path(__file__).parent / "ball_slot" / "job.toml"
STEADY_S = (5.0, 6.0)
SAMPLES_PER_REVOLUTION = 360


def main() -> None:
    forces = twin.replay(JOB).forces
    steady = (forces["t_s"] >= STEADY_S[0]) & (forces["t_s"] < STEADY_S[1])
    fy = forces["fy_n"][steady]
    revolutions = len(fy) // SAMPLES_PER_REVOLUTION
    count = revolutions * SAMPLES_PER_REVOLUTION
    spectrum = np.abs(np.fft.rfft(fy[:count])) * 2.0 / count
    print(f"Fy from {STEADY_S[0]} to {STEADY_S[1]} s: mean {fy.mean():.2f} N, peak {fy.max():.2f} N")
    for order in (2, 4, 6, 8):
        print(f"  {order} per revolution: {spectrum[order * revolutions]:.2f} N")


if __name__ == "__main__":
    main()
