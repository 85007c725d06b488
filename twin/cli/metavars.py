"""Placeholders of options' values in help texts, without the tables of settings, which take time to import."""

from __future__ import annotations

from pathlib import PurePath
from typing import Any

_METAVARS: dict[type, str] = {bool: "", int: "N", float: "NUMBER", str: "TEXT", PurePath: "FILE"}


def type_metavar(annotation: Any) -> str | None:
    """Placeholder of a type in the help: empty for a flag, None for a type without one."""
    kinds = (kind for kind in _METAVARS if isinstance(annotation, type) and issubclass(annotation, kind))
    kind = next(kinds, None)
    return None if kind is None else _METAVARS[kind]
