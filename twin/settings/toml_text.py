"""Nested settings as TOML text."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any

from gcode.underline import harmless_json


def toml_text(data: Mapping[str, Any]) -> str:
    """Tables and lists of tables on top, everything below them inline; reading it gives the same data.

    Args:
        data: tables by name, as `tomllib` gives them; tuples are written as lists and paths as text.
    """
    return "\n".join(_sections(data))


def _sections(data: Mapping[str, Any]) -> Iterator[str]:
    tables = {name: _tables(value) for name, value in data.items()}
    for name, value in data.items():
        if not tables[name]:
            yield f"{_key(name)} = {toml_value(value)}"
    for name, found in tables.items():
        mark = "[{}]" if isinstance(data[name], Mapping) else "[[{}]]"
        for table in found:
            yield mark.format(_key(name))
            yield from (f"{_key(key)} = {toml_value(inner)}" for key, inner in table.items())
            yield ""


def _tables(value: object) -> list[Mapping[str, Any]]:
    """The tables that a value is, one or more; none for any other value."""
    items = value if isinstance(value, list | tuple) else [value]
    return [item for item in items if isinstance(item, Mapping)] if _all_tables(items) else []


def _all_tables(items: Sequence[object]) -> bool:
    return all(isinstance(item, Mapping) for item in items)


def _key(name: str) -> str:
    plain = name.isascii() and name.replace("_", "").replace("-", "").isalnum()
    return name if plain else _text(name)


def _text(text: str) -> str:
    return harmless_json(json.dumps(text, ensure_ascii=False))


def toml_value(value: object) -> str:
    """A value on one line; tables inline."""
    match value:
        case bool():
            return str(value).lower()
        case str() | PurePath():
            return _text(str(value))
        case Mapping() if not value:
            return "{}"
        case Mapping():
            return f"{{ {', '.join(f'{_key(k)} = {toml_value(v)}' for k, v in value.items())} }}"
        case list() | tuple():
            return f"[{', '.join(map(toml_value, value))}]"
        case float():
            return repr(float(value))
        case _:
            return str(value)
