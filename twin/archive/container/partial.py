"""A file that has its final name only when it is complete; until then its name ends in ``.partial``."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from twin.errors import ArchiveError, TwinError

#: Bytes copied in one piece.
_COPIED_TOGETHER = 1 << 22
_NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)


def partial_path(path: Path) -> Path:
    """Name of a file while it is written: ``slot.partial.mcap`` for ``slot.mcap``, which viewers open too."""
    return path.with_name(f"{path.stem}.partial{path.suffix}")


def reason(error: OSError) -> str:
    """The system's message, in lower case and without its number."""
    text = error.strerror or str(error)
    return text[:1].lower() + text[1:]


@contextlib.contextmanager
def replacing(target: Path, refuse: type[TwinError] = ArchiveError) -> Iterator[Path]:
    """Path to write to; on success it becomes the target, otherwise it is removed.

    Args:
        target: missing folders above it are created.
        refuse: the error for a file that cannot be written.
    """
    partial = partial_path(target)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        yield partial
        partial.replace(target)
    except OSError as error:
        raise refuse(f"{target}: cannot be written: {reason(error)}") from error
    finally:
        with contextlib.suppress(OSError):
            partial.unlink()


def copy_file(source: Path, target: Path, *, force: bool = False) -> Path:
    """Copy a file; the copy has its name only when it is whole.

    Args:
        target: missing folders above it are made.
        force: replace a file that exists.

    Returns:
        ``target``.

    Raises:
        ArchiveError: another suffix, a file that exists, or one that cannot be read or written.
    """
    if target.suffix.lower() != source.suffix.lower():
        raise ArchiveError(f"{target}: expected a file name that ends in {source.suffix}")
    if force and target.exists() and target.samefile(source):
        return target
    file = PartialFile(target, force=force)
    try:
        with source.open("rb") as data:
            while piece := data.read(_COPIED_TOGETHER):
                file.write(piece)
    except OSError as error:
        file.discard()
        raise ArchiveError(f"{source}: cannot be read: {reason(error)}") from error
    except BaseException:
        file.discard()
        raise
    file.commit()
    return target


class PartialFile:
    """Writes bytes without a buffer; a piece is in the file completely or not at all.

    Args:
        path: the final name.
        force: replace a file of that name, and the partial file of an earlier unfinished run, instead of refusing.

    Raises:
        ArchiveError: a file exists and ``force`` is not set, or none can be created.
    """

    def __init__(self, path: Path, *, force: bool = False) -> None:
        self.path = path
        self.partial = partial_path(path)
        self._force = force
        self._size = 0
        self._refuse_existing()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            if force:
                self.partial.unlink(missing_ok=True)
            self._file = self._open()
        except OSError as error:
            raise ArchiveError(f"{path}: cannot be written: {reason(error)}") from error

    def write(self, data: bytes) -> None:
        """Write all of the bytes through to the system.

        Raises:
            ArchiveError: not all could be written; the file is then closed and ends before them.
        """
        if self._file is None:
            raise self.is_closed()
        view = memoryview(data)
        try:
            while len(view):
                view = view[os.write(self._file, view) :]
        except OSError as error:
            with contextlib.suppress(OSError):
                os.ftruncate(self._file, self._size)
            self.abandon()
            raise ArchiveError(
                f"{self.path}: cannot be written: {reason(error)}; the part written so far is kept in {self.partial}"
            ) from error
        self._size += len(data)

    def commit(self) -> None:
        """Give the file its final name.

        Raises:
            ArchiveError: a file of that name was created meanwhile; the partial one is kept.
        """
        self.abandon()
        self._refuse_existing(f"; this run is kept in {self.partial}")
        try:
            self.partial.replace(self.path)
        except OSError as error:
            raise ArchiveError(
                f"{self.path}: cannot be written: {reason(error)}; this run is kept in {self.partial}"
            ) from error

    def abandon(self) -> None:
        """Close; the file is kept under its partial name."""
        file, self._file = self._file, None
        if file is not None:
            os.close(file)

    def discard(self) -> None:
        """Close and remove."""
        self.abandon()
        self.partial.unlink(missing_ok=True)

    def is_closed(self) -> ArchiveError:
        """The error for whoever writes to a closed file."""
        return ArchiveError(f"{self.path}: is closed")

    @property
    def closed(self) -> bool:
        """Whether nothing more can be written."""
        return self._file is None

    def _open(self) -> int | None:
        try:
            return os.open(self.partial, _NEW, 0o666)
        except FileExistsError:
            raise ArchiveError(
                f"{self.partial}: file of a run that did not finish, or is still running; "
                "move it away, or replace it with --force"
            ) from None

    def _refuse_existing(self, kept: str = "") -> None:
        if not self._force and self.path.exists():
            raise ArchiveError(f"{self.path}: already exists; replace it with --force{kept}")
