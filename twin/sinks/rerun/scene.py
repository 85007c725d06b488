"""Static parts of the scene: axes, stock, styles of curves and path, the scale of forces."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import rerun as rr

from twin.arrays import FloatArray
from twin.record import RunHeader
from twin.sinks.rerun import layout
from twin.sinks.rerun.shapes import CLASSES, box_edges, class_colors, class_force_n, force_class, label_step_n

#: Parts of the scale.
_BARS = 28
#: Allowance for rounding of the number at the end of the scale.
_ABOVE = 1.0 + 1e-9
_UP = np.array((0.0, 0.0, 1.0))


def draw_scene(recording: rr.RecordingStream, header: RunHeader) -> None:
    """Log all that does not change during a run."""
    log = recording.log
    log("/", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True, strict=True)
    edges = rr.LineStrips3D(
        box_edges(header.stock_bounds_mm), colors=layout.STOCK_COLOR, radii=rr.Radius.ui_points(0.6)
    )
    log(layout.STOCK, edges, static=True, strict=True)
    for curves in layout.CURVES:
        style = rr.SeriesLines(
            colors=[series.color for series in curves.series],
            names=[series.label for series in curves.series],
            widths=1.2,
            visible_series=[i < len(curves.series) - curves.hidden for i in range(len(curves.series))],
            aggregation_policy="MinMax",
        )
        log(curves.entity, style, static=True, strict=True)
    collision = rr.SeriesPoints(colors=layout.COLLISION_COLOR, names="collision", markers="cross", marker_sizes=6.0)
    log(layout.COLLISION_MARK, collision, static=True, strict=True)
    warning = rr.SeriesPoints(colors=layout.WARNING_COLOR, names="warning", markers="diamond", marker_sizes=6.0)
    log(layout.WARNING_MARK, warning, static=True, strict=True)
    cut = rr.LineStrips3D.from_fields(radii=rr.Radius.ui_points(1.8), show_labels=False)
    log(layout.CUT_PATH, cut, static=True, strict=True)
    rapid = rr.LineStrips3D.from_fields(radii=rr.Radius.ui_points(0.5), colors=layout.RAPID_COLOR, show_labels=False)
    log(layout.RAPID_PATH, rapid, static=True, strict=True)


def draw_colors(recording: rr.RecordingStream, end_n: float) -> None:
    """Log the colours of the force classes on a scale from 0 to ``end_n``; the path so far changes with it.

    Path strips have the class of their force, so a new scale needs only a new colour for each class.
    """
    names = [_newtons(force_n, force_n) for force_n in map(class_force_n, range(CLASSES + 1))]
    classes = [(number, *pair) for number, pair in enumerate(zip(names, class_colors(end_n), strict=True))]
    recording.log(layout.PATH, rr.AnnotationContext(classes), static=True, strict=True)


def draw_scale(recording: rr.RecordingStream, view_mm: FloatArray, end_n: float) -> None:
    """Log a bar of the colours with its numbers next to what the camera looks at, the box ``view_mm``, shape (2, 3)."""
    colors = class_colors(end_n)
    foot, numbers_foot, height = _bar(view_mm)
    at = np.linspace(0.0, height, _BARS + 1)
    strips = [np.stack([foot + a * _UP, foot + b * _UP]) for a, b in pairwise(at)]
    forces = (np.arange(_BARS) + 0.5) / _BARS * end_n
    bar_colors = [colors[max(1, force_class(float(f)))] for f in forces]
    bar = rr.LineStrips3D(strips, colors=bar_colors, radii=rr.Radius.ui_points(4.0))
    recording.log(layout.SCALE, bar, static=True, strict=True)
    step_n = label_step_n(end_n)
    values = np.arange(round(end_n / step_n) + 1) * step_n
    values = values[values <= end_n * _ABOVE]
    numbers = rr.Points3D(
        numbers_foot + (values / end_n * height)[:, None] * _UP,
        labels=[_newtons(v, step_n) for v in values.tolist()],
        colors=layout.TEXT_COLOR,
        radii=rr.Radius.ui_points(0.0),
        show_labels=True,
    )
    recording.log(f"{layout.SCALE}/numbers", numbers, static=True, strict=True)


def _newtons(force_n: float, fineness_n: float) -> str:
    """A force with the decimals that values this far apart need: ``0.5 N``, ``5,000 N``."""
    decimals = max(0, -math.floor(math.log10(fineness_n) + 1e-9)) if fineness_n > 0.0 else 0
    return f"{force_n:,.{decimals}f} N"


def _bar(view_mm: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Foot of the bar, foot of its numbers, and its height: to the right of what the camera looks at, above it."""
    low, high = view_mm
    reach = 0.5 * float(np.linalg.norm(high - low))
    to_x, to_y, _ = layout.EYE
    right = np.array((-to_y, to_x, 0.0)) / math.hypot(to_x, to_y)
    centre = np.array((*(0.5 * (low + high))[:2], high[2] + 0.05 * reach))
    return centre + 1.25 * reach * right, centre + 1.35 * reach * right, 0.6 * reach
