"""The report of a run: one HTML file that needs no other, and prints well."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from twin.archive.container.partial import PartialFile
from twin.errors import ArchiveError
from twin.number_format import clock, column, digits, grouped, plural, volume
from twin.pages.page import page
from twin.record import RunHeader
from twin.report import pictures
from twin.report.contents import ReportContents, WorstPosition, report_contents
from twin.run.run import Run
from twin.run.watch import COLLISION_TEXTS

SUFFIX = ".html"
_MOST_LINES = 15
_MOST_GROUPS = 25
_NUMBER = re.compile(r"^number\s*=\s*(\d+)")
#: A value of a job file with the comment that it was assumed.
_ASSUMED = re.compile(r"^(?P<value>[^#]*?)\s*#\s*assumed:?\s*(?P<reason>.*)$")
_TABLE = re.compile(r"^\[+(?P<name>[^\[\]]+)\]+\s*(?:#.*)?$")
#: Limits of every run, in the order of their likely effect.
_MODEL = (
    "Tool, spindle, workpiece and fixture are rigid: no deflection, no vibration, no chatter.",
    "The tool moves at the programmed feed: acceleration and the control's corner rounding are not modelled.",
    "The tool is sharp, and the same along its edges; wear, temperature and built-up edge are not modelled.",
    "Forces are as good as the coefficients, which hold for their material, tool and range of chip thickness only.",
)


def write_run_report(run: Run, out: str | PathLike[str], *, force: bool = False) -> Path:
    """Write the report of a run: one HTML page with its pictures inside.

    It opens with a verdict, and has the machined part with the path coloured by force, forces and engagement by tool,
    over machine time and by NC line, the positions with the highest force, collisions, warnings, assumptions, settings.

    Args:
        run: a replayed or opened run.
        out: file that ends in ``.html``.
        force: replace a file that exists.

    Returns:
        The file's path.

    Raises:
        ArchiveError: a wrong suffix, a file that exists or cannot be written, or a damaged archive.

    Examples:
        >>> twin.write_run_report(twin.open_run("slot.mcap"), "slot.html")
    """
    path = Path(out)
    if path.suffix.lower() != SUFFIX:
        raise ArchiveError(f"{path}: expected a file name that ends in {SUFFIX}")
    if path.exists() and not force:
        raise ArchiveError(f"{path}: already exists; replace it with --force")
    text = report_html(report_contents(run))
    partial = PartialFile(path, force=force)
    partial.write(text.encode())
    partial.commit()
    return path


def report_html(contents: ReportContents) -> str:
    """The page's text, with its pictures."""
    part = contents.run.mesh()
    drawn = {"overview": pictures.overview(contents, part), "time": pictures.over_time(contents)}
    for number, worst in enumerate(contents.worst, 1):
        drawn[f"worst_{number}"] = pictures.position(contents, worst, part)
    summary, header = contents.summary, contents.header
    return page(
        "twin.report",
        "report.html.j2",
        drawn,
        {"clock": clock, "digits": digits, "grouped": grouped, "volume": volume},
        title=f"{header.program}: replay",
        subtitle=_subtitle(contents),
        verdict=_verdict(contents),
        warnings=_warnings(contents),
        summary=summary,
        forces=summary.samples > 0,
        tools=_tools(contents),
        lines=_lines(contents),
        omitted_lines=max(len(contents.lines) - _MOST_LINES, 0),
        worst=[_position(k, w, contents) for k, w in enumerate(contents.worst, 1)],
        collisions=[(g, COLLISION_TEXTS[g.kind]) for g in contents.collisions[:_MOST_GROUPS]],
        omitted_collisions=max(len(contents.collisions) - _MOST_GROUPS, 0),
        assumed=list(assumed_values(header)),
        model=_MODEL,
        settings=_settings(header),
    )


def assumed_values(header: RunHeader) -> Iterator[tuple[str, str]]:
    """Values of the attached job file with a comment ``# assumed: reason``, as key path and reason."""
    for attachment in header.attachments:
        if not attachment.name.lower().endswith(".toml"):
            continue
        table = ""
        above: list[str] = []
        for line in map(str.strip, attachment.data.decode("utf-8", "replace").splitlines()):
            heading, number = _TABLE.match(line), _NUMBER.match(line)
            if heading:
                table = heading["name"].strip()
                yield from ((table, reason) for reason in above)
                above = []
            elif number and table == "tools":
                table = f"T{number[1]}"
            found = _ASSUMED.match(line)
            if found and not found["value"].strip():
                above.append(found["reason"].strip())  # of the table that begins below
            elif found:
                yield f"{table}: {found['value'].strip()}".strip(": "), found["reason"].strip()


def _subtitle(contents: ReportContents) -> str:
    header = contents.header
    low, high = header.stock_bounds_mm.tolist()
    stock = " × ".join(f"{b - a:.6g}" for a, b in zip(low, high, strict=True))
    material = header.parameters.get("cutting.material")
    parts = [f"stock {stock} mm", plural(len(header.tools), "tool"), f"slice pitch {max(header.slice_pitch_mm):.3g} mm"]
    if material:
        parts.insert(0, material)
    return " · ".join([*parts, f"twin {header.twin_version}"])


def _verdict(contents: ReportContents) -> str:
    """How much was replayed, the largest values and where, collisions, warnings."""
    summary = contents.summary
    if contents.run.complete:
        extent = f"The whole program was replayed: {clock(summary.machine_time_s)} of machine time"
    else:
        planned = clock(contents.header.planned_time_s)
        extent = f"The run ended early, at {clock(summary.machine_time_s)} of {planned} of machine time"
    text = f"{extent}, {clock(summary.cutting_time_s)} in cut, {volume(summary.removed_volume_mm3)} removed."
    if contents.worst:
        first = contents.worst[0].forces
        power = max(t.peak_power_w for t in summary.tools)
        text += f" Largest force {digits(first.peak_n)} N, at line {first.nc_line} with T{first.tool}; "
        text += f"largest power {digits(power)} W."
    elif summary.samples == 0:
        text += " Forces were not computed."
    count = summary.collisions
    text += f" {plural(count, 'collision').capitalize()}." if count else " No collisions."
    return text


def _warnings(contents: ReportContents) -> list[str]:
    early = [] if contents.run.intact else ["the archive is incomplete: this report covers what it holds"]
    return [*early, *contents.warnings]


def _tools(contents: ReportContents) -> list[dict[str, Any]]:
    tools = []
    for tool in contents.summary.tools:
        lines = [line for line in contents.lines if line.tool == tool.number]
        tools.append(
            {
                "sums": tool,
                "name": f"T{tool.number} {tool.description}" if tool.number else tool.description,
                "peak": column(tool.peak_force_n),
                "mean": column(tool.mean_force_n),
                "axial": max((line.axial_depth_mm for line in lines), default=0.0),
                "radial": max((line.radial_width_mm for line in lines), default=0.0),
                "chip": max((line.chip_thickness_mm for line in lines), default=0.0),
            }
        )
    return tools


def _lines(contents: ReportContents) -> list[dict[str, Any]]:
    shown = contents.lines[:_MOST_LINES]
    peaks = column(max(line.peak_n, 0.0) for line in shown)
    return [
        {"forces": line, "peak": peak, "block": contents.blocks.get(line.nc_line, "")}
        for line, peak in zip(shown, peaks, strict=True)
    ]


def _position(number: int, worst: WorstPosition, contents: ReportContents) -> dict[str, Any]:
    forces = worst.forces
    x, y, z = forces.point_mm
    caption = (
        f"{number}. {digits(forces.peak_n)} N at {clock(forces.t_s)}, X{x:.3f} Y{y:.3f} Z{z:.3f}, T{forces.tool}, "
        f"F{forces.feed_mm_min:g} S{abs(forces.spindle_rpm):g}; on this line at most {forces.axial_depth_mm:.2f} mm "
        f"axial, {forces.radial_width_mm:.2f} mm radial depth of cut, chip {forces.chip_thickness_mm:.3g} mm. "
        "Left: the finished part from above, the tool's circle at the peak."
    )
    block = contents.blocks.get(forces.nc_line, "")
    return {"name": f"worst_{number}", "caption": caption, "line": forces.nc_line, "block": block}


def _settings(header: RunHeader) -> Mapping[str, str]:
    return dict(sorted(header.parameters.items()))
