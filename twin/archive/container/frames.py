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

from google.protobuf.message import DecodeError
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from mcap.records import Attachment as AttachmentRecord
from mcap.records import Footer, Header
from mcap.records import Metadata as MetadataRecord

from twin.archive import run_metadata, schemas
from twin.archive.container.container import MAGIC
from twin.archive.container.partial import partial_path, reason
from twin.archive.container.unpack import HEAD_BYTES, SHORT_HEAD_BYTES, ChunkError, ChunkHead
from twin.errors import ArchiveError
from twin.record import Attachment

#: Opcode and length before every record.
HEAD = struct.Struct("<BQ")
#: Errors that the libraries raise on inconsistent bytes.
DAMAGE = (ValueError, KeyError, TypeError, AttributeError, OverflowError, struct.error, McapError, DecodeError)
#: Footer record and closing magic: the last bytes of a complete file.
FOOTER_BYTES = HEAD.size + 20 + len(MAGIC)
_FIXED_LENGTHS: dict[int, int] = {Opcode.FOOTER: 20, Opcode.DATA_END: 4}
_PIECE = 1 << 20


def stream(body: bytes) -> ReadDataStream:
    """Input of the ``read`` functions of `mcap.records`."""
    return _Content(io.BytesIO(body))


@dataclass(frozen=True, slots=True)
class Head:
    """Opcode and length of one record of the file.

    Attributes:
        offset: position of its first byte.
        length: of its content.
    """

    offset: int
    opcode: int
    length: int

    @property
    def end(self) -> int:
        """Position of the next record."""
        return self.offset + HEAD.size + self.length


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


class _Content(ReadDataStream):
    """The content of a record; bytes beyond its end are an error, where the library gives those that are there."""

    def read(self, length: int) -> bytes:
        data = super().read(length)
        if len(data) < length:
            raise EndOfFile
        return data


class McapFile:
    """An MCAP file, open for reading; a context manager.

    Attributes:
        kind: the file that is expected, for messages.

    Raises:
        ArchiveError: no such file, or not an MCAP file.
    """

    kind = "an MCAP file"

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
        """Records from a position on, up to the footer or to the last complete one.

        Raises:
            ArchiveError: damaged.
        """
        for head in self.heads(start):
            yield self.frame(head)

    def heads(self, start: int = len(MAGIC)) -> Iterator[Head]:
        """As `frames`, without reading the records' content.

        Raises:
            ArchiveError: damaged.
        """
        offset = start
        while (head := self._head(offset)) is not None:
            yield head
            offset = head.end
            if head.opcode == Opcode.FOOTER:
                return

    def frame(self, head: Head) -> Frame:
        """A record with its content."""
        return Frame(head.offset, head.opcode, self.read(head.offset + HEAD.size, head.length))

    def footer(self) -> Footer | None:
        """The footer, or None for an incomplete file.

        Raises:
            ArchiveError: the file has its end, but no footer before it.
        """
        start = self.size - FOOTER_BYTES
        if start < len(MAGIC) or self.read(self.size - len(MAGIC), len(MAGIC)) != MAGIC:
            return None
        head = HEAD.unpack(self.read(start, HEAD.size))
        if head != (Opcode.FOOTER, 20):
            raise self.damaged(start, "no footer before the end of the file")
        found: Footer = Footer.read(stream(self.read(start + HEAD.size, 20)))
        return found

    def chunk_head(self, head: Head) -> ChunkHead:
        """The fields of a chunk.

        Raises:
            ArchiveError: damaged.
        """
        try:
            return ChunkHead.read(self.read(head.offset + HEAD.size, min(head.length, HEAD_BYTES)), head.length)
        except ChunkError as error:
            raise self.damaged(head.offset, str(error)) from error

    def unpack(self, frame: Frame) -> bytes:
        """The records inside a chunk.

        Raises:
            ArchiveError: damaged, too large, or compressed by an unknown method.
        """
        try:
            return ChunkHead.read(frame.body, len(frame.body)).unpack(frame.body)
        except ChunkError as error:
            raise self.damaged(frame.offset, str(error)) from error

    def attachment(self, frame: Frame) -> Attachment:
        """An attached file.

        Raises:
            ArchiveError: damaged.
        """
        if zlib.crc32(frame.body[:-4]) != int.from_bytes(frame.body[-4:], "little"):
            raise self.damaged(frame.offset)
        found = AttachmentRecord.read(stream(frame.body))
        return Attachment(name=found.name, media_type=found.media_type, data=found.data)

    def read(self, offset: int, length: int) -> bytes:
        """Bytes of the file, fewer at its end.

        Raises:
            ArchiveError: the file cannot be read.
        """
        try:
            self._file.seek(offset)
            return self._file.read(length)
        except OSError as error:
            raise ArchiveError(f"{self.path}: cannot be read: {reason(error)}") from error

    def damaged(self, offset: int, problem: str = "") -> ArchiveError:
        """The error for an inconsistent record."""
        return ArchiveError(f"{self.path}: damaged at byte {offset}{problem and f': {problem}'}")

    def _check_kind(self) -> None:
        if not self.size:
            raise ArchiveError(f"{self.path}: is empty, expected {self.kind}")
        if (begin := self.read(0, len(MAGIC))) != MAGIC:
            what = "ends within its first bytes" if MAGIC.startswith(begin) else "is not an MCAP file"
            raise ArchiveError(f"{self.path}: {what}, expected {self.kind}")

    def _head(self, offset: int) -> Head | None:
        """Opcode and length of the record at a position; None where the file ends within it."""
        raw = self.read(offset, HEAD.size)
        if len(raw) < HEAD.size:
            return None
        opcode, length = HEAD.unpack(raw)
        if not opcode:
            if not self._zeros_from(offset):
                raise self.damaged(offset, "zeros in place of a record")
            return None
        head = Head(offset, opcode, length)
        try:
            self._check_frame(head)
        except ArchiveError:
            tail = offset + HEAD.size + HEAD_BYTES
            if tail < self.size and self._zeros_from(tail):
                return None
            raise
        return head if head.end <= self.size else None

    def _zeros_from(self, offset: int) -> bool:
        """Whether the rest of the file is zeros, as a crash of the system may leave it: an early end, not damage."""
        at = offset
        while piece := self.read(at, _PIECE):
            if piece.strip(b"\0"):
                return False
            at += len(piece)
        return True

    def _check_frame(self, head: Head) -> None:
        """Lengths that can be derived from what is in the record must agree with its frame."""
        fixed = _FIXED_LENGTHS.get(head.opcode, head.length)
        if head.length != fixed:
            raise self.damaged(head.offset, f"a record of {head.length} bytes, expected {fixed}")
        if head.opcode == Opcode.CHUNK and self.size - head.offset - HEAD.size >= min(head.length, SHORT_HEAD_BYTES):
            self.chunk_head(head)
        elif head.opcode == Opcode.MESSAGE_INDEX and len(raw := self.read(head.offset + HEAD.size, 6)) == 6:
            length = 6 + int.from_bytes(raw[2:], "little")
            if head.length != length:
                raise self.damaged(head.offset, f"a message index of {head.length} bytes, expected {length}")

    def _hint(self) -> str:
        partial = partial_path(self.path)
        return f"; a run that did not finish is kept in {partial}" if partial.exists() else ""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()


class RunFile(McapFile):
    """A run's file.

    Raises:
        ArchiveError: no such file, not an MCAP file, or one of another program.
    """

    kind = "a run's MCAP file"
    #: Name and version of the program that wrote the file.
    library = ""

    def values(self, frame: Frame) -> tuple[str, dict[str, str]]:
        """Name and values of a metadata record.

        Raises:
            ChunkError: their checksum is wrong.
        """
        content = stream(frame.body)
        found = MetadataRecord.read(content)
        if content.count != len(frame.body):
            raise ChunkError("metadata that are shorter than their record")
        required = self.library.endswith(schemas.WITH_CHECKSUMS)
        return found.name, run_metadata.unsealed(found.metadata, required=required)

    def _check_kind(self) -> None:
        super()._check_kind()
        first = self._head(len(MAGIC))
        if first is None or first.opcode != Opcode.HEADER:
            raise ArchiveError(f"{self.path}: ends within its first bytes, expected {self.kind}")
        try:
            header = Header.read(stream(self.frame(first).body))
        except DAMAGE:
            raise self.damaged(first.offset) from None
        if header.profile != schemas.PROFILE:
            raise ArchiveError(f"{self.path}: an MCAP file of profile {header.profile!r}, expected {schemas.PROFILE!r}")
        self.library = header.library

    def _check_frame(self, head: Head) -> None:
        if head.opcode > Opcode.DATA_END:
            raise self.damaged(head.offset, f"a record of the unknown kind 0x{head.opcode:02X}")
        super()._check_frame(head)
