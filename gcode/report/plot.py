"""The tool path of a program as a picture; matplotlib is imported only here, when a picture is drawn.

Points are projected before they are drawn, so that all axes have one scale in every view.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gcode.events import ArcMotion, Event, LinearMotion
from gcode.report.path_geometry import points_mm
from gcode.whole_file import whole_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

View: TypeAlias = Literal["iso", "xy", "xz", "yz"]
ColourBy: TypeAlias = Literal["z", "tool"]
_Array: TypeAlias = NDArray[np.float64]

#: Endings of the pictures that can be written.
SUFFIXES = (".png", ".svg", ".pdf")

_ROOT2, _ROOT6 = math.sqrt(2.0), math.sqrt(6.0)
#: Rows that take x, y, z to the picture's right and up; iso looks from the front right above, along (-1, 1, -1).
_PROJECTIONS: Mapping[str, _Array] = MappingProxyType(
    {
        "iso": np.array(((1 / _ROOT2, 1 / _ROOT2, 0.0), (-1 / _ROOT6, 1 / _ROOT6, 2 / _ROOT6))),
        "xy": np.array(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))),
        "xz": np.array(((1.0, 0.0, 0.0), (0.0, 0.0, 1.0))),
        "yz": np.array(((0.0, 1.0, 0.0), (0.0, 0.0, 1.0))),
    }
)
_RAPID = "#9aa0a6"
_INK = "#3c4043"
_EDGE = "#c4c7cc"
#: Ticks closer to the corner of the axes than this share of an axis.
_CORNER_SHARE = 0.04
#: Directions in the iso picture in which the ticks of the box's X, Y and Z edges stand.
_OUTWARDS = np.array(((0.6, -1.0), (-0.6, -1.0), (-1.2, 0.0)))
_TOOLS = ("#1f77b4", "#d95f02", "#2a9d5c", "#c2378f", "#7a5bc4", "#a6761d", "#16a3b8", "#c23b31", "#6b7a1f", "#5b6770")


class PlotError(Exception):
    """A picture that cannot be drawn; the message gives the reason."""


def check_picture(out: Path) -> None:
    """Checks the output file of a picture before the work begins.

    Raises:
        PlotError: for a name that does not end in one of `SUFFIXES`, a missing folder, and without matplotlib.
    """
    if out.suffix.lower() not in SUFFIXES:
        raise PlotError(f"{out}: unknown kind of image; expected a file name that ends in {', '.join(SUFFIXES)}")
    if not out.absolute().parent.is_dir():
        raise PlotError(f"{out}: cannot be written: the folder {out.parent} does not exist")
    if importlib.util.find_spec("matplotlib") is None:
        raise PlotError("matplotlib, which draws the picture, is not installed; pip install matplotlib")


def plot_path(
    events: Iterable[Event],
    out: Path,
    *,
    view: View = "iso",
    colour: ColourBy = "z",
    tolerance_mm: float = 0.01,
    title: str = "",
) -> None:
    """Draws the tool path of a program: rapids dashed, feed motions coloured, all axes to one scale.

    Args:
        events: of the program; only motions are drawn.
        out: image file to write; its suffix (.png, .svg, .pdf) determines the format.
        view: ``iso``, or the plane of projection.
        colour: quantity that colours the feed motions: height (``z``) or ``tool``.
        tolerance_mm: largest distance of chords from arcs, mm.
        title: above the picture.

    Raises:
        PlotError: without any motion, for an unknown suffix, a missing folder, without matplotlib, and where the file
            cannot be written.
        GcodeError: where the program is refused.
    """
    check_picture(out)
    path = _path_of(events, tolerance_mm)
    if not path.rapids and not path.feeds:
        raise PlotError(f"{title or 'the program'}: no motion to draw")
    try:
        with whole_file(out) as partial:
            _figure(path, view, colour, title).savefig(partial, dpi=160, bbox_inches="tight", pad_inches=0.2)
    except OSError as error:
        raise PlotError(f"{out}: cannot be written: {error.strerror or error}") from None


@dataclass(slots=True)
class _Path:
    """Polylines: motions that follow each other, of one kind and tool.

    Attributes:
        ends: first and last point of the program's path, empty without motions.
        rapids: of positioning motions.
        feeds: of motions at a feed, by tool.
    """

    ends: list[_Array] = field(default_factory=list)
    rapids: list[_Array] = field(default_factory=list)
    feeds: dict[int, list[_Array]] = field(default_factory=dict)

    def points(self) -> _Array:
        """All points."""
        return np.concatenate([*self.rapids, *(line for lines in self.feeds.values() for line in lines)])


def _path_of(events: Iterable[Event], tolerance_mm: float) -> _Path:
    path = _Path()
    run: list[_Array] = []
    kind: tuple[bool, int] | None = None
    for event in events:
        if not isinstance(event, LinearMotion | ArcMotion):
            continue
        rapid = isinstance(event, LinearMotion) and event.rapid
        if run and (kind != (rapid, event.state.tool) or tuple(run[-1][-1]) != event.start_mm):
            _add(path, kind, run)
            run = []
        kind = (rapid, event.state.tool)
        points = points_mm(event, tolerance_mm)
        path.ends = [path.ends[0] if path.ends else points[0], points[-1]]
        run.append(points[1:] if run else points)
    _add(path, kind, run)
    return path


def _add(path: _Path, kind: tuple[bool, int] | None, run: Sequence[_Array]) -> None:
    if kind is not None and run:
        rapid, tool = kind
        (path.rapids if rapid else path.feeds.setdefault(tool, [])).append(np.concatenate(run))


def _figure(path: _Path, view: View, colour: ColourBy, title: str) -> Figure:
    from matplotlib.figure import Figure

    points = path.points()
    bounds = points.min(axis=0), points.max(axis=0)
    width, height = np.ptp(_corners(*bounds) @ _PROJECTIONS[view].T, axis=0) + 1e-9
    ratio = min(max(height / width, 0.35), 1.4)
    figure = Figure(figsize=(9.0, 9.0 * ratio + 1.2), layout="constrained")
    axes = figure.add_subplot()
    _draw_rapids(axes, path, view)
    if colour == "tool":
        _draw_by_tool(axes, path, view)
    else:
        _draw_by_height(figure, axes, path, view)
    _draw_ends(axes, path, view)
    _dress(axes, bounds, view, title)
    below = -0.04 if view == "iso" else -0.11
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, below), ncols=6, frameon=False, fontsize=8, labelcolor=_INK)
    return figure


def _draw_ends(axes: Axes, path: _Path, view: View) -> None:
    """Marks where the path starts and ends."""
    start, end = (point @ _PROJECTIONS[view].T for point in path.ends)
    style: dict[str, Any] = {"linestyle": "none", "marker": "o", "zorder": 5}
    axes.plot(*start, markersize=11, markerfacecolor="none", markeredgecolor="#2a9d5c", mew=2.0, label="start", **style)
    axes.plot(*end, markersize=5, markerfacecolor="#c23b31", markeredgecolor="#c23b31", label="end", **style)


def _draw_rapids(axes: Axes, path: _Path, view: View) -> None:
    from matplotlib.collections import LineCollection

    if path.rapids:
        lines = [line @ _PROJECTIONS[view].T for line in path.rapids]
        style: dict[str, Any] = {"colors": _RAPID, "linewidths": 0.7, "linestyles": (0, (5, 3)), "zorder": 1}
        axes.add_collection(LineCollection(lines, label="rapid", **style))


def _draw_by_tool(axes: Axes, path: _Path, view: View) -> None:
    from matplotlib.collections import LineCollection

    for index, (tool, lines) in enumerate(sorted(path.feeds.items())):
        flat = [line @ _PROJECTIONS[view].T for line in lines]
        name = f"T{tool}" if tool else "feed, no tool"
        made = LineCollection(flat, colors=_TOOLS[index % len(_TOOLS)], linewidths=0.9, zorder=2, label=name)
        axes.add_collection(made)


def _draw_by_height(figure: Figure, axes: Axes, path: _Path, view: View) -> None:
    """Each chord in the colour of its middle's height, the lower ones first where seen from above."""
    from matplotlib import colormaps
    from matplotlib.collections import LineCollection
    from matplotlib.colors import ListedColormap

    lines = [line for of_tool in path.feeds.values() for line in of_tool]
    if not lines:
        return
    chords = np.concatenate([np.stack((line[:-1], line[1:]), axis=1) for line in lines])
    heights = chords[:, :, 2].mean(axis=1)
    order = np.argsort(heights, kind="stable")
    colours = ListedColormap(colormaps["viridis"](np.linspace(0.0, 0.9, 256)))  # its last tenth is faint on white
    made = LineCollection(list(chords[order] @ _PROJECTIONS[view].T), cmap=colours, linewidths=0.9, zorder=2)
    made.set_array(heights[order])
    made.set_capstyle("round")
    made.set_label("feed, coloured by Z")
    axes.add_collection(made)
    if np.ptp(heights) > 1e-6:
        bar = figure.colorbar(made, ax=axes, shrink=0.7, pad=0.02, aspect=30)
        bar.set_label("Z, mm", color=_INK)
        bar.ax.tick_params(labelsize=8, colors=_INK)
        bar.outline.set_visible(False)


def _corners(low: _Array, high: _Array) -> _Array:
    """The eight corners of a box."""
    return np.stack(np.meshgrid(*zip(low, high, strict=True), indexing="ij"), axis=-1).reshape(-1, 3)


def _dress(axes: Axes, bounds: tuple[_Array, _Array], view: View, title: str) -> None:
    """Scale, limits, labels."""
    flat = _corners(*bounds) @ _PROJECTIONS[view].T
    low, high = flat.min(axis=0), flat.max(axis=0)
    margin = 0.05 * max(*(high - low), 1e-3)
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal", adjustable="box")
    axes.set_title(title, loc="left", fontsize=11, color=_INK)
    for spine in axes.spines.values():
        spine.set_visible(False)
    if view == "iso":
        axes.set_xticks([])
        axes.set_yticks([])
        _draw_box(axes, *bounds, view)
        return
    axes.set_xlabel(f"{view[0].upper()}, mm", color=_INK)
    axes.set_ylabel(f"{view[1].upper()}, mm", color=_INK)
    axes.tick_params(labelsize=8, colors=_INK, length=0)
    axes.grid(color="#e3e5e8", linewidth=0.6, zorder=0)
    axes.set_axisbelow(True)


def _draw_box(axes: Axes, low: _Array, high: _Array, view: View) -> None:
    """The three edges of the path's box that meet in its lowest corner at the left, with ticks in mm."""
    from matplotlib.ticker import MaxNLocator

    largest = float((high - low).max())
    at_corner = False
    for axis, name in enumerate("XYZ"):
        far = low.copy()
        far[axis] = high[axis]
        if far[axis] - low[axis] < 1e-9:
            continue
        ends = np.array((low, far)) @ _PROJECTIONS[view].T
        axes.plot(*ends.T, color=_EDGE, linewidth=0.8, zorder=0)
        outwards = _OUTWARDS[axis]
        count = max(1, round(6 * (far[axis] - low[axis]) / largest))
        for value in MaxNLocator(count).tick_values(low[axis], high[axis]):
            if low[axis] - 1e-9 <= value <= high[axis] + 1e-9:
                share = (value - low[axis]) / (far[axis] - low[axis])
                if share < _CORNER_SHARE and at_corner:
                    continue  # it would be written over that of another axis
                at_corner = at_corner or share < _CORNER_SHARE
                _draw_tick(axes, ends[0] + share * (ends[1] - ends[0]), outwards, f"{value:g}", 7)
        along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        _draw_tick(axes, ends[1], np.array((3.4, 2.6)) * along, f"{name}, mm", 9, mark=False)


def _draw_tick(axes: Axes, at: _Array, outwards: _Array, text: str, size: int, *, mark: bool = True) -> None:
    """A text next to a point of the box; ``outwards`` is the text's direction in points."""
    x, y = at.tolist()
    right, up = (9.0 * outwards).tolist()
    if mark:
        axes.plot(x, y, marker="o", markersize=1.8, color=_EDGE, zorder=0)
    axes.annotate(
        text,
        (x, y),
        xytext=(right, up),
        textcoords="offset points",
        fontsize=size,
        color=_INK,
        ha="center",
        va="center",
    )
