"""Whether a run's file is whole: its frames against its index, its counts, its checksums."""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, MetadataIndex, Statistics

from twin.archive.container.container import MAGIC
from twin.archive.container.frames import DAMAGE, FOOTER_BYTES, HEAD, Frame, Head, McapFile, stream
from twin.archive.container.unpack import MOST_RATIO

#: A file whose chunks have more than this together, unpacked, must not have more than `MOST_RATIO` times its own size.
FREE_TOTAL_BYTES = 1 << 26
#: Bytes of the footer that the checksum of the summary section covers: all but the checksum itself.
_FOOTER_CHECKED = HEAD.size + 16
_PIECE = 1 << 20


@dataclass(slots=True)
class FileIndex:
    """The summary section of a file.

    Attributes:
        start: position of its first byte.
        topics: topic of each channel.
        chunks: entry of each chunk, by its position.
        metadata: position of each metadata record, by its name.
        statistics: counts, None where the writer stored none.
    """

    start: int
    topics: dict[int, str] = field(default_factory=dict)
    chunks: dict[int, ChunkIndex] = field(default_factory=dict)
    metadata: dict[str, int] = field(default_factory=dict)
    statistics: Statistics | None = None

    @property
    def counts(self) -> dict[str, int]:
        """Number of messages by topic."""
        counts: Counter[str] = Counter()
        if self.statistics is not None:
            for channel, n in self.statistics.channel_message_counts.items():
                counts[self.topics[channel]] += n
        return dict(counts)

    def take(self, frame: Frame) -> None:
        """Add one record of the section."""
        if frame.opcode == Opcode.CHANNEL:
            channel = Channel.read(stream(frame.body))
            self.topics[channel.id] = channel.topic
        elif frame.opcode == Opcode.STATISTICS:
            self.statistics = Statistics.read(stream(frame.body))
        elif frame.opcode == Opcode.CHUNK_INDEX:
            entry = ChunkIndex.read(stream(frame.body))
            self.chunks[entry.chunk_start_offset] = entry
        elif frame.opcode == Opcode.METADATA_INDEX:
            found = MetadataIndex.read(stream(frame.body))
            self.metadata[found.name] = found.offset


def checked_index(file: McapFile) -> FileIndex | None:
    """The index of a file whose frames were checked against it; None for a file that ends early or has no index.

    No record is unpacked, so this takes milliseconds, however long the run is.

    Raises:
        ArchiveError: damaged.
    """
    footer = file.footer()
    data = _Data(file)
    if footer is None:
        data.read_to_early_end()
        return None
    for head in file.heads():
        if head.opcode in (Opcode.DATA_END, Opcode.FOOTER):
            break
        data.take(head)
    else:
        raise file.damaged(data.end, "the last record before the end of the file is not whole")
    if not footer.summary_start:
        return None
    if head.opcode != Opcode.DATA_END or head.end != footer.summary_start:
        moved = footer.summary_start - head.end
        problem = f"{abs(moved)} bytes of the data are {'missing' if moved > 0 else 'too many'}" if moved else "no end"
        raise file.damaged(head.offset, problem)
    index = _index(file, footer.summary_start, footer.summary_crc)
    data.compare(index)
    return index


def check_data(file: McapFile) -> None:
    """Check the checksum of the whole data section, if the writer stored one.

    Raises:
        ArchiveError: damaged.
    """
    crc, done = 0, 0
    for head in file.heads():
        if head.opcode == Opcode.DATA_END:
            stored = int.from_bytes(file.frame(head).body, "little")
            for piece in _pieces(file, done, head.offset):
                crc = zlib.crc32(piece, crc)
            if stored not in (0, crc):
                raise file.damaged(head.offset, "the checksum of all data is wrong")
            return


def compare_counts(file: McapFile, index: FileIndex, counts: Counter[str], only: str | None = None) -> None:
    """Compare the messages that were read with the file's statistics.

    Args:
        only: topic that was read; None for all.

    Raises:
        ArchiveError: other numbers.
    """
    for topic, n in index.counts.items():
        if counts[topic] != n and only in (None, topic):
            raise file.damaged(index.start, f"{counts[topic]} of {n} messages on {topic}")


@dataclass(slots=True)
class _Data:
    """The records of the data section, from their frames."""

    file: McapFile
    end: int = len(MAGIC)
    size: int = 0
    chunks: list[Head] = field(default_factory=list)
    kinds: Counter[int] = field(default_factory=Counter)

    def take(self, head: Head) -> None:
        self.end = head.end
        self.kinds[head.opcode] += 1
        if head.opcode == Opcode.CHUNK:
            self.chunks.append(head)
            self.size += self.file.chunk_head(head).size
            if self.size > (most := max(FREE_TOTAL_BYTES, MOST_RATIO * self.file.size)):
                raise self.file.damaged(head.offset, f"chunks of {self.size} bytes unpacked, expected at most {most}")

    def read_to_early_end(self) -> None:
        """Read a file without a footer: it may end within a record, but not after its last one."""
        for head in self.file.heads():
            if head.opcode == Opcode.FOOTER:
                rest = self.file.read(head.end, len(MAGIC) + 1)
                if not MAGIC.startswith(rest):
                    raise self.file.damaged(head.end, "expected the end of the file")
            self.take(head)

    def compare(self, index: FileIndex) -> None:
        """Compare with the index; files of writers that store no chunk index or statistics pass."""
        if index.chunks:
            for head in self.chunks:
                self._compare_chunk(head, index.chunks.get(head.offset))
            if lost := sorted(set(index.chunks) - {head.offset for head in self.chunks}):
                raise self.file.damaged(lost[0], "no chunk where the index has one")
        if (found := index.statistics) is None:
            return
        stated = {Opcode.CHUNK: found.chunk_count, Opcode.ATTACHMENT: found.attachment_count}
        stated[Opcode.METADATA] = found.metadata_count
        for kind, n in stated.items():
            if self.kinds[kind] != n:
                raise self.file.damaged(index.start, f"{self.kinds[kind]} of {n} {kind.name.lower()} records")

    def _compare_chunk(self, head: Head, entry: ChunkIndex | None) -> None:
        if entry is None:
            raise self.file.damaged(head.offset, "a chunk that is not in the index")
        found = self.file.chunk_head(head)
        there = (HEAD.size + head.length, found.start_ns, found.end_ns, found.size, found.stored, found.compression)
        stated = (entry.chunk_length, entry.message_start_time, entry.message_end_time, entry.uncompressed_size)
        if there != (*stated, entry.compressed_size, entry.compression):
            raise self.file.damaged(head.offset, "a chunk that differs from its entry in the index")


def _index(file: McapFile, start: int, crc: int) -> FileIndex:
    """The summary section.

    Raises:
        ArchiveError: damaged.
    """
    end = file.size - FOOTER_BYTES + _FOOTER_CHECKED
    found = 0
    for piece in _pieces(file, start, end):
        found = zlib.crc32(piece, found)
    if crc not in (0, found):
        raise file.damaged(start, "the checksum of the index is wrong")
    index = FileIndex(start)
    try:
        for frame in file.frames(start):
            index.take(frame)
        index.counts  # noqa: B018 (a channel without a topic is damage)
    except DAMAGE as error:
        raise file.damaged(start, "the index cannot be read") from error
    return index


def _pieces(file: McapFile, start: int, end: int) -> Iterator[bytes]:
    while start < end and (piece := file.read(start, min(_PIECE, end - start))):
        yield piece
        start += len(piece)
