"""A recording on its way to its file.

The viewer's library waits for ever when the disk is full. So its bytes come here first, through a pipe, and are written
by `PartialFile`: what goes wrong is an error of this program, and memory stays flat.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import rerun as rr

from twin.archive.container.partial import PartialFile
from twin.errors import ArchiveError

_PIECE = 1 << 20
#: Open files by number: where this folder is not (Windows), a recording waits in memory for its end.
_OPEN_FILES = Path("/dev/fd")


class _Way(Protocol):
    """How the bytes come from the library to the file."""

    def sink(self, recording: rr.RecordingStream) -> rr.FileSink | rr.BinaryStream:
        """Where the recording shall write."""

    def opened(self) -> None:
        """The recording holds the sink now."""

    def finish(self) -> None:
        """The recording has been flushed and disconnected: take the rest."""


class RecordingFile:
    """A ``.rrd`` file that has its final name only when it is whole.

    Args:
        path: the final name; missing folders above it are made.
        force: replace a file that is there instead of refusing.

    Raises:
        ArchiveError: the file is there already, or cannot be made.
    """

    def __init__(self, path: Path, *, force: bool = False) -> None:
        self._file = PartialFile(path, force=force)
        self._error: ArchiveError | None = None
        self._way: _Way = _Pipe(self._put) if _OPEN_FILES.exists() else _Memory(self._put)
        self._connected = False
        self._told = False

    def connect(self, recording: rr.RecordingStream, *viewers: rr.GrpcSink) -> None:
        """Let a recording write here, and to viewers beside; at most once."""
        recording.set_sinks(self._way.sink(recording), *viewers)
        self._way.opened()
        self._connected = True

    def check(self) -> None:
        """Raise what has gone wrong in the background, once.

        Raises:
            ArchiveError: something could not be written; the file keeps its partial name.
        """
        if self._error is not None and not self._told:
            self._told = True
            raise self._error

    def close(self) -> None:
        """Take the rest of a disconnected recording and give the file its final name; without one, leave none.

        Raises:
            ArchiveError: something could not be written; the file keeps its partial name.
        """
        if not self._connected:
            self._file.discard()
            return
        self._way.finish()
        self.check()
        if self._error is None:
            self._file.commit()

    def discard(self) -> None:
        """End a disconnected recording without leaving a file; what a failed write has kept stays."""
        if self._connected:
            self._way.finish()
        if self._error is None:
            self._file.discard()

    def _put(self, data: bytes) -> None:
        """Write, and after an error only swallow."""
        if self._error is None:
            try:
                self._file.write(data)
            except ArchiveError as error:
                self._error = error


class _Pipe:
    """The library writes into a pipe, a thread empties it."""

    def __init__(self, put: Callable[[bytes], None]) -> None:
        self._put = put

    def sink(self, recording: rr.RecordingStream) -> rr.FileSink:  # noqa: ARG002
        read, self._write = os.pipe()
        self._thread = threading.Thread(target=self._empty, args=(read,), name="rrd-writer", daemon=True)
        self._thread.start()
        return rr.FileSink(_OPEN_FILES / str(self._write))

    def opened(self) -> None:
        os.close(self._write)

    def finish(self) -> None:
        self._thread.join()

    def _empty(self, read: int) -> None:
        try:
            while data := os.read(read, _PIECE):
                self._put(data)
        finally:
            os.close(read)


class _Memory:
    """The library keeps everything until the end."""

    def __init__(self, put: Callable[[bytes], None]) -> None:
        self._put = put

    def sink(self, recording: rr.RecordingStream) -> rr.BinaryStream:
        self._stream = rr.binary_stream(recording)
        return self._stream

    def opened(self) -> None:
        """Nothing to do."""

    def finish(self) -> None:
        self._put(self._stream.read(flush=False) or b"")
