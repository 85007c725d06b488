"""Records of one run written to an MCAP file, in order."""

from __future__ import annotations

import time
from collections.abc import Callable

from twin.archive import messages, schemas
from twin.archive import run_metadata as meta
from twin.archive.container.chunk import to_ns
from twin.archive.container.container import Container
from twin.errors import ArchiveError
from twin.record import Collision, NcEvent, Record, RunHeader, RunSummary, Step, ToolRecord, WorkpiecePatch

#: A chunk is completed at this uncompressed size, each force sample as a message of its own (10,000 samples) ...
CHUNK_BYTES = 1 << 20
#: ... or this long after its first record: a killed run loses no more than that.
CHUNK_SECONDS = 2.0


class RunWriter:
    """Encodes records and completes chunks; `finish` completes the file.

    Args:
        put: takes bytes and keeps all of them, or raises.
        clock: seconds of a clock, for the age of a chunk.
    """

    def __init__(self, put: Callable[[bytes], None], *, clock: Callable[[], float] = time.monotonic) -> None:
        self._put = put
        self._clock = clock
        self._file: Container | None = None
        self._program = ""
        self._samples = "all"
        self._tools: dict[int, ToolRecord] = {}
        self._tool: int | None = None
        self._last: Step | None = None
        self._chunk_since = 0.0

    @property
    def started(self) -> bool:
        """Whether the header was written."""
        return self._file is not None

    def write(self, record: Record) -> None:
        """Write one record.

        Raises:
            ArchiveError: the first record is not a header, or a later one is, or two attachments have the same name.
        """
        if isinstance(record, RunHeader):
            self._start(record)
            return
        if self._file is None:
            raise ArchiveError(f"a run begins with its RunHeader, got {type(record).__name__}")
        was_empty = not self._file.pending_bytes
        self._encode(self._file, record)
        now = self._clock()
        if was_empty:
            self._chunk_since = now
        if self._file.pending_bytes >= CHUNK_BYTES or now - self._chunk_since >= CHUNK_SECONDS:
            self._file.flush()

    def finish(self) -> None:
        """Complete the file."""
        if self._file is not None:
            self._end(self._file)
            self._file.finish()

    def _start(self, header: RunHeader) -> None:
        if self._file is not None:
            raise ArchiveError("a run has one RunHeader, got a second one")
        names = [meta.TOOL_TABLE, *(a.name for a in header.attachments)]
        if double := next((n for n in names if names.count(n) > 1), None):
            raise ArchiveError(f"attachment {double!r} is there twice; names of attachments must differ")
        self._file = file = Container(self._put, f"{schemas.LIBRARY} {header.twin_version}{schemas.WITH_CHECKSUMS}")
        file.start()
        for attachment in header.attachments:
            file.add_attachment(attachment.name, attachment.media_type, attachment.data)
        file.add_attachment(meta.TOOL_TABLE, meta.JSON_TYPE, meta.tool_table(header.tools))
        file.add_metadata(meta.PARAMETERS, meta.sealed(header.parameters))
        file.add_metadata(meta.HEADER, meta.sealed(meta.header_metadata(header)))
        self._program = header.program
        self._samples = meta.kept_samples(header)
        self._tools = {tool.number: tool for tool in header.tools}

    def _encode(self, file: Container, record: Record) -> None:
        match record:
            case Step():
                self._step(file, record)
            case NcEvent():
                file.add_message(schemas.NC_TOPIC, _ns(record), messages.nc(record, self._program))
            case Collision():
                file.add_message(schemas.COLLISION_TOPIC, _ns(record), messages.collision(record, self._program))
            case WorkpiecePatch():
                topic = schemas.WORKPIECE_PREFIX + record.patch
                file.add_message(topic, _ns(record), messages.patch(record))
            case RunSummary():
                self._end(file)
                file.flush()
                file.add_metadata(meta.SUMMARY, meta.sealed(meta.summary_metadata(record)))

    def _step(self, file: Container, step: Step) -> None:
        """A step: tool shape and pose for viewers, engagement, force samples."""
        time_ns = _ns(step)
        if step.tool != self._tool:
            self._tool = step.tool
            if tool := self._tools.get(step.tool):
                file.add_message(schemas.TOOL_SHAPE_TOPIC, time_ns, messages.tool_shape(step.t_s, tool))
        file.add_message(schemas.POSE_TOPIC, time_ns, messages.pose(step.t_s, step.start_mm))
        keep = self._samples == "all" or (self._samples == "cutting" and step.engagement.cutting)
        count = len(step.samples.t_s) if keep else 0
        file.add_message(schemas.ENGAGEMENT_TOPIC, time_ns, messages.engagement(step, count))
        file.add_forces(step, keep=keep)
        self._last = step

    def _end(self, file: Container) -> None:
        """Position of the tool after the last step, and the last spindle revolution."""
        file.end_forces()
        if self._last is not None:
            end_s = self._last.t_s + self._last.duration_s
            file.add_message(schemas.POSE_TOPIC, to_ns(end_s), messages.pose(end_s, self._last.end_mm))
            self._last = None


def _ns(record: Step | NcEvent | Collision | WorkpiecePatch) -> int:
    return to_ns(record.t_s)
