"""Makes recordings/reference: a small run, and a SYNTHETIC dynamometer log of the same cut. Nothing here was measured.

The log is not made from the run: it comes from the model of examples/test_cuts/make_logs.py, edges integrated against a
block given by inequalities, with runout, which the run does not have. Noise, zero offsets and a delay are added.

    python tools/make_reference_recording.py
"""

from __future__ import annotations

import runpy
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import twin

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "recordings" / "reference"
RUN, LOG = FOLDER / "slot.mcap", FOLDER / "slot_synthetic.csv"
RATE_HZ, DELAY_S = 4000.0, 0.2345
OFFSET_N, NOISE_N = np.array([6.0, -4.0, 2.0]), 1.0
LENGTH_MM, DEPTH_MM = 20.0, 2.0


def main() -> None:
    """Replay the job, then write the log."""
    twin.replay(FOLDER / "slot.toml", mcap=RUN, force=True)
    t_s, on_tool = forces_on_tool()
    LOG.write_text(log_text(t_s, on_tool))
    for path in (RUN, LOG):
        print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1e3:.0f} kB")


def forces_on_tool() -> tuple[np.ndarray, np.ndarray]:
    """Times of the samples, s, and forces of the independent model, N, shape (n, 3)."""
    model = runpy.run_path(str(ROOT / "examples" / "test_cuts" / "make_logs.py"))
    cuts = list(feed_steps())
    t_s = np.arange(int((cuts[-1].t_s + 1.0) * RATE_HZ)) / RATE_HZ
    force = np.zeros((len(t_s), 3))
    for cut in cuts:
        at = (t_s - DELAY_S >= cut.t_s) & (t_s - DELAY_S < cut.t_s + cut.duration_s)
        along = (np.array(cut.end_mm) - cut.start_mm) / np.linalg.norm(np.subtract(cut.end_mm, cut.start_mm))
        speed, turns_s = cut.feed_mm_min / 60.0, cut.spindle_rpm / 60.0
        tip = cut.start_mm + np.outer(speed * (t_s[at] - DELAY_S - cut.t_s), along)
        angle = 2.0 * np.pi * turns_s * (t_s[at] - DELAY_S - cuts[0].t_s) + cuts[0].samples.spindle_angle_rad[0]
        force[at] = model["forces_on_tool"](
            tip,
            np.tile(along, (len(tip), 1)),
            angle,
            speed / turns_s / model["TEETH"],
            model["edges"](DEPTH_MM),
            LENGTH_MM,
            np.inf,
        )
    return t_s, force


def feed_steps() -> Iterator[twin.Step]:
    """Steps of the run that move at feed."""
    for record in twin.open_run(RUN).records():
        if isinstance(record, twin.Step) and record.feed_mm_min > 0.0 and not record.rapid:
            yield record


def log_text(t_s: np.ndarray, on_tool: np.ndarray) -> str:
    """The force on the workpiece in a dynamometer whose x axis is the machine's y, and its y axis the machine's -x."""
    force = np.column_stack((-on_tool[:, 1], on_tool[:, 0], -on_tool[:, 2]))
    force += OFFSET_N + np.random.default_rng(20261).normal(0.0, NOISE_N, force.shape)
    rows = [f"{t:.5f},{x:.1f},{y:.1f},{z:.1f}" for t, (x, y, z) in zip(t_s, force, strict=True)]
    source = "# SYNTHETIC DATA: computed by tools/make_reference_recording.py, not measured."
    return "\n".join([source, "Time [s],Fx [N],Fy [N],Fz [N]", *rows, ""])


if __name__ == "__main__":
    main()
