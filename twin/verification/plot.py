"""Deviations as a picture: a map from above, and a histogram of the machined area."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from twin.archive.container.partial import replacing
from twin.verification.deviation import Deviation

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_UM = 1000.0
#: Most regions of a kind with a mark.
_MARKED = 12
_MICROMETRES = "{x:.4g}"


def plot_deviation(found: Deviation, out: Path, title: str = "") -> None:
    """Draw deviations in um, red for gouges and blue for excess.

    Args:
        found: the deviations.
        out: picture to write; its suffix determines the format.
        title: title of the map.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13.0, 6.2), layout="constrained")
    FigureCanvasAgg(figure)
    plan, spread = figure.subplots(1, 2, width_ratios=(1.15, 1.0))
    _map(figure, plan, found, title)
    _spread(spread, found)
    with replacing(out) as partial:
        figure.savefig(partial, dpi=150)


def _scale(found: Deviation) -> tuple[float, float]:
    """Half width of the linear part of the scales and their end, µm: linear up to the larger tolerance, then
    logarithmic up to the worst value, so that the worst is on the scale and small deviations can still be seen.
    """
    linear = max(found.tolerance_mm, found.excess_mm, 1e-6) * _UM
    worst = max(found.worst_gouge_mm, found.worst_excess_mm, 0.0) * _UM
    return linear, max(2.0 * linear, 1.05 * worst)


def _map(figure: Figure, axes: Axes, found: Deviation, title: str) -> None:
    """Plan view of the machined surface, the largest deviations on top."""
    from matplotlib.colors import AsinhNorm

    linear, end = _scale(found)
    order = np.argsort(np.abs(found.deviation_mm))
    points, deviation = found.points_mm[order], found.deviation_mm[order] * _UM
    extent = float(np.ptp(points[:, :2], axis=0).max()) if len(order) else 1.0
    size = max((72.0 * 5.5 * found.pitch_mm / max(extent, 1e-9)) ** 2, 0.3)
    norm = AsinhNorm(linear_width=linear, vmin=-end, vmax=end)
    x, y = points[:, :2].T
    drawn = axes.scatter(x, y, c=deviation, s=size, cmap="RdBu", norm=norm, linewidths=0, rasterized=True)
    bar = figure.colorbar(drawn, ax=axes, label="deviation, µm (− gouge, + excess)")
    bar.ax.set_yticks(_ticks(linear, end))
    bar.ax.minorticks_off()
    bar.ax.yaxis.set_major_formatter(_MICROMETRES)
    axes.set(aspect="equal", xlabel="X, mm", ylabel="Y, mm", title=title, facecolor="0.93")
    for kind, marker in (("gouge", "x"), ("excess", "+")):
        regions = [region for region in found.regions if region.kind == kind]
        if regions:
            u, v = np.array([region.point_mm for region in regions[:_MARKED]])[:, :2].T
            name = f"{kind} out of tolerance" + (f", {_MARKED} of {len(regions)}" if len(regions) > _MARKED else "")
            axes.plot(u, v, f"k{marker}", markersize=6, markeredgewidth=0.9, label=name)
    if found.regions:
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2, fontsize=8, frameon=False)


def _ticks(linear: float, end: float) -> list[float]:
    """Zero, the linear part's ends, decades of it, and the scale's ends."""
    ticks = [0.0, linear]
    while ticks[-1] * 10.0 < 0.6 * end:
        ticks.append(10.0 * ticks[-1])
    ticks.append(end)
    return [-t for t in reversed(ticks[1:])] + ticks


def _spread(axes: Axes, found: Deviation) -> None:
    """Share of the machined area in classes of deviation, on the scale of the map."""
    linear, end = _scale(found)
    bins = linear * np.sinh(np.linspace(-1.0, 1.0, 121) * np.arcsinh(end / linear))
    share = 100.0 * found.area_mm2 / max(float(found.area_mm2.sum()), 1e-300)
    inside = np.clip(found.deviation_mm * _UM, -end, end)
    axes.hist(inside, bins=bins.tolist(), weights=share, color="#4a7db5", log=bool(share.any()))
    for at, style, name in (
        (-found.tolerance_mm * _UM, "--", f"gouge allowed: {found.tolerance_mm * _UM:g} µm"),
        (found.excess_mm * _UM, ":", f"excess allowed: {found.excess_mm * _UM:g} µm"),
    ):
        axes.axvline(at, color="#b2182b", linewidth=1.2, linestyle=style, label=name)
    axes.set_xscale("asinh", linear_width=linear)
    axes.set_xticks(_ticks(linear, end))
    axes.xaxis.set_major_formatter(_MICROMETRES)
    axes.minorticks_off()
    worst = f"deepest gouge {found.worst_gouge_mm * _UM:.3g} µm, largest excess {found.worst_excess_mm * _UM:.3g} µm"
    axes.set(xlabel="deviation, µm", ylabel="share of the machined area, %", title=worst)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2, fontsize=8, frameon=False)
