"""The text of a drafted job file: tables with a comment at every value that was assumed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from gcode.underline import harmless
from twin.settings.toml_text import toml_value

#: Lengths are written to this many decimals of a mm.
_DECIMALS = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """One key of a table.

    Attributes:
        key: the key.
        value: its value; None for a key that has to be filled in by hand.
        note: comment after it.
    """

    key: str
    value: Any
    note: str = ""


@dataclass(slots=True, kw_only=True)
class DraftTable:
    """One table of the file.

    Attributes:
        name: ``stock``.
        listed: it is one of a list, as ``[[tools]]``.
        comments: lines above its keys.
        entries: its keys; without any that has a value, the table is written as a comment.
    """

    name: str
    listed: bool = False
    comments: list[str] = field(default_factory=list)
    entries: list[Entry] = field(default_factory=list)

    def add(self, key: str, value: Any, note: str = "") -> None:
        """Add a key."""
        self.entries.append(Entry(key=key, value=rounded(value), note=note))

    def get(self, key: str) -> Any:
        """The value of a key, None if it has none."""
        return next((entry.value for entry in self.entries if entry.key == key), None)

    def values(self) -> dict[str, Any]:
        """The keys that have a value."""
        return {entry.key: entry.value for entry in self.entries if entry.value is not None}

    def lines(self) -> Iterator[str]:
        """The table as lines of a file."""
        yield from (f"# {harmless(comment)}" for comment in self.comments)
        empty = all(entry.value is None for entry in self.entries)
        yield f"{'# ' if empty else ''}{f'[[{self.name}]]' if self.listed else f'[{self.name}]'}"
        for entry in self.entries:
            text = f"# {entry.key} = ...  " if entry.value is None else f"{entry.key} = {toml_value(entry.value)}  "
            yield (f"{text}# {harmless(entry.note)}" if entry.note else text).rstrip()


def rounded(value: Any) -> Any:
    """A value without the noise of a conversion from inches."""
    if isinstance(value, float):
        return round(value, _DECIMALS) + 0.0
    if isinstance(value, dict):
        return {key: rounded(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(inner) for inner in value]
    return value


def file_text(heading: Sequence[str], tables: Sequence[DraftTable]) -> str:
    """A whole file: comments, then tables, with an empty line between them."""
    blocks = ["\n".join(f"# {harmless(line)}" for line in heading)]
    blocks += ["\n".join(table.lines()) for table in tables]
    return "\n\n".join(blocks) + "\n"
