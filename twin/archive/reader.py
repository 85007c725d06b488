"""A run's file read back into the records that were written, with constant memory."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

import numpy as np
from mcap.opcode import Opcode
from mcap.records import Channel, Schema
from numpy.typing import NDArray

from twin.archive import forces, messages, schemas
from twin.archive import run_metadata as meta
from twin.archive.container.chunk import MESSAGE_FIXED, MESSAGE_HEAD
from twin.archive.container.frames import DAMAGE, HEAD, Frame, RunFile, stream
from twin.archive.container.integrity import checked_index, compare_counts
from twin.archive.container.unpack import ChunkError
from twin.errors import ArchiveError
from twin.record import Attachment, Record, RunHeader, RunSummary, Step

_CONVERTERS: dict[str, Callable[[Any], Record]] = {
    schemas.NC_TOPIC: messages.to_nc,
    schemas.COLLISION_TOPIC: messages.to_collision,
}
_FOR_VIEWERS_ONLY = (schemas.POSE_TOPIC, schemas.TOOL_SHAPE_TOPIC)


def read_run(path: str | PathLike[str]) -> Iterator[Record]:
    """The records of a run in the order in which they were written; arrays are read-only.

    A file that ends early (a killed run, an incomplete copy) gives the records that are complete in it: no step without
    all of its samples, and no `RunSummary` if it ends before that. The frames, the checksum of every chunk, the
    messages' sequence numbers and the counts of the file's statistics are checked.

    Raises:
        ArchiveError: not the file of a run, damaged, or shorter than its header.
    """
    with RunFile(path) as file:
        yield from Decoder(file).records()


@dataclass(slots=True)
class _PendingStep:
    """A step whose samples are still to be read."""

    message: Any
    missing: int
    blocks: list[NDArray[np.void]] = field(default_factory=list)

    def take(self, block: NDArray[np.void]) -> None:
        if len(block):
            self.blocks.append(block)
        self.missing -= len(block)

    def step(self) -> Step:
        return messages.to_step(self.message, forces.to_samples(self.blocks))


@dataclass(slots=True)
class Decoder:
    """Turns the frames of one file into records.

    Attributes:
        counts: number of messages on each topic, of those that were read.
        end_ns: latest log time among them.
    """

    file: RunFile
    counts: Counter[str] = field(default_factory=Counter)
    end_ns: int = 0
    _schemas: dict[int, Schema] = field(default_factory=dict)
    _topics: dict[int, str] = field(default_factory=dict)
    _classes: dict[int, Any] = field(default_factory=dict)
    _layouts: dict[int, forces.ForceLayout] = field(default_factory=dict)
    _files: list[Attachment] = field(default_factory=list)
    _metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    _header: RunHeader | None = None
    _summary: RunSummary | None = None
    _pending: _PendingStep | None = None
    _sequence: dict[int, int] = field(default_factory=dict)

    def records(self) -> Iterator[Record]:
        """All records of the file, the summary last wherever it is in the file.

        Raises:
            ArchiveError: damaged, or without a whole header.
        """
        index = checked_index(self.file)
        yield from self._body()
        if index is not None:
            compare_counts(self.file, index, self.counts)
            for name in index.metadata.keys() - self._metadata.keys():
                raise self.file.damaged(index.metadata[name], f"no metadata {name!r}")
            if self._pending is not None:
                raise self.file.damaged(index.start, f"step {self._pending.message.step} without all of its samples")
        if self._summary is not None:
            yield self._summary

    def readable(self) -> Iterator[Record]:
        """As `records`, not compared with the file's index: up to the first damaged record.

        Raises:
            ArchiveError: as `records`, after the records that can be read.
        """
        yield from self._body()
        if self._summary is not None:
            yield self._summary

    def header(self) -> RunHeader:
        """The run's header alone; nothing after it is read or checked.

        Raises:
            ArchiveError: damaged, or without a whole header.
        """
        return next(record for record in self.readable() if isinstance(record, RunHeader))

    def _body(self) -> Iterator[Record]:
        """All records but the summary, which is kept.

        Raises:
            ArchiveError: damaged, or without a whole header.
        """
        self._begin()
        for frame in self.file.frames():
            if self._header is None and frame.opcode in (Opcode.CHUNK, Opcode.MESSAGE):
                raise self.file.damaged(frame.offset)
            try:
                yield from self._frame(frame)
            except DAMAGE as error:
                problem = str(error) if isinstance(error, ChunkError) else ""
                raise self.file.damaged(frame.offset, problem) from error
            if frame.opcode == Opcode.DATA_END:
                break
        if self._header is None:
            raise ArchiveError(f"{self.file.path}: ends before the run's header is whole (byte {self.file.size})")

    def _begin(self) -> None:
        self.counts.clear()
        self._files.clear()
        self._metadata.clear()
        self._sequence.clear()
        self._header = self._summary = self._pending = None

    def _frame(self, frame: Frame) -> Iterator[Record]:
        if frame.opcode == Opcode.CHUNK:
            yield from self._chunk(self.file.unpack(frame))
        elif frame.opcode == Opcode.MESSAGE:
            yield from self._chunk(HEAD.pack(frame.opcode, len(frame.body)) + frame.body)
        elif frame.opcode == Opcode.ATTACHMENT:
            self._files.append(self.file.attachment(frame))
        elif frame.opcode == Opcode.METADATA:
            yield from self._values(frame)
        elif frame.opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            self._register(frame.opcode, frame.body)

    def _values(self, frame: Frame) -> Iterator[Record]:
        """Take named values; those of the header give the header."""
        name, values = self.file.values(frame)
        self._metadata[name] = values
        if name == meta.HEADER:
            self._header = meta.to_header(values, self._metadata[meta.PARAMETERS], self._files)
            yield self._header
        elif name == meta.SUMMARY:
            self._summary = meta.to_summary(values)

    def _register(self, opcode: int, body: bytes) -> None:
        """Keep a schema or a channel; messages of another program's schema are decoded by that schema."""
        if opcode == Opcode.SCHEMA:
            schema = Schema.read(stream(body))
            self._schemas[schema.id] = schema
            return
        channel = Channel.read(stream(body))
        schema = self._schemas[channel.schema_id]
        wanted = schemas.message_on(channel.topic)
        if schema.name != wanted or channel.topic in _FOR_VIEWERS_ONLY:
            self._topics[channel.id] = channel.topic
            return
        own = schema.data == schemas.descriptor_set(wanted)
        self._topics[channel.id] = channel.topic
        self._classes[channel.id] = (
            schemas.message_class(wanted) if own else schemas.embedded_class(schema.data, wanted)
        )
        if channel.topic == schemas.FORCE_TOPIC and own:
            self._layouts[channel.id] = forces.ForceLayout.of(channel.id)

    def _chunk(self, data: bytes) -> Iterator[Record]:
        """Records inside a chunk; a step's force messages are taken as one array."""
        at = 0
        while at < len(data):
            opcode, length = data[at], int.from_bytes(data[at + 1 : at + 9], "little")
            if at + 9 + length > len(data):
                raise ChunkError("a record that is longer than its chunk")
            if opcode == Opcode.MESSAGE:
                _, _, channel, sequence, time_ns, _ = MESSAGE_HEAD.unpack_from(data, at)
                block = self._force_block(channel, data, at)
                if len(block):
                    self._count(channel, len(block), sequence, int(block["log_time"][-1]))
                    yield from self._take(block)
                    at += block.nbytes
                    continue
                self._count(channel, 1, sequence, time_ns)
                yield from self._message(channel, data[at + 9 + MESSAGE_FIXED : at + 9 + length])
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                self._register(opcode, data[at + 9 : at + 9 + length])
            else:
                raise ChunkError(f"a chunk with a record of kind 0x{opcode:02X}")
            at += 9 + length

    def _count(self, channel: int, n: int, sequence: int, time_ns: int) -> None:
        """Count messages; this program numbers those of a channel without a gap, so that a lost chunk is noticed."""
        topic, expected = self._topics[channel], self._sequence.get(channel, 0)
        if sequence != expected and self.file.library.startswith(schemas.LIBRARY):
            raise ChunkError(f"message {sequence} on {topic} after message {expected - 1}")
        self._sequence[channel] = sequence + n & 0xFFFFFFFF
        self.counts[topic] += n
        self.end_ns = max(self.end_ns, time_ns)

    def _force_block(self, channel: int, data: bytes, at: int) -> NDArray[np.void]:
        """The current step's force messages at this position, as far as they have this program's layout."""
        layout = self._layouts.get(channel)
        if layout is None or self._pending is None:
            return forces.NO_RECORDS
        return layout.match(data, at, self._pending.missing)

    def _message(self, channel: int, payload: bytes) -> Iterator[Record]:
        """One message of any topic except those for viewers only."""
        if channel not in self._classes:
            return
        topic, message = self._topics[channel], self._classes[channel].FromString(payload)
        if topic == schemas.FORCE_TOPIC:
            yield from self._take(forces.row(message))
        elif topic == schemas.ENGAGEMENT_TOPIC:
            self._pending = _PendingStep(message, message.samples)
            yield from self._take(forces.NO_RECORDS)
        else:
            yield _CONVERTERS.get(topic, messages.to_patch)(message)

    def _take(self, block: NDArray[np.void]) -> Iterator[Record]:
        """Add force messages to the current step; yields the step when it has all of them."""
        if self._pending is None:
            return
        self._pending.take(block)
        if self._pending.missing <= 0:
            step, self._pending = self._pending.step(), None
            yield step
