"""The summary of a run as tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from twin.number_format import clock, column, digits, plural, volume
from twin.run.watch import COLLISION_TEXTS

if TYPE_CHECKING:
    from twin.record import RunHeader, RunSummary, ToolSummary
    from twin.run.watch import CollisionGroup

_MOST_GROUPS = 10
_LONGEST_BLOCK = 76
_Four = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Timing:
    """Computing times."""

    setup_s: float
    wall_s: float


def mean_force(on_tool_n: _Four, force_on: str) -> _Four:
    """Mean force on the requested body; on the workpiece it has the opposite sign."""
    if force_on == "tool":
        return on_tool_n
    x, y, z, resultant = on_tool_n
    return -x, -y, -z, resultant


def print_summary(
    console: Console,
    summary: RunSummary,
    header: RunHeader | None,
    groups: Sequence[CollisionGroup],
    *,
    force_on: str = "tool",
    timing: Timing | None = None,
) -> None:
    """Print a run's summary.

    Args:
        header: names the program.
        groups: its collisions.
        force_on: ``"tool"`` or ``"workpiece"``.
        timing: None for a run that is not being replayed.
    """
    console.print(_title(summary, header))
    console.print(_totals(summary, timing))
    _section(console, "Time and material", _tools(summary))
    if any(tool.cutting_time_s > 0.0 for tool in summary.tools) and summary.samples > 0:
        _section(console, f"Forces on the {force_on}, N", _forces(summary, force_on))
        if summary.top_lines:
            _section(console, "NC lines with the highest force", _top_lines(summary))
    if groups:
        title = f"{plural(summary.collisions, 'collision')}".capitalize()
        _section(console, title, _collisions(groups), style="bold red")
    console.print()


def table(*heads: str, numbers: str = "") -> Table:
    """A table without a frame.

    Args:
        heads: headings of the columns.
        numbers: one letter per column, ``>`` for numbers: they are right-aligned and never wrapped.
    """
    made = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0))
    for head, side in zip(heads, numbers.ljust(len(heads)), strict=True):
        made.add_column(head, justify="right" if side == ">" else "left", no_wrap=side == ">" or not head)
    return made


def _section(console: Console, title: str, body: Table, style: str = "bold") -> None:
    console.print(f"\n{title}", style=style)
    console.print(body)


def _title(summary: RunSummary, header: RunHeader | None) -> Text:
    title = Text()
    title.append(header.program if header is not None else "run", style="bold")
    if not summary.complete:
        planned = f" of {clock(header.planned_time_s)}" if header is not None else ""
        title.append(f"   ended early, at {clock(summary.machine_time_s)}{planned}", style="bold yellow")
    return title


def _totals(summary: RunSummary, timing: Timing | None) -> Table:
    """The main numbers of the run, in two columns."""
    peak, mean = summary.peak_force_n[3], summary.mean_force_n[3]
    computed = summary.samples > 0
    idle_s = max(0.0, summary.machine_time_s - summary.cutting_time_s)
    left = [("machine time", clock(summary.machine_time_s)), ("cutting", clock(summary.cutting_time_s))]
    left.append(("not cutting", clock(idle_s)))
    right = [("removed", volume(summary.removed_volume_mm3))]
    right.append(("peak force", f"{digits(peak)} N" if computed else "not computed"))
    right.append(("mean force", f"{digits(mean)} N" if computed else "not computed"))
    if timing is not None and timing.wall_s > 0.0:
        factor = summary.machine_time_s / timing.wall_s
        left.append(("computed in", f"{clock(timing.wall_s)}  ({digits(factor)}x real time)"))
        right.append(("collisions", str(summary.collisions)))
    grid = Table.grid(padding=(0, 2))
    for _ in range(2):
        grid.add_column(style="dim")
        grid.add_column(min_width=24)
    for (a, b), (c, d) in zip(left, right, strict=False):
        grid.add_row(a, b, c, Text(d, style="bold red" if c == "collisions" and d != "0" else ""))
    return grid


def _name(tool: ToolSummary) -> Text:
    return Text(f"T{tool.number} {tool.description}" if tool.number else tool.description)


def _tools(summary: RunSummary) -> Table:
    heads = ("tool", "cutting", "air", "rapid", "removed, mm³", "removal rate, cm³/min")
    made = table(*heads, numbers=" >>>>>")
    removed = column(tool.removed_volume_mm3 for tool in summary.tools)
    rates = column(_rate_cm3_min(tool) for tool in summary.tools)
    for tool, volume_of, rate in zip(summary.tools, removed, rates, strict=True):
        times = (tool.cutting_time_s, tool.air_time_s, tool.rapid_time_s)
        made.add_row(_name(tool), *map(clock, times), volume_of, rate if tool.cutting_time_s > 0.0 else "")
    return made


def _rate_cm3_min(tool: ToolSummary) -> float:
    return 60e-3 * tool.removed_volume_mm3 / tool.cutting_time_s if tool.cutting_time_s > 0.0 else 0.0


def _forces(summary: RunSummary, force_on: str) -> Table:
    """Two rows per tool: peaks, and means over its cutting time."""
    made = table("tool", "", "Fx", "Fy", "Fz", "resultant", "torque, N·m", "power, W", "at line", numbers="  >>>>>>>")
    tools = [tool for tool in summary.tools if tool.cutting_time_s > 0.0]
    forces = column(f for tool in tools for f in (*tool.peak_force_n, *mean_force(tool.mean_force_n, force_on)))
    torques = column(t for tool in tools for t in (tool.peak_torque_nm, tool.mean_torque_nm))
    powers = column(tool.peak_power_w for tool in tools)
    for i, tool in enumerate(tools):
        peak, mean = forces[8 * i : 8 * i + 4], forces[8 * i + 4 : 8 * i + 8]
        made.add_row(_name(tool), "peak", *peak, torques[2 * i], powers[i], str(tool.peak_line))
        made.add_row("", "mean", *mean, torques[2 * i + 1])
    return made


def _top_lines(summary: RunSummary) -> Table:
    made = table("line", "peak, N", "block", numbers=">>")
    forces = column(force for _, _, force in summary.top_lines)
    for (line, text, _), force in zip(summary.top_lines, forces, strict=True):
        made.add_row(str(line), force, Text(text if len(text) <= _LONGEST_BLOCK else f"{text[: _LONGEST_BLOCK - 1]}…"))
    return made


def _collisions(groups: Sequence[CollisionGroup]) -> Table:
    made = table("line", "tool", "collision", "count", "mm³", "first at", "X", "Y", "Z", numbers=">> >>>>>>")
    shown = groups[:_MOST_GROUPS]
    volumes = column(g.volume_mm3 for g in shown)
    for g, volume_of in zip(shown, volumes, strict=True):
        position = (f"{x:.3f}" for x in g.point_mm)
        made.add_row(
            str(g.nc_line), f"T{g.tool}", COLLISION_TEXTS[g.kind], str(g.count), volume_of, clock(g.t_s), *position
        )
    if len(groups) > _MOST_GROUPS:
        made.add_row("", "", f"and on {plural(len(groups) - _MOST_GROUPS, 'further line')}")
    return made
