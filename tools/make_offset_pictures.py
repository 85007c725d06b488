"""Pictures of docs/offsets.md, on the torus example's part.

python tools/make_offset_pictures.py
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib import pyplot
from matplotlib.axes import Axes

from twin.arrays import FloatArray
from twin.cam.reach.tool_reach import tool_reach
from twin.cam.slices.offset import inflate, inflate_individually
from twin.cam.slices.sections import SlicedPart, slice_part
from twin.cam.slices.structuring_element import StructuringElement
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import surface_of_mesh
from twin.cli.show.reach_plot import write_plot
from twin.geometry.polygons.region import Region
from twin.geometry.polygons.shapes import cut_along, to_shape
from twin.workpiece.solids.from_mesh import Solid, solid
from twin.workpiece.stock import SliceSet

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
RADIUS_MM, PITCH_MM, CUT_MM = 4.0, 0.5, 19.75


def torus() -> Solid:
    """The example's part."""
    spec = importlib.util.spec_from_file_location("make_torus", ROOT / "examples" / "torus" / "make_torus.py")
    assert spec is not None
    assert spec.loader is not None
    maker = importlib.util.module_from_spec(spec)
    sys.modules["make_torus"] = maker
    spec.loader.exec_module(maker)
    return solid(maker.torus(192, 64), "torus")


def draw(axes: Axes, part: SlicedPart, grown: SliceSet, title: str) -> None:
    """One plane across x: the part, its offset by slices across x, and where slices across z end on it."""
    k = int(np.argmin(np.abs(part.slices.positions_mm(0) - CUT_MM)))
    outlines(axes, part.slices.regions[0][k], "0.45", "part", 1.0, fill=True)
    k = int(np.argmin(np.abs(grown.positions_mm(0) - CUT_MM)))
    outlines(axes, grown.regions[0][k], "C0", "slices across x", 1.6)
    ends = [
        (end, z)
        for z, region in zip(grown.positions_mm(2), grown.regions[2], strict=True)
        if not region.empty
        for span in cut_along(to_shape(region), 0, grown.positions_mm(0)[k])
        for end in span
    ]
    axes.plot(*np.array(ends).T, ".", color="C3", markersize=3.5, label="slices across z")
    u = np.linspace(-34.0, 34.0, 1201)
    points = np.column_stack((np.full(len(u), grown.positions_mm(0)[k]), u))
    drop = DropCutter(surface_of_mesh(part.mesh.vertices_mm, part.mesh.triangles), "ball 8", floor_mm=-30.0)
    exact = drop.drop(points) + RADIUS_MM
    axes.plot(u[exact > -15.0], exact[exact > -15.0], color="k", linewidth=0.7, linestyle="--", label="exact")
    axes.set_title(title, fontsize=10)
    axes.set_aspect("equal")
    axes.set_ylabel("Z, mm")


def outlines(axes: Axes, region: Region, color: str, label: str, width: float, *, fill: bool = False) -> None:
    """A region's rings."""
    for number, ring in enumerate(region.rings):
        line: FloatArray = np.concatenate((ring, ring[:1]))
        if fill:
            axes.fill(*line.T, color="0.85")
        axes.plot(*line.T, color=color, linewidth=width, label=label if number == 0 else None)


def main() -> None:
    """Draw and write both."""
    matplotlib.use("Agg")
    mesh = torus()
    part = slice_part(mesh, PITCH_MM)
    figure, (top, bottom) = pyplot.subplots(2, 1, figsize=(9.0, 7.2), layout="constrained", sharex=True)
    draw(top, part, inflate_individually(part.slices, RADIUS_MM), "Every slice inflated alone: the direction matters")
    ball = StructuringElement.ball(RADIUS_MM)
    draw(bottom, part, inflate(part, ball, axes=(0, 2)), "With its neighbours (eq. 1): it does not")
    bottom.set_xlabel(f"Y, mm (cut at X {CUT_MM:g}; ball of {RADIUS_MM:g} mm, slices {PITCH_MM:g} mm apart)")
    top.legend(loc="lower center", ncols=4, fontsize=8)
    figure.savefig(PICTURES / "offset_directions.png", dpi=110)
    fine = slice_part(mesh, 0.1)
    write_plot(PICTURES / "torus_reach.png", fine, {"ball 8": tool_reach(fine, ball)})


if __name__ == "__main__":
    main()
