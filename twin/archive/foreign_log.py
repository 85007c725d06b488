"""Messages in the MCAP files of other programs, in the order of the file, with bounded memory."""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from mcap.opcode import Opcode
from mcap.records import Channel, Schema

from twin.archive.container.chunk import MESSAGE_FIXED
from twin.archive.container.frames import DAMAGE, HEAD, Frame, McapFile, stream
from twin.archive.container.integrity import FileIndex, checked_index, compare_counts
from twin.errors import ArchiveError

#: Channel, sequence, log time and publish time of a message.
_MESSAGE = struct.Struct("<HIQQ")


@dataclass(frozen=True, slots=True)
class LogMessage:
    """One message, still encoded; the times at which it was recorded, and sent."""

    channel: Channel
    schema: Schema | None
    time_ns: int
    sent_ns: int
    data: bytes


class ForeignLog:
    """An MCAP file whose frames, counts and checksums are checked as those of a run are.

    Args:
        file: open for reading.

    Raises:
        ArchiveError: damaged, or incomplete.
    """

    def __init__(self, file: McapFile) -> None:
        self._file = file
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._index: FileIndex | None = checked_index(file)
        if file.footer() is None:
            raise ArchiveError(f"{file.path}: ends early, at byte {file.size}; expected an MCAP file that was closed")
        if self._index is not None:
            self._take_all(file.frames(self._index.start))
        if not self._channels:
            for _ in self.messages(""):
                pass

    @property
    def channels(self) -> list[Channel]:
        """All channels of the file."""
        return list(self._channels.values())

    def messages(self, topic: str) -> Iterator[LogMessage]:
        """The messages on a topic.

        Raises:
            ArchiveError: damaged.
        """
        counts: Counter[str] = Counter()
        for frame in self._file.frames():
            if frame.opcode == Opcode.DATA_END:
                break
            data = self._file.unpack(frame) if frame.opcode == Opcode.CHUNK else _whole(frame)
            for opcode, body in self._records(data, frame.offset):
                if opcode == Opcode.MESSAGE:
                    message = self._message(body, frame.offset)
                    if message.channel.topic == topic:
                        counts[topic] += 1
                        yield message
                else:
                    self._take_all([Frame(frame.offset, opcode, body)])
        if self._index is not None and topic:
            compare_counts(self._file, self._index, counts, topic)

    def _records(self, data: bytes, offset: int) -> Iterator[tuple[int, bytes]]:
        """Opcode and content of the records in a chunk."""
        at = 0
        while at < len(data):
            length = int.from_bytes(data[at + 1 : at + HEAD.size], "little")
            end = at + HEAD.size + length
            if not data[at] or end > len(data):
                raise self._file.damaged(offset, "a chunk whose records are not whole")
            yield data[at], data[at + HEAD.size : end]
            at = end

    def _message(self, body: bytes, offset: int) -> LogMessage:
        if len(body) < MESSAGE_FIXED:
            raise self._file.damaged(offset, "a message without its fields")
        number, _, time_ns, sent_ns = _MESSAGE.unpack_from(body)
        channel = self._channels.get(number)
        if channel is None:
            raise self._file.damaged(offset, f"a message on the unknown channel {number}")
        return LogMessage(channel, self._schemas.get(channel.schema_id), time_ns, sent_ns, body[MESSAGE_FIXED:])

    def _take_all(self, frames: Iterator[Frame] | list[Frame]) -> None:
        """Keep schemas and channels."""
        for frame in frames:
            try:
                if frame.opcode == Opcode.SCHEMA:
                    schema = Schema.read(stream(frame.body))
                    self._schemas[schema.id] = schema
                elif frame.opcode == Opcode.CHANNEL:
                    channel = Channel.read(stream(frame.body))
                    self._channels[channel.id] = channel
            except DAMAGE as error:
                raise self._file.damaged(frame.offset, "a schema or channel that cannot be read") from error


def _whole(frame: Frame) -> bytes:
    """A record outside of chunks as the content of one."""
    wanted = (Opcode.MESSAGE, Opcode.SCHEMA, Opcode.CHANNEL)
    return HEAD.pack(frame.opcode, len(frame.body)) + frame.body if frame.opcode in wanted else b""
