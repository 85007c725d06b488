"""The torus part from STL to a verified program: slicing, roughing, finishing, reach analysis, replay, verification.

    python examples/torus/run.py [--coarse] [--out FOLDER]

Conditions are those of Kaneko et al., Table 1: an R4 ball along y, one way; five layers of roughing 2 mm deep and 2 mm
apart with 0.1 mm allowance, then finishing 0.25 mm apart. ``--coarse`` has larger steps and slices and no forces, and
takes a minute; its rows are too far apart for the tolerance, so the verification ends out of tolerance, as expected.
NC program, job file, pictures and recordings go to the folder, ``examples/torus/recordings`` if not given.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import make_torus

import twin

HERE = Path(__file__).parent
#: Table 4 of the paper, which does not state the number of teeth.
CUTTING = {
    "Ktc": 935.62,
    "Kte": 2.0218,
    "Krc": 416.73,
    "Kre": 1.8238,
    "Kac": 2.72e-05,
    "Kae": 3.32e-06,
    "source": "Kaneko et al., unified 2D polygon-based CAM framework, Table 4",
}
#: Exit code of ``twin verify``.
OUT_OF_TOLERANCE = 4
#: Reasons why the verification ends out of tolerance.
FILLET_EXCESS = "a ball of 4 mm radius cannot reach into the inner fillet of 3 mm"
COARSE_EXCESS = "with --coarse finishing rows are 2 mm apart and leave scallops above the permitted excess of 0.1 mm"


@dataclass(frozen=True, slots=True, kw_only=True)
class Fineness:
    """Resolution of each step, mm; ``around`` and ``along`` are the segments of the STL file."""

    around: int
    along: int
    pitch: float
    rough_step: float
    rough_layers: int
    rough_depth: float
    finish_step: float
    arcs: float
    replay_pitch: float
    replay_step: float


FULL = Fineness(
    around=512,
    along=160,
    pitch=0.05,
    rough_step=2.0,
    rough_layers=5,
    rough_depth=2.0,
    finish_step=0.25,
    arcs=0.001,
    replay_pitch=0.1,
    replay_step=0.25,
)
COARSE = Fineness(
    around=128,
    along=48,
    pitch=0.25,
    rough_step=3.0,
    rough_layers=2,
    rough_depth=3.0,
    finish_step=2.0,
    arcs=0.01,
    replay_pitch=0.4,
    replay_step=1.0,
)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--coarse", action="store_true", help="larger steps and slices")
    parser.add_argument("--out", type=Path, default=HERE / "recordings", help="folder of all files")
    arguments = parser.parse_args()
    fine, out = COARSE if arguments.coarse else FULL, arguments.out
    out.mkdir(parents=True, exist_ok=True)
    stl = out / "torus.stl"
    make_torus.write_stl(stl, make_torus.torus(fine.around, fine.along))

    job = program(fine, stl, out)
    heading("reach: material that a ball of R4, and one of R3, cannot machine")
    command("reach", stl, "--tool", "ball 8", "--tool", "ball 6", "--pitch", fine.pitch)
    heading("replay: material removal" + ("" if arguments.coarse else " and forces"))
    files = ["--mcap", out / "torus.mcap", "--rrd", out / "torus.rrd", "--force"]
    if command("replay", job, *files, *(["--no-forces"] if arguments.coarse else [])):
        return 1
    heading("verify: the machined surface against the STL")
    files = ["--plot", out / "verify.png", "--rrd", out / "verify.rrd", "--force"]
    code = command("verify", job, stl, "--tolerance", 0.02, "--excess", 0.1, *files)
    if code == OUT_OF_TOLERANCE:
        print(f"\nOut of tolerance, as expected: {COARSE_EXCESS if arguments.coarse else FILLET_EXCESS}.")
        code = 0
    return code


def program(fine: Fineness, stl: Path, out: Path) -> Path:
    """Roughing and finishing in one program; returns the job file that replays it."""
    heading("slice, rough, finish")
    rough = scan(
        stl,
        fine,
        stepover_mm=fine.rough_step,
        allowance_mm=0.1,
        layers=fine.rough_layers,
        axial_depth_mm=fine.rough_depth,
        arcs_mm=0.02,
        gouge_mm=0.02,
    )
    finish = scan(rough.setup.part, fine, stepover_mm=fine.finish_step, arcs_mm=fine.arcs, gouge_mm=fine.arcs)
    print(f"slicing and roughing {rough.computed_s:.2f} s, finishing {finish.computed_s:.2f} s")
    # 100 minutes of cutting at 1 degree would fill 13 GB
    simulation = {"slice_pitch_mm": fine.replay_pitch, "step_mm": fine.replay_step, "angle_step_deg": 5.0}
    file, job = out / "torus.nc", out / "job.toml"
    tables = {"simulation": simulation, "cutting": CUTTING}
    lines = twin.write_paths([rough, finish], file, job, header=["torus on a plate"], tables=tables, force=True)
    print(f"{lines} lines in {file}")
    rough.plot(out / "rough.png")
    finish.plot(out / "finish.png")
    return job


def scan(part: Any, fine: Fineness, **values: Any) -> twin.PlannedPath:
    """One scanning path with the tool and cutting conditions of the paper.

    Args:
        part: STL file, or the slices of an earlier path on the same part.
    """
    common = {
        "strategy": "scan",
        "tool": "ball 8",
        "pitch_mm": fine.pitch,
        "direction": "y",
        "zigzag": False,
        "feed_mm_min": 200.0,
        "plunge_mm_min": 100.0,
        "spindle_rpm": 3600.0,
    }
    return twin.plan_paths(part, **common, **values)


def command(*words: object) -> int:
    """Run a command of twin; returns its exit code."""
    return subprocess.run([sys.executable, "-m", "twin", *map(str, words)], check=False).returncode


def heading(text: str) -> None:
    print(f"\n=== {text}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
