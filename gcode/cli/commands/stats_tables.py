"""Program statistics as tables for a machinist."""

from __future__ import annotations

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from gcode.cli.number_format import clock, grouped, joined, plural, short, span
from gcode.report.stats import TYPES, Box, MotionTotals, ProgramStats, ValueSet

#: Most feeds or speeds that are listed one by one.
_MOST_VALUES = 5


def print_stats(console: Console, name: str, stats: ProgramStats) -> None:
    """Print a program's statistics.

    Args:
        name: of the program.
    """
    console.print(Text(name, style="bold"))
    console.print(_totals(stats))
    for title, body in (("Tools", _tools(stats)), ("Motions", _motions(stats)), ("Travel range, mm", _space(stats))):
        if body.row_count:
            console.print(f"\n{title}", style="bold")
            console.print(body)
    if stats.untimed:
        console.print(f"\n{plural(stats.untimed, 'motion')} at a feed of 0: not in the times", style="yellow")
    console.print()


def _table(*heads: str, numbers: str) -> Table:
    """A table without a frame; a ``>`` in `numbers` sets its column to the right."""
    made = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0))
    for head, side in zip(heads, numbers, strict=True):
        made.add_column(head, justify="right" if side == ">" else "left", no_wrap=side == ">")
    return made


def _totals(stats: ProgramStats) -> Table:
    """The program in a few numbers, two columns of them."""
    total = stats.total
    left = (
        ("time", clock(total.time_s)),
        ("cutting", clock(total.cutting_s)),
        (f"rapids at {short(stats.rapid_mm_min)} mm/min", clock(total.rapid_s)),
        ("dwells", clock(total.dwell_s)),
    )
    right = (
        ("travel", f"{grouped(total.travel_mm, 1)} mm"),
        ("cutting", f"{grouped(total.cutting_mm, 1)} mm"),
        ("rapids", f"{grouped(total.rapid_mm, 1)} mm"),
        ("blocks", f"{grouped(stats.blocks)}, {plural(stats.tool_changes, 'tool change')}"),
    )
    grid = Table.grid(padding=(0, 2))
    for _ in range(2):
        grid.add_column(style="dim")
        grid.add_column(min_width=20)
    for (a, b), (c, d) in zip(left, right, strict=True):
        grid.add_row(a, b, c, d)
    return grid


def _tools(stats: ProgramStats) -> Table:
    heads = ("tool", "time", "cutting", "cutting, mm", "rapids, mm", "feeds, mm/min", "speeds, rpm")
    made = _table(*heads, numbers=" >>>>  ")
    for number, sums in stats.tools.items():
        made.add_row(
            f"T{number}" if number else "none",
            clock(sums.time_s),
            clock(sums.cutting_s),
            grouped(sums.cutting_mm, 1),
            grouped(sums.rapid_mm, 1),
            _values(sums.feeds_mm_min),
            _values(sums.speeds_rpm),
        )
    return made


def _values(values: ValueSet | None) -> str:
    if values is None:
        return "none"
    return joined(values.each, _MOST_VALUES) if values.each is not None else span(values.least, values.largest)


def _motions(stats: ProgramStats) -> Table:
    made = _table("tool", *TYPES, numbers=" >>>>>")
    rows = {f"T{number}" if number else "none": sums for number, sums in stats.tools.items()}
    if len(rows) > 1:
        rows["all"] = stats.total
    for name, sums in rows.items():
        made.add_row(name, *_counts(sums))
    return made


def _counts(sums: MotionTotals) -> list[str]:
    return [grouped(sums.motions[name]) if name in sums.motions else "" for name in TYPES]


def _space(stats: ProgramStats) -> Table:
    made = _table("", "X", "Y", "Z", numbers=" >>>")
    for name, found in (("cutting", stats.cutting_box), ("all", stats.box)):
        if found is not None:
            made.add_row(name, *_spans(found))
    return made


def _spans(found: Box) -> list[str]:
    return [f"{low:.3f} to {high:.3f}" for low, high in zip(found.low_mm, found.high_mm, strict=True)]
