"""``twin job``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from twin.cli.common import Json
from twin.cli.options import options_from, settings_from
from twin.drafting.settings import DraftSettings


@options_from(DraftSettings, "given", panel="Job")
def job(
    program: Annotated[Path, typer.Argument(metavar="PART.nc", help="NC program.", show_default=False)],
    given: Mapping[str, Any],
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="FILE", help="Job file to write, else printed.", show_default=False),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace a job file that exists, in place of adding what it lacks.")
    ] = False,
    as_json: Json = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Print no assumptions and no estimate, only warnings and errors.")
    ] = False,
) -> None:
    """Draft a job file from an NC program: tools from its comments, stock from its motions, resolution to suit them.

    Every value that the program does not state is printed as assumed, and has a comment in the file. A job file that
    exists keeps all its lines: tables and tools that it lacks are added, and values that differ are reported.
    """
    from twin.cli.console import say, say_json
    from twin.cli.show.draft_notes import draft_json, print_notes, print_written
    from twin.drafting.draft import draft_job
    from twin.drafting.update import write_draft

    settings = settings_from(DraftSettings, given, {}, "twin job", "twin job")
    draft = draft_job(program, settings, path=out)
    draft.job()
    written = None if out is None else write_draft(draft, force=force)
    print_notes(draft, quiet=quiet or as_json)
    if as_json:
        say_json(draft_json(draft, written))
    elif written is not None:
        print_written(written, quiet=quiet)
    else:
        say(draft.toml_text().removesuffix("\n"))
