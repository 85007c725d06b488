"""One message of another program: its numbers by name, its own time, and lists that are too long for columns."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from twin.archive import schemas
from twin.archive.foreign_log import LogMessage

#: Longer lists are many samples in one message, not columns.
_MOST_ELEMENTS = 64
#: Values nested deeper than this are not a message.
_MOST_LEVELS = 32
_SECONDS = ("sec", "secs", "seconds")
_NANOSECONDS = ("nsec", "nanosec", "nsecs", "nanos", "nanoseconds")
#: Moments of logs, s since 1970: the years 2000 to 2100.
_EPOCH_S = (9.46e8, 4.1e9)
_TIMESTAMP = "google.protobuf.Timestamp"


@dataclass(slots=True)
class MessageFields:
    """The fields of a message, decoded.

    Attributes:
        numbers: by name, nested fields joined by dots, elements of lists as ``name[1]``.
        stamp_ns: its first time, with seconds and nanoseconds, as in ``header.stamp``; None without.
        lists: lengths of the lists that were left out.
    """

    numbers: dict[str, float] = field(default_factory=dict)
    stamp_ns: int | None = None
    lists: dict[str, int] = field(default_factory=dict)

    @classmethod
    def of(cls, message: LogMessage, classes: dict[int, Any]) -> MessageFields:
        """The fields of a message in JSON or protobuf.

        Args:
            classes: those of the channels seen so far; new ones are added.

        Raises:
            ValueError: it cannot be decoded.
        """
        made = cls()
        if message.channel.message_encoding == "json":
            made._take_json(json.loads(message.data), "", 0)
            return made
        number = message.channel.id
        if number not in classes:
            if message.schema is None:
                raise ValueError("a protobuf topic without a schema")
            classes[number] = schemas.embedded_class(message.schema.data, message.schema.name)
        made._take_message(classes[number].FromString(message.data), "")
        return made

    def _take_json(self, value: Any, name: str, level: int) -> None:
        if level > _MOST_LEVELS:
            raise ValueError(f"values nested more than {_MOST_LEVELS} deep")
        if isinstance(value, Mapping):
            stamp = _stamp(value)
            if stamp is not None and name:
                self._stamped(stamp)
                return
            for key, inner in value.items():
                self._take_json(inner, f"{name}.{key}" if name else str(key), level + 1)
        elif isinstance(value, list):
            if self._fits(value, name):
                for index, inner in enumerate(value, 1):
                    self._take_json(inner, f"{name}[{index}]", level + 1)
        elif isinstance(value, int | float) and not isinstance(value, bool):
            self._take_number(value, name)
        elif isinstance(value, str) and _last(name) in ("stamp", "timestamp", "time"):
            self._stamped(_moment_ns(value))

    def _take_message(self, message: Any, prefix: str) -> None:
        """Fields that are not set are zero, as the format defines."""
        for part in message.DESCRIPTOR.fields:
            if part.cpp_type in (part.CPPTYPE_STRING, part.CPPTYPE_ENUM):
                continue
            value, name = getattr(message, part.name), f"{prefix}{part.name}"
            nested = part.cpp_type == part.CPPTYPE_MESSAGE
            if not part.is_repeated:
                self._take_part(value, name, nested=nested)
            elif not (nested and part.message_type.GetOptions().map_entry) and self._fits(value, name):
                for index, inner in enumerate(value, 1):
                    self._take_part(inner, f"{name}[{index}]", nested=nested)

    def _take_part(self, value: Any, name: str, *, nested: bool) -> None:
        if not nested:
            self._take_number(value, name)
            return
        fields = {part.name: getattr(value, part.name) for part in value.DESCRIPTOR.fields}
        stamp = _stamp(fields)
        if stamp is not None or value.DESCRIPTOR.full_name == _TIMESTAMP:
            self._stamped(stamp)
        else:
            self._take_message(value, f"{name}.")

    def _take_number(self, value: float, name: str) -> None:
        stamp = _moment_of(value) if _last(name) == "stamp" else None
        if stamp is None:
            self.numbers[name] = float(value)
        else:
            self._stamped(stamp)

    def _fits(self, values: Sequence[Any], name: str) -> bool:
        if len(values) <= _MOST_ELEMENTS:
            return True
        self.lists[name] = len(values)
        return False

    def _stamped(self, stamp_ns: int | None) -> None:
        if self.stamp_ns is None:
            self.stamp_ns = stamp_ns


def _stamp(fields: Mapping[str, Any]) -> int | None:
    """Nanoseconds of a time that is written as seconds and nanoseconds, None for anything else."""
    if len(fields) != 2:
        return None
    seconds = next((fields[k] for k in _SECONDS if k in fields), None)
    rest = next((fields[k] for k in _NANOSECONDS if k in fields), None)
    if not isinstance(seconds, int) or not isinstance(rest, int) or not abs(seconds) < 1 << 33:
        return None
    return seconds * 1_000_000_000 + rest


def _last(name: str) -> str:
    return name.rpartition(".")[2].lower()


def _moment_of(value: float) -> int | None:
    """Nanoseconds of a number named as a stamp: ms, us or ns since 1970 by its size, or seconds with decimals."""
    for size in (1_000_000, 1000, 1):
        if _EPOCH_S[0] < value * size * 1e-9 < _EPOCH_S[1]:
            return value * size if isinstance(value, int) else round(value * size)
    seconds = isinstance(value, float) and 0.0 <= value < _EPOCH_S[1]
    return round(value * 1e9) if seconds else None


def _moment_ns(text: str) -> int | None:
    """Nanoseconds of a date and time in ISO 8601."""
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        return None
    since = moment - datetime(1970, 1, 1, tzinfo=moment.tzinfo)
    return (since.days * 86_400 + since.seconds) * 1_000_000_000 + since.microseconds * 1000
