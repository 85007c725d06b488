"""Writes a rerun recording to its file.

The viewer's library waits for ever when the disk is full. So its bytes come here first, through a pipe, and are written
by `PartialFile`: a full disk is an error of this program, and memory stays constant.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import rerun as rr

from twin.archive.container.partial import PartialFile
from twin.archive.same_job import is_recording_of
from twin.errors import ArchiveError

_PIECE = 1 << 20
#: Open files by number: without this folder (Windows), a recording is kept in memory until its end.
_OPEN_FILES = Path("/dev/fd")


class _Transfer(Protocol):
    """Transfers the bytes of a recording from the library to the file."""

    def sink(self, recording: rr.RecordingStream) -> rr.FileSink | rr.BinaryStream:
        """The library's output."""

    def opened(self) -> None:
        """Called when the recording has opened the output."""

    def finish(self) -> None:
        """Take the rest; called when the recording was flushed and disconnected."""


class RecordingFile:
    """A ``.rrd`` file that has its final name only when it is complete.

    Args:
        path: the final name; missing folders above it are created.
        force: replace an existing file instead of refusing.
        job: job file of the run: a recording that was made from it is replaced without ``force``.

    Raises:
        ArchiveError: the file already exists, another program is writing it, or it cannot be created.
    """

    def __init__(self, path: Path, *, force: bool = False, job: Path | None = None) -> None:
        self._file = PartialFile(path, force=force, replaceable=lambda old: is_recording_of(old, job), keep=True)
        self._error: ArchiveError | None = None
        self._transfer: _Transfer = _Pipe(self._put) if _OPEN_FILES.exists() else _Memory(self._put)
        self._connected = False
        self._reported = False

    def connect(self, recording: rr.RecordingStream, *viewers: rr.GrpcSink) -> None:
        """Connect a recording to this file, and to viewers as well; at most once."""
        recording.set_sinks(self._transfer.sink(recording), *viewers)
        self._transfer.opened()
        self._connected = True

    def check(self) -> None:
        """Raise an error that occurred in the background, once.

        Raises:
            ArchiveError: something could not be written; the file keeps its partial name.
        """
        if self._error is not None and not self._reported:
            self._reported = True
            raise self._error

    def close(self) -> None:
        """Take the rest of a disconnected recording and give the file its final name; without one, leave none.

        Raises:
            ArchiveError: something could not be written; the file keeps its partial name.
        """
        if not self._connected:
            self._file.discard()
            return
        self._transfer.finish()
        self.check()
        if self._error is None:
            self._file.commit()

    def discard(self) -> None:
        """End a disconnected recording without leaving a file, except a partial file kept after a failed write."""
        if self._connected:
            self._transfer.finish()
        if self._error is None:
            self._file.discard()

    def _put(self, data: bytes) -> None:
        """Write; after an error, discard."""
        if self._error is None:
            try:
                self._file.write(data)
            except ArchiveError as error:
                self._error = error


class _Pipe:
    """The library writes to a pipe, a thread empties it."""

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
