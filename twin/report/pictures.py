"""Pictures of a report, as PNG data."""

from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.ticker import FuncFormatter

from twin.arrays import FloatArray
from twin.number_format import grouped
from twin.pages.figures import AXIS_COLOURS, DPI, RESULTANT, WIDTH, dress, png, stack
from twin.pages.solid_view import ISO, PLAN, draw_solid
from twin.report.bins import TimeBins
from twin.report.contents import ReportContents, WorstPosition
from twin.report.track import Track
from twin.run.plausibility import tool_sizes
from twin.workpiece.to_mesh import SurfaceMesh

#: Ticks with groups of three digits, as in the tables.
_TICKS = FuncFormatter(lambda value, _: grouped(value) if abs(value) >= 1000.0 else f"{value:g}")
#: Colours of the force, without the palest ones.
_FORCE_COLOURS = ListedColormap(colormaps["plasma"](np.linspace(0.0, 0.92, 256)))
_COLLISION = "#c2185b"
_MARK = {"boxstyle": "circle,pad=0.25", "facecolor": "white", "edgecolor": RESULTANT, "linewidth": 0.9}
_AIR = "#8d949e"


def overview(contents: ReportContents, part: SurfaceMesh) -> bytes:
    """The machined part from the front right above, the path coloured by force, the worst positions numbered."""
    figure = Figure(figsize=(WIDTH, 5.8), dpi=DPI, layout="constrained")
    axes = figure.add_subplot()
    if len(part.triangles):
        draw_solid(axes, part.vertices_mm, part.triangles, ISO)
    _draw_track(figure, axes, contents.track, ISO)
    for number, worst in enumerate(contents.worst, 1):
        at = np.array(worst.forces.point_mm) @ ISO[:2].T
        axes.annotate(
            str(number),
            at,
            xytext=(18.0, 18.0),
            textcoords="offset points",
            fontsize=8,
            zorder=6,
            bbox=_MARK,
            arrowprops={"arrowstyle": "-", "color": RESULTANT, "linewidth": 0.9},
        )
    if contents.collisions:
        points = np.array([c.point_mm for c in contents.collisions]) @ ISO[:2].T
        axes.plot(*points.T, "X", color=_COLLISION, markersize=7, markeredgecolor="white", zorder=5, label="collision")
    _frame(axes, contents)
    axes.set_axis_off()
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper left", fontsize=8, frameon=False)
    return png(figure)


def _frame(axes: Axes, contents: ReportContents) -> None:
    """Limits around stock, feed motions and collisions; rapids may lead out of the picture."""
    track = contents.track
    low, high = contents.header.stock_bounds_mm
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    feeds = ~track.rapid
    collisions = np.array([c.point_mm for c in contents.collisions]).reshape(-1, 3)
    points = np.concatenate((corners, track.start_mm[feeds], track.end_mm[feeds], collisions)) @ ISO[:2].T
    least, most = points.min(axis=0), points.max(axis=0)
    margin = 0.06 * float((most - least).max())
    axes.set_xlim(least[0] - margin, most[0] + margin)
    axes.set_ylim(least[1] - margin, most[1] + margin)
    axes.set_aspect("equal")


def over_time(contents: ReportContents) -> bytes:
    """Forces, power and engagement over machine time: the band between least and largest value of each column."""
    bins = contents.bins
    forces = bool(np.isfinite(bins.low_n).any())
    figure, parts = stack(4 if forces else 1, 1.75)
    if forces:
        for i, axis in enumerate("xyz"):
            colour = AXIS_COLOURS[axis]
            _band(parts[0], bins, bins.low_n[:, i], bins.high_n[:, i], colour, f"F{axis}")
        parts[0].axhline(0.0, color="#c9ced6", lw=0.7, zorder=0)
        dress(parts[0], "force on tool, N")
        _band(parts[1], bins, bins.low_n[:, 3], bins.high_n[:, 3], RESULTANT, "resultant")
        _marks(parts[1], contents)
        dress(parts[1], "resultant, N")
        _band(parts[2], bins, 0.0 * bins.power_w, bins.power_w, "#7a5bc4", "largest power")
        dress(parts[2], "power, W")
    depths = parts[-1]
    depths.step(bins.t_s, bins.axial_mm, where="mid", color="#a6761d", lw=1.1, label="axial depth of cut")
    depths.step(bins.t_s, bins.radial_mm, where="mid", color="#16a3b8", lw=1.1, label="radial depth of cut")
    dress(depths, "depth of cut, mm")
    depths.set_xlabel("machine time, s")
    depths.set_xlim(0.0, bins.end_s)
    for part in parts:
        part.yaxis.set_major_formatter(_TICKS)
        for t_s, _ in contents.tool_changes:
            part.axvline(t_s, color="#9aa0a6", lw=0.8, ls=":", zorder=0)
    if contents.collisions:
        for part in parts:
            for each in contents.collisions:
                part.axvline(each.t_s, color=_COLLISION, lw=0.8, alpha=0.7, zorder=0)
    return png(figure)


def position(contents: ReportContents, worst: WorstPosition, part: SurfaceMesh) -> bytes:
    """One position: path, tool and part from above, and the force over two revolutions."""
    figure = Figure(figsize=(WIDTH, 3.3), dpi=DPI, layout="constrained")
    plan, wave = figure.subplots(1, 2, width_ratios=(1.0, 1.7))
    _draw_plan(figure, plan, contents, worst, part)
    _draw_wave(wave, worst)
    return png(figure)


def _draw_plan(figure: Figure, axes: Axes, contents: ReportContents, worst: WorstPosition, part: SurfaceMesh) -> None:
    sizes = tool_sizes(contents.header)
    radius = 0.5 * sizes[worst.forces.tool][0] if worst.forces.tool in sizes else 1.0
    x, y, _ = worst.forces.point_mm
    if len(part.triangles):
        draw_solid(axes, *_around(part, (x, y), 4.5 * radius), PLAN)
    _draw_track(figure, axes, contents.track, PLAN, bar=False)
    axes.add_patch(Circle((x, y), radius, fill=False, color=RESULTANT, lw=1.4, zorder=5))
    axes.plot(x, y, "+", color=RESULTANT, markersize=7, zorder=5)
    axes.set_xlim(x - 3.0 * radius, x + 3.0 * radius)
    axes.set_ylim(y - 3.0 * radius, y + 3.0 * radius)
    axes.set_aspect("equal")
    axes.set_xlabel("X, mm", fontsize=9)
    axes.set_ylabel("Y, mm", fontsize=9)
    axes.tick_params(labelsize=8)


def _around(
    part: SurfaceMesh, centre: tuple[float, float], reach: float
) -> tuple[FloatArray, np.ndarray[tuple[int, int], np.dtype[np.uint32]]]:
    """The triangles of a part with a corner near a position, seen from above."""
    near = (np.abs(part.vertices_mm[:, :2] - np.array(centre)) <= reach).all(axis=1)
    kept = part.triangles[near[part.triangles].any(axis=1)]
    return part.vertices_mm, kept


def _draw_wave(axes: Axes, worst: WorstPosition) -> None:
    resultant = np.linalg.norm(worst.force_n, axis=1)
    turn_s = 60.0 / max(abs(worst.forces.spindle_rpm), 1e-3)
    turns = (worst.t_s - worst.forces.t_s) / turn_s
    for i, axis in enumerate("xyz"):
        axes.plot(turns, worst.force_n[:, i], color=AXIS_COLOURS[axis], lw=1.2, label=f"F{axis}")
    axes.plot(turns, resultant, color=RESULTANT, lw=1.2, label="resultant")
    axes.plot(0.0, resultant.max(initial=0.0), "o", color=RESULTANT, markersize=4)
    axes.axhline(0.0, color="#c9ced6", lw=0.7, zorder=0)
    dress(axes, "force on tool, N")
    axes.yaxis.set_major_formatter(_TICKS)
    axes.set_xlabel("revolutions of the spindle before and after the peak", fontsize=9)


def _draw_track(figure: Figure, axes: Axes, track: Track, view: FloatArray, *, bar: bool = True) -> None:
    """Rapids dashed, air thin, cutting motions coloured by force."""
    lines = np.stack((track.start_mm @ view[:2].T, track.end_mm @ view[:2].T), axis=1)
    air = ~track.rapid & (track.resultant_n <= 0.0)
    cut = ~track.rapid & (track.resultant_n > 0.0)
    for kept, name, style in ((track.rapid, "rapid", (0, (4, 3))), (air, "feed without force", "solid")):
        if kept.any():
            axes.add_collection(
                LineCollection(list(lines[kept]), colors=_AIR, linewidths=0.6, linestyles=style, zorder=2, label=name)
            )
    if not cut.any():
        return
    order = np.argsort(track.resultant_n[cut], kind="stable")
    made = LineCollection(list(lines[cut][order]), cmap=_FORCE_COLOURS, linewidths=1.6, zorder=3)
    made.set_array(track.resultant_n[cut][order])
    made.set_norm(Normalize(0.0, float(track.resultant_n.max())))
    made.set_capstyle("round")
    axes.add_collection(made)
    if bar:
        scale = figure.colorbar(made, ax=axes, shrink=0.75, pad=0.01, aspect=30)
        scale.set_label("largest resultant on the piece of path, N", fontsize=9)
        scale.ax.yaxis.set_major_formatter(_TICKS)
        scale.ax.tick_params(labelsize=8)


def _band(axes: Axes, bins: TimeBins, low: FloatArray, high: FloatArray, colour: str, name: str) -> None:
    low, high = bins.envelope(low, high)
    axes.fill_between(bins.t_s, low, high, color=colour, alpha=0.55, lw=0.7, label=name, step="mid")


def _marks(axes: Axes, contents: ReportContents) -> None:
    """The numbers of the worst positions, and the names of tools, on the resultant."""
    for number, worst in enumerate(contents.worst, 1):
        axes.annotate(str(number), (worst.forces.t_s, worst.forces.peak_n), fontsize=7, bbox=_MARK, zorder=5)
    if len(contents.tool_changes) > 1:
        for t_s, text in contents.tool_changes:
            axes.annotate(
                text.split()[0], (t_s, 0.97), xycoords=("data", "axes fraction"), fontsize=7, va="top", color="#5b626c"
            )
