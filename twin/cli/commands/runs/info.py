"""``twin info``."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from rich.table import Table

    from twin.archive import RunInfo

_WORKPIECE = "/workpiece/"


def info(
    run: Annotated[Path, typer.Argument(metavar="RUN.mcap", help="Archive of a run.", show_default=False)],
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    verify: Annotated[
        bool, typer.Option("--verify", help="Read every record and check every checksum, not only counts and frames.")
    ] = False,
) -> None:
    """Print the contents of an archive: summary of the run, program, stock, tools, messages, attached files.

    Ends with exit code 1 if the file is damaged. The file of a run that was killed is incomplete, not damaged.
    """
    from twin.archive import run_info
    from twin.errors import ArchiveError

    found = run_info(run, verify=verify)
    _print(found, as_json=as_json, verified=verify)
    if found.damage is not None:
        raise ArchiveError(found.damage)


def _print(found: RunInfo, *, as_json: bool, verified: bool) -> None:
    force_on = found.header.parameters.get("output.force_on", "tool")
    if as_json:
        from twin.cli.console import print_json
        from twin.cli.show.as_json import info_object

        print_json(info_object(found, force_on))
        return
    from twin.cli.console import results
    from twin.cli.show.summary import print_summary

    console = results()
    if found.summary is not None:
        print_summary(console, found.summary, found.header, (), force_on=force_on)
    console.print("The file", style="bold")
    console.print(_file_table(found, verified=verified))


def _file_table(info: RunInfo, *, verified: bool) -> Table:
    """The file itself, one line per item."""
    from rich.table import Table
    from rich.text import Text

    grid = Table.grid(padding=(0, 3))
    grid.add_column(style="dim", no_wrap=True)
    for name, text in _file_lines(info, verified=verified):
        grid.add_row(name, Text(text))
    return grid


def _state(info: RunInfo, *, verified: bool) -> str:
    if info.damage is not None:
        return "damaged: readable up to the damage"
    state = "complete" if info.intact else "incomplete: readable up to its last complete record"
    return f"{state}; every record and checksum verified" if verified else state


def _file_lines(info: RunInfo, *, verified: bool) -> list[tuple[str, str]]:
    from twin.number_format import clock, grouped, size

    header = info.header
    state = _state(info, verified=verified)
    low, high = header.stock_bounds_mm.tolist()
    box = ", ".join(f"{axis} {a:g} to {b:g}" for axis, a, b in zip("XYZ", low, high, strict=True))
    pitch = " x ".join(f"{p:g}" for p in header.slice_pitch_mm)
    return [
        ("name", str(info.path)),
        ("size", f"{size(info.path.stat().st_size)}, {state}"),
        ("program", header.program),
        ("covers", f"{clock(info.duration_s)} of {clock(header.planned_time_s)}"),
        ("stock, mm", f"{box}; slice pitch {pitch}"),
        ("tools", "; ".join(f"T{t.number} {t.description}" for t in header.tools)),
        *((f"messages {topic}", grouped(n)) for topic, n in _topics(info.counts).items()),
        *((f"attached {name}", size(n)) for name, n in info.attachments.items()),
        ("made by", f"twin {header.twin_version}"),
    ]


def _topics(counts: dict[str, int]) -> dict[str, int]:
    """Messages by topic, the patches of the workpiece as one."""
    topics: Counter[str] = Counter()
    for topic, count in sorted(counts.items()):
        topics[f"{_WORKPIECE}*" if topic.startswith(_WORKPIECE) else topic] += count
    return dict(topics)
