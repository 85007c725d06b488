"""Small text files as lines with their locations, and numbers in them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Literal, TypeAlias

from gcode.errors import GcodeError, Place

Unit: TypeAlias = Literal["mm", "inch"]

#: Length of the machine's unit, mm.
MM_PER_UNIT: Mapping[str, float] = MappingProxyType({"mm": 1.0, "inch": 25.4})
#: No table that people keep is larger.
LARGEST_BYTES = 16 * 2**20

NUMBER = re.compile(r"[+-]?(?:\d++(?:\.\d*+)?+|\.\d++)(?:[eE][+-]?\d+)?")
_TOKEN = re.compile(r"\S+")


def read_text(path: Path, suffixes: Iterable[str]) -> str:
    """The whole text of a file: UTF-8, or Latin-1 where it is not.

    Args:
        suffixes: endings that its name may have, in lower case, each with its dot.

    Raises:
        GcodeError: for another ending (``file-kind``), and for a file that cannot be read or is larger than any table
            (``unreadable-file``).
    """
    place = Place(file=str(path), line=0)
    if path.suffix.lower() not in suffixes:
        problem = f"the name ends in {path.suffix}" if path.suffix else "the name has no suffix"
        raise GcodeError(place, "file-kind", problem, f"a file name that ends in {' or '.join(suffixes)}")
    try:
        with path.open("rb") as handle:
            data = handle.read(LARGEST_BYTES + 1)
    except OSError as error:
        problem = f"cannot be read: {(error.strerror or str(error)).lower()}"
        raise GcodeError(place, "unreadable-file", problem, "a text file") from None
    if len(data) > LARGEST_BYTES:
        problem = f"cannot be read: larger than {LARGEST_BYTES // 2**20} MiB"
        raise GcodeError(place, "unreadable-file", problem, "a table of tools or parameters")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def lines_of(path: Path, text: str) -> Iterator[Place]:
    """The lines of a text with their locations; only line feeds, with or without a carriage return, end a line."""
    for number, line in enumerate(text.split("\n"), start=1):
        yield Place(file=str(path), line=number, text=line.rstrip("\r"))


def token_at(text: str, index: int) -> str:
    """The text at an index up to the next blank, for messages."""
    found = _TOKEN.search(text, index)
    return found.group()[:40] if found else ""


def error_at(place: Place, index: int, code: str, problem: str, expected: str) -> GcodeError:
    """The error at an index (from 0) of a line."""
    return GcodeError(replace(place, column=index + 1), code, problem, expected)


def number_at(place: Place, index: int, what: str, code: str) -> tuple[float, int]:
    """The number at an index of a line, and the index after it.

    Args:
        what: names the number in the message, e.g. ``Z``.
        code: of the error.

    Raises:
        GcodeError: where there is no number, or one that is not finite.
    """
    found = NUMBER.match(place.text, index)
    if found is None or not math.isfinite(float(found.group())):
        problem = f"{what} with {token_at(place.text, index) or 'nothing'} after it"
        raise error_at(place, index, code, problem, "a finite decimal number")
    return float(found.group()), found.end()
