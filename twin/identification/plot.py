"""Measured against fitted forces as a picture."""

from __future__ import annotations

import math
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from twin.identification.fit.least_squares import CONFIDENCE
from twin.identification.models.straight import NAMES
from twin.identification.result import CutResult, Identified

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLOURS = ("#c1272d", "#1f7a3d", "#1f4fa3")
_HELD = "#8a8a8a"
_AXES = "xyz"
_ACROSS = 3
_MOST_WAVEFORMS = 12
_ANGLES = 361


def plot_png(result: Identified) -> bytes:
    """A PNG: mean forces of all cuts, and waveforms over one revolution where they were fitted."""
    figure = _figure(result)
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=110)
    return buffer.getvalue()


def _figure(result: Identified) -> Figure:
    from matplotlib.figure import Figure

    waves = [cut for cut in result.cuts if cut.phase_rad is not None][:_MOST_WAVEFORMS]
    rows = math.ceil(len(waves) / _ACROSS)
    figure = Figure(figsize=(13.0, 4.6 + 2.7 * rows), layout="constrained")
    grid = figure.add_gridspec(1 + rows, _ACROSS, height_ratios=[1.45] + [1.0] * rows)
    for axis in range(3):
        _means(figure.add_subplot(grid[0, axis]), result, axis)
    for i, cut in enumerate(waves):
        _waveform(figure.add_subplot(grid[1 + i // _ACROSS, i % _ACROSS]), cut, first=i == 0)
    figure.suptitle(_title(result), fontsize=10, parse_math=False)
    return figure


def _title(result: Identified) -> str:
    estimate = result.estimate
    values = [
        f"{name} {value:.4g}" + (f" ± {_three(half)}" if math.isfinite(half) and not fixed else "")
        for name, value, half, fixed in zip(
            NAMES, estimate.values, estimate.half_widths, estimate.fixed.tolist(), strict=True
        )
    ]
    r2 = f"R² {result.r_squared[0]:.4f}"
    source = f"{result.source}\n" if result.source else ""
    return (
        f"{source}{result.file.name}: measured and fitted force on the tool ({result.method}), {r2}\n"
        f"{',  '.join(values)}   (c: N/mm², e: N/mm, ± {100 * CONFIDENCE:g} %)"
    )


def _three(value: float) -> str:
    """Three figures, without an exponent."""
    return f"{value:.{max(0, 2 - math.floor(math.log10(value)))}f}" if value > 0.0 else "0"


def _means(axes: Axes, result: Identified, axis: int) -> None:
    """Mean force of each cut: measured with its 95 % error, fitted as a bar's end."""
    cuts = result.cuts
    at = np.arange(len(cuts))
    fitted = np.array([cut.fitted_n[axis] for cut in cuts])
    measured = np.array([cut.measured.mean_n[axis] for cut in cuts])
    error = np.nan_to_num(np.array([1.96 * cut.measured.error_n[axis] for cut in cuts]))
    bars = axes.bar(at, fitted, width=0.62, color=_COLOURS[axis], alpha=0.3, label="fitted")
    for bar, cut in zip(bars, cuts, strict=True):
        if cut.held_out:
            bar.set(color=_HELD, hatch="//", alpha=0.35)
    axes.errorbar(at, measured, yerr=error, fmt="o", ms=4.5, color="black", lw=1.0, capsize=3, label="measured")
    axes.axhline(0.0, color="black", lw=0.6)
    axes.set_title(
        f"mean F{_AXES[axis]}, N" + (" (hatched: held out)" if any(c.held_out for c in cuts) else ""), fontsize=9
    )
    _cut_names(axes, at, [cut.name for cut in cuts])
    axes.legend(fontsize=7, frameon=False)


def _cut_names(axes: Axes, at: Any, names: list[str]) -> None:
    turned = sum(map(len, names)) > 30
    axes.set_xticks(
        at, names, fontsize=7, rotation=60 if turned else 0, ha="right" if turned else "center", parse_math=False
    )
    axes.tick_params(axis="y", labelsize=7)
    axes.spines[["top", "right"]].set_visible(False)


def _waveform(axes: Axes, cut: CutResult, *, first: bool) -> None:
    """One revolution: measured as dots, fitted as lines."""
    degrees = np.linspace(0.0, 360.0, _ANGLES)
    both = cut.waveforms(np.radians(degrees))
    assert both is not None
    for axis in range(3):
        if cut.measured.axes[axis]:
            axes.plot(degrees[::4], both[0][::4, axis], ".", ms=2.6, color=_COLOURS[axis])
        axes.plot(degrees, both[1][:, axis], lw=1.0, color=_COLOURS[axis], label=f"F{_AXES[axis]}")
    error = cut.waveform_error_n()
    held = ", held out" if cut.held_out else ""
    axes.set_title(f"{cut.name}{held}: dots measured, lines fitted, RMS {error:.2f} N", fontsize=8, parse_math=False)
    axes.set_xticks(range(0, 361, 90))
    axes.tick_params(labelsize=7)
    axes.set_xlabel("spindle angle, deg", fontsize=7)
    axes.set_ylabel("N", fontsize=7)
    axes.spines[["top", "right"]].set_visible(False)
    if first:
        axes.legend(fontsize=7, frameon=False, ncols=3, loc="upper right")
