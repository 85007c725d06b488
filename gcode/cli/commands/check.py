"""``gcode check``: finds errors in programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gcode.cli.machine_options import with_machine
from gcode.cli.setup import Setup


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
    from gcode.cli.tasks import print_findings

    raise typer.Exit(print_findings(files, setup, as_json=as_json, notices=notices))
