"""Mistakes in a settings file in words: the key, the value found, and what is allowed."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any, Literal, TypeAlias, get_args, get_origin

import annotated_types as at
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from twin.settings.keys import bare, fields_of
from twin.settings.table import Key
from twin.settings.toml_text import toml_value

Location: TypeAlias = tuple[str | int, ...]

_LONGEST_VALUE = 60
_BOUNDS = {at.Gt: ("above", "gt"), at.Ge: ("at least", "ge"), at.Lt: ("below", "lt"), at.Le: ("at most", "le")}
_WORDS: dict[Any, str] = {bool: "true or false", int: "a whole number", float: "a number", str: "text"}
_COUNTS = {2: "two", 3: "three", 4: "four", 6: "six"}


@dataclass(frozen=True, slots=True)
class Problem:
    """One mistake.

    Attributes:
        location: keys and list indices from the top of the file.
        text: what follows the key path, e.g. `` = 7: expected ...``.
        tool: number of the tool that it concerns, where it is known.
    """

    location: Location
    text: str
    tool: int | None = None

    def __str__(self) -> str:
        tool = f" (tool {self.tool})" if self.tool is not None else ""
        return f"{key_path(self.location)}{tool}{self.text}"


def wrong(location: Location, value: object, expected: str, tool: int | None = None) -> Problem:
    """A value that is not allowed."""
    return Problem(location, f" = {show(value)}: expected {expected}", tool)


def missing(location: Location, expected: str, tool: int | None = None) -> Problem:
    """A key that must be there."""
    return Problem(location, f": missing; expected {expected}", tool)


def unknown(location: Location, keys: Iterable[str], tool: int | None = None) -> Problem:
    """A key that means nothing, with the one that was probably meant."""
    names = list(keys)
    near = difflib.get_close_matches(str(location[-1]), names, n=1, cutoff=0.7)
    hint = f"did you mean {near[0]}?" if near else f"expected one of {', '.join(names)}"
    return Problem(location, f": unknown key; {hint}", tool)


def key_path(location: Location) -> str:
    """Human-readable location: ``tools[0].diameter_mm``."""
    path = ""
    for key in location:
        path += f"[{key}]" if isinstance(key, int) else f".{key}" if path else key
    return path


def show(value: object) -> str:
    """A value as TOML writes it, shortened."""
    text = toml_value(value)
    return text if len(text) <= _LONGEST_VALUE else f"{text[: _LONGEST_VALUE - 4]} ..."


def problems_of(errors: Sequence[ErrorDetails], model: type[BaseModel]) -> Iterator[Problem]:
    """Mistakes that pydantic found, each once.

    Args:
        errors: from `ValidationError.errors`.
        model: the model that was validated.
    """
    seen: set[Location] = set()
    for error in errors:
        location = _location(error)
        if location not in seen:
            seen.add(location)
            yield _problem(location, error, model)


def _location(error: ErrorDetails) -> Location:
    """Location of a mistake; a list that is too short is wrong itself, not its missing item."""
    location = error["loc"]
    if location[-1] == "[key]" or (error["type"] == "missing" and isinstance(location[-1], int)):
        return location[:-1]
    return location


def _problem(location: Location, error: ErrorDetails, model: type[BaseModel]) -> Problem:
    if error["loc"][-1] == "[key]":
        annotation, _ = declared(location[:-1], model)
        return _unknown_key(location, get_args(annotation)[0])
    if error["type"] == "extra_forbidden":
        table, _ = declared(location[:-1], model)
        return unknown(location, fields_of(table))
    if error["type"] == "value_error":
        reason = str(error["ctx"]["error"]).partition(": ")[2]
        return Problem(location, f" = {show(error['input'])}: {reason}")
    annotation, field = declared(location, model)
    meaning = f" ({field.description})" if field is not None and field.description else ""
    expected = allowed(annotation, field.metadata if field is not None else ()) + meaning
    if error["type"] == "missing" and location == error["loc"]:
        return missing(location, expected)
    return wrong(location, error["input"], expected)


def _unknown_key(location: Location, annotation: Any) -> Problem:
    """A key that a table with free keys does not take: not one of several names, or not a number."""
    if get_origin(bare(annotation)) is Literal:
        return unknown(location, get_args(bare(annotation)))
    return Problem(location, f": unknown key; expected {allowed(annotation)}")


def declared(location: Location, model: type[BaseModel]) -> tuple[Any, FieldInfo | None]:
    """Type and field that a location is declared with; the field is None inside lists, and for the file as a whole."""
    annotation: Any = model
    field: FieldInfo | None = None
    for key in location:
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            field = fields_of(annotation)[str(key)]
            annotation = bare(field.annotation)
        else:
            field = None
            annotation = bare(_inner(annotation))
    return annotation, field


def _inner(annotation: Any) -> Any:
    """Type of the items of a list, or of the values of a table with free keys."""
    arguments = get_args(annotation)
    return arguments[1] if get_origin(annotation) is dict else arguments[0]


def allowed(annotation: Any, notes: Iterable[Any] = ()) -> str:
    """Values that a type allows, in words.

    Args:
        notes: bounds that belong to it.
    """
    notes = (*notes, *getattr(annotation, "__metadata__", ()))
    named = next((note.expected for note in notes if isinstance(note, Key) and note.expected), "")
    if named:
        return named
    annotation = bare(annotation)
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Literal:
        return "one of " + ", ".join(map(toml_value, arguments))
    if origin is list:
        return _allowed_list((*arguments, ...))
    if origin is tuple:
        return _allowed_list(arguments)
    if origin is dict:
        keys = get_args(bare(arguments[0]))
        return "a table with keys " + ", ".join(keys) if keys else "a table by number"
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return "a table with keys " + ", ".join(fields_of(annotation))
    if isinstance(annotation, type) and issubclass(annotation, PurePath):
        return "a file name"
    return " ".join([_WORDS[annotation], *_bounds(notes)])


def _allowed_list(items: tuple[Any, ...]) -> str:
    if items[-1] is not Ellipsis:
        return f"a list of {_COUNTS[len(items)]} numbers"
    inner = bare(items[0])
    if get_origin(inner) is tuple:
        return f"a list of {_allowed_list(get_args(inner)).replace('a list', 'lists')}"
    if not isinstance(inner, type):
        return "a list"
    kinds = {BaseModel: "tables", PurePath: "file names", str: "texts"}
    return "a list of " + next((word for kind, word in kinds.items() if issubclass(inner, kind)), "numbers")


def _bounds(notes: Iterable[Any]) -> Iterator[str]:
    joint = ""
    for note in notes:
        if type(note) in _BOUNDS:
            word, name = _BOUNDS[type(note)]
            yield f"{joint}{word} {getattr(note, name):g}"
            joint = "and "
        elif isinstance(note, at.MinLen):
            yield "that is not empty"
