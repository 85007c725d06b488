"""An identification as tables for an engineer."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from twin.identification.models.straight import NAMES

if TYPE_CHECKING:
    from twin.identification.cuts.cuts_file import Cuts
    from twin.identification.result import CutResult, Identified

_AXES = "xyz"
_HOW = {
    "mean": "least squares on mean forces",
    "iterative": "search that matches simulated mean forces",
    "waveform": "least squares on waveforms",
}


def print_identified(console: Console, cuts: Cuts, result: Identified, *, verbose: bool) -> None:
    """Print a result."""
    fitted = sum(not cut.held_out for cut in result.cuts)
    effort = f", {result.evaluations} simulations of all cuts" if result.evaluations else ""
    console.print(
        f"{cuts.path.name}: {fitted} of {len(result.cuts)} cuts fitted, {_HOW[result.method]}{effort}\n", markup=False
    )
    console.print(_coefficients(result))
    console.print(_quality(result), "\n", markup=False, sep="")
    console.print("Correlation of the errors", style="bold")
    console.print(_correlation(result))
    console.print("\nMean force on the tool, N: measured, and measured minus fitted (Δ)", style="bold")
    console.print(_cuts(result.cuts))
    if any(cut.measured.window_s for cut in result.cuts):
        console.print("\nEvaluation of the logs", style="bold")
        console.print(_logs(result.cuts))
    if verbose:
        for cut in result.cuts:
            console.print(f"\n{cut.name}", style="bold", markup=False)
            for note in cut.measured.notes:
                console.print(f"  {note}", markup=False, soft_wrap=True)
    console.print()


def _coefficients(result: Identified) -> Table:
    estimate = result.estimate
    table = _table("coefficient", "value", "unit", "standard error", "95 % interval")
    for i, name in enumerate(NAMES):
        value, half = float(estimate.values[i]), float(estimate.half_widths[i])
        digits = _digits(half if math.isfinite(half) and half > 0.0 else 1e-3 * abs(value))
        interval = (
            f"{value - half:.{digits}f} to {value + half:.{digits}f}" if math.isfinite(value + half) else "unknown"
        )
        error = f"{estimate.errors[i]:.{digits}f}" if math.isfinite(estimate.errors[i]) else "unknown"
        unit = "N/mm²" if name.endswith("c") else "N/mm"
        if not math.isfinite(value):
            table.add_row(name, "not determined", unit, "", "")
        elif estimate.fixed[i]:
            table.add_row(name, f"{value:g}", unit, "given", "")
        else:
            table.add_row(name, f"{value:.{digits}f}", unit, error, interval)
    return table


def _quality(result: Identified) -> str:
    estimate = result.estimate
    r2 = ", ".join(
        f"{axis} {value:.4f}"
        for axis, value in zip(("all", *_AXES), result.r_squared, strict=True)
        if math.isfinite(value)
    )
    lines = [f"R² {r2}; condition number {estimate.condition:.3g}; {estimate.dof} degrees of freedom"]
    if estimate.spread_n is not None:
        lines.append(f"spread between cuts beyond the errors of their means: {estimate.spread_n:.2f} N")
    if (runout := result.runout) is not None:
        half = " and ".join(f"{1000.0 * h:.2f}" for h in runout.half_width_mm)
        lines.append(
            f"runout {1000.0 * runout.size_mm:.2f} µm at {math.degrees(runout.angle_rad):.1f}° from the tip of tooth 0 "
            f"(± {half} µm along and across it)"
        )
    return "\n".join(lines)


def _correlation(result: Identified) -> Table:
    table = _table("", *NAMES)
    for name, row in zip(NAMES, result.estimate.correlation, strict=True):
        table.add_row(name, *(f"{value:+.2f}" if math.isfinite(value) else "-" for value in row))
    return table


def _cuts(cuts: Sequence[CutResult]) -> Table:
    waves = any(cut.phase_rad is not None for cut in cuts)
    headings = [f"{what}{axis}" for axis in _AXES for what in ("F", "Δ")]
    table = _table("cut", *headings, *(["waveform RMS"] if waves else []))
    for cut in cuts:
        numbers = []
        for axis in range(3):
            measured, fitted = float(cut.measured.mean_n[axis]), float(cut.fitted_n[axis])
            numbers += [_newtons(measured), _newtons(measured - fitted, signed=True)]
        error = cut.waveform_error_n()
        name = Text(cut.name + (" (held out)" if cut.held_out else ""), style="italic" if cut.held_out else "")
        table.add_row(name, *numbers, *([_newtons(error) if error is not None else "-"] if waves else []))
    return table


def _logs(cuts: Sequence[CutResult]) -> Table:
    table = _table("cut", "steady cut, s", "spindle, rpm", "zero x, y, z, N", "drift x, y, z, N/s")
    for cut in cuts:
        m = cut.measured
        if m.window_s is None:
            table.add_row(cut.name, "mean force as given", f"{m.rpm:.2f}", "", "")
            continue
        zero, drift = (
            ", ".join(f"{v:+.{d}f}" for v in values) if values is not None and np.any(values) else "none"
            for values, d in ((m.zero_n, 2), (m.drift_n_s, 3))
        )
        table.add_row(cut.name, f"{m.window_s[0]:.3f} to {m.window_s[1]:.3f}", f"{m.rpm:.2f}", zero, drift)
    return table


def _table(*headings: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for i, heading in enumerate(headings):
        table.add_column(heading, justify="left" if i == 0 else "right", no_wrap=i > 0, overflow="fold")
    return table


def _newtons(value: float, *, signed: bool = False) -> str:
    return f"{value:{'+' if signed else ''}.2f}" if math.isfinite(value) else "-"


def _digits(size: float) -> int:
    """Digits after the point that show three figures of a size."""
    return max(0, 2 - math.floor(math.log10(size))) if size > 0.0 else 4
