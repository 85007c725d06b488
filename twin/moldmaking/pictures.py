"""Pictures of a mold's stages: tool paths from above, and the rest material after each stage."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from twin.archive.container.partial import replacing
from twin.arrays import FloatArray
from twin.cam.path.toolpath import MoveKind, ToolPath
from twin.cam.surface.drop_cutter import DropCutter
from twin.moldmaking.stages import MoldPlan, Stage, StageResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = {"cut": "#3c78c8", "rapid": "#d03c30", "link": "#3a9d5a", "helix": "#e0902a", "ramp": "#e0902a"}
_OTHER = "#8a50b0"
_DPI = 120
#: A move that ends within this distance of a level belongs to it, mm.
_AT_MM = 1e-3
#: Chord error of arcs in pictures, mm.
_CHORD_MM = 0.02


def _lines_by_kind(path: ToolPath) -> dict[str, list[FloatArray]]:
    """A path as polylines, by kind of move."""
    lines: dict[str, list[FloatArray]] = {}
    for move in path.moves:
        lines.setdefault(str(move.kind), []).append(move.chords_mm(_CHORD_MM))
    return lines


def draw(plan: MoldPlan, stages: Sequence[Stage], folder: Path) -> list[Path]:
    """Draw one picture per stage: the path, one level of roughing or semi-finishing, and the rest material afterwards.

    Returns:
        The PNG files.
    """
    from matplotlib.figure import Figure

    needle = DropCutter(plan.surface, None)
    files: list[Path] = []
    for stage in stages:
        result = plan.stage(stage)
        level = None if stage == "finish" else _middle_level(result.path)
        count = 2 if level is None else 3
        figure = Figure(figsize=(6.5 * count, 5.6), layout="constrained")
        axes = figure.subplots(1, count)
        draw_path(axes[0], result.path)
        if level is not None:
            draw_path(axes[1], result.path, level - _AT_MM, level + _AT_MM)
            axes[1].set_title(f"its moves that end at Z = {level:.2f} mm")
        _draw_rest(figure, axes[-1], result, needle)
        minutes = result.time.total_s / 60.0
        axes[0].set_title(f"{stage}: {result.path.name}, {minutes:.1f} min\nplan view of the path", fontsize=10)
        file = folder / f"{plan.job.output.name}_{stage}.png"
        with replacing(file) as partial:
            figure.savefig(partial, dpi=_DPI)
        files.append(file)
    return files


def _middle_level(path: ToolPath) -> float:
    """Height of the median cutting move."""
    heights = sorted(float(m.end_mm[2]) for m in path.of_kind(MoveKind.CUT))
    return heights[len(heights) // 2]


def draw_path(axes: Axes, path: ToolPath, low_z_mm: float = -np.inf, high_z_mm: float = np.inf) -> None:
    """Draw a path from above, coloured by kind of move, and only between two heights where they are given."""
    from matplotlib.collections import LineCollection

    for kind, lines in _lines_by_kind(path).items():
        kept = [ln[:, :2] for ln in lines if low_z_mm <= ln[-1, 2] <= high_z_mm]
        if kept:
            colour = COLOURS.get(kind, _OTHER)
            axes.add_collection(LineCollection(kept, colors=colour, linewidths=0.35, label=kind))
    axes.autoscale()
    axes.set_aspect("equal")
    axes.set_xlabel("X, mm")
    axes.set_ylabel("Y, mm")
    _draw_legend(axes)


def _draw_legend(axes: Axes) -> None:
    """Names of all lines below the picture, their lines thick enough to see the colour."""
    legend = axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=6, fontsize=8, frameon=False)
    for line in legend.get_lines():
        line.set_linewidth(2.0)


def _draw_rest(figure: Any, axes: Axes, result: StageResult, needle: DropCutter) -> None:
    """Material above the part, on a scale that ends at the most there is; what is below the part would be a gouge."""
    from matplotlib.colors import PowerNorm

    stock = result.stock
    above = stock.heights_mm - needle.drop(stock.points_mm).reshape(stock.heights_mm.shape)
    most = max(float(above.max()), 1e-3)
    extent = (float(stock.low_mm[0]), float(stock.high_mm[0]), float(stock.low_mm[1]), float(stock.high_mm[1]))
    # a power below one shows thin layers next to the thickest, which is often one narrow corner
    scale = PowerNorm(0.5, vmin=0.0, vmax=most)
    image = axes.imshow(above.T, origin="lower", extent=extent, norm=scale, cmap="viridis")
    figure.colorbar(image, ax=axes, label="rest material, mm along Z")
    x, y = stock.points_mm[int(np.argmax(above))][:2]
    axes.plot(
        x,
        y,
        "o",
        markersize=9,
        markerfacecolor="none",
        markeredgecolor="#d03c30",
        mew=1.5,
        ls="none",
        label=f"most: {most:.3f} mm at X{x:.2f} Y{y:.2f}",
    )
    axes.set_title(f"rest material after {result.stage}, plan view")
    axes.set_xlabel("X, mm")
    axes.set_ylabel("Y, mm")
    _draw_legend(axes)
