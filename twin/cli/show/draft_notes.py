"""Assumptions, warnings and the estimate of a drafted job, for the terminal and as JSON."""

from __future__ import annotations

import json
from typing import Any

from rich.text import Text

from twin.cli.console import errors, results, warn
from twin.drafting.draft import JobDraft
from twin.drafting.update import Written


def print_notes(draft: JobDraft, *, quiet: bool) -> None:
    """Print what the program's comments state, assumptions, contradictions, open values and the estimate."""
    console = errors()
    if not quiet:
        if draft.stated:
            console.print(Text.assemble(("stated:", "bold"), " ", ", ".join(draft.stated)))
        for line in draft.assumed:
            console.print(Text.assemble(("assumed:", "bold"), " ", line))
    for line in (*draft.warnings, *draft.open):
        warn(line)
    if not quiet:
        console.print(Text.assemble(("estimate:", "bold"), " ", str(draft.estimate)))


def print_written(written: Written, *, quiet: bool) -> None:
    """Print what became of the job file."""
    console = results()
    for line in written.kept:
        warn(f"{written.path} keeps {line}")
    if quiet:
        return
    if written.new:
        text = f"Job file   {written.path}"
    elif written.added:
        text = f"Job file   {written.path}: added {', '.join(written.added)}"
    else:
        text = f"Job file   {written.path}: unchanged, it has all tables and tools"
    console.print(text, markup=False, soft_wrap=True)


def draft_json(draft: JobDraft, written: Written | None) -> str:
    """The draft as one JSON object."""
    value: dict[str, Any] = {
        "job": None if written is None else str(written.path),
        "stated": list(draft.stated),
        "assumptions": assumption_objects(draft),
        "warnings": list(draft.warnings),
        "open": list(draft.open),
        "estimate": draft.estimate.as_dict(),
        "tables": [
            {"table": t.name, **{e.key: e.value for e in t.entries if e.value is not None}} for t in draft.tables
        ],
    }
    if written is not None:
        value |= {"added": list(written.added), "kept": list(written.kept)}
    return json.dumps(value, indent=2, ensure_ascii=False)


def assumption_objects(draft: JobDraft) -> list[dict[str, str]]:
    """The assumptions as objects."""
    return [{"subject": a.subject, "value": a.value, "reason": a.reason} for a in draft.assumptions]
