"""A comparison as tables on the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table
from rich.text import Text

from twin.cli.show.summary import table
from twin.comparison.verdict import verdict
from twin.number_format import column, digits

if TYPE_CHECKING:
    from twin.comparison.batch import Row
    from twin.comparison.comparison import Comparison, WindowResult
    from twin.comparison.metrics import AxisErrors

_MOST_LINES = 3


def print_comparison(console: Console, found: Comparison) -> None:
    """Print the verdict, the corrections, the errors as in the tri-slice paper's Table 6, and further errors."""
    title = Text(found.run.path.name, style="bold")
    title.append(f"  against  {found.log.source.name}", style="bold")
    console.print(title)
    console.print(Text(verdict(found)))
    _section(console, "Corrections of the log", _corrections(found))
    _section(console, "Errors of the simulated force on the tool, N", _errors(found))
    _section(console, "Further errors, N", _details(found))
    if any(w.lines for w in found.windows):
        _section(console, "Harmonics, amplitudes in N", _harmonics(found))
    console.print()


def window_name(window: WindowResult, *, short: bool = False) -> str:
    """``4.00–4.02 s``, with a mark if it is the whole overlap; ``4.00–4.02`` if short."""
    begin, end = window.span_s
    decimals = 3 if end - begin < 1.0 and (round(1e3 * begin) % 10 or round(1e3 * end) % 10) else 2
    text = f"{begin:.{decimals}f}–{end:.{decimals}f}"
    return text if short else f"{text} s{' (whole)' if window.whole else ''}"


def print_batch(console: Console, rows: Sequence[Row]) -> None:
    """Print one line for each row and window of a batch."""
    made = table("row", "name", "window", "Fx", "Fy", "Fz", "Fx", "Fy", "Fz", "correlation", numbers=">  >>>>>>>")
    for row in rows:
        if row.found is None:
            made.add_row(str(row.number), Text(row.name), Text("failed", style="bold red"))
            continue
        for window in row.found.windows:
            values = [_of(window, axis) for axis in "xyz"]
            texts = [digits(e.mean_abs_n) if e else "" for e in values] + [digits(e.max_n) if e else "" for e in values]
            made.add_row(str(row.number), Text(row.name), window_name(window), *texts, f"{row.found.score:.3f}")
    _section(console, "Errors, N: mean of x, y, z; then maximum of x, y, z", made)
    console.print()


def _section(console: Console, title: str, body: Table) -> None:
    console.print(f"\n{title}", style="bold")
    console.print(body)


def _corrections(found: Comparison) -> Table:
    grid = Table.grid(padding=(0, 2))
    grid.add_column(style="dim", no_wrap=True)
    for note in found.log.notes:
        grid.add_row("read", Text(note))
    for each in found.corrections:
        grid.add_row(each.kind, Text(each.text))
    if found.speed is not None:
        grid.add_row(
            "spindle", Text(f"{found.speed.rpm:.1f} rpm measured from its {found.speed.source}, as a check only")
        )
    return grid


def _of(window: WindowResult, axis: str) -> AxisErrors | None:
    return next((e for e in window.errors if e.axis == axis), None)


def _errors(found: Comparison) -> Table:
    """The columns of the tri-slice paper's Table 6."""
    made = table("window", "mean Fx", "Fy", "Fz", "maximum Fx", "Fy", "Fz", numbers=" >>>>>>")
    for window in found.windows:
        errors = [_of(window, axis) for axis in "xyz"]
        means = [f"{e.mean_abs_n:.2f}" if e else "" for e in errors]
        made.add_row(window_name(window), *means, *(f"{e.max_n:.2f}" if e else "" for e in errors))
    return made


def _details(found: Comparison) -> Table:
    heads = (
        "window, s",
        "",
        "RMS",
        "bias",
        "RMS/RMS",
        "RMS/peak",
        "mean",
        "simul.",
        "ratio",
        "peak",
        "simul.",
        "ratio",
        "corr.",
    )
    made = table(*heads, numbers="  >>>>>>>>>>>")
    for window in found.windows:
        for index, e in enumerate(window.errors):
            means, peaks = (
                column((e.measured_mean_n, e.simulated_mean_n)),
                column((e.measured_peak_n, e.simulated_peak_n)),
            )
            made.add_row(
                window_name(window, short=True) if not index else "",
                f"F{e.axis}" if e.axis in "xyz" else "F",
                digits(e.rms_n),
                digits(e.bias_n),
                percent(e.rms_by_rms),
                percent(e.rms_by_peak),
                *means,
                number(e.ratio_of_means),
                *peaks,
                number(e.ratio_of_peaks),
                number(e.correlation, 3),
            )
    return made


def _harmonics(found: Comparison) -> Table:
    """Measured and simulated amplitude at the first multiples of the tooth-passing frequency, and between them."""
    heads = ("window, s", "Hz", "tooth", *(f"F{a} {what}" for a in found.log.axes for what in ("meas.", "simul.")))
    made = table(*heads, numbers=" >>" + ">>" * len(found.log.axes))
    for window in found.windows:
        orders = sorted({e.order for e in window.lines if (e.tooth_order or 1) <= _MOST_LINES})
        for index, order in enumerate(orders):
            found_lines = [e for e in window.lines if e.order == order]
            tooth = found_lines[0].tooth_order
            cells = [digits(v) for e in found_lines for v in (e.measured_n, e.simulated_n)]
            name = window_name(window, short=True) if not index else ""
            made.add_row(name, f"{found_lines[0].hz:.1f}", f"{tooth}x" if tooth else "runout", *cells)
    return made


def percent(value: float | None) -> str:
    """``4.2 %``."""
    return "–" if value is None else f"{100.0 * value:.1f} %"


def number(value: float | None, decimals: int = 2) -> str:
    """A ratio; a dash where there is none."""
    return "–" if value is None else f"{value:.{decimals}f}"
