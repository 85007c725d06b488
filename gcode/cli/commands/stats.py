"""``gcode stats``: prints statistics of a program."""

from __future__ import annotations

from typing import Annotated

import typer

from gcode.cli.machine_options import ProgramFile, with_machine
from gcode.cli.setup import Setup

#: Rates of rapids, mm/min.
_SLOWEST, _FASTEST = 0.001, 1e9


def _rate(value: float) -> float:
    if not _SLOWEST <= value <= _FASTEST:
        raise typer.BadParameter(f"{value} is not a rate; expected {_SLOWEST:g} to {_FASTEST:g}")
    return value


@with_machine
def stats(
    file: ProgramFile,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    rapid_mm_min: Annotated[
        float,
        typer.Option("--rapid-mm-min", metavar="MM_MIN", callback=_rate, help="Rapid rate along the path, mm/min."),
    ] = 10_000.0,
    *,
    setup: Setup,
) -> None:
    """Print statistics of a program: lengths, times, travel range, feeds and speeds of each tool.

    Times include feed motions, dwells, and rapids at the given rate; acceleration and tool changes are ignored.
    """
    from gcode.cli.tasks import print_stats

    print_stats(file, setup, rapid_mm_min, as_json=as_json)
