"""Style of the pictures on pages: one width, light grids, no boxes, legends above the axes."""

from __future__ import annotations

import io

from matplotlib.axes import Axes
from matplotlib.figure import Figure

#: Width of a picture, inch, and its dots per inch.
WIDTH = 9.6
DPI = 130
#: Colours of the axes' forces, and of the resultant.
AXIS_COLOURS = {"x": "#d1472c", "y": "#12805c", "z": "#1f6fc4"}
RESULTANT = "#222831"


def stack(count: int, height: float) -> tuple[Figure, list[Axes]]:
    """A figure of several axes one above the other, which share their x axis.

    Args:
        height: of each, inch.
    """
    figure = Figure(figsize=(WIDTH, height * count + 0.4), dpi=DPI, layout="constrained")
    parts = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    return figure, list(parts)


def dress(part: Axes, label: str, legend: bool = True) -> None:
    """Give axes a label, a light grid, no box, and the legend above them."""
    if label:
        part.set_ylabel(label, fontsize=9)
    part.grid(color="#e6e9ee", lw=0.6)
    part.set_axisbelow(True)
    part.spines[["top", "right"]].set_visible(False)
    part.tick_params(labelsize=8)
    part.margins(x=0.0)
    if legend:
        part.legend(
            loc="lower right",
            bbox_to_anchor=(1.0, 0.985),
            borderaxespad=0.0,
            fontsize=7.5,
            ncols=6,
            frameon=False,
            handlelength=1.6,
            columnspacing=1.2,
        )


def png(figure: Figure) -> bytes:
    """A figure as PNG data, the same for equal figures."""
    out = io.BytesIO()
    figure.savefig(out, format="png", metadata={"Software": None})
    return out.getvalue()
