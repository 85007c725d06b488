"""A drafted job into a file: a new one, or the missing tables of one that exists, whose own values stay."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from twin.archive.container.partial import replacing
from twin.drafting.draft import JobDraft
from twin.drafting.tables import DraftTable
from twin.errors import JobError, TwinError
from twin.job import job_from_text
from twin.settings.toml_file import read_toml
from twin.settings.toml_text import toml_value

#: Keys that a tool may have from a library instead.
_FROM_ELSEWHERE = frozenset({"name", "origin"})
_REPLACE = "replace the file with --force"


@dataclass(frozen=True, slots=True, kw_only=True)
class Written:
    """A job file after a draft was written to it.

    Attributes:
        path: the file.
        new: it did not exist, or was replaced.
        added: tables that were added to a file that exists.
        kept: values of the file that differ from the draft's, and stay; keys that it lacks.
    """

    path: Path
    new: bool
    added: tuple[str, ...] = ()
    kept: tuple[str, ...] = ()


def write_draft(draft: JobDraft, *, force: bool = False) -> Written:
    """Write a draft to its file.

    A file that exists is not rewritten: every line of it stays. Tables that it lacks, and tools whose numbers it does
    not have, are added at its end; values that differ from the draft's are reported, and the file's count.

    Args:
        force: replace a file that exists.

    Raises:
        JobError: the file is not a job file, or is the job of another program.
        TwinError: the file cannot be written.
    """
    path = draft.path
    if force or not path.exists():
        _write(path, draft.toml_text())
        return Written(path=path, new=True)
    data, text = read_toml(path, "a job file", JobError, own="program")
    _refuse_other_program(draft, data)
    missing = list(_missing(draft, data))
    if missing:
        more = "\n\n".join("\n".join(table.lines()) for table in missing)
        text = f"{text.rstrip()}\n\n# added from {_program_name(draft)}\n{more}\n"
        _check(text, path)
        _write(path, text)
    return Written(path=path, new=False, added=tuple(map(_title, missing)), kept=tuple(_kept(draft, data)))


def _write(path: Path, text: str) -> None:
    with replacing(path, TwinError) as partial:
        partial.write_text(text, encoding="utf-8")


def _check(text: str, path: Path) -> None:
    try:
        job_from_text(text, path)
    except tomllib.TOMLDecodeError:
        raise JobError(str(path), [f"tables cannot be added to it as it is written; {_REPLACE}"]) from None


def _program_name(draft: JobDraft) -> str:
    return str(draft.tables[0].get("file"))


def _refuse_other_program(draft: JobDraft, data: Mapping[str, Any]) -> None:
    program = data.get("program")
    own = program.get("file") if isinstance(program, Mapping) else None
    folder = draft.path.parent
    wanted = _program_name(draft)
    if isinstance(own, str) and os.path.realpath(folder / own) != os.path.realpath(folder / wanted):
        raise JobError(str(draft.path), [f"is the job of {own}; expected one of {wanted}, or {_REPLACE}"])


def _missing(draft: JobDraft, data: Mapping[str, Any]) -> Iterator[DraftTable]:
    numbers = set(_by_number(data))
    for table in draft.tables:
        if table.listed:
            if table.get("number") not in numbers:
                yield table
        elif table.name not in data and any(entry.value is not None for entry in table.entries):
            yield table


def _by_number(data: Mapping[str, Any]) -> dict[Any, Mapping[str, Any]]:
    tools = data.get("tools")
    listed = tools if isinstance(tools, list) else []
    return {tool.get("number"): tool for tool in listed if isinstance(tool, Mapping)}


def _kept(draft: JobDraft, data: Mapping[str, Any]) -> Iterator[str]:
    """Values of the file that differ from the draft's, and keys that its tables lack."""
    tools = _by_number(data)
    for table in draft.tables:
        own = tools.get(table.get("number")) if table.listed else data.get(table.name)
        if not isinstance(own, Mapping):
            continue
        for entry in table.entries:
            if entry.value is None or own.get(entry.key) == entry.value:
                continue
            drafted = toml_value(entry.value)
            if entry.key in own:
                yield f"{_title(table)}: {entry.key} = {toml_value(own[entry.key])} (drafted: {drafted})"
            elif entry.key not in _FROM_ELSEWHERE:
                yield f"{_title(table)} without {entry.key} (drafted: {drafted})"


def _title(table: DraftTable) -> str:
    return f"T{table.get('number')}" if table.listed else f"[{table.name}]"
