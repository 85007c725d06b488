"""Drop-cutter and level contours on the example's mold, against opencamlib where it is installed: prints JSON.

    python -m benchmarks.drop_cutter [--triangles 99000 195000 460000] [--tool "ball 8"] [--points 2000] [--waterline]

Both drop the same tool on the same points of the same mesh on one thread, in CPU time; opencamlib with bucket size 10,
its best. Preparing (its tree, our lists) is timed separately. The number of points of a finishing is dropped by
ours alone, on all cores and in wall time, with the preparation shared out.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import time
from typing import Any

import numpy as np

from benchmarks.mold import mold
from benchmarks.report import report
from twin.arrays import FloatArray
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import surface_of
from twin.geometry.mesh.slicing import mesh_sections
from twin.tools.shape import ToolShape
from twin.tools.text import parse_tool
from twin.workpiece.solids.from_mesh import Solid

FLOOR_MM = -40.0
BUCKET = 10
NOTE = "opencamlib is not installed"
LEVELS_MM = np.arange(-24.0, -0.5, 1.0) + 0.013


def scan_points(count: int) -> FloatArray:
    """About this many points on scan lines over the mold, four times as dense along them as across."""
    step = np.sqrt(100.0 * 80.0 / count)
    x, y = np.arange(0.5 * step, 100.0, 0.5 * step), np.arange(0.5 * step, 80.0, 2.0 * step)
    return np.array([(a, b) for b in y for a in x])


def ours(
    triangles: FloatArray, tool: ToolShape, points: FloatArray, threads: int | None
) -> tuple[FloatArray, float, float]:
    """Heights, seconds to prepare and seconds to drop."""
    clock = time.process_time if threads == 1 else time.perf_counter
    begin = clock()
    cutter = DropCutter(surface_of(triangles, threads=threads), tool, floor_mm=FLOOR_MM, threads=threads)
    ready = clock()
    heights = cutter.drop(points)
    return heights, ready - begin, clock() - ready


def ocl_surface(ocl: Any, triangles: FloatArray) -> Any:
    surface = ocl.STLSurf()
    for t in triangles.tolist():
        surface.addTriangle(ocl.Triangle(*(ocl.Point(*p) for p in t)))
    return surface


def ocl_tool(ocl: Any, tool: ToolShape) -> Any:
    diameter = 2.0 * tool.nominal_radius_mm
    if tool.corner_radius_mm == 0.0:
        return ocl.CylCutter(diameter, 100.0)
    if tool.disc_mm == 0.0:
        return ocl.BallCutter(diameter, 100.0)
    return ocl.BullCutter(diameter, tool.corner_radius_mm, 100.0)


def theirs(ocl: Any, triangles: FloatArray, tool: ToolShape, points: FloatArray) -> tuple[FloatArray, float, float]:
    """The same from opencamlib's BatchDropCutter on one thread."""
    surface = ocl_surface(ocl, triangles)
    begin = time.process_time()
    batch = ocl.BatchDropCutter()
    batch.setSTL(surface)
    cutter = ocl_tool(ocl, tool)
    batch.setCutter(cutter)
    batch.setThreads(1)
    batch.setBucketSize(BUCKET)
    for x, y in points.tolist():
        batch.appendPoint(ocl.CLPoint(x, y, FLOOR_MM))
    ready = time.process_time()
    batch.run()
    done = time.process_time()
    return np.array([p.z for p in batch.getCLPoints()]), ready - begin, done - ready


def waterline_s(ocl: Any, triangles: FloatArray, tool: ToolShape) -> float:
    """Seconds opencamlib takes for one level's contours of the tool."""
    surface, cutter = ocl_surface(ocl, triangles), ocl_tool(ocl, tool)
    begin = time.process_time()
    waterline = ocl.Waterline()
    waterline.setSTL(surface)
    waterline.setCutter(cutter)
    waterline.setZ(float(LEVELS_MM[len(LEVELS_MM) // 2]))
    waterline.setSampling(0.2)
    waterline.setThreads(1)
    waterline.run()
    return time.process_time() - begin


def level_ms(solid: Solid) -> float:
    """Milliseconds a level to cut the mesh into contours."""
    begin = time.process_time()
    mesh_sections(solid.vertices_mm, solid.triangles, solid.edges, (2, 0, 1), LEVELS_MM)
    return (time.process_time() - begin) * 1000.0 / len(LEVELS_MM)


def figures(count: int, options: argparse.Namespace, ocl: Any) -> dict[str, object]:
    """All figures of one mesh."""
    solid, tool = mold(count), parse_tool(options.tool)
    triangles = solid.vertices_mm[solid.triangles]
    few, many = scan_points(options.points), scan_points(options.many)
    own, prepared, one = ours(triangles, tool, few, 1)
    _, ready, dropped = ours(triangles, tool, many, None)
    found: dict[str, object] = {
        "triangles": len(triangles),
        "points": len(few),
        "us_a_point": round(one / len(few) * 1e6, 3),
        "prepare_s": round(prepared, 3),
        "finishing_points": len(many),
        "finishing_us_a_point_all_cores": round(dropped / len(many) * 1e6, 3),
        "finishing_us_a_point_with_preparing": round((dropped + ready) / len(many) * 1e6, 3),
        "contours_ms_a_level": round(level_ms(solid), 2),
    }
    if ocl is None:
        return found | {"opencamlib": NOTE}
    other, other_prepared, other_one = theirs(ocl, triangles, tool, few)
    off = np.abs(own - other)
    found |= {
        "opencamlib_us_a_point": round(other_one / len(few) * 1e6, 1),
        "opencamlib_prepare_s": round(other_prepared, 3),
        "times_faster": round(other_one / one, 1),
        "times_faster_finishing_with_preparing": round(other_one / len(few) * len(many) / (dropped + ready), 1),
        "points_within_1e-6_mm": int((off <= 1e-6).sum()),
        "largest_difference_mm": float(f"{off.max():.2g}"),
    }
    if options.waterline:
        found["opencamlib_waterline_s_a_level"] = round(waterline_s(ocl, triangles, tool), 1)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--triangles", type=int, nargs="+", default=[99_000, 195_000, 460_000])
    parser.add_argument("--tool", default="ball 8")
    parser.add_argument("--points", type=int, default=2_000, help="points for both")
    parser.add_argument("--many", type=int, default=400_000, help="points of a finishing, for us alone")
    parser.add_argument("--waterline", action="store_true", help="opencamlib's contours of one level too")
    options = parser.parse_args()
    ocl = importlib.import_module("opencamlib") if importlib.util.find_spec("opencamlib") else None
    ours(mold(2_000).vertices_mm[mold(2_000).triangles], parse_tool(options.tool), scan_points(100), 1)
    level_ms(mold(2_000))
    report("drop_cutter", tool=options.tool, meshes=[figures(n, options, ocl) for n in options.triangles])


if __name__ == "__main__":
    main()
