"""Picture of the material that tools cannot reach: a plan view, and a section through its thickest point."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline

from twin.archive.container.partial import replacing
from twin.cam.slices.sections import cut_sections
from twin.geometry.polygons.shapes import Shape, cut_along, outline_rings, united
from twin.workpiece.store import PLANE_AXES

if TYPE_CHECKING:
    from twin.arrays import FloatArray
    from twin.cam.reach.tool_reach import Reach
    from twin.cam.reach.uncut_regions import UncutRegion
    from twin.cam.slices.sections import SlicedPart
    from twin.geometry.polygons.region import Region

_AXES = "XYZ"
_COLORS = ("#e24228", "#e0901c", "#2f74d0", "#2f9e55", "#9b4fc0")
#: Contour lines of the part in the view from above.
_LINES = 12


def write_plot(path: Path, sliced: SlicedPart, reaches: Mapping[str, Reach]) -> None:
    """Draw a picture and write it completely or not at all; its suffix determines the format."""
    figure = Figure(figsize=(12.0, 5.6), layout="constrained", dpi=110)
    left, right = figure.subplots(1, 2)
    _draw_above(left, sliced, reaches)
    _draw_cut(right, sliced, reaches)
    with replacing(path) as partial:
        figure.savefig(partial)


def _draw_above(axes: Axes, sliced: SlicedPart, reaches: Mapping[str, Reach]) -> None:
    planes = sliced.slices.regions[2]
    axes.plot([], [], color="0.65", linewidth=0.8, label="outlines of the part at several heights")
    for k in np.unique(np.linspace(0, len(planes) - 1, _LINES).astype(int)):
        lines = [np.concatenate((ring, ring[:1])) for ring in planes[k].rings]
        axes.add_collection(LineCollection(lines, colors="0.65", linewidths=0.6))
    for number, (text, reach) in enumerate(reaches.items()):
        color = _COLORS[number % len(_COLORS)]
        label = f"{text}: {reach.volume_mm3:.4g} mm³, {reach.thickness_mm:.3f} mm"
        axes.plot([], [], color=color, linewidth=5.0, label=label if reach.uncut_regions else f"{text}: none")
        for region in reach.uncut_regions:
            if region.axis == 2:
                _fill(axes, united(region.pieces), color)
    low, high = sliced.slices.low_mm, sliced.slices.high_mm
    _frame(axes, low[:2], high[:2], "X, mm", "Y, mm")
    axes.set_title("Uncut material, plan view")
    if reaches:
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), fontsize=8, frameon=False)


def _draw_cut(axes: Axes, sliced: SlicedPart, reaches: Mapping[str, Reach]) -> None:
    regions = [r for reach in reaches.values() for r in reach.uncut_regions]
    if not regions:
        axes.set_axis_off()
        axes.text(0.5, 0.5, "No uncut material.", ha="center", va="center", transform=axes.transAxes)
        return
    deepest = max(regions, key=lambda r: r.thickness_mm)
    aside = np.abs(deepest.deepest_mm - deepest.centroid_mm)[:2]
    axis = int(np.argmin(aside))
    u, v = PLANE_AXES[axis]
    plane = float(deepest.deepest_mm[axis])
    _fill_region(axes, cut_sections(sliced.mesh, axis, np.array([plane])).regions[0])
    for number, reach in enumerate(reaches.values()):
        color = _COLORS[number % len(_COLORS)]
        boxes = [b for region in reach.uncut_regions for b in _cut_boxes(region, axis, plane)]
        axes.add_collection(PolyCollection(boxes, facecolors=color, edgecolors="none", alpha=0.85))
    axes.plot([], [], color="0.8", linewidth=5.0, label="part")
    for number, (text, reach) in enumerate(reaches.items()):
        if reach.uncut_regions:
            axes.plot([], [], color=_COLORS[number % len(_COLORS)], linewidth=5.0, label=f"uncut by {text}")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=3, fontsize=8, frameon=False)
    reach_mm = max(8.0 * deepest.thickness_mm, 0.75 * float(np.ptp([deepest.low_mm[2], deepest.high_mm[2]])))
    middle = deepest.deepest_mm[[u, v]]
    _frame(axes, middle - reach_mm, middle + reach_mm, f"{_AXES[u]}, mm", "Z, mm")
    axes.set_title(f"Section at {_AXES[axis]} {plane:.2f}, through the thickest point ({deepest.thickness_mm:.3f} mm)")


def _cut_boxes(region: UncutRegion, axis: int, plane: float) -> list[FloatArray]:
    """Rectangles in which a plane across x or y cuts a region's slices."""
    if region.axis != 2:
        return []
    boxes = []
    for piece, (z0, z1) in zip(region.pieces, region.slabs_mm, strict=True):
        boxes += [np.array([(a, z0), (b, z0), (b, z1), (a, z1)]) for a, b in cut_along(piece, axis, plane)]
    return boxes


def _fill(axes: Axes, shape: Shape, color: str) -> None:
    rings = [Outline(ring, closed=True) for ring in outline_rings(shape)]
    if rings:
        patch = PathPatch(Outline.make_compound_path(*rings), facecolor=color, edgecolor="none", alpha=0.85)
        axes.add_patch(patch)


def _fill_region(axes: Axes, region: Region) -> None:
    rings = [Outline(np.concatenate((r, r[:1])), closed=True) for r in region.rings]
    if rings:
        axes.add_patch(PathPatch(Outline.make_compound_path(*rings), facecolor="0.8", edgecolor="0.35", linewidth=0.8))


def _frame(axes: Axes, low: FloatArray, high: FloatArray, across: str, up: str) -> None:
    axes.set_aspect("equal")
    margin = 0.03 * float(np.max(high - low))
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_xlabel(across)
    axes.set_ylabel(up)
