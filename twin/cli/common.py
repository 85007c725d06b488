"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypeAlias

import typer

Part: TypeAlias = Annotated[
    Path,
    typer.Argument(metavar="PART.stl", help="The part, a closed solid; mm unless --unit is given.", show_default=False),
]
SettingsFile: TypeAlias = Annotated[
    Path | None, typer.Option("--settings", metavar="FILE", help="TOML file with any of the parameters below.")
]
Picture: TypeAlias = Annotated[
    Path | None, typer.Option("--plot", metavar="FILE", help="Draw the result as .png, .svg or .pdf.")
]
Recording: TypeAlias = Annotated[
    Path | None, typer.Option("--rrd", metavar="FILE", help="Write the result as a rerun recording.")
]
Force: TypeAlias = Annotated[bool, typer.Option("--force", help="Replace files that exist.")]
Json: TypeAlias = Annotated[bool, typer.Option("--json", help="Print one JSON object in place of the tables.")]
Quiet: TypeAlias = Annotated[
    bool, typer.Option("--quiet", "-q", help="Print no progress and no tables, only warnings and errors.")
]
