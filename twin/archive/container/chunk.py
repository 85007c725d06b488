"""One chunk of an MCAP file that is being written: its messages, their index, its bytes."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Chunk, McapRecord, MessageIndex
from numpy.typing import NDArray

from twin.archive.forces import MESSAGE_OPCODE, RECORD, ForceLayout
from twin.arrays import places_in_runs
from twin.record import Step

#: Record length without its head, channel, sequence, log time and publish time before a message's payload.
MESSAGE_HEAD = struct.Struct("<BQHIQQ")
MESSAGE_FIXED = 22
_INDEX_HEAD = struct.Struct("<BQHI")
_COMPRESSION = "zstd"
_LEVEL = 1


def to_bytes(record: McapRecord) -> bytes:
    """The bytes of a record in a file."""
    builder = RecordBuilder()
    record.write(builder)
    return bytes(builder.end())  # type: ignore[no-untyped-call]


@dataclass(frozen=True, slots=True, kw_only=True)
class FinishedChunk:
    """The bytes of a chunk, and its entries in the summary section.

    Attributes:
        record: the chunk record.
        indexes: message index record of each channel.
        counts: number of messages on each channel.
        size: uncompressed size of the messages, compressed: as stored.
    """

    record: bytes
    indexes: dict[int, bytes]
    counts: dict[int, int]
    start_ns: int
    end_ns: int
    size: int
    compressed: int
    compression: str = _COMPRESSION


@dataclass(slots=True)
class ChunkBuilder:
    """Collects records; the force samples of the steps are encoded together when the chunk is finished."""

    layout: ForceLayout
    force_channel: int
    size: int = 0
    _parts: list[bytes | None] = field(default_factory=list)
    _index: dict[int, list[tuple[int, int]]] = field(default_factory=dict)
    _steps: list[Step] = field(default_factory=list)
    _starts: list[int] = field(default_factory=list)

    def add_record(self, record: McapRecord) -> None:
        """Take a schema or channel record."""
        self._append(to_bytes(record))

    def add_message(self, channel: int, sequence: int, time_ns: int, payload: bytes) -> None:
        """Take one message."""
        self._index.setdefault(channel, []).append((time_ns, self.size))
        head = MESSAGE_HEAD.pack(MESSAGE_OPCODE, MESSAGE_FIXED + len(payload), channel, sequence, time_ns, time_ns)
        self._append(head + payload)

    def add_forces(self, step: Step) -> None:
        """Take the samples of one step."""
        self._steps.append(step)
        self._starts.append(self.size)
        self._parts.append(None)
        self.size += len(step.samples.t_s) * RECORD.itemsize

    def finish(self, force_sequence: int) -> FinishedChunk:
        """The chunk's bytes.

        Args:
            force_sequence: number of the first force message on its channel.
        """
        forces = self.layout.encode(self._steps, force_sequence)
        data = b"".join(self._pieces(forces.data.cast("B")))
        times = [t for entries in self._index.values() for t, _ in entries]
        if len(forces):
            times += [int(forces["log_time"].min()), int(forces["log_time"].max())]
        start, end = (min(times), max(times)) if times else (0, 0)
        compressed = zstandard.ZstdCompressor(level=_LEVEL).compress(data)
        chunk = Chunk(_COMPRESSION, compressed, end, start, zlib.crc32(data), len(data))
        indexes = {c: to_bytes(MessageIndex(c, entries)) for c, entries in self._index.items()}
        counts = {c: len(entries) for c, entries in self._index.items()}
        if len(forces):
            indexes[self.force_channel] = self._force_index(forces)
            counts[self.force_channel] = len(forces)
        return FinishedChunk(
            record=to_bytes(chunk),
            indexes=indexes,
            counts=counts,
            start_ns=start,
            end_ns=end,
            size=len(data),
            compressed=len(compressed),
        )

    def _append(self, data: bytes) -> None:
        self._parts.append(data)
        self.size += len(data)

    def _pieces(self, forces: memoryview) -> Iterator[bytes | memoryview]:
        """The records in order, the force records of each step among them."""
        sizes = iter([len(s.samples.t_s) * RECORD.itemsize for s in self._steps])
        done = 0
        for part in self._parts:
            if part is None:
                size = next(sizes)
                yield forces[done : done + size]
                done += size
            else:
                yield part

    def _force_index(self, forces: NDArray[np.void]) -> bytes:
        """Message index record of the force channel, from arrays."""
        counts = np.array([len(s.samples.t_s) for s in self._steps])
        first = np.repeat(np.array(self._starts), counts)
        entries = np.empty((len(forces), 2), "<u8")
        entries[:, 0] = forces["log_time"]
        entries[:, 1] = first + places_in_runs(counts) * RECORD.itemsize
        head = _INDEX_HEAD.pack(Opcode.MESSAGE_INDEX, 6 + entries.nbytes, self.force_channel, entries.nbytes)
        return head + entries.tobytes()
