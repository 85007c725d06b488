"""Writes a run to an MCAP file (docs/archive-format.md)."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from types import TracebackType
from typing import Self

from twin.archive.container.interrupt import after_this
from twin.archive.container.partial import PartialFile
from twin.archive.run_writer import RunWriter
from twin.archive.same_job import is_run_of
from twin.record import Record


class McapSink:
    """Writes ``path``, under the name ``*.partial.mcap`` until `close`; that file is readable after a killed run.

    Ctrl-C takes effect after the current record is written. If writing fails, the complete records are kept under the
    partial name, and `close` does nothing more. A run that ends before its header leaves no file.

    Args:
        path: the run's file; missing folders above it are created.
        force: replace an existing file instead of refusing.
        job: job file of the run: a file that was made from it is replaced without ``force``.

    Raises:
        ArchiveError: the file already exists, another program is writing it, or it cannot be created.
    """

    def __init__(self, path: str | PathLike[str], *, force: bool = False, job: Path | None = None) -> None:
        self._file = PartialFile(Path(path), force=force, replaceable=lambda old: is_run_of(old, job), keep=True)
        self._run = RunWriter(self._file.write)

    def write(self, record: Record) -> None:
        """Take one record.

        Raises:
            ArchiveError: the disk is full or the like; the sink is closed; or the record does not belong here (see
                `RunWriter.write`).
        """
        if self._file.closed:
            raise self._file.is_closed()
        with after_this():
            self._run.write(record)

    def close(self) -> None:
        """Complete the file and give it its final name.

        Raises:
            ArchiveError: the end could not be written; the records are kept under the partial name.
        """
        if self._file.closed:
            return
        with after_this():
            if self._run.started:
                self._run.finish()
                self._file.commit()
            else:
                self._file.discard()

    def discard(self) -> None:
        """End without leaving a file, except a partial file kept after a failed write."""
        if not self._file.closed:
            self._file.discard()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
