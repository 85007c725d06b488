"""One chunk of an MCAP file that is being written: its messages, their index, its bytes."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass, field

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.records import Chunk, McapRecord, MessageIndex
from numpy.typing import NDArray

MESSAGE_OPCODE = 0x05
#: Opcode and length before every MCAP record.
RECORD_HEAD = 9
#: Record length without its head, channel, sequence, log time and publish time before a message's payload.
MESSAGE_HEAD = struct.Struct("<BQHIQQ")
MESSAGE_FIXED = 22
_COMPRESSION = "zstd"
_LEVEL = 1


def to_ns(t_s: float) -> int:
    """Machine time as the whole nanoseconds of a log time."""
    return round(t_s * 1e9)


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
    """Collects records."""

    size: int = 0
    _parts: list[bytes] = field(default_factory=list)
    _index: dict[int, list[tuple[int, int]]] = field(default_factory=dict)

    def add_record(self, record: McapRecord) -> None:
        """Take a schema or channel record."""
        self._append(to_bytes(record))

    def add_message(self, channel: int, sequence: int, time_ns: int, payload: bytes) -> None:
        """Take one message."""
        self._index.setdefault(channel, []).append((time_ns, self.size))
        head = MESSAGE_HEAD.pack(MESSAGE_OPCODE, MESSAGE_FIXED + len(payload), channel, sequence, time_ns, time_ns)
        self._append(head + payload)

    def add_records(self, channel: int, records: NDArray[np.void]) -> None:
        """Take whole message records of one size, shape (n,), with the field ``log_time``."""
        starts = range(self.size, self.size + records.nbytes, records.itemsize)
        self._index.setdefault(channel, []).extend(zip(records["log_time"].tolist(), starts, strict=True))
        self._append(records.tobytes())

    def finish(self) -> FinishedChunk:
        """The chunk's bytes."""
        data = b"".join(self._parts)
        times = [t for entries in self._index.values() for t, _ in entries]
        start, end = (min(times), max(times)) if times else (0, 0)
        compressed = zstandard.ZstdCompressor(level=_LEVEL).compress(data)
        chunk = Chunk(_COMPRESSION, compressed, end, start, zlib.crc32(data), len(data))
        return FinishedChunk(
            record=to_bytes(chunk),
            indexes={c: to_bytes(MessageIndex(c, entries)) for c, entries in self._index.items()},
            counts={c: len(entries) for c, entries in self._index.items()},
            start_ns=start,
            end_ns=end,
            size=len(data),
            compressed=len(compressed),
        )

    def _append(self, data: bytes) -> None:
        self._parts.append(data)
        self.size += len(data)
