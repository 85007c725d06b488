"""TOML documents whose entries have locations, so that errors name line and column."""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NamedTuple

from gcode.errors import GcodeError, Place
from gcode.tables.text_file import error_at, lines_of

_PART = r"""(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')"""
_KEY = rf"{_PART}(?:\s*\.\s*{_PART})*"
_TABLE = re.compile(rf"\s*\[\s*({_KEY})\s*\]")
_ENTRY = re.compile(rf"\s*({_KEY})\s*=\s*")
#: Larger numbers are not finite as floats.
LARGEST = sys.float_info.max
_TOML_PLACE = re.compile(r"\(at (?:line (\d+), column (\d+)|end of document)\)")


class _Entry(NamedTuple):
    """Where a key is given: the keys from the top, and the indices of key and value in the line."""

    keys: tuple[str, ...]
    place: Place
    key_index: int
    value_index: int


@dataclass(frozen=True, slots=True)
class Node:
    """A value of a document.

    Attributes:
        value: as `tomllib` gives it.
        keys: keys from the top that lead to it.
        entries: locations of all keys of the document.
    """

    value: Any
    keys: tuple[str, ...]
    entries: Sequence[_Entry]

    @property
    def name(self) -> str:
        """The keys, joined by points."""
        return ".".join(self.keys)

    def error(self, problem: str, expected: str, *, at_key: bool = False) -> GcodeError:
        """The error about this value, or with `at_key` about its name."""
        near = [e for e in self.entries if e.keys == self.keys[: len(e.keys)]]
        entry = max(near, key=lambda e: len(e.keys), default=self.entries[0])
        index = entry.key_index if at_key or len(entry.keys) < len(self.keys) else entry.value_index
        return error_at(entry.place, index, "settings-key" if at_key else "settings-value", problem, expected)

    def _wrong(self, expected: str) -> GcodeError:
        return self.error(f"{self.name} is {_shown(self.value)}", expected)

    def table(self) -> Iterator[tuple[str, Node]]:
        """The entries of a table by their keys."""
        if not isinstance(self.value, dict):
            raise self._wrong("a table")
        for key, value in self.value.items():
            yield key, Node(value, (*self.keys, key), self.entries)

    def known(self, names: Iterable[str]) -> Iterator[tuple[str, Node]]:
        """The entries of a table, all of whose keys must be among `names`."""
        allowed = sorted(names)
        for key, node in self.table():
            if key not in allowed:
                near = get_close_matches(key, allowed, 1)
                expected = f"perhaps {near[0]}" if near else f"one of {', '.join(allowed)}"
                raise node.error(f"unknown key {node.name}", expected, at_key=True)
            yield key, node

    def number(self) -> float:
        """A finite number."""
        if not isinstance(self.value, int | float) or isinstance(self.value, bool) or not abs(self.value) <= LARGEST:
            raise self._wrong("a finite number")
        return float(self.value)

    def whole(self, least: int = 0) -> int:
        """A whole number of at least `least`."""
        if not isinstance(self.value, int) or isinstance(self.value, bool) or self.value < least:
            raise self._wrong(f"a whole number of {least} or more")
        return self.value

    def point(self) -> tuple[float, float, float]:
        """Three finite numbers."""
        if not isinstance(self.value, list) or len(self.value) != 3:
            raise self._wrong("three numbers [x, y, z] in mm")
        x, y, z = (Node(value, self.keys, self.entries).number() for value in self.value)
        return (x, y, z)

    def flag(self) -> bool:
        """True or false."""
        if not isinstance(self.value, bool):
            raise self._wrong("true or false")
        return self.value

    def text(self, *allowed: str) -> str:
        """A text, one of `allowed` where any are given."""
        if not isinstance(self.value, str) or (allowed and self.value not in allowed):
            raise self._wrong(" or ".join(f'"{a}"' for a in allowed) or "a text in quotes")
        return self.value

    def texts(self) -> tuple[str, ...]:
        """A list of texts."""
        if not isinstance(self.value, list):
            raise self._wrong("a list of texts in quotes")
        return tuple(Node(value, self.keys, self.entries).text() for value in self.value)

    def numbered(self, what: str, least: int = 0) -> Iterator[tuple[int, Node]]:
        """The entries of a table whose keys are whole numbers.

        Args:
            what: names such a number in messages.
            least: smallest of them.
        """
        for key, node in self.table():
            if not key.isascii() or not key.isdigit() or len(key) > 9 or int(key) < least or key != str(int(key)):
                raise node.error(
                    f"{node.name}: {key!r} is not a {what}", f"a whole number of {least} or more", at_key=True
                )
            yield int(key), node


def load_document(path: Path, text: str) -> Node:
    """The top table of a document.

    Raises:
        GcodeError: for a text that is not TOML (``settings-syntax``).
    """
    lines = list(lines_of(path, text))
    try:
        data = tomllib.loads(text.replace("\r\n", "\n"))
    except (ValueError, RecursionError) as error:
        found = _TOML_PLACE.search(str(error))
        line, column = (int(found[1]), int(found[2])) if found and found[1] else (len(lines), 1)
        problem = _TOML_PLACE.sub("", str(error)).strip() if isinstance(error, ValueError) else "nested too deeply"
        expected = "TOML, such as G54 = [0, 0, -50]"
        raise error_at(lines[min(line, len(lines)) - 1], column - 1, "settings-syntax", problem, expected) from None
    return Node(data, (), (_Entry((), lines[0], 0, 0), *_entries(lines)))


def _entries(lines: Iterable[Place]) -> Iterator[_Entry]:
    """Where keys and tables are given, as far as one line shows it."""
    table: tuple[str, ...] = ()
    for place in lines:
        if found := _TABLE.match(place.text):
            table = _keys(found[1])
            yield _Entry(table, place, found.start(1), found.start(1))
        elif found := _ENTRY.match(place.text):
            yield _Entry((*table, *_keys(found[1])), place, found.start(1), found.end())


def _keys(text: str) -> tuple[str, ...]:
    return tuple(part.strip("\"'") for part in re.findall(_PART, text))


def _shown(value: object) -> str:
    """A value as TOML writes it, or nearly so."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "a table"
    text = f'"{value}"' if isinstance(value, str) else str(value)
    return text if len(text) <= 60 else f"{text[:59]}…"
