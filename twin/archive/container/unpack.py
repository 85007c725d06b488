"""Chunks of MCAP files: their fields, and their records unpacked, with bounds on the size."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass

import lz4.frame
import zstandard

#: Largest chunk, in bytes, unpacked. One step of a run, or one message of a log, never needs as much.
MOST_BYTES = 1 << 30
#: A chunk above this size, unpacked, must not have more than `MOST_RATIO` times the bytes that it has in the file.
#: Measured logs and runs of this program stay below 50: at least the time of every message differs from the last one.
FREE_BYTES = 1 << 25
MOST_RATIO = 200

_FIXED = struct.Struct("<QQQII")
_LENGTH = struct.Struct("<Q")
#: This much of a chunk record's content has all fields but the data; a compression's name is short.
HEAD_BYTES = _FIXED.size + 64 + _LENGTH.size
#: The same for the compressions that exist: a file that ends in a chunk before this ends early.
SHORT_HEAD_BYTES = _FIXED.size + 4 + _LENGTH.size


class ChunkError(ValueError):
    """A chunk that is damaged, or too large."""


@dataclass(frozen=True, slots=True)
class ChunkHead:
    """The fields of a chunk record.

    Attributes:
        start_ns, end_ns: lowest and highest log time.
        size: bytes of its records, unpacked.
        crc: of these, 0 where the writer computed none.
        compression: ``zstd``, ``lz4`` or nothing.
        data_start: position of the stored data in the record's content.
        stored: number of stored bytes.
    """

    start_ns: int
    end_ns: int
    size: int
    crc: int
    compression: str
    data_start: int
    stored: int

    @classmethod
    def read(cls, content: bytes, length: int) -> ChunkHead:
        """The fields, checked against each other.

        Args:
            content: the record's content, at least its first `HEAD_BYTES`.
            length: length of the content by the record's frame.

        Raises:
            ChunkError: they do not agree, or the chunk is too large when unpacked.
        """
        if len(content) < _FIXED.size:
            raise ChunkError("a chunk without its fields")
        start_ns, end_ns, size, crc, name = _FIXED.unpack_from(content)
        data_start = _FIXED.size + name + _LENGTH.size
        if data_start > len(content):
            raise ChunkError("a chunk without its fields")
        stored = _LENGTH.unpack_from(content, data_start - _LENGTH.size)[0]
        if data_start + stored != length:
            raise ChunkError(f"a chunk of {length} bytes whose fields give {data_start + stored}")
        _check_size(size, stored)
        compression = content[_FIXED.size : _FIXED.size + name].decode("utf-8", "replace")
        return cls(start_ns, end_ns, size, crc, compression, data_start, stored)

    def unpack(self, content: bytes) -> bytes:
        """The records in the chunk.

        Args:
            content: the whole content of the record.

        Raises:
            ChunkError: damaged, or compressed by an unknown method.
        """
        data = _unpacked(self.compression, memoryview(content)[self.data_start :], self.size)
        if len(data) != self.size:
            raise ChunkError(f"a chunk that does not unpack to the {self.size} bytes that it states")
        if self.crc not in (0, zlib.crc32(data)):
            raise ChunkError("a chunk whose checksum is wrong")
        return data


def _check_size(size: int, stored: int) -> None:
    if size > MOST_BYTES:
        raise ChunkError(f"a chunk of {size} bytes unpacked, expected at most {MOST_BYTES}")
    if size > FREE_BYTES and size > MOST_RATIO * stored:
        raise ChunkError(f"a chunk of {stored} bytes that states {size} unpacked, expected at most {MOST_RATIO} times")


def _unpacked(compression: str, stored: memoryview, size: int) -> bytes:
    """The data; never more than one byte above ``size``, however much is in ``stored``."""
    try:
        if compression == "":
            return bytes(stored)
        if compression == "zstd":
            return _zstd(stored, size)
        if compression == "lz4":
            return bytes(lz4.frame.LZ4FrameDecompressor().decompress(bytes(stored), max_length=size + 1))
    except (zstandard.ZstdError, RuntimeError, EOFError) as error:
        raise ChunkError("a chunk that cannot be unpacked") from error
    raise ChunkError(f"a chunk compressed by {compression!r}, expected 'zstd', 'lz4' or nothing")


def _zstd(stored: memoryview, size: int) -> bytes:
    stated = zstandard.frame_content_size(stored)
    if stated not in (-1, size):
        raise ChunkError(f"a chunk of {size} bytes whose compressed data state {stated}")
    return zstandard.ZstdDecompressor().decompress(stored, max_output_size=size)
