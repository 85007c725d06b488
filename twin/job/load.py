"""Job files in: read, check everything, and say every mistake at once."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from twin.errors import JobError
from twin.job.facts import Facts
from twin.job.model import Job, JobFile
from twin.job.problems import Location, Problem, problems_of
from twin.job.rules import RULES
from twin.job.toml_text import toml_text

_FILES: tuple[tuple[str, str], ...] = (
    *(("program", "file"), ("stock", "stl"), ("output", "mcap"), ("output", "rrd")),
    ("measured", "file"),
)
_TOML_PLACE = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")


def load_job(path: str | PathLike[str]) -> Job:
    """Read a job file.

    Raises:
        JobError: the file cannot be read, is no TOML, or has mistakes: all of them are in the message.
    """
    path = Path(path)
    data, text = read_toml(path)
    return _job(data, path, text)


def read_toml(path: Path, what: str = "a job file", refuse: type[JobError] = JobError) -> tuple[dict[str, Any], str]:
    """A TOML file's tables and its text.

    Args:
        what: what the file should be, for the message.
        refuse: the error for a file that cannot be read.

    Raises:
        JobError: ``refuse``, with the place of what is no TOML.
    """
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise refuse(str(path), [f"cannot be read: {why}; expected {what} (TOML)"]) from error
    except UnicodeDecodeError as error:
        raise refuse(str(path), [f"byte {error.start} is not UTF-8; expected {what} (TOML)"]) from error
    try:
        return tomllib.loads(text), text
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(path, text, str(error), refuse) from error


def job_from_dict(data: Mapping[str, Any], folder: str | PathLike[str] = ".") -> Job:
    """Make a job from tables as `tomllib` gives them; its text is written from them.

    Args:
        folder: what the files in it are relative to.

    Raises:
        JobError: see `load_job`.
    """
    return _job(data, Path(folder) / "job.toml", toml_text(data))


def _syntax_error(path: Path, text: str, message: str, refuse: type[JobError]) -> JobError:
    """TOML's complaint with the place in front."""
    lines = text.splitlines() or [""]
    place = _TOML_PLACE.search(message)
    line, column = (len(lines), len(lines[-1]) + 1) if place is None or place[1] is None else map(int, place.groups())
    what = _TOML_PLACE.sub("", message)
    return refuse(f"{path}:{line}:{column}", [f"no valid TOML: {what[:1].lower()}{what[1:]}"])


def _job(data: Mapping[str, Any], path: Path, text: str) -> Job:
    problems: list[Problem] = []
    try:
        JobFile.model_validate(data)
    except ValidationError as error:
        problems += problems_of(error.errors(include_url=False), JobFile)
    facts = Facts(data, [p.location for p in problems], _default)
    problems = [_with_tool(p, facts) for p in problems]
    problems += [problem for rule in RULES for problem in rule(facts, path.parent)]
    if problems:
        raise JobError(str(path), [str(p) for p in problems])
    return Job.model_validate({**_joined(data, path.parent), "path": path, "text": text})


def _with_tool(problem: Problem, facts: Facts) -> Problem:
    """Say the tool's number where a mistake is in a tool's table."""
    if problem.location[:1] != ("tools",) or len(problem.location) < 3 or problem.location[2] == "number":
        return problem
    return Problem(problem.location, problem.text, facts.get("tools", problem.location[1], "number"))


def _default(location: Location) -> Any:
    """Value of a key that is not given; None where it has no default."""
    table: type[BaseModel] = JobFile
    for key in location[:-1]:
        annotation = table.model_fields[str(key)].annotation if key in table.model_fields else None
        if not isinstance(annotation, type) or not issubclass(annotation, BaseModel):
            return None
        table = annotation
    field = table.model_fields.get(str(location[-1]))
    return None if field is None or field.is_required() else field.default


def _joined(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The data with its files' paths joined to the folder."""
    joined: dict[str, Any] = dict(data)
    for table, key in _FILES:
        name = joined.get(table, {}).get(key)
        if name is not None:
            joined[table] = {**joined[table], key: folder / name}
    program = joined.get("program", {})
    if "search_path" in program:
        joined["program"] = {**program, "search_path": [folder / name for name in program["search_path"]]}
    return joined
