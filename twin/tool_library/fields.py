"""Values of one entry of a library by key, with a warning for each that cannot be read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from twin.settings.problems import show
from twin.tool_library.quantities import LibraryUnit, angle_deg, length_mm, whole
from twin.tool_library.raw_tool import Size

_UNIT_TEXT: dict[LibraryUnit, str] = {"mm": "mm", "inch": "in"}


class Fields:
    """The values of an entry.

    Args:
        values: by key, as the file has them; None and empty text are as if they were absent.
        unit: unit of lengths that have none.

    Attributes:
        sizes: the sizes read so far, by name.
        warnings: values that could not be read.
    """

    def __init__(self, values: Mapping[str, Any], unit: LibraryUnit) -> None:
        self._values = values
        self.unit = unit
        self.sizes: dict[str, Size] = {}
        self.warnings: list[str] = []

    def length(self, name: str, *keys: str, unit: LibraryUnit | None = None) -> Size | None:
        """Read a length as a size of that name, from the first of the keys that is there; ``unit`` is the key's own."""
        own = unit or self.unit
        return self._size(name, keys, lambda value: length_mm(value, own), _UNIT_TEXT[own])

    def angle(self, name: str, *keys: str) -> Size | None:
        """Read an angle in degrees as a size of that name."""
        return self._size(name, keys, angle_deg, "deg")

    def whole(self, *keys: str) -> int | None:
        """A whole number."""
        found = self._first(keys)
        return None if found is None else self.tried(found, whole)

    def text(self, *keys: str) -> str:
        """A text, empty where there is none."""
        found = self._first(keys)
        return found[1] if found is not None and isinstance(found[1], str) else ""

    def tried(self, found: tuple[str, Any], read: Callable[[Any], Any]) -> Any:
        """A value as a function reads it; None, with a warning, where it cannot."""
        key, value = found
        try:
            return read(value)
        except ValueError as error:
            self.warnings.append(f"{key} = {_shown(value)}: expected {error}")
            return None

    def _size(self, name: str, keys: tuple[str, ...], read: Callable[[Any], float], unit: str) -> Size | None:
        found = self._first(keys)
        value = None if found is None else self.tried(found, read)
        if found is None or value is None:
            return None
        self.sizes[name] = Size(value, f"{found[0]} = {_with_unit(found[1], unit)}")
        return self.sizes[name]

    def _first(self, keys: tuple[str, ...]) -> tuple[str, Any] | None:
        """The first key that has a value, with that."""
        for key in keys:
            value = self._values.get(key)
            if value is not None and not (isinstance(value, str) and not value.strip()):
                return key, value
        return None


def _with_unit(value: Any, unit: str) -> str:
    """A value as the file has it, with its unit."""
    if not isinstance(value, str):
        return f"{value:g} {unit}"
    text = value.strip()
    return f"{text} {unit}" if text[-1:].isdigit() else text


def _shown(value: Any) -> str:
    return show(value if isinstance(value, str | int | float | bool) else str(type(value).__name__))
