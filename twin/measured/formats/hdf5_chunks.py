"""Compressed chunks of HDF5 data sets, checked before the library unpacks them: it does not bound the size."""

from __future__ import annotations

import math
import zlib
from pathlib import Path
from typing import Any

from twin.errors import MeasuredError
from twin.measured.formats.bounds import most_bytes

_DEFLATE = 1
#: Most bytes that one byte of deflated data makes.
_MOST_DEFLATED = 1032
#: Bytes of checksums behind a chunk.
_TRAILER_BYTES = 64
_PIECE_BYTES = 1 << 20


def check_chunks(path: Path, node: Any) -> None:
    """Refuse a data set with a chunk that unpacks to more than its shape holds.

    A chunk that deflating does not shorten is stored as is, so a stored chunk is never longer than its shape. Only a
    chunk that could unpack beyond the file's bound is unpacked here, piece by piece, and counted.

    Args:
        node: an open data set.

    Raises:
        MeasuredError: such a chunk.
    """
    properties = node.id.get_create_plist()
    filters = [properties.get_filter(i)[0] for i in range(properties.get_nfilters())]
    if _DEFLATE not in filters or node.chunks is None:
        return
    holds = math.prod(node.chunks) * node.dtype.itemsize
    most_stored = most_bytes(path) // _MOST_DEFLATED
    doubtful: list[tuple[int, ...]] = []

    def visit(chunk: Any) -> None:
        if chunk.size > holds + _TRAILER_BYTES:
            raise MeasuredError(
                f"{path}: data set {node.name}: a chunk of {chunk.size} bytes, expected at most {holds}: the file is "
                "damaged"
            )
        if chunk.size > most_stored:
            doubtful.append(chunk.chunk_offset)

    node.id.chunk_iter(visit)
    for offset in doubtful:
        _count(path, node, offset, holds)


def _count(path: Path, node: Any, offset: tuple[int, ...], holds: int) -> None:
    """Unpack one chunk without keeping it."""
    mask, data = node.id.read_direct_chunk(offset)
    if mask:
        return
    unpacker, found = zlib.decompressobj(), 0
    while data and not unpacker.eof:
        try:
            found += len(unpacker.decompress(data, _PIECE_BYTES))
        except zlib.error:
            return  # the library reports it
        data = unpacker.unconsumed_tail
        if found > holds:
            raise MeasuredError(
                f"{path}: data set {node.name}: a chunk that unpacks to more than {holds} bytes: the file is damaged"
            )
