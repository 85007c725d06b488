"""MCAP files of other programs: the numbers in the messages of one topic, by their own schemas."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from mcap.reader import make_reader
from mcap.records import Channel, Schema

from twin.archive import schemas
from twin.archive.container.partial import reason
from twin.archive.frames import RunFile
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
    path = Path(path)
    try:
        with path.open("rb") as file:
            reader = make_reader(file)
            found = _choose(path, reader.get_summary(), topic)
            rows = list(_rows(reader, found))
    except OSError as error:
        raise ArchiveError(f"{path}: cannot be read: {reason(error)}") from error
    except ArchiveError:
        raise
    except Exception as error:  # the libraries raise many kinds on damaged files
        raise ArchiveError(f"{path}: not a readable MCAP file: {error}") from error
    if len(rows) < 2:
        raise ArchiveError(f"{path}: {len(rows)} messages on {found}, expected at least 2")
    names = dict.fromkeys(name for _, row in rows for name in row)
    columns = {name: np.array([row.get(name, np.nan) for _, row in rows]) for name in names}
    if not any(name.split(".")[-1] in ("t_s", "time", "t", "time_s") for name in names):
        times = np.array([ns for ns, _ in rows], np.int64)
        columns = {"t_s": (times - times[0]) * 1e-9, **columns}
    return found, columns


def _choose(path: Path, summary: Any, topic: str | None) -> str:
    """The topic to read."""
    channels: list[Channel] = list(summary.channels.values()) if summary is not None else []
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


def _rows(reader: Any, topic: str) -> Iterator[tuple[int, dict[str, float]]]:
    """Log time in ns and numbers of each message."""
    classes: dict[int, Any] = {}
    for schema, channel, message in reader.iter_messages(topics=[topic]):
        if channel.message_encoding == "json":
            yield message.log_time, dict(_json_numbers(json.loads(message.data), ""))
        else:
            made = classes.get(channel.id) or _class(schema)
            classes[channel.id] = made
            yield message.log_time, dict(_fields(made.FromString(message.data), ""))


def _class(schema: Schema) -> Any:
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
