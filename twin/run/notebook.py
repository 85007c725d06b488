"""A run in a notebook: its numbers and a plot of its forces, small however many samples there are."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.record import RunSummary

#: Columns of the plot's envelope: about one for each of its pixels.
COLUMNS = 800
_FORCES = (("fx_n", "Fx", "tab:red"), ("fy_n", "Fy", "tab:green"), ("fz_n", "Fz", "tab:blue"))


def run_html(program: str, extent: str, summary: RunSummary, forces: Mapping[str, NDArray[Any]]) -> str:
    """A heading, a table by tool and a plot.

    Args:
        extent: how much of the program the run covers.
    """
    head = f"<b>{escape(program)}</b> {escape(extent)}; {summary.removed_volume_mm3:.1f} mm³ removed, "
    head += f"{summary.collisions} collisions"
    names = ("tool", "cutting, s", "removed, mm³", "Fx", "Fy", "Fz", "resultant, N (peaks)", "power, W")
    rows = [
        (
            f"T{t.number} {t.description}",
            f"{t.cutting_time_s:.1f}",
            f"{t.removed_volume_mm3:.1f}",
            *(f"{f:.1f}" for f in t.peak_force_n),
            f"{t.peak_power_w:.1f}",
        )
        for t in summary.tools
    ]
    lines = [_row("th", names), *(_row("td", cells) for cells in rows)]
    plot = f'<img alt="forces over time" src="data:image/png;base64,{_png(forces)}">' if summary.samples else ""
    return f"<div>{head}<table>{''.join(lines)}</table>{plot}</div>"


def envelope(values: FloatArray, count: int = COLUMNS) -> tuple[NDArray[np.intp], FloatArray, FloatArray]:
    """Least and largest of samples, thinned for a plot.

    Args:
        values: shape (n,).
        count: at most this many columns.

    Returns:
        Index of each column's first sample, and its least and largest value, all of shape (min(n, count),).
    """
    firsts = np.unique(np.arange(min(len(values), count)) * len(values) // max(1, min(len(values), count)))
    if not len(firsts):
        return firsts, np.zeros(0), np.zeros(0)
    return firsts, np.minimum.reduceat(values, firsts), np.maximum.reduceat(values, firsts)


def _row(kind: str, cells: tuple[str, ...]) -> str:
    return "<tr>" + "".join(f"<{kind}>{escape(cell)}</{kind}>" for cell in cells) + "</tr>"


def _png(forces: Mapping[str, NDArray[Any]]) -> str:
    """Forces over time as the base64 text of a PNG."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 2.6), dpi=100, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    for name, label, color in _FORCES:
        firsts, low, high = envelope(forces[name])
        axes.fill_between(forces["t_s"][firsts], low, high, color=color, alpha=0.6, linewidth=0.8, label=label)
    axes.set_xlabel("machine time, s")
    axes.set_ylabel("force on the tool, N")
    axes.legend(loc="upper right", ncols=3)
    axes.margins(x=0.0)
    file = io.BytesIO()
    figure.savefig(file, format="png")
    return base64.b64encode(file.getvalue()).decode()
