"""Slices, offsets and CL lines of the torus part next to other methods for the same: prints one JSON object.

    python -m benchmarks.offset [--pitches 0.25,0.125,0.05] [--quick]

The part of examples/torus (164,878 triangles, 60 x 60 mm), an R4 ball. Paths are those of the tri-slice paper's Table
1: roughing in rows 2 mm apart, 5 layers of 2 mm, 0.10 mm left; finishing in rows 0.25 mm apart. Errors are those of the
finishing path's points against the exact drop-cutter on the same triangles. The others: trimesh's sections,
opencamlib's drop-cutter (on some of the points), and a height map dilated by the ball, with heights of slices at the
same positions and no larger error.
"""

from __future__ import annotations

import argparse
import importlib.util
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from benchmarks.report import report
from twin.cam.reach.tool_reach import tool_reach
from twin.cam.slices.cl_lines import Profiles, cl_heights, cl_lines
from twin.cam.slices.offset import inflate
from twin.cam.slices.polylines import Samples
from twin.cam.slices.sections import slice_part
from twin.cam.slices.structuring_element import StructuringElement
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import Surface, surface_of_mesh
from twin.tools.text import parse_tool
from twin.workpiece.solids.from_mesh import Solid, load_mesh, mesh_slices

TOOL = "ball 8"
RADIUS_MM = 4.0
HALF_MM = 30.0
#: Distance of the samples along a row, before it is refined.
PLACES_MM = 0.05
FLOOR_MM = -10.0
ROWS_MM = np.linspace(-HALF_MM, HALF_MM, 241)
#: Grids of height maps, and pitches of slices that make no larger error at the same places.
EQUAL_ERROR = {0.25: 0.2, 0.125: 0.125, 0.05: 0.05}
#: Points that opencamlib computes.
ASKED = 400


class Cost(NamedTuple):
    """Seconds on the clock, and of all threads together: what the clock would show on one core with nothing else."""

    wall_s: float
    cpu_s: float

    def __add__(self, other: object) -> Cost:
        assert isinstance(other, Cost)
        return Cost(self.wall_s + other.wall_s, self.cpu_s + other.cpu_s)

    def rounded(self) -> dict[str, float]:
        """As it is printed."""
        return {"wall_s": round(self.wall_s, 3), "cpu_s": round(self.cpu_s, 3)}


def timed(work: Callable[[], Any], repeats: int = 3) -> tuple[Cost, Any]:
    """The least of some runs, and the last result."""
    costs = []
    for _ in range(repeats):
        begin, cpu = time.perf_counter(), time.process_time()
        made = work()
        costs.append(Cost(time.perf_counter() - begin, time.process_time() - cpu))
    return Cost(min(c.wall_s for c in costs), min(c.cpu_s for c in costs)), made


def write_torus(path: Path) -> None:
    """The example's part as an STL file."""
    source = Path(__file__).parents[1] / "examples" / "torus" / "make_torus.py"
    spec = importlib.util.spec_from_file_location("make_torus", source)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["make_torus"] = module
    spec.loader.exec_module(module)
    module.write_stl(path, module.torus())


def paths(profiles: Profiles, repeats: int) -> tuple[list[np.ndarray], Cost, Cost]:
    """The finishing path, and costs of roughing and finishing."""
    tool = StructuringElement.tool(parse_tool(TOOL))
    places = Samples.between(-HALF_MM, HALF_MM, PLACES_MM)
    rough = np.linspace(-HALF_MM, HALF_MM, 31)

    def layers() -> None:
        for k in range(5):
            cl_lines(profiles, tool, rough, places, FLOOR_MM, allowance_mm=0.1 + 2.0 * k, chord_mm=0.01)

    roughing, _ = timed(layers, repeats)
    finishing, lines = timed(lambda: cl_lines(profiles, tool, ROWS_MM, places, FLOOR_MM), repeats)
    return lines, roughing, finishing


def errors(points: np.ndarray, heights: np.ndarray, surface: Surface) -> dict[str, float]:
    """The paper's columns: largest error, and percent of points within 1, 2, 5 um."""
    off = 1000.0 * np.abs(heights - DropCutter(surface, TOOL, floor_mm=FLOOR_MM).drop(points))
    return {"max_um": round(float(off.max()), 2)} | {
        f"within_{t}_um_percent": round(100.0 * float(np.mean(off <= t)), 3) for t in (1, 2, 5)
    }


def at_pitch(stl: Path, pitch: float) -> dict[str, Any]:
    """Everything that depends on the pitch."""
    repeats = 1 if pitch < 0.02 else 3
    load, mesh = timed(lambda: load_mesh(stl), repeats)
    slices, _ = timed(lambda: mesh_slices(mesh, pitch), repeats)
    part = slice_part(mesh, pitch)
    prepared, profiles = timed(lambda: Profiles.of(part.sections(1)), repeats)
    lines, roughing, finishing = paths(profiles, repeats)
    costs = {
        "load": load,
        "slices_3_directions": slices,
        "profiles": prepared,
        "roughing": roughing,
        "finishing": finishing,
        "total": load + slices + prepared + roughing + finishing,
    }
    points = np.concatenate(
        [np.column_stack((u[:, 0], np.full(len(u), y))) for u, y in zip(lines, ROWS_MM, strict=True)]
    )
    heights = np.concatenate([line[:, 1] for line in lines])
    return {name: cost.rounded() for name, cost in costs.items()} | errors(points, heights, surface_of(mesh))


def surface_of(mesh: Solid) -> Surface:
    """The mesh as the drop-cutter takes it."""
    return surface_of_mesh(mesh.vertices_mm, mesh.triangles)


def trimesh_sections(mesh: Solid, pitch: float) -> dict[str, float]:
    """Cost of trimesh's sections in three directions, closed to polygons."""
    import trimesh

    made = trimesh.Trimesh(mesh.vertices_mm, mesh.triangles, process=False)

    def work() -> None:
        for axis in range(3):
            low, high = made.bounds[:, axis]
            heights = np.arange(low + 0.5 * pitch, high, pitch)
            for section in made.section_multiplane(np.zeros(3), np.eye(3)[axis], heights):
                if section is not None:
                    _ = section.polygons_closed

    return timed(work, 1)[0].rounded()


def opencamlib_ms(mesh: Solid) -> float | None:
    """Milliseconds a point of opencamlib's drop-cutter; None where it is not installed."""
    try:
        from opencamlib import ocl
    except ImportError:
        return None
    surface = ocl.STLSurf()
    for a, b, c in mesh.vertices_mm[mesh.triangles].tolist():
        surface.addTriangle(ocl.Triangle(ocl.Point(*a), ocl.Point(*b), ocl.Point(*c)))
    ball, cutter = ocl.BallCutter(2.0 * RADIUS_MM, 50.0), ocl.BatchDropCutter()  # it does not keep what it is given
    cutter.setSTL(surface)
    cutter.setCutter(ball)
    cutter.setThreads(1)
    cutter.setBucketSize(10)
    for x, y in np.random.default_rng(1).uniform(-HALF_MM, HALF_MM, (ASKED, 2)).tolist():
        cutter.appendPoint(ocl.CLPoint(x, y, -100.0))
    return 1000.0 * timed(cutter.run, 1)[0].cpu_s / ASKED


@njit(nogil=True)
def dilated_row(top, row, reach, lift, out):  # type: ignore[no-untyped-def]
    """Highest of all shifted heights plus the ball's over one row of a height map."""
    n = top.shape[1]
    out[:] = -1e9
    for j in range(-reach, reach + 1):
        if not 0 <= row + j < top.shape[0]:
            continue
        for i in range(-reach, reach + 1):
            up = lift[j + reach, i + reach]
            if up < -1e8:
                continue
            first, last = max(0, -i), min(n, n - i)
            for k in range(first, last):
                h = top[row + j, k + i] + up
                out[k] = h if h > out[k] else out[k]


def height_map(surface: Surface, grid: float) -> dict[str, Any]:
    """A plain height map dilated by the ball, at the finishing path's rows: its making, the dilation, errors."""
    nodes = np.arange(-HALF_MM, HALF_MM + 0.5 * grid, grid)
    x, y = np.meshgrid(nodes, nodes)
    points = np.column_stack((x.ravel(), y.ravel()))
    prepared, top = timed(lambda: DropCutter(surface, None, floor_mm=FLOOR_MM).drop(points).reshape(x.shape))
    reach = int(RADIUS_MM / grid)
    shift = grid * np.arange(-reach, reach + 1)
    rest = RADIUS_MM**2 - shift[:, None] ** 2 - shift[None, :] ** 2
    lift = np.where(rest >= 0.0, np.sqrt(np.maximum(rest, 0.0)) - RADIUS_MM, -1e9)
    rows = np.arange(0, len(nodes), max(1, round(0.25 / grid)))
    out = np.empty((len(rows), len(nodes)))

    def work() -> None:
        with ThreadPoolExecutor() as pool:
            list(pool.map(lambda k: dilated_row(top, rows[k], reach, lift, out[k]), range(len(rows))))

    work()
    cost, _ = timed(work)
    places = np.column_stack((np.tile(nodes, len(rows)), np.repeat(nodes[rows], len(nodes))))
    return {"prepared": prepared.rounded(), "dilated": cost.rounded()} | errors(places, out.ravel(), surface)


def heights_of_slices(mesh: Solid, pitch: float, grid: float) -> dict[str, Any]:
    """Heights at the same places from slices: slicing, heights, errors."""
    places = Samples.between(-HALF_MM, HALF_MM, grid)
    tool = StructuringElement.tool(parse_tool(TOOL))
    prepared, profiles = timed(lambda: Profiles.of(slice_part(mesh, pitch).sections(1)))
    cost, heights = timed(lambda: cl_heights(profiles, tool, ROWS_MM, places))
    points = np.column_stack((np.tile(places.at_mm, len(ROWS_MM)), np.repeat(ROWS_MM, places.count)))
    return {
        "pitch_mm": pitch,
        "prepared": prepared.rounded(),
        "heights": cost.rounded(),
        **errors(points, np.maximum(heights.ravel(), FLOOR_MM), surface_of(mesh)),
    }


def drop_cutter(surface: Surface) -> dict[str, Any]:
    """The exact drop-cutter at the finishing path's evenly spaced points."""
    along = np.arange(-HALF_MM, HALF_MM + 0.5 * PLACES_MM, PLACES_MM)
    x, y = np.meshgrid(along, ROWS_MM)
    points = np.column_stack((x.ravel(), y.ravel()))
    build, cutter = timed(lambda: DropCutter(surface, TOOL, floor_mm=FLOOR_MM))
    drop, _ = timed(lambda: cutter.drop(points))
    return {"build": build.rounded(), "drop": drop.rounded(), "points": len(points)}


def polygons(stl: Path) -> dict[str, Any]:
    """General polygons: an offset in three directions, and what the ball cannot reach."""
    ball = StructuringElement.ball(RADIUS_MM)
    coarse, fine = slice_part(stl, 0.5), slice_part(stl, 0.1)
    inflated, _ = timed(lambda: inflate(coarse, ball), 1)
    reached, reach = timed(lambda: tool_reach(fine, ball), 1)
    return {
        "inflate_3_directions_0.5_mm": inflated.rounded(),
        "machinable_0.1_mm": reached.rounded(),
        "machinable_volume_mm3": round(reach.volume_mm3, 3),
        "machinable_thickness_mm": round(reach.thickness_mm, 4),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pitches", default="0.25,0.125,0.05,0.01")
    parser.add_argument("--quick", action="store_true", help="leave the other programs out")
    options = parser.parse_args()
    pitches = [float(p) for p in options.pitches.split(",")]
    with tempfile.TemporaryDirectory() as folder:
        stl = Path(folder) / "torus.stl"
        write_torus(stl)
        at_pitch(stl, 1.0)
        figures: dict[str, Any] = {"pitches_mm": {str(p): at_pitch(stl, p) for p in pitches}}
        mesh = load_mesh(stl)
        surface = surface_of(mesh)
        figures["drop_cutter"] = drop_cutter(surface)
        figures["grids_mm"] = {
            str(grid): {"height_map": height_map(surface, grid), "slices": heights_of_slices(mesh, pitch, grid)}
            for grid, pitch in EQUAL_ERROR.items()
        }
        if not options.quick:
            figures["trimesh_sections"] = {str(p): trimesh_sections(mesh, p) for p in (0.25, 0.125)}
            figures["opencamlib_ms_a_point"] = opencamlib_ms(mesh)
            figures["polygons"] = polygons(stl)
    report("offset", triangles=len(mesh.triangles), **figures)


if __name__ == "__main__":
    main()
