"""CPU time of whole ``gcode`` commands, and of LinuxCNC's rs274 on the same programs: one JSON object.

    python -m benchmarks.gcode_commands [--lines 100000] [--repeat 3] [--seed 1] [--only straight,arcs]

User CPU seconds of a command include the start of Python and all imports, from compiled modules as they are once a
command has run; ``start`` is a program without lines. In every repetition each command runs once,
so that all meet the same load; figures are medians of the repetitions. Output goes to /dev/null.
"""

from __future__ import annotations

import argparse
import math
import os
import random
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from benchmarks.report import report

RS274 = shutil.which("rs274")
HEAD = "%\nG21 G90 G17 G54 G94\nT1 M6\nS12000 M3\nG0 X0. Y0. Z20.\nG1 Z5. F1200.\n"
TAIL = "G0 Z20.\nM5\nM30\n%\n"
COMMANDS = ("stats", "motions", "check")


def straight(lines: int, chance: random.Random) -> Iterable[str]:
    """Lines of a surface: X and Z, and most with Y."""
    for index in range(lines):
        x, z = 0.25 * (index % 400) + chance.uniform(-0.01, 0.01), 2.0 * math.sin(index / 40.0)
        yield f"X{x:.4f}Y{0.2 * (index // 400):.4f}Z{z:.4f}" if chance.random() < 0.9 else f"X{x:.4f}Z{z:.4f}"


def arcs(lines: int, chance: random.Random) -> Iterable[str]:
    """Slots around a part: one arc after every second line, by its centre, the code in each block that changes it."""
    radius = 1.0
    for index in range(lines):
        x, y = 10.0 * (index // 3 % 50), 0.05 * (index // 150)
        radius = radius if index % 3 else 1.0 + round(chance.random(), 3)
        yield (
            f"G1 X{x:.3f} Y{y:.3f}",
            f"X{x + 2.0 * radius:.3f}",
            f"G{2 + index % 2} X{x:.3f} Y{y:.3f} I{-radius:.3f} J0.",
        )[index % 3]


def feeds(lines: int, chance: random.Random) -> Iterable[str]:
    """Straight lines with an F word on each."""
    return (f"{line}F{chance.randint(300, 2000)}." for line in straight(lines, chance))


def speeds(lines: int, chance: random.Random) -> Iterable[str]:
    """Straight lines with an S word on each."""
    return (f"{line}S{chance.randint(3000, 12000)}" for line in straight(lines, chance))


def commented(lines: int, chance: random.Random) -> Iterable[str]:
    """Numbered lines, now and then a comment, coolant and spindle codes."""
    for index, line in enumerate(straight(lines, chance)):
        tail = (" (pass)", " M8", " M3", "")[min(index % 20, 3)]
        yield f"N{index % 99999 + 1} {line}{tail}"


def macros(lines: int, chance: random.Random) -> Iterable[str]:
    """Loops of three blocks, so that about `lines` blocks are executed: a wavy surface by expressions."""
    yield from ("#1 = 0", f"o100 while [#1 LT {lines // 5}]", "#2 = [#1 * 0.05]")
    yield from (f"G1 X[#2] Y[{chance.random():.3f} + #2 / 10] Z[2 * SIN[#2 * 9]]", "#1 = [#1 + 1]", "o100 endwhile")


def expressions(lines: int, chance: random.Random) -> Iterable[str]:
    """Lines with a computed word in each."""
    yield "#5 = 2.5"
    for index in range(lines):
        yield f"X{0.1 * (index % 400):.3f} Z[#5 + {chance.random():.3f}]"


def start(_lines: int, _chance: random.Random) -> Iterable[str]:
    """No lines."""
    return ()


PROGRAMS: Mapping[str, Callable[[int, random.Random], Iterable[str]]] = {
    made.__name__: made for made in (start, straight, arcs, feeds, speeds, commented, macros, expressions)
}


def cpu_s(command: list[str], folder: Path) -> float:
    """User CPU time of a command that must succeed, s."""
    compiled = {"PYTHONPYCACHEPREFIX": str(folder / "compiled"), "PYTHONPATH": str(Path(__file__).parents[1])}
    environment = {**os.environ, **compiled, "HOME": str(folder), "PYTHONDONTWRITEBYTECODE": ""}
    quiet = subprocess.DEVNULL
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run(command, cwd=folder, env=environment, stdin=quiet, stdout=quiet, stderr=quiet, check=True)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def measured(name: str, folder: Path, options: argparse.Namespace) -> dict[str, float]:
    """Seconds of every command on one program, and their ratios to rs274's."""
    path = folder / f"{name}.ngc"
    lines = PROGRAMS[name](options.lines, random.Random(options.seed))
    path.write_text(HEAD + "".join(f"{line}\n" for line in lines) + TAIL)
    ours = [sys.executable, "-m", "gcode"]
    commands = {command: [*ours, command, path.name, "--dialect", "linuxcnc"] for command in COMMANDS}
    if RS274:
        commands["rs274"] = [RS274, "-g", path.name]
    times: dict[str, list[float]] = {command: [] for command in commands}
    for _ in range(options.repeat):
        for command, words in commands.items():
            times[command].append(cpu_s(words, folder))
    figures = {f"{name}_{command}_s": round(statistics.median(values), 3) for command, values in times.items()}
    for command in COMMANDS if RS274 else ():
        ratios = [mine / theirs for mine, theirs in zip(times[command], times["rs274"], strict=True)]
        figures[f"{name}_{command}_over_rs274"] = round(statistics.median(ratios), 2)
    return figures


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lines", type=int, default=100_000)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default=",".join(PROGRAMS), help="names of programs, separated by commas")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as made:
        figures: dict[str, float] = {}
        cpu_s([sys.executable, "-c", "import gcode.cli.app, gcode.cli.commands.stats_tables, rich"], Path(made))
        for command in COMMANDS:  # compiles the modules
            (Path(made) / "start.ngc").write_text(HEAD + TAIL)
            cpu_s([sys.executable, "-m", "gcode", command, "start.ngc"], Path(made))
        for name in options.only.split(","):
            figures |= measured(name, Path(made), options)
    report("gcode_commands", lines=options.lines, repeat=options.repeat, **figures)


if __name__ == "__main__":
    main()
