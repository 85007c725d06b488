"""MCAP files of other programs: the numbers in the messages of one topic, by their own schemas."""

from __future__ import annotations

import dataclasses
import json
from array import array
from collections.abc import Iterable, Iterator, Mapping
from math import nan
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from mcap.records import Channel, Schema

from twin.archive import schemas
from twin.archive.foreign_log import ForeignLog, LogMessage
from twin.archive.frames import McapFile, RunFile
from twin.arrays import FloatArray
from twin.errors import ArchiveError

_ENCODINGS = ("protobuf", "json")


def is_run(path: str | PathLike[str]) -> bool:
    """Whether a file is a run of this program."""
    try:
        with RunFile(path):
            return True
    except ArchiveError:
        return False


def read_numbers(path: str | PathLike[str], topic: str | None = None) -> tuple[str, dict[str, FloatArray]]:
    """The numbers of the messages on a topic, nested fields joined by dots.

    Args:
        topic: None for the only topic with readable messages.

    Returns:
        the topic, and shape (n,) arrays by field; ``t_s`` is added from the log time, counted from the first message,
        if no field is a time.

    Raises:
        ArchiveError: not an MCAP file; a topic that is unknown, cannot be read, or must be chosen.
    """
    try:
        with McapFile(path) as file:
            log = ForeignLog(file)
            found = _choose(file.path, log.channels, topic)
            rows = _Rows()
            for time_ns, row in _numbers(log.messages(found)):
                rows.add(time_ns, row)
    except ArchiveError:
        raise
    except Exception as error:  # the libraries raise many kinds on damaged files
        raise ArchiveError(f"{path}: not a readable MCAP file: {error}") from error
    if len(rows.times_ns) < 2:
        raise ArchiveError(f"{path}: {len(rows.times_ns)} messages on {found}, expected at least 2")
    return found, rows.columns()


@dataclasses.dataclass(slots=True)
class _Rows:
    """Numbers by name, with 8 bytes a number."""

    times_ns: array[int] = dataclasses.field(default_factory=lambda: array("q"))
    values: dict[str, array[float]] = dataclasses.field(default_factory=dict)

    def add(self, time_ns: int, row: Mapping[str, float]) -> None:
        for name, value in row.items():
            column = self.values.setdefault(name, array("d"))
            column.extend([nan] * (len(self.times_ns) - len(column)))
            column.append(value)
        self.times_ns.append(time_ns)

    def columns(self) -> dict[str, FloatArray]:
        """The columns in the order of log time; a number that a message does not have is NaN."""
        times = np.array(self.times_ns)
        order = np.argsort(times, kind="stable")
        columns: dict[str, FloatArray] = {}
        if not any(name.split(".")[-1] in ("t_s", "time", "t", "time_s") for name in self.values):
            columns["t_s"] = (times[order] - times[order[0]]) * 1e-9
        for name, column in self.values.items():
            column.extend([nan] * (len(times) - len(column)))
            columns[name] = np.array(column)[order]
        return columns


def _choose(path: Path, channels: list[Channel], topic: str | None) -> str:
    """The topic to read."""
    known = [c.topic for c in channels if c.message_encoding in _ENCODINGS]
    if topic is not None:
        if topic not in known:
            raise ArchiveError(f"{path}: no topic {topic!r} in protobuf or JSON; expected one of {', '.join(known)}")
        return topic
    likely = [t for t in known if "force" in t.lower()] or known
    if len(likely) != 1:
        names = ", ".join(f"{c.topic} ({c.message_encoding})" for c in channels) or "none"
        raise ArchiveError(f"{path}: which topic has the forces? topics are {names}; choose one by --group TOPIC")
    return likely[0]


def _numbers(messages: Iterable[LogMessage]) -> Iterator[tuple[int, dict[str, float]]]:
    """Log time in ns and numbers of each message."""
    classes: dict[int, Any] = {}
    for message in messages:
        channel = message.channel
        if channel.message_encoding == "json":
            yield message.time_ns, dict(_json_numbers(json.loads(message.data), ""))
        else:
            made = classes.get(channel.id) or _class(message.schema)
            classes[channel.id] = made
            yield message.time_ns, dict(_fields(made.FromString(message.data), ""))


def _class(schema: Schema | None) -> Any:
    if schema is None:
        raise ValueError("a protobuf topic without a schema")
    return schemas.embedded_class(schema.data, schema.name)


def _fields(message: Any, prefix: str) -> Iterator[tuple[str, float]]:
    """Numbers of a protobuf message; fields that are not set are zero, as the format defines."""
    for field in message.DESCRIPTOR.fields:
        if field.is_repeated or field.cpp_type in (field.CPPTYPE_STRING, field.CPPTYPE_ENUM):
            continue
        value = getattr(message, field.name)
        if field.cpp_type == field.CPPTYPE_MESSAGE:
            if field.message_type.full_name != "google.protobuf.Timestamp":
                yield from _fields(value, f"{prefix}{field.name}.")
        else:
            yield f"{prefix}{field.name}", float(value)


def _json_numbers(value: Any, prefix: str) -> Iterator[tuple[str, float]]:
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _json_numbers(inner, f"{prefix}.{key}" if prefix else str(key))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield prefix, float(value)
