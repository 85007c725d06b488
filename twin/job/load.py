"""Job files: read, check everything, and report every mistake at once."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from twin.errors import JobError
from twin.job.job_file import Job, JobFile
from twin.job.library import with_library_tools
from twin.job.material import with_materials
from twin.job.rules import RULES
from twin.settings.facts import Facts
from twin.settings.problems import Problem, problems_of
from twin.settings.toml_file import read_toml
from twin.settings.toml_text import toml_text

_FILES: tuple[tuple[str, str], ...] = (
    *(("program", "file"), ("stock", "stl"), ("output", "mcap"), ("output", "rrd")),
    ("measured", "file"),
)


def load_job(path: str | PathLike[str]) -> Job:
    """Read and check a job file.

    Args:
        path: the file (TOML).

    Raises:
        JobError: the file cannot be read, is not TOML, or has mistakes; the message has every one.
    """
    path = Path(path)
    data, text = read_toml(path, "a job file", JobError, own="program")
    return _job(data, path, text)


def job_from_dict(data: Mapping[str, Any], folder: str | PathLike[str] = ".") -> Job:
    """Make a job from tables, as `tomllib` reads them from a job file.

    Args:
        data: the tables by name.
        folder: folder to which paths of files are relative.

    Raises:
        JobError: see `load_job`.
    """
    return _job(data, Path(folder) / "job.toml", toml_text(data))


def job_from_text(text: str, path: str | PathLike[str]) -> Job:
    """Make a job from the text of a job file that need not exist.

    Args:
        text: TOML.
        path: the file, to whose folder paths of files are relative.

    Raises:
        JobError: see `load_job`.
    """
    return _job(tomllib.loads(text), Path(path), text)


def _job(data: Mapping[str, Any], path: Path, text: str) -> Job:
    data, problems = with_library_tools(data, path.parent)
    data, unknown = with_materials(data)
    problems += unknown
    try:
        JobFile.model_validate(data)
    except ValidationError as error:
        problems += problems_of(error.errors(include_url=False), JobFile)
    facts = Facts(data, [p.location for p in problems], JobFile)
    problems = [_with_tool(p, facts) for p in problems]
    problems += [problem for rule in RULES for problem in rule(facts, path.parent)]
    if problems:
        raise JobError(str(path), [str(p) for p in problems])
    return Job.model_validate({**_joined(data, path.parent), "path": path, "text": text})


def _with_tool(problem: Problem, facts: Facts) -> Problem:
    """The problem with the tool's number where it is in a tool's table."""
    if problem.location[:1] != ("tools",) or len(problem.location) < 3 or problem.location[2] == "number":
        return problem
    return Problem(problem.location, problem.text, facts.get("tools", problem.location[1], "number"))


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
