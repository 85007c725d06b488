"""``twin schema``."""

from __future__ import annotations

import json


def schema() -> None:
    """Print the JSON Schema of the job file, for editors that complete and check TOML."""
    import typer

    from twin.job import job_schema

    typer.echo(json.dumps(job_schema(), indent=2, ensure_ascii=False))
