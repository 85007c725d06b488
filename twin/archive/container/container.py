"""An MCAP file that is being written: attachments, metadata, chunks, and the summary section at its end."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from twin.archive import schemas
from twin.archive.container.chunk import ChunkBuilder, FinishedChunk, to_bytes, to_ns
from twin.archive.samples import packed
from twin.archive.samples.fixed_records import FixedRecords
from twin.archive.samples.revolutions import Revolutions
from twin.record import Step

MAGIC = b"\x89MCAP0\r\n"
#: Bytes that a force sample counts as before it is packed: those of a message of its own.
_SAMPLE_BYTES = 104


@dataclass(slots=True)
class Container:
    """Writes one MCAP file through a function that takes bytes and keeps all of them or raises.

    Attributes:
        put: takes bytes and keeps all of them, or raises.
        library: name of the writer in the file's header.
        profile: kind of the file: a run, or a comparison of one.
    """

    put: Callable[[bytes], None]
    library: str
    profile: str = schemas.PROFILE
    _offset: int = 0
    _crc: int = 0
    _schemas: dict[str, Schema] = field(default_factory=dict)
    _channels: dict[str, Channel] = field(default_factory=dict)
    _counts: dict[int, int] = field(default_factory=dict)
    _chunks: list[ChunkIndex] = field(default_factory=list)
    _attachments: list[AttachmentIndex] = field(default_factory=list)
    _metadata: list[MetadataIndex] = field(default_factory=list)
    _builder: ChunkBuilder | None = None
    _span: tuple[int, int] | None = None
    _sequence: dict[int, int] = field(default_factory=dict)
    _steps: list[tuple[Step, bool]] = field(default_factory=list)
    _samples: int = 0
    _revolutions: Revolutions = field(default_factory=Revolutions)

    def start(self) -> None:
        """Write the magic and the header."""
        self._write(MAGIC + to_bytes(Header(self.profile, self.library)))

    @property
    def pending_bytes(self) -> int:
        """Size of the records that are not in a chunk of the file yet, each force sample as a message of its own."""
        return (self._builder.size if self._builder else 0) + self._samples * _SAMPLE_BYTES

    def add_attachment(self, name: str, media_type: str, data: bytes) -> None:
        """Attach a file."""
        record = to_bytes(Attachment(create_time=0, log_time=0, name=name, media_type=media_type, data=data))
        index = AttachmentIndex(self._offset, len(record), 0, 0, len(data), name, media_type)
        self._write(record)
        self._attachments.append(index)

    def add_metadata(self, name: str, data: dict[str, str]) -> None:
        """Write named key-value pairs."""
        record = to_bytes(Metadata(name=name, metadata=data))
        index = MetadataIndex(self._offset, len(record), name)
        self._write(record)
        self._metadata.append(index)

    def add_message(self, topic: str, time_ns: int, payload: bytes) -> None:
        """Add one message; it is in the file after `flush`."""
        channel = self._channel(topic)
        sequence = self._numbers(channel, 1)
        self._chunk().add_message(channel, sequence & 0xFFFFFFFF, time_ns, payload)

    def add_forces(self, step: Step, *, keep: bool) -> None:
        """Add the force samples of one step; they are in the file after `flush`.

        Args:
            keep: keep the samples, and not the values of each revolution alone.
        """
        if len(step.samples.t_s):
            self._steps.append((step, keep))
            self._samples += len(step.samples.t_s)

    def end_forces(self) -> None:
        """Add the spindle revolution in progress, after the last force samples."""
        self._pack_forces()
        if schemas.REVOLUTION_TOPIC in self._channels:
            self._add_revolutions([])

    def flush(self) -> None:
        """Complete the chunk: all that was added so far is in the file."""
        self._pack_forces()
        if self._builder is None:
            return
        chunk = self._builder.finish()
        self._builder = None
        start = self._offset
        indexes = b"".join(chunk.indexes.values())
        self._write(chunk.record + indexes)
        self._note(chunk, start, len(indexes))

    def finish(self) -> None:
        """Complete the file: last chunk, end of data, summary section, footer."""
        self.flush()
        self._write(to_bytes(DataEnd(self._crc)))
        start = self._offset
        groups = self._summary()
        summary = b"".join(data for _, data in groups)
        offsets, at = b"", start
        for opcode, data in groups:
            offsets += to_bytes(SummaryOffset(opcode, at, len(data)))
            at += len(data)
        body = summary + offsets
        head = struct.pack("<BQQQ", Opcode.FOOTER, 20, start, start + len(summary))
        crc = zlib.crc32(head, zlib.crc32(body))
        self._write(
            body
            + to_bytes(Footer(summary_start=start, summary_offset_start=start + len(summary), summary_crc=crc))
            + MAGIC
        )

    def _write(self, data: bytes) -> None:
        self.put(data)
        self._offset += len(data)
        self._crc = zlib.crc32(data, self._crc)

    def _chunk(self) -> ChunkBuilder:
        if self._builder is None:
            self._builder = ChunkBuilder()
        return self._builder

    def _pack_forces(self) -> None:
        """Add the force samples that were taken, and the revolutions that they complete."""
        if not self._steps:
            return
        kept = [step for step, is_kept in self._steps if is_kept]
        if kept:
            self.add_message(schemas.PACKED_TOPIC, to_ns(float(kept[-1].samples.t_s[-1])), packed.encode(kept))
        self._add_revolutions([step for step, _ in self._steps])
        self._steps.clear()
        self._samples = 0

    def _add_revolutions(self, steps: list[Step]) -> None:
        """Add the revolutions that steps complete, or the one in progress if there are none."""
        channel = self._channel(schemas.REVOLUTION_TOPIC)
        layout, sequence = FixedRecords.of(channel, schemas.REVOLUTION), self._sequence.get(channel, 0)
        made = self._revolutions
        with np.errstate(over="ignore", invalid="ignore"):  # in single precision
            records = made.records(steps, layout, sequence) if steps else made.rest(layout, sequence)
        if len(records):
            self._numbers(channel, len(records))
            self._chunk().add_records(channel, records)

    def _numbers(self, channel: int, count: int) -> int:
        """Sequence number of the first of some further messages on a channel."""
        sequence = self._sequence.get(channel, 0)
        self._sequence[channel] = sequence + count
        return sequence

    def _channel(self, topic: str) -> int:
        """Number of a topic's channel, registered in the chunk at hand when it is new."""
        if topic not in self._channels:
            number = len(self._channels) + 1
            schema = self._schema(schemas.message_on(topic))
            self._channels[topic] = Channel(number, topic, schemas.ENCODING, {}, schema.id)
            self._chunk().add_record(self._channels[topic])
        return self._channels[topic].id

    def _schema(self, name: str) -> Schema:
        if name not in self._schemas:
            schema = Schema(len(self._schemas) + 1, schemas.descriptor_set(name), schemas.ENCODING, name)
            self._schemas[name] = schema
            self._chunk().add_record(schema)
        return self._schemas[name]

    def _note(self, chunk: FinishedChunk, start: int, index_length: int) -> None:
        """Keep what the summary section will say of a chunk."""
        offsets, at = {}, start + len(chunk.record)
        for channel, index in chunk.indexes.items():
            offsets[channel] = at
            at += len(index)
            self._counts[channel] = self._counts.get(channel, 0) + chunk.counts[channel]
        if chunk.counts:
            low, high = self._span or (chunk.start_ns, chunk.end_ns)
            self._span = (min(low, chunk.start_ns), max(high, chunk.end_ns))
        self._chunks.append(
            ChunkIndex(
                chunk_length=len(chunk.record),
                chunk_start_offset=start,
                compression=chunk.compression,
                compressed_size=chunk.compressed,
                message_end_time=chunk.end_ns,
                message_index_length=index_length,
                message_index_offsets=offsets,
                message_start_time=chunk.start_ns,
                uncompressed_size=chunk.size,
            )
        )

    def _summary(self) -> list[tuple[int, bytes]]:
        """Groups of the summary section with their opcodes; empty ones are left out."""
        low, high = self._span or (0, 0)
        statistics = Statistics(
            attachment_count=len(self._attachments),
            channel_count=len(self._channels),
            channel_message_counts=self._counts,
            chunk_count=len(self._chunks),
            message_count=sum(self._counts.values()),
            message_end_time=high,
            message_start_time=low,
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )
        groups: list[tuple[int, list[McapRecord]]] = [
            (Opcode.SCHEMA, list(self._schemas.values())),
            (Opcode.CHANNEL, list(self._channels.values())),
            (Opcode.STATISTICS, [statistics]),
            (Opcode.CHUNK_INDEX, list(self._chunks)),
            (Opcode.ATTACHMENT_INDEX, list(self._attachments)),
            (Opcode.METADATA_INDEX, list(self._metadata)),
        ]
        return [(opcode, b"".join(map(to_bytes, records))) for opcode, records in groups if records]
