"""A run in a notebook: its numbers and a plot of its forces, small however many samples there are."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Mapping
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.record import RunSummary

#: Columns of the plot's envelope: about one for each of its pixels.
COLUMNS = 800
#: Runs with more samples are shown without a plot, which would take longer than a minute to read.
MOST_SAMPLES = 20_000_000
_FORCES = (("fx_n", "Fx", "tab:red"), ("fy_n", "Fy", "tab:green"), ("fz_n", "Fz", "tab:blue"))

#: Samples by name, all of shape (n,).
Samples = Mapping[str, NDArray[Any]]


def run_html(program: str, extent: str, summary: RunSummary, batches: Iterable[Samples]) -> str:
    """A heading, a table by tool and a plot.

    Args:
        program: name of the NC program.
        extent: how much of the program the run covers.
        summary: of the run.
        batches: its force samples, in parts.
    """
    head = f"<b>{escape(program)}</b> {escape(extent)}; {summary.removed_volume_mm3:.1f} mm³ removed, "
    head += f"{summary.collisions} collisions"
    names = ("tool", "cutting, s", "removed, mm³", "peak Fx, N", "Fy", "Fz", "resultant", "peak power, W")
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
    return f"<div>{head}<table>{''.join(lines)}</table>{_plot(summary, batches)}</div>"


def envelope(batches: Iterable[Samples], end_s: float, columns: int = COLUMNS) -> tuple[FloatArray, FloatArray]:
    """Least and largest force in equal parts of the machine time; memory does not grow with the samples.

    Args:
        batches: samples in parts, in the order of time.
        end_s: machine time at the end of the last column.
        columns: number of parts.

    Returns:
        Least and largest Fx, Fy, Fz of each column, shape (columns, 3) each; NaN in a column without samples.
    """
    low, high = np.full((columns, 3), np.nan), np.full((columns, 3), np.nan)
    for batch in batches:
        at = np.minimum((batch["t_s"] / end_s * columns).astype(np.int64), columns - 1)
        if not len(at):
            continue
        firsts = np.flatnonzero(np.diff(at, prepend=-1))
        rows = at[firsts]
        for axis, (name, _, _) in enumerate(_FORCES):
            low[rows, axis] = np.fmin(low[rows, axis], np.minimum.reduceat(batch[name], firsts))
            high[rows, axis] = np.fmax(high[rows, axis], np.maximum.reduceat(batch[name], firsts))
    return low, high


def _row(kind: str, cells: tuple[str, ...]) -> str:
    return "<tr>" + "".join(f"<{kind}>{escape(cell)}</{kind}>" for cell in cells) + "</tr>"


def _plot(summary: RunSummary, batches: Iterable[Samples]) -> str:
    if not summary.samples:
        return ""
    if summary.samples > MOST_SAMPLES:
        return f"<p>{summary.samples} samples: no plot; <code>view()</code> shows them in rerun.</p>"
    png = base64.b64encode(_png(summary.machine_time_s, batches)).decode()
    return f'<img alt="forces over time" src="data:image/png;base64,{png}">'


def _png(end_s: float, batches: Iterable[Samples]) -> bytes:
    """Forces over time."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    low, high = envelope(batches, end_s)
    t_s = (np.arange(len(low)) + 0.5) * end_s / len(low)
    figure = Figure(figsize=(8.0, 2.6), dpi=100, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    for axis, (_, label, color) in enumerate(_FORCES):
        axes.fill_between(t_s, low[:, axis], high[:, axis], color=color, alpha=0.6, linewidth=0.8, label=label)
    axes.set_xlabel("machine time, s")
    axes.set_ylabel("force on the tool, N")
    axes.legend(loc="upper right", ncols=3)
    axes.margins(x=0.0)
    file = io.BytesIO()
    figure.savefig(file, format="png")
    return file.getvalue()
