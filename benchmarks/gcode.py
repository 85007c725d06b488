"""Speed of reading a 3-axis surface program, compared with LinuxCNC's rs274 where it is installed: one JSON object.

    python -m benchmarks.gcode [--lines 200000] [--repeat 5] [--seed 1] [--long-lines 1000000]

Every repetition runs each method of reading once, so that all meet the same load; figures are medians of repetitions.
Peak memory is that of a separate process that only makes the arrays; it includes the text of the program.
"""

from __future__ import annotations

import argparse
import math
import os
import random
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Callable
from pathlib import Path

from benchmarks.report import report
from gcode import interpret, motion_arrays
from gcode.bulk.plain_rules import PlainRules, PlainStart
from gcode.bulk.plain_runs import plain_run

RS274 = shutil.which("rs274")
POINTS_A_PASS = 400
HEAD = "%\nO1000\nG21 G90 G17 G54\nS12000 M3\nG0 X0. Y0. Z20.\nG1 Z5. F1200.\n"
TAIL = "G0 Z20.\nM5\nM30\n%\n"


def surface_program(lines: int, seed: int, *, numbered: bool = False) -> bytes:
    """Passes over a wavy surface: X and Z in each line, Y in most, now and then G1 and F, on request block numbers."""
    chance = random.Random(seed)
    wave, phase = chance.uniform(5.0, 9.0), chance.uniform(0.0, math.pi)
    made = []
    for index in range(lines):
        row, column = divmod(index, POINTS_A_PASS)
        x = 0.25 * (column if row % 2 == 0 else POINTS_A_PASS - 1 - column) + chance.uniform(-0.01, 0.01)
        y = 0.2 * row
        z = 2.0 * math.sin(x / wave + phase) * math.cos(y / wave)
        number = f"N{10 * index % 1_000_000}" if numbered else ""
        code = "G1" if chance.random() < 0.03 else ""
        across = f"Y{y + chance.uniform(-0.01, 0.01):.4f}" if chance.random() < 0.9 else ""
        feed = f"F{chance.randint(300, 2000)}." if column == 0 or chance.random() < 0.005 else ""
        made.append(f"{number}{code}X{x:.4f}{across}Z{z:.{chance.choice((3, 4))}f}{feed}\n")
    return (HEAD + "".join(made) + TAIL).encode()


def run_plain(text: bytes) -> None:
    """The plain lines alone."""
    offset = len(HEAD)
    start = PlainStart((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), 1.0, absolute=True, code=1, feed_mm_min=1200.0, line=7)
    while (run := plain_run(text, offset, start, PlainRules())[0]) is not None:
        offset, start = run.offset, run.after


def run_arrays(text: bytes) -> None:
    deque(motion_arrays(text), maxlen=0)


def run_events(text: bytes) -> None:
    deque(interpret(text), maxlen=0)


def rs274_runner(path: Path) -> Callable[[bytes], None]:
    """Runs rs274 on a file, as ``rs274 -g FILE > /dev/null``; it keeps its tool table in a home of its own."""
    environment = {**os.environ, "HOME": str(path.parent)}

    def run(_: bytes) -> None:
        command = [str(RS274), "-g", path.name]
        quiet = subprocess.DEVNULL
        subprocess.run(
            command, cwd=path.parent, env=environment, stdin=quiet, stdout=quiet, stderr=quiet, check=True, timeout=600
        )

    return run


def seconds(read: Callable[[bytes], None], text: bytes) -> float:
    begin = time.perf_counter()
    read(text)
    return time.perf_counter() - begin


def peak_mib(path: Path) -> float:
    """Peak memory of a process that makes the arrays of a program; of one that only loads the code, for no lines."""
    command = [sys.executable, "-m", "benchmarks.gcode", "--peak", str(path)]
    done = subprocess.run(command, cwd=Path(__file__).parents[1], capture_output=True, text=True, check=True)
    return float(done.stdout)


def print_peak(path: Path) -> None:
    deque(motion_arrays(path), maxlen=0)
    status = Path("/proc/self/status").read_text()
    print(next(int(line.split()[1]) for line in status.splitlines() if line.startswith("VmHWM")) / 1024)


def measure(options: argparse.Namespace, folder: Path) -> dict[str, float | None]:
    text = surface_program(options.lines, options.seed)
    path, longer, none = folder / "surface.ngc", folder / "longer.ngc", folder / "none.ngc"
    path.write_bytes(text)
    longer.write_bytes(surface_program(options.long_lines, options.seed))
    none.write_text("M30\n")
    readers: dict[str, Callable[[bytes], None]] = {
        "plain_run": run_plain,
        "arrays": run_arrays,
        "arrays_numbered": run_arrays,
        "events": run_events,
    }
    texts = {"arrays_numbered": surface_program(options.lines, options.seed, numbered=True)}
    if RS274:
        readers["rs274"] = rs274_runner(path)
    rates: dict[str, list[float]] = {name: [] for name in readers}
    for _ in range(options.repeat):
        for name, read in readers.items():
            rates[name].append(options.lines / seconds(read, texts.get(name, text)))
    figures: dict[str, float | None] = {
        f"{name}_lines_per_s": round(statistics.median(values)) for name, values in rates.items()
    }
    ratios = [ours / theirs for ours, theirs in zip(rates["arrays"], rates.get("rs274", []), strict=False)]
    figures["arrays_least_lines_per_s"] = round(min(rates["arrays"]))
    figures["arrays_over_rs274"] = round(statistics.median(ratios), 2) if ratios else None
    figures["arrays_over_rs274_least"] = round(min(ratios), 2) if ratios else None
    for name, file in (("no_lines", none), ("program", path), ("long_program", longer)):
        figures[f"peak_mib_{name}"] = round(peak_mib(file), 1)
        figures[f"text_mib_{name}"] = round(file.stat().st_size / 2**20, 1)
    return figures


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lines", type=int, default=200_000)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--long-lines", type=int, default=1_000_000)
    parser.add_argument("--peak", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.peak:
        print_peak(options.peak)
        return
    with tempfile.TemporaryDirectory() as folder:
        figures = measure(options, Path(folder))
    report("gcode", lines=options.lines, long_lines=options.long_lines, repeat=options.repeat, **figures)


if __name__ == "__main__":
    main()
