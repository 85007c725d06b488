"""Cost of turns close to each other, next to a straight cut: prints one JSON object.

    python -m benchmarks.retraced [--turns 5] [--down 0.1] [--forces] [--only helix]

Ball of 8 mm, flat tool of 10 mm and bull-nose tool of 6 mm on a radius of 4 mm, slices and steps at 0.1 mm, without
forces unless they are asked for: a helix of arcs that goes down every turn, full circles at one height, and a spiral of
blocks of 0.04 mm that grows by 0.063 mm a turn. The straight cut is as long as the helix and 1 mm deep. CPU time of one
thread; edges are those of the cells that hold any.
"""

from __future__ import annotations

import argparse
import math
import tempfile
import time
from pathlib import Path
from typing import Any

from benchmarks.report import report
from twin.job import job_from_dict
from twin.simulation.replay import Replay
from twin.workpiece.trislice import CellSlices

RADIUS_MM, BLOCKS, GROWTH_MM = 4.0, 628, 1e-4
TOOLS: dict[str, dict[str, Any]] = {
    "ball 8": {"kind": "ball", "diameter_mm": 8.0},
    "flat 10": {"kind": "flat", "diameter_mm": 10.0},
    "bull 6": {"kind": "bull", "diameter_mm": 6.0, "corner_radius_mm": 1.0},
}
CUTTING = {"Ktc": 900.0, "Kte": 2.0, "Krc": 400.0, "Kre": 2.0, "Kac": 0.0, "Kae": 0.0, "source": "of no material"}


def programs(turns: int, down_mm: float) -> dict[str, tuple[str, float]]:
    """Motions of each case, and the length of its path, mm."""
    length = 2.0 * math.pi * RADIUS_MM * turns
    arcs = "".join(f"G3 X34 Y15 I-4 J0 Z{-down_mm * (i + 1):.4f}\n" for i in range(turns))
    points = [(RADIUS_MM + i * GROWTH_MM, i * 0.01) for i in range(BLOCKS * turns)]
    blocks = "".join(f"X{30.0 + r * math.cos(a):.3f} Y{15.0 + r * math.sin(a):.3f}\n" for r, a in points)
    spiral = 0.01 * sum(r for r, _ in points)
    return {
        "straight": (f"G0 X-6 Y15\nG43 H1 Z5\nZ-1\nG1 X{length - 6.0:.3f} F1000\n", length),
        "helix": (f"G0 X34 Y15\nG43 H1 Z5\nG1 Z0 F1000\n{arcs}", length),
        "circles": ("G0 X34 Y15\nG43 H1 Z5\nG1 Z-1 F1000\n" + "G3 X34 Y15 I-4 J0\n" * turns, length),
        "spiral": (f"G0 X34 Y15\nG43 H1 Z5\nG1 Z-1 F1000\n{blocks}", spiral),
    }


def cost(
    folder: Path, body: str, tool: dict[str, Any], path_mm: float, width_mm: float, *, forces: bool
) -> dict[str, float]:
    """CPU time for a mm of path, and edges in the cells left."""
    program = folder / "cut.nc"
    program.write_text(f"G21 G90 G94\nT1 M6\nS3600 M3\n{body}M30\n")
    shape = {**tool, "teeth": 2, "helix_deg": 30.0, "flute_length_mm": 20.0}
    data: dict[str, Any] = {
        "program": {"file": str(program)},
        "stock": {"box_mm": {"min": [0, 0, -20], "max": [width_mm, 30, 0]}},
        "tools": [{"number": 1, **shape, "length_mm": 80.0}],
        "simulation": {"slice_pitch_mm": 0.1, "step_mm": 0.1, "angle_step_deg": 1.0, "axial_step_mm": 0.1},
    }
    if forces:
        data["cutting"] = CUTTING
    begin = time.process_time()
    with Replay(job_from_dict(data, folder), threads=1, preview=False) as run:
        for _ in run:
            pass
        spent, workpiece = time.process_time() - begin, run.workpiece
    assert isinstance(workpiece, CellSlices)
    mean, most = workpiece.edges_per_cell
    return {
        "s": round(spent, 2),
        "ms/mm": round(1000.0 * spent / path_mm, 3),
        "edges/cell": round(mean, 1),
        "most edges": most,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--down", type=float, default=0.1, help="depth of a turn of the helix, mm")
    parser.add_argument("--forces", action="store_true")
    parser.add_argument("--only", help="one of the cases")
    options = parser.parse_args()
    made: dict[str, dict[str, dict[str, float]]] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for title, tool in TOOLS.items():
            for body, path_mm in programs(1, options.down).values():  # loads the compiled code
                cost(folder, body, tool, path_mm, 60.0, forces=options.forces)
            made[title] = {
                case: cost(folder, body, tool, path_mm, 60.0 if case != "straight" else path_mm, forces=options.forces)
                for case, (body, path_mm) in programs(options.turns, options.down).items()
                if options.only in (None, case)
            }
    report("retraced", turns=options.turns, down_mm=options.down, forces=options.forces, tools=made)


if __name__ == "__main__":
    main()
