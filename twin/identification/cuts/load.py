"""Files of test cuts: read, check everything, and report every mistake at once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from twin.errors import CutsError
from twin.identification.cuts.cuts_file import Cuts, CutsFile
from twin.identification.cuts.rules import RULES
from twin.job.library import with_library_tools
from twin.settings.facts import Facts
from twin.settings.problems import Problem, problems_of, wrong
from twin.settings.toml_file import read_toml

#: What `load_cuts` changes in ``[fit]`` unless more is given.
NOTHING: Mapping[str, Any] = {}
#: Keys whose default stands for "as the cuts need it".
_NO_DEFAULT = (("tool", "flute_length_mm"),)


def load_cuts(path: str | PathLike[str], fit: Mapping[str, Any] = NOTHING) -> Cuts:
    """Read a file of test cuts.

    Args:
        fit: keys in place of those in the file's ``[fit]``; cuts in ``holdout`` are added to those of the file.

    Raises:
        CutsError: the file cannot be read, is not TOML, or has mistakes: all of them are in the message.
    """
    path = Path(path)
    data, _ = read_toml(path, "a file of test cuts", CutsError, own="cuts")
    return cuts_from_dict(data, path, fit)


def cuts_from_dict(data: Mapping[str, Any], path: str | PathLike[str], fit: Mapping[str, Any] = NOTHING) -> Cuts:
    """Make test cuts from tables as `tomllib` gives them.

    Args:
        path: the file; its folder is the base of relative file names.
        fit: see `load_cuts`.

    Raises:
        CutsError: see `load_cuts`.
    """
    path = Path(path)
    data = {**data, "fit": _merged(data.get("fit", {}), fit)}
    data, problems = with_library_tools(data, path.parent)
    try:
        CutsFile.model_validate(data)
    except ValidationError as error:
        problems += problems_of(error.errors(include_url=False), CutsFile)
    facts = Facts(data, [p.location for p in problems], CutsFile, _NO_DEFAULT)
    problems += [problem for rule in RULES for problem in rule(facts, path.parent)]
    problems += [*facts.extremes(), *_names(facts)]
    if problems:
        raise CutsError(str(path), [str(_with_name(p, facts)) for p in problems])
    joined = _joined(data, path.parent)
    names = _named(facts)
    joined["cuts"] = [{**cut, "name": name} for cut, name in zip(joined["cuts"], names, strict=True)]
    return Cuts.model_validate({**joined, "path": path})


def _merged(own: Any, fit: Mapping[str, Any]) -> Any:
    """The table ``[fit]`` with other keys in it; as is where it is not a table."""
    if not isinstance(own, Mapping):
        return own
    held_out = own.get("holdout", [])
    more = [*held_out, *fit["holdout"]] if "holdout" in fit and isinstance(held_out, list) else held_out
    return {**own, **fit, "holdout": more}


def _named(facts: Facts) -> list[str]:
    """Names of the cuts, made up where they have none."""
    names = []
    for index in range(facts.count("cuts")):
        source = facts.get("cuts", index, "log") or facts.get("cuts", index, "job")
        made_up = Path(source).stem if source else f"cut{index + 1}"
        names.append(facts.get("cuts", index, "name") or made_up)
    return names


def _names(facts: Facts) -> Iterator[Problem]:
    """No two cuts have one name, and cuts that are held out exist and are not all."""
    names = _named(facts)
    for name, count in Counter(names).items():
        if count > 1:
            index = len(names) - 1 - names[::-1].index(name)
            yield wrong(("cuts", index, "name"), name, f"a unique name, cuts[{names.index(name)}] already has it")
    listed = facts.get("fit", "holdout") or ()
    for name in listed:
        if name not in names:
            yield wrong(("fit", "holdout"), name, f"the name of a cut: {', '.join(names)}")
    out = {*listed, *(n for i, n in enumerate(names) if facts.get("cuts", i, "holdout"))}
    if names and out >= set(names):
        yield Problem(("cuts",), ": all are held out; expected at least one that is fitted")


def _with_name(problem: Problem, facts: Facts) -> Problem:
    """The problem with the cut's name where it is in a cut."""
    match problem.location:
        case ("cuts", int(index), *rest) if rest != ["name"]:
            name = facts.get("cuts", index, "name")
            return Problem(problem.location, f" (cut {name}){problem.text}") if name else problem
    return problem


def _joined(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The data with defaults in the cuts and files joined to the folder."""
    cuts = []
    for cut in data["cuts"]:
        made = {**data.get("defaults", {}), **cut}
        for key in ("log", "job"):
            if key in made:
                made[key] = folder / made[key]
        cuts.append(made)
    return {**data, "cuts": cuts}
