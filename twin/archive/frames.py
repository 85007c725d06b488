"""The records of an MCAP file in order, also of a file that ends within a record."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

import zstandard
from google.protobuf.message import DecodeError
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment as AttachmentRecord
from mcap.records import Chunk, Footer, Header

from twin.archive import schemas
from twin.archive.container.container import MAGIC
from twin.archive.container.partial import partial_path, reason
from twin.errors import ArchiveError
from twin.record import Attachment

#: Opcode and length before every record.
HEAD = struct.Struct("<BQ")
#: Errors that the libraries raise on inconsistent bytes.
DAMAGE = (ValueError, KeyError, TypeError, struct.error, McapError, DecodeError)
#: Footer record and closing magic: the last bytes of a complete file.
FOOTER_BYTES = HEAD.size + 20 + len(MAGIC)


def stream(body: bytes) -> ReadDataStream:
    """Input of the ``read`` functions of `mcap.records`."""
    return ReadDataStream(io.BytesIO(body))


@dataclass(frozen=True, slots=True)
class Frame:
    """One record of the file.

    Attributes:
        offset: position of its first byte.
        body: its content, without opcode and length.
    """

    offset: int
    opcode: int
    body: bytes


class RunFile:
    """A run's file, open for reading; a context manager.

    Raises:
        ArchiveError: no such file, not an MCAP file, or one of another program.
    """

    def __init__(self, path: str | PathLike[str]) -> None:
        self.path = Path(path)
        try:
            self._file: BinaryIO = self.path.open("rb")
            self.size = self._file.seek(0, io.SEEK_END)
        except OSError as error:
            raise ArchiveError(f"{self.path}: cannot be read: {reason(error)}{self._hint()}") from error
        try:
            self._check_kind()
        except BaseException:
            self._file.close()
            raise

    def frames(self, start: int = len(MAGIC)) -> Iterator[Frame]:
        """Records from a position on, up to the footer or to the last complete one."""
        offset = start
        while (frame := self._frame(offset)) is not None:
            yield frame
            offset += HEAD.size + len(frame.body)
            if frame.opcode == Opcode.FOOTER:
                return

    def footer(self) -> Footer | None:
        """The footer, or None for an incomplete file."""
        start = self.size - FOOTER_BYTES
        if start < len(MAGIC) or self._read(self.size - len(MAGIC), len(MAGIC)) != MAGIC:
            return None
        frame = self._frame(start)
        return Footer.read(stream(frame.body)) if frame is not None and frame.opcode == Opcode.FOOTER else None

    def unpack(self, frame: Frame) -> bytes:
        """The records inside a chunk.

        Raises:
            ArchiveError: damaged, or compressed by an unknown method.
        """
        chunk = Chunk.read(stream(frame.body))
        data = self._decompress(chunk, frame.offset)
        if chunk.uncompressed_crc not in (0, zlib.crc32(data)):
            raise self.damaged(frame.offset)
        return data

    def attachment(self, frame: Frame) -> Attachment:
        """An attached file.

        Raises:
            ArchiveError: damaged.
        """
        if zlib.crc32(frame.body[:-4]) != int.from_bytes(frame.body[-4:], "little"):
            raise self.damaged(frame.offset)
        found = AttachmentRecord.read(stream(frame.body))
        return Attachment(name=found.name, media_type=found.media_type, data=found.data)

    def damaged(self, offset: int) -> ArchiveError:
        """The error for an inconsistent record."""
        return ArchiveError(f"{self.path}: damaged at byte {offset}")

    def _check_kind(self) -> None:
        if not self.size:
            raise ArchiveError(f"{self.path}: is empty, expected a run's MCAP file")
        if (begin := self._read(0, len(MAGIC))) != MAGIC:
            what = "ends within its first bytes" if MAGIC.startswith(begin) else "is not an MCAP file"
            raise ArchiveError(f"{self.path}: {what}, expected a run's MCAP file")
        first = self._frame(len(MAGIC))
        if first is None or first.opcode != Opcode.HEADER:
            raise ArchiveError(f"{self.path}: ends within its first bytes, expected a run's MCAP file")
        try:
            profile = Header.read(stream(first.body)).profile
        except DAMAGE:
            raise self.damaged(first.offset) from None
        if profile != schemas.PROFILE:
            raise ArchiveError(f"{self.path}: an MCAP file of profile {profile!r}, expected {schemas.PROFILE!r}")

    def _frame(self, offset: int) -> Frame | None:
        head = self._read(offset, HEAD.size)
        if len(head) < HEAD.size:
            return None
        opcode, length = HEAD.unpack(head)
        if not opcode or offset + HEAD.size + length > self.size:
            return None
        return Frame(offset, opcode, self._read(offset + HEAD.size, length))

    def _read(self, offset: int, length: int) -> bytes:
        try:
            self._file.seek(offset)
            return self._file.read(length)
        except OSError as error:
            raise ArchiveError(f"{self.path}: cannot be read: {reason(error)}") from error

    def _decompress(self, chunk: Chunk, offset: int) -> bytes:
        if chunk.compression == "":
            return chunk.data
        if chunk.compression != "zstd":
            raise ArchiveError(f"{self.path}: compressed by {chunk.compression!r}, expected 'zstd' or nothing")
        try:
            if zstandard.frame_content_size(chunk.data) not in (-1, chunk.uncompressed_size):
                raise self.damaged(offset)
            return zstandard.ZstdDecompressor().decompress(chunk.data, max_output_size=chunk.uncompressed_size)
        except zstandard.ZstdError:
            raise self.damaged(offset) from None

    def _hint(self) -> str:
        partial = partial_path(self.path)
        return f"; a run that did not finish is kept in {partial}" if partial.exists() else ""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
