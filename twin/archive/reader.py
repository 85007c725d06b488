"""A run's file read back into the records that were written, with constant memory."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

import numpy as np
from mcap.opcode import Opcode
from mcap.records import Channel, Schema
from numpy.typing import NDArray

from twin.archive import messages, schemas
from twin.archive import run_metadata as meta
from twin.archive.container.chunk import MESSAGE_FIXED, MESSAGE_HEAD
from twin.archive.container.frames import DAMAGE, HEAD, Frame, RunFile, stream
from twin.archive.container.integrity import checked_index, compare_counts
from twin.archive.container.unpack import ChunkError
from twin.archive.samples import packed, single
from twin.archive.samples.fixed_records import FixedRecords
from twin.errors import ArchiveError
from twin.record import Attachment, ForceSamples, Record, RunHeader, RunSummary, Step

_CONVERTERS: dict[str, Callable[[Any], Record]] = {
    schemas.NC_TOPIC: messages.to_nc,
    schemas.COLLISION_TOPIC: messages.to_collision,
}
_FOR_VIEWERS_ONLY = (schemas.POSE_TOPIC, schemas.TOOL_SHAPE_TOPIC, schemas.REVOLUTION_TOPIC)


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
    """A step whose samples are still to be read.

    Attributes:
        missing: number of those samples.
        blocks: samples read so far, where each is a message.
        samples: all of them, where they are packed.
    """

    message: Any
    missing: int
    blocks: list[NDArray[np.void]] = field(default_factory=list)
    samples: ForceSamples | None = None

    def take(self, block: NDArray[np.void]) -> None:
        self.blocks.append(block)
        self.missing -= len(block)

    def step(self) -> Step:
        return messages.to_step(self.message, self.samples or single.to_samples(self.blocks))


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
    _layouts: dict[int, FixedRecords] = field(default_factory=dict)
    _files: list[Attachment] = field(default_factory=list)
    _metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    _header: RunHeader | None = None
    _summary: RunSummary | None = None
    _pending: deque[_PendingStep] = field(default_factory=deque)
    _waiting: deque[Record | _PendingStep] = field(default_factory=deque)
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
            if self._pending:
                raise self.file.damaged(index.start, f"step {self._pending[0].message.step} without all of its samples")
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
        self._pending.clear()
        self._waiting.clear()
        self._header = self._summary = None

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
            self._layouts[channel.id] = FixedRecords.of(channel.id, schemas.FORCE)

    def _chunk(self, data: bytes) -> Iterator[Record]:
        """Records inside a chunk; force messages of earlier versions are taken as arrays."""
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
                    self._take(block)
                    yield from self._ready()
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
        if layout is None or not self._pending:
            return single.NO_RECORDS
        return layout.match(data, at, self._pending[0].missing)

    def _message(self, channel: int, payload: bytes) -> Iterator[Record]:
        """One message of any topic except those for viewers only."""
        if channel not in self._classes:
            return
        topic, message = self._topics[channel], self._classes[channel].FromString(payload)
        if topic == schemas.PACKED_TOPIC:
            self._unpack(message)
        elif topic == schemas.FORCE_TOPIC:
            self._take(single.row(message))
        elif topic == schemas.ENGAGEMENT_TOPIC:
            step = _PendingStep(message, message.samples)
            self._waiting.append(step)
            if step.missing:
                self._pending.append(step)
        else:
            self._waiting.append(_CONVERTERS.get(topic, messages.to_patch)(message))
        yield from self._ready()

    def _take(self, block: NDArray[np.void]) -> None:
        """Add force messages of earlier versions to the step that lacks them."""
        if self._pending:
            self._pending[0].take(block)
            if self._pending[0].missing <= 0:
                self._pending.popleft()

    def _unpack(self, message: Any) -> None:
        """Give the samples in a message to the steps that lack them.

        Raises:
            ValueError: samples of other steps.
        """
        counts = list(message.samples)
        steps = [self._pending.popleft() for _ in counts[: len(self._pending)]]
        if [step.missing for step in steps] != counts:
            raise ChunkError("force samples that are not those of the steps before them")
        samples = packed.decode(message, [step.message.spindle_rpm for step in steps])
        for step, own in zip(steps, samples, strict=True):
            step.samples, step.missing = own, 0

    def _ready(self) -> Iterator[Record]:
        """The records that wait for no samples any more, in order."""
        while self._waiting:
            first = self._waiting[0]
            if not isinstance(first, _PendingStep):
                yield first
            elif first.missing <= 0:
                yield first.step()
            else:
                return
            self._waiting.popleft()
