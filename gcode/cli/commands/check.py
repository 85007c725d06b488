"""``gcode check``: finds errors in programs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gcode.cli import exit_codes
from gcode.cli.machine_options import Setup, with_machine

if TYPE_CHECKING:
    from gcode.cli.commands.findings import Findings


@with_machine
def check(
    files: Annotated[list[Path], typer.Argument(metavar="FILE", help="NC programs.", show_default=False)],
    as_json: Annotated[
        bool, typer.Option("--json", help="Print each finding as a JSON object on its own line.")
    ] = False,
    notices: Annotated[
        bool,
        typer.Option(
            "--notices", help="Also list notices: words that are understood but cause no motion, and the like."
        ),
    ] = False,
    *,
    setup: Setup,
) -> None:
    """Find errors in programs, as many as possible in one run, each with its line and column."""
    from gcode.cli.commands.findings import findings
    from gcode.cli.console import fail

    codes = {exit_codes.OK}
    for file in files:
        found = findings(file, setup)
        if found.unreadable is not None:
            fail(str(found.unreadable))
            codes.add(exit_codes.ERROR)
            continue
        (_print_json if as_json else _print_text)(found, notices)
        codes.add(exit_codes.ERROR if found.errors else exit_codes.OK)
    raise typer.Exit(max(codes))


def _print_text(found: Findings, notices: bool) -> None:
    from gcode.cli.console import say
    from gcode.cli.number_format import plural

    for error in found.errors:
        say(f"{error.underlined()}\n")
    for group in found.grouped(notices=notices):
        say(group)
    count = plural(len(found.errors), "error")
    warnings = len(found.warnings)
    kinds = ((warnings, "warning"), (len(found.notices) - warnings, "notice"))
    more = "".join(f", {plural(number, kind)}" for number, kind in kinds if number)
    say(f"{found.file}: {count}{more}", colour=typer.colors.RED if found.errors else typer.colors.GREEN)


def _print_json(found: Findings, notices: bool) -> None:
    import json

    from gcode.cli.console import say_json

    for made in found.objects(notices=notices):
        say_json(json.dumps(made))
