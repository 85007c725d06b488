"""The base of every settings table, and what a field adds to its type and description."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, TypeAlias

from pydantic import BaseModel, BeforeValidator, ConfigDict, Strict

Point: TypeAlias = Annotated[tuple[float, float, float], Strict(False)]


def _without_escapes(value: object) -> object:
    """The value; a text with control characters is refused: in double quotes, TOML takes a backslash for an escape.

    A path that is joined to its folder already is not a text: folders may have any name.
    """
    if isinstance(value, str) and any(ord(letter) < 32 or ord(letter) == 127 for letter in value):
        raise ValueError(
            "path: expected a path; a backslash begins an escape: write the path in single quotes, or / for each \\"
        )
    return value


FilePath: TypeAlias = Annotated[Path, Strict(False), BeforeValidator(_without_escapes)]


class Table(BaseModel):
    """A table of a settings file: unknown keys are refused, text is not a number, nor are true and false."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", allow_inf_nan=False, defer_build=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """Presentation of a key, part of the field's annotation: ``Annotated[float, Key(unset="...")]``.

    Attributes:
        options: names of the command line's option, a pair as ``--climb/--conventional``; made from the key if empty.
        metavar: placeholder of the option's value in the help; made from the key's unit if not given.
        unset: effect of a key that is not given and has no default, e.g. ``0.4 of the diameter``.
        as_text: the option takes one text, which the field's validator reads.
        expected: values that are allowed, in words, where its type does not state them.
    """

    options: tuple[str, ...] = ()
    metavar: str | None = None
    unset: str | None = None
    as_text: bool = False
    expected: str = ""
