"""Mutations inside the chunks of an MCAP file, whose checksums would otherwise hide them from the decoder."""

from __future__ import annotations

import random

import zstandard
from mcap.opcode import Opcode
from mcap.records import Chunk

from support.fuzz.mutations import binary_mutated
from twin.archive.container.chunk import to_bytes
from twin.archive.container.unpack import ChunkHead

_MAGIC = 8


def inside_mutated(source: random.Random, data: bytes) -> bytes:
    """A file that ends after its first chunk, with a mutation inside that, or one of its bytes."""
    if source.random() < 0.4:
        return binary_mutated(source, data)
    at = _MAGIC
    while at + 9 < len(data):
        length = int.from_bytes(data[at + 1 : at + 9], "little")
        if data[at] == Opcode.CHUNK:
            return data[:at] + _packed(source, data[at + 9 : at + 9 + length])
        at += 9 + length
    return binary_mutated(source, data)


def _packed(source: random.Random, content: bytes) -> bytes:
    try:
        records = ChunkHead.read(content, len(content)).unpack(content)
    except ValueError:
        return content
    records = binary_mutated(source, records) if records else records
    return to_bytes(Chunk("zstd", zstandard.ZstdCompressor().compress(records), 0, 0, 0, len(records)))
