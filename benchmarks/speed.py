"""How much faster than the machine a replay is, and what its cost depends on: prints one JSON object.

    python -m benchmarks.speed [--repeat 3] [--out DIR]

The slot: ball R4, two teeth, 2 mm deep, 3600 rpm, forces at every degree, steps and edge elements of 0.1 mm, 60 s of
cutting at 200 mm/min. Real-time factor is machine time over wall time, kernels compiled. With ``--out`` the flat cost
is drawn to ``flat_cost.png``, too. Ratios are of medians taken in one run.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.report import report
from twin.arrays import FloatArray
from twin.job import Job, job_from_dict
from twin.motion.sweep import Body, Sweep
from twin.simulation.replay import Replay
from twin.tolerance import Tolerance
from twin.tools.shape import tool_shape
from twin.workpiece.removal import Removal
from twin.workpiece.stock import box_slices
from twin.workpiece.trislice import CellSlices

COEFFICIENTS = {"Ktc": 935.62, "Kte": 2.0218, "Krc": 416.73, "Kre": 1.8238, "Kac": 2.72e-05, "Kae": 3.32e-06}
PITCH_MM = 0.1
PASSES = 80
PASS_MM = 20.0


def slot(folder: Path, feed_mm_min: float, pitch_mm: float = PITCH_MM, length_mm: float = 200.0) -> dict[str, Any]:
    """A job of one slot."""
    program = folder / "slot.nc"
    program.write_text(
        f"G21 G90 G94\nT1 M6\nS3600 M3\nG0 X-6 Y15\nG43 H1 Z20\nZ-2\nG1 X{length_mm - 2:g} F{feed_mm_min:g}\nM30\n"
    )
    ball = {"number": 1, "kind": "ball", "diameter_mm": 8.0, "teeth": 2, "helix_deg": 30.0, "flute_length_mm": 20.0}
    return {
        "program": {"file": str(program)},
        "stock": {"box_mm": {"min": [0, 0, -20], "max": [length_mm + 8.0, 30, 0]}},
        "tools": [{**ball, "length_mm": 80.0}],
        "cutting": {**COEFFICIENTS, "source": "Kaneko et al., Table 4"},
        "simulation": {"slice_pitch_mm": pitch_mm, "step_mm": 0.1, "angle_step_deg": 1.0, "axial_step_mm": 0.1},
    }


def once(job: Job, threads: int) -> tuple[float, str]:
    """Real-time factor and digest of one replay without drawing the part."""
    begin = time.perf_counter()
    with Replay(job, threads=threads, preview=False) as run:
        for _ in run:
            pass
        summary = run.summary(complete=True)
    return summary.machine_time_s / (time.perf_counter() - begin), summary.digest


def real_time_factors(folder: Path, repeat: int) -> dict[str, Any]:
    """The table: one and two threads, three cases."""
    made: dict[str, Any] = {}
    cases = {"200 mm/min": (200.0, 0.1), "2000 mm/min": (2000.0, 0.1), "200 mm/min, 0.05 mm": (200.0, 0.05)}
    for name, (feed, pitch) in cases.items():
        job = job_from_dict(slot(folder, feed, pitch), folder)
        once(job_from_dict(slot(folder, feed, pitch, 20.0), folder), 2)
        job = job_from_dict(slot(folder, feed, pitch), folder)
        found = {threads: [once(job, threads) for _ in range(repeat)] for threads in (1, 2)}
        digests = {digest for runs in found.values() for _, digest in runs}
        made[name] = {f"{threads} threads": rounded([rtf for rtf, _ in runs]) for threads, runs in found.items()}
        made[name]["equal digests"] = len(digests) == 1
    return made


def whole_command(folder: Path, repeat: int) -> dict[str, Any]:
    """``twin replay`` with an archive, as a process: its start and what it writes are in the time."""
    data = slot(folder, 200.0)
    job = folder / "job.toml"
    tool, simulation = data["tools"][0], data["simulation"]
    tables = {"program": data["program"], "cutting": data["cutting"], "simulation": simulation}
    text = "\n".join(f"[{name}]\n" + lines(table) for name, table in tables.items())
    box = data["stock"]["box_mm"]
    text += f"\n[stock]\nbox_mm = {{ min = {box['min']}, max = {box['max']} }}\n[[tools]]\n{lines(tool)}"
    job.write_text(text + '\n[output]\nmcap = "run.mcap"\n')
    walls = []
    for _ in range(repeat + 1):
        begin = time.perf_counter()
        subprocess.run(
            [sys.executable, "-c", "from twin.cli import main; main()", "replay", str(job), "--quiet", "--force"],
            check=True,
        )
        walls.append(time.perf_counter() - begin)
    cutting_s = 60.0
    return {"real-time factor": rounded([cutting_s / wall for wall in walls[1:]]), "wall_s": rounded(walls[1:])}


def lines(table: dict[str, Any]) -> str:
    return "\n".join(f'{key} = "{v}"' if isinstance(v, str) else f"{key} = {v}" for key, v in table.items()) + "\n"


def rounded(values: list[float]) -> dict[str, float]:
    return {name: round(of(values), 2) for name, of in (("median", statistics.median), ("min", min), ("max", max))}


def zigzag() -> list[float]:
    """Milliseconds per mm of each pass of a zigzag, 0.5 mm apart, in sweeps of a millimetre."""
    tolerance = Tolerance.for_pitch(PITCH_MM)
    body = Body.of(tool_shape("ball", 8.0, 20.0), chord_mm=tolerance.chord_mm)
    piece = CellSlices(box_slices((0.0, 0.0, -6.0), (PASS_MM, 8.0 + 0.5 * PASSES, 0.0), PITCH_MM))
    times = []
    with Removal(piece, tolerance.chord_mm) as removal:
        for number in range(PASSES):
            begin = time.perf_counter()
            for a, b in path(4.0 + 0.5 * number, number % 2 == 1):
                removal.cut(Sweep(body, a, b))
            times.append((time.perf_counter() - begin) * 1000.0 / PASS_MM)
    return times


def path(y: float, back: bool) -> list[tuple[FloatArray, FloatArray]]:
    xs = np.arange(0.0, PASS_MM + 1.0)
    points = [np.array([x, y, -2.0]) for x in (xs[::-1] if back else xs)]
    return list(pairwise(points))


def block_sizes() -> dict[str, float]:
    """Milliseconds per mm of a slot of 40 mm in blocks of 60 mm and of 600 mm, turn by turn."""
    tolerance = Tolerance.for_pitch(PITCH_MM)
    body = Body.of(tool_shape("ball", 8.0, 20.0), chord_mm=tolerance.chord_mm)
    times: dict[float, list[float]] = {60.0: [], 600.0: []}
    for _ in range(5):
        for size, found in times.items():
            piece = CellSlices(box_slices((0.0, 0.0, -10.0), (size, size, 0.0), PITCH_MM))
            with Removal(piece, tolerance.chord_mm) as removal:
                begin = time.perf_counter()
                for n in range(40):
                    at = np.array([5.0 + n, 30.0, -2.0])
                    removal.cut(Sweep(body, at, at + np.array([1.0, 0.0, 0.0])))
                found.append((time.perf_counter() - begin) * 1000.0 / 40.0)
    medians = {size: statistics.median(found) for size, found in times.items()}
    return {
        "60 mm block, ms/mm": round(medians[60.0], 3),
        "600 mm block, ms/mm": round(medians[600.0], 3),
        "ratio": round(medians[600.0] / medians[60.0], 3),
    }


def across() -> dict[str, Any]:
    """Milliseconds per mm of passes across a face with scallops 0.5 mm apart, and across a flat one, equally deep."""
    tolerance = Tolerance.for_pitch(PITCH_MM)
    body = Body.of(tool_shape("ball", 8.0, 20.0), chord_mm=tolerance.chord_mm)
    face, made = -1.8, {}
    for depth in (0.5, 2.0):
        times: dict[str, list[float]] = {"fresh": [], "scalloped": []}
        for kind in ("fresh", "scalloped") * 5:
            piece = CellSlices(box_slices((0.0, 0.0, -6.0), (40.0, 40.0, face if kind == "fresh" else 0.0), PITCH_MM))
            with Removal(piece, tolerance.chord_mm) as removal:
                for y in np.arange(-4.0, 44.1, 0.5) if kind == "scalloped" else ():
                    removal.cut(Sweep(body, np.array([-5.0, y, face]), np.array([45.0, y, face])))
                begin = time.perf_counter()
                for x, y in ((x, y) for x in (10.0, 20.0, 30.0) for y in range(40)):
                    removal.cut(Sweep(body, np.array([x, y, face - depth]), np.array([x, y + 1.0, face - depth])))
                times[kind].append((time.perf_counter() - begin) * 1000.0 / 120.0)
        fresh, scalloped = (statistics.median(times[kind]) for kind in ("fresh", "scalloped"))
        made[f"{depth:g} mm deep"] = {
            "fresh face, ms/mm": round(fresh, 3),
            "scalloped face, ms/mm": round(scalloped, 3),
            "ratio": round(scalloped / fresh, 3),
        }
    return made


def memory() -> dict[str, Any]:
    """Memory of the slices after facing squares of growing side, and after one slot in blocks of two sizes."""
    tolerance = Tolerance.for_pitch(PITCH_MM)
    body = Body.of(tool_shape("ball", 8.0, 20.0), chord_mm=tolerance.chord_mm)
    squares = {}
    for side in (10.0, 20.0, 40.0):
        piece = CellSlices(box_slices((0.0, 0.0, -10.0), (60.0, 60.0, 0.0), PITCH_MM))
        with Removal(piece, tolerance.chord_mm) as removal:
            for y in np.arange(10.0, 10.0 + side, 0.5):
                removal.cut(Sweep(body, np.array([10.0, y, -2.0]), np.array([10.0 + side, y, -2.0])))
        squares[f"{side:g} mm square, bytes/mm2"] = round(piece.bytes_in_use / side**2)
    blocks = {}
    for size in (60.0, 600.0):
        piece = CellSlices(box_slices((0.0, 0.0, -10.0), (size, size, 0.0), PITCH_MM))
        with Removal(piece, tolerance.chord_mm) as removal:
            removal.cut(Sweep(body, np.array([5.0, 30.0, -2.0]), np.array([45.0, 30.0, -2.0])))
        blocks[f"slot in a block of {size:g} mm, MiB"] = round(piece.bytes_in_use / 2**20, 1)
    return {**squares, **blocks}


def draw(times: list[float], out: Path) -> None:
    """The cost of each pass as a picture."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(7.0, 3.2), layout="constrained")
    axes.plot(range(1, len(times) + 1), times, ".-")
    axes.set(xlabel="pass of the zigzag", ylabel="removal, ms per mm", ylim=(0.0, 1.3 * max(times)))
    axes.grid(alpha=0.3)
    figure.savefig(out / "flat_cost.png", dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--out", type=Path, default=None)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        factors = real_time_factors(folder, options.repeat)
        command = whole_command(folder, options.repeat)
    runs = [zigzag() for _ in range(options.repeat)]
    times = [statistics.median(of_pass) for of_pass in zip(*runs, strict=True)]
    if options.out is not None:
        draw(times, options.out)
    report(
        "speed",
        real_time_factors=factors,
        whole_command=command,
        zigzag={
            "last passes over pass 2 to 4": round(statistics.median(times[-3:]) / statistics.median(times[1:4]), 3),
            "ms/mm": round(statistics.median(times), 3),
        },
        block_size=block_sizes(),
        across=across(),
        memory=memory(),
    )


if __name__ == "__main__":
    main()
