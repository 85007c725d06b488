"""Whole scanning paths of the torus part: slice, rough, finish, write; finishing paths against the drop-cutter.

    python -m benchmarks.paths [--pitches 0.25,0.125,0.05]

Conditions are those of the tri-slice paper's Table 1. Finishing paths are measured as they are written, thinned: from
slices with and without arcs, and exact; at places 0.02 mm apart, vertically from the exact drop-cutter's height on the
same triangles.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.report import report
from twin.arrays import FloatArray
from twin.cam.path.to_nc import NcOptions, Operation, write_nc
from twin.cam.path.toolpath import MoveKind, ToolPath
from twin.cam.slices.sections import SlicedPart, slice_part
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import surface_of_mesh
from twin.planning.paths import plan, prepare
from twin.planning.settings import PathSettings
from twin.settings.check import checked
from twin.tools.text import parse_tool

COMMON = {"strategy": "scan", "tool": "ball 8", "direction": "y", "zigzag": False}
ROUGH = {"stepover_mm": 2.0, "allowance_mm": 0.1, "layers": 5, "axial_depth_mm": 2.0}
FINISH = {"stepover_mm": 0.25}
APART_MM = 0.02


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--pitches", default="0.25,0.125,0.05", help="slice pitches, mm")
    arguments = parser.parse_args()
    sys.path.insert(0, str(Path(__file__).parents[1] / "examples" / "torus"))
    import make_torus

    with tempfile.TemporaryDirectory() as folder:
        stl = Path(folder) / "torus.stl"
        make_torus.write_stl(stl, make_torus.torus())
        mesh = slice_part(stl, 5.0).mesh
        cutter = DropCutter(surface_of_mesh(mesh.vertices_mm, mesh.triangles), parse_tool("ball 8"), floor_mm=-10.0)
        at_pitch(1.0, stl, cutter)  # kernels are loaded
        figures = {pitch: at_pitch(float(pitch), stl, cutter) for pitch in arguments.pitches.split(",")}
    report("paths", pitches=figures)


def at_pitch(pitch: float, stl: Path, cutter: DropCutter) -> dict[str, object]:
    """Seconds of each stage, lines of the program, errors of the finishing path."""
    wall, cpu = [time.perf_counter()], [time.process_time()]

    def done() -> None:
        wall.append(time.perf_counter())
        cpu.append(time.process_time())

    part = slice_part(stl, pitch)
    done()
    rough = planned(part, pitch, ROUGH)
    done()
    finish = planned(part, pitch, FINISH)
    done()
    exact = planned(part, pitch, FINISH | {"exact": True})
    done()
    lines = write_nc(
        stl.with_suffix(".nc"), [Operation(path=p, spindle_rpm=3600.0) for p in (rough, finish)], NcOptions()
    )
    done()
    stages = ("slice", "rough", "finish", "exact_finish", "write")
    return {
        "wall_s": dict(zip(stages, np.diff(wall).round(3).tolist(), strict=True)),
        "cpu_s": dict(zip(stages, np.diff(cpu).round(3).tolist(), strict=True)),
        "lines": lines,
        "straight": errors(finish, cutter),
        "exact": errors(exact, cutter),
        "arcs_1_um": errors(planned(part, pitch, FINISH | {"arcs_mm": 0.001}), cutter),
    }


def planned(part: SlicedPart, pitch: float, values: dict[str, object]) -> ToolPath:
    """One path."""
    settings = checked(PathSettings, {**COMMON, **values, "pitch_mm": pitch}, "benchmark")
    return plan(settings, prepare(settings, part))


def errors(path: ToolPath, cutter: DropCutter) -> dict[str, float]:
    """The paper's columns: largest error, um, and shares within 1, 2 and 5 um, %."""
    points = np.concatenate([along(move.chords_mm(1e-5)) for move in path.of_kind(MoveKind.CUT)])
    error = np.abs(points[:, 2] - cutter.drop(points[:, :2])) * 1000.0
    shares = {f"within_{k}_um": round(100.0 * float((error <= k).mean()), 3) for k in (1, 2, 5)}
    return {"points": path.points, "largest_um": round(float(error.max()), 2), **shares}


def along(line: FloatArray) -> FloatArray:
    """Evenly spaced places on a polyline."""
    ways = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))))
    at = np.arange(0.5 * APART_MM, ways[-1], APART_MM)
    return np.column_stack([np.interp(at, ways, line[:, k]) for k in range(3)])


if __name__ == "__main__":
    main()
