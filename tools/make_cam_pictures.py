"""Pictures of docs/drop-cutter.md and docs/dexel.md, on the example's mold.

python tools/make_cam_pictures.py
"""

from __future__ import annotations

import importlib.util
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib import pyplot
from matplotlib.colors import LightSource, ListedColormap

from twin.arrays import FloatArray
from twin.cam.stock.dexel import Dexels
from twin.cam.stock.rest import RestMaterial, allowed_heights
from twin.cam.stock.strokes import Strokes
from twin.cam.surface.drop_cutter import DropCutter
from twin.cam.surface.surface import Surface, surface_of
from twin.tools.text import parse_tool

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
EXTENT = (0.0, 100.0, 0.0, 80.0)
ROUGHING, FLAT_STEP_MM, LEVELS_MM = "flat 10", 5.0, np.arange(-2.0, -26.0, -2.0)


def mold() -> Surface:
    """The example's mold with 195,000 triangles."""
    spec = importlib.util.spec_from_file_location("make_mold", ROOT / "examples" / "mold" / "make_mold.py")
    assert spec is not None
    assert spec.loader is not None
    maker = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(maker)
    return surface_of(maker.mold_triangles(195_000))


def shaded(heights: FloatArray, pitch: float) -> FloatArray:
    """Heights as a picture, light from the upper left."""
    light = LightSource(315, 40)
    image: FloatArray = light.shade(heights.T, pyplot.get_cmap("viridis"), blend_mode="soft", dx=pitch, dy=pitch)
    return image


def drop_cutter_picture(part: Surface) -> None:
    """Heights of a ball's tip over the mold, and what it touches."""
    grid = Dexels((0.0, 0.0), (100.0, 80.0), 0.1, 0.0)
    found = DropCutter(part, "ball 8").contacts(grid.points_mm)
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(15, 6.2), layout="constrained")
    left.imshow(shaded(found.z_mm.reshape(grid.heights_mm.shape), 0.1), origin="lower", extent=EXTENT)
    left.set_title("Tip of a ball D8 over the mold")
    kinds = ListedColormap(["#d9d9d9", "#3182bd", "#e6550d", "#ffffff"])
    kind = found.kind.reshape(grid.heights_mm.shape).T
    right.imshow(kind, origin="lower", extent=EXTENT, cmap=kinds, vmin=-0.5, vmax=3.5, interpolation="nearest")
    right.set_title("It touches a face (grey), an edge (blue) or a vertex (orange)")
    figure.savefig(PICTURES / "drop_cutter.png", dpi=80)


def roughed(part: Surface) -> Dexels:
    """Stock after level rows of a flat tool, 2 mm apart in depth, wherever it does not gouge."""
    stock = Dexels((0.0, 0.0), (100.0, 80.0), 0.1, 0.0, -35.0)
    tool = parse_tool(ROUGHING)
    tips = allowed_heights(part, tool, stock.points_mm, 0.3).reshape(stock.heights_mm.shape)
    for z in LEVELS_MM:
        for column in range(0, tips.shape[1], round(FLAT_STEP_MM / 0.1)):
            free = np.flatnonzero(tips[:, column] <= z)
            for run in np.split(free, np.flatnonzero(np.diff(free) > 1) + 1):
                if len(run):
                    ends = [(stock.x_mm[i], stock.y_mm[column], z) for i in (run[0], run[-1])]
                    stock.cut(tool, Strokes.through(ends), threads=1)
    return stock


def rest_picture(part: Surface) -> None:
    """Material left by roughing, and the positions of a ball at one level."""
    stock = roughed(part)
    level = RestMaterial(stock, part, parse_tool("ball 6"), allowance_mm=0.1).level(-12.5)
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(15, 6.2), layout="constrained")
    left.imshow(shaded(stock.heights_mm, 0.1), origin="lower", extent=EXTENT)
    left.set_title("Dexels after rows of a flat tool D10, 2 mm deep each")
    regions = np.where(level.regions > 0, level.regions, np.nan).T
    right.imshow(regions, origin="lower", extent=EXTENT, cmap="Pastel1", interpolation="nearest")
    right.plot(*level.points_mm[:, :2].T, "k.", markersize=3)
    right.set_title("A ball D6 at z = -12.5: where it cuts and does not gouge; thinned points")
    figure.savefig(PICTURES / "rest_material.png", dpi=80)


def main() -> None:
    """Both pictures."""
    matplotlib.use("Agg")
    part = mold()
    drop_cutter_picture(part)
    rest_picture(part)


if __name__ == "__main__":
    main()
