"""``twin schema``."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeAlias

import typer
from pydantic import BaseModel

File: TypeAlias = Literal["job", "cuts", "mold", "paths", "reach", "verify"]


def schema(
    file: Annotated[
        File, typer.Argument(help="File to describe: a job, test cuts, a mold job, or the settings of a command.")
    ] = "job",
) -> None:
    """Print the JSON Schema of a job file or settings file, for editors that complete and check TOML."""
    from twin.cli.console import print_json

    print_json(_schema(file))


def _schema(file: File) -> dict[str, Any]:
    from twin.identification.cuts.cuts_file import CutsFile
    from twin.moldmaking.model import MoldFile
    from twin.planning.settings import PathSettings, ReachSettings
    from twin.settings.json_schema import toml_schema
    from twin.verification.settings import VerifySettings

    if file == "job":
        from twin.job import job_schema

        return job_schema()
    models: dict[str, tuple[type[BaseModel], str]] = {
        "cuts": (CutsFile, "Test cuts of a machining twin"),
        "mold": (MoldFile, "Mold job of a machining twin"),
        "paths": (PathSettings, "Settings of twin paths"),
        "reach": (ReachSettings, "Settings of twin reach"),
        "verify": (VerifySettings, "Settings of twin verify"),
    }
    return toml_schema(*models[file])
