"""Deviations as a picture: a map from above, and a histogram of the machined area."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from twin.archive.container.partial import replacing
from twin.verification.deviation import Deviation

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_UM = 1000.0


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
    end = 2.0 * max(found.tolerance_mm, found.excess_mm) * _UM
    order = np.argsort(np.abs(found.deviation_mm))
    points, deviation = found.points_mm[order], found.deviation_mm[order] * _UM
    size = (
        (72.0 * 5.5 * found.pitch_mm / max(float(np.ptp(points[:, :2], axis=0).max()), 1e-9)) ** 2 if len(order) else 1
    )
    drawn = plan.scatter(
        points[:, 0],
        points[:, 1],
        c=deviation,
        s=max(size, 0.3),
        cmap="RdBu",
        vmin=-end,
        vmax=end,
        linewidths=0,
        rasterized=True,
    )
    figure.colorbar(drawn, ax=plan, label="deviation, µm (− gouge, + excess)", extend="both")
    plan.set(aspect="equal", xlabel="x, mm", ylabel="y, mm", title=title, facecolor="0.93")
    for region in found.regions[:12]:
        x, y, _ = region.point_mm
        plan.plot(x, y, "kx", markersize=5, markeredgewidth=0.8)
    _spread(spread, found, end)
    with replacing(out) as partial:
        figure.savefig(partial, dpi=150)


def _spread(axes: Axes, found: Deviation, end: float) -> None:
    bins = np.linspace(-end, end, 121)
    inside = np.clip(found.deviation_mm * _UM, -end, end)
    share = 100.0 * found.area_mm2 / max(float(found.area_mm2.sum()), 1e-300)
    axes.hist(inside, bins=bins.tolist(), weights=share, color="#4a7db5", log=bool(share.any()))
    for at in (-found.tolerance_mm * _UM, found.excess_mm * _UM):
        axes.axvline(at, color="#b2182b", linewidth=1.0, linestyle="--")
    axes.set(xlabel="deviation, µm (outer bins: beyond)", ylabel="share of the machined area, %")
