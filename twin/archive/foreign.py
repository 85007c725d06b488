"""MCAP files of other programs: the numbers in the messages of one topic, by their own schemas."""

from __future__ import annotations

import dataclasses
from array import array
from math import nan
from os import PathLike
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from mcap.records import Channel

from twin.archive.container.frames import McapFile, RunFile
from twin.archive.foreign_log import ForeignLog, LogMessage
from twin.archive.foreign_message import MessageFields
from twin.arrays import FloatArray
from twin.errors import ArchiveError

#: Messages were recorded in bursts where their usual step is shorter than this, ns, and that part of the mean step.
_BURST_NS, _BURST_PART = 10_000, 0.1
_ENCODINGS = ("protobuf", "json")
_Times: TypeAlias = np.ndarray[tuple[int], np.dtype[np.int64]]
#: Fields that are times by their names.
_TIME_FIELDS = frozenset(("t_s", "time", "t", "time_s", "t_ms", "time_ms", "t_us", "time_us", "timestamp"))


def is_run(path: str | PathLike[str]) -> bool:
    """Whether a file is a run of this program."""
    try:
        with RunFile(path):
            return True
    except ArchiveError:
        return False


@dataclasses.dataclass(frozen=True, slots=True, kw_only=True)
class TopicNumbers:
    """The numbers of one topic's messages.

    Attributes:
        columns: shape (n,) by field; ``t_s``, counted from the first message, is the first one if no field is a time.
        notes: which clock ``t_s`` is, if not that of the recorder.
        not_read: fields with too many numbers a message.
    """

    topic: str
    columns: dict[str, FloatArray]
    notes: tuple[str, ...]
    not_read: tuple[str, ...]


def read_numbers(path: str | PathLike[str], topic: str | None = None) -> TopicNumbers:
    """The numbers of the messages on a topic, nested fields joined by dots, elements of lists numbered from 1.

    Args:
        topic: None for the only topic with readable messages.

    Raises:
        ArchiveError: not an MCAP file; a topic that is unknown, cannot be read, or must be chosen.
    """
    try:
        with McapFile(path) as file:
            log = ForeignLog(file)
            found = _choose(file.path, log.channels, topic)
            rows = _Rows()
            for number, message in enumerate(log.messages(found), 1):
                rows.decode(file.path, number, message)
    except ArchiveError:
        raise
    except Exception as error:  # the libraries raise many kinds on damaged files
        raise ArchiveError(f"{path}: not a readable MCAP file: {error}") from error
    if len(rows.times_ns) < 2:
        raise ArchiveError(f"{path}: {len(rows.times_ns)} messages on {found}, expected at least 2")
    columns, notes = rows.columns()
    not_read = tuple(f"{name} (list of {count} numbers)" for name, count in rows.lists.items())
    return TopicNumbers(topic=found, columns=columns, notes=notes, not_read=not_read)


def _times() -> array[int]:
    return array("q")


@dataclasses.dataclass(slots=True)
class _Rows:
    """Numbers by name, with 8 bytes a number, and the times of the messages by three clocks."""

    times_ns: array[int] = dataclasses.field(default_factory=_times)
    sent_ns: array[int] = dataclasses.field(default_factory=_times)
    stamps_ns: array[int] = dataclasses.field(default_factory=_times)
    values: dict[str, array[float]] = dataclasses.field(default_factory=dict)
    lists: dict[str, int] = dataclasses.field(default_factory=dict)
    classes: dict[int, Any] = dataclasses.field(default_factory=dict)

    def decode(self, path: Path, number: int, message: LogMessage) -> None:
        """Decode a message and take its numbers.

        Raises:
            ArchiveError: it cannot be decoded; the message names it by its number on the topic.
        """
        try:
            self.add(message, MessageFields.of(message, self.classes))
        except Exception as error:  # the libraries raise many kinds on damaged messages
            encoding = {"json": "JSON"}.get(message.channel.message_encoding, message.channel.message_encoding)
            why = "values nested too deep" if isinstance(error, RecursionError) else str(error).strip("\"'")
            raise ArchiveError(
                f"{path}: message {number} on {message.channel.topic} cannot be read as {encoding}: {why}"
            ) from error

    def add(self, message: LogMessage, fields: MessageFields) -> None:
        for name, value in fields.numbers.items():
            column = self.values.setdefault(name, array("d"))
            column.extend([nan] * (len(self.times_ns) - len(column)))
            column.append(value)
        self.lists |= fields.lists
        if fields.stamp_ns is not None:
            self.stamps_ns.append(fields.stamp_ns)
        self.times_ns.append(message.time_ns)
        self.sent_ns.append(message.sent_ns)

    def columns(self) -> tuple[dict[str, FloatArray], tuple[str, ...]]:
        """The columns in the order of time; a number that a message does not have is NaN. And notes."""
        times, notes = self._clock()
        order = np.argsort(times, kind="stable")
        if np.any(order[1:] < order[:-1]):
            notes = (*notes, "messages out of order were sorted by their time")
        columns: dict[str, FloatArray] = {}
        if not any(name.rpartition(".")[2].lower() in _TIME_FIELDS for name in self.values):
            columns["t_s"] = (times[order] - times[order[0]]) * 1e-9
        else:
            notes = ()
        for name, column in self.values.items():
            column.extend([nan] * (len(times) - len(column)))
            columns[name] = np.array(column)[order]
        return columns, notes

    def _clock(self) -> tuple[_Times, tuple[str, ...]]:
        """Times of the messages: their own stamps, or when they were recorded; when they were sent, if in bursts."""
        count = len(self.times_ns)
        if len(self.stamps_ns) == count and self.stamps_ns.count(0) <= 1 and min(self.stamps_ns) < max(self.stamps_ns):
            return np.array(self.stamps_ns), ("time from the stamps in the messages",)
        recorded, sent = np.array(self.times_ns), np.array(self.sent_ns)
        steps, sent_steps = np.diff(np.sort(recorded)), np.diff(np.sort(sent))
        if not np.any(steps == 0) and not _in_bursts(steps):
            return recorded, ()
        if np.all(sent_steps > 0) and not _in_bursts(sent_steps):
            return sent, ("time at which the messages were sent: they were recorded in bursts",)
        return (_begins(recorded), ("recorded in bursts",)) if _in_bursts(steps) else (recorded, ())


def _in_bursts(steps_ns: _Times) -> bool:
    """Whether messages come in bursts with pauses between: faster than forces are sampled, and than in the mean."""
    usual = float(np.median(steps_ns)) if len(steps_ns) else 0.0
    return 0.0 < usual < min(_BURST_NS, _BURST_PART * float(steps_ns.mean()))


def _begins(times_ns: _Times) -> _Times:
    """Times of messages that were recorded in bursts: the begin of its burst for each."""
    order = np.argsort(times_ns, kind="stable")
    sorted_ns = times_ns[order]
    first = np.concatenate(([True], np.diff(sorted_ns) >= _BURST_NS))
    made = np.empty_like(times_ns)
    made[order] = sorted_ns[np.maximum.accumulate(np.where(first, np.arange(len(first)), 0))]
    return made


def _choose(path: Path, channels: list[Channel], topic: str | None) -> str:
    """The topic to read."""
    known = [c.topic for c in channels if c.message_encoding in _ENCODINGS]
    others = ", ".join(f"{c.topic} ({c.message_encoding})" for c in channels if c.topic not in known)
    if not known:
        raise ArchiveError(
            f"{path}: no topic in protobuf or JSON, topics are {others or 'none'}; expected messages in one of these: "
            "convert the file, or export the topic as CSV"
        )
    if topic is not None:
        if topic not in known:
            raise ArchiveError(f"{path}: no topic {topic!r} in protobuf or JSON; expected one of {', '.join(known)}")
        return topic
    likely = [t for t in known if any(word in t.lower() for word in ("force", "wrench"))] or known
    if len(likely) != 1:
        names = ", ".join(f"{c.topic} ({c.message_encoding})" for c in channels if c.topic in known)
        rest = f" (not readable: {others})" if others else ""
        raise ArchiveError(f"{path}: which topic has the forces? topics are {names}{rest}; choose one by --group TOPIC")
    return likely[0]
