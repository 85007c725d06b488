"""Replays a job and looks at its records one by one; memory stays flat however long the program."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import twin

JOB = Path(__file__).parent / "ball_slot" / "job.toml"


def main() -> None:
    deepest = 0.0
    for record in twin.records(JOB):
        if isinstance(record, twin.Step) and record.engagement.cutting:
            deepest = max(deepest, record.engagement.axial_depth_mm)
        elif isinstance(record, twin.RunSummary):
            summary = record
    fx, fy, fz, resultant = np.round(summary.mean_force_n, 2)
    print(f"{summary.removed_volume_mm3:.1f} mm3 in {summary.cutting_time_s:.1f} s of cutting, {deepest:.2f} mm deep")
    print(f"mean force on the tool: x {fx} N, y {fy} N, z {fz} N, resultant {resultant} N")


if __name__ == "__main__":
    main()
