"""A file that has its final name only when it is complete; until then its name ends in ``.partial``."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path

from twin.archive.container.interrupt import ENDING_SIGNALS, after_this
from twin.archive.container.lock import lock
from twin.errors import ArchiveError, TwinError

_EXISTS = "already exists; replace it with --force"
#: Bytes copied in one piece.
_COPIED_TOGETHER = 1 << 22
_NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
_OLD = os.O_WRONLY | getattr(os, "O_NONBLOCK", 0)


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
    file = PartialFile(target, force=True, refuse=refuse)
    try:
        yield file.partial
        file.commit()
    except OSError as error:
        raise refuse(f"{target}: cannot be written: {reason(error)}") from error
    finally:
        file.discard()


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

    The partial file is locked while it is written, so that two programs cannot write one output at the same time. The
    lock ends with the process: what a killed run left is recognised by it.

    Args:
        path: the final name.
        force: replace a file of that name, and the partial file of an earlier unfinished run, instead of refusing.
        replaceable: whether an existing file may be replaced without ``force``.
        keep: keep the partial file when its end cannot be written: it has a run up to there.
        refuse: the error for a file that cannot be written.

    Raises:
        ArchiveError: a file exists and must not be replaced, the path is that of a device, another program is writing
            it, or none can be created.
    """

    def __init__(
        self,
        path: Path,
        *,
        force: bool = False,
        replaceable: Callable[[Path], bool] = lambda _path: False,
        keep: bool = False,
        refuse: type[TwinError] = ArchiveError,
    ) -> None:
        self.path = path
        self.partial = partial_path(path)
        self._may_replace = (lambda _path: True) if force else replaceable
        self._keep = keep
        self._refuse = refuse
        self._size = 0
        self._file: int | None = None
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise refuse(f"{path}: is a device or a pipe, which a finished file cannot replace; expected a file name")
        if self._is_taken():
            raise refuse(f"{path}: {_EXISTS}")
        try:
            with after_this(*ENDING_SIGNALS):
                path.parent.mkdir(parents=True, exist_ok=True)
                self._file = self._open()
        except OSError as error:
            raise refuse(f"{path}: cannot be written: {reason(error)}") from error
        except BaseException:
            self.discard()
            raise

    def write(self, data: bytes) -> None:
        """Write all of the bytes through to the system.

        Raises:
            ArchiveError: not all could be written; the file is then closed and ends before them.
        """
        if self._file is None:
            raise self.is_closed()
        self._refuse_removed(self._file)
        view = memoryview(data)
        try:
            while len(view):
                view = view[os.write(self._file, view) :]
        except OSError as error:
            with contextlib.suppress(OSError):
                os.ftruncate(self._file, self._size)
            raise self._failed(f"cannot be written: {reason(error)}", "the part written so far") from error
        self._size += len(data)

    def commit(self) -> None:
        """Give the file its final name.

        Raises:
            ArchiveError: a file of that name was created meanwhile, or the partial file was removed.
        """
        if self._file is None:
            raise self.is_closed()
        self._refuse_removed(self._file)
        if self._is_taken():
            raise self._failed(_EXISTS, "this run")
        try:
            self.partial.replace(self.path)
        except OSError as error:
            raise self._failed(f"cannot be written: {reason(error)}", "this run") from error
        self.abandon()

    def abandon(self) -> None:
        """Close; the file is kept under its partial name."""
        file, self._file = self._file, None
        if file is not None:
            os.close(file)

    def discard(self) -> None:
        """Close and remove; nothing after `commit` or `abandon`."""
        if self._file is not None and _is_open_file(self.partial, self._file):
            self.partial.unlink(missing_ok=True)
        self.abandon()

    def is_closed(self) -> TwinError:
        """The error for whoever writes to a closed file."""
        return self._refuse(f"{self.path}: is closed")

    @property
    def closed(self) -> bool:
        """Whether nothing more can be written."""
        return self._file is None

    def _open(self) -> int:
        """Create and lock the partial file; one that is there and not locked is replaced if it may be."""
        while True:
            try:
                file = os.open(self.partial, _NEW, 0o666)
            except FileExistsError:
                self._remove_old()
                continue
            if lock(file) and _is_open_file(self.partial, file):
                return file
            os.close(file)

    def _remove_old(self) -> None:
        """Remove the file of an unfinished run; while it is removed it is locked, so that only one program does so."""
        try:
            old = os.open(self.partial, _OLD)
        except FileNotFoundError:
            return
        try:
            if not lock(old):
                raise self._refuse(f"{self.partial}: another program is writing this file; wait for its end")
            if not _is_open_file(self.partial, old):
                return
            if os.fstat(old).st_size and not self._may_replace(self.partial):
                raise self._refuse(
                    f"{self.partial}: file of a run that did not finish; move it away, or replace it with --force"
                )
            self.partial.unlink(missing_ok=True)
        finally:
            os.close(old)

    def _is_taken(self) -> bool:
        return self.path.exists() and not self._may_replace(self.path)

    def _failed(self, problem: str, what: str) -> TwinError:
        """Close, and remove unless the partial file is to be kept; returns the error."""
        if self._keep:
            self.abandon()
        else:
            self.discard()
        return self._refuse(f"{self.path}: {problem}{f'; {what} is kept in {self.partial}' if self._keep else ''}")

    def _refuse_removed(self, file: int) -> None:
        if not _is_open_file(self.partial, file):
            self.abandon()
            raise self._refuse(f"{self.path}: cannot be written: {self.partial} was removed by another program")


def _is_open_file(path: Path, file: int) -> bool:
    """Whether a path is still that of an open file."""
    try:
        return os.path.samestat(path.stat(), os.fstat(file))
    except OSError:
        return False
