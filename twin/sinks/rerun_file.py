"""A recording's bytes on their way to its file, so that a full disk is an error here and never a viewer library that hangs."""

from __future__ import annotations

import os
import threading
from pathlib import Path
from typing import Protocol

import rerun as rr

from twin.archive.partial import PartialFile
from twin.errors import ArchiveError

_PIECE = 1 << 20


class Outlet(Protocol):
    """Takes what a recording writes; one of the classes below."""

    def attach(self, recording: rr.RecordingStream) -> rr.FileSink | rr.BinaryStream:
        """What the recording shall write to; called once."""

    def check(self) -> None:
        """Raise the error that has come up meanwhile, if any."""

    def finish(self) -> None:
        """Take the rest; called once the recording is disconnected, or never was attached.

        Raises:
            ArchiveError: something could not be written.
        """


class PipeOutlet:
    """Hands the bytes over through a pipe: nothing waits for long in memory.

    The library writes into the pipe, a thread takes the bytes out and goes on taking them when the disk is full.
    """

    def __init__(self, file: PartialFile) -> None:
        self._file = file
        self._error: ArchiveError | None = None
        self._thread: threading.Thread | None = None

    def attach(self, recording: rr.RecordingStream) -> rr.FileSink:  # noqa: ARG002
        """See `Outlet.attach`."""
        self._read, self._write = os.pipe()
        self._thread = threading.Thread(target=self._drain, name="rrd-writer", daemon=True)
        self._thread.start()
        return rr.FileSink(f"/dev/fd/{self._write}")

    def opened(self) -> None:
        """The library holds the pipe's end by itself now."""
        os.close(self._write)

    def check(self) -> None:
        """See `Outlet.check`."""
        if self._error is not None:
            raise self._error

    def finish(self) -> None:
        """See `Outlet.finish`."""
        if self._thread is not None:
            self._thread.join()
        self.check()

    def _drain(self) -> None:
        with open(self._read, "rb", buffering=0) as pipe:  # noqa: PTH123
            while data := pipe.read(_PIECE):
                if self._error is None:
                    self._keep(data)

    def _keep(self, data: bytes) -> None:
        try:
            self._file.write(data)
        except ArchiveError as error:
            self._error = error
