"""Files that are small and claim or unpack to much: refused before any of it is in memory."""

from __future__ import annotations

import struct
import tracemalloc
import zlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import lz4.frame
import pytest
import zstandard
from mcap.opcode import Opcode
from mcap.records import Chunk

from twin.archive import read_run, run_info
from twin.archive.container.chunk import to_bytes
from twin.archive.foreign import read_numbers
from twin.errors import ArchiveError
from twin.record import Record

#: Bytes above which the share of the stored bytes counts.
BIG = 3 << 24
MAGIC = b"\x89MCAP0\r\n"


@cache
def zeros_in_lz4(size: int) -> bytes:
    return bytes(lz4.frame.compress(bytes(size)))


def chunk(compression: str, data: bytes, size: int) -> bytes:
    return to_bytes(Chunk(compression, data, 0, 0, 0, size))


def zstd_frame_stating(size: int) -> bytes:
    """The head of a frame that states its size, and one empty block."""
    return b"\x28\xb5\x2f\xfd\xe0" + struct.pack("<Q", size) + b"\x01\x00\x00"


@cache
def zstd_of(size: int) -> bytes:
    return zstandard.ZstdCompressor().compress(bytes(size))


@cache
def zstd_without_size(size: int) -> bytes:
    return zstandard.ZstdCompressor(write_content_size=False).compress(bytes(size))


BOMBS: dict[str, Callable[[], bytes]] = {
    "zstd": lambda: chunk("zstd", zstd_of(BIG), BIG),
    "lz4": lambda: chunk("lz4", zeros_in_lz4(BIG), BIG),
    "frame that claims 2^40": lambda: chunk("zstd", zstd_frame_stating(1 << 40), 1 << 40),
    "chunk that claims 2^63": lambda: chunk("", b"", 1 << 63),
    "zstd, states less": lambda: chunk("zstd", zstd_of(BIG), 1000),
    "zstd without a size, states less": lambda: chunk("zstd", zstd_without_size(BIG), 1000),
    "zstd without a size, states nothing": lambda: chunk("zstd", zstd_without_size(BIG), 0),
    "lz4, states less": lambda: chunk("lz4", zeros_in_lz4(BIG), 1000),
    "states more than there is": lambda: chunk("lz4", lz4.frame.compress(bytes(1000)), 1 << 24),
    "many chunks": lambda: chunk("zstd", zstd_of(1 << 25), 1 << 25) * 9,
    "record of 2^40 bytes": lambda: struct.pack("<BQ", Opcode.CHUNK, 1 << 40) + bytes(100),
    "record in a chunk of 2^40 bytes": lambda: chunk("", struct.pack("<BQ", 5, 1 << 40) + bytes(40), 49),
    "zeros": lambda: chunk("zstd", zstd_of(1 << 20), 1 << 20),
    "data longer than the record": lambda: struct.pack("<BQQQQIIQ", 6, 240, 0, 0, 0, 0, 0, 1 << 40) + b"x" * 200,
}


@pytest.fixture
def head(run_records: list[Record], write: Callable[..., Path]) -> bytes:
    """A run's file up to its first chunk."""
    data = write(run_records).read_bytes()
    return data[: data.index(b"zstd") - 41]


@pytest.fixture
def bounded() -> Any:
    tracemalloc.start()
    yield
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 4.5e7


@pytest.mark.parametrize("bomb", BOMBS)
def test_in_a_run(bomb: str, head: bytes, tmp_path: Path, bounded: None) -> None:
    path = tmp_path / "bomb.mcap"
    tracemalloc.stop()
    path.write_bytes(head + BOMBS[bomb]())
    tracemalloc.start()
    with pytest.raises(ArchiveError, match=rf"^{path}: damaged at byte \d+: .*(chunk|frame|record)"):
        list(read_run(path))
    assert "damaged at byte" in str(run_info(path).damage)


@pytest.mark.parametrize("bomb", BOMBS)
def test_in_a_log(bomb: str, tmp_path: Path, bounded: None) -> None:
    path = tmp_path / "bomb.mcap"
    tracemalloc.stop()
    data_end = struct.pack("<BQI", Opcode.DATA_END, 4, 0)
    footer = struct.pack("<BQQQI", Opcode.FOOTER, 20, 0, 0, 0)
    header = struct.pack("<BQII", Opcode.HEADER, 8, 0, 0)
    path.write_bytes(MAGIC + header + BOMBS[bomb]() + data_end + footer + MAGIC)
    tracemalloc.start()
    with pytest.raises(ArchiveError, match=rf"^{path}: damaged at byte \d+: .*(chunk|frame|record)"):
        read_numbers(path)


def test_lz4_is_read(head: bytes, write: Callable[..., Path], run_records: list[Record], tmp_path: Path) -> None:
    """Another program may have compressed the chunks anew."""
    data = write(run_records, "again.mcap").read_bytes()
    begin = len(head)
    length = int.from_bytes(data[begin + 1 : begin + 9], "little")
    old = data[begin + 9 : begin + 9 + length]
    plain = zstandard.ZstdDecompressor().decompress(old[old.index(b"zstd") + 12 :])
    made = to_bytes(Chunk("lz4", lz4.frame.compress(plain), 0, 0, zlib.crc32(plain), len(plain)))
    path = tmp_path / "lz4.mcap"
    path.write_bytes(head + made)
    assert len(list(read_run(path))) == len(run_records) - 1
