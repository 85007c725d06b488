"""``gcode stats``: prints statistics of a program."""

from __future__ import annotations

from typing import Annotated

import typer

from gcode.cli.machine_options import ProgramFile, Setup, with_machine

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
    from gcode.cli.console import results, say_json, with_progress
    from gcode.flow.interpreter import run
    from gcode.report.stats import program_stats

    events = run(file, dialect=setup.dialect, settings=setup.settings)
    found = program_stats(with_progress(events, file.name), rapid_mm_min)
    if as_json:
        import json

        from gcode.report.stats_json import stats_object

        say_json(json.dumps({"file": str(file), **stats_object(found)}, indent=2))
    else:
        from gcode.cli.commands.stats_tables import print_stats

        print_stats(results(), file.name, found)
