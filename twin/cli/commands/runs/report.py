"""``twin report``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from twin.cli.common import Force


def report(
    run: Annotated[Path, typer.Argument(metavar="RUN.mcap", help="Archive of a run.", show_default=False)],
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="FILE.html", help="Page to write; the run's name with .html if not given."),
    ] = None,
    force: Force = False,
) -> None:
    """Write a page about a run: summary, forces by tool and line, worst positions, collisions, warnings.

    The page also has assumptions and all settings. It is one file with its pictures inside, for printing too.
    """
    from twin.cli.console import results
    from twin.cli.early_end import warn_of_early_end
    from twin.report.page import write_run_report
    from twin.run.run import Run

    written = write_run_report(Run(run), out if out is not None else run.with_suffix(".html"), force=force)
    warn_of_early_end(run)
    results().print(f"report written to {written}", markup=False, soft_wrap=True)
