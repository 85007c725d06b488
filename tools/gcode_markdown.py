"""Tables in Markdown, and descriptions of fields from the docstrings of dataclasses."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Mapping, Sequence

_ENTRY = re.compile(r"^(\w+): (.*?)(?=^\w+: |\Z)", re.MULTILINE | re.DOTALL)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; bars in cells are escaped."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |\n" for line in lines)


def code(text: str) -> str:
    """The text in code type."""
    return f"`{text}`"


def field_texts(kind: type) -> Mapping[str, str]:
    """Descriptions of fields, from the ``Attributes`` of a class's docstring.

    Raises:
        ValueError: for a class without them.
    """
    text = inspect.getdoc(kind) or ""
    begin = text.find("Attributes:\n")
    if begin < 0:
        raise ValueError(f"{kind.__name__} has no Attributes in its docstring")
    part = text[begin:].partition("\n")[2].partition("\n\n")[0]
    body = inspect.cleandoc("\n" + part)
    return {name: _plain(meaning) for name, meaning in _ENTRY.findall(body)}


def _plain(text: str) -> str:
    return " ".join(text.split()).replace("``", "`").rstrip(".")
